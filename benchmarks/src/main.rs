//! The command `gearbench`.

use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    gearbench::commands::run(gearbench::cli::Cli::parse())
}
