//! Scenes drawn at random, on which a choice of model is judged.
//!
//! A set has a seed; scene `n` of it follows from the seed and `n` alone. Gears come from a short list, everything else
//! from distributions: approach speed `v`, added inertia, load, damping, backlash, start, mount, metric, tolerance.
//! With the tooth pair's stiffness `k` (norm) and the reduced mass `m` on the line of action
//!
//! ```text
//! 1/m = r_b1^2/J_1 + r_b2^2/J_2     T = pi sqrt(m/k)     F = v sqrt(k m)
//! ```
//!
//! are length and peak force of an impact, by which loads and durations are scaled. There are three kinds of scenes:
//! one impact, several impacts within the backlash, and running under load for some mesh cycles.
//!
//! A scene is sound when rigid gears of the norm's stiffness do in it what its kind says, and no tooth is loaded beyond
//! what steel bears; rigid gears take microseconds and say when contacts begin and end, from which the duration
//! follows. A scene that is not sound is drawn again from the next stream of random numbers, and that is counted.

mod random;
mod rigid;
#[cfg(test)]
mod tests;
mod text;
mod toothing;

use gearbench::scene_file::{Origin, SceneError, SceneFile};
use gearbench_models::error::BuildError;
use gearbench_models::geometry::GeometryError;
use gearbench_models::spec::mesh_layout;
use gearbench_reports::Metric;
use random::{Random, fitting, short};
use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};
use toothing::{PAIRS, RACKS, Toothing};

/// Sets and their seeds.
const SETS: &str = include_str!("../../sets.toml");
/// Draws of a scene before it is given up.
const MOST_DRAWS: u32 = 200;
/// Greatest `F / (b m_n)` [Pa]: some four times that is bending stress at the root.
const BEARABLE: f64 = 150e6;
/// Longest scene [s].
const LONGEST: f64 = 20e-3;
/// Flight after an impact that belongs to the scene, over the length of the impact, and flight that there must be:
/// softer gears part later.
const AFTER: [f64; 2] = [0.35, 0.6];
/// Part of the flight after the last of several impacts that belongs to the scene.
const AFTER_LAST: f64 = 0.3;
/// Part of the path of contact at either end where no impact starts: there the corners of tips touch.
const PATH_MARGIN: f64 = 0.1;
/// Penalty over the module [Pa/m m]: 1e15 Pa/m for 4 mm.
const PENALTY: f64 = 4e12;
/// First frequency of a tooth over the module [Hz m].
const TOOTH_FREQUENCY: f64 = 244.0;

/// A set of scenes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Set {
    /// `tuning` or `held-out`.
    pub name: String,
    /// Seed.
    pub seed: u64,
    /// Number of scenes, counted from 1.
    pub scenes: usize,
    /// So many of its scenes of one impact, the first, are judged against full finite elements.
    pub full_order: usize,
}

/// Why there is no such scene.
#[derive(Debug, thiserror::Error)]
pub enum DrawError {
    /// No such set.
    #[error("there is no set `{name}`; there are {}", known.join(" and "))]
    Set {
        /// What was asked for.
        name: String,
        /// What there is.
        known: Vec<String>,
    },
    /// No such scene.
    #[error("the set `{set}` has scenes 1 to {last}, not {number}")]
    Number {
        /// The set.
        set: String,
        /// Its last scene.
        last: usize,
        /// What was asked for.
        number: usize,
    },
    /// The list of sets cannot be read.
    #[error("validation/sets.toml: {0}")]
    Sets(String),
    /// Nothing sound was found.
    #[error("scene {number} of `{set}`: none of {MOST_DRAWS} draws is sound; the last: {last}")]
    Unsound {
        /// The set.
        set: String,
        /// The scene.
        number: usize,
        /// Why the last was not.
        last: String,
    },
    /// A gear of the list cannot be cut.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// A drawn scene is no scene file.
    #[error("a drawn scene cannot be read: {0}")]
    Scene(#[from] SceneError),
    /// The gears do not mesh.
    #[error("a drawn scene cannot be built: {0}")]
    Build(#[from] BuildError),
}

#[derive(serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
struct SetRow {
    seed: u64,
    scenes: usize,
    #[serde(default)]
    full_order: usize,
}

/// A set by its name.
///
/// # Errors
/// [`DrawError::Set`] names those there are.
pub fn set(name: &str) -> Result<Set, DrawError> {
    let rows: BTreeMap<String, SetRow> =
        toml::from_str(SETS).map_err(|e| DrawError::Sets(e.to_string()))?;
    let row = rows.get(name).ok_or_else(|| DrawError::Set {
        name: name.to_owned(),
        known: rows.keys().cloned().collect(),
    })?;
    Ok(Set {
        name: name.to_owned(),
        seed: row.seed,
        scenes: row.scenes,
        full_order: row.full_order,
    })
}

/// What happens in a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// One impact.
    Impact,
    /// Several impacts within the backlash.
    Hammer,
    /// Running under load for some mesh cycles.
    Load,
}

impl Kind {
    /// All kinds.
    #[cfg(test)]
    pub const ALL: [Kind; 3] = [Kind::Impact, Kind::Hammer, Kind::Load];

