//! Tables of studies as CSV, SI units in the header.

use crate::record::{Results, Run, Study};
use crate::stability::{Cell, Columns, Map};
use crate::steady::Steady;

/// Names that the tables of a record can have.
pub(crate) const FILES: &[&str] = &[
    "truncation.csv",
    "sweep.csv",
    "sweep_cycles.csv",
    "statics.csv",
    "penalty.csv",
    "precision.csv",
    "stability.csv",
    "stability_limits.csv",
    "choice_check.csv",
    "choose.csv",
];

/// The tables of a record: name, text.
pub(crate) fn tables(results: &Results) -> Vec<(String, String)> {
    let mut all: Vec<(String, String)> = Vec::new();
    if results.study == Study::Truncation {
        all.push(("truncation.csv".to_owned(), truncation(results)));
    }
    let steady: Vec<(&Run, &Steady)> = (results.runs.iter())
        .filter_map(|r| Some((r, r.steady.as_ref()?)))
        .collect();
    if !steady.is_empty() {
        all.push(("sweep.csv".to_owned(), sweep(&steady)));
        all.push(("sweep_cycles.csv".to_owned(), cycles(&steady)));
    }
    if results.study == Study::Penalty {
        all.push(("penalty.csv".to_owned(), penalty(results)));
    }
    if results.study == Study::Precision {
        let table = crate::precision_csv::precision(results);
        all.push(("precision.csv".to_owned(), table));
    }
    if !results.maps.is_empty() {
        all.push(("stability.csv".to_owned(), stability(results)));
        all.push(("stability_limits.csv".to_owned(), stability_limits(results)));
    }
    if !results.choices.is_empty() {
        all.push(("choice_check.csv".to_owned(), choices(results)));
    }
    if let Some(text) = crate::choice::csv(results) {
        all.push(("choose.csv".to_owned(), text));
    }
    if !results.statics.is_empty() {
        all.push(("statics.csv".to_owned(), statics(results)));
    }
    all
}

pub(crate) fn write(header: &[&str], rows: impl Iterator<Item = Vec<String>>) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    // Writing to memory cannot fail.
    let _ = writer.write_record(header);
    for row in rows {
        let _ = writer.write_record(row);
    }
    String::from_utf8(writer.into_inner().unwrap_or_default()).unwrap_or_default()
}

/// A number, or nothing where there is none.
pub(crate) fn number(x: Option<f64>) -> String {
    x.filter(|x| x.is_finite())
        .map_or(String::new(), |x| format!("{x:.9e}"))
}

fn truncation(results: &Results) -> String {
    let header = [
        "model",
        "variant",
        "modes",
        "highest_hz",
        "residual",
        "choose",
        "integrator",
        "step_s",
        "status",
        "against",
        "force_l2",
        "peak_force_rel",
        "impulse_rel",
        "wall_s",
        "steps",
        "setup_s",
    ];
    let rows = (results.runs.iter()).flat_map(|r| {
        r.metrics.iter().map(move |m| {
            vec![
                r.model.clone(),
                r.variant.clone().unwrap_or_default(),
                r.modes.map_or(String::new(), |n| n.to_string()),
                number(r.highest_hz),
                r.residual.map_or(String::new(), |b| b.to_string()),
                r.choose.clone().unwrap_or_default(),
                r.integrator.clone(),
                number(r.step),
                r.status.to_string(),
                m.against.clone(),
                number(m.force_l2),
                number(m.peak_force_rel),
                number(m.impulse_rel),
                number(Some(r.wall_s)),
                r.steps.to_string(),
                number(Some(r.setup_s)),
            ]
        })
    });
    write(&header, rows)
}

