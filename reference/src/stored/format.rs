//! The shape of a stored `params.json`, as its generator wrote it; angles in degrees.

use super::{GearData, ImpactParameters, RackData};
use serde_json::Value;

/// Reads the solver, and the parameters of its results in the units and names of this crate.
pub(super) fn read(text: &str) -> Result<(String, ImpactParameters), String> {
    let raw: Value = serde_json::from_str(text).map_err(|e| e.to_string())?;
    let at = |path: &str| raw.pointer(path).ok_or(format!("{path} is missing"));
    let number = |path: &str| at(path)?.as_f64().ok_or(format!("{path} is no number"));
    let word = |path: &str| match at(path)?.as_str() {
        Some(word) => Ok(word.to_owned()),
        None => Err(format!("{path} is no text")),
    };
    let gear = |path: &str, speed: &str| {
        let gear: GearData =
            serde_json::from_value(at(path)?.clone()).map_err(|e| format!("{path}: {e}"))?;
        let speed = number(speed)?;
        Ok::<_, String>(GearData { speed, ..gear })
    };
    // The pair that touches first has the smallest gap.
    let gaps = at("/effective_gap_faceted_m")?.as_object().into_iter();
    let gaps = gaps.flat_map(|g| g.values().filter_map(Value::as_f64));
    let gap_effective = gaps
        .min_by(f64::total_cmp)
        .ok_or("effective_gap_faceted_m is empty")?;
    let pressure_angle = number("/gear_common/alpha_deg")?.to_radians();
    let mut gears = vec![gear("/gear1", "/initial/omega1_rad_s")?];
    let held = raw.pointer("/rack/base_fixed").and_then(Value::as_bool);
    let (rack, centre_distance, working_pressure_angle) = match (raw.get("pair"), held) {
        (Some(_), None) => {
            gears.push(gear("/gear2", "/initial/omega2_rad_s")?);
            let angle = number("/pair/working_pressure_angle_deg")?;
            (None, number("/pair/centre_distance_m")?, angle.to_radians())
        }
        (None, Some(true)) => {
            let rack = RackData {
                teeth: number("/rack/teeth")? as u32,
                mass: number("/gear2/mass_mesh_kg")?,
                distance: number("/rack/reference_line_x_m")?,
            };
            let distance = rack.distance;
            (Some(rack), distance, pressure_angle)
        }
        _ => {
            return Err(
                "expected a second gear and its pair, or a rack with its base fixed".into(),
            );
        }
    };
    let parameters = ImpactParameters {
        case: word("/case")?,
        element: word("/element_type")?,
        gears,
        rack,
        module: number("/gear_common/module_m")?,
        pressure_angle,
        face_width: number("/gear_common/face_width_m")?,
        addendum: number("/gear_common/ha_factor")?,
        dedendum: number("/gear_common/hf_factor")?,
        tip_radius: number("/gear_common/rack_tip_radius_factor")?,
        young: number("/material/E_pa")?,
        poisson: number("/material/nu")?,
        density: number("/material/density")?,
        penalty: number("/contact/penalty_pa_per_m")?,
        friction: number("/contact/friction")?,
        centre_distance,
        working_pressure_angle,
        path_coordinate: number("/initial/path_coordinate_s1_m")?,
        gap_exact: number("/initial/gap_exact_involute_m")?,
        gap_effective,
        step: number("/time/dt_s")?,
        hht_alpha: number("/time/hht_alpha")?,
    };
    Ok((word("/solver")?, parameters))
}
