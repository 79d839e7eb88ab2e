//! Scene file of a choice: the gears and meshes of the original scene, one model, one integrator.

use super::plan::Candidate;
use crate::scene_file::{Origin, SceneError, SceneFile};
use gearbench_integrators::Resolution;
use gearbench_models::law::{Damping, Friction, FrictionForm};
use gearbench_models::spec::{ContactSpec, LocalContact, PointContact, PointRule};
use gearbench_models::stiffness::{Foundation, Hertz, PairStiffness};
use serde::Serialize;
use serde_json::{Value as Json, json};
use toml_edit::{DocumentMut, Item, TableLike, TomlError};

/// Tables and keys that a choice replaces. The tolerance may refer to a model that is gone.
const REPLACED: [&str; 3] = ["models", "study", "tolerance"];

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
    let (model, study) = (model(file, candidate), study(file, candidate));
    Ok(format!("{}\n\n{model}{study}", kept.trim_end()))
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

fn number(x: f64) -> String {
    // Ten digits are enough for anything that was found; whole numbers stay as they are.
    if x.fract() == 0.0 && x.abs() < 1e6 {
        return format!("{x:.0}");
    }
    let short: f64 = format!("{x:.9e}").parse().unwrap_or(x);
    format!("{short:e}")
}

fn quote(text: &str) -> String {
    toml_edit::Value::from(text).to_string()
}

/// A value as TOML has it in a line; nothing is left out of tables.
fn inline(value: &Json) -> String {
    match value {
        Json::Number(x) => x.as_f64().map_or_else(String::new, number),
        Json::String(x) => quote(x),
        Json::Array(all) => {
            let all: Vec<String> = all.iter().map(inline).collect();
            format!("[{}]", all.join(", "))
        }
        Json::Object(all) => {
            let given = all.iter().filter(|(_, value)| !value.is_null());
            let pairs = given.map(|(key, value)| format!("{key} = {}", inline(value)));
            format!("{{ {} }}", pairs.collect::<Vec<_>>().join(", "))
        }
        other => other.to_string(),
    }
}

fn model(file: &SceneFile, candidate: &Candidate) -> String {
    let modelling = &candidate.modelling;
    let first = &modelling.gears[0];
    let others: serde_json::Map<String, Json> = (file.spec.gears.iter().zip(&modelling.gears))
        .filter(|(_, m)| *m != first)
        .map(|(g, m)| {
            let own = json!({ "model": m.id, "parameters": m.parameters });
            (g.name.clone(), own)
        })
        .collect();
    let contacts: Vec<Json> = modelling.contacts.iter().map(contact).collect();
    let alike = contacts.windows(2).all(|w| w[0] == w[1]);
    let gap = candidate.scene.meshes.first().map(|m| m.start.gap);
    let plain = file.spec.meshes.first().map(|m| m.start.gap);
    let rows = [
        ("label", json!("chosen")),
        ("model", json!(first.id)),
        ("parameters", json!(first.parameters)),
        ("gears", Json::Object(others)),
        (
            "contact",
            match contacts.first() {
                Some(one) if alike => one.clone(),
                _ => Json::Array(contacts),
            },
        ),
        ("gap_m", json!(gap.filter(|_| gap != plain))),
    ];
    let empty = |value: &Json| value.is_null() || value.as_object().is_some_and(|o| o.is_empty());
    let mut out = "[[models]]\n".to_owned();
    for (key, value) in rows.iter().filter(|(_, value)| !empty(value)) {
        out.push_str(&format!("{key} = {}\n", inline(value)));
    }
    out
}

/// Returns a value as JSON, or null if it is the default of scenes.
fn given<T: Default + PartialEq + Serialize>(value: &T) -> Json {
    match *value == T::default() {
        true => Json::Null,
        false => json!(value),
    }
}

