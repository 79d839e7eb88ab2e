//! Planetary sets: forces compared with the energy, conservation laws, the same set on fixed axes and rotated as a
//! whole.

mod frequencies;
mod sharing;

use crate::shafts::{body, shaft};
use gearbench_integrators::{Outputs, Report, Resolution, SecondOrderSystem, State, StateView};
use gearbench_models::geometry::Side;
use gearbench_models::scene::Scene;
use gearbench_models::spec::{
    Bearing, Freedom, ModelSpec, Modelling, Mount, OutOfPlaneSpec, SceneSpec, StationMember,
};
use gearbench_tests::*;
use std::f64::consts::TAU;

/// Indices of sun, three planets and carrier, in the order of their hub coordinates.
const SUN: usize = 0;
const PLANETS: [usize; 3] = [1, 2, 3];
const CARRIER: usize = 4;
/// Distance between the axes of sun and planets [m].
const DISTANCE: f64 = 0.0801;

/// Returns freedom across the axis, on a spring.
pub(super) fn across(stiffness: f64, damping: f64) -> Option<Box<OutOfPlaneSpec>> {
    let mut lateral = OutOfPlaneSpec {
        bearing: Bearing::default(),
        ..OutOfPlaneSpec::default()
    };
    for d in 0..2 {
        lateral.directions[d] = Freedom::Free;
        lateral.bearing.stiffness[d][d] = stiffness;
        lateral.bearing.damping[d][d] = damping;
    }
    Some(Box::new(lateral))
}

/// Returns a sun with three planets on a carrier, one of them with a gap, without a support on the ground.
pub fn set(gap: f64) -> SceneSpec {
    let sun = gear("sun", spur(21), 0.0, 30.0);
    let planet = |k: usize| {
        let angle = TAU * k as f64 / 3.0;
        let mut planet = gear(&format!("planet-{k}"), spur(18), 0.0, -4.0);
        planet.position = [DISTANCE * angle.cos(), DISTANCE * angle.sin(), 0.0];
        planet
    };
    let mut carrier = body(0.0, "carrier", 2e-3);
    if let StationMember::Body(body) = &mut carrier.carries {
        body.planets = PLANETS.to_vec();
        body.speed = 3.0;
    }
    SceneSpec {
        duration: f64::INFINITY,
        gears: std::iter::once(sun).chain((0..3).map(planet)).collect(),
        meshes: PLANETS
            .map(|p| mesh([SUN, p], start(Side::Left, gap)))
            .to_vec(),
        shafts: vec![shaft("carrier-shaft", vec![carrier], vec![])],
        stages: Vec::new(),
    }
}

/// Returns the same set with freedom of sun, planets and carrier across the axis.
fn loose(gap: f64, [of_sun, of_pins, of_carrier]: [f64; 3]) -> SceneSpec {
    let mut spec = set(gap);
    spec.gears[SUN].lateral = across(of_sun, 0.0);
    for p in PLANETS {
        spec.gears[p].lateral = across(of_pins, 0.0);
    }
    if let StationMember::Body(body) = &mut spec.shafts[0].stations[0].carries {
        body.lateral = across(of_carrier, 0.0);
        body.lateral.as_mut().unwrap().mass = Some(0.8);
    }
    spec
}

pub(super) fn carrier_of(spec: &mut SceneSpec) -> &mut gearbench_models::spec::BodySpec {
    match &mut spec.shafts[0].stations[0].carries {
        StationMember::Body(body) => body,
        StationMember::Gear(_) => unreachable!("a carrier stands there"),
    }
}

fn build_with(spec: &SceneSpec, model: &ModelSpec) -> Scene {
    let modelling = Modelling {
        gears: vec![model.clone(); spec.gears.len()],
        contacts: vec![contact(14e9); spec.meshes.len()],
    };
    Scene::build(spec, &modelling, gearbench::models::models()).unwrap()
}

fn models() -> Vec<(&'static str, ModelSpec)> {
    vec![
        ("rigid", rigid()),
        ("movable teeth", movable(7.8e8, 5e-3, 0.0)),
    ]
}

