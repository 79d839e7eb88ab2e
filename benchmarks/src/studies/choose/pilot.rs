//! Pilot run of rigid gears through the whole scene, and the window of the scene on which models are compared.
//!
//! The window goes from the start through so many contact times of touching teeth that several impacts or mesh cycles
//! are in it, and where gears run under a load, through mesh cycles at all of it; where the whole scene has no more than
//! that, it is the whole scene.

use super::plan::InelasticLevel;
use super::problem::Problem;
use super::reasons::per_cent;
use super::requirement::is_scalar;
use super::run::ChooseError;
use super::statics::MeshOscillator;
use super::trial::{Outcome, WindowModel};
use gearbench_integrators::Scheme;
use gearbench_integrators::table::TRIGONOMETRIC;
use gearbench_models::spec::{effective_radius, mesh_layout};
use gearbench_models::stiffness::{PairOrMesh, PairStiffness};
use gearbench_reports::numbers::quantile;
use gearbench_reports::numbers::{round_quantity, short};
use gearbench_reports::{ForceStatistics, Metric};

/// Steps and samples of a pilot run per contact time.
const STEPS: f64 = 32.0;
/// Samples per contact time around contacts.
const SAMPLES: f64 = 48.0;
/// Samples per period of a tooth where the metric is a peak: ringing teeth make it.
const RINGING: f64 = 10.0;
/// Ratio by which samples are thinned where no teeth touch.
const SPARSE: usize = 8;
/// Contact times, and part of the time that has passed, by which contacts of other models may come earlier or later.
const AROUND: [f64; 2] = [0.5, 0.02];
/// Most samples of a run.
const MOST_SAMPLES: f64 = 8000.0;
/// Contact times of touching teeth in a window.
const BUDGET: f64 = 12.0;
/// Mesh cycles in a window of lasting contact, and the upper bound of such a window in contact times.
const CYCLES: f64 = 4.0;
const MOST_BUDGET: f64 = 200.0;
/// Mesh cycles under the whole load that are in a window of gears that run.
const RUNNING: f64 = 2.0;
/// Part of the greatest mean force of a mesh cycle from which on the load is there, and of a cycle that gears touch in which
/// run under load.
const LOADED: f64 = 0.9;
/// Contact times that the end of an impact is followed by.
const MARGIN: f64 = 0.5;
/// Relative change of stiffness from whose effect the growth of errors is estimated.
const NUDGE: f64 = 0.01;
/// Smaller relative change of stiffness, which shows whether the effect is proportional to the change.
const SMALL_NUDGE: f64 = 0.001;
/// Change of a history from which on it is another one.
const ORDER_ONE: f64 = 0.5;
/// Effect of the smaller change over that of the larger one, in proportion a tenth, from which on a history does not repeat.
const NOT_IN_PROPORTION: f64 = 0.3;

/// Part of a scene, from its start, on which models are compared.
#[derive(Clone, Debug, PartialEq)]
pub struct Window {
    /// End of the window [s].
    pub end: f64,
    /// Times at which histories are recorded [s].
    pub grid: Vec<f64>,
    /// True if the window is the whole scene.
    pub whole: bool,
    /// Impacts, or spells of contact, that begin in the window.
    pub contacts: usize,
    /// Impacts, or spells of contact, that begin in the whole scene.
    pub all_contacts: usize,
    /// Time of contact in the whole scene over that in the window.
    pub contact_ratio: f64,
    /// Duration of the scene over that of the window.
    pub time_ratio: f64,
}

impl Window {
    /// Returns the window of the first `end` seconds, recorded every `spacing` seconds.
    pub fn to(end: f64, spacing: f64) -> Window {
        let n = (end / spacing).clamp(200.0, MOST_SAMPLES) as usize;
        Window {
            end,
            grid: (0..=n).map(|i| end * i as f64 / n as f64).collect(),
            whole: true,
            contacts: 0,
            all_contacts: 0,
            contact_ratio: 1.0,
            time_ratio: 1.0,
        }
    }

