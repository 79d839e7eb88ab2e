//! Co-simulation of a driveline with a pair of gears, against the same driveline as one system.
//!
//! The host contains a motor, a shaft and the hub of the pinion; the FMU contains the teeth and the wheel. The host
//! steps first, with the torque of the teeth extrapolated from its value and derivatives; the FMU follows, with the
//! motion of the hub interpolated between both ends of the step. Extrapolation with `p` terms has an error of `H^p`
//! over the run; linear interpolation of the motion has an error of `H^2` on springs, cubic interpolation less than the
//! extrapolation. (With linear interpolation a damper has the mean speed at the end of the step, an error of first
//! order: motions on dampers have to be cubic.)
//!
//! The whole is integrated through model exchange, the motion of the hub an input at each stage.

use crate::host::Fmu;
use crate::{packed, scene};
use gearbench::fmu::package::Package;

const SCENE: &str = r#"
schema = 1
name = "own"
duration_s = 1e-3

[gears.pinion]
teeth = 20
module_m = 0.004
face_width_m = 0.01

[gears.wheel]
teeth = 30
module_m = 0.004
face_width_m = 0.01
loads = [{ torque_nm = 30.0 }]

[[meshes]]
gears = ["pinion", "wheel"]
centre_distance_m = 0.1001
start = { flank = "left", gap_m = 0.0 }

[[models]]
model = "rigid"
contact = { stiffness = { kind = "constant", stiffness_n_per_m2 = 1.4e10, of = "mesh" }, damping = { law = "kelvin-voigt", damping_ns_per_m = 200.0 } }
"#;

/// Inertias of motor and hub [kg m^2]; below, stiffness of the shaft [N m/rad] and torque of the motor [N m].
const INERTIA: [f64; 2] = [2e-3, 1e-3];
const SHAFT: f64 = 2000.0;
const MOTOR: f64 = 20.0;
const END: f64 = 4e-4;

/// Angle of the hub at the start [rad]: the teeth carry a little less than the torque of the motor.
const PRESSED: f64 = 8e-5;

/// Angles of motor and hub, then speeds. The shaft balances the teeth at the start, so that the acceleration of the hub
/// is zero, as the FMU assumes before the first step.
fn start(fmu: &Fmu) -> [f64; 4] {
    let teeth = fmu.get("pinion.contact_torque");
    [PRESSED - teeth / SHAFT, PRESSED, 0.0, 0.0]
}

/// Time derivative of the driveline in the host, under a torque of the mesh [N m].
fn driveline([motor, hub, v, w]: [f64; 4], teeth: f64) -> [f64; 4] {
    let shaft = SHAFT * (motor - hub);
    [
        v,
        w,
        (MOTOR - shaft) / INERTIA[0],
        (shaft + teeth) / INERTIA[1],
    ]
}

/// A classical Runge-Kutta step.
fn runge_kutta<const N: usize>(
    x: [f64; N],
    h: f64,
    mut rate: impl FnMut(f64, [f64; N]) -> [f64; N],
) -> [f64; N] {
    let plus = |x: [f64; N], h: f64, dx: [f64; N]| std::array::from_fn(|i| x[i] + h * dx[i]);
    let a = rate(0.0, x);
    let b = rate(0.5, plus(x, 0.5 * h, a));
    let c = rate(0.5, plus(x, 0.5 * h, b));
    let d = rate(1.0, plus(x, h, c));
    std::array::from_fn(|i| x[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]))
}

/// Number of times at which both solutions are compared.
const LOOKS: u32 = 20;

