//! The command `gearbench init`: writes a scene file to start from, or the files of a check.

use crate::cli::command_result::CommandResult;
use crate::cli::files::{ReplaceableFiles, write_whole};
use crate::cli::terminal::{Refusal, absolute};
use crate::context::Context;
use crate::scene_file::{SHIPPED, SceneError, ShippedScene, did_you_mean};
use clap::Args;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  gearbench init                                two gears under load, pair.toml
  gearbench init train --out gearbox.toml       three gears
  gearbench init spur_impact                    a copy of a shipped scene with its fitted constants
  gearbench init own_gears                      a folder with gears of other programs, data in a file, and five commands
  gearbench init check                          check.toml, for `gearbench check`
  gearbench init workflow                       workflow.yml, which runs that check for every pull request
  gearbench init snakemake                      a folder with a workflow of Snakemake, which runs a scan in parts";

/// Templates of scenes in addition to the shipped ones.
const TEMPLATES: [(&str, &str); 3] = [
    ("pair", include_str!("../../templates/pair.toml")),
    ("rack", include_str!("../../templates/rack.toml")),
    ("train", include_str!("../../templates/train.toml")),
];

/// Other files to start from: name, extension, content, next step for the user.
const OTHERS: [(&str, &str, &str, &str); 2] = [
    (
        "check",
        "toml",
        include_str!("../../templates/check.toml"),
        "store its baseline: gearbench check FILE --update",
    ),
    (
        "workflow",
        "yml",
        include_str!("../../templates/workflow.yml"),
        "its first lines state its requirements",
    ),
];

/// Template of several files: the name of its folder, and its files, the main one first.
type FolderTemplate = (&'static str, &'static [(&'static str, &'static [u8])]);

const FOLDERS: [FolderTemplate; 2] = [("own_gears", &OWN_GEARS), ("snakemake", &SNAKEMAKE)];

const SNAKEMAKE: [(&str, &[u8]); 4] = [
    (
        "Snakefile",
        include_bytes!("../../templates/snakemake/Snakefile"),
    ),
    (
        "config.yaml",
        include_bytes!("../../templates/snakemake/config.yaml"),
    ),
    (
        "profiles/default/config.yaml",
        include_bytes!("../../templates/snakemake/profiles/default/config.yaml"),
    ),
    (
        "profiles/slurm/config.yaml",
        include_bytes!("../../templates/snakemake/profiles/slurm/config.yaml"),
    ),
];

const OWN_GEARS: [(&str, &[u8]); 5] = [
    (
        "press.toml",
        include_bytes!("../../examples/own_gears/press.toml"),
    ),
    (
        "press.csv",
        include_bytes!("../../examples/own_gears/press.csv"),
    ),
    (
        "pinion.inp.gz",
        include_bytes!("../../examples/own_gears/pinion.inp.gz"),
    ),
    (
        "wheel.msh.gz",
        include_bytes!("../../examples/own_gears/wheel.msh.gz"),
    ),
    (
        "check.toml",
        include_bytes!("../../examples/own_gears/check.toml"),
    ),
];

/// Arguments of `init`.
#[derive(Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Init {
    /// pair, rack, train, the name of a shipped scene, own_gears, check, workflow or snakemake
    #[arg(value_name = "WHAT", default_value = TEMPLATES[0].0)]
    pub what: String,
    /// File to write [default: WHAT.toml]; for own_gears and snakemake, the folder
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Overwrite an existing file
    #[arg(long)]
    pub force: bool,
}

/// Writes a scene to start from, or a folder of them.
pub fn run(context: &Context, args: &Init) -> Result<CommandResult, Refusal> {
    if let Some(folder) = FOLDERS.iter().find(|(name, _)| *name == args.what) {
        return write_folder(context, args, folder);
    }
    let other = OTHERS.iter().find(|(name, ..)| *name == args.what);
    let (text, ending, next) = match other {
        Some((_, ending, text, next)) => ((*text).to_owned(), *ending, *next),
        None => (text(&args.what)?, "toml", "run it: gearbench compare FILE"),
    };
    let path = (args.out.clone()).unwrap_or_else(|| format!("{}.{ending}", args.what).into());
    write(&[(path.clone(), text.as_bytes())], args.force)?;
    let path = absolute(path);
    context
        .messages
        .print_line(&format!("written: {}", path.display()));
    context
        .messages
        .print_line(&next.replace("FILE", &path.display().to_string()));
    Ok(CommandResult::done().with("written", path))
}

