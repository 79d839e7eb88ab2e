//! Range of scenes on which the choice has been validated, and the test whether a scene lies outside of it.

use super::plan::CandidateData;
use super::problem::Problem;
use gearbench_models::law::Damping;
use gearbench_models::spec::{Body, Mount, Profile};
use gearbench_reference::reduction::ElasticParameters;
use gearbench_reports::numbers::short;
use std::f64::consts::{PI, TAU};

/// Numbers of teeth of the gears that choices were validated on.
pub const TEETH: [u32; 2] = [14, 56];
/// Least and greatest module of the gears [m].
pub const MODULE: [f64; 2] = [1.5e-3, 10e-3];
/// Least and greatest face width over the module [-].
pub const WIDTH: [f64; 2] = [2.5, 7.5];
/// Highest frequency of tooth engagement in these scenes [Hz].
pub const FREQUENCY: f64 = 2500.0;
/// Longest duration of these scenes [s].
pub const LONGEST: f64 = 20e-3;

/// Returns sentences on the properties of a scene outside of the validated range; empty if there are none.
pub fn outside(problem: &Problem, prepared: &CandidateData) -> Vec<String> {
    let mut found = Vec::new();
    let scene = &problem.scene;
    if scene.gears.len() != 2 || scene.meshes.len() != 1 {
        found.push(format!(
            "it has {} gears and {} meshes; checked were two gears, or a gear on a rack",
            scene.gears.len(),
            scene.meshes.len()
        ));
    }
    if let Some(shaft) = scene.shafts.first() {
        found.push(format!(
            "it has the shaft `{}`; checked were gears by themselves",
            shaft.name
        ));
    }
    for g in scene.gears.iter().filter(|g| g.guide.is_some()) {
        found.push(format!(
            "`{}` is guided; checked were gears that nothing holds along their motion",
            g.name
        ));
    }
    for g in &scene.gears {
        let (teeth, module, width, spur, plain) = match &g.body {
            Body::Gear(gear) => {
                let p = gear.params();
                (
                    Some(p.teeth),
                    p.module,
                    p.face_width,
                    p.helix_angle == 0.0,
                    p.modifications.is_none(),
                )
            }
            Body::Rack(r) => {
                let p = r.params();
                (None, p.module, p.face_width, p.helix_angle == 0.0, true)
            }
        };
        let name = &g.name;
        if !spur {
            found.push(format!("`{name}` is helical; checked were spur gears"));
        }
        if !plain {
            found.push(format!(
                "`{name}` has modified flanks; checked were involutes as they are"
            ));
        }
        if let Some(z) = teeth.filter(|z| !(TEETH[0]..=TEETH[1]).contains(z)) {
            found.push(format!(
                "`{name}` has {z} teeth; checked were {} to {}",
                TEETH[0], TEETH[1]
            ));
        }
        if !(MODULE[0]..=MODULE[1]).contains(&module) {
            found.push(format!(
                "`{name}` has a module of {} mm; checked were {} to {} mm",
                short(1e3 * module, 4),
                1e3 * MODULE[0],
                1e3 * MODULE[1]
            ));
        }
        if !(WIDTH[0]..=WIDTH[1]).contains(&(width / module)) {
            found.push(format!(
                "`{name}` is {:.1} modules wide; checked were {} to {}",
                width / module,
                WIDTH[0],
                WIDTH[1]
            ));
        }
        let speed = match &g.mount {
            Mount::Driven(p) => p.value(0.0),
            _ => g.speed,
        };
        let frequency = match &g.body {
            Body::Gear(gear) => f64::from(gear.teeth()) * speed.abs() / TAU,
            Body::Rack(_) => speed.abs() / (PI * module),
        };
        if frequency > FREQUENCY {
            found.push(format!(
                "{frequency:.0} teeth of `{name}` pass in a second; checked were up to {FREQUENCY}"
            ));
        }
        match &g.mount {
            Mount::Revolute | Mount::Prismatic => {}
            Mount::Fixed | Mount::Driven(Profile::Constant(_)) => {}
            Mount::Driven(_) => found.push(format!(
                "`{name}` is driven at a changing speed; checked were gears that are free, held, or driven at a constant one"
            )),
        }
    }
    if problem.duration > LONGEST {
        found.push(format!(
            "it lasts {:.3} s; checked were scenes of up to {LONGEST} s",
            problem.duration
        ));
    }
    for c in &prepared.details.lead.contacts {
        if c.friction.is_some() {
            found.push("flanks have friction; checked were smooth ones".into());
        }
        if c.flanks.is_hard() {
            found.push("contact is hard; checked were penalties".into());
        }
        if matches!(c.damping, Damping::RatioAtLoad { .. }) {
            found.push("contact is damped by a ratio at load; checked was damping of modes".into());
        }
    }
    let retarded = |g: &ElasticParameters| g.rayleigh.is_some_and(|[_, beta]| beta > 0.0);
    if prepared.details.lead.gears.iter().any(retarded) {
        found.push(
            "bodies are damped in proportion to their stiffness; checked was damping of modes"
                .into(),
        );
    }
    if let Some(why) = &prepared.details.no_half_spaces {
        found.push(format!(
            "flanks touch with their elements, because {why}; checked were half-spaces"
        ));
    }
    if let Err(why) = &prepared.details.finer {
        found.push(format!("no finer mesh judges it, because {why}"));
    }
    if let Err(e) = &prepared.statics {
        found.push(format!(
            "static solves gave no stiffness for rigid gears: {e}"
        ));
    }
    found.dedup();
    found
}
