//! Errors that only internal gears and their mates have, each with a remedy.

use super::error::GeometryError;
use crate::error::Reason;

/// Error of an internal gear or its mesh. Lengths are in metre.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "what the fields are the messages say")]
pub enum InternalError {
    /// The cutter does not fit into the gear.
    CutterTeeth { cutter: u32, ring: u32 },
    /// Cutter and gear have no line of action.
    CutterShift { shift: f64, greatest: f64 },
    /// The cutter has no tip land.
    CutterTip {
        r_tip: f64,
        r_base: f64,
        r_pointed: f64,
    },
    /// The cutter would have to cut the tips of the gear within its own base circle.
    CutterBase { missing: f64, tip_radius: f64 },
    /// The cutter removes the tips of the gear as it leaves the tooth space.
    CutterFouls { overlap: f64 },
    /// The tips of the gear lie within its base circle.
    TipWithinBase { r_tip: f64, r_base: f64 },
    /// The fillet reaches the tip.
    NoInvolute { r_form: f64, r_tip: f64 },
    /// The root circle does not lie outside the tip circle.
    RootWithinTip { r_root: f64, r_tip: f64 },
    /// The rim does not enclose the root circle.
    Rim { rim: f64, r_root: f64 },
    /// An internal gear has a bore.
    Bore,
    /// The feature does not exist for internal gears.
    Not { what: &'static str },
    /// Both gears are internal.
    BothInternal,
    /// The mate of an internal gear is a rack.
    OnRack,
    /// The mate has too many teeth to roll inside the internal gear.
    ToothDifference { ring: u32, mate: u32 },
    /// The teeth do not reach each other.
    NoEngagement { distance: f64, least: f64 },
    /// The backlash is negative.
    FlanksOverlap {
        distance: f64,
        backlash: f64,
        greatest: f64,
    },
    /// The base circles touch or intersect: there is no line of action.
    DistanceTooSmall { distance: f64, difference: f64 },
    /// The tips of the mate collide with the tips of the gear outside the path of contact.
    TipsFoul { overlap: f64, difference: u32 },
}

impl InternalError {
    /// Returns cause and remedy.
    pub fn reason(&self) -> Reason {
        let (cause, help) = match self {
            Self::CutterTeeth { cutter, ring } => (
                format!("a cutter with {cutter} teeth does not fit into {ring} internal teeth"),
                "use a cutter with fewer teeth".to_owned(),
            ),
            Self::CutterShift { shift, greatest } => (
                format!(
                    "the cutter cannot cut: with its profile shift {shift:.4} there is no line of action in the gear"
                ),
                format!(
                    "use a profile shift of the cutter below {greatest:.4}, a smaller one of the gear, or fewer teeth of \
                     the cutter"
                ),
            ),
            Self::CutterTip {
                r_tip,
                r_base,
                r_pointed,
            } => (
                format!(
                    "the cutter cannot cut: its tip radius {r_tip:.6} m is not between its base circle {r_base:.6} m and \
                     the radius {r_pointed:.6} m where its flanks meet"
                ),
                "choose dedendum factor (or root circle), profile shift and teeth of the cutter otherwise".to_owned(),
            ),
            Self::CutterBase {
                missing,
                tip_radius,
            } => (
                format!(
                    "the cutter cannot cut: the tips of the internal gear lie {missing:.3e} m (along the line of action) \
                     within the base circle of the cutter"
                ),
                format!(
                    "use a cutter with more teeth, or a tip radius of at least {tip_radius:.6} m (a smaller addendum)"
                ),
            ),
            Self::CutterFouls { overlap } => (
                format!(
                    "the cutter cannot cut: leaving the tooth space it takes {overlap:.3e} m off the tips of the gear"
                ),
                "use a cutter with fewer teeth, a smaller addendum factor or a larger pressure angle".to_owned(),
            ),
            Self::TipWithinBase { r_tip, r_base } => (
                format!(
                    "no involute at the tip: the tip radius {r_tip:.6} m of the internal gear lies within its base \
                     circle, {r_base:.6} m"
                ),
                "use a smaller addendum factor, a smaller profile shift or more teeth".to_owned(),
            ),
            Self::NoInvolute { r_form, r_tip } => (
                format!(
                    "no involute flank: the fillet of the internal gear begins at radius {r_form:.6} m, not above the tip \
                     radius {r_tip:.6} m"
                ),
                "use a larger addendum factor or a smaller tip radius factor".to_owned(),
            ),
            Self::RootWithinTip { r_root, r_tip } => (
                format!(
                    "the root radius {r_root:.6} m of the internal gear is not above its tip radius {r_tip:.6} m"
                ),
                "use larger addendum and dedendum factors".to_owned(),
            ),
            Self::Rim { rim, r_root } => (
                format!("the rim radius {rim:.6} m is not above the root radius {r_root:.6} m"),
                "use a larger rim".to_owned(),
            ),
            Self::Bore => (
                "an internal gear has no bore".to_owned(),
                "give the outer radius of its rim".to_owned(),
            ),
            Self::Not { what } => (
                format!("internal gears have no {what}"),
                "leave it out".to_owned(),
            ),
            Self::BothInternal => (
                "two internal gears do not mesh".to_owned(),
                "one of both has to be external".to_owned(),
            ),
            Self::OnRack => (
                "an internal gear does not mesh with a rack".to_owned(),
                "its mate is an external gear".to_owned(),
            ),
            Self::ToothDifference { ring, mate } => (
                format!("{mate} teeth do not roll inside {ring} internal teeth"),
                format!("use fewer than {ring} teeth for the external gear"),
            ),
            Self::NoEngagement { distance, least } => (
                format!("no tooth engagement: at {distance:.6} m the tips do not reach each other"),
                format!("the centre distance in an internal gear must be above {least:.6} m"),
            ),
            Self::FlanksOverlap {
                distance,
                backlash,
                greatest,
            } => (
                format!("flanks overlap: at {distance:.6} m the backlash is {backlash:.3e} m"),
                format!(
                    "reduce the centre distance in the internal gear to {greatest:.8} m or less, or thin the teeth"
                ),
            ),
            Self::DistanceTooSmall {
                distance,
                difference,
            } => (
                format!(
                    "centre distance too small: {distance:.6} m is not above the difference of the base radii \
                     {difference:.6} m"
                ),
                "increase it".to_owned(),
            ),
            Self::TipsFoul {
                overlap,
                difference,
            } => (
                format!(
                    "tips foul: {difference} teeth less than the internal gear has, the tips of the external gear cut \
                     {overlap:.3e} m into those of the internal one beside the path of contact"
                ),
                "use a larger difference of tooth numbers, smaller addendum factors, or profile shifts that raise the \
                 working pressure angle"
                    .to_owned(),
            ),
        };
        Reason { cause, help }
    }
}

impl From<InternalError> for GeometryError {
    fn from(why: InternalError) -> Self {
        GeometryError::Internal(why)
    }
}