/// Returns the momentum along x and y, and the angular momentum about the origin.
fn momenta(scene: &mut Scene, s: &State) -> [f64; 3] {
    let mut p = vec![0.0; s.q.len()];
    scene.apply_mass(s.at(), &s.v, &mut p);
    let mut sum = [0.0; 3];
    for g in scene.gears() {
        let hub = g.model.hub();
        let own: Vec<usize> = hub.free_directions().collect();
        let at = |d: usize| {
            own.iter()
                .position(|o| *o == d)
                .map(|k| g.range().start + k)
        };
        // Hub and teeth turn.
        let lateral: Vec<usize> = (0..2).filter_map(at).collect();
        sum[2] += g
            .range()
            .filter(|i| !lateral.contains(i))
            .map(|i| p[i])
            .sum::<f64>();
        if let [x, y] = lateral[..] {
            sum[0] += p[x];
            sum[1] += p[y];
            let (px, py) = (hub.centre.x + s.q[x], hub.centre.y + s.q[y]);
            sum[2] += px * p[y] - py * p[x];
        }
    }
    sum
}

fn energy(scene: &mut Scene, at: StateView<'_>) -> [f64; 2] {
    let mut out = Outputs::default();
    scene.output(at, &mut out);
    [out.energy.kinetic, out.energy.strain + out.energy.contact]
}

/// Returns a state in which all three meshes are loaded and the carrier has rotated far and moved.
fn pressed(scene: &mut Scene, turn: f64) -> State {
    let mut s = scene.initial();
    let mut rng = Numbers::new(11);
    let gears: Vec<_> = scene
        .gears()
        .iter()
        .map(|g| (g.range(), g.model.hub().hub.clone()))
        .collect();
    let own = gears[CARRIER].0.start;
    let moved = [3e-6, -2e-6];
    for (k, (range, hub)) in gears.iter().enumerate() {
        let free: Vec<usize> = hub.free_directions().collect();
        let push = if k == SUN { 4e-4 } else { 0.0 };
        for i in range.clone() {
            let direction = free.get(i - range.start).copied().unwrap_or(5);
            if direction < 2 {
                let (sin, cos) = turn.sin_cos();
                let c = [hub.centre.x, hub.centre.y];
                let go = [
                    cos * c[0] - sin * c[1] - c[0],
                    sin * c[0] + cos * c[1] - c[1],
                ];
                s.q[i] = go[direction] + moved[direction] + 2e-6 * rng.draw();
                s.v[i] = 1e-2 * rng.draw();
            } else {
                s.q[i] = turn + push + 1e-6 * rng.draw();
                s.v[i] = 0.1 * rng.draw();
            }
        }
    }
    s.q[own] = turn;
    s
}

/// Returns `-dV/dq` by central differences.
fn slope(scene: &mut Scene, s: &State, i: usize, h: f64) -> f64 {
    let of = |scene: &mut Scene, h: f64| {
        let mut moved = s.clone();
        moved.q[i] += h;
        energy(scene, moved.at())[1]
    };
    -(of(scene, h) - of(scene, -h)) / (2.0 * h)
}

#[test]
fn forces_are_slopes_of_the_energy() {
    for (name, model) in models() {
        for (what, spec) in [
            ("rigid pins", set(0.0)),
            ("all loose", loose(0.0, [2e8, 1e8, 3e8])),
        ] {
            let mut scene = build_with(&spec, &model);
            for turn in [0.0, 2.4, -11.0] {
                let mut s = pressed(&mut scene, turn);
                s.v.fill(0.0);
                let mut f = vec![0.0; s.q.len()];
                scene.force(s.at(), &mut f);
                let largest = f.iter().fold(0.0_f64, |m, f| m.max(f.abs()));
                assert!(largest > 10.0, "{name}, {what}: nothing presses");
                let mut worst = 0.0_f64;
                for (i, f) in f.iter().enumerate() {
                    let by_energy = slope(&mut scene, &s, i, 1e-8);
                    worst = worst.max((f - by_energy).abs() / largest);
                    assert!(
                        (f - by_energy).abs() < 2e-6 * largest,
                        "{name}, {what}, turned by {turn}: coordinate {i}, {f} beside {by_energy}"
                    );
                }
                println!(
                    "{name}, {what}, turned by {turn} rad: forces off slopes of the energy by {worst:.1e} of the largest"
                );
            }
        }
    }
}

