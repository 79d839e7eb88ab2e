//! An external gear in an internal one: gaps compared with a direct search over both flanks, forces compared with
//! slopes of the energy through the whole mesh cycle, exchanged, rotated and mirrored gears, and the rim as a body.

use gearbench_integrators::{Events, Outputs, Report, SecondOrderSystem, State};
use gearbench_models::geometry::{Gear, GearParams, Internal, Modifications, Side, TipRelief};
use gearbench_models::law::Damping;
use gearbench_models::scene::Scene;
use gearbench_models::spec::{
    Body, ContactSpec, GearSpec, ModelSpec, SceneSpec, effective_radius, signed_effective_radius,
};
use gearbench_tests::*;

const DISTANCE: f64 = 0.078;

fn params(teeth: u32, profile_shift: f64) -> GearParams {
    GearParams {
        profile_shift,
        thinning: 4e-5,
        bore_radius: 0.0,
        ..spur(teeth)
    }
}

fn ring_params() -> GearParams {
    GearParams {
        addendum: 0.8,
        internal: Some(Internal {
            cutter_teeth: Some(23),
            ..Internal::default()
        }),
        ..params(61, -0.2)
    }
}

fn at(name: &str, params: GearParams, position: [f64; 3]) -> GearSpec {
    GearSpec {
        position,
        ..gear(name, params, 0.0, 0.0)
    }
}

/// Returns a pinion in a ring whose axis is offset from that of the pinion in a direction [rad].
fn pair(pinion: GearParams, ring: GearParams, direction: f64, side: Side) -> SceneSpec {
    let off = [DISTANCE * direction.cos(), DISTANCE * direction.sin(), 0.0];
    pair_of(
        at("pinion", pinion, [0.0; 3]),
        at("ring", ring, off),
        start(side, 0.0),
    )
}

fn plain(side: Side) -> SceneSpec {
    pair(params(22, 0.2), ring_params(), 0.0, side)
}

fn helical() -> SceneSpec {
    // Of one hand; the module is that of the transverse plane of the spur gears.
    let beta = 0.2_f64;
    let tilted = |p: GearParams| GearParams {
        helix_angle: beta,
        module: 4e-3 * beta.cos(),
        face_width: 0.03,
        ..p
    };
    pair(
        tilted(params(22, 0.2)),
        tilted(ring_params()),
        0.0,
        Side::Left,
    )
}

fn exchanged(mut spec: SceneSpec) -> SceneSpec {
    spec.gears.swap(0, 1);
    spec
}

fn toothing(g: &GearSpec) -> &Gear {
    match &g.body {
        Body::Gear(gear) => gear,
        Body::Rack(_) => panic!("a rack"),
    }
}

/// Returns the state after rolling by an angle of the pinion, with an overlap [m] on the flank of a side.
fn rolled(scene: &Scene, spec: &SceneSpec, roll: f64, (side, press): (Side, f64)) -> State {
    let mut s = scene.initial();
    let radii = [0, 1].map(|i| signed_effective_radius(&spec.gears[i].body));
    let pinion = usize::from(spec.gears[0].name != "pinion");
    for (i, g) in scene.gears().iter().enumerate() {
        // The path coordinates of both gears add up to the length of the line and the approach.
        let mut turn = match i == pinion {
            true => roll,
            false => -roll * radii[pinion] / radii[i],
        };
        turn += 0.5 * side.sign() * press / radii[i];
        s.q[g.range()].iter_mut().for_each(|q| *q += turn);
    }
    s
}

fn energy(scene: &mut Scene, s: &State) -> f64 {
    let mut out = Outputs::default();
    scene.output(s.at(), &mut out);
    out.energy.contact + out.energy.strain
}

fn varying(slices: usize) -> ContactSpec {
    ContactSpec {
        stiffness: weber_banaschek(),
        damping: Damping::None,
        slices: Some(slices),
        ..contact(1.4e10)
    }
}

