//! Scene file of a choice: the gears and meshes of the original scene, one model, one integrator.

use super::plan::Candidate;
use crate::scene_file::format::{
    Count, IntegratorTable, ModelTable, StudyTable, WriteError, insert,
};
use crate::scene_file::{Origin, SceneError, SceneFile};
use gearbench_models::spec::SceneSpec;
use toml_edit::{DocumentMut, Item, TableLike, TomlError};

/// Tables and keys that a choice replaces. The tolerance may refer to a model that is gone.
const REPLACED: [&str; 4] = ["damping", "models", "study", "tolerance"];

/// Returns the text of a scene file with the chosen model; `remarks` head it as comments.
///
/// # Errors
/// [`SceneError`] when what was written is no scene: its models stand in a way that was not seen through.
pub fn text(
    file: &SceneFile,
    candidate: &Candidate,
    remarks: &[String],
) -> Result<String, SceneError> {
    let remarks = remarks
        .iter()
        .map(|r| format!("# {}\n", r.replace('\n', " ")));
    let out = remarks.collect::<String>() + &written(file, candidate)?;
    SceneFile::parse(&file.context, "chosen.toml", &out, Origin::Shipped, true)?;
    Ok(out)
}

/// The scene with a choice.
fn written(file: &SceneFile, candidate: &Candidate) -> Result<String, SceneError> {
    let kept = placed(&scene_without_choice(file.text())?, file)?;
    let mut document = parsed(&format!("{}\n", kept.trim_end()))?;
    let failed = |e: WriteError| SceneError::plain(e.to_string(), "choose with other limits");
    insert(&mut document, "models", &vec![model(file, candidate)]).map_err(failed)?;
    insert(&mut document, "study", &study(file, candidate)).map_err(failed)?;
    Ok(document.to_string())
}

fn parsed(text: &str) -> Result<DocumentMut, SceneError> {
    text.parse().map_err(|e: TomlError| {
        let help = "a choice is written into a scene that is TOML";
        SceneError::plain(e.to_string(), help)
    })
}

/// A scene whose tables of references are found from any folder.
fn placed(text: &str, file: &SceneFile) -> Result<String, SceneError> {
    let mut document = parsed(text)?;
    for r in &file.references {
        let Some(path) = r.file().and_then(|p| std::path::absolute(p).ok()) else {
            continue;
        };
        let path = toml_edit::value(path.display().to_string());
        let table = match r.index() {
            None => match document.get_mut("reference") {
                Some(word) if word.is_str() => {
                    *word = path;
                    continue;
                }
                other => other.and_then(Item::as_table_like_mut),
            },
            Some(i) => (document.get_mut("references")).and_then(|all| match all {
                Item::ArrayOfTables(all) => all.get_mut(i).map(|t| t as &mut dyn TableLike),
                all => {
                    let inline = all.as_array_mut()?.get_mut(i)?.as_inline_table_mut()?;
                    Some(inline as &mut dyn TableLike)
                }
            }),
        };
        if let Some(table) = table {
            table.insert("csv", path);
        }
    }
    Ok(document.to_string())
}

/// A scene without what a choice replaces, and without the comments right above that.
fn scene_without_choice(text: &str) -> Result<String, SceneError> {
    let mut document = parsed(text)?;
    for key in REPLACED {
        document.remove(key);
    }
    Ok(document.to_string())
}

/// The table of the chosen model.
fn model(file: &SceneFile, candidate: &Candidate) -> ModelTable {
    let names: Vec<&str> = file.spec.gears.iter().map(|g| g.name.as_str()).collect();
    let gap = |scene: &SceneSpec| scene.meshes.first().map(|m| m.start.gap);
    let own = gap(&candidate.scene).filter(|own| Some(*own) != gap(&file.spec));
    ModelTable {
        gap_m: own,
        ..ModelTable::of("chosen", &names, &candidate.modelling)
    }
}

