//! The list of commands that run a study: name, group of the help, arguments, and where the arguments have the output
//! folder. A study whose results are one table needs no more than its arguments ([`TabularStudy`]).
//!
//! Each writes one folder. `rerun` makes a study again from this list, and from nothing else.

use super::arguments::Output;
use super::command_result::CommandResult;
use super::refusal::Refusal;
use crate::context::Context;
use crate::studies::check::{self, arguments::Check};
use crate::studies::choose::{self, arguments::Choose};
use crate::studies::compare::{self, arguments::Compare};
use crate::studies::cost::Cost;
use crate::studies::coupling::Coupling;
use crate::studies::identify::{self, arguments::Identify};
use crate::studies::modes::{self, arguments::Modes};
use crate::studies::penalty::Penalty;
use crate::studies::precision::Precision;
use crate::studies::response::{self, arguments::Response};
use crate::studies::run_up::{self, arguments::RunUp};
use crate::studies::scan::{self, arguments::Scan};
use crate::studies::stability::{self, arguments::Stability};
use crate::studies::stiffness::{self, arguments::Stiffness};
use crate::studies::sweep::{self, arguments::Sweep};
use crate::studies::tabular::{self, TabularStudy};
use crate::studies::truncation::Truncation;
use clap::Subcommand;
use gearbench_reports::columns::FileDescription;
use std::path::PathBuf;

/// Declares the commands of studies, each once.
macro_rules! studies {
    (
        $($(#[$about:meta])* $name:literal in $group:literal: $variant:ident($args:ty) runs $run:path, writes $($out:ident).+;)+
        tables: $($table_name:literal in $table_group:literal: $table:ident;)+
    ) => {
        /// A command that runs a study and writes its folder.
        #[derive(Clone, Debug, Subcommand)]
        pub(crate) enum StudyCommand {
            $($(#[$about])* #[command(name = $name)] $variant($args),)+
            $(#[command(name = $table_name)] $table($table),)+
        }

        impl StudyCommand {
            /// Name and group of each study.
            pub(super) const GROUPS: &[(&str, &str)] = &[
                $(($name, $group),)+
                $(($table_name, $table_group),)+
            ];

            /// Runs the study; its record stores the command line.
            pub(super) fn run(
                &self,
                context: &Context,
                command_line: &str,
            ) -> Result<CommandResult, Refusal> {
                match self {
                    $(StudyCommand::$variant(args) => $run(context, args, command_line),)+
                    $(StudyCommand::$table(args) => tabular::run(context, args, command_line),)+
                }
            }

            /// The output options of the study.
            pub(super) fn output(&mut self) -> &mut Output {
                match self {
                    $(StudyCommand::$variant(args) => &mut args.$($out).+,)+
                    $(StudyCommand::$table(args) => &mut args.options().output,)+
                }
            }

            /// The CSV files of studies whose results are one table.
            pub(crate) fn tables() -> Vec<FileDescription> {
                vec![$(tabular::columns::<$table>().described()),+]
            }
        }
    };
}

studies! {
    /// Compare the models and integrators of a scene with its reference
    "compare" in "Compare and choose": Compare(Compare) runs compare::command::run, writes run.bounded.output;
    /// Choose the cheapest model, integrator and step that meet a tolerance on a scene, with reasons
    "choose" in "Compare and choose": Choose(Choose) runs choose::command::run, writes run.output;
    /// Map the stability of integrators over step size and stiffness, damping, speed or modes, and compare it with
    /// theory
    "stability" in "Compare and choose": Stability(Stability) runs stability::command::run, writes run.output;
    /// Compute static mesh stiffness, load sharing and transmission error of the models of a scene
    "stiffness" in "Analyse": Stiffness(Stiffness) runs stiffness::command::run, writes output;
    /// Compute natural frequencies and mode shapes of the whole scene about its loaded state
    "modes" in "Analyse": Modes(Modes) runs modes::command::run, writes output;
    /// Compute the response to tooth mesh excitation in the frequency domain: transmission error and forces of mounts
    "response" in "Analyse": Response(Response) runs response::command::run, writes output;
    /// Run under load at a series of speeds: transmission error, bearing forces, spectra, resonances
    "sweep" in "Analyse": Sweep(Sweep) runs sweep::command::run, writes run.output;
    /// Run through a range of speed: spectra and orders over the speed, resonances
    "run-up" in "Analyse": RunUp(RunUp) runs run_up::command::run, writes output;
    /// Run many scenes that differ in some keys: grids, samples, sensitivity indices
    "scan" in "Analyse": Scan(Box<Scan>) runs scan::command::run, writes run.output;
    /// Fit stiffness, tooth mass and time of first contact of the models to the scene's reference
    "identify" in "Data, meshes and other programs": Identify(Identify) runs identify::command::run, writes output;
    /// Compare results, work and runtime of selected runs with a stored baseline, for CI
    "check" in "Keep and repeat": Check(Check) runs check::command::run, writes output;
    tables:
    "penalty" in "Compare and choose": Penalty;
    "cost" in "Compare and choose": Cost;
    "truncation" in "Compare and choose": Truncation;
    "coupling" in "Data, meshes and other programs": Coupling;
    "precision" in "Compare and choose": Precision;
}

impl Default for StudyCommand {
    /// The default study is the comparison that `gearbench` runs without a command.
    fn default() -> Self {
        StudyCommand::Compare(Compare::default())
    }
}

impl StudyCommand {
    /// Returns the study with all of its output in one folder. Options that write elsewhere (a baseline, a calibration,
    /// the scene) or allow overwriting are removed.
    pub(super) fn confined_to(mut self, folder: PathBuf) -> Self {
        match &mut self {
            StudyCommand::Identify(args) => args.write = None,
            StudyCommand::Check(args) => args.update = false,
            _ => {}
        }
        let output = self.output();
        (output.out, output.fresh, output.force) = (Some(folder), false, false);
        self
    }
}
