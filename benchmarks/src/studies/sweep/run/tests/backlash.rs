//! The oscillator with backlash, `x'' + 2 z x' + (1 + e cos W t) g(x) = Fm + Fa W^2 cos W t`, g the dead zone of half width 1
//! (A. Kahraman, R. Singh, Journal of Sound and Vibration 142, 1990): gears whose deflection is tiny beside the base pitch
//! are this oscillator. Root mean squares about the mean by RK4 with bisected contact events, 2000 and 8000 steps per
//! period agreeing to eight digits, speeds upwards and downwards from state to state. The gears are those of the shipped
//! scenes `backlash_parametric` and `backlash_forced`, at their own frequency as they stand.

mod oscillator;

use super::*;
use crate::context::Context;
use crate::scene_file::load;
use gearbench_integrators::State;
use gearbench_integrators::table::RK4;
use gearbench_models::spec::{Modelling, base_radius};
use gearbench_reports::series::{TRANSMISSION_ERROR, TimeSeries};
use oscillator::{Case, FM, FORCED, IndependentOscillator, PARAMETRIC, Z};
use std::f64::consts::TAU;

/// Half of the dead zone over the base pitch; the mean deflection is a tenth of it. Larger ones shift the teeth, by some
/// 1e-6 of the answer; smaller ones drown in the rounding of hub angles after a thousand mesh cycles.
const B: f64 = 2e-5;
/// Periods of settling: between jumps, and at the end of the branch, where the transient is longest.
const PERIODS: [f64; 2] = [120.0, 400.0];

/// Gears that are equivalent to the oscillator: the pinion turns evenly or is at rest, the wheel vibrates on the mesh.
struct Gears {
    scene: SceneFile,
    /// Base pitch [m], half of the dead zone [m], base radius of the wheel [m].
    pitch: f64,
    b: f64,
    rb: f64,
    /// Natural frequency [rad/s] and inertia of the oscillator.
    omega: f64,
    inertia: f64,
    sign: f64,
    case: Case,
}

const K: f64 = 1e8;

impl Gears {
    fn new(case: Case) -> Self {
        let scene = load(&Context::default(), case.scene).unwrap_or_else(|e| panic!("{e:?}"));
        let [a, b] = [&scene.spec.gears[0], &scene.spec.gears[1]];
        let l = mesh_layout(a, b).unwrap();
        let rb = base_radius(&b.body);
        let inertia = b.inertia.unwrap();
        Gears {
            pitch: l.base_pitch,
            b: B * l.base_pitch,
            rb,
            omega: (K * rb * rb / inertia).sqrt(),
            inertia,
            sign: scene.spec.meshes[0].start.side.sign(),
            case,
            scene,
        }
    }

    /// Sets the wheel's loads at a speed: the mean force is Fm at any damping, the oscillating one Fa.
    fn load(&self, spec: &mut SceneSpec, w: f64, speed: f64, phase: f64) {
        let c = 2.0 * Z * self.omega * self.inertia;
        let unit = self.sign * self.rb * K * self.b;
        spec.gears[1].loads = vec![
            Load::Viscous(c),
            Load::Applied(Profile::Harmonic {
                mean: FM * unit + c * speed,
                amplitude: self.case.fa * w * w * unit,
                frequency: w * self.omega / TAU,
                phase,
            }),
        ];
    }

    /// The speed of the wheel [rad/s] in even running at a frequency.
    fn speed(&self, w: f64) -> f64 {
        let turning = matches!(self.scene.spec.gears[0].mount, Mount::Driven(_));
        let f = w * self.omega / TAU;
        if turning {
            -self.sign * f * self.pitch / self.rb
        } else {
            0.0
        }
    }

    /// Returns the rms over [`B`] in the last periods of the shipped scene with a model.
    fn as_shipped(&self, label: &str) -> f64 {
        let choice = self.scene.model(label).unwrap();
        let entry = Configuration::of(&self.scene, choice);
        let period = TAU / (self.case.w * self.omega);
        let end = self.scene.duration;
        let grid: Vec<f64> = (0..=256)
            .map(|i| end - period * f64::from(256 - i) / 256.0)
            .collect();
        let method = self.scene.study.integrators[0];
        let conditions = Conditions {
            events: true,
            ..Conditions::of(&self.scene)
        };
        let job = Job {
            t_end: end,
            also_steps: false,
            repeats: 0,
            ..conditions.job((&entry.scene, &entry.modelling), &method, &grid)
        };
        let row = crate::experiment::run::run(&job).unwrap();
        assert!(!row.status.is_failure(), "{:?}", row.message);
        self.rms(&row.series.unwrap())
    }