    /// The word of records.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Kind::Impact => "one impact",
            Kind::Hammer => "hammering",
            Kind::Load => "under load",
        }
    }

    /// Metrics that are asked for. After several impacts a history is all phase, so hammering is judged by numbers
    /// of the whole; under load the speed swings about a mean, and where it ends says little.
    #[must_use]
    pub fn metrics(self) -> &'static [Metric] {
        match self {
            Kind::Impact => &[
                Metric::ForceL2Aligned,
                Metric::PeakForceRel,
                Metric::ImpulseRel,
                Metric::Rebound,
                Metric::TransmissionError,
            ],
            Kind::Hammer => &[Metric::PeakForceRel, Metric::ImpulseRel, Metric::Rebound],
            Kind::Load => &[
                Metric::ForceL2Aligned,
                Metric::PeakForceRel,
                Metric::ImpulseRel,
                Metric::TransmissionError,
            ],
        }
    }
}

/// Tolerances that are asked for.
pub const TOLERANCES: [f64; 5] = [0.01, 0.02, 0.05, 0.1, 0.2];

/// Mount of the second gear.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Second {
    Free,
    Fixed,
    Driven,
}

/// Load on a hub, in N m or N.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Load {
    None,
    Constant(f64),
    /// From zero, up to a time [s].
    Ramp(f64, f64),
    Viscous(f64),
}

/// All that a scene is written from.
#[derive(Clone, Debug)]
struct Parameters {
    set: String,
    number: usize,
    kind: Kind,
    metric: Metric,
    tolerance: f64,
    toothing: Toothing,
    /// Inertia or mass at the hubs.
    added: [f64; 2],
    second: Second,
    speed: [f64; 2],
    load: [Load; 2],
    backlash: f64,
    gap: f64,
    /// Place of the first pair on the middle part of the path of contact, 0 to 1.
    place: f64,
    penalty: f64,
    /// Dashpot of flank points [N s/m per m^2].
    dashpot: f64,
    modal_ratio: f64,
    rigid_ratio: f64,
    /// Length of an impact [s].
    contact_time: f64,
    /// Impacts, or mesh cycles.
    count: u32,
    /// Time that rigid gears are given to do what the kind says [s].
    window: f64,
}

/// A scene that was drawn.
#[derive(Clone, Debug)]
pub struct Drawn {
    /// Its number in the set, from 1.
    pub number: usize,
    /// What happens.
    pub kind: Kind,
    /// Metric that is asked for.
    pub metric: Metric,
    /// Greatest error that is accurate enough.
    pub tolerance: f64,
    /// Length of an impact by the estimate above [s].
    pub contact_time: f64,
    /// The scene file.
    pub text: String,
    /// What the text says; its models are read, not built.
    pub scene: SceneFile,
    /// Draws that were not sound.
    pub redraws: u32,
}

/// Draws a scene of a set by its number, from 1.
///
/// # Errors
/// [`DrawError`]: no such scene, or a drawing that breaks its own rules.
pub fn draw(set: &Set, number: usize) -> Result<Drawn, DrawError> {
    if !(1..=set.scenes).contains(&number) {
        return Err(DrawError::Number {
            set: set.name.clone(),
            last: set.scenes,
            number,
        });
    }
    let mut last = String::new();
    for redraws in 0..MOST_DRAWS {
        let mut random = Random::of(set.seed, number, redraws);
        let parameters = parameters(&mut random, set, number)?;
        match sound(&parameters)? {
            Ok((text, scene)) => {
                return Ok(Drawn {
                    number,
                    kind: parameters.kind,
                    metric: parameters.metric,
                    tolerance: parameters.tolerance,
                    contact_time: parameters.contact_time,
                    text,
                    scene,
                    redraws,
                });
            }
            Err(why) => last = why.to_owned(),
        }
    }
    Err(DrawError::Unsound {
        set: set.name.clone(),
        number,
        last,
    })
}