/// Returns the gap of open flanks of two teeth from points of either flank: the rotation that brings the mate's
/// involute to each point.
fn direct(pinion: &Gear, ring: &Gear, [one, two]: [f64; 2]) -> f64 {
    let n = 40_000;
    let mut least = f64::INFINITY;
    // (own gear, mate, angle of its tooth, of the mate's, where its axis lies as seen from the mate's)
    for own_is_pinion in [true, false] {
        let (own, mate, turned, of_mate, off) = match own_is_pinion {
            true => (pinion, ring, one, two, DISTANCE),
            false => (ring, pinion, two, one, -DISTANCE),
        };
        let (low, high) = (own.roll_length_form(), own.roll_length_tip());
        for i in 0..=n {
            let s = low + (high - low) * f64::from(i) / f64::from(n);
            let r = own.r_base().hypot(s);
            // The left flank of the pinion, the right one of the ring.
            let theta = turned + own.sign() * own.half_angle_at_roll(s);
            let (x, y) = (r * theta.cos() + off, r * theta.sin());
            let radius = x.hypot(y);
            let within = mate.sign() * (radius - mate.r_form()) > 0.0
                && mate.sign() * (radius - mate.r_tip()) < 0.0;
            if !within {
                continue;
            }
            let flank = of_mate + mate.sign() * mate.half_angle_at(radius);
            let ahead = y.atan2(x) - flank;
            let ahead = ahead - std::f64::consts::TAU * (ahead / std::f64::consts::TAU).round();
            least = least.min(mate.sign() * mate.r_base() * ahead);
        }
    }
    least
}

#[test]
fn gaps_are_the_least_distance_of_the_flanks() {
    let mut spec = plain(Side::Left);
    // The ring at the left of the pinion, so that they touch on +x of both axes.
    spec.gears[1].position[0] = -DISTANCE;
    let mut scene = build(&spec, &[rigid(), rigid()], &contact(1.4e10));
    let phases = scene.phases().to_vec();
    let [pinion, ring] = [0, 1].map(|k| toothing(&spec.gears[k]).clone());
    let (mut compared, mut edges, mut worst) = (0, 0, 0.0_f64);
    for place in 0..80 {
        let s = rolled(&scene, &spec, 0.008 * f64::from(place), (Side::Left, 0.0));
        let _ = energy(&mut scene, &s);
        for (_, c) in candidates(&scene, &s) {
            // Right flanks are open by the backlash.
            let left = c.normal.y > 0.0;
            if !left || c.gap > 2e-5 {
                continue;
            }
            let angle = |k: usize| {
                let pitch = toothing(&spec.gears[k]).pitch_angle();
                phases[k] + s.q[k] + c.points[k].tooth.index as f64 * pitch
            };
            let gap = direct(&pinion, &ring, [angle(0), angle(1)]);
            if gap.is_finite() {
                worst = worst.max((gap - c.gap).abs());
                compared += 1;
                edges += usize::from(c.scale != [1.0; 2]);
            }
        }
    }
    println!("{compared} pairs, {edges} at tip edges: gaps within {worst:.1e} m");
    assert!(compared > 100 && edges > 5);
    assert!(worst < 1e-11, "{worst:e}");
}