    /// The rms over [`B`] of a history over one period of 256 parts.
    fn rms(&self, series: &TimeSeries) -> f64 {
        let (_, error) = series.all_of(TRANSMISSION_ERROR).next().unwrap();
        let x = &error[..256];
        let mean = x.iter().sum::<f64>() / 256.0;
        let square: f64 = x.iter().map(|x| ((x - mean) / self.b).powi(2)).sum();
        (square / 256.0).sqrt()
    }

    /// The rms over [`B`] of the oscillator at frequencies from state to state, by the runs of a sweep.
    fn swept(&self, ws: &[f64], branch: Branch, last: f64) -> Vec<f64> {
        let mut from: Option<EndState> = None;
        let mut found = Vec::new();
        for &w in ws {
            let f = w * self.omega / TAU;
            let mut entry = Configuration::of(&self.scene, &self.scene.models[0]);
            let periods = PERIODS[usize::from(w == last)];
            self.load(&mut entry.scene, w, self.speed(w), 0.0);
            let plan = Plan {
                method: RK4.at_step(1.0 / (f * 400.0)),
                settle: periods / f,
                ..super::plan(&self.scene, vec![f], 8, 0.0)
            };
            let runner = Runner::default();
            let one = Branches {
                pair: Pair::in_scene("wave", &entry.scene).unwrap(),
                plan: &plan,
                runner: &runner,
                entry: &entry,
                method: &plan.method,
                resonance: self.omega / TAU,
                total: 1,
            };
            let (row, end) = one.one(branch, f, from.as_ref()).unwrap();
            assert!(!row.status.is_failure(), "{:?}", row.message);
            found.push(row.steady.unwrap().error_rms_m / self.b);
            from = end;
        }
        found
    }

    /// Returns the rms over [`B`] of the oscillator for gears at rest under an oscillating load.
    fn shaken(&self, ws: &[f64], last: f64) -> Vec<f64> {
        let modelling: &Modelling = &self.scene.models[0].modelling;
        let mut from: Option<State> = None;
        let (mut phase, mut before) = (0.0, 0.0);
        let mut found = Vec::new();
        for &w in ws {
            let mut spec = self.scene.spec.clone();
            let t = from.as_ref().map_or(0.0, |s| s.t);
            phase += (before - w) * self.omega * t;
            before = w;
            self.load(&mut spec, w, 0.0, phase);
            let period = TAU / (w * self.omega);
            let begin = t + period * (2.0 * PERIODS[usize::from(w == last)]).round();
            let grid: Vec<f64> = (0..=256)
                .map(|i| begin + period * f64::from(i) / 256.0)
                .collect();
            let method = RK4.at_step(period / 400.0);
            let conditions = Conditions {
                events: true,
                ..Conditions::of(&self.scene)
            };
            let job = Job {
                t_end: grid[256],
                also_steps: false,
                repeats: 0,
                ..conditions.job((&spec, modelling), &method, &grid)
            };
            let mut built = Scene::build(&spec, modelling, crate::models::models()).unwrap();
            let mut state = from.take().unwrap_or_else(|| built.initial());
            let row = run_from(&job, &mut built, &mut state, std::time::Duration::ZERO).unwrap();
            assert!(!row.status.is_failure(), "{:?}", row.message);
            found.push(self.rms(&row.series.unwrap()));
            from = Some(state);
        }
        found
    }
}

/// Frequencies with root mean squares that are known.
#[allow(clippy::print_stdout)]
fn near(ws: &[f64], found: &[f64], known: &[(f64, f64)], tolerance: f64) {
    for (w, rms) in known {
        let i = ws.iter().position(|x| x == w).unwrap();
        println!(
            "backlash oscillator, W = {w}: root mean square off by {:.1e} of half the backlash",
            (found[i] - rms).abs()
        );
        assert!(
            (found[i] - rms).abs() < tolerance,
            "W = {w}: {} {rms}",
            found[i]
        );
    }
}

const UP: [f64; 9] = [0.80, 0.85, 0.88, 0.90, 0.903, 0.905, 0.906, 0.907, 0.95];
const DOWN: [f64; 9] = [0.95, 0.90, 0.87, 0.85, 0.84, 0.837, 0.835, 0.834, 0.80];
const KNOWN_UP: [(f64, f64); 4] = [
    (0.80, 0.03985167),
    (0.85, 0.05126528),
    (0.90, 0.07212562),
    (0.95, 0.10861053),
];
const KNOWN_DOWN: [(f64, f64); 3] = [(0.85, 0.14429031), (0.90, 0.12608384), (0.80, 0.03985167)];