#[test]
fn contact_and_pins_add_no_momentum() {
    for (name, model) in models() {
        let mut scene = build_with(&loose(0.0, [0.0, 1e8, 0.0]), &model);
        let s = pressed(&mut scene, 0.7);
        let n = s.q.len();
        let mut f = vec![0.0; n];
        scene.force(s.at(), &mut f);
        let largest = f.iter().fold(0.0_f64, |m, f| m.max(f.abs()));
        scene.solve_mass(s.at(), &mut f);
        let acceleration = State { v: f, ..s };
        let rates = momenta(&mut scene, &acceleration);
        let worst = rates.iter().fold(0.0_f64, |m, r| m.max(r.abs())) / largest;
        println!("{name}: contact and pins add momentum of {worst:.1e} of the largest force");
        for rate in rates {
            assert!(
                rate.abs() < 1e-11 * largest,
                "{name}: {rates:?} of {largest}"
            );
        }
    }
}

#[test]
fn an_impact_of_a_floating_set_keeps_energy_and_momentum() {
    for (name, model) in models() {
        for (what, spec) in [
            ("rigid pins", set(1e-5)),
            ("all loose", loose(1e-5, [0.0, 1e8, 0.0])),
        ] {
            let mut scene = build_with(&spec, &model);
            let s = scene.initial();
            let before = (momenta(&mut scene, &s), energy(&mut scene, s.at()));
            for (method, resolution) in [
                ("dopri5", Resolution::Tolerance(1e-9)),
                ("velocity-verlet", Resolution::Step(1e-7)),
            ] {
                let end = run(&mut scene, method, resolution, 1.5e-3).unwrap(name);
                let after = momenta(&mut scene, &end.state);
                assert!(
                    end.peak > 100.0,
                    "{name}, {what}: no impact, {} N",
                    end.peak
                );
                let mut gained = 0.0_f64;
                for (a, b) in after.iter().zip(&before.0) {
                    let scale = before.0[2].abs();
                    gained = gained.max((a - b).abs() / scale);
                    assert!(
                        (a - b).abs() < 1e-11 * scale,
                        "{name}, {what}, {method}: {after:?} {:?}",
                        before.0
                    );
                }
                let now: f64 = energy(&mut scene, end.state.at()).iter().sum();
                let was: f64 = before.1.iter().sum();
                println!(
                    "{name}, {what}, {method}: impact of a floating set, momentum changes by {gained:.1e}, energy by {:.1e}",
                    (now / was - 1.0).abs()
                );
                assert!(
                    (now - was).abs() < 1e-5 * was,
                    "{name}, {what}, {method}: {was} J, {now} J"
                );
            }
        }
    }
}

#[test]
fn a_held_carrier_is_a_train_on_fixed_axes() {
    for (name, model) in models() {
        let mut spec = set(1e-5);
        carrier_of(&mut spec).speed = 0.0;
        let mut plain = build_with(
            &SceneSpec {
                shafts: vec![],
                ..spec.clone()
            },
            &model,
        );
        carrier_of(&mut spec).mount = Mount::Fixed;
        let mut held = build_with(&spec, &model);
        let tolerance = Resolution::Tolerance(1e-10);
        let ends =
            [&mut plain, &mut held].map(|s| run(s, "dopri5", tolerance, 1e-3).unwrap(name).state);
        let n = plain.initial().q.len();
        let fastest = ends[0].v.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        let mut worst = 0.0_f64;
        for i in 0..n {
            let (a, b) = (ends[0].v[i], ends[1].v[i]);
            worst = worst.max((a - b).abs() / fastest);
            assert!(
                (a - b).abs() < 1e-6 * 30.0,
                "{name}: speed {i}, {a} and {b}"
            );
        }
        println!(
            "{name}: a held carrier and fixed axes, speeds differ by {worst:.1e} of the fastest"
        );
        // Its link holds it with the torque that the planets exert on their pins.
        assert!(ends[1].q[n].abs() < 1e-15 && ends[1].v[n].abs() < 1e-15);
    }
}

