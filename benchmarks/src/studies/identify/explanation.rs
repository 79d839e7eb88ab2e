//! Explanations, in words, of the parameter combinations that the data do not determine.

use super::estimate::Estimate;
use super::estimate::identifiability::UndeterminedCombination;
use super::fit_parameters::FitParameters;
use super::parameters::Parameter;
use super::plan::{Data, DataSet};
use crate::scene_file::calibration::{CURVATURE, DAMPING, GAP, SLOPE, STIFFNESS};

/// Keys of the springs and dampers of teeth.
const TOOTH_STIFFNESS: &str = "tooth_stiffness_n_per_m";
const TOOTH_MASS: &str = "tooth_mass_kg";

/// Returns one sentence per combination that is not determined, without its full stop.
pub fn undetermined(estimate: &Estimate, chosen: &FitParameters, data: &[DataSet]) -> Vec<String> {
    let told = |w: &UndeterminedCombination| {
        let members: Vec<&Parameter> = (w.members().into_iter())
            .map(|j| &chosen.parameters[j])
            .collect();
        let names: Vec<String> = members.iter().map(|p| p.name(data)).collect();
        let has = |key: &str| members.iter().any(|p| p.is(key));
        let only = |keys: &[&str]| members.len() == keys.len() && keys.iter().all(|k| has(k));
        let clock = members.iter().any(|p| matches!(p, Parameter::Clock(_)));
        let scale = members
            .iter()
            .any(|p| matches!(p, Parameter::ClockScale(_)));
        let at_rest = data.iter().all(|d| matches!(d.data, Data::Statics(_)));
        let why = if only(&[STIFFNESS, TOOTH_STIFFNESS]) {
            "they act in series, so that the data determine only the sum of their compliances"
        } else if clock && has(GAP) {
            "both shift the force in time in the same way"
        } else if scale && members.len() == 1 {
            "the data are too short, or have too few features, for the rate of their clock"
        } else if has(SLOPE) || has(CURVATURE) {
            "the contacts cover too little of the path of contact, or too much of it at the same time"
        } else if members.len() > 1 {
            "the data determine only a combination of them"
        } else if at_rest && !has(STIFFNESS) && !has(TOOTH_STIFFNESS) {
            "gears at rest do not depend on it"
        } else if has(TOOTH_MASS) {
            "the force changes too slowly to excite the vibration of a tooth on its spring"
        } else if has(GAP) {
            "the data do not determine the time at which the flanks touch"
        } else if has(DAMPING) {
            "the data contain no loss of energy that depends on it"
        } else {
            "it has hardly any influence on the data"
        };
        let subject = match names.as_slice() {
            [one] => format!("{one} is not determined"),
            _ => format!("{} cannot be determined separately", join(&names)),
        };
        let way_out = match names.as_slice() {
            [_] => "fix it with --hold",
            _ => "fix one with --hold",
        };
        format!("{subject}: {why}; {way_out}, or add data")
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
            (true, _) => format!("the data give only a lower bound, {:.3e}", value(low)),
            (_, true) => format!("the data give only an upper bound, {:.3e}", value(high)),
            _ => "the data give no bounds".into(),
        };
        all.push(format!(
            "{name} is not determined: {bound}; fix it with --hold, or add data that depend on it"
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
