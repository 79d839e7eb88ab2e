//! Errors of the gear geometry, at the keys that cause them.

use super::error::SceneError;
use super::reading::Place;
use gearbench_models::error::Reason;
use gearbench_models::geometry::{GeometryError, InternalError, Quantity};

/// Converts an error of the geometry to one at the key that causes it.
pub(super) fn geometry(at: &Place<'_>, e: &GeometryError) -> SceneError {
    let Reason { cause, help } = e.reason();
    let message = format!("{}: {cause}", at.header());
    at.first(keys_of(e))
        .error(message, "impossible geometry", help)
}

/// The keys that can cause a geometry error, the likeliest first.
pub(super) fn keys_of(e: &GeometryError) -> &'static [&'static str] {
    use GeometryError as E;
    use InternalError as I;
    use Quantity as Q;
    match e {
        E::Invalid { what, .. } => match what {
            Q::Teeth | Q::RackTeeth => &["teeth"],
            Q::ReliefAmount | Q::ReliefStart => &["tip_relief"],
            Q::EndReliefAmount | Q::EndReliefLength => &["end_relief"],
            Q::HelixSlope => &["helix_slope_m"],
            Q::Twist => &["twist_m"],
            Q::TopographyRadius | Q::TopographyHeight => &["topography"],
            Q::CentreDistance | Q::RackDistance => &["centre_distance_m"],
            Q::ReferenceCircle => &["module_m"],
            Q::TipCircle => &["tip_circle_radius_m", "module_m"],
            Q::RootCircle => &["root_circle_radius_m", "module_m"],
            Q::Module => &["module_m"],
            Q::PressureAngle => &["pressure_angle_deg"],
            Q::HelixAngle => &["helix_angle_deg"],
            Q::Addendum => &["addendum_factor"],
            Q::Dedendum => &["dedendum_factor"],
            Q::TipRadius => &["tip_radius_factor"],
            Q::Thinning => &["thinning_m"],
            Q::FaceWidth => &["face_width_m"],
            Q::ProfileShift => &["profile_shift"],
            Q::ProfileShiftAngle => &["profile_shift_angle_deg"],
            Q::TipConeAngle => &["tip_cone_angle_deg", "profile_shift_angle_deg"],
            Q::BoreRadius => &["bore_radius_m"],
            Q::RimRadius => &["rim_radius_m"],
            Q::CutterTeeth => &["cutter_teeth"],
            Q::CutterShift => &["cutter_profile_shift"],
            Q::ProfileCrowning => &["profile_crowning_m"],
            Q::LeadCrowning => &["lead_crowning_m"],
            Q::BodyHeight => &["body_height_m"],
            Q::Backlash => &["backlash_m"],
        },
        E::Undercut { .. } => &["profile_shift", "teeth"],
        E::PointedTooth { .. } => &["addendum_factor", "profile_shift", "thinning_m", "teeth"],
        E::NoToothLeft { .. } => &["thinning_m"],
        E::TipRadius { .. } => &["tip_radius_factor", "dedendum_factor"],
        E::PointedTool { .. } => &["dedendum_factor", "pressure_angle_deg"],
        E::NoRoot { .. } => &["dedendum_factor", "profile_shift", "teeth"],
        E::NoInvolute { .. } => &["addendum_factor", "tip_radius_factor", "profile_shift"],
        E::FilletFolds => &["profile_shift", "tip_radius_factor", "dedendum_factor"],
        E::BoreTooLarge { .. } => &["bore_radius_m"],
        E::ReliefStart { .. } => &["tip_relief"],
        E::EndRelief { .. } => &["end_relief"],
        E::Topography { .. } => &["topography"],
        E::Deviations { .. } => &["deviations"],
        E::ModificationTooDeep { .. } => &[
            "tip_relief",
            "profile_crowning_m",
            "lead_crowning_m",
            "topography",
            "end_relief",
            "helix_slope_m",
            "twist_m",
            "deviations",
        ],
        E::UnequalModules { .. } => &["module_m"],
        E::UnequalPressureAngles { .. } => &["pressure_angle_deg"],
        E::HelixMismatch { .. } => &["helix_angle_deg"],
        E::Conical(_) => &["profile_shift_angle_deg", "tip_cone_angle_deg"],
        E::Internal(why) => match why {
            I::CutterTeeth { .. } | I::CutterFouls { .. } => &["cutter_teeth", "internal"],
            I::CutterShift { .. } => &[
                "cutter_profile_shift",
                "profile_shift",
                "cutter_teeth",
                "internal",
            ],
            I::CutterTip { .. } => &[
                "root_circle_radius_m",
                "dedendum_factor",
                "cutter_teeth",
                "cutter_profile_shift",
                "internal",
            ],
            I::CutterBase { .. } => &[
                "cutter_teeth",
                "tip_circle_radius_m",
                "addendum_factor",
                "internal",
            ],
            I::TipWithinBase { .. } | I::NoInvolute { .. } | I::RootWithinTip { .. } => &[
                "tip_circle_radius_m",
                "addendum_factor",
                "profile_shift",
                "internal",
            ],
            I::Rim { .. } => &["rim_radius_m", "internal"],
            I::Bore => &["bore_radius_m"],
            I::Not { .. } => &[
                "profile_shift_angle_deg",
                "tip_cone_angle_deg",
                "topography",
                "internal",
            ],
            _ => &["internal"],
        },
        _ => &[],
    }
}