fn choices(results: &Results) -> String {
    let header = [
        "scene",
        "kind",
        "gears",
        "duration_s",
        "metric",
        "tolerance",
        "reference",
        "reference_error",
        "densest_error",
        "redraws",
        "candidates",
        "failed",
        "cut_short",
        "outcome",
        "chosen",
        "predicted_error",
        "error",
        "predicted_cost_s",
        "cost_s",
        "cheapest",
        "cheapest_error",
        "cheapest_cost_s",
        "cost_ratio",
        "least_error",
        "choosing_s",
        "note",
    ];
    let text = |x: &Option<String>| x.clone().unwrap_or_default();
    let rows = results.choices.iter().map(|s| {
        vec![
            s.scene.clone(),
            s.kind.clone(),
            s.gears.clone(),
            number(Some(s.duration_s)),
            s.metric.to_string(),
            s.tolerance.to_string(),
            s.reference.clone(),
            number(s.reference_error),
            number(s.densest_error),
            s.redraws.to_string(),
            s.candidates.to_string(),
            s.failed.to_string(),
            s.cut_short.to_string(),
            s.outcome.to_string(),
            text(&s.chosen),
            number(s.predicted_error),
            number(s.error),
            number(s.predicted_cost_s),
            number(s.cost_s),
            text(&s.cheapest),
            number(s.cheapest_error),
            number(s.cheapest_cost_s),
            number(s.cost_ratio()),
            number(s.least_error),
            number(s.choosing_s),
            text(&s.note),
        ]
    });
    write(&header, rows)
}

fn penalty(results: &Results) -> String {
    let header = [
        "model",
        "penalty_pa_per_m",
        "hard",
        "status",
        "peak_force_n",
        "impulse_ns",
        "static_transmission_error_m",
        "force_l2_to_hard",
        "peak_force_rel_to_hard",
        "impulse_rel_to_hard",
        "integrator",
        "step_s",
        "wall_s",
    ];
    let rows = results.runs.iter().map(|r| {
        let (own, hard) = (r.metrics.first(), r.against("hard"));
        vec![
            r.model_label(),
            number(r.penalty_pa_per_m),
            r.hard.unwrap_or(false).to_string(),
            r.status.to_string(),
            number(own.and_then(|m| m.peak_force_n)),
            number(own.and_then(|m| m.impulse_ns)),
            number(r.static_error_m),
            number(hard.and_then(|m| m.force_l2)),
            number(hard.and_then(|m| m.peak_force_rel)),
            number(hard.and_then(|m| m.impulse_rel)),
            r.integrator.clone(),
            number(r.step),
            number(Some(r.wall_s)),
        ]
    });
    write(&header, rows)
}

/// One line per run of a map; runs that close in on the largest stable step follow the cells of their map.
fn stability(results: &Results) -> String {
    let header = [
        "set",
        "model",
        "variant",
        "integrator",
        "axis_1",
        "value_1",
        "axis_2",
        "value_2",
        "step_s",
        "rtol",
        "closing_in",
        "status",
        "error",
        "energy_rel",
        "reached_s",
        "steps",
        "rejected",
        "force_evaluations",
        "newton_iterations",
        "message",
    ];
    let line = |map: &Map, row: usize, cell: &Cell, closing_in: bool| {
        let values = map.values(row);
        let axis = |i: usize| map.axes.get(i).map_or(String::new(), |a| a.id.clone());
        let at = |columns: Columns| number((map.columns == columns).then_some(cell.at));
        vec![
            (map.set + 1).to_string(),
            map.model.clone(),
            map.variant.clone().unwrap_or_default(),
            map.integrator.clone(),
            axis(0),
            number(values.first().copied()),
            axis(1),
            number(values.get(1).copied()),
            at(Columns::Step),
            at(Columns::Tolerance),
            closing_in.to_string(),
            cell.status.to_string(),
            number(cell.error),
            number(cell.energy_rel),
            number(cell.reached_s),
            cell.steps.to_string(),
            cell.rejected.to_string(),
            cell.force_evaluations.to_string(),
            cell.newton_iterations.to_string(),
            cell.message.clone().unwrap_or_default(),
        ]
    };
    let rows = results.maps.iter().flat_map(|map| {
        let columns = map.at.len().max(1);
        let cells = map.cells.iter().enumerate();
        let cells = cells.map(move |(i, c)| line(map, i / columns, c, false));
        let own = map.own_row();
        cells.chain(map.refined.iter().map(move |c| line(map, own, c, true)))
    });
    write(&header, rows)
}