    /// Describes the window in words: its length [s] and the number of contacts.
    pub fn describe(&self) -> String {
        let spells = |n: usize| match n {
            1 => "one spell of contact".to_string(),
            n => format!("{n} spells of contact"),
        };
        if self.whole {
            format!(
                "the whole scene, {} with {}",
                round_quantity(self.end, "s", 4),
                spells(self.contacts)
            )
        } else {
            format!(
                "the first {}, 1/{} of the scene, with {} of {}",
                round_quantity(self.end, "s", 4),
                short(self.time_ratio, 3),
                spells(self.contacts),
                self.all_contacts
            )
        }
    }
}

fn method() -> Scheme {
    TRIGONOMETRIC.at_tolerance(1e-2)
}

/// A rigid run through the whole scene.
fn whole(
    problem: &Problem,
    level: &InelasticLevel,
    contact_time: f64,
) -> Result<Outcome, ChooseError> {
    let n = (STEPS * problem.duration / contact_time).clamp(400.0, 200_000.0) as usize;
    let window = Window {
        grid: (0..=n)
            .map(|i| problem.duration * i as f64 / n as f64)
            .collect(),
        ..Window::to(problem.duration, contact_time / SAMPLES)
    };
    Ok(WindowModel::new(problem, &level.scene, &level.modelling)?.run(&method(), &window)?)
}

/// Computes the approach of the flanks at the largest force of a rigid run [m].
///
/// # Errors
/// [`ChooseError::NoContact`] when no teeth touch, [`ChooseError::Budget`] when the run was cut off before they did.
pub fn approach(
    problem: &Problem,
    level: &InelasticLevel,
    oscillator: &MeshOscillator,
) -> Result<f64, ChooseError> {
    let run = whole(problem, level, oscillator.contact_time())?;
    let force = run.series.contact_force();
    let peak = force.iter().copied().fold(0.0, f64::max);
    if peak > 0.0 {
        Ok(peak / oscillator.stiffness)
    } else if problem.runner.budget().is_spent() {
        // The run was cut off, so that later contacts are not known.
        Err(ChooseError::Budget(problem.runner.budget().described()))
    } else {
        Err(ChooseError::NoContact {
            duration: problem.duration,
        })
    }
}

/// Spells of contact: times between which teeth touch [s].
fn spells(run: &Outcome) -> Vec<[f64; 2]> {
    let (t, f) = (&run.series.time_s, run.series.contact_force());
    let mut all: Vec<[f64; 2]> = Vec::new();
    let mut open = false;
    for (t, f) in t.iter().zip(f) {
        if *f > 0.0 {
            match all.last_mut().filter(|_| open) {
                Some(last) => last[1] = *t,
                None => all.push([*t, *t]),
            }
        }
        open = *f > 0.0;
    }
    all
}

/// When gears that run first carry the load that they carry at most over a mesh cycle [s]; nothing where they do not run
/// for a few cycles, or part.
fn loaded(run: &Outcome, cycle: f64) -> Option<f64> {
    let (t, f) = (&run.series.time_s, run.series.contact_force());
    let duration = *t.last()?;
    if cycle.is_nan() || (RUNNING + 1.0) * cycle > duration {
        return None;
    }
    // Impulse, and time of contact, up to each time.
    let mut sums = vec![[0.0; 2]];
    for (t, f) in t.windows(2).zip(f.windows(2)) {
        let (step, last) = (t[1] - t[0], sums[sums.len() - 1]);
        let touches = f64::from(u8::from(f[0] > 0.0 || f[1] > 0.0));
        sums.push([
            last[0] + 0.5 * (f[0] + f[1]) * step,
            last[1] + touches * step,
        ]);
    }
    // The mean over a cycle that ends there, of gears that touch all the while.
    let mean = |i: usize| {
        let from = t.partition_point(|x| *x < t[i] - cycle);
        let [impulse, touching] = [0, 1].map(|k| (sums[i][k] - sums[from][k]) / (t[i] - t[from]));
        (t[i] >= cycle && touching >= LOADED).then_some((t[i], impulse))
    };
    let means: Vec<(f64, f64)> = (0..t.len()).filter_map(mean).collect();
    let most = means.iter().map(|(_, m)| *m).fold(0.0, f64::max);
    let (first, _) = means.iter().find(|(_, m)| *m >= LOADED * most)?;
    (most > 0.0).then_some(*first)
}

