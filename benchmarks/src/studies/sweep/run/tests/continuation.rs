//! Loaded gears with backlash on both branches of their resonance, against a continuation of their own: one degree of
//! freedom, the reduced mass on the teeth that touch over the path of contact, written anew from the geometry of involutes
//! and of tip edges, integrated by RK4 at fixed small steps, speeds upwards and downwards from state to state.
#![allow(clippy::print_stdout, reason = "observed figures")]

use super::*;
use crate::context::Context;
use gearbench_models::spec::Body;
use std::f64::consts::TAU;

/// The gears of the FZG test rig, type C, rigid on teeth of constant stiffness.
const SCENE: &str = r#"
schema = 1
name = "backlash"
duration_s = 1e-3
[gears.pinion]
teeth = 16
module_m = 0.0045
face_width_m = 0.014
profile_shift = 0.1817
thinning_m = 5e-5
bore_radius_m = 0.015
loads = [{ torque_nm = 94.1 }]
[gears.wheel]
teeth = 24
module_m = 0.0045
face_width_m = 0.014
profile_shift = 0.1715
thinning_m = 5e-5
bore_radius_m = 0.015
loads = [{ torque_nm = 141.15 }]
[[meshes]]
gears = ["pinion", "wheel"]
centre_distance_m = 0.0915
start = { flank = "left", gap_m = 0.0 }
[[models]]
model = "rigid"
contact = { stiffness = { kind = "constant", stiffness_n_per_m2 = 1.4e10 }, damping = { law = "kelvin-voigt-ratio", ratio = 0.05 } }
"#;
/// Steps of a mesh cycle.
const STEPS: usize = 3000;

/// Two gears with one degree of freedom, the approach `x` of their flanks along the line of action, at constant common
/// rotation.
struct IndependentPair {
    /// Base radii, tip radii [m].
    rb: [f64; 2],
    ra: [f64; 2],
    centre_distance: f64,
    /// Working pressure angle [rad], distance of the tangent points, base pitch [m].
    alpha: f64,
    length: f64,
    pitch: f64,
    backlash: f64,
    /// Sum of the path coordinates of both flanks of a tooth of the first gear, each on its own line of action [m].
    both_flanks: f64,
    /// Shares of the approach that either gear moves by.
    share: [f64; 2],
    mass: f64,
    force: f64,
    /// Stiffness of a tooth pair [N/m].
    stiffness: f64,
    damping: f64,
    /// Path coordinate of a pair, its rate, approach and its rate.
    s: f64,
    speed: f64,
    x: [f64; 2],
}

fn involute(ratio: f64) -> f64 {
    ratio - ratio.atan()
}

impl IndependentPair {
    fn new(scene: &SceneFile) -> Self {
        let spec = &scene.spec;
        let models = crate::models::models();
        let built = Scene::build(spec, &scene.models[0].modelling, models).unwrap();
        let gears = [0, 1].map(|i| match &spec.gears[i].body {
            Body::Gear(g) => g,
            Body::Rack(_) => unreachable!(),
        });
        let rb = gears.map(|g| g.r_base());
        let inertia = [0, 1].map(|i| built.gears()[i].model.hub().hub.inertia);
        let masses = [0, 1].map(|i| inertia[i] / (rb[i] * rb[i]));
        let mass = 1.0 / (1.0 / masses[0] + 1.0 / masses[1]);
        let stiffness = 1.4e10 * 0.014;
        let centre_distance: f64 = 0.0915;
        let alpha = ((rb[0] + rb[1]) / centre_distance).acos();
        let force = 94.1 / rb[0];
        // Half the angle of a tooth on the base circle, thinned on the reference circle.
        let alpha0 = 20.0_f64.to_radians();
        let thickness = 4.5e-3 * (0.25 * TAU + 2.0 * 0.1817 * alpha0.tan()) - 5e-5;
        let half = 0.5 * thickness / (8.0 * 4.5e-3) + involute(alpha0.tan());
        IndependentPair {
            rb,
            ra: gears.map(|g| g.r_tip()),
            centre_distance,
            alpha,
            length: (rb[0] + rb[1]) * alpha.tan(),
            pitch: TAU * rb[0] / 16.0,
            backlash: 2.0 * 5e-5 * alpha0.cos(),
            both_flanks: 2.0 * rb[0] * (alpha + half),
            share: masses.map(|m| mass / m),
            mass,
            force,
            stiffness,
            damping: 2.0 * 0.05 * (stiffness * mass).sqrt(),
            s: rb[0] * alpha.tan(),
            speed: 0.0,
            x: [force / stiffness, 0.0],
        }
    }

    /// Gap of the flanks of a pair whose flanks meet the line of action at lengths of roll `s` on both gears.
    fn gap(&self, s: [f64; 2]) -> f64 {
        // The edge of the tip of one gear on the involute of the other, both from the own centre, the line of centres
        // at angle 0: flanks begin on the base circle at `alpha - s / rb`.
        let edge = |k: usize| {
            let roll = (self.ra[k].powi(2) - self.rb[k].powi(2)).sqrt();
            let angle = self.alpha - s[k] / self.rb[k] + involute(roll / self.rb[k]);
            let (x, y) = (self.ra[k] * angle.cos(), self.ra[k] * angle.sin());
            let (x, y) = (self.centre_distance - x, -y);
            let other = self.rb[1 - k];
            let roll = (x * x + y * y - other * other).max(0.0).sqrt();
            let begin = y.atan2(x) - involute(roll / other);
            other * (self.alpha - begin) - s[1 - k]
        };
        let tip = |k: usize| (self.ra[k].powi(2) - self.rb[k].powi(2)).sqrt();
        if s[0] > tip(0) {
            edge(0)
        } else if s[1] > tip(1) {
            edge(1)
        } else {
            self.length - s[0] - s[1]
        }
    }

