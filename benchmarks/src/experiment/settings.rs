//! What a reader must know of a scene, beside the results of a study.

use crate::scene_file::{ModelChoice, SceneFile, formula_limits};
use gearbench_integrators::Resolution;
use gearbench_models::spec::{Body, GearSpec, ModelSpec, Mount, Value, mesh_layout};
use gearbench_reports::numbers::short;

/// What a reader must know of the scene: geometry, positions, loads, models and where their constants come
/// from, conventions of the stiffness.
pub fn settings(
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
            "contact opening and closing, ends of the path of contact and breakpoints of tables are located"
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
            Resolution::Step(h) => format!("{} h {} us", m.method, short(h * 1e6, 3)),
            Resolution::Tolerance(r) => format!("{} rtol {r:.0e}", m.method),
        })
        .collect();
    row("integrators of the scene", steps.join("; "));
    for odd in &scene.odd {
        row("odd", odd.told());
    }
    rows
}

fn gear_text(g: &GearSpec) -> String {
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
        Mount::Fixed => "fixed",
        Mount::Revolute => "revolute",
        Mount::Prismatic => "prismatic",
        Mount::Driven(_) => "driven",
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
        let limits = formula_limits(&spec, mesh.gears, contact);
        parts.extend(limits.into_iter().map(|w| format!("note: {w}")));
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
