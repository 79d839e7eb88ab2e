//! Sweeps over the parameter space, with a valid geometry or a refusal but never a panic, and identities of every
//! accepted pair.

use super::*;

/// A deterministic generator (xorshift64*), so that sweeps repeat.
struct Random(u64);

impl Random {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        let bits = self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11;
        low + (high - low) * bits as f64 / (1u64 << 53) as f64
    }
}

fn random_params(random: &mut Random) -> GearParams {
    GearParams {
        teeth: random.between(3.0, 101.0) as u32,
        module: 10f64.powf(random.between(-4.0, -1.5)),
        pressure_angle: random.between(0.2, 0.55),
        profile_shift: random.between(-1.5, 2.0),
        helix_angle: random.between(-0.7, 0.7),
        face_width: random.between(1e-3, 1e-1),
        addendum: random.between(0.3, 1.5),
        dedendum: random.between(0.5, 1.8),
        tip_radius: random.between(0.0, 0.5),
        thinning: random.between(0.0, 2e-5),
        ..GearParams::default()
    }
}

/// Checks the properties of an accepted gear.
fn sound(gear: &Gear) {
    let p = gear.params();
    let (root, form, tip) = (gear.r_root(), gear.r_form(), gear.r_tip());
    assert!(0.0 < root && root < form && form < tip, "{p:?}");
    assert!(form >= gear.r_base(), "{p:?}");
    let mut last = 0.5 * gear.pitch_angle() * (1.0 + 1e-12);
    for k in 0..=60 {
        let r = root + (tip - root) * f64::from(k) / 60.0;
        let half = gear.half_angle_at(r);
        assert!(
            half > 0.0 && half <= last,
            "{half} after {last} at {r}: {p:?}"
        );
        // Without undercut a tooth thins towards its tip.
        last = half;
    }
    assert_eq!(gear.half_angle_at(2.0 * tip), gear.half_angle_at(tip));
    assert_eq!(gear.half_angle_at(0.0), gear.half_angle_at(root));
    let mass = gear.mass_properties(7850.0);
    let per_area = 7850.0 * gear.face_width() * std::f64::consts::PI;
    assert!(mass.mass > per_area * root * root && mass.mass < per_area * tip * tip);
    assert!(mass.izz > 0.5 * mass.mass * root * root * 0.5 && mass.izz < mass.mass * tip * tip);
}

#[test]
fn standard_gears_over_teeth_and_shift() {
    let mut accepted = 0;
    for teeth in 8..=100 {
        for step in -20..=20 {
            let params = GearParams {
                teeth,
                module: 3e-3,
                profile_shift: f64::from(step) * 0.1,
                ..GearParams::default()
            };
            if let Ok(gear) = Gear::new(params) {
                sound(&gear);
                accepted += 1;
            }
        }
    }
    // Roughly x from the undercut limit (below 0 for many teeth) to the pointed limit.
    assert!(accepted > 1500, "{accepted}");
}

#[test]
fn random_gears_are_sound_or_refused() {
    let mut random = Random(0x9E37_79B9_7F4A_7C15);
    let mut accepted = 0;
    for _ in 0..20_000 {
        if let Ok(gear) = Gear::new(random_params(&mut random)) {
            sound(&gear);
            accepted += 1;
        }
    }
    assert!(accepted > 2000, "{accepted}");
}

#[test]
fn random_pairs_are_sound_or_refused() {
    let mut random = Random(0x1234_5678_9ABC_DEF1);
    let mut accepted = 0;
    for _ in 0..20_000 {
        let one = random_params(&mut random);
        let two = GearParams {
            teeth: random.between(8.0, 101.0) as u32,
            profile_shift: random.between(-0.5, 1.0),
            helix_angle: -one.helix_angle,
            ..one.clone()
        };
        let (Ok(one), Ok(two)) = (Gear::new(one), Gear::new(two)) else {
            continue;
        };
        let wide = random.between(-0.5, 1.5) * one.params().module;
        let a = one.r_reference() + two.r_reference() + wide;
        if let Ok(pair) = Pair::new(&one, &two, a) {
            consistent(&pair, &one, &two);
            accepted += 1;
        }
        let exact = Pair::centre_distance_for_backlash(&one, &two, 1e-6 * a);
        if let Ok(pair) = exact.and_then(|a| Pair::new(&one, &two, a)) {
            let error = pair.backlash_circ() - 1e-6 * a;
            assert!(error.abs() < 1e-12 * a, "{error} at {a}");
        }
    }
    assert!(accepted > 400, "{accepted}");
}

