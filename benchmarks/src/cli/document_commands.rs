//! Commands in the documents of the repository: code blocks, and code within sentences.
//!
//! The unit tests of the command line and the tests of the built program share this module.

use super::command_line::split;
use std::path::{Path, PathBuf};

/// A command line of a document.
pub struct DocumentCommand {
    /// Words of the command, with the name of the program.
    pub words: Vec<String>,
    /// True if the command is a line of a code block; within a sentence it may lack its arguments.
    pub in_block: bool,
    /// Output that the document shows below a line `$ gearbench ...`; empty if it shows none.
    pub output: String,
}

/// Adds all Markdown files of a folder and its subfolders.
fn add_pages(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        match path.extension() {
            _ if path.is_dir() => add_pages(&path, found),
            Some(e) if e == "md" => found.push(path),
            _ => {}
        }
    }
}

/// Returns the documents of the repository whose commands are tested.
pub fn documents() -> Vec<PathBuf> {
    // Two packages compile this file.
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors();
    let root = crates.skip(1).find(|p| p.join("docs").is_dir());
    let root = root.expect("the root of the repository");
    let mut all = vec![root.join("README.md"), root.join("CONTRIBUTING.md")];
    all.push(root.join("benchmarks/scenes/README.md"));
    add_pages(&root.join("docs"), &mut all);
    add_pages(&root.join("examples"), &mut all);
    all
}

/// Returns the words of a command line of a document, whose quotes are double or single and whose comments begin with
/// ` #`.
fn words(line: &str) -> Vec<String> {
    // In the examples of a help text two spaces separate command and description.
    let line = line.split("  ").next().unwrap_or_default();
    let line = line.split(" #").next().unwrap_or_default();
    let mut quoted = false;
    let ends_command = |c: char| {
        quoted ^= c == '\'' || c == '"';
        !quoted && ['|', '>', ';', '&'].contains(&c)
    };
    let line = line.split(ends_command).next().unwrap_or_default();
    let line = line.replace('"', "'");
    [vec!["gearbench".to_owned()], split(line.trim())].concat()
}

/// Returns the commands of `gearbench` in a document. Commands with placeholders are left out.
pub fn commands(text: &str) -> Vec<DocumentCommand> {
    let mut found: Vec<DocumentCommand> = Vec::new();
    let (mut inside, mut shows_output) = (false, false);
    let is_program = |line: &str| line.starts_with("gearbench ") || line == "gearbench";
    let command = |line: &str, in_block: bool| DocumentCommand {
        words: words(line),
        in_block,
        output: String::new(),
    };
    for line in text.lines() {
        if line.trim_start().starts_with("```") {
            (inside, shows_output) = (!inside, false);
        } else if inside {
            let prompted = line.trim_start().strip_prefix("$ ");
            let shell = prompted.unwrap_or(line.trim_start());
            let shell = shell
                .strip_prefix("cargo run --release -- ")
                .map_or(shell.into(), |rest| format!("gearbench {rest}"));
            // Commands that continue in the next line are skipped.
            let is_command = is_program(&shell) && !shell.ends_with('\\');
            if is_command {
                found.push(command(&shell, true));
            } else if let (true, None, Some(last)) = (shows_output, prompted, found.last_mut()) {
                last.output.push_str(line);
                last.output.push('\n');
            }
            shows_output = match prompted {
                Some(_) => is_command,
                None => shows_output && !is_command,
            };
        } else {
            let code = line.split('`').skip(1).step_by(2);
            found.extend(code.filter(|c| is_program(c)).map(|c| command(c, false)));
        }
    }
    // Words in capitals, dots and brackets are placeholders.
    let is_placeholder = |w: &String| {
        w.contains("...") || w.contains(['[', '$']) || w.chars().all(|c| c.is_ascii_uppercase())
    };
    found.retain(|command| !command.words.iter().any(is_placeholder));
    found
}