/// The independent implementation of the oscillator jumps at the known frequencies.
#[test]
fn the_oscillator_jumps_where_it_is_known_to() {
    let own = |ws: &[f64]| -> Vec<f64> {
        let mut own = IndependentOscillator {
            case: PARAMETRIC,
            w: ws[0],
            t: 0.0,
            x: [1.1, 0.0],
        };
        ws.iter().map(|w| own.at(*w, 300)).collect()
    };
    let up = own(&UP);
    near(&UP, &up, &KNOWN_UP, 1e-7);
    assert!(up[6] < 0.09 && up[7] > 0.11, "{up:?}");
    let down = own(&DOWN);
    near(&DOWN, &down, &KNOWN_DOWN, 1e-7);
    assert!(down[6] > 0.14 && down[7] < 0.06, "{down:?}");
}

/// Neither is a scene that the command sweeps: one does not run, and the drag of the other is balanced at its own speed.
#[test]
fn commands_refuse_to_sweep_them() {
    let refused = |case: Case| {
        let scene = Gears::new(case).scene;
        match Pair::in_scene(&scene.name, &scene.spec) {
            Ok(pair) => {
                assert!((pair.own_force() / (FM * K * B) - Gears::new(case).pitch).abs() < 1e-9);
                let f = case.w * Gears::new(case).omega / TAU;
                pair.check_speeds(&scene.name, [0.9 * f, f].into_iter())
            }
            Err(e) => Err(e),
        }
        .unwrap_err()
        .to_string()
    };
    let e = refused(FORCED);
    assert!(e.contains("`pinion` is fixed"), "{e}");
    let e = refused(PARAMETRIC);
    assert!(
        e.contains("2171 Hz") && e.contains("the loads cause"),
        "{e}"
    );
}

/// The shipped scenes have the parameters of the oscillators, and both solutions of each have the amplitudes in the
/// table of benchmarks/scenes/README.md.
#[test]
#[allow(clippy::print_stdout)]
fn shipped_scenes_are_the_oscillators() {
    for (case, pressed, parted) in [
        (PARAMETRIC, 0.05126528, 0.14429031),
        (FORCED, 0.06135720, 0.20225840),
    ] {
        let gears = Gears::new(case);
        let mut spec = gears.scene.spec.clone();
        gears.load(&mut spec, case.w, gears.speed(case.w), 0.0);
        let of = |spec: &SceneSpec| -> Vec<f64> {
            let loads = &spec.gears[1].loads;
            [0.0, 1e-4]
                .iter()
                .flat_map(|t| {
                    loads.iter().map(|load| match load {
                        Load::Viscous(c) => *c,
                        Load::Applied(p) => p.value(*t),
                    })
                })
                .collect()
        };
        for (stands, follows) in of(&gears.scene.spec).iter().zip(of(&spec)) {
            assert!(
                (stands / follows - 1.0).abs() < 1e-12,
                "{}: {stands} {follows}",
                case.scene
            );
        }
        for (label, known) in [("pressed", pressed), ("parted", parted)] {
            let found = gears.as_shipped(label);
            println!("{}, {label}: {found:.8}, known {known:.8}", case.scene);
            assert!(
                (found - known).abs() < 2e-6,
                "{}, {label}: {found} {known}",
                case.scene
            );
        }
    }
}

/// Gears on a wave of stiffness run on both of its branches, and jump where it does.
#[test]
fn gears_are_the_parametric_oscillator_on_both_branches() {
    let gears = Gears::new(PARAMETRIC);
    let up = gears.swept(&UP, Branch::Up, 0.907);
    near(&UP, &up, &KNOWN_UP, 1e-6);
    assert!(up[6] < 0.09 && up[7] > 0.11, "{up:?}");
    let down = gears.swept(&DOWN, Branch::Down, 0.834);
    near(&DOWN, &down, &KNOWN_DOWN, 1e-6);
    assert!(down[6] > 0.14 && down[7] < 0.06, "{down:?}");
}

/// Gears at rest under a load with a harmonic, likewise.
#[test]
fn gears_under_a_harmonic_load_are_the_forced_oscillator_on_both_branches() {
    let gears = Gears::new(FORCED);
    let ws = [0.75, 0.80, 0.815, 0.822, 0.825, 0.827, 0.828, 0.829, 0.85];
    let up = gears.shaken(&ws, 0.829);
    near(
        &ws,
        &up,
        &[(0.75, 0.04480330), (0.80, 0.06135720), (0.85, 0.18130073)],
        1e-6,
    );
    assert!(up[6] < 0.1 && up[7] > 0.15, "{up:?}");
    let ws = [
        0.85, 0.80, 0.75, 0.73, 0.72, 0.714, 0.711, 0.71, 0.709, 0.708,
    ];
    let down = gears.shaken(&ws, 0.708);
    near(&ws, &down, &[(0.80, 0.20225840), (0.75, 0.22472379)], 1e-6);
    assert!(down[8] > 0.2 && down[9] < 0.05, "{down:?}");
}
