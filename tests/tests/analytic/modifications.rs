//! Flanks that vary over the width: helix slope compared with a tilt of the axis, twisted and measured flanks compared
//! with a direct computation of their distance from the mate.

use super::space::{helical, helical_pair, on_bearings};
use gearbench_integrators::{SecondOrderSystem, State};
use gearbench_models::Vec3;
use gearbench_models::geometry::{
    EndRelief, Gear, GearParams, Modifications, Pair, ReliefShape, Side, Topography,
};
use gearbench_models::scene::Scene;
use gearbench_models::spec::{Body, SceneSpec, Start, effective_radius, turned_to};
use gearbench_tests::*;
use std::sync::Arc;

fn toothing(spec: &SceneSpec, k: usize) -> &Gear {
    match &spec.gears[k].body {
        Body::Gear(gear) => gear,
        Body::Rack(_) => panic!("a rack"),
    }
}

/// Returns spur gears with modifications of the pinion, with a pair of left flanks at the path coordinate `s` that
/// would touch without modifications.
fn pair_with(modifications: Modifications, s: Option<f64>) -> SceneSpec {
    let pinion = GearParams {
        modifications,
        ..helical(20, 0.0)
    };
    let start = Start {
        side: Side::Left,
        gap: 0.0,
        path_coordinate: s,
        loaded: false,
    };
    pair_of(
        gear("pinion", pinion, 0.0, 0.0),
        gear("wheel", helical(30, 0.0), 0.1001, 0.0),
        start,
    )
}

/// Returns height and normal force of every contact, from below.
fn loads(scene: &mut Scene, s: &State) -> Vec<(f64, f64)> {
    let forces = scene.contact_forces(s.at());
    let mut loads: Vec<_> = forces.iter().map(|f| (f.x.z, f.normal_force)).collect();
    loads.sort_by(|a, b| a.0.total_cmp(&b.0));
    loads
}

/// A helix slope of `C` over the width `b` is a tilt by `C/b` of the axis in the plane of action, to first order.
#[test]
fn a_helix_slope_is_a_tilt_in_the_plane_of_action() {
    let (slices, width, per_width) = (100, 0.02, 1.5e10);
    let mut worst = Vec::new();
    for tilt in [4e-4, 2e-4, 1e-4] {
        let amount = tilt * width;
        let sloped = pair_with(
            Modifications {
                helix_slope: [-amount, 0.0],
                ..Modifications::default()
            },
            None,
        );
        let mut tilted = helical_pair(0.0, 0.0, false);
        let pair = Pair::new(toothing(&sloped, 0), toothing(&sloped, 1), 0.1001).unwrap();
        let angle = std::f64::consts::FRAC_PI_2 - pair.working_pressure_angle();
        let line = Vec3::new(angle.cos(), angle.sin(), 0.0);
        // The upper end of the pinion leans towards the wheel.
        for (gear, sign) in tilted.gears.iter_mut().zip([0.5, -0.5]) {
            let turn = nalgebra::Rotation3::new(Vec3::z().cross(&line) * sign * tilt);
            gear.axes = turned_to(&gear.axes, &(turn * Vec3::z()));
        }
        let mut law = contact(per_width);
        law.slices = Some(slices);
        for model in [rigid(), movable(1e9, 1e-3, 0.0)] {
            let mut scenes =
                [&sloped, &tilted].map(|spec| build(spec, &[model.clone(), rigid()], &law));
            for approach in [0.4, 1.0, 2.5] {
                let press = |scene: &Scene, by: f64| {
                    let mut s = scene.initial();
                    let turn = by / effective_radius(&sloped.gears[0].body);
                    let range = scene.gears()[0].range();
                    s.q[range].iter_mut().for_each(|q| *q += turn);
                    s
                };
                let states = [
                    press(&scenes[0], approach * amount),
                    press(&scenes[1], (approach - 0.5) * amount),
                ];
                let [a, b] = [0, 1].map(|k| loads(&mut scenes[k], &states[k]));
                let greatest = a.iter().map(|l| l.1).fold(0.0, f64::max);
                assert!((a.last().unwrap().0 - 0.01).abs() < width / f64::from(slices as u32));
                // A slice at the border of contact may bear nothing in one of both.
                let of = |all: &[(f64, f64)], z: f64| {
                    all.iter()
                        .find(|l| (l.0 - z).abs() < 1e-5)
                        .map_or(0.0, |l| l.1)
                };
                let off = a
                    .iter()
                    .chain(&b)
                    .map(|l| (of(&a, l.0) - of(&b, l.0)).abs());
                worst.push(off.fold(0.0, f64::max) / greatest);
            }
        }
    }
    for (tilt, of) in [4e-4, 2e-4, 1e-4].iter().zip(worst.chunks(6)) {
        let greatest = of.iter().copied().fold(0.0, f64::max);
        println!("tilt {tilt:e}: slices differ by {greatest:.1e} of the greatest load");
    }
    for (i, w) in worst.iter().enumerate() {
        let tilt = [4e-4, 2e-4, 1e-4][i / 6];
        assert!(*w < 10.0 * tilt, "{w:e} at {tilt}");
    }
}

