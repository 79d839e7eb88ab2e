//! Separations compared with the rotation of a mate that brings its flank to a point, and with limits.

use super::*;

/// Gears of 20 and 30 teeth, module 4 mm, pressure angle 20 degrees, in the view of either of them.
fn engagements() -> [Engagement; 2] {
    let alpha = 20.0_f64.to_radians();
    let rb = [0.04 * alpha.cos(), 0.06 * alpha.cos()];
    let tip = [0.044_f64, 0.064].map(|r| r);
    let roll = [0, 1].map(|k| (tip[k] * tip[k] - rb[k] * rb[k]).sqrt());
    [0, 1].map(|k| Engagement {
        base_radius: Some(rb[k]),
        mate_base_radius: Some(rb[1 - k]),
        length: (rb[0] + rb[1]) * alpha.tan(),
        tip: roll[k],
        mate_tip: roll[1 - k],
        pressure_angle: alpha,
        helix_cos: 1.0,
        base_pitch: std::f64::consts::PI * 4e-3 * alpha.cos(),
    })
}

/// The separation equals the smallest rotation of the mate that brings its flank, a polyline, to the tip; it is found
/// by bisection of the side on which the tip lies.
#[test]
fn separation_is_the_turn_that_brings_the_mate_to_the_edge() {
    for of in engagements() {
        let (rb, rm) = (of.base_radius.unwrap(), of.mate_base_radius.unwrap());
        for u in [2e-4, 5e-4, 1e-3, 1.5e-3] {
            let turn = u / rb;
            let (sin, cos) = turn.sin_cos();
            // The tip on the line of action, turned on about the gear's centre, seen from the mate's centre.
            let tip = [rb * cos - of.tip * sin, rb * sin + of.tip * cos];
            let p = [tip[0] - rb - rm, tip[1] - of.length];
            let radius = p[0].hypot(p[1]);
            // The mate's involute at path coordinate s_m, by its polar angle at this radius.
            let roll = (radius * radius - rm * rm).sqrt();
            let flank_angle = |s_m: f64| {
                let base = std::f64::consts::PI + s_m / rm - roll / rm;
                base + (roll / rm).atan()
            };
            let angle = p[1].atan2(p[0]).rem_euclid(std::f64::consts::TAU);
            let (mut low, mut high) = (0.0, of.length);
            for _ in 0..100 {
                let middle = 0.5 * (low + high);
                if flank_angle(middle) < angle {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            let want = low + of.tip + u - of.length;
            let got = of.of_point(of.tip, of.tip + u).unwrap().0;
            assert!(
                (got - want).abs() < 1e-14 && got > 0.0,
                "{u}: {got:e} {want:e}"
            );
        }
    }
}

#[test]
fn the_edge_leaves_smoothly_and_the_table_has_its_slopes() {
    for of in engagements() {
        let e = Separation::new(&of, 0.0, 2, None);
        let [tip, end] = e.edge();
        assert!((e.eval(tip)[0], e.eval(tip)[1]) == (0.0, 0.0));
        let (along, follows) = ((end - tip) / of.base_pitch, e.eval(end)[0]);
        assert!(along > 0.05 && along <= 0.5, "{along}");
        // As far as no load closes, half a base pitch, or the mate's own tip.
        assert!(follows <= FOLLOWED * of.base_pitch + 1e-9, "{follows:e}");
        assert!(follows > 1e-4, "{follows:e}");
        for i in 1..200 {
            let s = tip + (end - tip) * f64::from(i) / 201.0;
            let exact = of.of_point(of.tip, s).unwrap();
            let [value, slope, curvature] = e.eval(s);
            assert!((value - exact.0).abs() < 1e-11, "{value:e} {exact:?}");
            assert!((slope - exact.1).abs() < 1e-5, "{slope:e} {exact:?}");
            let h = 1e-7;
            let by = (e.eval(s + h)[1] - e.eval(s - h)[1]) / (2.0 * h);
            assert!((by - curvature).abs() < 1e-2 * curvature.abs().max(1.0));
        }
    }
}

#[test]
fn a_rack_is_the_limit_of_a_large_gear() {
    let [of, _] = engagements();
    let alpha = of.pressure_angle;
    let (from_pitch, mate_tip) = (9e-3, 9e-3);
    let on_rack = Engagement {
        mate_base_radius: None,
        ..of
    };
    let large = Engagement {
        mate_base_radius: Some(1e5),
        mate_tip: 1e5 * alpha.tan() + mate_tip,
        length: of.base_radius.unwrap() * alpha.tan() + 1e5 * alpha.tan(),
        ..of
    };
    for u in [3e-4, 1e-3] {
        let [a, b] = [on_rack, large].map(|e| e.of_point(of.tip, of.tip + u).unwrap());
        assert!(
            (a.0 - b.0).abs() < 1e-9 && (a.1 - b.1).abs() < 1e-6,
            "{a:?} {b:?}"
        );
    }
    // A rack's own tip on the gear: path coordinates from the pitch point, and from far away.
    let gear = of.base_radius.unwrap();
    let rack = Engagement {
        base_radius: None,
        mate_base_radius: Some(gear),
        length: gear * alpha.tan(),
        tip: from_pitch,
        mate_tip: of.tip,
        ..of
    };
    let far = 1e5 * alpha.tan();
    let like = Engagement {
        base_radius: Some(1e5),
        length: rack.length + far,
        tip: from_pitch + far,
        ..rack
    };
    for u in [3e-4, 1e-3] {
        let a = rack.of_point(from_pitch, from_pitch + u).unwrap();
        let b = like
            .of_point(from_pitch + far, from_pitch + far + u)
            .unwrap();
        assert!(
            (a.0 - b.0).abs() < 1e-8 && (a.1 - b.1).abs() < 1e-5,
            "{a:?} {b:?}"
        );
    }
}

#[test]
fn a_relief_is_kept_where_it_is_smooth() {
    let [of, _] = engagements();
    let start = of.tip - 3e-3;
    let removed = |rho: f64| 20e-6 * ((rho - start) / (of.tip - start)).max(0.0);
    let e = Separation::new(&of, 0.2 * of.tip, 257, Some(&removed));
    // Far from its start and from the tip, the separation is the relief less the shift by the contact.
    let s = of.tip - 1.5e-3;
    let (value, plain) = (e.eval(s)[0], removed(s));
    assert!(
        value <= plain && plain - value < 2e-6,
        "{value:e} {plain:e}"
    );
    assert!(e.eval(start - 1e-3)[0].abs() < 1e-12);
    // At the edge the separation exceeds the whole relief.
    let [tip, end] = e.edge();
    assert!(e.eval(0.5 * (tip + end))[0] > 20e-6);
    for i in 0..300 {
        let s = 0.3 * of.tip + (end - 0.3 * of.tip) * f64::from(i) / 299.0;
        assert!(e.lowest() <= e.eval(s)[0]);
    }
}
