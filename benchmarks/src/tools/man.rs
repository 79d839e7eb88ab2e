//! The command `gearbench man`: manual pages of all commands.

use crate::cli::Cli;
use crate::cli::command_result::CommandResult;
use crate::cli::files::write_whole;
use crate::cli::terminal::{Refusal, absolute};
use crate::context::Context;
use clap::{Args, Command, CommandFactory};
use clap_mangen::Man as Page;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  gearbench man | man -l -                              the page of gearbench
  gearbench man --out ~/.local/share/man/man1           pages of all commands: man gearbench-compare";

/// Arguments of `man`.
#[derive(Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Man {
    /// Folder to write the pages of all commands to [default: print that of gearbench]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// The text of a page.
fn page(command: Command) -> Result<String, Refusal> {
    let mut text = Vec::new();
    let rendered = Page::new(command).render(&mut text);
    rendered.map_err(|e| Refusal::Files(format!("a manual page: {e}")))?;
    Ok(String::from_utf8_lossy(&text).into_owned())
}

/// Prints the page of the program, or writes those of all commands.
pub fn run(context: &Context, args: &Man) -> Result<CommandResult, Refusal> {
    let mut program = Cli::command();
    program.build();
    let Some(folder) = &args.out else {
        context.messages.print_text(page(program)?.trim_end());
        return Ok(CommandResult::done());
    };
    let fail = |e: std::io::Error| Refusal::Files(format!("{}: {e}", folder.display()));
    std::fs::create_dir_all(folder).map_err(fail)?;
    let name = |command: &Command| format!("gearbench-{}", command.get_name());
    let mut pages = vec![("gearbench".to_owned(), page(program.clone())?)];
    for command in program.get_subcommands().filter(|c| !c.is_hide_set()) {
        // The built program gives its commands these names.
        pages.push((name(command), page(command.clone())?));
    }
    for (name, text) in &pages {
        write_whole(&folder.join(format!("{name}.1")), text).map_err(fail)?;
    }
    let folder = absolute(folder.clone());
    let line = format!("written: {} pages in {}", pages.len(), folder.display());
    context.messages.print_line(&line);
    Ok(CommandResult::done().with("written", folder))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_command_has_a_page() {
        let folder = tempfile::tempdir().unwrap();
        let args = Man {
            out: Some(folder.path().to_owned()),
        };
        run(&Context::default(), &args).unwrap();
        let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
        assert!(read("gearbench.1").contains("gearbench\\-compare(1)"));
        assert!(read("gearbench-compare.1").contains("\\-\\-integrators"));
        assert!(read("gearbench-fmu.1").contains("\\-\\-fmi"));
    }
}
