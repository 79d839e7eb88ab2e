//! What choices are held against: the densest elastic model, or full finite elements on the same mesh.

use super::ValidationError;
use super::measure::{PATIENCE, error};
use gearbench::studies::choose::plan::{DENSEST, densest, elastic, full};
use gearbench::studies::choose::problem::Problem;
use gearbench::studies::choose::trial::{Outcome, Trial};
use gearbench_integrators::Resolution;
use gearbench_integrators::table::{HHT_ALPHA, NEWMARK};
use gearbench_integrators::{MethodSpec, Scheme};
use gearbench_models::spec::Modelling;
use gearbench_reports::Metric;

/// Modes of the model whose distance tells what the densest is off by cutting modes.
const FEWER: usize = 200;
const _: () = assert!(FEWER < DENSEST);
/// Methods of full finite elements and their steps per contact time, in the order in which they are tried. Dashpots at
/// flanks may ask Newton's method for steps that take minutes: where none of these reaches the end, the densest elastic
/// model is the reference, and the row says so.
const FULL: [(MethodSpec, f64); 2] = [(NEWMARK, 500.0), (HHT_ALPHA.with_value(0.05), 500.0)];
/// Parts of its step that the densest elastic model is given, likewise.
const FINER: [f64; 2] = [1.0, 0.25];

pub struct Reference {
    /// In words.
    pub name: &'static str,
    pub run: Outcome,
    /// The larger of what twice the step and fewer modes change; for the densest elastic model.
    pub own_error: Option<f64>,
    /// Error of the densest elastic model, where that is not the reference.
    pub densest_error: Option<f64>,
}

/// Names of the references.
pub const DENSEST_NAME: &str = "densest elastic model";
/// See [`DENSEST_NAME`].
pub const FULL_NAME: &str = "full finite elements";

pub fn reference(
    problem: &Problem,
    metric: Metric,
    full_order: bool,
    (grid, contact_time): (&[f64], f64),
) -> Result<Reference, ValidationError> {
    let dense = densest(problem)?;
    let run = |modelling: &Modelling, method: &Scheme| -> Result<Outcome, ValidationError> {
        let mut trial = Trial::new(problem, &dense.scene, modelling)?;
        let seen = trial.observe(method, (problem.duration, grid), false, PATIENCE)?;
        if !seen.usable() {
            return Err(ValidationError::Reference {
                method: method.method.to_string(),
                why: (seen.row.message).unwrap_or_else(|| seen.row.status.to_string()),
            });
        }
        Ok(seen)
    };
    let first = |modelling: &Modelling, methods: &[Scheme]| {
        let mut last = None;
        for (i, method) in methods.iter().enumerate() {
            match run(modelling, method) {
                Ok(seen) => return Ok((seen, i)),
                Err(e @ ValidationError::Reference { .. }) => last = Some(e),
                Err(e) => return Err(e),
            }
        }
        Err(last.unwrap_or(ValidationError::Reference {
            method: dense.method.method.to_string(),
            why: "no method to try".into(),
        }))
    };
    let finer = FINER.map(|part| scaled(&dense.method, part));
    let (fine, used) = first(&dense.modelling, &finer)?;
    let dense_method = &finer[used];
    if full_order {
        let methods = FULL.map(|(method, steps)| method.at_step(contact_time / steps));
        match first(&full(problem), &methods) {
            Ok((run, _)) => {
                return Ok(Reference {
                    name: FULL_NAME,
                    own_error: None,
                    densest_error: error(&fine, metric, &run),
                    run,
                });
            }
            Err(ValidationError::Reference { .. }) => {}
            Err(e) => return Err(e),
        }
    }
    let step = dense_method.resolution.step();
    // What does not reach the end says nothing of the one that does.
    let coarse = run(&dense.modelling, &scaled(dense_method, 2.0)).ok();
    let fewer = run(&elastic(problem, FEWER, step), dense_method).ok();
    let own = [coarse, fewer]
        .iter()
        .flatten()
        .filter_map(|o| error(o, metric, &fine))
        .fold(None, |worst: Option<f64>, e| {
            Some(worst.map_or(e, |w| w.max(e)))
        });
    Ok(Reference {
        name: DENSEST_NAME,
        run: fine,
        own_error: own,
        densest_error: None,
    })
}

/// A method at another step, or at a tolerance that is as much larger in decades as twice the step is one.
fn scaled(method: &Scheme, part: f64) -> Scheme {
    method.method.at(match method.resolution {
        Resolution::Step(h) => Resolution::Step(part * h),
        Resolution::Tolerance(r) => Resolution::Tolerance(r * 10f64.powf(part.log2())),
    })
}