/// Time in which the first mesh moves on by one tooth pair [s].
fn cycle(problem: &Problem) -> f64 {
    let mesh = &problem.scene.meshes[0];
    let [a, b] = mesh.gears.map(|i| &problem.scene.gears[i]);
    let speed = |g: &gearbench_models::spec::GearSpec| {
        let given = match &g.mount {
            gearbench_models::spec::Mount::Driven(p) => p.value(0.0),
            gearbench_models::spec::Mount::Fixed => 0.0,
            _ => g.speed,
        };
        (given * effective_radius(&g.body)).abs()
    };
    let base = mesh_layout(a, b).map_or(f64::INFINITY, |l| l.base_pitch);
    base / speed(a).max(speed(b))
}

/// Returns the window of a scene.
pub fn window(
    problem: &Problem,
    level: &InelasticLevel,
    oscillator: &MeshOscillator,
    metric: Metric,
) -> Result<Window, ChooseError> {
    let time = oscillator.contact_time();
    let run = whole(problem, level, time)?;
    let spells = spells(&run);
    let total: f64 = spells.iter().map(|[a, b]| b - a).sum();
    let budget = (CYCLES * cycle(problem)).clamp(BUDGET * time, MOST_BUDGET * time);
    let mut end = problem.duration;
    let mut used = 0.0;
    for [a, b] in &spells {
        if used + (b - a) >= budget {
            let cut = a + (budget - used);
            // An impact is let end.
            end = if b - cut < time {
                b + MARGIN * time
            } else {
                cut
            };
            break;
        }
        used += b - a;
    }
    let cycle = cycle(problem);
    if let Some(loaded) = loaded(&run, cycle) {
        end = end.max(loaded + RUNNING * cycle).min(problem.duration);
    }
    // A rest that is hardly longer than the window is taken along.
    if end > 0.7 * problem.duration {
        end = problem.duration;
    }
    let inside: f64 = (spells.iter())
        .map(|[a, b]| (b.min(end) - a).max(0.0))
        .sum();
    Ok(Window {
        whole: end >= problem.duration,
        contacts: spells.iter().filter(|[a, _]| *a < end).count(),
        all_contacts: spells.len(),
        contact_ratio: if inside > 0.0 { total / inside } else { 1.0 },
        time_ratio: problem.duration / end,
        grid: grid(end, spacing(problem, oscillator, metric), time, &spells),
        ..Window::to(end, time / SAMPLES)
    })
}

/// Distance of samples around contacts [s].
fn spacing(problem: &Problem, oscillator: &MeshOscillator, metric: Metric) -> f64 {
    let contact = oscillator.contact_time() / SAMPLES;
    if metric == Metric::PeakForceRel {
        contact.min(1.0 / (RINGING * problem.tooth_frequency()))
    } else {
        contact
    }
}

/// Times that are dense where something may touch: looking at modes costs more than stepping them in flight.
fn grid(end: f64, spacing: f64, contact_time: f64, spells: &[[f64; 2]]) -> Vec<f64> {
    let evenly = Window::to(end, spacing).grid;
    let near = |t: f64| {
        let margin = AROUND[0] * contact_time + AROUND[1] * t;
        (spells.iter()).any(|[a, b]| t > a - margin && t < b + margin)
    };
    let last = evenly.len() - 1;
    (evenly.into_iter().enumerate())
        .filter(|(i, t)| *i == last || i % SPARSE == 0 || near(*t))
        .map(|(_, t)| t)
        .collect()
}

/// Sensitivity of a history to a slightly larger stiffness of rigid gears.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensitivity {
    /// Factor by which the effect on the metric grows from the window to the whole scene, at least 1: phase errors
    /// accumulate from impact to impact.
    pub growth: f64,
    /// Effect of the change of stiffness on the metric over the whole scene, where the history does not repeat; 0 where
    /// it does.
    pub scatter: f64,
    /// Reason why the history does not repeat; `None` if it does.
    pub not_repeatable: Option<String>,
}