/// Speeds of the hub at these times, from the driveline as one system.
fn whole(package: &Package) -> Vec<f64> {
    let fmu = Fmu::exchanging(package);
    fmu.set("pinion.angle", PRESSED);
    fmu.initialise(0.0);
    fmu.event();
    let steps = 1600;
    let h = END / f64::from(steps);
    let [motor, hub, v, w] = start(&fmu);
    let mut x = [motor, hub, v, w, 0.0, 0.0];
    let mut seen = Vec::new();
    for i in 0..steps {
        let t = f64::from(i) * h;
        x = runge_kutta(x, h, |c, x| {
            fmu.move_to(t + c * h, &x[4..]);
            fmu.set("pinion.angle", x[1]);
            fmu.set("pinion.speed", x[3]);
            let teeth = fmu.get("pinion.contact_torque");
            let host = driveline([x[0], x[1], x[2], x[3]], teeth);
            let wheel = fmu.rates();
            [host[0], host[1], host[2], host[3], wheel[0], wheel[1]]
        });
        assert!(!fmu.completed());
        if (i + 1) % (steps / LOOKS) == 0 {
            seen.push(x[3]);
        }
    }
    seen
}

/// Speeds of the hub from co-simulation of both parts, with `terms` of extrapolation and a number of steps.
fn in_parts(package: &Package, terms: usize, linear: bool, steps: u32) -> Vec<f64> {
    let fmu = Fmu::stepping(package);
    fmu.interpolate();
    fmu.set("pinion.angle", PRESSED);
    fmu.initialise(0.0);
    let h = END / f64::from(steps);
    let mut x = start(&fmu);
    let mut seen = Vec::new();
    for i in 0..steps {
        let mut course = [fmu.get("pinion.contact_torque"), 0.0, 0.0];
        for order in 1..terms {
            course[order] = fmu.slope("pinion.contact_torque", order as i32);
        }
        let (before, parts) = (x, 16);
        let small = h / f64::from(parts);
        for k in 0..parts {
            x = runge_kutta(x, small, |c, x| {
                let s = (f64::from(k) + c) * small;
                driveline(x, course[0] + s * (course[1] + 0.5 * s * course[2]))
            });
        }
        let slope = (x[1] - before[1]) / h;
        let speeds = if linear {
            [slope; 2]
        } else {
            [before[3], x[3]]
        };
        fmu.set("pinion.angle", before[1]);
        fmu.set("pinion.angle_end", x[1]);
        fmu.set("pinion.speed", speeds[0]);
        fmu.set("pinion.speed_end", speeds[1]);
        fmu.step(f64::from(i) * h, h);
        if (i + 1) % (steps / LOOKS) == 0 {
            seen.push(x[3]);
        }
    }
    seen
}

#[test]
fn co_simulation_converges_with_the_order_of_extrapolation_and_interpolation() {
    let damper = ", damping = { law = \"kelvin-voigt\", damping_ns_per_m = 200.0 }";
    let elastic = SCENE.replace(damper, "");
    assert_ne!(elastic, SCENE);
    let [damped, elastic] = [SCENE, &elastic].map(|text| {
        let package = packed(&scene(text), "rigid", "rk4@250ns", &["pinion"]);
        let exact = whole(&package);
        (package, exact)
    });
    let norm = |x: &mut dyn Iterator<Item = f64>| x.map(|x| x * x).sum::<f64>().sqrt();
    let mut before = f64::INFINITY;
    for (terms, linear, order) in [
        (1, false, 1.0),
        (2, false, 2.0),
        (3, false, 3.0),
        (3, true, 2.0),
    ] {
        let (package, exact) = if linear { &elastic } else { &damped };
        let size = norm(&mut exact.iter().copied());
        let error = |seen: Vec<f64>| norm(&mut seen.iter().zip(exact).map(|(a, b)| a - b)) / size;
        let errors = [40, 80, 160, 320].map(|n| error(in_parts(package, terms, linear, n)));
        let orders: Vec<f64> = errors.windows(2).map(|e| (e[0] / e[1]).log2()).collect();
        let shown = errors.map(|e| format!("{e:.1e}")).join(", ");
        println!("{terms} terms, linear motion {linear}: {shown}; orders {orders:.2?}");
        let last = orders[2];
        assert!(
            (last - order).abs() < 0.2,
            "{terms} terms, {linear}: {orders:?}"
        );
        // More terms help.
        assert!(linear || errors[3] < 0.1 * before);
        before = errors[3];
    }
}

