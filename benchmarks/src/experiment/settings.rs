//! Settings of a scene that a report lists before the results.

use super::shaft_text::{guide_text, shaft_text, stage_text};
use crate::scene_file::{ModelChoice, SceneFile, formula_limits};
use gearbench_integrators::Resolution;
use gearbench_models::geometry::Pair;
use gearbench_models::law::Damping;
use gearbench_models::spec::{
    Body, ContactSpec, FlankContact, GearSpec, Load, ModelSpec, Mount, PointLaw, PointRule,
    Profile, SpinTerms, SurfaceKind, mesh_layout,
};
use gearbench_reports::numbers::short;
use serde_json::Value;

/// Describes overlap ratio and total length of the contact lines of helical teeth over a mesh cycle.
fn contact_lines_text(gear: &Body, mate: &Body, distance: f64) -> Option<String> {
    let Body::Gear(gear) = gear else {
        return None;
    };
    let pair = Pair::new(gear, mate, distance).ok()?;
    let lines = pair.contact_lines();
    let [least, greatest, mean] =
        [lines.least, lines.greatest, lines.mean].map(|l| short(l * 1e3, 5));
    (pair.overlap_ratio() > 0.0).then(|| {
        format!(
            "{least} to {greatest} mm long in all over a mesh cycle, {mean} mm in the mean; overlap ratio {}",
            short(pair.overlap_ratio(), 4)
        )
    })
}

/// The setting of the simulated time [s].
pub fn simulated_time(duration: f64) -> (String, String) {
    let text = format!("{} ms", short(duration * 1e3, 4));
    ("simulated time".into(), text)
}

/// The settings of a scene for the report: geometry, positions, loads, models with the origin of their constants, and
/// conventions of the stiffness.
pub fn settings(
    scene: &SceneFile,
    choices: &[&ModelChoice],
    no_events: bool,
) -> Vec<(String, String)> {
    let mut rows: Vec<(String, String)> = vec![simulated_time(scene.duration)];
    let mut row = |what: &str, value: String| rows.push((what.to_string(), value));
    for g in &scene.spec.gears {
        row(&format!("gear {}", g.name), gear_text(g));
    }
    for s in &scene.spec.shafts {
        row(&format!("shaft {}", s.name), shaft_text(&scene.spec, s));
    }
    for s in &scene.spec.stages {
        row(&format!("stage {}", s.name), stage_text(&scene.spec, s));
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
            if let Some(lines) = contact_lines_text(&a.body, &b.body, l.distance) {
                row(&format!("contact lines {} - {}", a.name, b.name), lines);
            }
        }
    }
    if let Some(stated) = scene.damping {
        row("damping of all models", stated.to_text());
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
    row("converged solution (self)", super::converged::described());
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
        row("odd", odd.to_text());
    }
    rows
}

/// Describes the direction of the axis and the out-of-plane motion of the hub.
fn out_of_plane_text(g: &GearSpec) -> String {
    let mut text = String::new();
    let axis = g.axes[2];
    if axis.z != 1.0 {
        let parts = axis.iter().map(|x| short(*x, 6)).collect::<Vec<_>>();
        text += &format!(", axis ({})", parts.join(", "));
    }
    let Some(lateral) = &g.lateral else {
        return text;
    };
    let k = &lateral.bearing.stiffness;
    let diagonal = (0..6).map(|d| short(k[d][d], 3)).collect::<Vec<_>>();
    text += &format!(", bearing {} N/m and N m/rad", diagonal.join(", "));
    if lateral.bearing.clearance > 0.0 {
        let play = short(lateral.bearing.clearance * 1e6, 3);
        text += &format!(" with a play of {play} um");
    }
    text += match lateral.spin {
        SpinTerms::Auto => ", spin terms where they change a thousandth",
        SpinTerms::On => ", with spin terms",
        SpinTerms::Off => ", without spin terms",
    };
    text
}

