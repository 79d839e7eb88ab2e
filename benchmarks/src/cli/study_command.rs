//! The list of commands that run a study.
//!
//! Each writes one folder. `rerun` makes a study again from this list, and from nothing else.

use super::arguments::Output;
use super::command_result::CommandResult;
use super::refusal::Refusal;
use crate::context::Context;
use crate::studies::check::{self, arguments::Check};
use crate::studies::choose::{self, arguments::Choose};
use crate::studies::compare::{self, arguments::Compare};
use crate::studies::coupling::{self, arguments::Coupling};
use crate::studies::identify::{self, arguments::Identify};
use crate::studies::modes::{self, arguments::Modes};
use crate::studies::penalty::{self, arguments::Penalty};
use crate::studies::precision::{self, arguments::Precision};
use crate::studies::response::{self, arguments::Response};
use crate::studies::run_up::{self, arguments::RunUp};
use crate::studies::scan::{self, arguments::Scan};
use crate::studies::stability::{self, arguments::Stability};
use crate::studies::stiffness::{self, arguments::Stiffness};
use crate::studies::sweep::{self, arguments::Sweep};
use crate::studies::truncation::{self, arguments::Truncation};
use clap::Subcommand;
use std::path::PathBuf;

/// A command that runs a study and writes its folder.
#[derive(Clone, Debug, Subcommand)]
pub(crate) enum StudyCommand {
    /// Compare the models and integrators of a scene with its reference
    Compare(Compare),
    /// Compute error and cost of every model, integrator and resolution of a scene, and the Pareto front
    Precision(Precision),
    /// Map the stability of integrators over step size and stiffness, damping, speed or modes, and compare it with
    /// theory
    Stability(Stability),
    /// Choose the cheapest model, integrator and step that meet a tolerance on a scene, with reasons
    Choose(Choose),
    /// Fit stiffness, tooth mass and time of first contact of the models to the scene's reference
    Identify(Identify),
    /// Compute static mesh stiffness, load sharing and transmission error of the models of a scene
    Stiffness(Stiffness),
    /// Compute the error of the elastic model over the number of modes, against full finite elements on the same mesh
    Truncation(Truncation),
    /// Compute natural frequencies and mode shapes of the whole scene about its loaded state
    Modes(Modes),
    /// Compute the response to tooth mesh excitation in the frequency domain: transmission error and forces of mounts
    Response(Response),
    /// Compute results over the contact penalty and compare them with hard contact
    Penalty(Penalty),
    /// Run under load at a series of speeds: transmission error, bearing forces, spectra, resonances
    Sweep(Sweep),
    /// Couple the gears to a host that moves their hubs: error, energy and stability over the communication step
    Coupling(Coupling),
    /// Run through a range of speed: spectra and orders over the speed, resonances
    RunUp(RunUp),
    /// Run many scenes that differ in some keys: grids, samples, sensitivity indices
    Scan(Box<Scan>),
    /// Compare results, work and runtime of selected runs with a stored baseline, for CI
    Check(Check),
}

impl Default for StudyCommand {
    /// The default study is the comparison that `gearbench` runs without a command.
    fn default() -> Self {
        StudyCommand::Compare(Compare::default())
    }
}

impl StudyCommand {
    /// Runs the study; its record stores the command line.
    pub(super) fn run(
        &self,
        context: &Context,
        command_line: &str,
    ) -> Result<CommandResult, Refusal> {
        match self {
            StudyCommand::Compare(args) => compare::command::run(context, args, command_line),
            StudyCommand::Precision(args) => precision::command::run(context, args, command_line),
            StudyCommand::Stability(args) => stability::command::run(context, args, command_line),
            StudyCommand::Choose(args) => choose::command::run(context, args, command_line),
            StudyCommand::Identify(args) => identify::command::run(context, args, command_line),
            StudyCommand::Stiffness(args) => stiffness::command::run(context, args, command_line),
            StudyCommand::Truncation(args) => truncation::command::run(context, args, command_line),
            StudyCommand::Modes(args) => modes::command::run(context, args, command_line),
            StudyCommand::Response(args) => response::command::run(context, args, command_line),
            StudyCommand::Penalty(args) => penalty::command::run(context, args, command_line),
            StudyCommand::Sweep(args) => sweep::command::run(context, args, command_line),
            StudyCommand::Coupling(args) => coupling::command::run(context, args, command_line),
            StudyCommand::RunUp(args) => run_up::command::run(context, args, command_line),
            StudyCommand::Scan(args) => scan::command::run(context, args, command_line),
            StudyCommand::Check(args) => check::command::run(context, args, command_line),
        }
    }

    /// The output options of the study.
    pub(super) fn output(&mut self) -> &mut Output {
        match self {
            StudyCommand::Compare(args) => &mut args.run.bounded.output,
            StudyCommand::Precision(args) => &mut args.output,
            StudyCommand::Stability(args) => &mut args.run.output,
            StudyCommand::Choose(args) => &mut args.run.output,
            StudyCommand::Identify(args) => &mut args.output,
            StudyCommand::Stiffness(args) => &mut args.output,
            StudyCommand::Truncation(args) => &mut args.run.bounded.output,
            StudyCommand::Modes(args) => &mut args.output,
            StudyCommand::Response(args) => &mut args.output,
            StudyCommand::Penalty(args) => &mut args.run.output,
            StudyCommand::Sweep(args) => &mut args.run.output,
            StudyCommand::Coupling(args) => &mut args.run.output,
            StudyCommand::RunUp(args) => &mut args.output,
            StudyCommand::Scan(args) => &mut args.run.output,
            StudyCommand::Check(args) => &mut args.output,
        }
    }

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
