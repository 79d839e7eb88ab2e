//! Restitution laws where a contact closes without speed: its impact speed is zero for as long as it stays closed, and
//! small vibrations about the load have the damping ratio `-ln(e)/pi` of the documentation, whatever the law.

use gearbench_integrators::{Resolution, State, TimePlan};
use gearbench_models::geometry::{GearParams, Side};
use gearbench_models::law::Damping;
use gearbench_models::spec::{ContactSpec, Load, Mount, Profile, SceneSpec, effective_radius};
use gearbench_tests::*;
use std::f64::consts::PI;

/// Torque on the pinion [N m], and its inertia [kg m^2].
const TORQUE: f64 = 40.0;
const INERTIA: f64 = 3.102e-4;
/// Stiffness of a tooth pair per width [N/m^2].
const PER_WIDTH: f64 = 1.4e10;

/// Returns gears of module 4 mm times a size, with a torque on the pinion and the wheel fixed, in contact at rest; the
/// wheel may be the first gear. Lengths are proportional to the size, masses and forces as at equal density and
/// stress.
fn touching(teeth: [u32; 2], size: f64, exchanged: bool) -> SceneSpec {
    let distance = 2e-3 * f64::from(teeth[0] + teeth[1]) + 1e-4;
    let of = |i: usize| {
        let params = spur(teeth[i]);
        let scaled = GearParams {
            module: size * params.module,
            face_width: size * params.face_width,
            bore_radius: size * params.bore_radius,
            ..params
        };
        gear(
            ["pinion", "wheel"][i],
            scaled,
            [0.0, size * distance][i],
            0.0,
        )
    };
    let (mut pinion, mut wheel) = (of(0), of(1));
    pinion.inertia = Some(INERTIA * size.powi(5));
    pinion.loads = vec![Load::Applied(Profile::Constant(TORQUE * size.powi(3)))];
    wheel.mount = Mount::Fixed;
    let start = start(Side::Left, 0.0);
    if exchanged {
        pair_of(wheel, pinion, start)
    } else {
        pair_of(pinion, wheel, start)
    }
}

fn law(damping: Damping, exponent: f64) -> ContactSpec {
    ContactSpec {
        damping,
        exponent,
        ..contact(PER_WIDTH)
    }
}

/// Returns `chi` and the restitution of a law, from the published table.
fn factor(damping: Damping) -> [f64; 2] {
    match damping {
        Damping::HuntCrossley { e } => [1.5 * (1.0 - e), e],
        Damping::LankaraniNikravesh { e } => [0.75 * (1.0 - e * e), e],
        Damping::Flores { e } => [1.6 * (1.0 - e) / e, e],
        Damping::Gonthier { e } => [(1.0 - e * e) / e, e],
        other => panic!("{other:?} has no restitution"),
    }
}

/// Computes the documented motion from contact at rest, `m x'' = F - k x^n (1 + chi x' / max(v_L, |x'|))`, to a time:
/// the approach and its speed, and the extremes of the approach.
fn documented(
    spec: &SceneSpec,
    damping: Damping,
    exponent: f64,
    t_end: f64,
) -> ([f64; 2], Vec<f64>) {
    let radius = effective_radius(&spec.gears[0].body);
    let mass = spec.gears[0].inertia.unwrap() / radius.powi(2);
    let (k, load) = (PER_WIDTH * 0.01, TORQUE / radius);
    let [chi, e] = factor(damping);
    let deflection = (load / k).powf(1.0 / exponent);
    let tangent = exponent * load / deflection;
    let load_speed = chi * load / (2.0 * (-e.ln() / PI) * (tangent * mass).sqrt());
    let acceleration = |x: f64, v: f64| {
        let elastic = k * x * x.abs().powf(exponent - 1.0);
        (load - elastic * (1.0 + chi * v / load_speed.max(v.abs()))) / mass
    };
    let steps = 40_000;
    let h = t_end / f64::from(steps);
    let [mut x, mut v] = [0.0, 0.0];
    let mut extremes = vec![0.0];
    for _ in 0..steps {
        let a = [x, v, acceleration(x, v)];
        let b = [
            v + 0.5 * h * a[2],
            acceleration(x + 0.5 * h * v, v + 0.5 * h * a[2]),
        ];
        let c = [
            v + 0.5 * h * b[1],
            acceleration(x + 0.5 * h * b[0], v + 0.5 * h * b[1]),
        ];
        let d = [v + h * c[1], acceleration(x + h * c[0], v + h * c[1])];
        let next = v + h / 6.0 * (a[2] + 2.0 * b[1] + 2.0 * c[1] + d[1]);
        if v * next < 0.0 {
            let s = h * v / (v - next);
            extremes.push(x + v * s + 0.5 * a[2] * s * s);
        }
        x += h / 6.0 * (v + 2.0 * b[0] + 2.0 * c[0] + d[0]);
        v = next;
    }
    ([x, v.abs()], extremes)
}

