//! The run-up of a scene: its own, or from a speed to another over a time.
//!
//! Where a hub is driven its speed becomes the ramp, by the ratio that it has to the reference gear. Where none is, all members
//! are driven by the torques `J_i alpha_i` that accelerate each alone as the train turns: these press no flank.

use super::plan::Ramp;
use gearbench_models::error::BuildError;
use gearbench_models::gear::table::Model;
use gearbench_models::scene::Scene;
use gearbench_models::spec::{Carried, Load, Modelling, Mount, Profile, SceneSpec};

/// Why a scene has no such run-up, and a way out.
#[derive(Clone, Debug, PartialEq)]
pub struct NoRamp(pub String, pub &'static str);

/// What of a member a ramp changes.
struct Driven<'a> {
    mount: &'a mut Mount,
    loads: &'a mut Vec<Load>,
    speed: &'a mut f64,
}

/// Gears, and behind them bodies.
fn members(spec: &mut SceneSpec) -> Vec<Driven<'_>> {
    let mut all: Vec<Driven<'_>> = (spec.gears.iter_mut())
        .map(|g| Driven {
            mount: &mut g.mount,
            loads: &mut g.loads,
            speed: &mut g.speed,
        })
        .collect();
    for station in spec.shafts.iter_mut().flat_map(|s| &mut s.stations) {
        if let Carried::Body(body) = &mut station.carries {
            all.push(Driven {
                mount: &mut body.mount,
                loads: &mut body.loads,
                speed: &mut body.speed,
            });
        }
    }
    all
}

/// The scene with a run-up of a gear.
///
/// # Errors
/// [`BuildError`] where the scene cannot be assembled; within, why it has no such run-up.
pub fn run_up(
    (spec, modelling): (&SceneSpec, &Modelling),
    models: &[Model],
    gear: usize,
    ramp: &Ramp,
) -> Result<Result<SceneSpec, NoRamp>, BuildError> {
    let built = Scene::build(spec, modelling, models)?;
    let start = built.initial();
    let own: Vec<f64> = (built.gears().iter())
        .map(|g| g.model.hub_state(g.at(start.at())).speed)
        .collect();
    let reference = own[gear];
    if reference == 0.0 {
        let why = format!(
            "`{}` does not turn at the start, so that nothing says in which sense a run-up of it goes",
            spec.gears[gear].name
        );
        return Ok(Err(NoRamp(
            why,
            "give the gears their `speed_rad_s`, or take another reference with --gear",
        )));
    }
    let scale = ramp.from / reference.abs();
    let rate = (ramp.to - ramp.from) / ramp.over / reference.abs();
    let mut spec = spec.clone();
    let mut all = members(&mut spec);
    let driven = all.iter().any(|m| matches!(m.mount, Mount::Driven(_)));
    for ((m, own), built) in all.iter_mut().zip(&own).zip(built.gears()) {
        *m.speed *= scale;
        match m.mount {
            Mount::Driven(profile) => {
                let speed = profile.value(0.0);
                *profile = Profile::Ramp {
                    from: scale * speed,
                    to: (scale + rate * ramp.over) * speed,
                    start: 0.0,
                    end: ramp.over,
                };
            }
            Mount::Revolute | Mount::Prismatic if !driven => {
                let torque = built.model.hub().hub.inertia * rate * own;
                m.loads.push(Load::Applied(Profile::Constant(torque)));
            }
            _ => {}
        }
    }
    drop(all);
    Ok(Ok(spec))
}
