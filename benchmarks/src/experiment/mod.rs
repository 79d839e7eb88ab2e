//! Experiments: runs of one model under one integrator, their conditions, storage and status.
//!
//! | module | owns |
//! |---|---|
//! | [`budget`] | budget of processor time of a whole study |
//! | `checkout` | commit of a checkout, also for the build script of the command |
//! | [`conditions`] | conditions that all runs of a study share, header of its record |
//! | `contact_log` | tooth pairs in contact, openings and closings of contacts |
//! | [`configuration`] | one model of a scene with its parameters |
//! | `converged` | the converged solution of a model |
//! | [`error`] | errors of runs and studies |
//! | `force` | contact force of a run between events, for metrics |
//! | `history` | channels of a run over time |
//! | [`interruption`] | handling of Ctrl-C and SIGTERM |
//! | [`journal`] | storage of finished work, so that an interrupted study continues |
//! | [`key`] | keys of pieces of work, hashed from their inputs |
//! | `linear_models` | models for analyses with dense matrices, and their mesh modes |
//! | `mechanism` | bodies without teeth, shafts and bearings of a motion |
//! | [`machine`] | computer, program and time of a record |
//! | [`parallel`] | parallel execution of pieces of work |
//! | `record` | the row of a run in the record, and its histories |
//! | `reference_series` | references in the form of records |
//! | [`run`] | run of one model under one integrator, a row of the record |
//! | `parameters` | parameters of a run for its record |
//! | `paths` | paths of torque and power through a train, load sharing between planets |
//! | [`motion`] | poses, displaced teeth and contacts at instants of a run, for the report |
//! | [`pictures`] | frames of a run for ParaView |
//! | `resample` | interpolation of histories |
//! | [`runner`] | execution of a study piece by piece |
//! | `settings` | settings of a scene for the report |
//! | [`status`] | status of a run: one label for every kind of failure |
//! | `decimation` | reduction of histories to the size of a record |
//! | `monitored_observer` | a run with one more observer |

pub mod budget;
mod checkout;
pub mod conditions;
pub mod configuration;
pub(crate) mod contact_log;
pub(crate) mod converged;
pub(crate) mod decimation;
pub mod error;
pub(crate) mod flanks;
pub(crate) mod force;
pub(crate) mod history;
pub mod interruption;
pub mod journal;
pub mod key;
pub(crate) mod linear_models;
pub mod machine;
mod mechanism;
mod monitored_observer;
pub mod motion;
pub mod parallel;
pub(crate) mod parameters;
mod paths;
pub mod pictures;
pub(crate) mod record;
pub(crate) mod reference_series;
pub(crate) mod resample;
pub mod run;
pub mod runner;
pub(crate) mod settings;
mod shaft_text;
pub mod status;
