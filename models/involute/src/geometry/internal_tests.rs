//! Internal gears compared with the envelope of their cutter, and with published formulas.

use super::internal::Internal;
use super::{Gear, GearParams, Pair, Side, inv};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

pub(super) fn external(teeth: u32, profile_shift: f64) -> Gear {
    Gear::new(GearParams {
        teeth,
        module: 4e-3,
        profile_shift,
        ..GearParams::default()
    })
    .unwrap()
}

pub(super) fn ring_params(teeth: u32, profile_shift: f64) -> GearParams {
    GearParams {
        teeth,
        module: 4e-3,
        profile_shift,
        addendum: 0.8,
        tip_radius: 0.25,
        internal: Some(Internal {
            cutter_teeth: Some(23),
            ..Internal::default()
        }),
        ..GearParams::default()
    }
}

pub(super) fn ring(teeth: u32, profile_shift: f64) -> Gear {
    Gear::new(ring_params(teeth, profile_shift)).unwrap()
}

fn rings() -> Vec<Gear> {
    let shifted = GearParams {
        thinning: 1e-4,
        internal: Some(Internal {
            cutter_teeth: Some(17),
            cutter_shift: 0.1,
            ..Internal::default()
        }),
        ..ring_params(45, 0.2)
    };
    let helical = GearParams {
        helix_angle: 0.3,
        profile_shift: -0.2,
        tip_radius: 0.1,
        ..ring_params(70, 0.0)
    };
    [ring_params(61, 0.0), shifted, helical]
        .into_iter()
        .map(|p| Gear::new(p).unwrap())
        .collect()
}

/// The tooth space is the envelope of the cutter: no point of it enters a tooth, and at every radius some point
/// touches its flank. The test does not use the law of gearing: the centre distance is where nothing overlaps and all
/// of the space is filled.
#[test]
fn the_tooth_space_is_what_the_cutter_leaves() {
    for gear in rings() {
        let p = gear.params();
        let of = p.internal.unwrap();
        let z0 = f64::from(of.cutter_teeth_of(p.teeth));
        let ratio = z0 / f64::from(p.teeth);
        let (r0, rb0) = (ratio * gear.r_reference(), ratio * gear.r_base());
        // The cutter: an involute, and an arc of the given radius that touches it and the tip circle, looked for by halving.
        let tan = p.pressure_angle.tan();
        let chi = (FRAC_PI_2 + 2.0 * of.cutter_shift * tan) / z0
            + p.thinning / (2.0 * r0)
            + inv(gear.transverse_pressure_angle());
        let half_at = |r: f64| chi - inv((rb0 / r).min(1.0).acos());
        let difference = f64::from(p.teeth) - z0;
        let inv_w = inv(gear.transverse_pressure_angle())
            - 2.0 * tan * (p.profile_shift + of.cutter_shift) / difference;
        let alpha_w = super::inv_inverse(inv_w);
        let distance = (gear.r_base() - rb0) / alpha_w.cos();
        let r_tip = gear.r_root() - distance;
        assert!((r_tip - r0 - p.module * (p.dedendum + of.cutter_shift)).abs() < 1e-15);
        let rho = p.tip_radius * p.module;
        let flank: Vec<[f64; 2]> = (0..=8000)
            .map(|k| {
                let r = rb0 + (r_tip - rb0) * f64::from(k) / 8000.0;
                [r * half_at(r).cos(), r * half_at(r).sin()]
            })
            .collect();
        let rc = r_tip - rho;
        let free = |theta: f64| {
            let c = [rc * theta.cos(), rc * theta.sin()];
            let beyond = |q: &&[f64; 2]| q[0].hypot(q[1]) > rc - rho;
            let near = flank.iter().filter(beyond);
            near.map(|q| (q[0] - c[0]).hypot(q[1] - c[1]))
                .fold(f64::INFINITY, f64::min)
                - rho
        };
        let (mut lo, mut hi) = (0.0, half_at(rc));
        for _ in 0..50 {
            let mid = 0.5 * (lo + hi);
            if free(mid) > 0.0 { lo = mid } else { hi = mid }
        }
        let centre = [rc * lo.cos(), rc * lo.sin()];
        let mut profile: Vec<[f64; 2]> = (0..=400)
            .map(|k| {
                let phi = lo + 1.6 * f64::from(k) / 400.0;
                [centre[0] + rho * phi.cos(), centre[1] + rho * phi.sin()]
            })
            .filter(|q| q[1].atan2(q[0]) < half_at(q[0].hypot(q[1])) + 1e-12)
            .collect();
        profile.extend((0..60).map(|k| {
            let a = lo * f64::from(k) / 60.0;
            [r_tip * a.cos(), r_tip * a.sin()]
        }));
        // Points of the involute below the end of the root arc.
        let from_arc = |q: &[f64; 2]| (q[0] - centre[0]).hypot(q[1] - centre[1]);
        let last = (0..flank.len())
            .min_by(|i, j| from_arc(&flank[*i]).total_cmp(&from_arc(&flank[*j])))
            .unwrap();
        profile.extend(flank[..=last].iter().step_by(4));
        const BINS: usize = 40;
        let (root, tip) = (gear.r_root(), gear.r_tip());
        let mut closest = [f64::INFINITY; BINS];
        for step in -1500..=1500 {
            let turn = 1.2 * f64::from(step) / 1500.0;
            let (sin, cos) = turn.sin_cos();
            for q in &profile {
                let (x, y) = (distance + cos * q[0] - sin * q[1], sin * q[0] + cos * q[1]);
                let radius = x.hypot(y);
                if radius <= tip || radius >= root * (1.0 - 1e-9) {
                    assert!(radius <= root * (1.0 + 1e-9), "the cutter passes the root");
                    continue;
                }
                let from_space = y.atan2(x) - turn * ratio;
                let space = 0.5 * gear.pitch_angle() - gear.half_angle_at(radius);
                let open = (space - from_space) * radius;
                assert!(
                    open > -2e-9,
                    "cutter inside the tooth by {open} at {radius}"
                );
                let bin = ((radius - tip) / (root - tip) * BINS as f64) as usize;
                closest[bin] = closest[bin].min(open);
            }
        }
        let worst = closest.iter().copied().fold(0.0, f64::max);
        assert!(
            worst < 2e-5 * p.module,
            "the cutter leaves {worst} m standing"
        );
    }
}

