//! Studies: what the command does with a scene.
//!
//! | module | study |
//! |---|---|
//! | [`choose`] | the cheapest adequate model, integrator and step for a scene, without finite elements |
//! | [`compare`] | all models and integrators of a scene against its references |
//! | [`identify`] | stiffness, tooth mass and touch time fitted to a reference impact |
//! | [`limits`] | the largest stable step of a method on a scene: theory, and what is found |
//! | [`modes`] | error of the elastic model over the number of modes, against full finite elements |
//! | [`penalty`] | force, impulse and transmission error over the penalty, beside hard contact |
//! | [`precision`] | error against cost: models, integrators, resolutions, mode counts |
//! | [`run`] | one model under one integrator: a row of the record, failed or not |
//! | [`stability`] | where methods fail: maps over step and stiffness, damping, speed, modes |
//! | [`sweep`] | running under load at speed after speed: transmission error, bearing forces, spectra |
//! | [`stiffness`] | static mesh stiffness of the models beside the norm and the analytic compliance |
//! | [`verdict`] | how a run ended: one label for every way a run can go wrong |

pub mod choose;
pub mod compare;
pub mod history;
pub mod identify;
pub mod limits;
pub mod machine;
pub mod modes;
pub mod penalty;
pub mod precision;
pub mod run;
pub mod stability;
pub mod stiffness;
pub mod sweep;
pub mod verdict;
