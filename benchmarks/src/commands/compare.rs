//! `gearbench compare SCENE`.

use super::{Refusal, exit_code, progress_bar, refuse_run, say, write};
use crate::cli::Compare;
use crate::scene_file::{self, ModelChoice, SceneFile, Selection};
use crate::study::compare::{LEFT_OUT, Plan, compare, methods_from};
use gearbench_integrators::Resolution;
use gearbench_models::geometry::Pair;
use gearbench_models::scene::build::{lever, mesh_layout};
use gearbench_models::scene::spec::{Body, ModelSpec, SceneSpec, Value};
use gearbench_models::stiffness::{Mate, build_with_warnings};
use gearbench_reports::numbers::short;
use gearbench_reports::record::{Results, Status};

use std::process::ExitCode;
use std::time::Duration;

/// Runs the comparison and writes its folder.
pub fn run(args: &Compare, command: &str) -> Result<ExitCode, Refusal> {
    let scene = scene_file::load_for(&args.scene, Selection::Labels(args.models.as_deref()))?;
    let choices = scene.select(args.models.as_deref())?;
    let reference = scene
        .reference
        .as_deref()
        .map(gearbench_reference::reference)
        .transpose()
        .map_err(|e| Refusal::Files(e.to_string()))?;
    let plan = Plan {
        command: command.to_string(),
        settings: settings(&scene, &choices, args.no_events),
        repeats: args.repeats.max(1),
        events: scene.study.events && !args.no_events,
        timeout: Duration::from_secs_f64(args.timeout),
        ..Plan::of(&scene, &choices, reference.as_ref())
    };
    let plan = match &args.integrators {
        // What the command line asks for goes for all models.
        Some(text) => plan.with_methods(
            methods_from(text, &scene.study.integrators)
                .map_err(crate::study::run::RunError::Method)
                .map_err(refuse_run)?,
        ),
        None => plan,
    };
    let bar = progress_bar(plan.len());
    let results = compare(&plan, None, |done, what| {
        bar.set_position(done as u64);
        bar.set_message(what.to_string());
    });
    bar.finish_and_clear();
    let results = results.map_err(refuse_run)?;

    write(&results, (&args.out, &scene.name), summarise)?;
    Ok(exit_code(&results))
}

/// One line per run, failures with their reason.
fn summarise(results: &Results) {
    let against = results.references.first().map_or("self", |r| r.id.as_str());
    say(&format!(
        "{:<24} {:<30} {:>9} {:>9} {:>8}  force error against {against}",
        "model", "integrator", "step/rtol", "wall", "steps"
    ));
    for r in &results.runs {
        let resolution = r
            .step
            .or(r.rtol)
            .map_or(String::new(), |x| format!("{x:.0e}"));
        let wall = if r.wall_s < 1e-3 {
            format!("{:.0} us", r.wall_s * 1e6)
        } else if r.wall_s < 1.0 {
            format!("{:.1} ms", r.wall_s * 1e3)
        } else {
            format!("{:.2} s", r.wall_s)
        };
        let outcome = match (
            r.status,
            r.against(against).and_then(|m| m.force_l2_aligned),
        ) {
            (Status::Converged, Some(e)) => format!("{} %", short(100.0 * e, 3)),
            (Status::Converged, None) => "converged".into(),
            (status, _) => format!(
                "{status}: {}",
                r.message.as_deref().unwrap_or("no reason given")
            ),
        };
        say(&format!(
            "{:<24} {:<30} {:>9} {:>9} {:>8}  {}",
            r.model_label(),
            r.integrator,
            resolution,
            wall,
            r.steps,
            outcome
        ));
    }
    for (what, pair) in results.settings.iter().filter(|(what, _)| what == LEFT_OUT) {
        say(&format!("{what}: {pair}"));
    }
    let failed = results
        .runs
        .iter()
        .filter(|r| r.status.is_failure())
        .count();
    if failed > 0 {
        say(&format!(
            "{failed} of {} runs failed; they are recorded as failures",
            results.runs.len()
        ));
    }
}

/// What a reader must know of the scene: geometry, positions, loads, models and where their constants come
/// from, conventions of the stiffness.
pub(super) fn settings(
    scene: &SceneFile,
    choices: &[&ModelChoice],
    no_events: bool,
) -> Vec<(String, String)> {
    let mut rows: Vec<(String, String)> = Vec::new();
    let mut row = |what: &str, value: String| rows.push((what.to_string(), value));
    row(
        "simulated time",
        format!("{} ms", short(scene.duration * 1e3, 4)),
    );
    for g in &scene.spec.gears {
        row(&format!("gear {}", g.name), gear_text(g));
    }
    for m in &scene.spec.meshes {
        let [a, b] = m.gears.map(|i| &scene.spec.gears[i]);
        if let Ok(l) = mesh_layout(a, b) {
            row(
                &format!("mesh {} - {}", a.name, b.name),
                format!(
                    "distance {} mm, working pressure angle {} deg, contact ratio {}, backlash {} um along the line of action",
                    short(l.distance * 1e3, 5),
                    short(l.working_pressure_angle.to_degrees(), 5),
                    short(l.contact_ratio, 4),
                    short(l.backlash * 1e6, 4)
                ),
            );
        }
    }
    for choice in choices {
        row(
            &format!("model {}", choice.label),
            model_text(scene, choice),
        );
    }
    row(
        "events",
        if no_events || !scene.study.events {
            "not located: contact opens and closes inside steps".into()
        } else {
            "contact opening and closing, ends of the path of contact and table knots are located"
                .into()
        },
    );
    row(
        "converged solution (self)",
        "dopri5, rtol 1e-10 (1e-8 where that takes too long); a tolerance multiplies the scene's typical deflection and speed".into(),
    );
    let steps: Vec<String> = scene
        .study
        .integrators
        .iter()
        .map(|m| match m.resolution {
            Resolution::Step(h) => format!("{} h {} us", m.text, short(h * 1e6, 3)),
            Resolution::Tolerance(r) => format!("{} rtol {r:.0e}", m.text),
        })
        .collect();
    row("integrators of the scene", steps.join("; "));
    rows
}