#[test]
fn co_simulation_with_elastic_gears_converges() {
    // Modes of a held hub swing in its frame, shaken by its acceleration, which a cubic motion has. The force of the teeth is
    // smooth once they are pressed; the finest run stands for the whole.
    let text = SCENE.find("[[models]]").map(|at| &SCENE[..at]).unwrap();
    let elastic = format!(
        "{text}[[models]]\nmodel = \"elastic\"\nparameters = {{ mesh = \"generated\", flank_elements = 4, fillet_elements = 2, \
         across_elements = 6, rim_elements = 2, width_elements = 1, modes = 10 }}\ncontact = {{ penalty_pa_per_m = 1e15 }}\n"
    );
    let package = packed(&scene(&elastic), "elastic", "rk4@250ns", &["pinion"]);
    let norm = |x: &mut dyn Iterator<Item = f64>| x.map(|x| x * x).sum::<f64>().sqrt();
    let exact = in_parts(&package, 3, false, 640);
    let size = norm(&mut exact.iter().copied());
    let error = |seen: Vec<f64>| norm(&mut seen.iter().zip(&exact).map(|(a, b)| a - b)) / size;
    for (terms, linear, order) in [
        (1, false, 1.0),
        (2, false, 2.0),
        (3, false, 3.0),
        (3, true, 2.0),
    ] {
        let errors = [20, 40, 80].map(|n| error(in_parts(&package, terms, linear, n)));
        let orders: Vec<f64> = errors.windows(2).map(|e| (e[0] / e[1]).log2()).collect();
        let shown = errors.map(|e| format!("{e:.1e}")).join(", ");
        println!("elastic, {terms} terms, linear motion {linear}: {shown}; orders {orders:.2?}");
        assert!(
            orders[1] > order - 0.3,
            "{terms} terms, {linear}: {orders:?}"
        );
    }
}

#[test]
fn derivatives_of_outputs_are_those_of_their_course() {
    let package = packed(&scene(SCENE), "rigid", "rk4@250ns", &[]);
    let fmu = Fmu::stepping(&package);
    fmu.set("pinion.torque", MOTOR);
    fmu.initialise(0.0);
    let (h, n) = (1e-6, 40);
    let mut seen = Vec::new();
    let name = "pinion.contact_torque";
    for i in 0..n {
        seen.push([fmu.get(name), fmu.slope(name, 1), fmu.slope(name, 2)]);
        fmu.step(f64::from(i) * h, h);
    }
    let largest = |k: usize| seen.iter().map(|x| x[k].abs()).fold(0.0, f64::max);
    for i in 20..30 {
        // Differences of fourth order along the run.
        let d = |k: usize| {
            let at = |j: usize| seen[j][k];
            (8.0 * (at(i + 1) - at(i - 1)) - (at(i + 2) - at(i - 2))) / (12.0 * h)
        };
        assert!((seen[i][1] - d(0)).abs() < 1e-4 * largest(1));
        assert!((seen[i][2] - d(1)).abs() < 1e-4 * largest(2));
    }
}

#[test]
fn a_hub_that_its_host_makes_jump_touches_anew() {
    // Held values in place of a course: the hub is somewhere else at each step.
    let package = packed(&scene(SCENE), "rigid", "rk4@250ns", &["pinion"]);
    let fmu = Fmu::stepping(&package);
    fmu.initialise(0.0);
    let forces = [1e-4, -1e-3, 1e-4].map(|angle| {
        fmu.set("pinion.angle", angle);
        fmu.get("pinion_wheel.force")
    });
    assert!(forces[0] > 100.0 && forces[1] == 0.0);
    assert_eq!(forces[0], forces[2]);
    fmu.step(0.0, 1e-6);
    assert!(fmu.get("pinion_wheel.force") > 100.0);
}