#[test]
fn a_set_that_turns_as_a_whole_meshes_alike() {
    for (name, model) in models() {
        let mut spec = set(1e-5);
        let mut still = build_with(&spec, &model);
        for g in &mut spec.gears {
            g.speed += 50.0;
        }
        carrier_of(&mut spec).speed += 50.0;
        let mut turning = build_with(&spec, &model);
        let t = 1e-3;
        let tolerance = Resolution::Tolerance(1e-11);
        let [a, b] =
            [&mut still, &mut turning].map(|s| run(s, "dopri5", tolerance, t).unwrap(name));
        let differences = (a.state.v.iter().zip(&b.state.v)).map(|(a, b)| (b - a - 50.0).abs());
        println!(
            "{name}: a set that rotates as a whole, speeds differ by {:.1e} rad/s",
            differences.fold(0.0, f64::max)
        );
        for (i, (a, b)) in a.state.v.iter().zip(&b.state.v).enumerate() {
            assert!(
                (b - a - 50.0).abs() < 3e-6,
                "{name}: speed {i}, {a} and {b}"
            );
        }
        assert!(
            (a.peak / b.peak - 1.0).abs() < 1e-2,
            "{name}: {} {}",
            a.peak,
            b.peak
        );
    }
}

#[test]
fn pins_of_a_turning_carrier_give_way_to_the_centrifugal_force() {
    let (k, speed) = (1e7, 900.0);
    let mut spec = loose(1e-5, [1e8, k, 1e8]);
    for g in &mut spec.gears {
        g.speed = speed;
    }
    carrier_of(&mut spec).speed = speed;
    let mut scene = build_with(&spec, &rigid());
    let mut s = scene.initial();
    let gears: Vec<_> = PLANETS
        .map(|p| {
            (
                scene.gears()[p].range(),
                scene.gears()[p].model.hub().clone(),
            )
        })
        .into();
    for (range, hub) in &gears {
        let m = hub.masses[1];
        // (P + u) m w^2 = k u along the radius.
        let out = m * speed * speed / (k - m * speed * speed);
        let (x, y) = (range.start + 1, range.start + 2);
        (s.q[x], s.q[y]) = (out * hub.centre.x, out * hub.centre.y);
        let (px, py) = (hub.centre.x + s.q[x], hub.centre.y + s.q[y]);
        (s.v[x], s.v[y]) = (-speed * py, speed * px);
    }
    let mut a = vec![0.0; s.q.len()];
    scene.force(s.at(), &mut a);
    scene.solve_mass(s.at(), &mut a);
    for (range, hub) in &gears {
        let centripetal = speed * speed;
        for (d, c) in [(1, hub.centre.x), (2, hub.centre.y)] {
            let place = c + s.q[range.start + d];
            let wanted = -centripetal * place;
            assert!((a[range.start + d] - wanted).abs() < 1e-8 * centripetal * DISTANCE);
        }
    }
    assert!(a[SUN].abs() < 1e-6, "the sun does not feel it");
}

#[test]
fn corrections_solve_what_tangents_say() {
    use gearbench_integrators::Coeffs;
    for (name, model) in models() {
        let mut fixed = loose(0.0, [2e8, 1e8, 3e8]);
        fixed.gears[SUN].mount = Mount::Fixed;
        for (what, spec, held) in [
            ("rigid pins", set(0.0), (false, 1e-7)),
            ("all loose", loose(0.0, [2e8, 1e8, 3e8]), (false, 1e-5)),
            ("a held sun", fixed, (true, 1e-5)),
        ] {
            let mut scene = build_with(&spec, &model);
            // How forces turn with the carrier is not in the correction, and small.
            let mut s = pressed(&mut scene, 0.0);
            s.v.fill(0.0);
            let c = Coeffs {
                m: 1e12,
                d: 0.0,
                k: 1.0,
            };
            crate::shafts::corrects_within(&mut scene, &s, c, held, &format!("{name}, {what}"));
        }
    }
}
