//! The command `gearbench completions SHELL`: a script for the completion of commands and options.

use crate::cli::Cli;
use crate::cli::command_result::CommandResult;
use crate::cli::terminal::Refusal;
use crate::context::Context;
use clap::{Args, CommandFactory};
use clap_complete::Shell;

const EXAMPLES: &str = "\
Examples:
  gearbench completions bash > ~/.local/share/bash-completion/completions/gearbench
  gearbench completions fish > ~/.config/fish/completions/gearbench.fish";

/// Arguments of `completions`.
#[derive(Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Completions {
    /// The shell
    pub shell: Shell,
}

/// Prints the completion script of a shell.
pub fn run(context: &Context, args: &Completions) -> Result<CommandResult, Refusal> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "gearbench", &mut script);
    context
        .messages
        .print_text(String::from_utf8_lossy(&script).trim_end());
    Ok(CommandResult::done())
}