/// The table `[study]` with the chosen integrator.
fn study(file: &SceneFile, candidate: &Candidate) -> StudyTable {
    StudyTable {
        integrators: Some(vec![IntegratorTable::from(&candidate.method)]),
        samples: Some(Count(file.study.samples)),
        ..StudyTable::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::context::Context;
    use crate::scene_file::{ModelChoice, Selection, load_for};
    use crate::studies::choose::detail::Detail;
    use crate::studies::choose::level::Level;
    use gearbench_integrators::table::DOPRI5;

    #[test]
    fn replaced_parts_go_with_their_comments() {
        let text = "name = \"x\" # [[models]]\ntolerance = { limit = 1 }\n\n[gears.a]\nteeth = 20\n\n# rigid\n\
                    [[models]]\nmodel = \"rigid\"\ncontact = { table = [\n[1.0, 2.0],\n] }\n[models.parameters]\nx = 1\n\
                    # kept\n[[meshes]]\ngears = [\"a\"]\n[study]\nsamples = 3\n";
        assert_eq!(
            scene_without_choice(text)
                .unwrap()
                .split('\n')
                .filter(|l| !l.is_empty())
                .collect::<Vec<_>>(),
            [
                "name = \"x\" # [[models]]",
                "[gears.a]",
                "teeth = 20",
                "# kept",
                "[[meshes]]",
                "gears = [\"a\"]"
            ]
        );
        let quoted = "description = \"\"\"\n[[models]]\nof words\"\"\"\n[gears.a]";
        assert_eq!(scene_without_choice(quoted).unwrap().trim_end(), quoted);
    }

    /// The folder of the choice is another one: tables of references are found from there too.
    #[test]
    fn tables_of_references_are_found_from_elsewhere() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("s.toml");
        let base = load_for(&Context::default(), "hammer", Selection::None).unwrap();
        for (one, several) in [
            ("reference = \"a.csv\"", ""),
            (
                "reference = { csv = \"a.csv\" }",
                "\n[[references]]\ncsv = \"b.csv\"\n",
            ),
            (
                "references = [{ csv = \"a.csv\" }, { csv = \"b.csv\" }]",
                "",
            ),
        ] {
            let text = format!("{one}\n{}{several}", base.text());
            let origin = Origin::File(path.clone());
            let file =
                SceneFile::unbuilt(&Context::default(), "s.toml", &text, origin, true).unwrap();
            let text = placed(file.text(), &file).unwrap();
            let read =
                SceneFile::unbuilt(&Context::default(), "c.toml", &text, Origin::Shipped, true)
                    .unwrap();
            assert_eq!(read.references.len(), file.references.len(), "{text}");
            for r in &read.references {
                assert!(r.file().unwrap().starts_with(folder.path()), "{text}");
            }
        }
    }

    /// Models of all kinds, written and read, are written alike again.
    #[test]
    fn what_is_written_is_read() {
        let write = |file: &SceneFile, choice: &ModelChoice| {
            let candidate = Candidate {
                level: Level::QuasiStatic(Detail::Given),
                scene: file.spec_for(choice).into(),
                modelling: choice.modelling.clone().into(),
                method: DOPRI5.at_tolerance(1e-6),
            };
            written(file, &candidate).unwrap()
        };
        for name in [
            "spur_impact",
            "rack_pinion",
            "hammer",
            "loaded_mesh",
            "spur_rotation",
        ] {
            let file = load_for(&Context::default(), name, Selection::None).unwrap();
            for choice in &file.models {
                let first = write(&file, choice);
                let read = SceneFile::unbuilt(
                    &Context::default(),
                    "chosen.toml",
                    &first,
                    Origin::Shipped,
                    true,
                );
                let read = read.unwrap_or_else(|e| panic!("{e:?}\n{first}"));
                assert_eq!(read.models.len(), 1, "{first}");
                assert_eq!(write(&read, &read.models[0]), first);
            }
        }
    }
}
