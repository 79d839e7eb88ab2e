//! Distributions of the parameters of random scenes.

use super::random::{Random, fitting, short};
use super::sets::{SampleError, Set};
use super::toothing::{PAIRS, RACKS, Toothing};
use gearbench_reports::Metric;
use std::f64::consts::{PI, TAU};

/// Longest duration of a scene [s].
pub const LONGEST: f64 = 20e-3;
/// Share of the scenes with one impact.
const IMPACTS: f64 = 0.45;
/// Share of the scenes with one or several impacts; see [`IMPACTS`].
const FREE: f64 = 0.70;
/// Share of the scenes without damping.
const UNDAMPED: f64 = 0.35;
/// Penalty over the module [Pa/m m]; this is 1e15 Pa/m at 4 mm.
const PENALTY: f64 = 4e12;
/// First natural frequency of a tooth times the module [Hz m].
const TOOTH_FREQUENCY: f64 = 244.0;

/// Kind of loading of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    Impact,
    /// Several impacts within the backlash, on alternating flanks.
    Hammer,
    /// Running under load for some mesh cycles.
    Load,
}

impl Kind {
    /// All kinds of loading.
    #[cfg(test)]
    pub const ALL: [Kind; 3] = [Kind::Impact, Kind::Hammer, Kind::Load];

    /// The name of the kind in records.
    pub fn as_str(self) -> &'static str {
        match self {
            Kind::Impact => "one impact",
            Kind::Hammer => "hammering",
            Kind::Load => "under load",
        }
    }

    /// Metrics of the questions. After several impacts the phase dominates the error of a history, so hammering is
    /// validated by scalar quantities; under load the speed oscillates about a mean, and its final value has little
    /// meaning.
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

/// Tolerances of the questions.
pub const TOLERANCES: [f64; 5] = [0.01, 0.02, 0.05, 0.1, 0.2];

/// Mount of the second gear.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Second {
    Free,
    Fixed,
    Driven,
}

/// Load on a hub, in N m or N.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Load {
    None,
    Constant(f64),
    /// A ramp from zero to a value, up to a time [s].
    Ramp(f64, f64),
    Viscous(f64),
}

/// Sampled parameters from which a scene is written.
#[derive(Clone, Debug)]
pub struct Parameters {
    pub set: String,
    pub number: usize,
    pub kind: Kind,
    pub metric: Metric,
    pub tolerance: f64,
    pub toothing: Toothing,
    /// Added inertia [kg m^2] or mass [kg] of the hubs.
    pub added: [f64; 2],
    pub second: Second,
    pub speed: [f64; 2],
    pub load: [Load; 2],
    pub backlash: f64,
    pub gap: f64,
    /// Position of the first tooth pair on the middle part of the path of contact, 0 to 1.
    pub place: f64,
    pub penalty: f64,
    /// Dashpots of flank points per area [N s/m per m^2].
    pub dashpot: f64,
    pub modal_ratio: f64,
    pub rigid_ratio: f64,
    /// Duration of an impact [s].
    pub contact_time: f64,
    /// Number of impacts, or of mesh cycles.
    pub count: u32,
    /// Time bound for rigid gears to complete the motion of the kind [s].
    pub window: f64,
}

