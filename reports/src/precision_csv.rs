//! The table of accuracy against cost.

use crate::precision::{Cloud, Cost, Precision, SELF, Shown};
use crate::record::{Metrics, Results, Run};
use crate::study_csv::{number, write};

/// One line per run and reference.
pub(crate) fn precision(results: &Results) -> String {
    let header = [
        "model",
        "modes",
        "integrator",
        "step_s",
        "rtol",
        "status",
        "fitted_to",
        "against",
        "on_front",
        "force_l2",
        "force_l2_aligned",
        "peak_force_rel",
        "impulse_rel",
        "rebound_rel",
        "transmission_error_l2",
        "energy_drift_rel",
        "wall_s",
        "wall_min_s",
        "wall_max_s",
        "repeats",
        "setup_s",
        "steps",
        "rejected",
        "force_evaluations",
        "newton_iterations",
        "factorisations",
        "dofs",
        "message",
    ];
    let told = Precision::of(results);
    let clouds: Vec<Cloud<'_>> = (told.references.iter().map(String::as_str))
        .chain([SELF])
        .map(|id| told.cloud(id, told.headline(), Cost::Wall))
        .collect();
    // The front of each reference, of the model's own converged solution that of each model.
    let on_front = |r: &Run, against: &str| {
        let own = |s: &Shown<'_>| against != SELF || s.run.model_label() == r.model_label();
        let Some(cloud) = clouds.iter().find(|c| c.against == against) else {
            return false;
        };
        let front = cloud.front(own);
        front.iter().any(|i| std::ptr::eq(cloud.shown[*i].run, r))
    };
    let rows = results.runs.iter().flat_map(|r| {
        let none = [Metrics::default()];
        let metrics = if r.metrics.is_empty() {
            none.to_vec()
        } else {
            r.metrics.clone()
        };
        let rows: Vec<Vec<String>> = (metrics.iter())
            .map(|m| {
                let mut row = vec![
                    r.model_label(),
                    r.modes.map_or(String::new(), |n| n.to_string()),
                    r.integrator.clone(),
                    number(r.step),
                    number(r.rtol),
                    r.status.to_string(),
                    r.fitted_to.clone().unwrap_or_default(),
                    m.against.clone(),
                    on_front(r, &m.against).to_string(),
                ];
                let errors = [
                    m.force_l2,
                    m.force_l2_aligned,
                    m.peak_force_rel,
                    m.impulse_rel,
                    m.rebound_rel,
                    m.transmission_error_l2,
                    m.energy_drift_rel,
                ];
                row.extend(errors.map(number));
                row.extend([
                    number(Some(r.wall_s)),
                    number(r.wall_spread_s.map(|s| s[0])),
                    number(r.wall_spread_s.map(|s| s[1])),
                    r.repeats.to_string(),
                    number(Some(r.setup_s)),
                ]);
                let work = [
                    r.steps,
                    r.rejected,
                    r.force_evaluations,
                    r.newton_iterations,
                    r.factorisations,
                    r.dofs as u64,
                ];
                row.extend(work.map(|n| n.to_string()));
                row.push(r.message.clone().unwrap_or_default());
                row
            })
            .collect();
        rows
    });
    write(&header, rows)
}
