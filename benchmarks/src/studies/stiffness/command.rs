//! `gearbench stiffness SCENE`: static mesh stiffness, load sharing and transmission error of its models.

use super::arguments::Stiffness;
use super::csv::summary_csv;
use super::plan::{Entry, formulas, includes};
use super::run::{Row, solve};
use super::summary::summarise;
use crate::cli::answer::Answer;
use crate::cli::files::write_whole;
use crate::cli::progress::Display;
use crate::cli::study_folder::StudyFolder;
use crate::cli::terminal::{Refusal, absolute, refuse_study, say};
use crate::cli::values::DEFAULT_LOAD;
use crate::experiment::error::StudyError;
use crate::models::models;
use crate::scene_file::{self, Selection};
use gearbench_models::scene::Scene;
use gearbench_models::spec::{Load, base_radius, initial_speed, signed_base_radius};
use gearbench_reference::statics::Load as StaticLoad;
use gearbench_reports::numbers::{quantity, short};
use gearbench_reports::{StiffnessCurves, stiffness};
use std::path::{Path, PathBuf};

/// Loads the models of a scene over a mesh cycle and writes a folder.
pub fn run(args: &Stiffness) -> Result<Answer, Refusal> {
    let scene = scene_file::load_for(&args.scene, Selection::Labels(args.models.as_deref()))?;
    let choices = scene.select(args.models.as_deref())?;
    let mut entries: Vec<Entry> = choices
        .iter()
        .map(|c| Entry {
            label: c.label.clone(),
            includes: includes(&c.modelling, models()),
            spec: scene.spec_for(c),
            modelling: c.modelling.clone(),
            stated: None,
        })
        .collect();
    let first = &entries[0];
    if first.spec.gears.len() != 2 || first.spec.meshes.len() != 1 {
        return Err(Refusal::Input(miette::miette!(
            help = "take a scene with one mesh of two gears",
            "the scene `{}` has {} gears and {} meshes",
            scene.name,
            first.spec.gears.len(),
            first.spec.meshes.len()
        )));
    }
    entries.extend(formulas(&first.spec, &first.modelling));

    // The formulas stand for rigid gears of the same scene.
    let own = entries.last().and_then(own_force);
    let folder = StudyFolder::of(&args.output, &scene, "stiffness")?;
    let total = args.positions * entries.len();
    let display = Display::new(total);
    let mut rows: Vec<Row> = Vec::new();
    let mut load_text = String::new();
    for (i, entry) in entries.iter().enumerate() {
        let (force, origin) = force_of(args, entry, own)?;
        let done = args.positions * i;
        let row = solve(
            entry,
            models(),
            StaticLoad::Force(force),
            args.positions,
            |n| {
                display.tell(done + n, total, &entry.label);
            },
        );
        let fail = |e| refuse_study(&scene, StudyError::Statics(entry.label.clone(), e));
        let row = row.map_err(fail)?;
        load_text = format!(
            "{} along the line of action in the transverse plane, {} N/mm, {origin}",
            quantity(force, "N", 6),
            short(1e-3 * force / row.cycle.face_width, 6)
        );
        rows.push(row);
    }
    drop(display);
    let dir = folder.path();
    summarise(&scene.name, &load_text, &rows);
    write(dir, &rows, &load_text)?;
    let written = absolute(dir.to_owned());
    folder.close();
    say(&format!("written: {}", written.display()));
    let table: Vec<_> = rows.iter().map(Row::told).collect();
    Ok(Answer::done().with("folder", written).with("rows", table))
}

/// Force in the transverse plane by which the loads of the scene press the flanks of the start [N]; `None` where they do not.
///
/// Loads are those at the end of their ramps. Between gears that the loads accelerate the force is that of rigid gears:
///
/// ```text
/// F = (F_1/m_1 + F_2/m_2) / (1/m_1 + 1/m_2),    F_i = T_i / r_bi,    m_i = I_i / r_bi^2,  infinite where the hub is held
/// ```
fn own_force(rigid: &Entry) -> Option<f64> {
    let built = Scene::build(&rigid.spec, &rigid.modelling, models()).ok()?;
    let mesh = &rigid.spec.meshes[0];
    let sign = mesh.start.side.sign();
    let (mut sum, mut inverse) = (0.0, 0.0);
    for i in mesh.gears {
        let gear = &rigid.spec.gears[i];
        let radius = signed_base_radius(&gear.body);
        let torque: f64 = (rigid.spec.loads_at(i))
            .map(|load| match load {
                Load::Applied(profile) => profile.settled(),
                Load::Viscous(c) => -c * initial_speed(&gear.mount, gear.speed),
            })
            .sum();
        let hub = &built.gears()[i].model.hub().hub;
        if hub.is_free() {
            sum += sign * torque / radius * radius.powi(2) / hub.inertia;
            inverse += radius.powi(2) / hub.inertia;
        }
    }
    Some(sum / inverse).filter(|force| *force > 0.0 && force.is_finite())
}

/// The force along the line of action in the transverse plane [N], and where it is from: the command line, the loads of the
/// scene, or the default.
fn force_of(
    args: &Stiffness,
    entry: &Entry,
    own: Option<f64>,
) -> Result<(f64, &'static str), Refusal> {
    let gears = &entry.spec.gears;
    let [a, b] = entry.spec.meshes[0].gears;
    let layout = gearbench_models::spec::mesh_layout(&gears[a], &gears[b])
        .map_err(|e| Refusal::Failed(e.to_string()))?;
    let over_width = |load: f64| 1e3 * load * layout.face_width;
    Ok(match (args.torque, args.load, own) {
        (Some(torque), ..) => (torque.abs() / base_radius(&gears[a].body), "from --torque"),
        (None, Some(load), _) => (over_width(load), "from --load"),
        (None, None, Some(force)) => (force, "from the loads of the scene"),
        (None, None, None) => (over_width(DEFAULT_LOAD), "the default"),
    })
}

/// Name of a file for a label.
fn file_name(label: &str) -> String {
    let plain = |c: char| {
        if c.is_ascii_alphanumeric() || c == '-' || c == '_' {
            c.to_ascii_lowercase()
        } else {
            '-'
        }
    };
    format!("cycle_{}.csv", label.chars().map(plain).collect::<String>())
}

/// Writes all files; each is complete before it takes its name.
fn write(dir: &Path, rows: &[Row], load: &str) -> Result<(), Refusal> {
    let c = &rows[0].cycle;
    let relative = |s: f64| (s - c.pitch_point) / c.base_pitch;
    let limits: String = (rows.iter())
        .flat_map(|r| {
            r.limits
                .iter()
                .map(|l| format!(" Out of range: {}: {l}.", r.label))
        })
        .collect();
    let chart = stiffness(&StiffnessCurves {
        remark: format!("{load}.{limits}"),
        path: c.path.map(relative),
        curves: rows.iter().map(Row::curve).collect(),
    })
    .map_err(|e| Refusal::Failed(e.to_string()))?;
    let mut files: Vec<(String, String)> = vec![
        (chart.file.to_string(), chart.svg),
        ("stiffness.csv".into(), summary_csv(rows)),
    ];
    files.extend(rows.iter().map(|r| (file_name(&r.label), r.csv())));
    let fail =
        |path: &PathBuf, e: std::io::Error| Refusal::Files(format!("{}: {e}", path.display()));
    std::fs::create_dir_all(dir).map_err(|e| fail(&dir.to_path_buf(), e))?;
    for (name, text) in files {
        let path = dir.join(&name);
        write_whole(&path, &text).map_err(|e| fail(&path, e))?;
    }
    Ok(())
}
