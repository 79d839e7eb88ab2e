//! Entry point of the command-line program `gearbench`. The commit of the build is stamped here, so that a commit
//! compiles this file again and not the library.

use gearbench::experiment::machine;
use gearbench_reference::reduction::cache::{self, Cache};
use std::process::ExitCode;

fn main() -> ExitCode {
    machine::set_commit(env!("GEARBENCH_COMMIT"));
    cache::choose(Cache::standard());
    gearbench::cli::main()
}
