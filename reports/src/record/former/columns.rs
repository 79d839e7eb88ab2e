//! Columns without names of gears: of a former record these are those of the first mesh and of the first two gears.
//!
//! A former series has the keys `contact_force_n`, `omega1_rad_s` and `omega2_rad_s` besides its `columns`, metrics have
//! `omega1_end` and `omega2_end`. The names of the gears are those of the pictures of the mesh, else those of the angles of
//! the hubs; the first mesh is the first of the forces or of the torque paths by mesh, else that of the first two gears.
//! Where a record has no names, they are `gear_1` and `gear_2`.

use crate::series::{CONTACT_FORCE, NUMBERED_SPEEDS, OF_MESHES, SPEED};
use serde_json::{Map, Value, json};

/// Keys of the last speeds of the first two gears in former metrics.
const LAST_SPEEDS: [&str; 2] = ["omega1_end", "omega2_end"];
/// Key of the contact force of the first mesh in a former series.
const FORCE: &str = "contact_force_n";

/// Former name of the transverse part of a contact force, and its name.
const TRANSVERSE: [&str; 2] = ["contact_force_transverse", "transverse_force"];

/// True if a text may be a record with such columns.
pub fn may_be_former(text: &str) -> bool {
    let is_key = |key: &str| text.contains(&format!("\"{key}\":"));
    NUMBERED_SPEEDS
        .iter()
        .chain(&LAST_SPEEDS)
        .any(|key| is_key(key))
        || is_key(FORCE)
}

/// Names of gears of a record.
struct Names {
    gears: Vec<String>,
    /// Names of both gears of the first mesh with `_` between them.
    mesh: String,
}

/// Names the columns of a record after their gears, and returns the names of its gears; `None` if no column has to be
/// named.
pub fn upgrade(record: &mut Value) -> Option<Vec<String>> {
    let names = Names::of(record);
    walk(record, &names).then_some(names.gears)
}

impl Names {
    fn of(record: &Value) -> Self {
        let entries = |key: &str| record[key].as_array().into_iter().flatten();
        let runs = || entries("runs");
        let text = |v: &Value| v.as_str().map(str::to_owned);
        let list = |v: &Value, name: &dyn Fn(&Value) -> Option<String>| -> Vec<String> {
            v.as_array()
                .into_iter()
                .flatten()
                .filter_map(name)
                .collect()
        };
        let outlines = |r: &Value| list(&r["contacts"]["outlines"], &|o| text(&o["gear"]));
        let hub = |c: &Value| {
            let name = c["name"].as_str()?;
            let angle = name
                .strip_prefix("hub_angle_")
                .map(|n| n.strip_suffix("_rad"));
            let way = || {
                name.strip_prefix("hub_displacement_")
                    .map(|n| n.strip_suffix("_m"))
            };
            angle.or_else(way)?.map(str::to_owned)
        };
        let hubs = |r: &Value| list(&r["series"]["columns"], &hub);
        let with_series = ["runs", "references", "histories"].into_iter();
        let mut all = (runs().map(outlines)).chain(with_series.flat_map(entries).map(hubs));
        let mut gears = all.find(|names| names.len() > 1).unwrap_or_default();
        for g in gears.len()..2 {
            gears.push(format!("gear_{}", g + 1));
        }
        let first = |meshes: &Value| list(&meshes[0]["gears"], &text);
        let mut meshes =
            runs().flat_map(|r| [first(&r["mesh_forces"]), first(&r["paths"]["meshes"])]);
        let mesh = meshes.find(|names| names.len() == 2);
        let mesh = mesh.unwrap_or_else(|| gears[..2].to_vec()).join("_");
        Self { gears, mesh }
    }

    /// Returns the name of a column of a former series.
    fn column(&self, former: &str) -> String {
        let name = match former.strip_prefix(TRANSVERSE[0]) {
            Some(rest) => format!("{}{rest}", TRANSVERSE[1]),
            None => former.to_owned(),
        };
        let of_first = OF_MESHES.iter().find(|q| q.without_gears() == name);
        of_first.map_or(name, |q| q.of(&self.mesh))
    }