#[test]
fn fillet_joins_involute_and_root_circle() {
    for gear in rings() {
        let (r, h) = (gear.r_form(), 1e-8);
        let jump = gear.half_angle_at(r * (1.0 + 1e-15)) - gear.half_angle_at(r);
        assert!(jump.abs() < 1e-13, "{jump}");
        let slope = |r: f64, h: f64| r * (gear.half_angle_at(r + h) - gear.half_angle_at(r)) / h;
        let kink = slope(r + 1e-12, h).atan() - slope(r - 1e-12, -h).atan();
        assert!(kink.abs() < 1e-4, "{kink}");
        assert!(
            slope(gear.r_root(), -1e-12).atan() > 1.57,
            "tangent to the root circle"
        );
        assert!(gear.r_tip() < r && r < gear.r_root() && gear.r_root() < gear.r_outer());
    }
}

#[test]
fn thickness_by_the_formula_of_a_tooth_space() {
    let gear = ring(61, 0.3);
    // ISO 21771-1 with z = -61, or the space as an external tooth.
    let (m, r, rb) = (4e-3, gear.r_reference(), gear.r_base());
    assert!((gear.r_tip() - (0.122 - 1.1 * m)).abs() < 1e-15);
    let a = 20f64.to_radians();
    for y in [gear.r_tip(), r, gear.r_form()] {
        let space = m * (FRAC_PI_2 - 0.6 * a.tan()) / r + 2.0 * (inv(a) - inv((rb / y).acos()));
        let tooth = TAU / 61.0 - space;
        assert!((2.0 * gear.half_angle_at(y) - tooth).abs() < 1e-15);
    }
    let given = Gear::new(GearParams {
        internal: Some(Internal {
            tip_circle: Some(0.1182),
            root_circle: Some(0.1268),
            rim_radius: Some(0.14),
            ..Internal::default()
        }),
        ..ring_params(61, 0.0)
    })
    .unwrap();
    let radii = [given.r_tip(), given.r_root(), given.seat_radius()];
    for (x, y) in radii.iter().zip([0.1182, 0.1268, 0.14]) {
        assert!((x - y).abs() < 1e-15);
    }
}

/// Mass and inertia equal the area and polar moment of the disc of the rim less those of the polygon of the hole.
#[test]
fn mass_and_inertia_are_the_integrals_of_the_section() {
    for gear in rings() {
        let (mut area, mut polar) = (0.0, 0.0);
        let hole = gear.outline(600);
        for (i, [x0, y0]) in hole.iter().enumerate() {
            let [x1, y1] = hole[(i + 1) % hole.len()];
            let cross = x0 * y1 - x1 * y0;
            area += 0.5 * cross;
            polar += cross / 12.0 * (x0 * x0 + x0 * x1 + x1 * x1 + y0 * y0 + y0 * y1 + y1 * y1);
        }
        let rim2 = gear.r_outer().powi(2);
        let (a, p) = (PI * rim2 - area, 0.5 * PI * rim2 * rim2 - polar);
        let (own_a, own_p) = gear.section_properties();
        assert!((own_a / a - 1.0).abs() < 2e-6, "{own_a} {a}");
        assert!((own_p / p - 1.0).abs() < 2e-6, "{own_p} {p}");
        let mass = gear.mass_properties(7850.0);
        assert!((mass.mass / (7850.0 * gear.face_width() * a) - 1.0).abs() < 2e-6);
    }
}

