//! Nearest points compared with bisection of the slope, and bounds of distant flanks compared with descents.
#![allow(clippy::print_stdout, reason = "observed figures")]

use super::*;
use crate::geometry::{Gear, GearParams, Modifications, Rack, RackParams, ReliefShape, TipRelief};

const HELIX: f64 = 0.3;
const WIDTH: f64 = 0.02;

/// Greatest length of roll [m]; the base circle of the mate lies beyond.
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

/// Builds a pair that is sliced on its first gear.
fn flanks(modified: bool) -> Spatial {
    let gears = [gear(20, HELIX, modified), gear(30, -HELIX, modified)];
    spatial(
        &gears[0],
        FlankForm::Involute(Box::new(Helicoid::new(&gears[1]))),
    )
}

fn spatial(gear: &Gear, mate: FlankForm) -> Spatial {
    Spatial::new(SpatialGeometry {
        base_pitch: gear.pitch_angle() * gear.flank(Side::Left).base_radius,
        flanks: [FlankForm::Involute(Box::new(Helicoid::new(gear))), mate],
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

/// Finds the nearest point of a section by bisection.
fn bisected(section: &Section<'_>, [low, high]: [f64; 2], exact: bool) -> SectionPoint {
    let (mut from, mut to) = (low, high);
    loop {
        let roll = 0.5 * (from + to);
        let mut place = section.at_roll(roll);
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

/// Returns, for parallel, tilted and crossed axes, the largest differences of nearest points in gap [m], position and
/// normal, the number of comparisons, and the number of evaluations for each.
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
                    let touch = spatial.touch(&section, nearest, &pose, PointDerivatives::Path);
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

/// Nearest points are exact to 1e-11 despite first-order last corrections and initial guesses from the previous slice.
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
            assert!(place < 1e-11 && normal < 1e-10, "{place:e} {normal:e}");
        }
    }
}

/// Generator of repeatable uniform numbers in [-1, 1) (xorshift64*).
struct RandomNumbers(u64);

impl RandomNumbers {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        let bits = self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11;
        bits as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// Builds the flanks of a helical pair, a spur pair, a conical pair and a helical gear with a rack, with the hub of
/// the mate and its angle (position) where a left or right flank of the gear at the angle zero is about in mesh.
fn arrangements() -> Vec<(&'static str, Spatial, HubFrame, [f64; 2])> {
    let involute = |g: &Gear| FlankForm::Involute(Box::new(Helicoid::new(g)));
    let aligned = |helix: f64| {
        let mate = involute(&gear(30, -helix, false));
        let apart = std::f64::consts::PI;
        (
            spatial(&gear(20, helix, false), mate),
            hub(0.1 / helix.cos(), [0.0; 2]),
            [apart - 0.1, apart + 0.1],
        )
    };
    let conical = |teeth: u32, angle: f64, helix: f64| {
        Gear::new(GearParams {
            teeth,
            module: 4e-3,
            profile_shift: 0.2,
            profile_shift_angle: angle,
            tip_cone_angle: 0.9 * angle,
            helix_angle: helix,
            face_width: WIDTH,
            ..GearParams::default()
        })
        .unwrap()
    };
    let rack = Rack::new(RackParams {
        teeth: 9,
        module: 4e-3,
        helix_angle: -HELIX,
        face_width: WIDTH,
        ..RackParams::default()
    })
    .unwrap();
    let facing = HubFrame {
        axes: [Vec3::y(), -Vec3::x(), Vec3::z()],
        origin: Vec3::new(0.04 / HELIX.cos(), 0.0, 0.0),
    };
    let half_pitch = std::f64::consts::TAU * 1e-3 / HELIX.cos();
    let (helical, spur) = (aligned(HELIX), aligned(0.0));
    let [one, two] = [conical(20, 0.09, -0.1), conical(30, 0.1, 0.1)];
    vec![
        ("helical", helical.0, helical.1, helical.2),
        ("spur", spur.0, spur.1, spur.2),
        (
            "conical",
            spatial(&one, involute(&two)),
            hub(0.102, [0.0, 0.19]),
            spur.2,
        ),
        (
            "rack",
            spatial(
                &gear(20, HELIX, false),
                FlankForm::Plane(Plane::new(&rack, rack.tip_height())),
            ),
            facing,
            [half_pitch, -half_pitch],
        ),
    ]
}

/// Returns the smallest distance in descent direction from a point, in small steps and by bisection; `None` where the
/// descent reaches the base cylinder of the mate.
fn descended(section: &Section<'_>, from: &SectionPoint, least: f64) -> Option<f64> {
    let step = 1e-4 * section.flank.base_radius;
    let downhill = -section.slopes(from, least).gap.signum() * step;
    let (mut roll, mut distance) = (from.roll, from.near.distance);
    loop {
        let next = section.at_roll(roll + downhill);
        if next.near.roll == 0.0 {
            return None;
        }
        if next.near.distance >= distance || next.roll < least {
            break;
        }
        (roll, distance) = (next.roll, next.near.distance);
    }
    let around = [(roll - step).max(least), roll + step];
    Some(bisected(section, around, false).near.distance.min(distance))
}

/// Distant flanks are at least as far as their bounds, whatever the tilts, offsets and guesses.
#[test]
fn far_flanks_are_as_far_as_their_bounds() {
    let mut draws = RandomNumbers(7);
    for (name, spatial, at, angles) in arrangements() {
        let least = LEAST_ROLL * spatial.base_pitch;
        let (mut bounded, mut left_out, mut closest, mut missed) = (0, 0, f64::INFINITY, 0);
        for trial in 0..20_000 {
            // From rounding to a tenth.
            let size = 0.1 * (4.0 * draws.next() - 4.0).exp2();
            let turn = nalgebra::Rotation3::new(
                size * Vec3::new(draws.next(), draws.next(), 0.1 * draws.next()),
            );
            let offset = 1e-3 * Vec3::new(draws.next(), draws.next(), draws.next());
            let mate = HubFrame {
                axes: at.axes.map(|axis| turn * axis),
                origin: at.origin + offset,
            };
            let side = Side::BOTH[trial % 2];
            let psi = 0.3 * draws.next();
            // The mate follows the gear, up to a fifth of a tooth.
            let involute = matches!(spatial.flanks[1], FlankForm::Involute(_));
            let follows = if involute {
                -psi / 1.5
            } else {
                0.04 * psi / HELIX.cos()
            };
            let play = if involute { 0.04 } else { 2.4e-3 };
            let of_mate = angles[side_index(side)] + follows + play * draws.next();
            let pose = spatial.pose([&hub(0.0, [0.0; 2]), &mate]);
            let z = 0.5 * WIDTH * draws.next();
            let section = spatial.section(side, z, &pose, [(0, psi), (0, of_mate)]);
            let guess = least + 0.5 * (1.0 + draws.next()) * REACH;
            let place = section.at_roll(guess);
            if let Some(bound) = section.lower_bound(&place)
                && let Some(exact) = descended(&section, &place, least)
            {
                bounded += 1;
                closest = closest.min(exact - bound);
            }
            let found = spatial.nearest(&section, 0, &pose, guess);
            let Some(exact) = descended(&section, &section.at_roll(found.roll), least) else {
                continue;
            };
            if found.near.distance > spatial.far {
                left_out += 1;
                closest = closest.min(exact - found.near.distance);
            } else if exact > 1.1 * spatial.far {
                missed += 1;
            }
        }
        println!(
            "{name}: {bounded} bounds, {left_out} flanks left out, the nearest {closest:.1e} m beyond its bound; {missed} exact though far"
        );
        assert!(bounded > 2000 && left_out > 2000, "{bounded} {left_out}");
        assert!(closest > -1e-15, "{name}: {closest:e}");
        assert!(missed < left_out / 20, "{name}: {missed}");
    }
}

/// A guess far from the nearest point has no bound above the distance there.
#[test]
fn a_poor_guess_does_not_leave_a_near_flank_out() {
    let spatial = flanks(false);
    let hubs = [hub(0.0, [0.0; 2]), hub(0.1 / HELIX.cos() + 1e-4, [0.0; 2])];
    let pose = spatial.pose([&hubs[0], &hubs[1]]);
    let least = LEAST_ROLL * spatial.base_pitch;
    for by in 1..40 {
        let of_mate = std::f64::consts::PI - 0.1 - 1e-3 * f64::from(by);
        let section = spatial.section(Side::Left, 0.0, &pose, [(0, 0.0), (0, of_mate)]);
        let exact = bisected(&section, [least, REACH], false).near.distance;
        for guess in 1..66 {
            let place = section.at_roll(5e-4 * f64::from(guess));
            let bound = section.lower_bound(&place).unwrap_or(f64::NEG_INFINITY);
            assert!(bound <= exact + 1e-15, "{guess}: {bound:e} {exact:e}");
        }
    }
}