fn gear_text(g: &gearbench_models::scene::spec::GearSpec) -> String {
    let toothing = match &g.body {
        Body::Gear(x) => {
            let p = x.params();
            format!(
                "z = {}, m = {} mm, x = {}, b = {} mm, helix {} deg",
                p.teeth,
                short(p.module * 1e3, 4),
                short(p.profile_shift, 4),
                short(p.face_width * 1e3, 4),
                short(p.helix_angle.to_degrees(), 4)
            )
        }
        Body::Rack(x) => {
            let p = x.params();
            format!(
                "rack, {} teeth, m = {} mm, b = {} mm",
                p.teeth,
                short(p.module * 1e3, 4),
                short(p.face_width * 1e3, 4)
            )
        }
    };
    let (inertia, unit, speed) = match &g.body {
        Body::Gear(x) => (
            g.inertia
                .unwrap_or_else(|| x.mass_properties(g.material.density).izz),
            "kg m^2",
            "rad/s",
        ),
        Body::Rack(x) => (
            g.inertia.unwrap_or_else(|| x.mass(g.material.density)),
            "kg",
            "m/s",
        ),
    };
    let mount = match &g.mount {
        gearbench_models::mount::Mount::Fixed => "fixed",
        gearbench_models::mount::Mount::Revolute => "revolute",
        gearbench_models::mount::Mount::Prismatic => "prismatic",
        gearbench_models::mount::Mount::Driven(_) => "driven",
    };
    format!(
        "{toothing}; {mount}, inertia {} {unit}, initial speed {} {speed}, {} load(s)",
        short(inertia + g.added_inertia, 5),
        short(g.speed, 5),
        g.loads.len()
    )
}

fn model_text(scene: &SceneFile, choice: &ModelChoice) -> String {
    let spec = scene.spec_for(choice);
    let mut parts = Vec::new();
    if let Some(c) = &choice.calibration {
        parts.push(format!("calibration `{}` of scene {}", c.name, c.scene));
    } else {
        parts.push("constants as given in the scene".into());
    }
    for (contact, mesh) in choice.modelling.contacts.iter().zip(&spec.meshes) {
        parts.push(format!("contact: {}", contact.stiffness.describe()));
        parts.push(format!(
            "law exponent {}, damping {}",
            contact.exponent,
            contact.damping.id()
        ));
        parts.push(format!(
            "gap at the start {} um",
            short(mesh.start.gap * 1e6, 4)
        ));
        parts.extend(warnings(&spec, mesh.gears, contact));
    }
    if let Some(first) = choice.modelling.gears.first() {
        parts.extend(parameters(first));
        if choice.modelling.gears.iter().any(|g| g.id != first.id) {
            let ids: Vec<&str> = choice
                .modelling
                .gears
                .iter()
                .map(|g| g.id.as_str())
                .collect();
            parts.push(format!("gears modelled as {}", ids.join(", ")));
        }
    }
    parts.join("; ")
}

fn parameters(model: &ModelSpec) -> Vec<String> {
    model
        .parameters
        .iter()
        .map(|(key, value)| match value {
            Value::Number(x) => format!("{key} = {}", short(*x, 5)),
            Value::Text(x) => format!("{key} = {x}"),
            Value::Flag(x) => format!("{key} = {x}"),
            Value::List(x) => format!("{key}: {} values", x.len()),
        })
        .collect()
}

/// Limits of the stiffness formulas that the scene does not keep.
fn warnings(
    spec: &SceneSpec,
    gears: [usize; 2],
    contact: &gearbench_models::scene::spec::ContactSpec,
) -> Vec<String> {
    let [a, b] = gears.map(|i| &spec.gears[i]);
    let (Body::Gear(ga), Ok(l)) = (&a.body, mesh_layout(a, b)) else {
        return Vec::new();
    };
    debug_assert!(lever(&a.body) > 0.0);
    let materials = [a.material, b.material];
    let built = match &b.body {
        Body::Gear(gb) => Pair::new(ga, gb, l.distance).ok().and_then(|pair| {
            build_with_warnings(
                &contact.stiffness,
                ga,
                Mate::Gear(gb, &pair),
                materials,
                l.face_width,
            )
            .ok()
        }),
        Body::Rack(rack) => gearbench_models::geometry::RackPair::new(ga, rack, l.distance)
            .ok()
            .and_then(|pair| {
                build_with_warnings(
                    &contact.stiffness,
                    ga,
                    Mate::Rack(rack, &pair),
                    materials,
                    l.face_width,
                )
                .ok()
            }),
    };
    built.map_or_else(Vec::new, |b| {
        b.warnings.iter().map(|w| format!("note: {w}")).collect()
    })
}
