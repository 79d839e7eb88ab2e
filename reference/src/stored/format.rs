//! The shape of a stored `params.json`, as its generator wrote it; angles in degrees.

use super::{GearData, ImpactParameters, RackData};
use serde::Deserialize;
use std::collections::BTreeMap;

/// What is used of the file.
#[derive(Deserialize)]
pub(super) struct RawParameters {
    case: String,
    pub(super) solver: String,
    element_type: String,
    material: RawMaterial,
    gear_common: RawToothing,
    contact: RawContact,
    time: RawTime,
    initial: RawInitial,
    gear1: GearData,
    gear2: RawSecond,
    pair: Option<RawPair>,
    rack: Option<RawRack>,
    effective_gap_faceted_m: BTreeMap<String, f64>,
}

#[derive(Deserialize)]
struct RawMaterial {
    #[serde(rename = "E_pa")]
    young: f64,
    nu: f64,
    density: f64,
}

#[derive(Deserialize)]
struct RawToothing {
    module_m: f64,
    alpha_deg: f64,
    face_width_m: f64,
    ha_factor: f64,
    hf_factor: f64,
    rack_tip_radius_factor: f64,
}

#[derive(Deserialize)]
struct RawContact {
    penalty_pa_per_m: f64,
    friction: f64,
}

#[derive(Deserialize)]
struct RawTime {
    dt_s: f64,
    hht_alpha: f64,
}

#[derive(Deserialize)]
struct RawInitial {
    omega1_rad_s: f64,
    omega2_rad_s: f64,
    gap_exact_involute_m: f64,
    path_coordinate_s1_m: f64,
}

/// The second body: a gear, or the mesh of a rack.
#[derive(Deserialize)]
#[serde(untagged)]
enum RawSecond {
    Gear(GearData),
    Mesh { mass_mesh_kg: f64 },
}

#[derive(Deserialize)]
struct RawRack {
    teeth: u32,
    reference_line_x_m: f64,
    tooth0_centre_y_m: f64,
    base_fixed: bool,
}

#[derive(Deserialize)]
struct RawPair {
    centre_distance_m: f64,
    working_pressure_angle_deg: f64,
}

impl RawParameters {
    /// The parameters in the crate's own units and names.
    pub(super) fn typed(self) -> Result<ImpactParameters, String> {
        // The pair that touches first has the smallest gap.
        let gap_effective = self
            .effective_gap_faceted_m
            .into_values()
            .min_by(f64::total_cmp)
            .ok_or("effective_gap_faceted_m is empty")?;
        let pressure_angle = self.gear_common.alpha_deg.to_radians();
        let speeds = [self.initial.omega1_rad_s, self.initial.omega2_rad_s];
        let turning = |gear: GearData, speed| GearData { speed, ..gear };
        let mut gears = vec![turning(self.gear1, speeds[0])];
        let (rack, centre_distance, working_pressure_angle) =
            match (self.gear2, self.pair, self.rack) {
                (RawSecond::Gear(gear), Some(pair), None) => {
                    gears.push(turning(gear, speeds[1]));
                    let angle = pair.working_pressure_angle_deg.to_radians();
                    (None, pair.centre_distance_m, angle)
                }
                (RawSecond::Mesh { mass_mesh_kg }, None, Some(rack)) if rack.base_fixed => {
                    let data = RackData {
                        teeth: rack.teeth,
                        mass: mass_mesh_kg,
                        distance: rack.reference_line_x_m,
                        tooth0: rack.tooth0_centre_y_m,
                    };
                    (Some(data), rack.reference_line_x_m, pressure_angle)
                }
                _ => {
                    return Err(
                        "expected a second gear and its pair, or a rack with its base fixed".into(),
                    );
                }
            };
        Ok(ImpactParameters {
            case: self.case,
            element: self.element_type,
            gears,
            rack,
            module: self.gear_common.module_m,
            pressure_angle,
            face_width: self.gear_common.face_width_m,
            addendum: self.gear_common.ha_factor,
            dedendum: self.gear_common.hf_factor,
            tip_radius: self.gear_common.rack_tip_radius_factor,
            young: self.material.young,
            poisson: self.material.nu,
            density: self.material.density,
            penalty: self.contact.penalty_pa_per_m,
            friction: self.contact.friction,
            centre_distance,
            working_pressure_angle,
            path_coordinate: self.initial.path_coordinate_s1_m,
            gap_exact: self.initial.gap_exact_involute_m,
            gap_effective,
            step: self.time.dt_s,
            hht_alpha: self.time.hht_alpha,
        })
    }
}
