//! Steady state of a run: channels over exactly whole mesh cycles, their harmonics, and one mean cycle.

use crate::experiment::resample::{resample, resample_smooth};
use gearbench_reports::force::ForceHistory;
use gearbench_reports::record::{Bearing, Steady};
use gearbench_reports::sweep::ShaftOrders;
use std::f64::consts::TAU;

/// Samples of a mean mesh cycle.
const PER_CYCLE: usize = 128;
/// Number of harmonics of the mesh frequency in the record.
pub const HARMONICS: usize = 24;
/// Orders of a shaft that are kept beyond twice that of the mesh.
const SIDEBANDS: usize = 4;
/// Contact force below this part of its mean counts as none.
const APART: f64 = 1e-6;

/// Histories of a run on its time grid.
pub struct Histories<'a> {
    /// Times of the grid [s], ascending.
    pub time: &'a [f64],
    /// Position of the reference pair over the base pitch, from the pitch point, by the second gear's displacement.
    pub position: &'a [f64],
    /// Transmission error along the line of action [m].
    pub error: &'a [f64],
    /// Contact force of the mesh [N].
    pub force: &'a [f64],
    /// Piecewise contact force between events, where it is known: its greatest value, mean and contact times do not
    /// depend on samples.
    pub pieces: Option<&'a ForceHistory>,
    /// Speed of the first gear [rad/s].
    pub speed: &'a [f64],
    /// Names and numbers of teeth of both gears.
    pub gears: [(&'a str, usize); 2],
    /// Bearing forces: gear, whether they contain its own inertia, x and y [N].
    pub bearings: Vec<(String, bool, &'a [f64], &'a [f64])>,
}

/// Measures the last `cycles` whole mesh cycles, in so many samples `per_cycle` (a multiple of 128); `None` when the
/// histories hold fewer.
///
/// Everything is resampled at even positions of the pair, so that a speed that drifts a little smears no harmonic.
pub fn measure(h: &Histories<'_>, [cycles, per_cycle]: [usize; 2]) -> Option<Steady> {
    let n = h.position.len();
    if n < 2 || cycles == 0 || h.time.len() != n {
        return None;
    }
    // Positions may fall with time: the sense of rotation is the scene's.
    let forward = h.position[n - 1] > h.position[0];
    let along: Vec<f64> = (h.position.iter())
        .map(|p| if forward { *p } else { -p })
        .collect();
    if along.windows(2).any(|w| w[1] <= w[0]) {
        return None;
    }
    // Whole cycles end at the last position where a cycle of the pair begins.
    let end = (along[n - 1] - 0.5).floor() + 0.5;
    let start = end - cycles as f64;
    if start < along[0] {
        return None;
    }
    let at: Vec<f64> = (0..per_cycle * cycles)
        .map(|i| start + (i as f64 + 0.5) / per_cycle as f64)
        .collect();
    let sampled = |y: &[f64]| resample(&along, y, &at);
    let (error, force) = (resample_smooth(&along, h.error, &at), sampled(h.force));
    let ends = resample(&along, h.time, &[start, end]);
    let mesh_frequency = cycles as f64 / (ends[1] - ends[0]);
    let speed = mean(&sampled(h.speed));

    let within = h.pieces.map(|p| p.within(ends[0], ends[1]));
    let lasts = ends[1] - ends[0];
    let mean_force = within.map_or_else(|| mean(&force), |w| w.impulse_ns / lasts);
    let bearings = (h.bearings.iter())
        .map(|(gear, own_inertia, x, y)| {
            let (x, y) = (sampled(x), sampled(y));
            let (ax, ay) = (amplitudes(&x, cycles), amplitudes(&y, cycles));
            Bearing {
                gear: gear.clone(),
                own_inertia: *own_inertia,
                mean_n: mean(&x).hypot(mean(&y)),
                rms_n: rms(&x).hypot(rms(&y)),
                harmonics_n: ax.iter().zip(&ay).map(|(a, b)| a.hypot(*b)).collect(),
            }
        })
        .collect();
    // Over whole turns of a shaft every tooth has its own share; what repeats is a mesh cycle otherwise.
    let turns = |teeth: usize| teeth > 0 && cycles.is_multiple_of(teeth);
    let whole: Vec<(&str, usize)> = h.gears.into_iter().filter(|g| turns(g.1)).collect();
    let shaft_orders = (whole.iter())
        .map(|(gear, teeth)| ShaftOrders {
            gear: (*gear).to_owned(),
            teeth: *teeth,
            error_m: (1..=2 * teeth + SIDEBANDS)
                .map(|n| amplitude(&error, n * (cycles / teeth)))
                .collect(),
        })
        .collect();
    let cycle = mean_cycle(&error, per_cycle);
    let regular = rms(&cycle);
    let deviations: Vec<f64> = (error.iter().enumerate())
        .map(|(i, e)| e - cycle[i % per_cycle])
        .collect();
    let mut one = Steady {
        mesh_frequency_hz: mesh_frequency,
        speed_rad_s: speed,
        cycles,
        error_mean_m: mean(&error),
        error_rms_m: rms(&error),
        error_peak_to_peak_m: range(&error),
        error_harmonics_m: amplitudes(&error, cycles),
        error_long_peak_to_peak_m: range(&running_mean(&error, per_cycle)),
        shaft_orders,
        force_mean_n: mean_force,
        force_peak_n: within
            .map_or_else(|| force.iter().copied().fold(0.0, f64::max), |w| w.peak_n),
        separated: within.map_or_else(
            || share(&force, |f| f <= APART * mean_force),
            |w| (1.0 - w.contact_s / lasts).max(0.0),
        ),
        irregular: if regular > 0.0 && whole.is_empty() {
            rms(&deviations) / regular
        } else {
            0.0
        },
        bearings,
        position: (0..PER_CYCLE)
            .map(|i| (i as f64 + 0.5) / PER_CYCLE as f64 - 0.5)
            .collect(),
        force_cycle_n: in_blocks(&mean_cycle(&force, per_cycle)),
        error_cycle_m: in_blocks(&cycle),
        ..Steady::default()
    };
    if !forward {
        one.error_cycle_m.reverse();
        one.force_cycle_n.reverse();
    }
    Some(one)
}

fn mean(x: &[f64]) -> f64 {
    x.iter().sum::<f64>() / x.len() as f64
}

/// Computes the root mean square about the mean.
fn rms(x: &[f64]) -> f64 {
    let m = mean(x);
    (x.iter().map(|x| (x - m).powi(2)).sum::<f64>() / x.len() as f64).sqrt()
}

fn range(x: &[f64]) -> f64 {
    let (low, high) = (x.iter()).fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| {
        (a.min(*x), b.max(*x))
    });
    high - low
}

