//! Refusals of internal gears and their mates, compared with the overlap of rotating polygons.

use super::internal::Internal;
use super::internal_tests::{external, ring, ring_params};
use super::{Gear, GearParams, GeometryError, InternalError, Pair};

/// Returns the largest depth of points of the mate inside the ring, over a pitch of the mesh with one flank in
/// contact.
fn overlap(mate: &Gear, ring: &Gear, distance: f64) -> f64 {
    let base = ring.r_base() - mate.r_base();
    let alpha = (base / distance).acos();
    // Tooth 0 of the mate touches the right flank of tooth 0 of the ring.
    let phase = |theta: f64| {
        let s = mate.r_base() * (theta + alpha + mate.half_angle_base());
        (s + distance * alpha.sin()) / ring.r_base() - alpha + ring.half_angle_base()
    };
    let outline = mate.outline(120);
    let mut deepest = f64::NEG_INFINITY;
    for k in 0..200 {
        let theta = mate.pitch_angle() * f64::from(k) / 200.0;
        let (sin, cos) = theta.sin_cos();
        let at = phase(theta);
        for [x, y] in &outline {
            let (x, y) = (cos * x - sin * y + distance, sin * x + cos * y);
            let r = x.hypot(y);
            if r <= ring.r_tip() {
                continue;
            }
            let pitch = ring.pitch_angle();
            let off = y.atan2(x) - at;
            let off = off - pitch * (off / pitch).round();
            let into = match r < ring.r_root() {
                true => (ring.half_angle_at(r) - off.abs()) * r,
                false => r - ring.r_root(),
            };
            deepest = deepest.max(into.min(r - ring.r_tip()));
        }
    }
    deepest
}

/// Accepted gears run without overlap, and where tips are reported to collide they do.
#[test]
fn polygons_that_turn_in_each_other_say_the_same() {
    let (mut accepted, mut fouled, mut interfering) = (0, 0, 0);
    for teeth in [41, 60, 90] {
        for less in (2..=14).chain([25, 40]) {
            for (addendum, shift) in [(1.0, 0.0), (0.8, 0.0), (0.6, 0.0), (0.8, 0.3), (0.7, -0.3)] {
                let gear = |teeth, profile_shift, internal| {
                    Gear::new(GearParams {
                        teeth,
                        module: 4e-3,
                        addendum,
                        profile_shift,
                        tip_radius: 0.2,
                        internal,
                        ..GearParams::default()
                    })
                };
                let cutter = Internal {
                    cutter_teeth: Some(teeth / 2),
                    ..Internal::default()
                };
                let (Ok(mate), Ok(ring)) = (
                    gear(teeth - less, 0.0, None),
                    gear(teeth, shift, Some(cutter)),
                ) else {
                    continue;
                };
                let Ok(distance) = Pair::centre_distance_for_backlash(&mate, &ring, 0.0) else {
                    continue;
                };
                let depth = overlap(&mate, &ring, distance);
                match Pair::new(&mate, &ring, distance) {
                    Ok(_) => {
                        accepted += 1;
                        assert!(depth < 2e-8, "{teeth} {less} {addendum}: {depth:e}");
                    }
                    Err(GeometryError::Internal(InternalError::TipsFoul { overlap, .. })) => {
                        fouled += 1;
                        assert!(
                            depth > 0.0 || overlap < 2e-5,
                            "{teeth} {less} {addendum} {shift}: {overlap:e} {depth:e}"
                        );
                    }
                    Err(GeometryError::Interference { below, .. }) => {
                        interfering += 1;
                        assert!(
                            depth > 1e-9 || below < 2e-4,
                            "{teeth} {less} {addendum} {shift}: {below:e} {depth:e}"
                        );
                    }
                    Err(
                        GeometryError::TipRootCollision { .. } | GeometryError::ContactRatio { .. },
                    ) => {}
                    Err(other) => panic!("{teeth} {less} {addendum} {shift}: {other}"),
                }
            }
        }
    }
    assert!(
        accepted > 20 && fouled > 5 && interfering > 5,
        "{accepted} accepted, {fouled} foul, {interfering} interfere"
    );
}

#[test]
fn what_cannot_be_is_refused_with_a_way_out() {
    let with = |change: fn(&mut GearParams, &mut Internal)| {
        let mut p = ring_params(61, 0.0);
        let mut of = p.internal.unwrap();
        change(&mut p, &mut of);
        p.internal = Some(of);
        Gear::new(p).unwrap_err()
    };
    use InternalError as E;
    type Change = fn(&mut GearParams, &mut Internal);
    type Is = fn(&E) -> bool;
    let refusals: [(Change, Is); 9] = [
        (
            |_, of| of.cutter_teeth = Some(61),
            |e| matches!(e, E::CutterTeeth { .. }),
        ),
        (
            |_, of| of.cutter_shift = 2.0,
            |e| matches!(e, E::CutterShift { .. }),
        ),
        (
            |_, of| of.root_circle = Some(0.16),
            |e| matches!(e, E::CutterTip { .. }),
        ),
        (
            |p, _| p.addendum = 1.9,
            |e| matches!(e, E::TipWithinBase { .. }),
        ),
        (
            |p, of| {
                (p.dedendum, p.tip_radius) = (1.0, 0.1);
                of.cutter_teeth = Some(12);
            },
            |e| matches!(e, E::CutterBase { .. }),
        ),
        (
            |_, of| of.cutter_teeth = Some(57),
            |e| matches!(e, E::CutterFouls { .. }),
        ),
        (
            |_, of| of.rim_radius = Some(0.12),
            |e| matches!(e, E::Rim { .. }),
        ),
        (|p, _| p.bore_radius = 0.01, |e| matches!(e, E::Bore)),
        (
            |p, _| p.tip_cone_angle = 0.1,
            |e| matches!(e, E::Not { .. }),
        ),
    ];
    for (i, (change, is)) in refusals.into_iter().enumerate() {
        match with(change) {
            GeometryError::Internal(why) => assert!(is(&why), "{i}: {why:?}"),
            other => panic!("{i}: {other}"),
        }
    }
    assert!(matches!(
        with(|p, _| p.tip_radius = 2.0),
        GeometryError::TipRadius { max_factor, .. } if max_factor > 0.2 && max_factor < 0.8
    ));
    let (planet, ring) = (external(22, 0.0), ring(61, 0.0));
    let refused = |one: &Gear, two: &Gear, a: f64| match Pair::new(one, two, a).unwrap_err() {
        GeometryError::Internal(why) => why,
        other => panic!("{other}"),
    };
    assert!(matches!(refused(&ring, &ring, 0.078), E::BothInternal));
    assert!(matches!(
        refused(&external(70, 0.0), &ring, 0.078),
        E::ToothDifference { .. }
    ));
    assert!(matches!(
        refused(&planet, &ring, 0.0729),
        E::DistanceTooSmall { .. }
    ));
    let E::FlanksOverlap { greatest, .. } = refused(&ring, &planet, 0.0785) else {
        panic!("flanks overlap")
    };
    assert!((greatest - 0.078).abs() < 1e-12);
    let thin = GearParams {
        addendum: 0.5,
        ..planet.params().clone()
    };
    let thin = Gear::new(thin).unwrap();
    let E::NoEngagement { least, .. } = refused(&thin, &ring, 0.0733) else {
        panic!("no engagement")
    };
    assert!(matches!(
        refused(&thin, &ring, 0.9999 * least),
        E::NoEngagement { .. }
    ));
}