/// Writes files: all of them, or none if one exists, unless `force`.
fn write(files: &[(PathBuf, &[u8])], force: bool) -> Result<(), Refusal> {
    let overwriting = ReplaceableFiles {
        inputs: &[],
        // A file that the user has changed is no longer replaced.
        mark: None,
        force,
    };
    for (path, _) in files {
        overwriting.check(path)?;
    }
    for (path, bytes) in files {
        write_whole(path, bytes).map_err(|e| Refusal::Files(format!("{}: {e}", path.display())))?;
    }
    Ok(())
}

/// Writes several files into a folder: all of them, or none if one exists.
fn write_folder(
    context: &Context,
    args: &Init,
    (name, files): &FolderTemplate,
) -> Result<CommandResult, Refusal> {
    let folder = (args.out.clone()).unwrap_or_else(|| name.into());
    let of_folder = |(name, bytes): &(&str, &'static [u8])| (folder.join(name), *bytes);
    let whole: Vec<(PathBuf, &[u8])> = files.iter().map(of_folder).collect();
    for parent in whole.iter().filter_map(|(path, _)| path.parent()) {
        std::fs::create_dir_all(parent)
            .map_err(|e| Refusal::Files(format!("{}: {e}", parent.display())))?;
    }
    write(&whole, args.force)?;
    let folder = absolute(folder);
    context
        .messages
        .print_line(&format!("written: {}", folder.display()));
    context.messages.print_line(&format!(
        "change to this folder; the first lines of {} contain the commands",
        files[0].0
    ));
    Ok(CommandResult::done().with("written", folder))
}

/// The text of a template or of a shipped scene.
fn text(what: &str) -> Result<String, SceneError> {
    if let Some((_, text)) = TEMPLATES.iter().find(|(name, _)| *name == what) {
        return Ok((*text).to_owned());
    }
    match SHIPPED.iter().find(|s| s.name == what) {
        Some(shipped) => Ok(alone(shipped)),
        None => {
            let names = (TEMPLATES.iter().map(|(name, _)| *name))
                .chain(SHIPPED.iter().map(|s| s.name))
                .chain(OTHERS.iter().map(|o| o.0))
                .chain(FOLDERS.map(|(name, _)| name))
                .collect::<Vec<_>>();
            Err(SceneError::plain(
                format!("there is no template or shipped scene `{what}`"),
                format!(
                    "{}there are {}",
                    did_you_mean(what, &names),
                    names.join(", ")
                ),
            ))
        }
    }
}

/// The scene with its fitted constants in its own tables `[calibration.NAME.LABEL]`.
fn alone(shipped: &ShippedScene) -> String {
    let constants: Vec<String> = (shipped.calibration.lines())
        .map(|line| match line.strip_prefix('[') {
            Some(rest) => format!("[calibration.{rest}"),
            None => line.to_owned(),
        })
        .collect();
    match constants.is_empty() {
        true => shipped.text.to_owned(),
        false => format!(
            "{}\n\n# Fitted constants; `gearbench identify FILE --write` writes others to a calibration file, which then takes precedence.\n{}\n",
            shipped.text.trim_end(),
            constants.join("\n")
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene_file::{Origin, SceneFile};

    /// Written scenes can be read from any folder and have the constants of the shipped ones.
    #[test]
    fn scenes_to_start_from_stand_alone() {
        let names = TEMPLATES
            .iter()
            .map(|t| t.0)
            .chain(SHIPPED.iter().map(|s| s.name));
        for name in names {
            // Under another name nothing that is embedded is found.
            let own = format!("name = \"{name}\"");
            let text = text(name).unwrap();
            assert!(text.contains(&own), "{name}");
            let text = text.replacen(&own, "name = \"mine\"", 1);
            let origin = Origin::File("nowhere/mine.toml".into());
            let scene = SceneFile::unbuilt(&Context::default(), "mine.toml", &text, origin, true);
            let scene = scene.unwrap_or_else(|e| panic!("{name}: {}", e.to_text()));
            assert!(scene.odd.is_empty(), "{name}: {:?}", scene.odd);
            let Ok(shipped) = crate::scene_file::load_for(
                &Context::default(),
                name,
                crate::scene_file::Selection::None,
            ) else {
                continue;
            };
            for (a, b) in scene.models.iter().zip(&shipped.models) {
                assert_eq!(
                    format!("{:?}", a.modelling),
                    format!("{:?}", b.modelling),
                    "{name}"
                );
                assert_eq!(a.gap(), b.gap(), "{name}");
            }
        }
    }

    #[test]
    fn what_there_is_not_is_refused_with_what_there_is() {
        let e = text("traim").unwrap_err();
        assert!(
            e.help_text().unwrap().contains("did you mean `train`"),
            "{}",
            e.to_text()
        );
    }
}
