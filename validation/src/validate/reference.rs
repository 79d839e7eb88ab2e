//! The reference of the validation: the densest elastic model on the refined mesh, with half-space contact where the
//! scene allows it.
//!
//! The error of the reference itself is estimated (twice the step, fewer modes), as are the errors by mesh and contact
//! of the scene with the same number of modes.

use super::ValidationError;
use super::measure::{PATIENCE, error};
use gearbench::studies::choose::plan::{CandidateData, DENSEST, densest, elastic};
use gearbench::studies::choose::problem::{ElasticSettings, Problem};
use gearbench::studies::choose::trial::{Outcome, WindowModel};
use gearbench_integrators::Resolution;
use gearbench_integrators::Scheme;
use gearbench_models::spec::Modelling;
use gearbench_reports::Metric;

/// Number of modes of the reduced model that estimates the truncation error of the densest one.
const FEWER: usize = 200;
const _: () = assert!(FEWER < DENSEST);
/// Steps of the densest elastic model, relative to its default, in the order of the trials.
const FINER: [f64; 2] = [1.0, 0.25];
/// Name of the reference with half-space contact.
pub const NAME: &str = "refined elastic model";
/// Name of the reference with the contact of the scene, where no run with half-space contact is sound.
pub const MESH_NAME: &str = "refined elastic model, contact of the scene";

pub struct Reference {
    pub run: Outcome,
    /// The larger of the changes by twice the step and by fewer modes.
    pub own_error: Option<f64>,
    /// Error of a model with the same modes and contact on the mesh of the scene.
    pub mesh_error: Option<f64>,
    /// Error of a model with the same modes, with mesh and contact of the scene.
    pub given_error: Option<f64>,
}

/// Runs the whole scene; fails unless the run reaches its end.
fn ended(
    problem: &Problem,
    modelling: &Modelling,
    method: &Scheme,
    grid: &[f64],
) -> Result<Outcome, ValidationError> {
    let mut trial = WindowModel::new(problem, &problem.scene, modelling)?;
    let seen = trial.observe(method, (problem.duration, grid), false, PATIENCE)?;
    if seen.usable() {
        return Ok(seen);
    }
    Err(ValidationError::Reference {
        method: method.method.to_string(),
        why: (seen.row.message).unwrap_or_else(|| seen.row.status.to_string()),
    })
}

/// Returns the first of some methods that reaches the end, with its run.
pub fn first<'m>(
    problem: &Problem,
    modelling: &Modelling,
    methods: &'m [Scheme],
    grid: &[f64],
) -> Result<(Outcome, &'m Scheme), ValidationError> {
    let mut last = ValidationError::Reference {
        method: "nothing".into(),
        why: "no method to try".into(),
    };
    for method in methods {
        match ended(problem, modelling, method, grid) {
            Ok(seen) => return Ok((seen, method)),
            Err(e @ ValidationError::Reference { .. }) => last = e,
            Err(e) => return Err(e),
        }
    }
    Err(last)
}

pub fn reference(
    (problem, prepared): (&Problem, &CandidateData),
    metric: Metric,
    grid: &[f64],
) -> Result<Reference, ValidationError> {
    let details = &prepared.details;
    let judge = details.judge();
    let dense = densest(problem, prepared, judge);
    let methods = FINER.map(|part| scaled(&dense.method, part));
    let (fine, method) = first(problem, &dense.modelling, &methods, grid)?;
    // The reported solution is repeated with twice the step, and compared with the same model at that step. A
    // repetition that does not reach the end gives no estimate.
    let twice = scaled(method, 2.0);
    let step = twice.resolution.step();
    let at_twice = |of: &ElasticSettings, modes: usize| {
        ended(problem, &elastic(of, modes, step), &twice, grid).ok()
    };
    let coarse = at_twice(judge, DENSEST);
    let off = |of: &ElasticSettings, modes: usize| {
        let (run, coarse) = (at_twice(of, modes)?, coarse.as_ref()?);
        error(&run, metric, coarse)
    };
    let own = [
        coarse.as_ref().and_then(|o| error(o, metric, &fine)),
        off(judge, FEWER),
    ];
    let of = |other: &ElasticSettings| {
        (other.detail != judge.detail)
            .then(|| off(other, DENSEST))
            .flatten()
    };
    Ok(Reference {
        own_error: own.into_iter().flatten().reduce(f64::max),
        mesh_error: of(&details.lead),
        given_error: of(&problem.flexible),
        run: fine,
    })
}

/// The method at `part` times its step; a factor of two in the step corresponds to a decade in the tolerance.
fn scaled(method: &Scheme, part: f64) -> Scheme {
    method.method.at(match method.resolution {
        Resolution::Step(h) => Resolution::Step(part * h),
        Resolution::Tolerance(r) => Resolution::Tolerance(r * 10f64.powf(part.log2())),
    })
}