/// A planetary stage of 17, 22 and 61 teeth with module 4 and centre distance 78 runs on its reference circles.
#[test]
fn planetary_stage_of_17_22_61() {
    let (planet, ring) = (external(22, 0.0), ring(61, 0.0));
    let pair = Pair::new(&planet, &ring, 0.078).unwrap();
    assert!((pair.working_pressure_angle().to_degrees() - 20.0).abs() < 1e-12);
    assert!(pair.backlash_base().abs() < 1e-15);
    let a = 20f64.to_radians();
    let rho = |ra: f64, z: f64| (ra * ra - (2.0 * z * a.cos()).powi(2)).sqrt();
    // In mm: radii of the tips 48 and 118.8.
    let path = rho(48.0, 22.0) - rho(118.8, 61.0) + 78.0 * a.sin();
    let eps = path / (4.0 * PI * a.cos());
    assert!(
        (pair.contact_ratio() - eps).abs() < 1e-12,
        "{} {eps}",
        pair.contact_ratio()
    );
    let [w1, w2] = pair.pitch_radii();
    assert!((w1 - 0.044).abs() < 1e-15 && (w2 + 0.122).abs() < 1e-15);
    // Shifted: ISO 21771-1 with z_2 = -61 and x_2 = -0.4.
    let (planet, ring) = (external(22, 0.2), ring_params(61, -0.4));
    let ring = Gear::new(ring).unwrap();
    let closest = Pair::centre_distance_for_backlash(&planet, &ring, 0.0).unwrap();
    let inv_w = inv(a) + 2.0 * a.tan() * (0.2 - 0.4) / (22.0 - 61.0);
    let expected = 0.078 * a.cos() / super::inv_inverse(inv_w).cos();
    assert!((closest - expected).abs() < 1e-12, "{closest} {expected}");
    for backlash in [1e-5, 1e-4] {
        let at = Pair::centre_distance_for_backlash(&planet, &ring, backlash).unwrap();
        let pair = Pair::new(&planet, &ring, at).unwrap();
        assert!((pair.backlash_circ() - backlash).abs() < 1e-14 && at < closest);
    }
}

/// Returns point and outward normal of a flank at length of roll `s`, for a tooth at an angle.
fn on_flank(gear: &Gear, side: Side, angle: f64, s: f64) -> ([f64; 2], [f64; 2]) {
    let base = gear.flank(side).base(angle, s, 0.0);
    let x = gear.flank(side).point(&base, s, 0.0);
    let sign = side.sign();
    ([x.x, x.y], [-sign * base.sin, sign * base.cos])
}

/// Flanks touch in one point with one normal all along the path, and rotate at the ratio of their numbers of teeth.
#[test]
fn flanks_touch_on_the_line_of_action_and_keep_the_ratio() {
    let (planet, ring) = (external(22, 0.2), ring(61, -0.2));
    let distance = Pair::centre_distance_for_backlash(&planet, &ring, 5e-5).unwrap();
    let pair = Pair::new(&planet, &ring, distance).unwrap();
    for side in Side::BOTH {
        let mut first = None;
        for k in 0..=20 {
            let s = pair.s_start() + (pair.s_end() - pair.s_start()) * f64::from(k) / 20.0;
            let (one, two) = (pair.tooth_angle(s, side), pair.mate_position(s, 0.0, side));
            assert!(pair.gap(one, two, side).abs() < 1e-15);
            let (x1, n1) = on_flank(&planet, side, one, s);
            let (x2, n2) = on_flank(&ring, side.opposite(), two, pair.line_length() - s);
            // The ring's axis is on the far side of the pitch point.
            assert!((x1[0] + distance - x2[0]).abs() < 1e-15, "{x1:?} {x2:?}");
            assert!((x1[1] - x2[1]).abs() < 1e-15);
            assert!((n1[0] + n2[0]).abs() < 1e-13 && (n1[1] + n2[1]).abs() < 1e-13);
            let half = ring.half_angle_at(x2[0].hypot(x2[1]));
            let seen = x2[1].atan2(x2[0]) - two;
            assert!(
                (seen + side.sign() * half).abs() < 1e-13,
                "on the mate's other flank"
            );
            let (a, b) = *first.get_or_insert((one, two));
            assert!(((two - b) - (one - a) * 22.0 / 61.0).abs() < 1e-14);
        }
    }
}

#[test]
fn the_order_of_both_gears_does_not_matter() {
    let (planet, ring) = (external(22, 0.2), ring(61, -0.2));
    let one = Pair::new(&planet, &ring, 0.0779).unwrap();
    let two = Pair::new(&ring, &planet, 0.0779).unwrap();
    let same = |x: f64, y: f64| assert!((x - y).abs() < 1e-14, "{x} {y}");
    same(one.contact_ratio(), two.contact_ratio());
    same(one.backlash_base(), two.backlash_base());
    same(one.line_length(), two.line_length());
    same(one.s_start(), one.line_length() - two.s_end());
    same(one.s_end(), one.line_length() - two.s_start());
    same(one.s_pitch(), one.line_length() - two.s_pitch());
    for s in [0.2, 0.7].map(|x| one.s_start() + x * (one.s_end() - one.s_start())) {
        let mirrored = one.line_length() - s;
        same(
            one.tooth_angle(s, Side::Left),
            two.mate_position(mirrored, 0.0, Side::Left),
        );
    }
}
