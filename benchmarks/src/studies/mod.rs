//! Studies: evaluations of a scene by the commands of the program. Each study is one module with its arguments, plan,
//! runs and summary; one whose results are a table is one file (`tabular`).
//!
//! | module | study |
//! |---|---|
//! | `check` | results, work and runtime of chosen runs against a stored baseline |
//! | [`choose`] | the cheapest adequate model, integrator and step for a scene, without finite elements |
//! | [`compare`] | all models and integrators of a scene against its references |
//! | `cost` | what the runs of each model and integrator cost, without errors |
//! | `coupling` | the hubs of the gears in a host: error, energy and stability over the communication step |
//! | [`identify`] | stiffness, tooth mass and touch time fitted to a reference impact |
//! | [`modes`] | natural frequencies and shapes of the whole scene about its loaded state |
//! | `penalty` | force, impulse and transmission error over the penalty, compared with hard contact |
//! | `precision` | error against cost: models, integrators, resolutions, mode counts |
//! | [`response`] | frequency response to the passing of teeth, without running |
//! | [`run_up`] | a run from one speed to another: spectra and orders over the speed |
//! | `scan` | many scenes: keys varied at once, samples, sensitivity indices, parts for several machines |
//! | [`stability`] | stability maps over step and stiffness, damping, speed, modes; the largest stable step |
//! | `stiffness` | static mesh stiffness of the models, compared with ISO 6336 and the analytic compliance |
//! | `sweep` | running under load at speed after speed: transmission error, bearing forces, spectra |
//! | `truncation` | error of the elastic model over the number of modes, against full finite elements |

pub(crate) mod check;
pub mod choose;
pub mod compare;
pub(crate) mod cost;
pub(crate) mod coupling;
pub mod identify;
pub mod modes;
pub(crate) mod penalty;
pub(crate) mod precision;
pub mod response;
pub mod run_up;
pub(crate) mod scan;
pub mod stability;
pub(crate) mod stiffness;
pub(crate) mod sweep;
pub(crate) mod tabular;
#[cfg(test)]
pub(crate) mod test_scene;
#[cfg(test)]
mod transverse_plane_tests;
pub(crate) mod truncation;

use crate::cli::study_command::StudyCommand;
use gearbench_reports::columns::FileDescription;

/// Returns the descriptions of the CSV files of all studies.
pub fn files() -> Vec<FileDescription> {
    let mut all = gearbench_reports::dictionary::files();
    all.extend(StudyCommand::tables());
    all
}
