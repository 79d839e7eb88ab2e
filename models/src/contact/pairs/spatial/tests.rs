//! Nearest points against those that bisection of the slope finds from scratch.

use super::*;
use crate::geometry::{Gear, GearParams, Modifications, ReliefShape, TipRelief};

const HELIX: f64 = 0.3;
const WIDTH: f64 = 0.02;

/// Greatest length of roll [m]: the mate has its base circle beyond.
const REACH: f64 = 0.033;

fn gear(teeth: u32, helix: f64, modified: bool) -> Gear {
    let relief = TipRelief {
        amount: 2e-5,
        start_radius: 42e-3,
        shape: ReliefShape::Parabolic,
    };
    let modifications = Modifications {
        tip_relief: (teeth == 20).then_some(relief),
        profile_crowning: 5e-6,
        lead_crowning: 8e-6,
        ..Modifications::default()
    };
    Gear::new(GearParams {
        teeth,
        module: 4e-3,
        helix_angle: helix,
        face_width: WIDTH,
        modifications: if modified {
            modifications
        } else {
            Modifications::default()
        },
        ..GearParams::default()
    })
    .unwrap()
}

/// A pair that is sliced on its first gear.
fn flanks(modified: bool) -> Spatial {
    let gears = [gear(20, HELIX, modified), gear(30, -HELIX, modified)];
    let pitch = std::f64::consts::TAU / 20.0;
    Spatial::new(SpatialGeometry {
        base_pitch: pitch * gears[0].flank(Side::Left).base_radius,
        flanks: gears.map(|g| FlankForm::Involute(Box::new(Helicoid::new(&g)))),
        sliced: 0,
        length: 0.034,
        roll_scale: [[1.0; 2]; 2],
        phases: [0.0; 2],
    })
}

fn hub(x: f64, tilt: [f64; 2]) -> HubFrame {
    let turn = nalgebra::Rotation3::new(Vec3::new(tilt[0], tilt[1], 0.0));
    HubFrame {
        axes: [Vec3::x(), Vec3::y(), Vec3::z()].map(|axis| turn * axis),
        origin: Vec3::new(x, 0.0, 0.0),
    }
}

/// The nearest place of a section by bisection.
fn bisected(section: &Section<'_>, [low, high]: [f64; 2], exact: bool) -> Place {
    let (mut from, mut to) = (low, high);
    loop {
        let roll = 0.5 * (from + to);
        let mut place = section.from_roll(roll);
        let slope = match exact {
            true => section.remove(&mut place, low).gap,
            false => section.slopes(&place, low).gap,
        };
        if roll <= from || roll >= to {
            return place;
        }
        if slope > 0.0 {
            to = roll;
        } else {
            from = roll;
        }
    }
}

/// Of parallel, tilted and crossed axes: what nearest points differ by at most in gap [m], place and normal, how many were
/// compared, and places that were evaluated for each.
fn compared(modified: bool, tilt: f64) -> ([f64; 3], usize, f64) {
    let spatial = flanks(modified);
    let hubs = [
        hub(0.0, [0.0, 0.0]),
        hub(0.1 / HELIX.cos() + 1e-4, [tilt, -0.7 * tilt]),
    ];
    let poses = || spatial.pose([&hubs[0], &hubs[1]]);
    let least = LEAST_ROLL * spatial.base_pitch;
    let [of_a, of_b] = [0, 1].map(|k| {
        let FlankForm::Involute(h) = &spatial.flanks[k] else {
            unreachable!()
        };
        h
    });
    let (mut worst, mut count, mut evaluated) = ([0.0_f64; 3], 0, 0);
    for side in Side::BOTH {
        let reach = [least, REACH];
        for step in 0..25 {
            let psi = 0.025 * (f64::from(step) - 12.0);
            // The mate's tooth that stands so that the middle slices overlap a little.
            let middle = |of_mate: f64| {
                let pose = poses();
                let teeth = [(0, psi), (0, of_mate)];
                let section = spatial.section(side, 0.0, &pose, teeth);
                bisected(&section, reach, false).near.distance
            };
            let apart = std::f64::consts::PI - psi / 1.5 - side.sign() * 0.1;
            let (d, turn) = (middle(apart), 1e-3);
            let slope = (middle(apart + turn) - d) / turn;
            for target in [-2e-5, 1e-4] {
                let of_mate = apart + (target - d) / slope;
                let teeth = [(0, psi), (0, of_mate)];
                let pose = poses();
                for slice in 0..9 {
                    let z = WIDTH * (f64::from(slice) - 4.0) / 8.0;
                    let section = spatial.section(side, z, &pose, teeth);
                    let plain = bisected(&section, reach, false);
                    let before = spatial.evaluated();
                    let nearest = spatial.nearest(&section, 0, &pose, 0.012);
                    let touch = spatial.touch(&section, nearest, &pose, true);
                    let taken = spatial.evaluated() - before;
                    let distance = plain.near.distance;
                    if distance > spatial.far {
                        continue;
                    }
                    let (tip, of_tip) = (of_a.tip(side, z), of_b.tip(side, plain.x.z));
                    let foot = plain.near.roll - distance / of_b.flank(side).cos_helix;
                    if plain.roll > 0.98 * tip || foot > of_tip || plain.roll < 1.5 * least {
                        continue;
                    }
                    let place = match modified {
                        true => bisected(&section, [least, tip], true),
                        false => plain,
                    };
                    if place.roll == tip {
                        continue;
                    }
                    let removed = of_a.removed(0, side, place.roll, z)[0];
                    let found = hubs[1].point_back(&touch.x);
                    let normal = -hubs[1].turn_back(&touch.normal);
                    let off = [
                        (touch.gap - place.near.distance - removed).abs(),
                        (found - place.x).norm() / place.roll,
                        (normal - place.near.gradient).norm(),
                    ];
                    worst.iter_mut().zip(off).for_each(|(w, o)| *w = w.max(o));
                    count += 1;
                    evaluated += taken;
                }
            }
        }
    }
    (worst, count, evaluated as f64 / count as f64)
}

/// Small last corrections to first order and starts from the slice before leave nearest points exact to 1e-9.
#[test]
fn nearest_points_are_those_of_bisection() {
    for modified in [false, true] {
        for tilt in [0.0, 1e-3, 0.05] {
            let ([gap, place, normal], count, evaluated) = compared(modified, tilt);
            println!(
                "modified {modified}, tilt {tilt}: {count} pairs, gaps within {gap:.1e} m, places {place:.1e}, normals {normal:.1e}; {evaluated:.2} places each"
            );
            assert!(count > 60, "{count}");
            assert!(gap < 1e-15, "{gap:e}");
            assert!(place < 1e-9 && normal < 1e-9, "{place:e} {normal:e}");
        }
    }
}