fn gear_text(g: &GearSpec) -> String {
    let toothing = match &g.body {
        Body::Gear(x) => {
            let p = x.params();
            let conical = match x.is_conical() {
                true => format!(
                    ", conical: profile shift {} deg, tip {} deg, mass and stiffness of the middle section",
                    short(p.profile_shift_angle.to_degrees(), 5),
                    short(p.tip_cone_angle.to_degrees(), 5)
                ),
                false => String::new(),
            };
            let internal = p.internal.map_or_else(String::new, |of| {
                format!(
                    ", internal, cut by {} teeth, tip {} mm, root {} mm, rim {} mm",
                    of.cutter_teeth_of(p.teeth),
                    short(x.r_tip() * 1e3, 5),
                    short(x.r_root() * 1e3, 5),
                    short(x.r_outer() * 1e3, 5)
                )
            });
            format!(
                "z = {}, m = {} mm, x = {}, b = {} mm, helix {} deg{conical}{internal}",
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
    let guide = g.guide.as_ref().map_or_else(String::new, |guide| {
        guide_text(guide, matches!(g.body, Body::Rack(_)))
    });
    format!(
        "{toothing}; {mount}{guide}{}, inertia {} {unit}, initial speed {} {speed}, {}",
        out_of_plane_text(g),
        short(inertia + g.added_inertia, 5),
        short(g.speed, 5),
        loads(g)
    )
}

/// Describes the loads of a gear.
fn loads(g: &GearSpec) -> String {
    let rack = matches!(g.body, Body::Rack(_));
    let (load, damper) = match rack {
        true => ("force", "N s/m"),
        false => ("torque", "N m s/rad"),
    };
    let unit = if rack { "N" } else { "N m" };
    let text = |l: &Load| match l {
        Load::Viscous(c) => format!("viscous brake {} {damper}", short(*c, 5)),
        Load::Applied(profile) => format!("{load} {}", profile_text(profile, unit)),
    };
    match g.loads.as_slice() {
        [] => "no loads".into(),
        all => all.iter().map(text).collect::<Vec<_>>().join(", "),
    }
}

fn profile_text(profile: &Profile, unit: &str) -> String {
    let ms = |t: f64| format!("{} ms", short(1e3 * t, 4));
    match profile {
        Profile::Constant(x) => format!("{} {unit}", short(*x, 5)),
        Profile::Ramp {
            from,
            to,
            start,
            end,
        } => format!(
            "{} to {} {unit} from {} to {}",
            short(*from, 5),
            short(*to, 5),
            ms(*start),
            ms(*end)
        ),
        Profile::Table(table) => format!(
            "table of {} points, {} to {} {unit}, {} to {}",
            table.times().len(),
            short(
                table.values().iter().copied().fold(f64::INFINITY, f64::min),
                5
            ),
            short(
                table
                    .values()
                    .iter()
                    .copied()
                    .fold(f64::NEG_INFINITY, f64::max),
                5
            ),
            ms(table.times().first().copied().unwrap_or(0.0)),
            ms(table.times().last().copied().unwrap_or(0.0))
        ),
        Profile::Polynomial { integral, .. } => {
            format!(
                "{} {unit} at the start, set by a host",
                short(integral[1], 5)
            )
        }
        Profile::Harmonic {
            mean,
            amplitude,
            frequency,
            phase,
        } => format!(
            "{} {unit} with {} {unit} cos at {} Hz, {} deg",
            short(*mean, 5),
            short(*amplitude, 5),
            short(*frequency, 5),
            short(phase.to_degrees(), 4)
        ),
    }
}

fn model_text(scene: &SceneFile, choice: &ModelChoice) -> String {
    let spec = scene.spec_for(choice);
    let mut parts = Vec::new();
    if let Some(c) = &choice.calibration {
        parts.push(format!(
            "calibration `{}` of scene {}, for {}",
            c.name,
            c.scene,
            c.fitted_to().holds_for()
        ));
    } else {
        parts.push("constants as given in the scene".into());
    }
    for (contact, mesh) in choice.modelling.contacts.iter().zip(&spec.meshes) {
        parts.push(contact_text(contact));
        parts.push(format!(
            "gap at the start {} um",
            short(mesh.start.gap * 1e6, 4)
        ));
        if contact.flanks == FlankContact::Toothing {
            let limits = formula_limits(&spec, mesh.gears, contact);
            parts.extend(limits.into_iter().map(|w| format!("note: {w}")));
        }
    }
    let gears = &choice.modelling.gears;
    let mut described: Vec<(&str, &ModelSpec)> = Vec::new();
    for (gear, model) in spec.gears.iter().zip(gears) {
        let is_new = described.iter().all(|(_, other)| *other != model);
        if is_new && !model.values().is_empty() {
            described.push((&gear.name, model));
        }
    }
    for (name, model) in &described {
        let of_gear = |text: String| match described.len() {
            1 => text,
            _ => format!("{text} of {name}"),
        };
        parts.extend(parameters(model).into_iter().map(of_gear));
    }
    if gears.windows(2).any(|g| g[0].id() != g[1].id()) {
        let ids: Vec<&str> = gears.iter().map(|g| g.id()).collect();
        parts.push(format!("gears modelled as {}", ids.join(", ")));
    }
    parts.join("; ")
}

/// Describes the contact: penalty per area or hard contact of flank points, else stiffness and force law along the line
/// of action.
fn contact_text(contact: &ContactSpec) -> String {
    let exponent = match contact.exponent {
        1.0 => "linear".into(),
        n => format!("exponent {}", short(n, 4)),
    };
    let points = match &contact.flanks {
        FlankContact::Toothing => {
            if let Some(law) = &contact.normal_force {
                let (stiffness, name) = (contact.stiffness.describe(), law.name());
                return format!("contact: {stiffness}; law `{name}` of the program");
            }
            return format!(
                "contact: {}; law {exponent}, damping {}",
                contact.stiffness.describe(),
                contact.damping.id()
            );
        }
        FlankContact::HalfSpace => {
            return format!(
                "contact: Hertz's half-spaces along lines of the flanks, damping {}",
                contact.damping.id()
            );
        }
        FlankContact::Points(points) => points,
    };
    let rule = match points.rule {
        PointRule::Quadrature { along, across } => {
            format!("{along} x {across} quadrature points per face")
        }
        PointRule::Nodes => "nodes with their areas".into(),
        PointRule::EachNode => "single nodes".into(),
    };
    let law = match (points.law, points.rule) {
        (PointLaw::Hard, _) => "hard, no penalty".to_owned(),
        (PointLaw::Penalty { stiffness, .. }, PointRule::EachNode) => {
            format!("penalty {stiffness:e} N/m per node, {exponent}")
        }
        (PointLaw::Penalty { stiffness, .. }, _) => {
            format!("penalty {stiffness:e} Pa/m, {exponent}")
        }
    };
    let damping = match (points.penalty(), contact.damping) {
        (Some([_, dashpot]), Damping::None) if dashpot != 0.0 => {
            format!("dashpot {dashpot:e} N s/m^3")
        }
        (_, Damping::None) => "no dashpot".to_owned(),
        (_, law) => format!("damping {}", law.id()),
    };
    let surface = match points.surface {
        SurfaceKind::Faceted => "faceted",
        SurfaceKind::Smooth => "smooth",
    };
    format!("contact of {surface} flanks: {law}, {damping}, at {rule}")
}

fn parameters(model: &ModelSpec) -> Vec<String> {
    (model.values().iter())
        .map(|(key, value)| match value {
            Value::Number(x) => format!("{key} = {}", short(x.as_f64().unwrap_or(f64::NAN), 5)),
            Value::String(x) => format!("{key} = {x}"),
            Value::Array(x) => format!("{key}: {} values", x.len()),
            other => format!("{key} = {other}"),
        })
        .collect()
}
