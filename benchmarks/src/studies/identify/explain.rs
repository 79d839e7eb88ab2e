//! What the data do not tell apart, in words.

use super::chosen::Chosen;
use super::estimate::Estimate;
use super::estimate::identifiable::Weak;
use super::parameters::Parameter;
use super::plan::{Data, DataSet};
use crate::scene_file::calibration::{CURVATURE, DAMPING, GAP, SLOPE, STIFFNESS};

/// Keys of the springs and dampers of teeth.
const TOOTH_STIFFNESS: &str = "tooth_stiffness_n_per_m";
const TOOTH_MASS: &str = "tooth_mass_kg";

/// One sentence per combination that is not determined, without its full stop.
pub fn undetermined(estimate: &Estimate, chosen: &Chosen, data: &[DataSet]) -> Vec<String> {
    let told = |w: &Weak| {
        let members: Vec<&Parameter> = (w.members().into_iter())
            .map(|j| &chosen.parameters[j])
            .collect();
        let names: Vec<String> = members.iter().map(|p| p.name(data)).collect();
        let has = |key: &str| members.iter().any(|p| p.is(key));
        let only = |keys: &[&str]| members.len() == keys.len() && keys.iter().all(|k| has(k));
        let clock = members.iter().any(|p| matches!(p, Parameter::Clock(_)));
        let at_rest = data.iter().all(|d| matches!(d.data, Data::Statics(_)));
        let why = if only(&[STIFFNESS, TOOTH_STIFFNESS]) {
            "they act in series, only the sum of their compliances is determined"
        } else if clock && has(GAP) {
            "both shift the force in time alike"
        } else if has(SLOPE) || has(CURVATURE) {
            "the flanks touch on too little of the path, or on too much of it at once"
        } else if members.len() > 1 {
            "the data determine only a combination of them"
        } else if at_rest && !has(STIFFNESS) && !has(TOOTH_STIFFNESS) {
            "gears at rest do not depend on it"
        } else if has(TOOTH_MASS) {
            "the force is too slow for a tooth to swing on its spring"
        } else if has(GAP) {
            "nothing in the data says when the flanks touch"
        } else if has(DAMPING) {
            "the data lose no energy that would tell it"
        } else {
            "the data hardly change with it"
        };
        let subject = match names.as_slice() {
            [one] => format!("{one} is not determined"),
            _ => format!("{} cannot be told apart", join(&names)),
        };
        let way_out = match names.as_slice() {
            [_] => "hold it with --hold",
            _ => "hold one with --hold",
        };
        format!("{subject}: {why}; {way_out}, or add data that tell")
    };
    let mut all: Vec<String> = estimate.weak.iter().map(told).collect();
    all.dedup();
    for (j, profile) in estimate.profiles.iter().enumerate() {
        let open = (profile.as_ref()).filter(|p| p.is_open(&chosen.coordinates[j]));
        let Some([low, high]) = open.map(|p| p.interval) else {
            continue;
        };
        let name = chosen.parameters[j].name(data);
        let value = |z: f64| chosen.coordinates[j].value(z);
        let bound = match (low.is_finite(), high.is_finite()) {
            (true, _) => format!("the data bound it from below alone, at {:.3e}", value(low)),
            (_, true) => format!("the data bound it from above alone, at {:.3e}", value(high)),
            _ => "the data bound it to neither side".into(),
        };
        all.push(format!(
            "{name} is not determined: {bound}; hold it with --hold, or add data that depend on it"
        ));
    }
    all
}

fn join(names: &[String]) -> String {
    match names {
        [rest @ .., last] if !rest.is_empty() => format!("{} and {last}", rest.join(", ")),
        _ => names.concat(),
    }
}
