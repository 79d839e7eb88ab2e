//! The documents and the program agree: every command of a document is understood, and the generated pages of the book (options,
//! keys, models, integrators) are what the program declares.
//!
//! `GEARBENCH_UPDATE_GOLDEN=1 cargo test --release --locked --workspace --lib documents` writes the pages.

use super::Cli;
use super::document_commands::{commands, documents};
use crate::models::models;
use crate::scene_file::reading::keys::tables;
use crate::studies::files;
use clap::CommandFactory;
use gearbench_integrators::table::{FREE_FLIGHT, METHODS};
use gearbench_reports::dictionary::{DATA_DICTIONARY, with_tables};
use std::fmt::Write as _;
use std::path::Path;

const NOTE: &str = "This page is generated from the program; a test compares it.";

/// Escapes text for a cell of a Markdown table.
fn cell(text: &str) -> String {
    text.trim()
        .replace('|', "\\|")
        .replace('<', "&lt;")
        .replace('\n', " ")
}

/// The help of every command.
fn options() -> String {
    let mut page = format!(
        "# Options of the commands\n\n{NOTE} `gearbench COMMAND --help` prints the same.\n"
    );
    let mut program = Cli::command().term_width(100).disable_colored_help(true);
    program.build();
    for command in program.get_subcommands_mut().filter(|c| !c.is_hide_set()) {
        let help = command.clone().render_long_help().to_string();
        let lines: Vec<&str> = help.lines().map(str::trim_end).collect();
        let (name, help) = (command.get_name(), lines.join("\n"));
        write!(page, "\n## {name}\n\n```text\n{}\n```\n", help.trim_end()).unwrap();
    }
    page
}

/// Words of a name in camel case, as a heading.
fn heading(name: &str) -> String {
    let mut text = String::new();
    for (i, c) in name.trim_end_matches("Table").char_indices() {
        if i > 0 && c.is_uppercase() {
            text.push(' ');
        }
        text.extend(
            c.to_lowercase()
                .filter(|_| i > 0)
                .chain((i == 0).then_some(c)),
        );
    }
    text
}

/// The keys of scene files and check files, and the parameters of the gear models.
fn keys() -> String {
    let mut page = format!(
        "# Keys of scene files and check files\n\n{NOTE} [Scene files](../../../../benchmarks/scenes/README.md) explains the format with \
         examples.\nA key that needs a table of its own has the heading of that table below.\n"
    );
    for table in tables() {
        write!(
            page,
            "\n## {}\n\n| key | meaning |\n|---|---|\n",
            heading(table.name)
        )
        .unwrap();
        for (key, meaning) in table.keys {
            writeln!(page, "| `{key}` | {} |", cell(meaning)).unwrap();
        }
    }
    page.push_str("\n# Parameters of the gear models\n");
    for model in models().iter().filter(|m| !m.parameters.is_empty()) {
        let title = cell(model.title);
        write!(
            page,
            "\n## {}\n\n{title}\n\n| parameter | meaning |\n|---|---|\n",
            model.id
        )
        .unwrap();
        for p in model.parameters {
            let required = if p.required { " (has to be given)" } else { "" };
            writeln!(page, "| `{}` | {}{required} |", p.key, cell(p.meaning)).unwrap();
        }
    }
    page
}

/// The integrators and their parameters.
fn integrators() -> String {
    let mut page = format!(
        "# Integrators\n\n{NOTE} A method is named as on the command line, with its parameters in parentheses and a step or\na tolerance \
         behind `@`: `generalised-alpha(rho_inf=0.8)@500ns`, `dopri5@1e-6`.\n\n| id | method | order | kind | parameters | source |\n|---|---|---|---|---|---|\n"
    );
    for method in METHODS {
        let info = method.info;
        let kind = if info.implicit {
            "implicit"
        } else {
            "explicit"
        };
        let parameters: Vec<String> = (info.parameters.iter())
            .map(|p| {
                let (low, high) = p.range;
                format!(
                    "`{}` = {}, {low} to {high}: {}",
                    p.name,
                    p.default,
                    cell(p.meaning)
                )
            })
            .collect();
        writeln!(
            page,
            "| `{}` | {} | {} | {kind} | {} | {} |",
            info.id,
            cell(info.name),
            info.order,
            parameters.join("; "),
            cell(info.citation)
        )
        .unwrap();
    }
    let (name, meaning) = (FREE_FLIGHT.name, cell(FREE_FLIGHT.meaning));
    write!(
        page,
        "\nAll methods have the parameter `{name}`. {meaning}.\n"
    )
    .unwrap();
    page
}

#[test]
fn pages_are_those_of_the_program() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/book/src/reference");
    for (name, page) in [
        ("options.md", options()),
        ("keys.md", keys()),
        ("integrators.md", integrators()),
        ("../../../data.md", with_tables(DATA_DICTIONARY, files())),
    ] {
        let path = folder.join(name);
        if std::env::var_os("GEARBENCH_UPDATE_GOLDEN").is_some() {
            std::fs::write(&path, &page).unwrap();
        }
        let stored = std::fs::read_to_string(&path).unwrap_or_default();
        let differs = stored.lines().zip(page.lines()).find(|(a, b)| a != b);
        assert!(
            stored == page,
            "{name} is not what the program declares: {differs:?}; GEARBENCH_UPDATE_GOLDEN=1 writes it anew"
        );
    }
}

#[test]
fn commands_of_the_documents_are_understood() {
    let mut checked = 0;
    for page in documents() {
        let text = std::fs::read_to_string(&page).unwrap();
        for command in commands(&text) {
            checked += 1;
            // In a sentence a command may lack its arguments.
            let help = (!command.in_block).then_some("--help");
            let words = command.words.iter().map(String::as_str).chain(help);
            if let Err(e) = Cli::read(words) {
                assert!(
                    !e.use_stderr(),
                    "{}: `{}`\n{e}",
                    page.display(),
                    command.words.join(" ")
                );
            }
        }
    }
    assert!(checked > 100, "{checked} commands");
}
