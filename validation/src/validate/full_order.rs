//! Comparison of choices with full finite elements on a mesh three times as fine along the flanks as that of the scene,
//! with contact of elements by a penalty and no half-spaces. A scene takes minutes.

use super::measure::{error, grid};
use super::reference::first;
use super::{LONGEST, ValidationError};
use crate::sampling::Sample;
use gearbench::studies::choose::plan::{Candidate, CandidateData, densest, full};
use gearbench::studies::choose::problem::Problem;
use gearbench::studies::choose::trial::{Outcome, WindowModel};
use gearbench_integrators::MethodSpec;
use gearbench_integrators::table::{HHT_ALPHA, NEWMARK};
use serde::{Deserialize, Serialize};

/// Methods of full finite elements and numbers of steps per contact time, in the order of the trials.
const FULL: [(MethodSpec, f64); 2] = [(NEWMARK, 250.0), (HHT_ALPHA.with_value(0.05), 250.0)];
/// Elements along a flank and penalty, relative to those of the scene.
const FINE: (usize, f64) = (3, 10.0);
/// Errors of the choice and of the reference of the validation, against full finite elements on a finer mesh.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct FullOrderErrors {
    pub chosen: Option<f64>,
    pub refined: Option<f64>,
}

/// Compares a validated choice, by its name, with full finite elements; `None` if nothing was chosen.
///
/// # Errors
/// [`ValidationError::Reference`]: they do not reach the end.
pub fn against_full(
    sample: &Sample,
    chosen: Option<&str>,
) -> Result<FullOrderErrors, ValidationError> {
    let problem = Problem::of(&sample.scene);
    let times = grid(problem.duration, sample.contact_time);
    let prepared = CandidateData::of(&problem)?;
    let full = finite_elements(&problem, (&times, sample.contact_time))?;
    let against = |candidate: &Candidate| -> Result<Option<f64>, ValidationError> {
        let mut trial = WindowModel::new(&problem, &candidate.scene, &candidate.modelling)?;
        let whole = (problem.duration, &times[..]);
        let seen = trial.observe(&candidate.method, whole, false, LONGEST)?;
        Ok(error(&seen, sample.metric, &full))
    };
    let all = prepared.candidates(&problem);
    let chosen = all.iter().find(|c| Some(c.name().as_str()) == chosen);
    Ok(FullOrderErrors {
        chosen: chosen.map(&against).transpose()?.flatten(),
        refined: against(&densest(&problem, &prepared, prepared.details.judge()))?,
    })
}

/// The model of full finite elements on a mesh that is finer along the flanks, without half-spaces.
///
/// # Errors
/// [`ValidationError::Reference`]: no method reaches the end.
fn finite_elements(
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
        if let Some(stiffness) = contact.flanks.penalty_mut() {
            *stiffness *= penalty;
        }
    }
    let methods = FULL.map(|(method, steps)| method.at_step(contact_time / steps));
    Ok(first(problem, &full(&fine), &methods, grid)?.0)
}
