//! Experiments: what is run, how, and how it ended.
//!
//! | module | owns |
//! |---|---|
//! | [`budget`] | the processor time that a whole study may take |
//! | [`conditions`] | what all runs of a study share, and what heads its record |
//! | `contact_log` | tooth pairs in contact, and contacts that close and open |
//! | [`configuration`] | what is run: a model of a scene |
//! | `converged` | the converged solution of a model |
//! | [`error`] | why a study ends before its end |
//! | `force` | the force of a run between events, for metrics |
//! | `history` | channels of a run over time |
//! | [`interruption`] | Ctrl-C and SIGTERM |
//! | [`journal`] | finished work on disk, so that a killed study goes on where it was |
//! | [`key`] | names of pieces of work by all that they depend on |
//! | [`machine`] | where and when a record was made |
//! | [`parallel`] | pieces of work on several threads |
//! | `record` | what a record keeps of a run |
//! | `referenced` | references as records keep them |
//! | [`run`] | one model under one integrator: a row of the record, failed or not |
//! | `parameters` | parameters of a run for its record |
//! | `paths` | paths of torque and power through a train, load sharing between planets |
//! | [`pictures`] | frames of a run for ParaView |
//! | `resample` | histories at other abscissae |
//! | [`runner`] | how a study does its work: piece by piece, kept when finished |
//! | `settings` | what a reader must know of a scene |
//! | [`status`] | how a run ended: one label for every way a run can go wrong |
//! | [`small_signals`] | scenes in the equilibrium of their loads, and to first order there |
//! | `thin` | histories as records keep them |
//! | `watched` | one more observer of a run |

pub mod budget;
pub mod conditions;
pub mod configuration;
pub(crate) mod contact_log;
pub(crate) mod converged;
pub mod error;
pub(crate) mod flanks;
pub(crate) mod force;
pub(crate) mod history;
pub mod interruption;
pub mod journal;
pub mod key;
pub mod machine;
pub mod parallel;
pub(crate) mod parameters;
mod paths;
pub mod pictures;
pub(crate) mod record;
pub(crate) mod referenced;
pub(crate) mod resample;
pub mod run;
pub mod runner;
pub(crate) mod settings;
mod shaft_text;
pub mod small_signals;
pub mod status;
pub(crate) mod thin;
mod watched;
