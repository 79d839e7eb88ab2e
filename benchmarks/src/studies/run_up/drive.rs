//! Run-up of a scene: its own, or from one speed to another over a time.
//!
//! Where a hub is driven its speed becomes the ramp, by the ratio that it has to the reference gear. Where none is, all members
//! get the torques `J_i alpha_i` that accelerate each alone as the train turns: these press no flank. The loads of the scene stay
//! but for the torque of the **driver**, the member whose loads put most power in, or else the reference gear. It gives what
//! the others take at the speeds of the run-up,
//!
//! ```text
//! T_d(t) = -sum_i (omega_i / omega_d) T_i(t, omega_i(t))
//! ```
//!
//! so that the speeds follow the ramp whatever the loads. Losses in meshes are not known beforehand: they make the run fall
//! behind, which the study measures at the end.

use super::plan::Ramp;
use gearbench_integrators::system::State;
use gearbench_models::error::BuildError;
use gearbench_models::gear::table::Model;
use gearbench_models::scene::Scene;
use gearbench_models::spec::{Load, Modelling, Mount, Profile, SceneSpec, StationMember};

/// Reason why a scene cannot follow a ramp, and advice.
#[derive(Clone, Debug, PartialEq)]
pub struct RampError(pub String, pub &'static str);

/// Mutable mount, loads and speed of a member, which a ramp changes.
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
        if let StationMember::Body(body) = &mut station.carries {
            all.push(Driven {
                mount: &mut body.mount,
                loads: &mut body.loads,
                speed: &mut body.speed,
            });
        }
    }
    all
}

/// Returns the scene with a run-up of a gear.
///
/// # Errors
/// [`BuildError`] where the scene cannot be assembled; within, why it has no such run-up.
pub fn run_up(
    (spec, modelling): (&SceneSpec, &Modelling),
    models: &[Model],
    gear: usize,
    ramp: &Ramp,
) -> Result<Result<SceneSpec, RampError>, BuildError> {
    let built = Scene::build(spec, modelling, models)?;
    let start = built.initial();
    let own: Vec<f64> = (built.gears().iter())
        .map(|g| g.model.hub_state(g.at(start.at())).speed)
        .collect();
    let reference = own[gear];
    if reference == 0.0 {
        let why = format!(
            "`{}` does not rotate at the start, so that the sense of its run-up is unknown",
            spec.gears[gear].name
        );
        return Ok(Err(RampError(
            why,
            "give the gears their `speed_rad_s`, or name another reference gear with --gear",
        )));
    }
    let scale = ramp.from / reference.abs();
    let rate = (ramp.to - ramp.from) / ramp.over / reference.abs();
    let inertia = inertias(&built, &start);
    let mut spec = spec.clone();
    let mut all = members(&mut spec);
    let driven = all.iter().any(|m| matches!(m.mount, Mount::Driven(_)));
    let factors = [scale, scale + rate * ramp.over];
    if !driven {
        balance(&mut all, &own, gear, (factors, ramp.over));
    }
    for ((m, own), inertia) in all.iter_mut().zip(&own).zip(inertia) {
        *m.speed *= scale;
        match m.mount {
            Mount::Driven(profile) => {
                let speed = profile.value(0.0);
                *profile = over_time(factors.map(|f| f * speed), ramp.over);
            }
            Mount::Revolute | Mount::Prismatic if !driven => {
                add_torque(m.loads, [inertia * rate * own; 2], ramp.over);
            }
            _ => {}
        }
    }
    drop(all);
    Ok(Ok(spec))
}

/// The line between two values over the run-up.
fn over_time([from, to]: [f64; 2], over: f64) -> Profile {
    Profile::Ramp {
        from,
        to,
        start: 0.0,
        end: over,
    }
}

/// Adds a torque that is a line over the run-up to one that is such a line already, so that damping at the load of a mesh
/// counts their sum.
fn add_torque(loads: &mut Vec<Load>, by: [f64; 2], over: f64) {
    if by == [0.0; 2] {
        return;
    }
    let mut ends = by;
    loads.retain(|load| {
        let known = match load {
            Load::Applied(Profile::Constant(x)) => [*x; 2],
            Load::Applied(Profile::Ramp {
                from,
                to,
                start,
                end,
            }) if [*start, *end] == [0.0, over] => [*from, *to],
            _ => return true,
        };
        (ends.iter_mut().zip(known)).for_each(|(e, x)| *e += x);
        false
    });
    loads.push(Load::Applied(match ends {
        [from, to] if from == to => Profile::Constant(from),
        ends => over_time(ends, over),
    }));
}

/// Lets the driver give what the loads of all others take at the speeds `own` times the factors of the start and the end.
fn balance(
    all: &mut [Driven<'_>],
    own: &[f64],
    reference: usize,
    (factors, over): ([f64; 2], f64),
) {
    let power = |(i, m): (usize, &Driven<'_>)| {
        let value = |l: &Load| match l {
            Load::Applied(p) => p.value(0.5 * over),
            Load::Viscous(_) => 0.0,
        };
        (i, own[i] * m.loads.iter().map(value).sum::<f64>())
    };
    let free =
        |(_, m): &(usize, &Driven<'_>)| matches!(m.mount, Mount::Revolute | Mount::Prismatic);
    let powers = all.iter().enumerate().filter(free).map(power);
    let strongest = powers.max_by(|a, b| a.1.total_cmp(&b.1));
    let driver = strongest
        .filter(|(_, p)| *p > 0.0)
        .map_or(reference, |(i, _)| i);
    all[driver].loads.retain(|l| matches!(l, Load::Viscous(_)));
    let (mut line, mut others) = ([0.0; 2], Vec::new());
    for (m, speed) in all.iter().zip(own) {
        let ratio = speed / own[driver];
        for load in m.loads.iter().filter(|_| ratio != 0.0) {
            match load {
                Load::Viscous(c) => {
                    (line.iter_mut().zip(factors)).for_each(|(x, f)| *x += c * ratio * speed * f);
                }
                Load::Applied(Profile::Constant(x)) => {
                    line.iter_mut().for_each(|to| *to -= ratio * x);
                }
                Load::Applied(p) => others.push(Load::Applied(p.scaled(-ratio))),
            }
        }
    }
    all[driver].loads.extend(others);
    add_torque(all[driver].loads, line, over);
}

/// Inertias of all members about their own motion; carriers have those of planets that they move on elastic pins.
fn inertias(built: &Scene, start: &State) -> Vec<f64> {
    let gears = built.gears();
    let mut found: Vec<f64> = gears.iter().map(|g| g.model.hub().hub.inertia).collect();
    let mut seen = vec![false; gears.len()];
    for (mesh, of_mesh) in built.meshes().iter().enumerate() {
        let Some((coordinate, body)) = built.carrier_of_mesh(mesh) else {
            continue;
        };
        let spin = start.v[coordinate];
        for gear in of_mesh.gears {
            if spin == 0.0 || !built.is_carried(gear) || std::mem::replace(&mut seen[gear], true) {
                continue;
            }
            let hub = gears[gear].model.hub();
            let first = gears[gear].range().start;
            let across = hub.free_directions().enumerate().filter(|(_, d)| *d < 2);
            let mass = hub.hub.lateral.as_ref().map_or(0.0, |l| l.body.mass);
            found[body] += across
                .map(|(k, _)| mass * (start.v[first + k] / spin).powi(2))
                .sum::<f64>();
        }
    }
    found
}