/// Returns the distance of a modified flank of the pinion from the involute of the wheel in one transverse plane: the
/// minimum over a fine set of points, each moved into the material along its normal.
fn direct(one: &Gear, two: &Gear, angles: [f64; 2], zeta: f64) -> f64 {
    let n = 40_000;
    let (low, high) = (one.roll_length_form(), one.roll_length_tip());
    let mut least = f64::INFINITY;
    for i in 0..=n {
        let s = low + (high - low) * f64::from(i) / f64::from(n);
        let r = one.r_base().hypot(s);
        let at = angles[0] + one.half_angle_at_roll(s);
        let normal = at - (s / one.r_base()).atan();
        let removed = one.flank_deviation(Side::Left, r, zeta);
        let x = r * at.cos() + removed * normal.sin();
        let y = r * at.sin() - removed * normal.cos();
        // The involute of the wheel through this point is its flank turned.
        let (x, y) = (x - 0.1001, y);
        let roll = two.roll_length(x.hypot(y));
        let off = y.atan2(x).rem_euclid(std::f64::consts::TAU) - angles[1];
        least = least.min(two.r_base() * (off - two.half_angle_at_roll(roll)));
    }
    least
}

#[test]
fn gaps_of_varied_flanks_are_their_least_distance() {
    let wavy = |u: f64, v: f64| 2e-6 * (5.0 * u).sin() + 4e-6 * (3.0 * v + u).cos();
    let row = |i: i32| (0..15).map(move |j| wavy(f64::from(i) / 11.0, f64::from(j) / 14.0));
    let rows: Vec<Vec<f64>> = (0..12).map(|i| row(i).collect()).collect();
    let measured = Arc::new(Topography::new(&rows, None, None).unwrap());
    let cases = [
        Modifications {
            twist: [16e-6, 0.0],
            ..Modifications::default()
        },
        Modifications {
            topography: [Some(measured), None],
            ..Modifications::default()
        },
        Modifications {
            twist: [-10e-6, 0.0],
            helix_slope: [5e-6, 0.0],
            profile_crowning: 3e-6,
            end_relief: [
                Some(EndRelief {
                    amount: 6e-6,
                    length: 6e-3,
                    shape: ReliefShape::Parabolic,
                }),
                None,
            ],
            ..Modifications::default()
        },
    ];
    let plain = pair_with(Modifications::default(), None);
    let pair = Pair::new(toothing(&plain, 0), toothing(&plain, 1), 0.1001).unwrap();
    let depth = 25e-6;
    let mut worst = [0.0_f64; 2];
    for modifications in cases {
        for ahead in [-1.2e-3, 0.0, 1.1e-3] {
            let s = pair.s_pitch() + ahead;
            let spec = pair_with(modifications.clone(), Some(s));
            let (one, two) = (toothing(&spec, 0), toothing(&spec, 1));
            let angles = [
                pair.tooth_angle(s + depth, Side::Left),
                pair.mate_position(s, 0.0, Side::Left),
            ];
            let mut afloat = spec.clone();
            afloat
                .gears
                .iter_mut()
                .for_each(|g| g.lateral = on_bearings());
            for (k, spec) in [&spec, &afloat].into_iter().enumerate() {
                let mut law = contact(1.5e10);
                law.slices = Some(8);
                let mut scene = build(spec, &[rigid(), rigid()], &law);
                let mut state = scene.initial();
                let own = scene.gears()[0].range().start;
                state.q[own] += depth / one.r_base();
                let found = scene.contact_forces(state.at());
                assert_eq!(found.len(), 8, "one pair, eight slices");
                for c in found {
                    let off = (c.gap - direct(one, two, angles, c.x.z / 0.01)).abs();
                    worst[k] = worst[k].max(off);
                }
            }
        }
    }
    println!(
        "greatest error of a gap, on lines of action and in space: {:.1e} and {:.1e} m",
        worst[0], worst[1]
    );
    assert!(worst.iter().all(|w| *w < 2e-10), "{worst:?}");
}

/// A topography sampled from crownings gives the forces of the crownings.
#[test]
fn a_sampled_crowning_bears_as_the_crowning() {
    let crowned = Modifications {
        profile_crowning: 5e-6,
        lead_crowning: 8e-6,
        ..Modifications::default()
    };
    let part = |i: i32, n: i32| 2.0 * f64::from(i) / f64::from(n - 1) - 1.0;
    let amount = |u: f64, v: f64| 5e-6 * u * u + 8e-6 * v * v;
    let row = |i| {
        (0..7)
            .map(move |j| amount(part(i, 9), part(j, 7)))
            .collect()
    };
    let rows: Vec<Vec<f64>> = (0..9).map(row).collect();
    let measured = Arc::new(Topography::new(&rows, None, None).unwrap());
    let sampled = Modifications {
        topography: [Some(measured.clone()), Some(measured)],
        ..Modifications::default()
    };
    let mut worst = 0.0_f64;
    for model in [rigid(), movable(1e9, 1e-3, 0.0)] {
        let mut scenes = [&crowned, &sampled].map(|m| {
            let spec = pair_with(m.clone(), None);
            build(&spec, &[model.clone(), rigid()], &contact(1.5e10))
        });
        for i in 0..40 {
            let of: [f64; 2] = scenes.each_mut().map(|scene| {
                let mut s = scene.initial();
                let roll = 0.005 * f64::from(i) + 5e-4;
                let range = scene.gears()[0].range();
                s.q[range].iter_mut().for_each(|q| *q += roll);
                let wheel = scene.gears()[1].range().start;
                s.q[wheel] -= (roll - 5e-4) * 20.0 / 30.0;
                let mut f = vec![0.0; s.q.len()];
                scene.force(s.at(), &mut f);
                f[wheel]
            });
            assert!(of[0].abs() > 100.0, "{of:?}");
            worst = worst.max((of[1] / of[0] - 1.0).abs());
        }
    }
    println!("greatest difference of the torque: {worst:.1e}");
    assert!(worst < 1e-12, "{worst:e}");
}