pub fn parameters(r: &mut Random, set: &Set, number: usize) -> Result<Parameters, SampleError> {
    let own = &set.own;
    let share = match own.loaded_every {
        None => r.unit(),
        Some(n) if number.is_multiple_of(n) => 1.0,
        Some(_) => FREE * r.unit(),
    };
    let kind = match share {
        u if u < IMPACTS => Kind::Impact,
        u if u < FREE => Kind::Hammer,
        _ => Kind::Load,
    };
    let toothing = if kind == Kind::Impact && r.chance(own.racks) {
        r.one(&RACKS)
    } else {
        r.one(&PAIRS)
    };
    let effective_radii = toothing.effective_radii()?;
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
    let mass =
        |i: usize| (toothing.inertia(i) + added[i]) / (effective_radii[i] * effective_radii[i]);
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
    // Force at which the damping ratio is evaluated.
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
            move_apart(&mut p, effective_radii, rolling, approach);
            p.gap = short(r.decades(1e-6, 2e-5).min(0.5 * backlash));
            let share = r.decades(0.01, 0.3);
            let sign = r.one(&[0.0, 0.0, 1.0, -1.0]);
            // A load that holds back must not stop the gears before they touch.
            let least = 0.25 * reduced * approach * approach / p.gap;
            let along = if sign < 0.0 { least } else { f64::INFINITY };
            p.load[0] = constant(sign * (share * peak).min(along) * effective_radii[0]);
            p.window = 2.0 * p.gap / approach + 6.0 * contact_time;
        }
        Kind::Hammer => {
            let rolling = r.decades(0.1, 5.0);
            move_apart(&mut p, effective_radii, rolling, approach);
            p.gap = short(backlash * r.between(0.1, 0.9));
            p.count = r.one(&[2, 3, 4, 5, 6]);
            // Work of the load across the backlash over the energy of the approach.
            let share = r.between(0.1, 1.0);
            let sign = r.one(&[0.0, 0.0, 1.0, -1.0]);
            let load = share * 0.5 * reduced * approach * approach / backlash;
            p.load[0] = constant(sign * load * effective_radii[0]);
            let flight = backlash / approach + contact_time;
            p.window = (3.0 * f64::from(p.count + 1) * flight).min(1.5 * LONGEST);
        }
        Kind::Load => {
            let frequency = r.decades(300.0, 2500.0);
            p.count = r.one(&own.cycles);
            let period = frequency.recip();
            let turn = TAU * frequency / f64::from(toothing.teeth[0]);
            let ratio = effective_radii[0] / effective_radii[1];
            let turn = short(turn);
            p.speed = [turn, fitting(-turn * ratio)];
            force = r.decades(4e6, 5e7) * toothing.width * toothing.module;
            // In step, and in balance: rounding must not drive the gears apart.
            let torque = short(force * effective_radii[0]);
            let torque = [torque, fitting(torque / ratio)];
            let ramp = r.chance(0.5);
            let end = short(period * f64::from((p.count / 2).max(1)));
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
    let undamped = (own.undamped_impacts).filter(|_| kind == Kind::Impact);
    if !r.chance(undamped.unwrap_or(UNDAMPED)) {
        let lag = r.decades(1e-7, 2e-6);
        let modal = r.decades(0.002, 0.02);
        // Full finite elements, with which impacts are compared, have dashpots in the contact but no modal damping.
        let (lag, modal) = match own.dashpots {
            true if kind == Kind::Impact => (lag, 0.0),
            true => (lag, modal),
            false => (0.0, modal),
        };
        p.dashpot = short(lag * p.penalty);
        p.modal_ratio = short(modal);
        p.rigid_ratio = equal_loss(
            &p,
            effective_radii,
            (stiffness, PI / contact_time),
            force,
            lag,
        );
    }
    Ok(p)
}

/// Sets speeds such that the second gear's flank recedes at `rolling` and the first approaches it [m/s].
fn move_apart(p: &mut Parameters, effective_radii: [f64; 2], rolling: f64, approach: f64) {
    // A rack slides the way the flank of the gear goes, a wheel turns against it.
    let along = if p.toothing.rack { 1.0 } else { -1.0 };
    p.speed = [
        short((rolling + approach) / effective_radii[0]),
        short(along * rolling / effective_radii[1]),
    ];
}

fn constant(load: f64) -> Load {
    if load == 0.0 {
        Load::None
    } else {
        Load::Constant(short(load))
    }
}

/// Damping ratio of a spring `k` that loses as much in a cycle at `omega` as flank points with a dashpot that lags
/// their penalty, in series with teeth. Flat contact under `F` with the penalty `p` [Pa/m], width `b` and radius `rho`
/// has the half width `a = (3 F rho / (2 p b))^(1/3)` and the stiffness `2 a b p`.
fn equal_loss(
    p: &Parameters,
    effective_radii: [f64; 2],
    (k, omega): (f64, f64),
    force: f64,
    lag: f64,
) -> f64 {
    let t = &p.toothing;
    let half_width =
        (1.5 * force * t.curvature(effective_radii) / (p.penalty * t.width)).powf(1.0 / 3.0);
    let contact = 2.0 * half_width * t.width * p.penalty;
    let tooth = TAU * TOOTH_FREQUENCY / t.module;
    short(0.5 * omega * lag * (k / contact).min(1.0) + p.modal_ratio * omega / tooth)
}
