//! Entry point of the command-line program `gearbench`. The commit of the build is stamped here, so that a commit
//! compiles this file again and not the library.

use gearbench::context::Context;
use gearbench::experiment::machine;
use gearbench_reference::reduction::cache::Cache;
use std::process::ExitCode;
use std::sync::Arc;

fn main() -> ExitCode {
    machine::set_commit(env!("GEARBENCH_COMMIT"));
    let mut context = Context::default();
    context.resources.cache = Arc::new(Cache::standard());
    gearbench::cli::main(context)
}
