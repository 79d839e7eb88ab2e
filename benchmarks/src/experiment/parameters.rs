//! Model and contact parameters of a run for its record.

use gearbench_models::spec::{
    ContactSpec, FlankContact, Modelling, PointContact, PointRule, SceneSpec,
};
use gearbench_models::stiffness::PairStiffness;
use serde_json::Value;
use std::collections::BTreeMap;

/// Parameters of all gears by their names, and of the contacts by those of their gears.
pub fn parameters(
    scene: &SceneSpec,
    modelling: &Modelling,
) -> BTreeMap<String, BTreeMap<String, Value>> {
    let mut all: BTreeMap<String, BTreeMap<String, Value>> = (scene.gears.iter())
        .zip(&modelling.gears)
        .map(|(gear, model)| {
            // Numbers are floats, whatever the model counts.
            let values = model.values().into_iter();
            let values = values.map(|(key, x)| (key, x.as_f64().map_or(x, Value::from)));
            (gear.name.clone(), values.collect())
        })
        .filter(|(_, values): &(_, BTreeMap<_, _>)| !values.is_empty())
        .collect();
    for (mesh, contact) in scene.meshes.iter().zip(&modelling.contacts) {
        let [a, b] = scene.names_of(mesh.gears);
        let values = numbers(contact, mesh.start.gap);
        let values = values.map(|(key, x)| (key.to_owned(), Value::from(x)));
        all.insert(format!("contact {a} - {b}"), values.collect());
    }
    all
}

/// Numeric parameters of a contact, under the keys of scenes.
fn numbers(contact: &ContactSpec, gap: f64) -> impl Iterator<Item = (&'static str, f64)> {
    let pair = match contact.stiffness {
        _ if contact.flanks != FlankContact::Toothing => None,
        PairStiffness::Constant { per_width, .. } => Some((per_width, None)),
        PairStiffness::Parabola {
            per_width, along, ..
        } => Some((per_width, Some(along))),
        _ => None,
    };
    let along = pair.and_then(|p| p.1);
    let points = contact.flanks.points();
    let penalty = points.and_then(PointContact::penalty);
    let key = match points.map(|p| p.rule) {
        Some(PointRule::EachNode) => "penalty_n_per_m",
        _ => "penalty_pa_per_m",
    };
    [
        ("gap_m", Some(gap)),
        (
            "exponent",
            (contact.normal_force.is_none()).then_some(contact.exponent),
        ),
        ("stiffness_n_per_m2", pair.map(|p| p.0)),
        ("path_slope", along.map(|a| a[0])),
        ("path_curvature", along.map(|a| a[1])),
        (key, penalty.map(|[stiffness, _]| stiffness)),
        (
            "damping_ns_per_m3",
            points.map(|_| penalty.map_or(0.0, |[_, dashpot]| dashpot)),
        ),
    ]
    .into_iter()
    .filter_map(|(key, x)| Some((key, x?)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::context::Context;
    use crate::scene_file::{Selection, load_for};

    /// Tooth stiffness and mass are in the record with all their digits.
    #[test]
    fn constants_of_teeth_are_numbers() {
        let scene = load_for(&Context::default(), "spur_impact", Selection::None).unwrap();
        let choice = scene.model("movable-teeth").unwrap();
        let spec = scene.spec_for(choice);
        let all = parameters(&spec, &choice.modelling);
        let fitted = choice.calibration.as_ref().unwrap();
        let constants = fitted.constants.as_ref().unwrap();
        assert!(!constants.parameters.is_empty());
        for (key, x) in &constants.parameters {
            assert_eq!(all[&spec.gears[0].name][key].as_f64(), Some(*x), "{key}");
        }
        let contact = &all["contact pinion - wheel"];
        assert_eq!(contact["stiffness_n_per_m2"].as_f64(), constants.stiffness);
        assert_eq!(contact["gap_m"].as_f64(), constants.gap);
    }
}
