//! What the choice has been checked on, and in which ways a scene lies outside of it.

use super::candidate::Prepared;
use super::situation::Situation;
use gearbench_models::mount::Mount;
use gearbench_models::scene::build::lever;
use gearbench_models::scene::spec::Body;

/// Numbers of teeth, modules [m], face widths over module, and speeds of flanks along the line of action [m/s] of the
/// scenes that choices were judged on.
pub const TEETH: [u32; 2] = [14, 60];
/// See [`TEETH`].
pub const MODULE: [f64; 2] = [1.5e-3, 10e-3];
/// See [`TEETH`].
pub const WIDTH: [f64; 2] = [1.5, 15.0];
/// See [`TEETH`].
pub const SPEED: f64 = 30.0;

/// Sentences on what is unusual about a scene; none when nothing is.
#[must_use]
pub fn outside(situation: &Situation, prepared: &Prepared) -> Vec<String> {
    let mut found = Vec::new();
    let scene = &situation.scene;
    if scene.gears.len() != 2 || scene.meshes.len() != 1 {
        found.push(format!(
            "it has {} gears and {} meshes; checked were two gears, or a gear on a rack",
            scene.gears.len(),
            scene.meshes.len()
        ));
    }
    for g in &scene.gears {
        let (teeth, module, width, spur, plain) = match &g.body {
            Body::Gear(gear) => {
                let p = gear.params();
                let m = &p.modifications;
                let plain =
                    m.lead_crowning == 0.0 && m.profile_crowning == 0.0 && m.tip_relief.is_none();
                (
                    Some(p.teeth),
                    p.module,
                    p.face_width,
                    p.helix_angle == 0.0,
                    plain,
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
                "`{name}` has a module of {:.4} mm; checked were {} to {} mm",
                1e3 * module,
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
        let speed = (g.speed * lever(&g.body)).abs();
        if speed > SPEED {
            found.push(format!(
                "the flanks of `{name}` move at {speed:.1} m/s; checked were speeds to {SPEED} m/s"
            ));
        }
        match &g.mount {
            Mount::Revolute | Mount::Prismatic => {}
            Mount::Fixed if matches!(g.body, Body::Rack(_)) => {}
            _ => found.push(format!(
                "the mount of `{name}` is none that was checked (free to turn, or a rack that is held)"
            )),
        }
    }
    for c in &situation.flexible.contacts {
        if c.friction.is_some() {
            found.push("flanks have friction; checked were smooth ones".into());
        }
        if c.points.is_some_and(|p| p.hard) {
            found.push("contact is hard; checked were penalties".into());
        }
    }
    if let Err(e) = &prepared.statics {
        found.push(format!(
            "static solves gave no stiffness for rigid gears: {e}"
        ));
    }
    found.dedup();
    found
}
