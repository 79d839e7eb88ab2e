//! Points of concave flanks: gaps to exact involutes and to the lines of action, in either order of the gears.

use super::*;
use gearbench_models::contact::Candidate;
use gearbench_models::geometry::inv;
use gearbench_models::spec::{Body, Passes, PointRule};
use gearbench_tests::{build, candidates, rigid};
use std::f64::consts::TAU;

fn flanked(rows: f64, columns: f64) -> ModelSpec {
    model_of("rigid-flanks-test", [("rows", rows), ("columns", columns)])
}

/// Returns the distance of a point from the exact involute helicoid of the tooth of gear `k` [m].
fn exact_gap(spec: &SceneSpec, scene: &Scene, s: &State, k: usize, c: &Candidate) -> f64 {
    let Body::Gear(g) = &spec.gears[k].body else {
        unreachable!("there is no rack")
    };
    let (x, tooth) = (c.points[1 - k].x, c.points[k].tooth.index as f64);
    // The side of the pinion, which is that of the ring as one looks from its roots.
    let (_, seen) = scene.meshes()[0].search.flank_of(c);
    let side = g.side_from_root(seen).sign();
    let [cx, cy, _] = spec.gears[k].position;
    let (dx, dy, rb) = (x.x - cx, x.y - cy, g.r_base());
    let roll = g.sign() * (dx * dx + dy * dy - rb * rb).sqrt();
    let displacement = scene.phases()[k] + s.q[scene.gears()[k].range().start];
    let helix = g.base_helix_angle();
    let centre = displacement + tooth * g.pitch_angle() + x.z * helix.tan() / rb;
    let half = g.half_angle_base() - inv((roll / rb).atan());
    let turn = side * (dy.atan2(dx) - centre) - half;
    rb * helix.cos() * (turn - TAU * (turn / TAU).round())
}

fn least(scene: &Scene, s: &State) -> [Option<Candidate>; 2] {
    let mut least: [Option<Candidate>; 2] = [None, None];
    for (_, c) in candidates(scene, s) {
        let (_, side) = scene.meshes()[0].search.flank_of(&c);
        let best = &mut least[usize::from(side == Side::Right)];
        if best.is_none_or(|b| c.gap < b.gap) {
            *best = Some(c);
        }
    }
    least
}

fn agrees(name: &str, spec: &SceneSpec, models: &[ModelSpec; 2], slave: usize) {
    let lines = build(spec, &[rigid(), rigid()], &contact(1.5e10));
    let points = PointContact {
        rule: PointRule::Quadrature {
            along: 10,
            across: 2,
        },
        reach: Some(1e-3),
        passes: [Passes::First, Passes::Second][slave],
        ..PointContact::new(1e15)
    };
    let scene = build(spec, models, &touching(points, None));
    let (mut worst, mut count) = ([0.0_f64; 3], 0);
    let pitch = match &spec.gears[0].body {
        Body::Gear(g) => g.pitch_angle(),
        Body::Rack(_) => unreachable!("there is no rack"),
    };
    for i in 0..13 {
        let roll = pitch * (f64::from(i) - 6.0) / 11.0;
        let s = rolled(&scene, spec, roll, (Side::Left, 0.0));
        for (_, c) in candidates(&scene, &s) {
            let exact = exact_gap(spec, &scene, &s, 1 - slave, &c);
            if exact.abs() < 30e-6 {
                worst[0] = worst[0].max((c.gap - exact).abs());
                count += 1;
            }
        }
        let (found, wanted) = (least(&scene, &s), least(&lines, &s));
        for side in 0..2 {
            let (c, w) = (found[side].unwrap(), wanted[side].unwrap());
            worst[1] = worst[1].max((c.gap - w.gap).abs());
            worst[2] = worst[2].max((c.normal - w.normal).norm());
        }
    }
    println!(
        "{name}: {count} gaps off by {:.1e} m, the least by {:.1e} m, its normal by {:.1e}",
        worst[0], worst[1], worst[2]
    );
    assert!(count > 1000, "{name}: {count} candidates");
    assert!(worst[0] < 1e-9, "{name}: gaps off by {:.2e}", worst[0]);
    assert!(worst[1] < 3e-7, "{name}: least off by {:.2e}", worst[1]);
    assert!(worst[2] < 1e-2, "{name}: normal off by {:.2e}", worst[2]);
}

#[test]
fn concave_flanks_have_exact_gaps_and_those_of_the_lines_of_action() {
    for (name, helix, columns) in [("spur", 0.0, 2.0), ("helical", 0.2, 9.0)] {
        let spec = pair_in(0.7, params(helix), Side::Left, 5e-6);
        let fine = flanked(41.0, columns);
        let both = [fine.clone(), fine.clone()];
        agrees(name, &spec, &both, 0);
        agrees(&format!("{name}, points of the ring"), &spec, &both, 1);
        let other = exchanged(spec.clone());
        agrees(&format!("{name}, the ring first"), &other, &both, 0);
        agrees(
            &format!("{name}, a rigid ring"),
            &spec,
            &[fine.clone(), rigid()],
            0,
        );
        agrees(
            &format!("{name}, a rigid pinion"),
            &spec,
            &[rigid(), fine],
            1,
        );
    }
}
