//! `gearbench stiffness SCENE`: static mesh stiffness, load sharing and transmission error of its models.

use super::arguments::Stiffness;
use super::{Entry, Row, build_error, formulas, includes, solve, summary_csv};
use crate::cli::terminal::{Refusal, progress_bar, say};
use crate::models::models;
use crate::scene_file::{self, Selection};
use gearbench_models::spec::effective_radius;
use gearbench_reference::statics::{Load, StaticsError};
use gearbench_reports::{StiffnessCurves, stiffness};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// N/(mm um) in N/m^2.
const PER_MM_UM: f64 = 1e9;

/// Loads the models of a scene over a mesh cycle and writes a folder.
pub fn run(args: &Stiffness) -> Result<ExitCode, Refusal> {
    let scene = scene_file::load_for(&args.scene, Selection::Labels(args.models.as_deref()))?;
    let choices = scene.select(args.models.as_deref())?;
    let mut entries: Vec<Entry> = choices
        .iter()
        .map(|c| Entry {
            label: c.label.clone(),
            includes: includes(&c.modelling),
            spec: scene.spec_for(c),
            modelling: c.modelling.clone(),
        })
        .collect();
    let own = entries.len();
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

    let bar = progress_bar(args.positions * entries.len());
    let mut rows: Vec<Row> = Vec::new();
    let mut load_text = String::new();
    for (i, entry) in entries.iter().enumerate() {
        bar.set_message(entry.label.clone());
        let force = force_of(args, entry)?;
        let done = args.positions * i;
        let row = solve(entry, models(), Load::Force(force), args.positions, |n| {
            bar.set_position((done + n) as u64);
        });
        let row = row.map_err(|e| {
            bar.finish_and_clear();
            match build_error(&e) {
                Some(b) if i < own => Refusal::from(scene.locate_in(&entry.label, b)),
                _ => refuse(&entry.label, &e),
            }
        })?;
        load_text = format!(
            "{:.4} N along the line of action, {:.4} N/mm",
            force,
            1e-3 * force / row.cycle.face_width
        );
        rows.push(row);
    }
    bar.finish_and_clear();

    let dir = args
        .out
        .clone()
        .unwrap_or_else(|| Path::new("out").join(&scene.name).join("stiffness"));
    print(&scene.name, &load_text, &rows);
    write(&dir, &rows, &load_text)?;
    say(&format!("written: {}", dir.display()));
    Ok(ExitCode::SUCCESS)
}

fn refuse(label: &str, e: &StaticsError) -> Refusal {
    Refusal::Failed(format!("{label}: {e}"))
}

/// The force along the line of action that the command line asks for.
fn force_of(args: &Stiffness, entry: &Entry) -> Result<f64, Refusal> {
    let gears = &entry.spec.gears;
    let [a, b] = entry.spec.meshes[0].gears;
    let layout = gearbench_models::spec::mesh_layout(&gears[a], &gears[b])
        .map_err(|e| Refusal::Failed(e.to_string()))?;
    Ok(match args.torque {
        Some(torque) => torque / effective_radius(&gears[a].body),
        None => 1e3 * args.load * layout.face_width,
    })
}

fn print(scene: &str, load: &str, rows: &[Row]) {
    let c = &rows[0].cycle;
    say(&format!(
        "{scene}: {load}, {} positions over one base pitch, common width {:.4} mm",
        c.positions.len(),
        1e3 * c.face_width
    ));
    say("stiffness in N/(mm um), transmission error in um:");
    say("  c'      largest secant stiffness of one pair, its load over the approach of the gears");
    say("  at C    the same at the pitch point");
    say("  c_g     mean secant stiffness of the mesh;  tangent: its slope at the load, mean");
    say("  TE      mean static transmission error, and peak to peak");
    say("");
    let wide = rows.iter().map(|r| r.label.len()).max().unwrap_or(0).max(5);
    say(&format!(
        "{:<wide$} {:>7} {:>7} {:>7} {:>8} {:>8} {:>8}  includes",
        "model", "c'", "at C", "c_g", "tangent", "TE", "p-p"
    ));
    for r in rows {
        let c = &r.cycle;
        say(&format!(
            "{:<wide$} {:>7.2} {:>7.2} {:>7.2} {:>8.2} {:>8.3} {:>8.3}  {}",
            r.label,
            c.single_stiffness() / PER_MM_UM,
            c.at_pitch_point() / PER_MM_UM,
            c.mesh_stiffness() / PER_MM_UM,
            c.mesh_tangent() / PER_MM_UM,
            1e6 * c.mean_error(),
            1e6 * c.peak_to_peak(),
            r.includes
        ));
    }
    for r in rows.iter().filter(|r| r.unknowns > 0) {
        say(&format!(
            "{}: {} unknowns, set up in {:.2} s, {} equilibria with {} Newton iterations in {:.2} s",
            r.label, r.unknowns, r.wall[0], r.work[0], r.work[1], r.wall[1]
        ));
    }
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
    let chart = stiffness(&StiffnessCurves {
        remark: format!("{load}."),
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
        let (path, staged) = (dir.join(&name), dir.join(format!("{name}.part")));
        std::fs::write(&staged, text).map_err(|e| fail(&staged, e))?;
        std::fs::rename(&staged, &path).map_err(|e| fail(&path, e))?;
    }
    Ok(())
}
