//! Two laws of damping in a backlash, those of the Modelica Standard Library's example `Rotational.Examples.Backlash`: an
//! inertia J on a spring c with a damper d behind a backlash of b in all, let go at an angle, with the damper's torque bounded
//! by that of the spring (`ElastoBacklash`, here `kelvin-voigt-bounded`), and with the sum bounded by zero
//! (`ElastoBacklash2`, `kelvin-voigt`).
//!
//! As gears: a wheel of the inertia J against a fixed pinion, on one constant spring k = c/r_b^2 and damper d/r_b^2 along the line
//! of action. The backlash of 45 degrees is none of teeth; but both laws, and the motion with them, are homogeneous of degree
//! one in angle and speed, so that all angles are taken [`epsilon`](Gears::epsilon) times as large.
//!
//! Each law is linear branch by branch: the solution is put together from closed forms here, with the times of the switches
//! by bisection, and agrees with figures that were computed apart (Runge and Kutta's method to 1e-12).

use gearbench::context::Context;
use gearbench::scene_file::{Origin, SceneFile};
use gearbench_integrators::observers::ledger::Ledger;
use gearbench_integrators::{Resolution, TimePlan};
use gearbench_models::scene::Scene;
use gearbench_models::spec::effective_radius;
use gearbench_models::spec::mesh_layout;
use gearbench_tests::*;

const J: f64 = 5.0;
const C: f64 = 20e3;
const D: f64 = 50.0;
const B: f64 = std::f64::consts::FRAC_PI_4;
const PHI0: f64 = std::f64::consts::FRAC_PI_2;
const TIMES: [f64; 4] = [0.1, 0.2, 0.5, 1.0];

/// Angle and speed at [`TIMES`], bounded damper and bounded sum.
const PRINTED: [[[f64; 2]; 4]; 2] = [
    [
        [0.249835855, 52.893718606],
        [-0.961836073, 12.002529657],
        [-0.309958035, -17.228425706],
        [-0.155581414, -7.022937279],
    ],
    [
        [0.242540389, 52.249860201],
        [-0.948009344, 10.281726511],
        [-0.176686493, -16.007805118],
        [0.10347504, -6.213397138],
    ],
];

/// Branch of the damping law for a distance `x` beyond the edge of the backlash.
#[derive(Clone, Copy, PartialEq, Debug)]
enum Branch {
    Flight,
    /// The damper force has reached that of the spring.
    Saturated,
    Closed,
    /// The damper would pull more than the spring pushes.
    Released,
}

impl Branch {
    /// Returns stiffness and damping of the branch.
    fn constants(self) -> [f64; 2] {
        match self {
            Branch::Flight | Branch::Released => [0.0, 0.0],
            Branch::Saturated => [2.0 * C, 0.0],
            Branch::Closed => [C, D],
        }
    }

    /// Returns `x` and its rate after a time.
    fn after(self, [x, v]: [f64; 2], t: f64) -> [f64; 2] {
        let [k, c] = self.constants();
        if k == 0.0 {
            return [x + v * t, v];
        }
        let (decay, square) = (0.5 * c / J, k / J);
        let w = (square - decay * decay).sqrt();
        let (sin, cos) = (w * t).sin_cos();
        let e = (-decay * t).exp();
        [
            e * (x * cos + (v + decay * x) / w * sin),
            e * (v * cos - (decay * v + square * x) / w * sin),
        ]
    }

    /// Returns a function that is positive while the branch is valid.
    fn holds(self, bounded: bool, [x, v]: [f64; 2]) -> f64 {
        match self {
            // To the edge on the other side.
            Branch::Flight => x + B,
            Branch::Saturated => D * v - C * x,
            Branch::Closed if bounded => C * x - (D * v).abs(),
            Branch::Closed => C * x + D * v,
            Branch::Released => x,
        }
    }
}

/// Returns angle and speed at a time.
fn exact(bounded: bool, until: f64) -> [f64; 2] {
    let (mut t, mut side) = (0.0, 1.0);
    let (mut branch, mut state) = (Branch::Closed, [PHI0 - 0.5 * B, 0.0]);
    loop {
        // The first time at which the branch ends: looked for in steps, then by bisection.
        let ends = |h: f64| branch.holds(bounded, branch.after(state, h)) <= 0.0;
        let (mut lo, mut hi) = (0.0, 0.0);
        while t + hi < until && (hi == 0.0 || !ends(hi)) {
            lo = hi;
            hi += 1e-4;
        }
        if t + hi >= until && !ends(until - t) {
            let [x, v] = branch.after(state, until - t);
            return [side * (0.5 * B + x), side * v];
        }
        for _ in 0..80 {
            let mid = 0.5 * (lo + hi);
            if ends(mid) { hi = mid } else { lo = mid }
        }
        t += hi;
        state = branch.after(state, hi);
        branch = match branch {
            Branch::Flight => {
                side = -side;
                state = [0.0, -state[1]];
                if bounded {
                    Branch::Saturated
                } else {
                    Branch::Closed
                }
            }
            Branch::Saturated => Branch::Closed,
            Branch::Closed if bounded && state[1] > 0.0 => Branch::Saturated,
            Branch::Closed => Branch::Released,
            Branch::Released => Branch::Flight,
        };
    }
}

