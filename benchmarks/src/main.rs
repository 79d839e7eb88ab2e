//! The command `gearbench`.

use clap::Parser;
use gearbench_reference::reduction::cache::{self, Cache};
use std::process::ExitCode;

fn main() -> ExitCode {
    cache::choose(Cache::standard());
    gearbench::cli::run(gearbench::cli::Cli::parse())
}
