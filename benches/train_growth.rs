//! Growth of cost with the length of a train: `cargo bench --bench train_growth [-- MODEL,..]`.
//!
//! Trains of n = 1 to 64 meshes (n + 1 equal gears in a row, every one an idler but the ends) under a torque, all of them
//! by turns. Printed are the time at work per simulated second, the work behind it, memory, and the exponent that a power of
//! n would have: `slope of ln(time) over ln(n)`, by least squares and of the last doubling.

mod support;

use gearbench::context::Context;
use gearbench::scene_file::{Origin, SceneFile};
use gearbench_integrators::{NullSink, Resolution, SecondOrderSystem, TimePlan, Work};
use gearbench_models::scene::Scene;
use std::fmt::Write as _;
use std::time::Instant;
use support::ratio::{busy_seconds, seconds};
use support::scenes::{built, method, run};

const MESHES: [usize; 7] = [1, 2, 4, 8, 16, 32, 64];

/// Largest accepted exponent.
const BAR: f64 = 1.1;

/// Model, method, resolution, simulated time [s].
const RUNS: [(&str, &str, Resolution, f64); 6] = [
    ("rigid", "velocity-verlet", Resolution::Step(1e-6), 2e-3),
    ("rigid", "dopri5", Resolution::Tolerance(1e-5), 2e-3),
    (
        "rigid",
        "generalised-alpha(rho_inf=0.8)",
        Resolution::Step(2e-6),
        2e-3,
    ),
    (
        "movable-teeth",
        "velocity-verlet",
        Resolution::Step(1e-6),
        2e-3,
    ),
    (
        "movable-teeth",
        "generalised-alpha(rho_inf=0.8)",
        Resolution::Step(2e-6),
        2e-3,
    ),
    ("elastic", "trigonometric", Resolution::Step(1e-6), 4e-4),
];

/// Returns a train: its first gear drives, the last one carries the torque. Flanks overlap at the start about as much
/// as under it, because meshes whose flanks just touch open and close repeatedly before the load reaches them.
fn text(meshes: usize) -> String {
    let mut text = String::from(
        "schema = 1\nname = \"train\"\ntitle = \"A train\"\nduration_s = 2e-3\n\
         tolerance = { metric = \"force_l1\", limit = 0.05, against = \"self\" }\n",
    );
    let last = meshes;
    for k in 0..=meshes {
        // Torques keep their sign down a train where speeds change theirs at every mesh.
        let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
        let torque = match k {
            0 => 40.0,
            k if k == last => -40.0 * sign,
            _ => 0.0,
        };
        let _ = write!(
            text,
            "[gears.g{k}]\nteeth = 24\nmodule_m = 0.004\nface_width_m = 0.01\nthinning_m = 2e-5\n\
             bore_radius_m = 0.015\nspeed_rad_s = {:?}\nloads = [{{ torque_nm = {torque:?} }}]\n",
            50.0 * sign,
        );
    }
    for k in 0..meshes {
        let flank = if k % 2 == 0 { "left" } else { "right" };
        let _ = write!(
            text,
            "[[meshes]]\ngears = [\"g{k}\", \"g{}\"]\ncentre_distance_m = 0.096\n\
             start = {{ flank = \"{flank}\", gap_m = -4e-6 }}\n",
            k + 1
        );
    }
    text + "[[models]]\nmodel = \"rigid\"\n\
         contact = { stiffness = \"iso6336\", damping = { law = \"ratio-at-load\", ratio = 0.05 } }\n\
         [[models]]\nmodel = \"movable-teeth\"\n\
         contact = { stiffness = { kind = \"constant\", stiffness_n_per_m2 = 2.4e10 }, damping = { law = \"ratio-at-load\", ratio = 0.05 } }\n\
         parameters = { tooth_stiffness_n_per_m = 7e8, tooth_mass_kg = 5e-3, tooth_damping_ns_per_m = 60.0 }\n\
         [[models]]\nmodel = \"elastic\"\n\
         parameters = { flank_elements = 8, width_elements = 1, modes = 50, damping_ratio = 0.02 }\n\
         contact = { penalty_pa_per_m = 1e15 }\n"
}

fn train(meshes: usize, label: &str) -> Scene {
    let file = SceneFile::unbuilt(
        &Context::default(),
        "train",
        &text(meshes),
        Origin::Shipped,
        false,
    )
    .unwrap_or_else(|e| panic!("{e:?}"));
    built(&file, label, &[])
}

/// Fits the slope of a line through the points by least squares.
fn slope(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let mean = points
        .iter()
        .fold([0.0; 2], |m, p| [m[0] + p.0 / n, m[1] + p.1 / n]);
    let [xx, xy] = points.iter().fold([0.0; 2], |s, p| {
        let (x, y) = (p.0 - mean[0], p.1 - mean[1]);
        [s[0] + x * x, s[1] + x * y]
    });
    xy / xx
}

/// Returns the largest memory of this process [MB], where the system reports it.
fn memory() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|l| l.starts_with("VmHWM:"))?;
    let kilobytes: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kilobytes / 1024.0)
}

#[allow(clippy::print_stdout)]
fn main() {
    let wanted = std::env::args().nth(1).filter(|w| !w.starts_with("--"));
    for (label, by, resolution, end) in RUNS {
        if wanted
            .as_ref()
            .is_some_and(|w| !w.split(',').any(|w| w == label))
        {
            continue;
        }
        println!("{label}, {by}");
        let begin = Instant::now();
        let mut trains: Vec<(Scene, f64)> = vec![];
        for n in MESHES {
            let mut scene = None;
            let setup = seconds(|| scene = Some(train(n, label)));
            trains.extend(scene.map(|s| (s, setup)));
        }
        let mut least = [f64::INFINITY; MESHES.len()];
        let mut work = [Work::default(); MESHES.len()];
        for turn in 0..3 {
            // Short trains are quick: three turns each, as long as all together take less than some minutes.
            if turn > 0 && begin.elapsed().as_secs() > 120 {
                break;
            }
            for (k, (scene, _)) in trains.iter_mut().enumerate() {
                let plan = TimePlan::new(end, resolution);
                let mut by = method(by);
                // The system counts time at work in ticks of some milliseconds.
                let (_, done, wall) = run(scene, by.as_mut(), &plan, &mut NullSink);
                let runs = (0.1 / wall).ceil().max(1.0);
                work[k] = done;
                let all = busy_seconds(|| {
                    for _ in 0..runs as usize {
                        run(scene, by.as_mut(), &plan, &mut NullSink);
                    }
                });
                let time = all / runs;
                least[k] = least[k].min(time / end);
            }
        }
        let points: Vec<_> = (MESHES.iter().zip(least))
            .map(|(n, t)| ((*n as f64).ln(), t.ln()))
            .collect();
        for (k, (scene, setup)) in trains.iter().enumerate() {
            println!(
                "  {:>3} meshes {:>6} coordinates: {:10.2} s per simulated second, {:8.2} us a step and mesh; {} steps, {} events, {} force evaluations; set up in {setup:.2} s",
                MESHES[k],
                scene.layout().n,
                least[k],
                1e6 * least[k] * end / (work[k].steps as f64 * MESHES[k] as f64),
                work[k].steps,
                work[k].events,
                work[k].force_evaluations,
            );
        }
        println!(
            "  exponent {:.2}, of the last doubling {:.2} (bar {BAR}); memory at most {:.0} MB so far",
            slope(&points),
            slope(&points[points.len() - 2..]),
            memory().unwrap_or(f64::NAN),
        );
    }
}