/// Gears of the example, with a damping law.
struct Gears {
    scene: Scene,
    /// Ratio of the angles of the wheel to those of the example.
    epsilon: f64,
}

fn text(gap: f64, stiffness: f64, law: &str, damper: f64) -> String {
    format!(
        r#"
schema = 1
name = "elasto_backlash"
duration_s = 1.0
[gears.pinion]
teeth = 20
module_m = 0.004
face_width_m = 0.01
mount = "fixed"
[gears.wheel]
teeth = 30
module_m = 0.004
face_width_m = 0.01
inertia_kgm2 = {J}
[[meshes]]
gears = ["pinion", "wheel"]
backlash_m = 40e-6
start = {{ flank = "left", gap_m = {gap:e} }}
[[models]]
model = "rigid"
[models.contact]
stiffness = {{ kind = "constant", stiffness_n_per_m2 = {stiffness:e}, of = "mesh" }}
damping = {{ law = "{law}", damping_ns_per_m = {damper:e} }}
"#
    )
}

fn read(text: &str) -> SceneFile {
    SceneFile::unbuilt(
        &Context::default(),
        "backlash.toml",
        text,
        Origin::Shipped,
        false,
    )
    .expect("the scene is sound")
}

impl Gears {
    fn new(bounded: bool) -> Self {
        let law = ["kelvin-voigt", "kelvin-voigt-bounded"][usize::from(bounded)];
        // The backlash along the line of action is that of the gears as they stand.
        let [pinion, wheel] = &read(&text(0.0, 1e9, law, 0.0)).spec.gears[..] else {
            panic!("two gears");
        };
        let backlash = mesh_layout(pinion, wheel).unwrap().backlash;
        let r = effective_radius(&wheel.body);
        let epsilon = backlash / (r * B);
        let overlap = epsilon * r * (PHI0 - 0.5 * B);
        let file = read(&text(-overlap, C / (r * r) / 0.01, law, D / (r * r)));
        let modelling = &file.models[0].modelling;
        let scene = Scene::build(&file.spec, modelling, gearbench::models::models()).unwrap();
        Gears { scene, epsilon }
    }

    /// Returns the largest error of angle and speed of a run, relative to the largest of both in the example, and the
    /// ledger of the last run.
    fn error(&mut self, bounded: bool, method: &str, resolution: Resolution) -> (f64, Ledger) {
        let (mut worst, mut ledger) = (0.0_f64, Ledger::default());
        for t in TIMES {
            let plan = TimePlan::new(t, resolution);
            let begin = self.scene.initial();
            ledger = Ledger::default();
            let (end, _) = watched(&mut self.scene, begin, method, &plan, &mut ledger);
            let [phi, w] = exact(bounded, t);
            // The left flank of the pinion pushes the wheel clockwise.
            let angle = PHI0 + end.q[0] / self.epsilon;
            let speed = end.v[0] / self.epsilon;
            worst = worst.max((angle - phi).abs()).max((speed - w).abs());
        }
        (worst, ledger)
    }
}

#[test]
fn the_closed_form_is_what_was_computed_apart() {
    for (printed, bounded) in PRINTED.iter().zip([true, false]) {
        for (t, [phi, w]) in TIMES.iter().zip(printed) {
            let [own_phi, own_w] = exact(bounded, *t);
            println!("bounded {bounded}, {t} s: {own_phi:.9} rad, {own_w:.9} rad/s");
            assert!((own_phi - phi).abs() < 2e-9 && (own_w - w).abs() < 1e-8);
        }
    }
}

/// Rigid gears satisfy both laws under methods that step through contact and, where the whole is linear, from event to
/// event.
#[test]
fn rigid_gears_have_both_laws_of_damping_in_their_backlash() {
    for bounded in [true, false] {
        let mut gears = Gears::new(bounded);
        for (method, resolution, most) in [
            ("dopri5", Resolution::Tolerance(1e-10), 1e-6),
            ("tsit45", Resolution::Tolerance(1e-10), 1e-6),
            ("rk4", Resolution::Step(2e-4), 1e-6),
            ("trigonometric", Resolution::Step(2e-5), 1e-4),
        ] {
            let (worst, ledger) = gears.error(bounded, method, resolution);
            println!(
                "bounded {bounded}, {method}: {worst:.1e} rad or rad/s, energy {:.1e}",
                ledger.residual()
            );
            assert!(worst < most, "bounded {bounded}, {method}: {worst:.2e}");
        }
    }
}

/// Each step has one smooth force: the order of a method is preserved through all switches of the bounded damper.
#[test]
fn the_order_of_a_method_holds_through_the_switches() {
    let mut gears = Gears::new(true);
    let [coarse, fine] = [1e-3, 2.5e-4].map(|h| gears.error(true, "rk4", Resolution::Step(h)).0);
    let order = (coarse / fine).log2() / 2.0;
    println!("rk4: {coarse:.1e} and {fine:.1e} at a quarter of the step, order {order:.2}");
    assert!(order > 3.5, "{order}");
}
