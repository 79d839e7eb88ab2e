//! Theoretical limits as lines over the rows of a map.
//!
//! A scene is linearised once per model and row; all integrators of the model get their lines from it.

use super::plan::Plan;
use super::setup::Setup;
use crate::experiment::key::Key;
use crate::studies::stability::limits::{Linearised, StepLine};
use gearbench_reports::record::finite;
use gearbench_reports::stability::{Columns, MapLine};

/// The lines of all maps that share their converged solutions with map `first` (one model over one set of axes), by
/// place in the plan. A row that cannot be linearised has no lines.
pub fn lines(plan: &Plan, maps: &[usize]) -> Vec<(usize, Vec<MapLine>)> {
    let mut all: Vec<(usize, Vec<MapLine>)> = maps.iter().map(|m| (*m, Vec::new())).collect();
    let mut linearised: Vec<(Key, Option<Linearised>)> = Vec::new();
    for (m, lines) in &mut all {
        let map = &plan.maps[*m];
        if map.columns != Columns::Step {
            continue;
        }
        for row in 0..map.rows() {
            let Ok(setup) = plan.setup(map, row) else {
                continue;
            };
            let key = Key::new("linearised").and_scene(&setup.scene, &setup.modelling);
            let at = match linearised.iter().position(|f| f.0 == key) {
                Some(at) => at,
                None => {
                    linearised.push((key, linearise(plan, &setup)));
                    linearised.len() - 1
                }
            };
            if let Some(scene) = &mut linearised[at].1
                && let Ok(found) = scene.lines(setup.method)
            {
                for line in found {
                    push_line(lines, (row, map.rows()), line);
                }
            }
        }
    }
    all
}

fn linearise(plan: &Plan, setup: &Setup) -> Option<Linearised> {
    Linearised::new(
        &setup.scene,
        &setup.modelling,
        &plan.conditions.context.models,
    )
    .ok()
}

/// Puts the step of one row into the line with its label.
fn push_line(lines: &mut Vec<MapLine>, (row, rows): (usize, usize), step: StepLine) {
    let at = (lines.iter().position(|l| l.label == step.label)).unwrap_or_else(|| {
        lines.push(MapLine {
            label: step.label,
            kind: step.kind,
            step_s: vec![None; rows],
        });
        lines.len() - 1
    });
    lines[at].step_s[row] = finite(step.step_s);
}

/// Returns the indices of maps that share their linearised scenes.
pub fn shared(plan: &Plan) -> Vec<Vec<usize>> {
    let mut found: Vec<Vec<usize>> = Vec::new();
    for (m, map) in plan.maps.iter().enumerate() {
        let same = |group: &&mut Vec<usize>| {
            let first = &plan.maps[group[0]];
            (first.set, first.entry) == (map.set, map.entry)
        };
        match found.iter_mut().find(same) {
            Some(group) => group.push(m),
            None => found.push(vec![m]),
        }
    }
    found
}
