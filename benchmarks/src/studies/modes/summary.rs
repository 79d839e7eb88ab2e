//! Terminal summary of a record of `modes`.

use crate::messages::Messages;
use gearbench_reports::modes::{LinearisedState, ModelModes};
use gearbench_reports::numbers::{short, significant};
use gearbench_reports::record::Results;

/// Largest number of modes printed for each model.
const MOST: usize = 12;

/// Prints the state and the lowest modes of each model.
pub fn summarise(messages: &Messages, results: &Results) {
    for v in results.vibrations() {
        messages.print_line(&format!("{}: {}", v.label, state(v)));
        if v.about == LinearisedState::NotFound {
            continue;
        }
        messages.print_line(&format!(
            "{:>14} {:>3} {:>9}  {}",
            "Hz", "x", "damping", "mode"
        ));
        for m in v.modes.iter().take(MOST) {
            let damping = m
                .damping_ratio
                .map_or(String::new(), |z| format!("{} %", short(100.0 * z, 3)));
            messages.print_line(&format!(
                "{:>14} {:>3} {damping:>9}  {}",
                significant(m.frequency_hz, 5),
                m.multiplicity,
                m.name
            ));
        }
        let listed: usize = v.modes.iter().take(MOST).map(|m| m.multiplicity).sum();
        if listed < v.frequencies {
            messages.print_line(&format!(
                "{:>14} {} more, the highest at {} kHz",
                "",
                v.frequencies - listed,
                short(1e-3 * v.highest_hz, 4)
            ));
        }
    }
}

fn state(v: &ModelModes) -> String {
    let forces: Vec<String> = (v.meshes.iter())
        .map(|m| format!("{} {} N", m.name, short(m.force_n, 5)))
        .collect();
    let about = match (v.about, forces.is_empty()) {
        (LinearisedState::NotFound, _) => return v.message.clone(),
        (about, true) => about.to_string(),
        (about, false) => format!("{about}, {}", forces.join(", ")),
    };
    match v.message.is_empty() {
        true => about,
        false => format!("{about}; {}", v.message),
    }
}