fn cases() -> Vec<(&'static str, SceneSpec, [ModelSpec; 2], ContactSpec)> {
    let teeth = movable(8e8, 8e-3, 0.0);
    let relieved = |p: GearParams, start_radius: f64| GearParams {
        modifications: Modifications {
            tip_relief: Some(TipRelief {
                amount: 8e-6,
                start_radius,
                shape: gearbench_models::geometry::ReliefShape::Parabolic,
            }),
            lead_crowning: 3e-6,
            ..Modifications::default()
        },
        ..p
    };
    let modified = pair(
        relieved(params(22, 0.2), 0.0470),
        relieved(ring_params(), 0.1208),
        0.7,
        Side::Left,
    );
    let deviating = |p: GearParams, seed: u64| GearParams {
        deviations: gearbench_models::geometry::Deviations::Class { class: 5, seed },
        ..p
    };
    let deviating = pair(
        deviating(params(22, 0.2), 1),
        deviating(ring_params(), 2),
        2.0,
        Side::Left,
    );
    let hertz = ContactSpec {
        exponent: 1.5,
        ..contact(4e11)
    };
    vec![
        (
            "constant",
            plain(Side::Left),
            [rigid(), rigid()],
            contact(1.4e10),
        ),
        ("coupled", plain(Side::Left), [rigid(), rigid()], varying(1)),
        (
            "right flanks",
            plain(Side::Right),
            [rigid(), rigid()],
            varying(1),
        ),
        (
            "ring first",
            exchanged(plain(Side::Left)),
            [rigid(), rigid()],
            varying(1),
        ),
        ("helical", helical(), [rigid(), rigid()], varying(5)),
        (
            "helical, ring first",
            exchanged(helical()),
            [rigid(), rigid()],
            varying(5),
        ),
        ("modified", modified.clone(), [rigid(), rigid()], varying(5)),
        (
            "modified, ring first",
            exchanged(modified),
            [rigid(), rigid()],
            varying(5),
        ),
        (
            "deviating",
            deviating.clone(),
            [rigid(), rigid()],
            varying(1),
        ),
        ("exponent", plain(Side::Left), [rigid(), rigid()], hertz),
        (
            "teeth",
            plain(Side::Left),
            [teeth.clone(), teeth.clone()],
            contact(2.68e10),
        ),
        (
            "coupled teeth",
            exchanged(plain(Side::Left)),
            [teeth.clone(), teeth.clone()],
            varying(1),
        ),
        ("teeth and rigid", deviating, [teeth, rigid()], varying(1)),
    ]
}

#[test]
fn forces_are_the_slopes_of_the_energy_through_the_mesh_cycle() {
    for (name, spec, models, law) in cases() {
        let mut scene = build(&spec, &models, &law);
        let mut numbers = Numbers::new(5);
        let (mut worst, mut pressed) = (0.0_f64, 0);
        let side = spec.meshes[0].start.side;
        for place in 0..60 {
            let press = if place % 2 == 0 { 8e-6 } else { 1.6e-5 };
            let roll = 0.0104 * f64::from(place) - 0.3;
            let mut s = rolled(&scene, &spec, roll, (side, press));
            scene.begin(&mut s, false);
            let mut f = vec![0.0; s.q.len()];
            scene.force(s.at(), &mut f);
            for _ in 0..3 {
                let along: Vec<f64> = f.iter().map(|_| 2e-5 * numbers.draw()).collect();
                let moved = |h: f64| {
                    let mut s = s.clone();
                    s.q.iter_mut().zip(&along).for_each(|(q, x)| *q += h * x);
                    s
                };
                let work: f64 = f.iter().zip(&along).map(|(f, x)| f * x).sum();
                let scale: f64 = f.iter().zip(&along).map(|(f, x)| (f * x).abs()).sum();
                // Of fourth order: the energy is a polynomial between contacts that open and close.
                let e = |scene: &mut Scene, h: f64| energy(scene, &moved(h));
                let h = 2e-3;
                let d = [1.0, 2.0]
                    .map(|m| (e(&mut scene, m * h) - e(&mut scene, -m * h)) / (2.0 * m * h));
                let slope = (4.0 * d[0] - d[1]) / 3.0;
                let closed = |h: f64| {
                    let found = candidates(&scene, &moved(h));
                    let closed = found.iter().filter(|(_, c)| c.gap < 0.0);
                    closed.map(|(_, c)| c.slot).collect::<Vec<_>>()
                };
                if scale > 0.0 && closed(2.0 * h) == closed(-2.0 * h) {
                    worst = worst.max((work + slope).abs() / scale);
                    pressed += 1;
                }
            }
        }
        println!("{name}: forces within {worst:.1e} of the energy's slopes, {pressed} times");
        assert!(pressed > 100, "{name}: {pressed}");
        assert!(worst < 2e-8, "{name}: {worst:.2e}");
    }
}

