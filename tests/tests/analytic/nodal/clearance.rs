//! The clearance of rigid flanks is below the gap of every point, near the smallest, and linear in the displacements.

use super::*;
use gearbench_models::geometry::{GearParams, Side};
use gearbench_models::spec::Body;

#[test]
fn no_point_is_nearer_than_the_clearance() {
    let helical = GearParams {
        helix_angle: 0.2,
        ..spur(20)
    };
    let distance = 4e-3 * 25.0 / 0.2_f64.cos() + 1e-4;
    let helical_pair = |gap| {
        let wheel = GearParams {
            teeth: 30,
            helix_angle: -0.2,
            ..helical.clone()
        };
        pair_of(
            gear("a", helical, 0.0, 0.0),
            gear("b", wheel, distance, 0.0),
            start(Side::Left, gap),
        )
    };
    let with_rack = |gap| {
        pair_of(
            gear("a", spur(20), 0.0, 0.0),
            rack("r", 15, 0.04005, 0.0),
            start(Side::Right, gap),
        )
    };
    let gap = 8e-6;
    for (name, spec, surface) in [
        ("spur", case_a(gap), SurfaceKind::Smooth),
        ("spur", case_a(gap), SurfaceKind::Faceted),
        ("helical", helical_pair(gap), SurfaceKind::Smooth),
        ("rack", with_rack(gap), SurfaceKind::Smooth),
        ("rack", with_rack(gap), SurfaceKind::Faceted),
    ] {
        let points = PointContact {
            surface,
            rule: quadrature(6, 3),
            passes: Passes::Both,
            reach: Some(1e-4),
            ..PointContact::new(1e15)
        };
        let rows = 21;
        let model = toy(rows, 5, 2, 0.0);
        let scene = build(&spec, &[model.clone(), model], &with_points(points));
        let search = scene.meshes()[0].search.points().unwrap();
        let begin = search.clearance([0.0; 2]).expect("flanks move rigidly");
        let (mut tightest, mut loosest) = (f64::INFINITY, 0.0_f64);
        for step in 0..40 {
            let mut s = scene.initial();
            roll(&spec, &scene, &mut s, 0.04 * f64::from(step));
            // Shift contact from one flank to the other, through the backlash.
            let second = scene.gears()[1].range().start;
            s.q[second] +=
                [-1e-6, 0.0, 1e-6, 5e-6][step as usize % 4] / effective_radius(&spec.gears[1].body);
            let displacements = [s.q[0], s.q[second]];
            let here = search.clearance(displacements).unwrap();
            let linear = begin.after(displacements) - here.gaps[0].min(here.gaps[1]);
            assert!(linear.abs() < 1e-12, "{name}: {linear:e}");
            for (slot, clearance) in here.gaps.into_iter().enumerate() {
                let gaps = candidates(&scene, &s).into_iter().map(|(_, c)| c);
                let of_side = gaps.filter(|c| c.slot == slot);
                let least = of_side.fold(f64::INFINITY, |m, c| m.min(c.gap));
                if least.is_finite() {
                    tightest = tightest.min(least - clearance);
                    loosest = loosest.max(least - clearance);
                }
            }
        }
        // Facets touch late: a chord lies inside by its sagitta on both flanks.
        let radius = match &spec.gears[0].body {
            Body::Gear(g) => g.r_base() * 0.3,
            Body::Rack(_) => unreachable!(),
        };
        println!(
            "{name} {surface:?}: least gap above the clearance by {:.2e} to {:.2e} m",
            tightest, loosest
        );
        assert!(tightest > -1e-12, "{name} {surface:?}: {tightest:e}");
        let chord = 9e-3 / (rows - 1) as f64;
        let margin = if surface == SurfaceKind::Faceted {
            12.0
        } else {
            3.0
        };
        assert!(
            loosest < margin * chord * chord / (8.0 * radius),
            "{loosest:e}"
        );
    }
}