/// Numbers of the scenes of a set that are judged against full finite elements: the first that have one impact.
///
/// # Errors
/// As [`draw`].
pub fn full_order(set: &Set) -> Result<Vec<usize>, DrawError> {
    let mut found = Vec::new();
    for number in 1..=set.scenes {
        if found.len() == set.full_order {
            break;
        }
        if draw(set, number)?.kind == Kind::Impact {
            found.push(number);
        }
    }
    Ok(found)
}

fn parameters(r: &mut Random, set: &Set, number: usize) -> Result<Parameters, DrawError> {
    let kind = match r.unit() {
        u if u < 0.45 => Kind::Impact,
        u if u < 0.70 => Kind::Hammer,
        _ => Kind::Load,
    };
    let toothing = if kind == Kind::Impact && r.chance(0.15) {
        r.one(&RACKS)
    } else {
        r.one(&PAIRS)
    };
    let levers = toothing.levers()?;
    let added = [0, 1].map(|i| {
        let factor = r.one(&[0.0, 0.0, 2.0, 8.0]);
        short(factor * toothing.inertia(i))
    });
    let second = match (kind, r.unit()) {
        (Kind::Impact, u) if u < 0.2 => Second::Fixed,
        (Kind::Impact, u) if u < 0.3 => Second::Driven,
        (Kind::Hammer | Kind::Load, u) if u < 0.3 => Second::Driven,
        _ => Second::Free,
    };
    let backlash = short(toothing.module * r.between(0.01, 0.05));

    // Masses on the line of action.
    let mass = |i: usize| (toothing.inertia(i) + added[i]) / (levers[i] * levers[i]);
    let reduced = match second {
        Second::Free => 1.0 / (mass(0).recip() + mass(1).recip()),
        _ => mass(0),
    };
    let stiffness = toothing.stiffness();
    let contact_time = PI * (reduced / stiffness).sqrt();
    let approach = match kind {
        Kind::Impact => r.decades(0.05, 3.0),
        _ => r.decades(0.03, 0.6),
    };
    let peak = approach * (stiffness * reduced).sqrt();
    let mut p = Parameters {
        set: set.name.clone(),
        number,
        kind,
        metric: r.one(kind.metrics()),
        tolerance: r.one(&TOLERANCES),
        toothing,
        added,
        second,
        speed: [0.0; 2],
        load: [Load::None; 2],
        backlash,
        gap: 0.0,
        place: r.unit(),
        penalty: short(PENALTY / toothing.module),
        dashpot: 0.0,
        modal_ratio: 0.0,
        rigid_ratio: 0.0,
        contact_time,
        count: 1,
        window: 0.0,
    };
    // What force the damping is looked at under.
    let mut force = peak;
    match kind {
        Kind::Impact => {
            let turning = r.chance(0.5);
            let rolling = (approach * r.between(0.5, 10.0)).min(5.0);
            let rolling = match second {
                Second::Fixed => 0.0,
                Second::Free if !turning => 0.0,
                _ => rolling,
            };
            move_apart(&mut p, levers, rolling, approach);
            p.gap = short(r.decades(1e-6, 2e-5).min(0.5 * backlash));
            let share = r.decades(0.01, 0.3);
            let sign = r.one(&[0.0, 0.0, 1.0, -1.0]);
            // A load that holds back must not stop the gears before they touch.
            let least = 0.25 * reduced * approach * approach / p.gap;
            let along = if sign < 0.0 { least } else { f64::INFINITY };
            p.load[0] = constant(sign * (share * peak).min(along) * levers[0]);
            p.window = 2.0 * p.gap / approach + 6.0 * contact_time;
        }
        Kind::Hammer => {
            let rolling = r.decades(0.1, 5.0);
            move_apart(&mut p, levers, rolling, approach);
            p.gap = short(backlash * r.between(0.1, 0.9));
            p.count = r.one(&[2, 3, 4, 5, 6]);
            // Work of the load across the backlash over the energy of the approach.
            let share = r.between(0.1, 1.0);
            let sign = r.one(&[0.0, 0.0, 1.0, -1.0]);
            let load = share * 0.5 * reduced * approach * approach / backlash;
            p.load[0] = constant(sign * load * levers[0]);
            let flight = backlash / approach + contact_time;
            p.window = (3.0 * f64::from(p.count + 1) * flight).min(1.5 * LONGEST);
        }
        Kind::Load => {
            let frequency = r.decades(300.0, 2500.0);
            p.count = r.one(&[2, 3]);
            let period = frequency.recip();
            let turn = TAU * frequency / f64::from(toothing.teeth[0]);
            let ratio = levers[0] / levers[1];
            let turn = short(turn);
            p.speed = [turn, fitting(-turn * ratio)];
            force = r.decades(4e6, 5e7) * toothing.width * toothing.module;
            // In step, and in balance: rounding must not drive the gears apart.
            let torque = short(force * levers[0]);
            let torque = [torque, fitting(torque / ratio)];
            let ramp = r.chance(0.5);
            let end = short(period);
            p.load = torque.map(|x| {
                if ramp {
                    Load::Ramp(x, end)
                } else {
                    Load::Constant(x)
                }
            });
            let viscous = r.chance(0.25);
            match second {
                Second::Driven => p.load[1] = Load::None,
                _ if viscous => p.load[1] = Load::Viscous(short(torque[1] / -p.speed[1])),
                _ => {}
            }
            p.window = f64::from(p.count) * period;
        }
    }
    if !r.chance(0.35) {
        let lag = r.decades(1e-7, 2e-6);
        let modal = r.decades(0.002, 0.02);
        p.dashpot = short(lag * p.penalty);
        p.modal_ratio = if kind == Kind::Impact {
            0.0
        } else {
            short(modal)
        };
        p.rigid_ratio = equal_loss(&p, levers, (stiffness, PI / contact_time), force, lag);
    }
    Ok(p)
}