fn share(x: &[f64], is: impl Fn(f64) -> bool) -> f64 {
    x.iter().filter(|x| is(**x)).count() as f64 / x.len() as f64
}

fn mean_cycle(x: &[f64], per_cycle: usize) -> Vec<f64> {
    let cycles = (x.len() / per_cycle) as f64;
    (0..per_cycle)
        .map(|i| x.iter().skip(i).step_by(per_cycle).sum::<f64>() / cycles)
        .collect()
}

/// Means over equal parts of a cycle, as many as a mean cycle has.
fn in_blocks(x: &[f64]) -> Vec<f64> {
    x.chunks(x.len() / PER_CYCLE).map(mean).collect()
}

/// Computes the amplitudes of the harmonics `1 .. HARMONICS` of the cycle from samples over whole cycles: sums over all
/// samples, so that no window is needed and other harmonics do not leak.
pub fn amplitudes(x: &[f64], cycles: usize) -> Vec<f64> {
    (1..=HARMONICS).map(|k| amplitude(x, k * cycles)).collect()
}

/// Amplitude of what repeats so many times over all samples.
fn amplitude(x: &[f64], times: usize) -> f64 {
    let n = x.len() as f64;
    let turn = TAU * times as f64 / n;
    let (mut re, mut im) = (0.0, 0.0);
    for (i, x) in x.iter().enumerate() {
        let (sin, cos) = (turn * i as f64).sin_cos();
        re += x * cos;
        im += x * sin;
    }
    2.0 / n * re.hypot(im)
}