    fn rate(&self, s: f64, [x, v]: [f64; 2]) -> [f64; 2] {
        let mut sum = self.force;
        // The other flanks meet on the mirrored line, and the approach parts them.
        for (front, first) in [(true, s), (false, self.both_flanks - s)] {
            let (sign, play, way) = if front {
                (1.0, 0.0, self.speed)
            } else {
                (-1.0, self.backlash, -self.speed)
            };
            let at = |s: f64, x: f64| {
                let [a, b] = self.share.map(|share| share * sign * x);
                self.gap([s + a, self.length - play - s + b])
            };
            for pair in -4..=4 {
                let s = first + f64::from(pair) * self.pitch;
                // Beyond, neither tooth reaches.
                if s < 2e-3 || s > self.length - 2e-3 || at(s, x) >= 0.0 {
                    continue;
                }
                let h = 1e-8;
                let by_x = (at(s, x + h) - at(s, x - h)) / (2.0 * h);
                let by_s = (at(s + h, x) - at(s - h, x)) / (2.0 * h);
                let push = -self.stiffness * at(s, x) - self.damping * (by_x * v + by_s * way);
                sum += push.max(0.0) * by_x;
            }
        }
        [v, sum / self.mass]
    }

    fn step(&mut self, h: f64) {
        let add = |x: [f64; 2], k: [f64; 2], h: f64| [x[0] + h * k[0], x[1] + h * k[1]];
        let (s, x) = (self.s, self.x);
        let half = s + 0.5 * h * self.speed;
        let k1 = self.rate(s, x);
        let k2 = self.rate(half, add(x, k1, 0.5 * h));
        let k3 = self.rate(half, add(x, k2, 0.5 * h));
        let k4 = self.rate(s + h * self.speed, add(x, k3, h));
        self.x = [0, 1].map(|i| x[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
        self.s = s + h * self.speed;
        if self.s > 0.5 * (self.length + self.pitch) {
            self.s -= self.pitch;
        }
    }

    /// Integrates on at a mesh frequency; returns the root mean square of the last cycle, and the least approach.
    fn at(&mut self, frequency: f64, cycles: usize) -> [f64; 2] {
        self.speed = frequency * self.pitch;
        let h = 1.0 / (frequency * STEPS as f64);
        for _ in 0..(cycles - 1) * STEPS {
            self.step(h);
        }
        let x: Vec<f64> = (0..STEPS)
            .map(|_| {
                self.step(h);
                self.x[0]
            })
            .collect();
        let mean = x.iter().sum::<f64>() / STEPS as f64;
        let square = x.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / STEPS as f64;
        [
            square.sqrt(),
            x.iter().copied().fold(f64::INFINITY, f64::min),
        ]
    }
}

#[test]
fn loaded_gears_follow_both_branches_of_the_backlash_resonance() {
    let scene = SceneFile::parse(
        &Context::default(),
        "backlash.toml",
        SCENE,
        Origin::Shipped,
        false,
    )
    .unwrap();
    // At 3.35 kHz the way down all but touches the other flanks, and may begin to hammer on both or not.
    let mut frequencies = vec![3100.0, 3200.0, 3250.0, 3400.0];
    frequencies.extend((0..=10).map(|i| 3500.0 + 150.0 * f64::from(i)));
    let plan = Plan {
        branches: vec![Branch::Up, Branch::Down],
        ..super::plan(&scene, frequencies.clone(), 8, 0.02)
    };
    let runs = sweep(&plan, &Runner::default()).unwrap().runs;
    let mut own = IndependentPair::new(&scene);
    let down = frequencies.iter().rev();
    let (mut apart, mut behind) = (0, 0);
    for (run, f) in runs.iter().zip(frequencies.iter().chain(down)) {
        let s = run.steady.as_ref().unwrap();
        assert!(!run.status.is_failure(), "{f} Hz: {:?}", run.message);
        assert!((s.mesh_frequency_hz / f - 1.0).abs() < 1e-3);
        let [rms, least] = own.at(*f, 100);
        let off = s.error_rms_m / rms - 1.0;
        println!(
            "backlash resonance, {} {f} Hz: root mean square off by {off:.2e}",
            s.branch
        );
        assert!(off.abs() < 2e-3, "{} {f} Hz: {off:.2e}", s.branch);
        apart += usize::from(s.separated > 0.5);
        behind += usize::from(least < -own.backlash);
    }
    // The way up jumps to where teeth hammer, the way down stays there, in the end to and fro between both flanks.
    assert!(apart > 10 && behind > 0, "{apart} {behind}");
}

/// The teeth store half as much energy as free gears that turn this slowly, so that the instantaneous rotation is no
/// measure of their speed.
#[test]
fn free_gears_that_turn_slowly_keep_their_speed() {
    let scene = SceneFile::parse(
        &Context::default(),
        "backlash.toml",
        SCENE,
        Origin::Shipped,
        false,
    )
    .unwrap();
    let plan = Plan {
        branches: vec![Branch::Up],
        ..super::plan(&scene, vec![25.0], 1, 0.0)
    };
    let runs = sweep(&plan, &Runner::default()).unwrap().runs;
    let found = runs[0].steady.as_ref().unwrap().mesh_frequency_hz;
    assert!((found / 25.0 - 1.0).abs() < 0.03, "{found}");
}