/// Returns the forces on the hubs of pinion and ring.
fn on_hubs(scene: &mut Scene, spec: &SceneSpec, s: &State) -> [f64; 2] {
    let mut f = vec![0.0; s.q.len()];
    scene.force(s.at(), &mut f);
    let sum = |name: &str| {
        let i = spec.gears.iter().position(|g| g.name == name).unwrap();
        f[scene.gears()[i].range()].iter().sum::<f64>()
    };
    [sum("pinion"), sum("ring")]
}

#[test]
fn exchanged_turned_and_mirrored_gears_carry_the_same() {
    let teeth = movable(8e8, 8e-3, 0.0);
    for (models, law) in [
        ([rigid(), rigid()], varying(1)),
        ([teeth.clone(), teeth], varying(1)),
    ] {
        let spec = plain(Side::Left);
        let others = [
            (exchanged(plain(Side::Left)), 1.0),
            (pair(params(22, 0.2), ring_params(), 2.3, Side::Left), 1.0),
            (
                exchanged(pair(params(22, 0.2), ring_params(), -2.3, Side::Left)),
                1.0,
            ),
            (plain(Side::Right), -1.0),
            (exchanged(plain(Side::Right)), -1.0),
        ];
        let mut scene = build(&spec, &models, &law);
        let mut worst = [0.0_f64; 5];
        for place in 0..50 {
            let roll = 0.0121 * f64::from(place) - 0.3;
            let press = (Side::Left, 1.3e-5);
            let mut s = rolled(&scene, &spec, roll, press);
            scene.begin(&mut s, false);
            let expected = on_hubs(&mut scene, &spec, &s);
            assert!(expected[0] < 0.0 && expected[1] > 0.0, "{expected:?}");
            for ((other, sign), worst) in others.iter().zip(&mut worst) {
                let mut twin = build(other, &models, &law);
                let side = other.meshes[0].start.side;
                let mut s = rolled(&twin, other, sign * roll, (side, press.1));
                twin.begin(&mut s, false);
                let found = on_hubs(&mut twin, other, &s);
                for k in 0..2 {
                    *worst = worst.max((sign * found[k] / expected[k] - 1.0).abs());
                }
            }
        }
        println!("exchanged, turned, both, mirrored, mirrored and exchanged: {worst:?}");
        assert!(worst.iter().all(|w| *w < 1e-9), "{worst:?}");
    }
}

/// Rigid involutes have no transmission error, and the torques of plain flanks of constant stiffness have the ratio of
/// the base radii.
#[test]
fn the_ratio_of_rigid_gears_is_exact() {
    let spec = plain(Side::Left);
    let mut scene = build(&spec, &[rigid(), rigid()], &contact(1.4e10));
    let radii = [0, 1].map(|i| effective_radius(&spec.gears[i].body));
    assert!((radii[1] / radii[0] - 61.0 / 22.0).abs() < 1e-15);
    let (mut error, mut torque, mut free_of_edges) = (0.0_f64, 0.0_f64, 0);
    for place in 0..200 {
        let s = rolled(&scene, &spec, 0.0127 * f64::from(place), (Side::Left, 5e-6));
        let found = candidates(&scene, &s);
        // The ring's axis lies on +x, so that contact is on -x, and left flanks push to -y.
        let left = found.iter().filter(|(_, c)| c.normal.y < 0.0);
        let on_path = left.clone().filter(|(_, c)| c.scale == [1.0; 2]);
        let gaps: Vec<f64> = on_path.map(|(_, c)| c.gap).collect();
        assert!(!gaps.is_empty());
        error = gaps.iter().fold(error, |e, g| e.max((g + 5e-6).abs()));
        if left
            .clone()
            .all(|(_, c)| c.gap > 0.0 || c.scale == [1.0; 2])
        {
            let f = on_hubs(&mut scene, &spec, &s);
            torque = torque.max((f[0] / radii[0] + f[1] / radii[1]).abs() / (f[1] / radii[1]));
            free_of_edges += 1;
        }
    }
    println!("gaps within {error:.1e} m over 200 places, torques within {torque:.1e}");
    assert!(error < 1e-15);
    assert!(
        free_of_edges > 100 && torque < 1e-12,
        "{free_of_edges} {torque:e}"
    );
}