/// The largest stable step of every map at the scene's own parameters.
fn stability_limits(results: &Results) -> String {
    let header = [
        "set",
        "model",
        "variant",
        "integrator",
        "largest_stable_s",
        "next_unstable_s",
        "failing_with",
        "holds_again_beyond",
        "largest_accurate_s",
        "contact_pulls_from_s",
        "theory_s",
        "theory",
        "ratio",
    ];
    let rows = results.maps.iter().filter_map(|map| {
        let limit = map.limit()?;
        let theory = map.theory(map.own_row());
        Some(vec![
            (map.set + 1).to_string(),
            map.model.clone(),
            map.variant.clone().unwrap_or_default(),
            map.integrator.clone(),
            number(limit.stable_s),
            number(limit.unstable_s),
            limit.status.map_or(String::new(), |s| s.to_string()),
            limit.holds_again.to_string(),
            number(limit.accurate_s),
            number(limit.pulls_from_s),
            number(theory.map(|t| t.0)),
            theory.map_or(String::new(), |t| t.1.to_owned()),
            number(map.ratio()),
        ])
    });
    write(&header, rows)
}

fn sweep(runs: &[(&Run, &Steady)]) -> String {
    let harmonics = (runs.iter())
        .map(|(_, s)| s.error_harmonics_m.len())
        .max()
        .unwrap_or(0);
    let gears: Vec<&str> = (runs[0].1.bearings.iter())
        .map(|b| b.gear.as_str())
        .collect();
    let mut header: Vec<String> = [
        "model",
        "status",
        "mesh_frequency_hz",
        "speed_rad_s",
        "cycles",
        "transmission_error_mean_m",
        "transmission_error_rms_m",
        "transmission_error_peak_to_peak_m",
        "force_mean_n",
        "force_peak_n",
        "separated",
        "irregular",
    ]
    .map(String::from)
    .to_vec();
    header.extend((1..=harmonics).map(|k| format!("transmission_error_{k}_m")));
    for g in &gears {
        header.push(format!("bearing_{g}_mean_n"));
        header.push(format!("bearing_{g}_rms_n"));
        header.extend((1..=harmonics).map(|k| format!("bearing_{g}_{k}_n")));
    }
    let header: Vec<&str> = header.iter().map(String::as_str).collect();
    let rows = runs.iter().map(|(r, s)| {
        let mut row = vec![r.model_label(), r.status.to_string()];
        row.extend(
            [
                s.mesh_frequency_hz,
                s.speed_rad_s,
                s.cycles as f64,
                s.error_mean_m,
                s.error_rms_m,
                s.error_peak_to_peak_m,
                s.force_mean_n,
                s.force_peak_n,
                s.separated,
                s.irregular,
            ]
            .map(|x| number(Some(x))),
        );
        row.extend((0..harmonics).map(|k| number(s.error_harmonics_m.get(k).copied())));
        for g in &gears {
            let b = s.bearings.iter().find(|b| b.gear == *g);
            row.push(number(b.map(|b| b.mean_n)));
            row.push(number(b.map(|b| b.rms_n)));
            row.extend(
                (0..harmonics).map(|k| number(b.and_then(|b| b.harmonics_n.get(k).copied()))),
            );
        }
        row
    });
    write(&header, rows)
}

fn cycles(runs: &[(&Run, &Steady)]) -> String {
    let header = [
        "model",
        "mesh_frequency_hz",
        "position_base_pitches",
        "transmission_error_m",
        "contact_force_n",
    ];
    let rows = runs.iter().flat_map(|(r, s)| {
        (0..s.position.len()).map(move |i| {
            vec![
                r.model_label(),
                number(Some(s.mesh_frequency_hz)),
                number(Some(s.position[i])),
                number(s.error_cycle_m.get(i).copied()),
                number(s.force_cycle_n.get(i).copied()),
            ]
        })
    });
    write(&header, rows)
}

fn statics(results: &Results) -> String {
    let header = [
        "model",
        "force_n",
        "position_base_pitches",
        "transmission_error_m",
    ];
    let rows = results.statics.iter().flat_map(|s| {
        (s.position.iter().zip(&s.error_m)).map(move |(p, e)| {
            vec![
                s.label.clone(),
                number(Some(s.force_n)),
                number(Some(*p)),
                number(Some(*e)),
            ]
        })
    });
    write(&header, rows)
}
