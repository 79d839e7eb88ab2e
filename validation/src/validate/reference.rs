//! What choices are held against: the densest elastic model on the refined mesh, with the contact of half-spaces where the
//! scene allows it; and full finite elements on a mesh of their own, three times as fine along the flanks as the scene's,
//! which touch with their elements.
//!
//! Beside the first stands what it may be off itself (twice the step, fewer modes), and what the mesh and the contact of
//! the scene are off it, with as many modes.

use super::ValidationError;
use super::measure::{PATIENCE, error};
use gearbench::studies::choose::plan::{DENSEST, Prepared, densest, elastic, full};
use gearbench::studies::choose::problem::{Flexible, Problem};
use gearbench::studies::choose::trial::{Outcome, Trial};
use gearbench_integrators::Resolution;
use gearbench_integrators::table::{HHT_ALPHA, NEWMARK};
use gearbench_integrators::{MethodSpec, Scheme};
use gearbench_models::spec::{Modelling, PointContact};
use gearbench_reports::Metric;

/// Modes of the model whose distance tells what the densest is off by cutting modes.
const FEWER: usize = 200;
const _: () = assert!(FEWER < DENSEST);
/// Methods of full finite elements and their steps per contact time, in the order in which they are tried.
const FULL: [(MethodSpec, f64); 2] = [(NEWMARK, 250.0), (HHT_ALPHA.with_value(0.05), 250.0)];
/// Elements of theirs along a flank over those of the scene, penalty over that of the scene.
const FINE: (usize, f64) = (3, 10.0);
/// Parts of its step that the densest elastic model is given, in the order in which they are tried.
const FINER: [f64; 2] = [1.0, 0.25];
/// What it is called.
pub const NAME: &str = "refined elastic model";
/// The same where no run on half-spaces is sound.
pub const MESH_NAME: &str = "refined elastic model, contact of the scene";

pub struct Reference {
    pub run: Outcome,
    /// The larger of what twice the step and fewer modes change.
    pub own_error: Option<f64>,
    /// Error of as many modes on the mesh of the scene, with the same contact.
    pub mesh_error: Option<f64>,
    /// Error of as many modes with mesh and contact of the scene.
    pub given_error: Option<f64>,
}

/// A run over the whole scene that reached its end.
fn ended(
    problem: &Problem,
    modelling: &Modelling,
    method: &Scheme,
    grid: &[f64],
) -> Result<Outcome, ValidationError> {
    let mut trial = Trial::new(problem, &problem.scene, modelling)?;
    let seen = trial.observe(method, (problem.duration, grid), false, PATIENCE)?;
    if seen.usable() {
        return Ok(seen);
    }
    Err(ValidationError::Reference {
        method: method.method.to_string(),
        why: (seen.row.message).unwrap_or_else(|| seen.row.status.to_string()),
    })
}

/// The first of some methods that reaches the end, and its run.
fn first<'m>(
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
    (problem, prepared): (&Problem, &Prepared),
    metric: Metric,
    grid: &[f64],
) -> Result<Reference, ValidationError> {
    let details = &prepared.details;
    let judge = details.judge();
    let dense = densest(problem, prepared, judge);
    let methods = FINER.map(|part| scaled(&dense.method, part));
    let (fine, method) = first(problem, &dense.modelling, &methods, grid)?;
    // What is told beside is run at twice the step, and held against the same model there. What does not reach the end
    // says nothing of the one that does.
    let twice = scaled(method, 2.0);
    let step = twice.resolution.step();
    let at_twice =
        |of: &Flexible, modes: usize| ended(problem, &elastic(of, modes, step), &twice, grid).ok();
    let coarse = at_twice(judge, DENSEST);
    let off = |of: &Flexible, modes: usize| {
        let (run, coarse) = (at_twice(of, modes)?, coarse.as_ref()?);
        error(&run, metric, coarse)
    };
    let own = [
        coarse.as_ref().and_then(|o| error(o, metric, &fine)),
        off(judge, FEWER),
    ];
    let of = |other: &Flexible| {
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

/// Full finite elements on a mesh that is finer along the flanks, without half-spaces.
///
/// # Errors
/// [`ValidationError::Reference`]: no method reaches the end.
pub fn finite_elements(
    problem: &Problem,
    (grid, contact_time): (&[f64], f64),
) -> Result<Outcome, ValidationError> {
    let (along, penalty) = FINE;
    let mut fine = problem.flexible.clone();
    for gear in &mut fine.gears {
        let [flank, ..] = gear.mesh.counted();
        gear.mesh.flank_elements = Some(along * flank);
    }
    for contact in &mut fine.contacts {
        contact.points = contact.points.map(|p| PointContact {
            penalty: penalty * p.penalty,
            ..p
        });
    }
    let methods = FULL.map(|(method, steps)| method.at_step(contact_time / steps));
    Ok(first(problem, &full(&fine), &methods, grid)?.0)
}

/// A method at another step, or at a tolerance that is as much larger in decades as twice the step is one.
fn scaled(method: &Scheme, part: f64) -> Scheme {
    method.method.at(match method.resolution {
        Resolution::Step(h) => Resolution::Step(part * h),
        Resolution::Tolerance(r) => Resolution::Tolerance(r * 10f64.powf(part.log2())),
    })
}
