//! Conversion of the keys of a toothing to the parameters of the geometry.

use super::super::modifications::{end_reliefs, per_side};
use super::super::reading::values::Degrees;
use super::{GearTable, RackTable};
use gearbench_models::geometry::{
    Deviations, GearParams, Internal, Modifications, RackParams, ReliefShape, TipRelief, Topography,
};
use std::sync::Arc;

impl GearTable {
    pub(super) fn params(
        &self,
        deviations: Deviations,
        topography: [Option<Arc<Topography>>; 2],
    ) -> GearParams {
        let default = GearParams {
            // The tips of cutters are narrower than those of racks.
            tip_radius: if self.internal {
                0.25
            } else {
                GearParams::default().tip_radius
            },
            ..GearParams::default()
        };
        GearParams {
            teeth: self.teeth,
            module: self.module_m,
            pressure_angle: (self.pressure_angle_deg)
                .map_or(default.pressure_angle, Degrees::radians),
            profile_shift: self.profile_shift,
            helix_angle: self.helix_angle_deg.map_or(0.0, Degrees::radians),
            profile_shift_angle: self.profile_shift_angle_deg.map_or(0.0, Degrees::radians),
            tip_cone_angle: (self.tip_cone_angle_deg)
                .or(self.profile_shift_angle_deg)
                .map_or(0.0, Degrees::radians),
            face_width: self.face_width_m,
            addendum: self.addendum_factor.unwrap_or(default.addendum),
            dedendum: self.dedendum_factor.unwrap_or(default.dedendum),
            tip_radius: self.tip_radius_factor.unwrap_or(default.tip_radius),
            thinning: self.thinning_m,
            bore_radius: self.bore_radius_m,
            internal: self.internal.then(|| Internal {
                cutter_teeth: self.cutter_teeth,
                cutter_shift: self.cutter_profile_shift.unwrap_or(0.0),
                tip_circle: self.tip_circle_radius_m,
                root_circle: self.root_circle_radius_m,
                rim_radius: self.rim_radius_m,
            }),
            modifications: Modifications {
                tip_relief: self.tip_relief.as_ref().map(|relief| TipRelief {
                    amount: relief.amount_m,
                    start_radius: relief.start_radius_m,
                    shape: relief.shape.unwrap_or(ReliefShape::Linear),
                }),
                profile_crowning: self.profile_crowning_m,
                lead_crowning: self.lead_crowning_m,
                end_relief: end_reliefs(self.end_relief.as_ref()),
                helix_slope: per_side(self.helix_slope_m.as_ref()),
                twist: per_side(self.twist_m.as_ref()),
                topography,
            },
            deviations,
        }
    }
}

impl RackTable {
    pub(super) fn params(&self) -> RackParams {
        let default = RackParams::default();
        RackParams {
            teeth: self.teeth,
            module: self.module_m,
            pressure_angle: (self.pressure_angle_deg)
                .map_or(default.pressure_angle, Degrees::radians),
            face_width: self.face_width_m,
            addendum: self.addendum_factor.unwrap_or(default.addendum),
            dedendum: self.dedendum_factor.unwrap_or(default.dedendum),
            tip_radius: self.tip_radius_factor.unwrap_or(default.tip_radius),
            thinning: self.thinning_m,
            body_height: self.body_height_m.unwrap_or(1.5 * self.module_m),
            helix_angle: self.helix_angle_deg.map_or(0.0, Degrees::radians),
        }
    }
}