fn contact(c: &ContactSpec) -> Json {
    let points = c.points.as_ref();
    let penalty = match points.map(|p| p.rule) {
        Some(PointRule::EachNode) => "penalty_n_per_m",
        _ => "penalty_pa_per_m",
    };
    let rule = |p: &PointContact| match p.rule {
        PointRule::Nodes => Some(json!("nodes")),
        _ if !p.has_penalty() => None,
        PointRule::EachNode => Some(json!("nodes")),
        PointRule::Quadrature { along, across } => {
            Some(json!({ "along": along, "across": across }))
        }
    };
    let law = c.damping.id();
    let damping = match c.damping {
        Damping::None => Json::Null,
        Damping::KelvinVoigt { c } | Damping::KelvinVoigtBounded { c } => {
            json!({ "law": law, "damping_ns_per_m": c })
        }
        Damping::KelvinVoigtRatio { ratio } | Damping::RatioAtLoad { ratio } => {
            json!({ "law": law, "ratio": ratio })
        }
        Damping::HuntCrossley { e }
        | Damping::LankaraniNikravesh { e }
        | Damping::Flores { e }
        | Damping::Gonthier { e } => json!({ "law": law, "e": e }),
    };
    json!({
        "law": points.filter(|p| p.hard).map(|_| "hard"),
        "local": points.and_then(|p| (p.local == LocalContact::HalfSpace).then_some("half-space")),
        (penalty): points.filter(|p| p.has_penalty()).map(|p| p.penalty),
        "points": points.and_then(rule),
        "surface": points.map(|p| given(&p.surface)),
        "passes": points.map(|p| given(&p.passes)),
        "damping_ns_per_m3": points.map(|p| given(&p.damping)),
        "reach_m": points.and_then(|p| p.reach),
        "stiffness": stiffness(&c.stiffness),
        "exponent": Some(c.exponent).filter(|x| *x != 1.0),
        "damping": damping,
        "friction": c.friction.as_ref().map(friction),
        "slices": c.slices,
    })
}

fn friction(f: &Friction) -> Json {
    let (form, value) = match f.form() {
        FrictionForm::Regularised(v) => ("v_ref_m_s", v),
        FrictionForm::StickSlip(l) => ("stick_m", l),
    };
    match f.film() {
        None => json!({ "mu": f.mu(), form: value }),
        Some(film) => json!({
            "film": {
                "viscosity_pa_s": film.viscosity,
                "roughness_m": film.roughness,
                "lubricant_factor": film.lubricant,
            },
            form: value,
        }),
    }
}

fn stiffness(s: &PairStiffness) -> Json {
    match s {
        PairStiffness::Constant { per_width, of } => {
            json!({ "kind": "constant", "stiffness_n_per_m2": per_width, "of": given(of) })
        }
        PairStiffness::Parabola {
            per_width,
            along: [slope, curvature],
            of,
        } => json!({
            "kind": "parabola",
            "stiffness_n_per_m2": per_width,
            "path_slope": slope,
            "path_curvature": curvature,
            "of": given(of),
        }),
        PairStiffness::Iso6336 { variation } => {
            json!({ "kind": "iso6336", "variation": variation })
        }
        PairStiffness::Compliance {
            tooth,
            foundation,
            hertz,
        } => json!({
            "kind": "compliance",
            "tooth": tooth.id(),
            "foundation": foundation.id(),
            "root_length": match foundation {
                Foundation::SainsotVelex(root) => given(root),
                _ => Json::Null,
            },
            "hertz": hertz.id(),
            "reference_load_n": match hertz {
                Hertz::Log { reference_load } | Hertz::WeberBanaschek { reference_load } => {
                    *reference_load
                }
                Hertz::Linear | Hertz::Rigid => None,
            },
        }),
        PairStiffness::Table {
            s,
            k,
            of,
            ends,
            interpolation,
        } => json!({
            "kind": "table",
            "path_coordinate_m": s,
            "stiffness_n_per_m": k,
            "of": given(of),
            "ends": given(ends),
            "interpolation": given(interpolation),
        }),
    }
}

fn study(file: &SceneFile, candidate: &Candidate) -> String {
    let resolution = match candidate.method.resolution {
        Resolution::Step(h) => format!("step_s = {}", number(h)),
        Resolution::Tolerance(r) => format!("rtol = {}", number(r)),
    };
    format!(
        "\n[study]\nintegrators = [{{ method = {}, {resolution} }}]\nsamples = {}\n",
        quote(&candidate.method.method.to_string()),
        file.study.samples
    )
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

    #[test]
    fn numbers_read_back() {
        for x in [1e15, 2.5e-7, 60.0, 0.0, 1.234567891e-3, 12.0] {
            let back: f64 = number(x).parse().unwrap();
            assert!((back - x).abs() <= 1e-9 * x.abs(), "{x}");
        }
    }
}