/// Speeds at which the second gear's flank recedes at `rolling` and the first approaches it [m/s].
fn move_apart(p: &mut Parameters, levers: [f64; 2], rolling: f64, approach: f64) {
    // A rack slides the way the flank of the gear goes, a wheel turns against it.
    let along = if p.toothing.rack { 1.0 } else { -1.0 };
    p.speed = [
        short((rolling + approach) / levers[0]),
        short(along * rolling / levers[1]),
    ];
}

fn constant(load: f64) -> Load {
    if load == 0.0 {
        Load::None
    } else {
        Load::Constant(short(load))
    }
}

/// Damping ratio of a spring `k` that loses as much in a cycle at `omega` as flank points with a dashpot that lags their
/// penalty, in series with teeth. Flat contact under `F` with the penalty `p` [Pa/m], width `b` and radius `rho` has the
/// half width `a = (3 F rho / (2 p b))^(1/3)` and the stiffness `2 a b p`.
fn equal_loss(
    p: &Parameters,
    levers: [f64; 2],
    (k, omega): (f64, f64),
    force: f64,
    lag: f64,
) -> f64 {
    let t = &p.toothing;
    let half_width = (1.5 * force * t.curvature(levers) / (p.penalty * t.width)).powf(1.0 / 3.0);
    let contact = 2.0 * half_width * t.width * p.penalty;
    let tooth = TAU * TOOTH_FREQUENCY / t.module;
    short(0.5 * omega * lag * (k / contact).min(1.0) + p.modal_ratio * omega / tooth)
}

/// The scene of sound parameters, or why they are not.
fn sound(p: &Parameters) -> Result<Result<(String, SceneFile), &'static str>, DrawError> {
    let file = format!("{}-{}.toml", p.set, p.number);
    let parse = |text: &str| SceneFile::unbuilt(&file, text, Origin::Shipped, false);
    let unplaced = parse(&text::scene(p, None, p.window))?;
    let [a, b] = [0, 1].map(|i| &unplaced.spec.gears[i]);
    let [start, end] = mesh_layout(a, b)?.path;
    let margin = PATH_MARGIN * (end - start);
    let path = start + margin + p.place * (end - start - 2.0 * margin);

    let scene = parse(&text::scene(p, Some(path), p.window))?;
    let (peak, contacts) = rigid::contacts(&scene, p.contact_time)?;
    if peak.is_nan() || peak > BEARABLE * p.toothing.width * p.toothing.module {
        return Ok(Err("the teeth are overloaded"));
    }
    let duration = match p.kind {
        Kind::Impact => match contacts[..] {
            [[from, to], ref rest @ ..] if to < p.window => {
                let length = to - from;
                let next = rest.first().map_or(p.window, |c| c[0]);
                if next < to + AFTER[1] * length {
                    return Ok(Err("the flanks touch again at once"));
                }
                to + AFTER[0] * length
            }
            _ => return Ok(Err("the flanks do not touch and part")),
        },
        Kind::Hammer => {
            let n = p.count as usize;
            if contacts.len() <= n {
                return Ok(Err("there are too few impacts"));
            }
            let [ends, next] = [contacts[n - 1][1], contacts[n][0]];
            ends + AFTER_LAST * (next - ends)
        }
        Kind::Load => {
            if contacts.is_empty() {
                return Ok(Err("the flanks do not touch"));
            }
            p.window
        }
    };
    if duration > LONGEST {
        return Ok(Err("it takes too long"));
    }
    let text = text::scene(p, Some(path), duration);
    let scene = parse(&text)?;
    Ok(Ok((text, scene)))
}
