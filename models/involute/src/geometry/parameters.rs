//! Parameters of gears and racks. Units are SI; factors are multiples of the normal module.

use std::f64::consts::{FRAC_PI_4, PI};

use super::deviation::Deviations;
use super::error::{GeometryError, check, finite, not_negative, positive};
use super::internal::Internal;
use super::modification::Modifications;
use super::quantity::Quantity;

/// Parameters of a gear. Units are SI; factors are multiples of the normal module.
#[derive(Clone, Debug, PartialEq)]
pub struct GearParams {
    /// Number of teeth, 3 to 10000. The default is 0 and has to be set.
    pub teeth: u32,
    /// Normal module of the toothing (m).
    pub module: f64,
    /// Normal pressure angle (rad).
    pub pressure_angle: f64,
    /// Profile shift coefficient `x`.
    pub profile_shift: f64,
    /// Helix angle at the reference circle (rad); right hand positive, 0 for a spur gear.
    pub helix_angle: f64,
    /// Profile-shift angle (rad) of a conical gear (beveloid): the profile shift `x m_n` grows by its tangent along the
    /// axis; `profile_shift` is that of the middle of the face width. 0 for a cylindrical gear.
    pub profile_shift_angle: f64,
    /// Angle of the tip cone (rad): the tip radius grows by its tangent along the axis.
    pub tip_cone_angle: f64,
    /// Face width (m).
    pub face_width: f64,
    /// Addendum factor h_a* of the basic rack.
    pub addendum: f64,
    /// Dedendum factor h_f* of the basic rack (depth of the tool tip).
    pub dedendum: f64,
    /// Tip radius factor of the rack tool, which rounds the tooth root.
    pub tip_radius: f64,
    /// Reduction of the transverse arc tooth thickness at the reference circle (m).
    pub thinning: f64,
    /// Radius of the bore (m); 0 for a solid gear.
    pub bore_radius: f64,
    /// Additional parameters of an internal gear; `None` for an external one. With them `dedendum` and `tip_radius`
    /// are addendum and tip rounding of the cutter.
    pub internal: Option<Internal>,
    /// Tip relief and crowning, equal for all teeth.
    pub modifications: Modifications,
    /// Deviations of individual teeth in addition to the modifications.
    pub deviations: Deviations,
}

impl Default for GearParams {
    /// Basic rack of ISO 53 profile A (20 degrees, 1.0, 1.25, 0.38), module 1 mm, width 10 mm.
    fn default() -> Self {
        Self {
            teeth: 0,
            module: 1e-3,
            pressure_angle: 20f64.to_radians(),
            profile_shift: 0.0,
            helix_angle: 0.0,
            profile_shift_angle: 0.0,
            tip_cone_angle: 0.0,
            face_width: 10e-3,
            addendum: 1.0,
            dedendum: 1.25,
            tip_radius: 0.38,
            thinning: 0.0,
            bore_radius: 0.0,
            internal: None,
            modifications: Modifications::default(),
            deviations: Deviations::None,
        }
    }
}

/// Parameters of a rack. Units are SI; factors are multiples of the normal module.
#[derive(Clone, Debug, PartialEq)]
pub struct RackParams {
    /// Number of teeth, 1 to 10000. The default is 0 and has to be set.
    pub teeth: u32,
    /// Normal module of the toothing (m).
    pub module: f64,
    /// Normal pressure angle (rad).
    pub pressure_angle: f64,
    /// Face width (m).
    pub face_width: f64,
    /// Addendum factor h_a*.
    pub addendum: f64,
    /// Dedendum factor h_f*.
    pub dedendum: f64,
    /// Root fillet radius factor.
    pub tip_radius: f64,
    /// Reduction of the transverse tooth thickness at the reference line (m).
    pub thinning: f64,
    /// Height of the body below the root line (m).
    pub body_height: f64,
    /// Helix angle (rad); opposite in sign to that of the mating gear.
    pub helix_angle: f64,
}

impl Default for RackParams {
    /// Basic rack of ISO 53 profile A, module 1 mm, width 10 mm, body 3 mm high.
    fn default() -> Self {
        Self {
            teeth: 0,
            module: 1e-3,
            pressure_angle: 20f64.to_radians(),
            face_width: 10e-3,
            addendum: 1.0,
            dedendum: 1.25,
            tip_radius: 0.38,
            thinning: 0.0,
            body_height: 3e-3,
            helix_angle: 0.0,
        }
    }
}

/// Largest accepted number of teeth; larger inputs are considered mistakes.
const MAX_TEETH: u32 = 10_000;

/// Checks the parameters that gears and racks share; `factors` are addendum, dedendum and tip radius.
fn check_basic_rack(
    module: f64,
    pressure_angle: f64,
    helix_angle: f64,
    factors: [f64; 3],
    thinning: f64,
    face_width: f64,
) -> Result<(), GeometryError> {
    check(
        Quantity::Module,
        module,
        (1e-6..=10.0).contains(&module),
        "a length from 1e-6 to 10 m (4 mm is 0.004)",
    )?;
    check(
        Quantity::PressureAngle,
        pressure_angle,
        pressure_angle > 0.0 && pressure_angle < FRAC_PI_4,
        "an angle between 0 and 45 degrees (0.785 rad), ends excluded",
    )?;
    check(
        Quantity::HelixAngle,
        helix_angle,
        helix_angle.abs() <= PI / 3.0,
        "an angle from -60 to 60 degrees (1.047 rad)",
    )?;
    positive(Quantity::Addendum, factors[0])?;
    positive(Quantity::Dedendum, factors[1])?;
    not_negative(Quantity::TipRadius, factors[2])?;
    not_negative(Quantity::Thinning, thinning)?;
    positive(Quantity::FaceWidth, face_width)
}

impl GearParams {
    pub(super) fn check(&self) -> Result<(), GeometryError> {
        check(
            Quantity::Teeth,
            f64::from(self.teeth),
            (3..=MAX_TEETH).contains(&self.teeth),
            "a whole number from 3 to 10000",
        )?;
        check_basic_rack(
            self.module,
            self.pressure_angle,
            self.helix_angle,
            [self.addendum, self.dedendum, self.tip_radius],
            self.thinning,
            self.face_width,
        )?;
        finite(Quantity::ProfileShift, self.profile_shift)?;
        for (what, angle) in [
            (Quantity::ProfileShiftAngle, self.profile_shift_angle),
            (Quantity::TipConeAngle, self.tip_cone_angle),
        ] {
            check(
                what,
                angle,
                angle.abs() <= FRAC_PI_4,
                "an angle from -45 to 45 degrees (0.785 rad)",
            )?;
        }
        not_negative(Quantity::BoreRadius, self.bore_radius)?;
        self.internal.iter().try_for_each(Internal::check)
    }
}

impl RackParams {
    pub(super) fn check(&self) -> Result<(), GeometryError> {
        check(
            Quantity::RackTeeth,
            f64::from(self.teeth),
            (1..=MAX_TEETH).contains(&self.teeth),
            "a whole number from 1 to 10000",
        )?;
        check_basic_rack(
            self.module,
            self.pressure_angle,
            self.helix_angle,
            [self.addendum, self.dedendum, self.tip_radius],
            self.thinning,
            self.face_width,
        )?;
        positive(Quantity::BodyHeight, self.body_height)
    }
}