/// Returns the mean decay of the oscillation per half cycle, over pi.
fn decay(extremes: &[f64]) -> f64 {
    let swing = |i: usize| (extremes[i + 1] - extremes[i]).abs();
    let n = extremes.len() - 2;
    (swing(0) / swing(n)).ln() / (n as f64 * PI)
}

/// Returns the approach and its speed at the end of a scene.
fn end(
    spec: &SceneSpec,
    contact: &ContactSpec,
    id: &str,
    resolution: Resolution,
    t_end: f64,
) -> [f64; 2] {
    let mut scene = build(spec, &[rigid(), rigid()], contact);
    let start = scene.initial();
    let plan = TimePlan::new(t_end, resolution);
    let o = run_from(&mut scene, start, id, &plan).unwrap(id);
    // The wheel has no coordinates.
    let pinion = spec
        .gears
        .iter()
        .find(|g| g.mount == Mount::Revolute)
        .unwrap();
    let radius = effective_radius(&pinion.body);
    let State { q, v, .. } = o.state;
    [radius * q[0], radius * v[0]].map(f64::abs)
}

/// Four laws, linear and with an exponent of 10/9, under methods that locate events by tolerances from 1e-5 to 1e-10, and
/// by fixed steps, against the documented motion. With the speed of the moment in the place of the touch speed the decay
/// of Hunt and Crossley's law was 9 % short (0.99: 13 %), and with the exponent rounding at the first event decided.
#[test]
fn contacts_that_close_at_rest_have_the_documented_damping() {
    let t_end = 1.2e-3;
    let damping = [
        Damping::HuntCrossley { e: 0.9 },
        Damping::Gonthier { e: 0.9 },
        Damping::HuntCrossley { e: 0.99 },
        Damping::Flores { e: 0.7 },
        Damping::LankaraniNikravesh { e: 0.8 },
    ];
    for (teeth, exponent) in [([20, 30], 1.0), ([19, 50], 10.0 / 9.0)] {
        let spec = touching(teeth, 1.0, false);
        for damping in damping {
            let (own, extremes) = documented(&spec, damping, exponent, t_end);
            let contact = law(damping, exponent);
            let tolerances =
                [1e-5, 1e-7, 1e-8, 1e-9, 1e-10].map(|rtol| ("dopri5", Resolution::Tolerance(rtol)));
            let steps = ["rk4", "velocity-verlet"].map(|id| (id, Resolution::Step(2e-7)));
            let mut worst = 0.0_f64;
            for (id, resolution) in tolerances.into_iter().chain(steps) {
                let found = end(&spec, &contact, id, resolution, t_end);
                let swing = extremes[1];
                let speed = swing * (PER_WIDTH * 0.01 / 0.22).sqrt();
                let error = ((found[0] - own[0]) / swing).hypot((found[1] - own[1]) / speed);
                let bound = match resolution {
                    Resolution::Tolerance(rtol) => (300.0 * rtol).max(1e-6),
                    Resolution::Step(_) => 1e-4,
                };
                assert!(
                    error < bound,
                    "{teeth:?} {damping:?} {id} {resolution:?}: {error:e}"
                );
                worst = worst.max(error);
            }
            println!(
                "{teeth:?} {damping:?}: decay {:.5}, at the end within {worst:.1e}",
                decay(&extremes)
            );
        }
    }
}

/// Results depend neither on the order of the two gears nor on their size: rounding has no effect at first contact.
#[test]
fn contacts_that_close_at_rest_keep_exchange_and_size() {
    for damping in [Damping::HuntCrossley { e: 0.9 }, Damping::Flores { e: 0.7 }] {
        let ended = |size: f64, exchanged: bool| {
            let spec = touching([19, 50], size, exchanged);
            let rtol = Resolution::Tolerance(1e-9);
            let [x, v] = end(&spec, &law(damping, 1.0), "dopri5", rtol, 1.2e-3 * size);
            [x / size, v]
        };
        let as_it_is = ended(1.0, false);
        for (size, exchanged) in [(1.0, true), (2.0, false), (0.5, true)] {
            let other = ended(size, exchanged);
            for (a, b) in as_it_is.iter().zip(other) {
                assert!(
                    (a / b - 1.0).abs() < 1e-5,
                    "{damping:?} {size} {exchanged}: {as_it_is:?} {other:?}"
                );
            }
        }
    }
}