    /// Converts a former series; false if the object is none.
    fn series(&self, object: &mut Map<String, Value>) -> bool {
        let keys = [
            (FORCE, CONTACT_FORCE.of(&self.mesh)),
            (NUMBERED_SPEEDS[0], SPEED.of(&self.gears[0])),
            (NUMBERED_SPEEDS[1], SPEED.of(&self.gears[1])),
        ];
        if !object.contains_key("time_s") || !keys.iter().any(|(k, _)| object.contains_key(*k)) {
            return false;
        }
        let samples = object["time_s"].as_array().map_or(0, Vec::len);
        let mut columns = Vec::new();
        for (key, name) in keys {
            let values = object.remove(key).unwrap_or_default();
            // A history that a reference does not have was empty.
            let has = values.as_array().is_some_and(|v| !v.is_empty());
            if has || (samples == 0 && values.is_array()) {
                columns.push(json!({"name": name, "values": values}));
            }
        }
        if let Some(Value::Array(others)) = object.remove("columns") {
            columns.extend(others.into_iter().map(|mut c| {
                if let Some(name) = c["name"].as_str() {
                    c["name"] = self.column(name).into();
                }
                c
            }));
        }
        object.insert("columns".into(), columns.into());
        true
    }

    /// Converts former metrics; false if the object has none.
    fn metrics(&self, object: &mut Map<String, Value>) -> bool {
        if !object.contains_key("against") {
            return false;
        }
        let mut speeds = Map::new();
        for (key, gear) in LAST_SPEEDS.iter().zip(&self.gears) {
            if let Some(speed) = object.remove(*key) {
                speeds.insert(gear.clone(), speed);
            }
        }
        let found = !speeds.is_empty();
        if found {
            object.insert("speeds_end".into(), speeds.into());
        }
        found
    }
}

/// Converts all series and metrics of a value; false if there are none to convert.
fn walk(value: &mut Value, names: &Names) -> bool {
    match value {
        Value::Object(object) => {
            let own = [names.series(object), names.metrics(object)].contains(&true);
            let parts = object.values_mut().map(|v| walk(v, names));
            parts.fold(own, |any, part| any | part)
        }
        Value::Array(all) => {
            let parts = all.iter_mut().map(|v| walk(v, names));
            parts.fold(false, |any, part| any | part)
        }
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names_of(series: &Value) -> Vec<&str> {
        let columns = series["columns"].as_array().into_iter().flatten();
        columns.filter_map(|c| c["name"].as_str()).collect()
    }

    /// The gears of a record without names have numbers; a history that a reference does not have is no column.
    #[test]
    fn gears_without_names_have_numbers() {
        let mut record = json!({
            "runs": [{
                "series": {"time_s": [0.0], "contact_force_n": [1.0], "omega1_rad_s": [2.0], "omega2_rad_s": [3.0]},
                "metrics": [{"against": "self", "omega1_end": 2.0}, {"against": "fe"}],
            }],
            "references": [{
                "series": {"time_s": [0.0], "contact_force_n": [], "omega1_rad_s": [], "omega2_rad_s": [3.0]},
            }],
        });
        assert!(may_be_former(&record.to_string()));
        assert_eq!(upgrade(&mut record).unwrap(), ["gear_1", "gear_2"]);
        let all = [
            "contact_force_gear_1_gear_2_n",
            "speed_gear_1_rad_s",
            "speed_gear_2_rad_s",
        ];
        assert_eq!(names_of(&record["runs"][0]["series"]), all);
        assert_eq!(names_of(&record["references"][0]["series"]), all[2..]);
        let metrics = &record["runs"][0]["metrics"];
        let wanted = json!([{"against": "self", "speeds_end": {"gear_1": 2.0}}, {"against": "fe"}]);
        assert_eq!(metrics, &wanted);
        assert!(upgrade(&mut record).is_none() && !may_be_former(&record.to_string()));
    }

    /// Histories of an identification have the names of their hubs.
    #[test]
    fn hubs_have_the_names_of_gears() {
        let hub = |name: &str| json!({"name": name, "values": [0.0]});
        let columns = [
            hub("hub_angle_pinion_rad"),
            hub("hub_displacement_rack_m"),
            hub("mesh_cycle"),
        ];
        let mut record = json!({"histories": [{
            "series": {"time_s": [0.0], "contact_force_n": [1.0], "omega1_rad_s": [2.0], "omega2_rad_s": [3.0], "columns": columns},
        }]});
        assert_eq!(upgrade(&mut record).unwrap(), ["pinion", "rack"]);
        let names = names_of(&record["histories"][0]["series"]);
        assert_eq!(
            names[..2],
            ["contact_force_pinion_rack_n", "speed_pinion_rad_s"]
        );
        assert_eq!(names[5], "mesh_cycle_pinion_rack");
    }
}
