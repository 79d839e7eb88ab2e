//! What choices are held against: the densest elastic model, or full finite elements on the same mesh.

use super::super::candidate::{DENSEST, densest, elastic, full};
use super::super::situation::Situation;
use super::super::wish::Metric;
use super::JudgeError;
use super::measure::{Observed, PATIENCE, Ready};
use crate::study::run::Method;
use gearbench_integrators::Resolution;
use gearbench_models::scene::spec::Modelling;
use std::sync::atomic::AtomicBool;

/// Modes of the model whose distance tells what the densest is off by cutting modes.
const FEWER: usize = 200;
const _: () = assert!(FEWER < DENSEST);
/// Steps of full finite elements per contact time, and their method.
const FULL: (&str, f64) = ("newmark", 500.0);

/// A reference.
pub struct Reference {
    /// In words.
    pub name: &'static str,
    /// Its run.
    pub run: Observed,
    /// The larger of what twice the step and fewer modes change; for the densest elastic model.
    pub own_error: Option<f64>,
    /// Error of the densest elastic model, where that is not the reference.
    pub densest_error: Option<f64>,
}

/// Names of the references.
pub const DENSEST_NAME: &str = "densest elastic model";
/// See [`DENSEST_NAME`].
pub const FULL_NAME: &str = "full finite elements";

/// Runs the reference.
///
/// # Errors
/// A model that cannot be built or does not reach the end.
pub fn reference(
    situation: &Situation,
    metric: Metric,
    full_order: bool,
    (grid, contact_time): (&[f64], f64),
    cancel: Option<&AtomicBool>,
) -> Result<Reference, JudgeError> {
    let dense = densest(situation)?;
    let run = |modelling: &Modelling, method: &Method| -> Result<Observed, JudgeError> {
        let mut ready = Ready::new(situation, &dense.scene, modelling, cancel)?;
        let seen = ready.observe(method, grid, PATIENCE)?;
        if seen.status.is_failure() {
            return Err(JudgeError::Reference {
                method: method.text.clone(),
                why: seen.message.unwrap_or_else(|| seen.status.to_string()),
            });
        }
        Ok(seen)
    };
    let fine = run(&dense.modelling, &dense.method)?;
    if full_order {
        let (method, steps) = FULL;
        let method = Method {
            text: method.into(),
            resolution: Resolution::Step(contact_time / steps),
        };
        let run = run(&full(situation), &method)?;
        return Ok(Reference {
            name: FULL_NAME,
            own_error: None,
            densest_error: fine.error(metric, &run),
            run,
        });
    }
    let step = match dense.method.resolution {
        Resolution::Step(h) => Some(h),
        Resolution::Tolerance(_) => None,
    };
    let doubled = Method {
        text: dense.method.text.clone(),
        resolution: match dense.method.resolution {
            Resolution::Step(h) => Resolution::Step(2.0 * h),
            Resolution::Tolerance(r) => Resolution::Tolerance(10.0 * r),
        },
    };
    let coarse = run(&dense.modelling, &doubled)?;
    let fewer = run(&elastic(situation, FEWER, step), &dense.method)?;
    let own = [coarse, fewer]
        .iter()
        .filter_map(|o| o.error(metric, &fine))
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