/// Measures the sensitivity of a scene with rigid gears.
///
/// A history repeats where its change is small, or in proportion to the change of the stiffness. Where 1 % more stiffness
/// makes another history and 0.1 % makes one that is nearly as different, neighbouring solutions part exponentially: no
/// model predicts such a history, and only its statistics have a meaning.
pub fn sensitivity(
    problem: &Problem,
    level: &InelasticLevel,
    window: &Window,
    oscillator: &MeshOscillator,
    metric: Metric,
) -> Result<Sensitivity, ChooseError> {
    let all = match window.whole {
        true => window.clone(),
        false => Window::to(problem.duration, spacing(problem, oscillator, metric)),
    };
    let run = |factor: f64, w: &Window| -> Result<Outcome, ChooseError> {
        let level = scaled(problem, level, oscillator, factor);
        Ok(WindowModel::new(problem, &level.scene, &level.modelling)?.run(&method(), w)?)
    };
    let (base, stiffer) = (run(1.0, &all)?, run(1.0 + NUDGE, &all)?);
    let far = stiffer.error(metric, &base);
    let growth = match window.whole {
        true => 1.0,
        false => {
            let near = run(1.0 + NUDGE, window)?.error(metric, &run(1.0, window)?);
            let growth = far / near;
            if growth.is_finite() {
                growth.max(1.0)
            } else {
                1.0
            }
        }
    };
    let repeats = Sensitivity {
        growth,
        scatter: 0.0,
        not_repeatable: None,
    };
    // Single numbers may agree by chance: histories say whether the run repeats.
    let history = match is_scalar(metric) {
        true => Metric::ForceL2Aligned,
        false => metric,
    };
    let large = stiffer.error(history, &base);
    if !(base.usable() && large.is_finite() && large >= ORDER_ONE) {
        return Ok(repeats);
    }
    let slightly = run(1.0 + SMALL_NUDGE, &all)?;
    let small = slightly.error(history, &base);
    if !(small.is_finite() && small >= NOT_IN_PROPORTION * large) {
        return Ok(repeats);
    }
    Ok(Sensitivity {
        scatter: far.max(slightly.error(metric, &base)),
        not_repeatable: Some(format!(
            "{} % more stiffness of rigid gears changes it by {}, {} % by {}",
            100.0 * NUDGE,
            per_cent(large),
            100.0 * SMALL_NUDGE,
            per_cent(small)
        )),
        ..repeats
    })
}

/// Computes the statistics of the contact force of a run.
pub fn statistics(run: &Outcome) -> ForceStatistics {
    let (t, f) = (&run.series.time_s, run.series.contact_force());
    let square: f64 = (t.windows(2).zip(f.windows(2)))
        .map(|(t, f)| 0.5 * (f[0] * f[0] + f[1] * f[1]) * (t[1] - t[0]))
        .sum();
    let duration = t.last().unwrap_or(&0.0) - t.first().unwrap_or(&0.0);
    let peaks: Vec<f64> = (spells(run).iter())
        .map(|[a, b]| {
            let within = t.iter().zip(f).filter(|(t, _)| (a..=b).contains(t));
            within.map(|(_, f)| *f).fold(0.0, f64::max)
        })
        .collect();
    ForceStatistics {
        rms_n: if duration > 0.0 {
            (square / duration).sqrt()
        } else {
            0.0
        },
        spells: peaks.len(),
        median_peak_n: quantile(&peaks, 0.5).unwrap_or(0.0),
        greatest_peak_n: peaks.into_iter().fold(0.0, f64::max),
    }
}

/// A rigid level with its stiffness times a factor; a stiffness that is no table becomes a constant one.
fn scaled(
    problem: &Problem,
    level: &InelasticLevel,
    oscillator: &MeshOscillator,
    factor: f64,
) -> InelasticLevel {
    let mut modelling = (*level.modelling).clone();
    for (c, mesh) in modelling.contacts.iter_mut().zip(&problem.scene.meshes) {
        if let PairStiffness::Table { k, .. } = &mut c.stiffness {
            k.iter_mut().for_each(|k| *k *= factor);
            continue;
        }
        let [a, b] = mesh.gears.map(|i| &problem.scene.gears[i]);
        let width = mesh_layout(a, b).map_or(1.0, |l| l.face_width);
        c.stiffness = PairStiffness::Constant {
            per_width: factor * oscillator.stiffness / width,
            of: PairOrMesh::Pair,
        };
    }
    InelasticLevel {
        modelling: modelling.into(),
        ..level.clone()
    }
}