/// Checks the identities of an accepted pair.
fn consistent(pair: &Pair, one: &Gear, two: &Gear) {
    let a = pair.centre_distance();
    let tight = 1e-11 * a;
    let [rw1, rw2] = pair.pitch_radii();
    assert!((rw1 + rw2 - a).abs() < tight);
    let (start, end) = (pair.s_start(), pair.s_end());
    assert!(0.0 <= start + tight && start < end && end <= pair.line_length() + tight);
    assert!(pair.total_contact_ratio() >= 1.0 && pair.backlash_circ() >= 0.0);
    // s_1 + s_2 = L: the point at s on gear 1 is the point at L - s on gear 2.
    for k in 0..=4 {
        let s = start + (end - start) * f64::from(k) / 4.0;
        for side in Side::BOTH {
            let (t1, t2) = (pair.tooth_angle(s, side), pair.mate_position(s, 0.0, side));
            assert!((pair.path_coordinate(t1, side) - s).abs() < tight);
            assert!(pair.gap(t1, t2, side).abs() < tight);
            touch_in_the_plane(pair, [one, two], [t1, t2], s, side);
        }
    }
    // With one flank closed the other is open by the backlash along the line of action, in the
    // tooth space next to it.
    let s = pair.s_pitch();
    let (t1, t2) = (
        pair.tooth_angle(s, Side::Left),
        pair.mate_position(s, 0.0, Side::Left),
    );
    let next = t2 + two.pitch_angle();
    let open = pair.gap(t1, next, Side::Right);
    assert!((open - pair.backlash_base()).abs() < 10.0 * tight, "{open}");
}

/// Places both flank points from radius and half angle alone and checks that they coincide.
fn touch_in_the_plane(pair: &Pair, gears: [&Gear; 2], theta: [f64; 2], s: f64, side: Side) {
    let roll = [s, pair.line_length() - s];
    let centre = [0.0, pair.centre_distance()];
    let point = [0, 1].map(|i| {
        let r = gears[i].r_base().hypot(roll[i]);
        // The flank of `side` stands counter-clockwise of the centreline for the left one.
        let angle = theta[i] + side.sign() * gears[i].half_angle_at(r);
        [centre[i] + r * angle.cos(), r * angle.sin()]
    });
    let apart = (point[0][0] - point[1][0]).hypot(point[0][1] - point[1][1]);
    // Near the form circle half_angle_at may already stand on the fillet by rounding.
    assert!(
        apart < 1e-9 * pair.centre_distance(),
        "{apart} m apart at s = {s}"
    );
}

#[test]
fn random_rack_pairs_are_sound_or_refused() {
    let mut random = Random(0x0F0F_1234_ABCD_0001);
    let mut accepted = 0;
    for _ in 0..20_000 {
        let params = random_params(&mut random);
        let rack = RackParams {
            teeth: random.between(0.0, 12.0) as u32,
            module: params.module,
            pressure_angle: params.pressure_angle,
            face_width: params.face_width,
            addendum: random.between(0.4, 1.1),
            dedendum: random.between(1.0, 1.4),
            tip_radius: random.between(0.0, 0.4),
            thinning: params.thinning,
            body_height: params.module,
            helix_angle: -params.helix_angle,
        };
        let (Ok(gear), Ok(rack)) = (Gear::new(params), Rack::new(rack)) else {
            continue;
        };
        rack_is_sound(&rack);
        let p = gear.params();
        let d = gear.r_reference() + p.module * (p.profile_shift + random.between(-0.05, 0.3));
        let Ok(pair) = Pair::new(&gear, &rack, d) else {
            continue;
        };
        accepted += 1;
        for side in Side::BOTH {
            let s = pair.s_start() + (pair.s_end() - pair.s_start()) * random.between(0.0, 1.0);
            let (theta, y) = (pair.tooth_angle(s, side), pair.mate_position(s, 0.0, side));
            assert!(pair.gap(theta, y, side).abs() < 1e-12);
            // Both points in the plane.
            let r = gear.r_base().hypot(s);
            let angle = theta + side.sign() * gear.half_angle_at(r);
            let x = r * angle.cos();
            // The rack flank that faces this side of the gear tooth.
            let flank = y - side.sign() * rack.half_thickness_at(d - x);
            assert!((r * angle.sin() - flank).abs() < 1e-9 * d, "{side:?} {d}");
        }
        let theta = pair.tooth_angle(pair.s_pitch(), Side::Left);
        let y = pair.mate_position(pair.s_pitch(), 0.0, Side::Left) - rack.pitch();
        let open = pair.gap(theta, y, Side::Right);
        assert!((open - pair.backlash_base()).abs() < 1e-12, "{open}");
    }
    assert!(accepted > 300, "{accepted}");
}

fn rack_is_sound(rack: &Rack) {
    let polygon = rack.outline(200);
    let area: f64 = (0..polygon.len())
        .map(|i| {
            let ([x0, y0], [x1, y1]) = (polygon[i], polygon[(i + 1) % polygon.len()]);
            0.5 * (x0 * y1 - x1 * y0)
        })
        .sum();
    let exact = rack.mass(7850.0) / (7850.0 * rack.face_width());
    assert!((area / exact - 1.0).abs() < 1e-5, "{area} against {exact}");
}