/// Means over windows of a length, at every place where one fits.
fn running_mean(x: &[f64], length: usize) -> Vec<f64> {
    let mut sum: f64 = x[..length].iter().sum();
    let mut means = vec![sum / length as f64];
    for (out, new) in x.iter().zip(&x[length..]) {
        sum += new - out;
        means.push(sum / length as f64);
    }
    means
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns two harmonics on a mean, at a frequency, sampled over a time that is no whole number of cycles.
    fn histories(frequency: f64, drift: f64, turn: f64) -> [Vec<f64>; 5] {
        let time: Vec<f64> = (0..4000).map(|i| f64::from(i) * 5e-6).collect();
        let position: Vec<f64> = (time.iter())
            .map(|t| turn * (0.21 + frequency * t * (1.0 + drift * t)))
            .collect();
        let wave = |p: f64| 1e-6 * (8.0 + 0.5 * (TAU * p).sin() + 0.2 * (3.0 * TAU * p).cos());
        let error = position.iter().map(|p| wave(*p)).collect();
        let force = position
            .iter()
            .map(|p| (1000.0 * (0.5 + (TAU * p).sin())).max(0.0))
            .collect();
        let speed = time.iter().map(|_| 42.0).collect();
        [time, position, error, force, speed]
    }

    #[test]
    fn harmonics_are_found_at_any_speed_and_sense() {
        for (frequency, drift, turn) in [(1000.0, 0.0, 1.0), (1234.5, 0.8, 1.0), (777.0, 0.0, -1.0)]
        {
            let [time, position, error, force, speed] = histories(frequency, drift, turn);
            let s = measure(
                &Histories {
                    time: &time,
                    position: &position,
                    error: &error,
                    force: &force,
                    pieces: None,
                    gears: [("a", 3), ("b", 4)],
                    speed: &speed,
                    bearings: vec![("a".into(), false, &force, &error)],
                },
                [8, 128],
            )
            .unwrap();
            // Linear interpolation between some hundred samples of a cycle.
            let near = |x: f64, y: f64, t: f64| assert!((x - y).abs() < t * y.abs(), "{x} {y}");
            near(s.error_mean_m, 8e-6, 1e-6);
            near(s.error_harmonics_m[0], 0.5e-6, 1e-3);
            near(s.error_harmonics_m[2], 0.2e-6, 3e-3);
            assert!(s.error_harmonics_m[1] < 2e-10, "{:?}", s.error_harmonics_m);
            near(s.error_rms_m, 1e-6 * (0.125_f64 + 0.02).sqrt(), 2e-3);
            near(s.separated, 1.0 / 3.0, 0.02);
            assert!(s.irregular < 5e-3, "{}", s.irregular);
            near(s.bearings[0].mean_n, s.force_mean_n, 1e-6);
            if drift == 0.0 {
                near(s.mesh_frequency_hz, frequency, 1e-6);
            }
            // The mean cycle stands at the positions it names.
            let i = s.position.iter().position(|p| *p > 0.2).unwrap();
            let p = TAU * s.position[i];
            near(
                s.error_cycle_m[i],
                1e-6 * (8.0 + 0.5 * p.sin() + 0.2 * (3.0 * p).cos()),
                1e-4,
            );
        }
    }

    /// A pitch deviation of every third tooth and a run-out have harmonics at the orders of their shafts.
    #[test]
    fn whole_turns_have_the_orders_of_their_shaft() {
        let time: Vec<f64> = (0..6000).map(|i| f64::from(i) * 5e-6).collect();
        let position: Vec<f64> = time.iter().map(|t| 0.21 + 1000.0 * t).collect();
        let wave = |p: f64| {
            1e-6 * (0.5 * (TAU * p).sin()
                + 0.2 * (TAU * p / 12.0).cos()
                + 0.1 * (TAU * p / 3.0).sin())
        };
        let error: Vec<f64> = position.iter().map(|p| wave(*p)).collect();
        let force = vec![100.0; time.len()];
        let s = measure(
            &Histories {
                time: &time,
                position: &position,
                error: &error,
                force: &force,
                pieces: None,
                gears: [("pinion", 12), ("wheel", 17)],
                speed: &force,
                bearings: Vec::new(),
            },
            [24, 128],
        )
        .unwrap();
        let [orders] = s.shaft_orders.as_slice() else {
            panic!("{:?}", s.shaft_orders);
        };
        assert_eq!((orders.gear.as_str(), orders.teeth), ("pinion", 12));
        for (i, a) in orders.error_m.iter().enumerate() {
            let expected = match i + 1 {
                1 => 0.2e-6,
                4 => 0.1e-6,
                12 => 0.5e-6,
                _ => 0.0,
            };
            assert!((a - expected).abs() < 1e-10, "{}: {a}", i + 1);
        }
        // The mesh cycle itself is averaged away, slow waves hardly.
        assert!((s.error_long_peak_to_peak_m / 1e-6 - 0.53).abs() < 0.05);
        assert_eq!(s.irregular, 0.0);
    }

    #[test]
    fn too_few_cycles_and_turning_back_are_refused() {
        let [time, mut position, error, force, speed] = histories(1000.0, 0.0, 1.0);
        let of = |position: &[f64], cycles: usize| {
            measure(
                &Histories {
                    time: &time,
                    position,
                    error: &error,
                    force: &force,
                    pieces: None,
                    gears: [("a", 3), ("b", 4)],
                    speed: &speed,
                    bearings: Vec::new(),
                },
                [cycles, 128],
            )
        };
        assert!(of(&position, 19).is_some());
        assert!(of(&position, 21).is_none());
        position[2000] = 0.0;
        assert!(of(&position, 8).is_none());
    }
}
