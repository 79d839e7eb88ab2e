//! Positions of contact points: exact gaps, areas, edges, widths, and the cost of the search.

use super::*;
/// Rigid smooth flanks over a mesh cycle. The gap of every candidate is its distance from the exact flank, and
/// the least gap of each side is that of the lines of action: the points stand beside the point of contact
/// by at most half their spacing `x`, which costs `x^2 / (2 rho)`.
fn agrees(name: &str, spec: &SceneSpec, models: &[ModelSpec], slave: usize, tolerance: f64) {
    let rigid = vec![rigid(); 2];
    let lines = build(spec, &rigid, &contact(1.5e10));
    let points = PointContact {
        rule: PointRule::Quadrature {
            along: 10,
            across: 2,
        },
        reach: Some(1e-3),
        passes: [Passes::First, Passes::Second][slave],
        ..PointContact::new(1e15)
    };
    let scene = build(spec, models, &with_points(points));
    let (mut worst, mut count) = ([0.0_f64; 3], 0);
    for i in 0..13 {
        let s = roll(spec, &scene, -0.17 + 0.0286 * f64::from(i));
        for (_, c) in candidates(&scene, &s) {
            let exact = exact_gap(spec, &scene, &s, 1 - slave, &c);
            if exact.abs() < 30e-6 {
                worst[0] = worst[0].max((c.gap - exact).abs());
                count += 1;
            }
        }
        let (found, wanted) = (least_gaps(&scene, &s), least_gaps(&lines, &s));
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
    assert!(worst[0] < tolerance, "{name}: gaps off by {:.2e}", worst[0]);
    assert!(worst[1] < 3e-7, "{name}: least off by {:.2e}", worst[1]);
    assert!(worst[2] < 1e-2, "{name}: normal off by {:.2e}", worst[2]);
}

#[test]
fn rigid_smooth_flanks_have_exact_gaps_and_those_of_the_lines_of_action() {
    let m = |rows, columns| flanked("rigid-flanks-test", rows, columns);
    let pair = |pa: GearParams, pb: GearParams, distance: f64| {
        pair_of(
            gear("a", pa, 0.0, 0.0),
            gear("b", pb, distance, 0.0),
            start(Side::Left, 5e-6),
        )
    };
    let plain = pair(spur(20), spur(30), 0.1001);
    agrees("both", &plain, &[m(41, 2), m(41, 2)], 0, 1e-9);
    agrees("first", &plain, &[m(41, 2), rigid()], 0, 1e-9);
    agrees("second", &plain, &[rigid(), m(41, 2)], 1, 1e-9);
    let beta = 0.3;
    let (a, b) = (helical(spur(20), beta), helical(spur(30), -beta));
    let slanted = pair(a, b, 0.1001 / beta.cos());
    agrees("helical", &slanted, &[m(41, 9), m(41, 9)], 0, 1e-9);
    let with_rack = pair_of(
        gear("a", spur(20), 0.0, 0.0),
        rack("r", 15, 0.04005, 0.0),
        start(Side::Left, 5e-6),
    );
    agrees("rack", &with_rack, &[m(41, 2), rigid()], 0, 1e-9);
    agrees("its own", &with_rack, &[rigid(), m(9, 3)], 1, 1e-9);
    let mut slanted = with_rack;
    slanted.gears[0] = gear("a", helical(spur(20), beta), 0.0, 0.0);
    slanted.gears[1].position[0] = 0.04 / beta.cos() + 5e-5;
    let Body::Rack(r) = &slanted.gears[1].body else {
        unreachable!()
    };
    let params = RackParams {
        helix_angle: -beta,
        ..r.params().clone()
    };
    slanted.gears[1].body = Body::Rack(Rack::new(params).unwrap());
    agrees("helical rack", &slanted, &[m(41, 9), m(9, 3)], 0, 1e-9);
    agrees("its points", &slanted, &[rigid(), m(9, 3)], 1, 1e-9);
}

pub(super) fn helical(params: GearParams, angle: f64) -> GearParams {
    GearParams {
        helix_angle: angle,
        ..params
    }
}

/// Returns the smallest gap of each side over all candidates, and the largest angle of normals to the line of action.
fn least_gaps(scene: &Scene, s: &State) -> [Option<Candidate>; 2] {
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

/// Returns the distance of a point from the exact involute helicoid (rack: plane) of a gear's tooth [m].
fn exact_gap(spec: &SceneSpec, scene: &Scene, s: &State, k: usize, c: &Candidate) -> f64 {
    let x = c.points[1 - k].x;
    let tooth = c.points[k].tooth.index as f64;
    let (_, side) = scene.meshes()[0].search.flank_of(c);
    let displacement = scene.phases()[k] + s.q[scene.gears()[k].range().start];
    let [cx, cy, _] = spec.gears[k].position;
    match &spec.gears[k].body {
        Body::Gear(g) => {
            let (rb, tan) = (g.r_base(), g.base_helix_angle().tan());
            let (dx, dy) = (x.x - cx, x.y - cy);
            let roll = (dx * dx + dy * dy - rb * rb).sqrt();
            let base = dy.atan2(dx) + side.sign() * inv((roll / rb).atan());
            let centre = displacement + tooth * g.pitch_angle() + x.z * tan / rb;
            let turn = base - centre - side.sign() * g.half_angle_base();
            let turn = turn - TAU * (turn / TAU).round();
            rb * side.sign() * turn * g.base_helix_angle().cos()
        }
        Body::Rack(r) => {
            // Facing -x: the slide is +y, the left flank of a tooth is its lower one.
            let alpha = r.transverse_pressure_angle();
            let height = cx - x.x;
            let half = r.half_thickness_reference() - height * alpha.tan();
            let centre = cy + displacement + tooth * r.pitch() - x.z * r.params().helix_angle.tan();
            (-side.sign() * (x.y - centre) - half) * alpha.cos() * r.base_helix_angle().cos()
        }
    }
}

/// The points of a flank stand for its area: `b` times the length of the involute, `(s_a^2 - s_f^2) / (2 r_b)`.
#[test]
fn points_stand_for_the_whole_flank() {
    let spec = case_a(0.0);
    let Body::Gear(g) = &spec.gears[0].body else {
        unreachable!()
    };
    let length = (g.roll_length_tip().powi(2) - g.roll_length_form().powi(2)) / (2.0 * g.r_base());
    for rule in [PointRule::Nodes, quadrature(1, 1), quadrature(3, 2)] {
        let grids = flank_test_gears::grids(g, 41, 4);
        let areas = gearbench_models::contact::points::reference_areas(&grids, 0, rule);
        let sum: f64 = areas.iter().sum();
        let exact = g.face_width() * length;
        assert!((sum / exact - 1.0).abs() < 1e-4, "{rule:?}: {sum} {exact}");
    }
}

/// An edge that meets the other flank between its points is felt by the other pass: the tip of the wheel comes
/// down on the pinion's flank before the path of contact begins.
#[test]
fn an_edge_between_points_is_felt_by_the_other_pass() {
    let mut spec = case_a(-3e-6);
    let layout = mesh_layout(&spec.gears[0], &spec.gears[1]).unwrap();
    spec.meshes[0].start.path_coordinate = Some(layout.path[0]);
    let model = |rows| flanked("rigid-flanks-test", rows, 2);
    let scene = |rule, passes| {
        let points = PointContact {
            rule,
            passes,
            ..PointContact::new(1e15)
        };
        build(&spec, &[model(12), model(161)], &with_points(points))
    };
    let coarse = scene(PointRule::Nodes, Passes::First);
    let fine = scene(quadrature(3, 2), Passes::Second);
    let both = scene(PointRule::Nodes, Passes::Both);
    let (mut missed, mut felt) = (0, 0);
    for i in 0..60 {
        let s = roll(&spec, &coarse, -2e-4 * f64::from(i));
        let force = |scene: &Scene| {
            let all = candidates(scene, &s).into_iter();
            force_of(
                &all.filter(|(_, c)| c.points[0].tooth.index == 0)
                    .collect::<Vec<_>>(),
            )
        };
        if force(&fine) > 1.0 {
            assert!(force(&both) > 0.0, "place {i}");
            felt += 1;
            missed += usize::from(force(&coarse) == 0.0);
        }
    }
    println!("at {felt} places the edge presses, at {missed} of them between the points");
    assert!(missed >= 3 && felt > missed, "{felt} {missed}");
}

/// A point that slides over the tip edge leaves contact without a jump of force.
#[test]
fn points_leave_over_the_tip_without_a_jump() {
    let mut spec = case_a(-3e-6);
    let layout = mesh_layout(&spec.gears[0], &spec.gears[1]).unwrap();
    spec.meshes[0].start.path_coordinate = Some(layout.path[0]);
    let points = PointContact {
        rule: quadrature(2, 2),
        ..PointContact::new(1e15)
    };
    let model = |rows| flanked("rigid-flanks-test", rows, 2);
    let scene = build(&spec, &[model(31), model(31)], &with_points(points));
    let (mut last, mut jump, mut most): (Option<f64>, f64, f64) = (None, 0.0, 0.0);
    for i in 0..2000 {
        let s = roll(&spec, &scene, 0.01 * (f64::from(i) / 1000.0 - 1.0));
        let all = candidates(&scene, &s);
        let of_tooth: Vec<_> = all
            .into_iter()
            .filter(|(_, c)| c.points[0].tooth.index == 0)
            .collect();
        let force = force_of(&of_tooth);
        if let Some(last) = last {
            jump = jump.max((force - last).abs());
        }
        most = most.max(force);
        last = Some(force);
    }
    println!("largest jump {jump:.2} N of {most:.1} N");
    assert!(most > 10.0 && jump < 0.01 * most, "{jump} of {most}");
}

/// Faces that reach beyond the other gear's width are open there, and the force is that of the common width.
#[test]
fn only_the_common_width_touches() {
    let force = |widths: [f64; 2]| {
        let mut spec = case_a(-4e-6);
        for (g, width) in spec.gears.iter_mut().zip(widths) {
            let Body::Gear(body) = &g.body else {
                unreachable!()
            };
            let params = GearParams {
                face_width: width,
                ..body.params().clone()
            };
            g.body = Body::Gear(Gear::new(params).unwrap());
        }
        let points = PointContact {
            rule: quadrature(3, 6),
            ..PointContact::new(1e15)
        };
        let (_, found, _) = rigid_pair(&spec, [41, 6], points);
        assert!(found.iter().all(|(_, c)| c.points[1].x.z.abs() < 0.0051));
        force_of(&found)
    };
    let (whole, narrow) = (force([10e-3, 10e-3]), force([20e-3, 10e-3]));
    println!("{whole:.1} N, {narrow:.1} N");
    // Points over a wider gear meet the edge of the narrow one to within their spacing.
    assert!((narrow / whole - 1.0).abs() < 0.08, "{narrow} {whole}");
}

/// The work depends on the number of teeth near the line of centres, not on the number of teeth; times are printed.
#[test]
fn the_cost_follows_the_active_flanks() {
    for (z, distance) in [([20, 30], 0.1001), ([80, 120], 0.4001)] {
        let spec = pair_of(
            gear("a", spur(z[0]), 0.0, 0.0),
            gear("b", spur(z[1]), distance, 0.0),
            start(Side::Left, -4e-6),
        );
        let points = PointContact {
            passes: Passes::First,
            ..PointContact::new(1e15)
        };
        let (scene, _, s) = rigid_pair(&spec, [21, 7], points);
        let mesh = &scene.meshes()[0];
        let gear_state = |k: usize| GearState {
            gear: scene.gears()[k].model.as_ref(),
            at: scene.gears()[k].at(s.at()),
        };
        let mut found = Vec::new();
        let wanted = CandidateSelection::Touching(0.0);
        mesh.search
            .candidates(gear_state(0), gear_state(1), &[], wanted, &mut found);
        let work = mesh.search.points().unwrap().work();
        assert!(!found.is_empty());
        assert!(work.flanks <= 12, "{work:?}");
        assert!(work.points < work.nodes, "{work:?}");
    }
}
