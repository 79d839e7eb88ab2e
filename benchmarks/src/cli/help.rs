//! The command `gearbench help`: commands in groups, help of one command, and the embedded documents.

use super::command_result::CommandResult;
use super::study_command::StudyCommand;
use super::terminal::Refusal;
use super::{Cli, Command};
use crate::context::Context;
use crate::messages::OutputForm;
use crate::scene_file::did_you_mean;
use clap::{Args, CommandFactory, Subcommand};

/// A document that is compiled into the program.
struct Document {
    name: &'static str,
    title: &'static str,
    text: &'static str,
}

const DOCUMENTS: [Document; 5] = [
    Document {
        name: "scene",
        title: "every key of scene files and check files, with an example",
        text: include_str!("../../scenes/README.md"),
    },
    Document {
        name: "limits",
        title: "what gearbench does not do",
        text: include_str!("../../../docs/limits.md"),
    },
    Document {
        name: "data",
        title: "every column of the CSV files and every key of the records",
        text: include_str!("../../../docs/data.md"),
    },
    Document {
        name: "fmus",
        title: "inputs, outputs and accuracy of exported FMUs",
        text: include_str!("../../../docs/fmu.md"),
    },
    Document {
        name: "rexs",
        title: "import and export of gearboxes by REXS",
        text: include_str!("../../../docs/rexs.md"),
    },
];

/// Groups of commands by purpose, in the order of use: the commands that are no studies, in front of or behind the
/// studies of the group.
const GROUPS: [(&str, &[&str], &[&str]); 5] = [
    ("Start", &["init", "list", "help"], &[]),
    ("Compare and choose", &[], &[]),
    ("Analyse", &[], &["merge"]),
    (
        "Data, meshes and other programs",
        &["reference", "mesh", "reduce"],
        &["fmu", "import", "export"],
    ),
    (
        "Keep and repeat",
        &[],
        &["view", "report", "rerun", "completions", "man"],
    ),
];

/// Titles of the groups with the names of their commands.
fn groups() -> impl Iterator<Item = (&'static str, Vec<&'static str>)> {
    GROUPS.into_iter().map(|(title, before, behind)| {
        let of_group = |(name, group): &(&'static str, &str)| (*group == title).then_some(*name);
        let studies = StudyCommand::GROUPS.iter().filter_map(of_group);
        let names = before.iter().copied().chain(studies);
        (title, names.chain(behind.iter().copied()).collect())
    })
}

/// Arguments of `help`.
#[derive(Args, Clone, Debug)]
pub struct Help {
    /// A command, or a document: scene, limits, data, fmus, rexs
    #[arg(value_name = "TOPIC")]
    pub topic: Option<String>,
}

/// The template of `gearbench --help`.
pub(super) fn template() -> String {
    let commands = Command::augment_subcommands(clap::Command::new("gearbench"));
    let about = |name: &str| {
        let found = commands
            .find_subcommand(name)
            .and_then(clap::Command::get_about);
        found.map(ToString::to_string).unwrap_or_default()
    };
    let line = |name: &str, about: &str| format!("  {name:<12} {about}\n");
    let groups: Vec<String> = groups()
        .map(|(title, names)| {
            let lines: String = names.iter().map(|name| line(name, &about(name))).collect();
            format!("{title}:\n{lines}")
        })
        .collect();
    let documents: String = DOCUMENTS.iter().map(|d| line(d.name, d.title)).collect();
    format!(
        "{{about-with-newline}}\n{{usage-heading}} {{usage}}\n\n{}\nDocuments (gearbench help NAME):\n{documents}\nOptions:\n{{options}}{{after-help}}",
        groups.join("\n")
    )
}

/// Prints a document or the help of a command.
pub(super) fn run(context: &Context, args: &Help) -> Result<CommandResult, Refusal> {
    let mut program = Cli::command();
    program.build();
    let text = match args.topic.as_deref() {
        None => program.render_long_help().to_string(),
        Some(topic) => {
            let document = DOCUMENTS.iter().find(|d| d.name == topic);
            let command = program.find_subcommand_mut(topic);
            match (document, command) {
                (Some(document), _) => document.text.to_owned(),
                (None, Some(command)) => command.render_long_help().to_string(),
                (None, None) => return Err(unknown(topic)),
            }
        }
    };
    if context.messages.form != OutputForm::Json {
        context.messages.print_text(text.trim_end());
    }
    Ok(CommandResult::done().with("text", text))
}

fn unknown(topic: &str) -> Refusal {
    let commands = groups().flat_map(|(_, names)| names);
    let known: Vec<&str> = DOCUMENTS.iter().map(|d| d.name).chain(commands).collect();
    Refusal::Input(miette::miette!(
        help = format!(
            "{}there are {}",
            did_you_mean(topic, &known),
            known.join(", ")
        ),
        "there is no help on `{topic}`"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every command belongs to exactly one group of the help.
    #[test]
    fn every_command_is_in_one_group() {
        let program = Cli::command();
        let names = program.get_subcommands().map(clap::Command::get_name);
        for name in names {
            let found = groups().flat_map(|(_, names)| names);
            assert_eq!(found.filter(|n| *n == name).count(), 1, "{name}");
        }
        for (_, names) in groups() {
            for name in names {
                assert!(program.find_subcommand(name).is_some(), "{name}");
            }
        }
        let documents = DOCUMENTS.iter().map(|d| d.name);
        let mut both = documents.filter(|d| program.find_subcommand(d).is_some());
        assert_eq!(both.next(), None, "a document has the name of a command");
    }

    #[test]
    fn documents_are_whole() {
        for document in &DOCUMENTS {
            assert!(document.text.starts_with("# "), "{}", document.name);
        }
    }
}
