//! Entry point of the command-line program `gearbench`.

use gearbench_reference::reduction::cache::{self, Cache};
use std::process::ExitCode;

fn main() -> ExitCode {
    cache::choose(Cache::standard());
    gearbench::cli::main()
}
