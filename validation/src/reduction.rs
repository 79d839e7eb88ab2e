//! Elastic gears held against full finite elements on the same mesh and contact, on random scenes: does every run end,
//! and what do the modes that are cut cost?
//!
//! An impact is run whole at a 500th of its length, running under load for a mesh cycle at the shorter of its 500th and a
//! 100th of an impact. Full finite elements take Newmark's method, elastic gears with 150 modes the trigonometric one, at
//! the same step.

use crate::sampling::{Set, sample};
use crate::validate::{ValidationError, grid, outcome};
use gearbench::studies::choose::plan::{elastic, full};
use gearbench::studies::choose::problem::Problem;
use gearbench_integrators::table::{NEWMARK, TRIGONOMETRIC};
use gearbench_models::spec::{Body, mesh_layout};
use gearbench_reports::Metric;
use std::fmt::Write as _;

/// Modes of each elastic gear.
const MODES: usize = 150;
/// Steps of a mesh cycle, and of an impact; least steps of an impact within a mesh cycle.
const STEPS: f64 = 500.0;
/// See [`STEPS`].
const RESOLVED: f64 = 100.0;
/// Greatest error of the force history that the reduction may have.
pub const LIMIT: f64 = 0.01;

/// What a scene said.
#[derive(Clone, Debug)]
pub struct Row {
    pub scene: String,
    pub kind: String,
    pub duration_s: f64,
    pub step_s: f64,
    /// How the runs of finite elements and of elastic gears ended.
    pub status: [String; 2],
    /// Error of the force history in L2, where both ended.
    pub error: Option<f64>,
    /// Energy that either run made up, over that at the start.
    pub residual: [Option<f64>; 2],
}

impl Row {
    /// Both runs ended.
    pub fn ended(&self) -> bool {
        self.error.is_some()
    }

    /// The reduction costs no more than it may.
    pub fn is_within(&self) -> bool {
        self.error.is_some_and(|e| e <= LIMIT)
    }
}

/// Runs a scene of a set both ways.
///
/// # Errors
/// [`ValidationError`]: a sampling that fails, a run that cannot start.
pub fn compare(set: &Set, number: usize) -> Result<Row, ValidationError> {
    let sample = sample(set, number)?;
    let mut problem = Problem::of(&sample.scene);
    let mut step = sample.contact_time / STEPS;
    if let Some(cycle) = mesh_cycle(&problem) {
        problem.duration = problem.duration.min(cycle);
        step = (cycle / STEPS).min(sample.contact_time / RESOLVED);
    }
    let times = grid(problem.duration, sample.contact_time);
    let truth = outcome(&problem, &full(&problem), &NEWMARK.at_step(step), &times)?;
    let modelling = elastic(&problem, MODES, Some(step));
    let reduced = outcome(&problem, &modelling, &TRIGONOMETRIC.at_step(step), &times)?;
    let error = (truth.usable() && reduced.usable())
        .then(|| reduced.error(Metric::ForceL2, &truth))
        .filter(|e| e.is_finite());
    Ok(Row {
        scene: sample.scene.name.clone(),
        kind: sample.kind.as_str().into(),
        duration_s: problem.duration,
        step_s: step,
        status: [&truth, &reduced].map(|o| o.row.status.to_string()),
        error,
        residual: [&truth, &reduced].map(|o| o.ledger.residual_rel),
    })
}

/// A mesh cycle of a scene whose gears run under load from the start [s]; none of an impact.
fn mesh_cycle(problem: &Problem) -> Option<f64> {
    let spec = &problem.scene;
    let [a, b] = spec.meshes.first()?.gears.map(|i| &spec.gears[i]);
    let Body::Gear(gear) = &a.body else {
        return None;
    };
    let loaded = !a.loads.is_empty() && a.speed != 0.0 && b.speed != 0.0;
    let base_pitch = mesh_layout(a, b).ok()?.base_pitch;
    loaded.then(|| base_pitch / (gear.r_base() * a.speed.abs()))
}

/// All rows as a table.
pub fn csv(rows: &[Row]) -> String {
    let mut out = String::from(
        "scene,kind,duration_s,step_s,fe,elastic,force_l2,fe_residual_rel,elastic_residual_rel\n",
    );
    let number = |x: Option<f64>| x.map_or_else(String::new, |x| format!("{x:.3e}"));
    for r in rows {
        let [fe, reduced] = &r.status;
        // Writing to a string cannot fail.
        let _ = writeln!(
            out,
            "{},{},{:.6e},{:.6e},{fe},{reduced},{},{},{}",
            r.scene,
            r.kind,
            r.duration_s,
            r.step_s,
            number(r.error),
            number(r.residual[0]),
            number(r.residual[1])
        );
    }
    out
}
