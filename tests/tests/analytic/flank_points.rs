//! Contact of flank points: gaps and normals on exact involutes against the lines of action, forces, rows,
//! moments, edges.

use gearbench_integrators::system::Coeffs;
use gearbench_integrators::{Outputs, SecondOrderSystem, State};
use gearbench_models::contact::candidate::Candidate;
use gearbench_models::contact::flank_points::{Passes, PointContact, PointRule, SurfaceKind};
use gearbench_models::contact::search::{Party, Wanted};
use gearbench_models::geometry::{GearParams, Side, inv};
use gearbench_models::scene::Scene;
use gearbench_models::scene::build::{lever, mesh_layout};
use gearbench_models::scene::spec::{Body, ContactSpec, ModelSpec, Parameters, SceneSpec, Value};
use gearbench_tests::*;
use std::f64::consts::TAU;

fn flanked(id: &str, rows: usize, columns: usize) -> ModelSpec {
    ModelSpec {
        id: id.into(),
        parameters: Parameters::from([
            ("rows".to_string(), Value::Number(rows as f64)),
            ("columns".to_string(), Value::Number(columns as f64)),
        ]),
    }
}

fn with_points(points: PointContact) -> ContactSpec {
    ContactSpec {
        points: Some(points),
        ..contact(1.5e10)
    }
}

/// Turns both hubs as if rolling, by an angle of the first.
fn roll(spec: &SceneSpec, scene: &Scene, angle: f64) -> State {
    let mut s = scene.initial();
    let travel = angle * lever(&spec.gears[0].body);
    for (k, g) in scene.gears().iter().enumerate() {
        let rack = g.model.hub().slide.is_some();
        let sign = if rack || k == 0 { 1.0 } else { -1.0 };
        s.q[g.range().start] += sign * travel / lever(&spec.gears[k].body);
    }
    s
}

fn helical(params: GearParams, angle: f64) -> GearParams {
    GearParams {
        helix_angle: angle,
        ..params
    }
}

/// Least gap of each side over all candidates, and how far normals are from the line of action.
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

/// Distance of a point from the exact involute helicoid (rack: plane) of a gear's tooth [m].
fn exact_gap(spec: &SceneSpec, scene: &Scene, s: &State, k: usize, c: &Candidate) -> f64 {
    let x = c.points[1 - k].x;
    let tooth = c.points[k].tooth.index as f64;
    let (_, side) = scene.meshes()[0].search.flank_of(c);
    let travel = scene.phases()[k] + s.q[scene.gears()[k].range().start];
    let [cx, cy] = spec.gears[k].position;
    match &spec.gears[k].body {
        Body::Gear(g) => {
            let (rb, tan) = (g.r_base(), g.base_helix_angle().tan());
            let (dx, dy) = (x.x - cx, x.y - cy);
            let roll = (dx * dx + dy * dy - rb * rb).sqrt();
            let base = dy.atan2(dx) + side.sign() * inv((roll / rb).atan());
            let centre = travel + tooth * g.pitch_angle() + x.z * tan / rb;
            let turn = base - centre - side.sign() * g.half_angle_base();
            let turn = turn - TAU * (turn / TAU).round();
            rb * side.sign() * turn * g.base_helix_angle().cos()
        }
        Body::Rack(r) => {
            // Facing -x: the slide is +y, the left flank of a tooth is its lower one.
            let alpha = r.transverse_pressure_angle();
            let height = cx - x.x;
            let half = r.half_thickness_reference() - height * alpha.tan();
            let centre = cy + travel + tooth * r.pitch() - x.z * r.params().helix_angle.tan();
            (-side.sign() * (x.y - centre) - half) * alpha.cos() * r.base_helix_angle().cos()
        }
    }
}

/// Rigid smooth flanks over a mesh cycle. The gap of every candidate is its distance from the exact flank, and
/// the least gap of each side is that of the lines of action: the points stand beside the point of contact
/// by at most half their spacing `x`, which costs `x^2 / (2 rho)`.
fn agrees(name: &str, spec: &SceneSpec, models: &[ModelSpec], slave: usize, tolerance: f64) {
    let rigid = vec![rigid(); 2];
    let lines = build(spec, &rigid, &contact(1.5e10));
    let points = PointContact {
        rule: PointRule::Quadrature {
            along: 10,
            across: 3,
        },
        reach: Some(1e-3),
        ..PointContact::new(1e15)
    };
    let scene = build(spec, models, &with_points(points));
    let (mut worst, mut count) = ([0.0_f64; 3], 0);
    for i in 0..25 {
        let s = roll(spec, &scene, -0.17 + 0.0143 * f64::from(i));
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
}

fn nodal(rows: usize, columns: usize, condensed: bool) -> ModelSpec {
    let model = flanked("nodal-test", rows, columns);
    with(
        model,
        "condensed",
        Value::Number(f64::from(u8::from(condensed))),
    )
}

/// Case A with the flanks of both gears overlapping by `gap < 0` and everything else a little off its place.
fn pressed(models: &[ModelSpec], points: PointContact, gap: f64, off: f64) -> (Scene, State) {
    let scene = build(&case_a(gap), models, &with_points(points));
    let mut s = scene.initial();
    let mut numbers = Numbers::new(3);
    for g in scene.gears() {
        let first = g.range().start;
        for i in g.range().skip(1) {
            s.q[i] += off * numbers.draw();
            s.v[i] += 1e4 * off * numbers.draw();
        }
        s.q[first] += 10.0 * off * numbers.draw();
    }
    (scene, s)
}

/// Both ways to add contacts to a Newton correction give the same, by rows and by coordinates.
#[test]
fn the_condensed_correction_is_the_dense_one() {
    let c = Coeffs {
        m: 1.0,
        d: 1e-7,
        k: 2e-14,
    };
    for (along, across) in [(5, 2), (10, 10)] {
        let points = PointContact {
            damping: 1e8,
            rule: PointRule::Quadrature { along, across },
            passes: Passes::Both,
            ..PointContact::new(1e15)
        };
        let solve = |models: &[ModelSpec], points: PointContact| {
            let (mut scene, s) = pressed(models, points, -40e-6, 2e-7);
            let mut numbers = Numbers::new(11);
            let (scale, _) = scales(&scene);
            let mut x: Vec<f64> = numbers.vector(&scale);
            let mut out = Outputs::default();
            scene.apply_mass(s.at(), &x.clone(), &mut x);
            scene.correct(s.at(), c, &mut x).unwrap();
            scene.output(s.at(), &mut out);
            (x, scene.contact_forces(s.at()).len(), scale)
        };
        let size = |condensed| nodal(5, 2, condensed);
        let (dense, n, scale) = solve(&[size(false), size(false)], points);
        let (condensed, _, _) = solve(&[size(true), size(false)], points);
        let without = PointContact {
            damping: 0.0,
            ..PointContact::new(1e-9)
        };
        let (open, _, _) = solve(&[size(false), size(false)], without);
        assert!(n > 8, "{n} points touch");
        let apart = |x: &[f64], y: &[f64]| {
            let squares = x.iter().zip(y).zip(&scale);
            squares
                .map(|((x, y), s)| ((x - y) / s).powi(2))
                .sum::<f64>()
                .sqrt()
        };
        let error = apart(&dense, &condensed) / apart(&dense, &open);
        println!("{n} points: corrections by contact differ by {error:.1e}");
        assert!(error < 1e-10, "{n} points: {error:.2e}");
    }
}

fn quadrature(along: usize, across: usize) -> PointRule {
    PointRule::Quadrature { along, across }
}

/// Case A with rigid flanks, overlapping by `-gap`.
fn rigid_pair(
    spec: &SceneSpec,
    [rows, columns]: [usize; 2],
    points: PointContact,
) -> (Scene, Vec<(usize, Candidate)>, State) {
    let model = flanked("rigid-flanks-test", rows, columns);
    let scene = build(spec, &[model.clone(), model], &with_points(points));
    let s = scene.initial();
    let found = candidates(&scene, &s);
    (scene, found, s)
}

/// Of the candidates that overlap: sum of penalty x area x overlap [N].
fn force_of(found: &[(usize, Candidate)]) -> f64 {
    let closed = found.iter().filter(|(_, c)| c.gap < 0.0);
    closed.map(|(_, c)| -c.stiffness * c.gap).sum()
}

/// Rigid involutes that overlap by d touch over a strip of half length `sqrt(2 rho d)` with a parabola of
/// overlap, `rho` the relative radius of curvature: `N = p b (4/3) d sqrt(2 rho d)`. Nodes, quadrature, facets
/// and both passes come to it on fine grids.
#[test]
fn the_force_is_penalty_times_area_times_overlap() {
    let d = 4e-6;
    let spec = case_a(-d);
    let g = |k: usize| match &spec.gears[k].body {
        Body::Gear(g) => g.clone(),
        Body::Rack(_) => unreachable!(),
    };
    let layout = mesh_layout(&spec.gears[0], &spec.gears[1]).unwrap();
    let (r1, r2) = (layout.pitch_point, layout.length - layout.pitch_point);
    let rho = r1 * r2 / (r1 + r2);
    let exact = 1e15 * g(0).face_width() * 4.0 / 3.0 * d * (2.0 * rho * d).sqrt();
    let force = |rows: usize, rule, surface, passes| {
        let points = PointContact {
            rule,
            surface,
            passes,
            ..PointContact::new(1e15)
        };
        let (_, found, _) = rigid_pair(&spec, [rows, 2], points);
        force_of(&found)
    };
    let (smooth, faceted) = (SurfaceKind::Smooth, SurfaceKind::Faceted);
    for (name, rows, rule, surface, passes, tolerance) in [
        (
            "quadrature",
            81,
            quadrature(3, 2),
            smooth,
            Passes::First,
            5e-3,
        ),
        ("second", 81, quadrature(3, 2), smooth, Passes::Second, 5e-3),
        ("both", 81, quadrature(3, 2), smooth, Passes::Both, 5e-3),
        ("nodes", 161, PointRule::Nodes, smooth, Passes::First, 1e-2),
        (
            "faceted",
            161,
            quadrature(3, 2),
            faceted,
            Passes::First,
            2e-2,
        ),
        (
            "faceted nodes",
            321,
            PointRule::Nodes,
            faceted,
            Passes::Both,
            2e-2,
        ),
    ] {
        let found = force(rows, rule, surface, passes);
        println!("{name}: {found:.1} N, exact {exact:.1} N");
        assert!((found / exact - 1.0).abs() < tolerance, "{name}: {found}");
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
        let areas = gearbench_models::contact::flank_points::reference_areas(&grids, 0, rule);
        let sum: f64 = areas.iter().sum();
        let exact = g.face_width() * length;
        assert!((sum / exact - 1.0).abs() < 1e-4, "{rule:?}: {sum} {exact}");
    }
}

/// Rows of the nodal gears by differences of the gap: smooth and faceted, both passes, hub and nodes.
#[test]
fn rows_are_the_derivatives_of_the_gaps() {
    for surface in [SurfaceKind::Smooth, SurfaceKind::Faceted] {
        let points = PointContact {
            rule: quadrature(6, 3),
            surface,
            passes: Passes::Both,
            ..PointContact::new(1e15)
        };
        let (scene, s) = pressed(&[nodal(9, 3, true), nodal(9, 3, true)], points, -6e-6, 1e-7);
        let found: Vec<_> = candidates(&scene, &s)
            .into_iter()
            .filter(|(_, c)| c.gap < 10e-6)
            .collect();
        assert!(found.len() > 30, "{} candidates", found.len());
        let of_teeth = |x: &Candidate, c: &Candidate| {
            (0..2).all(|k| x.points[k].tooth == c.points[k].tooth)
                && (0..2).any(|k| x.points[k].locus == c.points[k].locus)
        };
        let mut numbers = Numbers::new(5);
        let (mut worst, mut checked) = (0.0_f64, 0);
        for (_, c) in &found {
            let w = contact_row(&scene, &s, 0, c);
            // All coordinates at once, in a direction that turns the hubs as much as it moves nodes.
            let mut scale = vec![1.0; s.q.len()];
            for g in scene.gears() {
                scale[g.range().start] = 25.0;
            }
            let direction = numbers.vector(&scale);
            let h = 2e-9;
            let gap = |x: f64| {
                let mut moved = s.clone();
                for (q, d) in moved.q.iter_mut().zip(&direction) {
                    *q += x * d;
                }
                let near = candidates(&scene, &moved).into_iter().map(|(_, x)| x);
                near.filter(|x| of_teeth(x, c)).map(|x| x.gap).next()
            };
            let (Some(above), Some(below)) = (gap(h), gap(-h)) else {
                continue;
            };
            let slope = (above - below) / (2.0 * h);
            let row: f64 = w.iter().zip(&direction).map(|(w, d)| w * d).sum();
            worst = worst.max((slope - row).abs());
            checked += 1;
        }
        assert!(checked > 30, "{checked} candidates stayed");
        println!("{surface:?}: {checked} rows off by {worst:.1e}");
        assert!(worst < 2e-6, "{surface:?}: rows off by {worst:.2e}");
    }
}

/// Contact forces turn the gears as forces on the line of action: `T = F r_b`, opposite on both sides of the
/// contact, with as much moment about the origin as the other gear takes.
#[test]
fn moments_are_those_of_the_line_of_action() {
    for side in Side::BOTH {
        let mut spec = case_a(-4e-6);
        spec.meshes[0].start = start(side, -4e-6);
        let points = PointContact {
            rule: quadrature(4, 2),
            ..PointContact::new(1e15)
        };
        let model = flanked("rigid-flanks-test", 41, 2);
        let mut scene = build(&spec, &[model.clone(), model], &with_points(points));
        let s = scene.initial();
        let force = channel(&mut scene, &s, "force:0");
        let lines = build(&spec, &[rigid(), rigid()], &contact(1.5e10));
        for (k, name) in ["pinion", "wheel"].into_iter().enumerate() {
            let torque = channel(&mut scene, &s, &format!("contact_torque:{name}"));
            let rb = lever(&spec.gears[k].body);
            // Both turn alike: the driven flank pushes the wheel with the same sense about its own axis.
            let error = (torque.abs() / (force * rb) - 1.0).abs();
            println!("{side:?} {name}: lever off by {error:.1e}");
            assert!(error < 2e-4, "{side:?} {name}: {torque} of {}", force * rb);
        }
        let mut f = vec![0.0; s.q.len()];
        scene.force(s.at(), &mut f);
        assert!(f[0] * f[1] > 0.0 && f[0] * side.sign() < 0.0, "{f:?}");
        drop(lines);
    }
}

/// The same state gives the same bits, whatever was evaluated before.
#[test]
fn forces_repeat_bit_for_bit() {
    let points = PointContact {
        passes: Passes::Both,
        ..PointContact::new(1e15)
    };
    let (mut scene, s) = pressed(
        &[nodal(7, 3, false), nodal(7, 3, false)],
        points,
        -6e-6,
        1e-7,
    );
    let force = |scene: &mut Scene, s: &State| {
        let mut f = vec![0.0; s.q.len()];
        scene.force(s.at(), &mut f);
        f
    };
    let first = force(&mut scene, &s);
    let mut other = s.clone();
    other.q[0] += 0.3;
    force(&mut scene, &other);
    assert_eq!(first, force(&mut scene, &s));
    assert!(first.iter().any(|x| *x != 0.0));
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

/// A point that slides over the tip edge leaves without a jump of force.
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

/// The work follows the teeth about the line of centres, not the number of teeth; times are printed.
#[test]
fn the_cost_follows_the_active_flanks() {
    for (z, distance) in [([20, 30], 0.1001), ([80, 120], 0.4001)] {
        let spec = pair_of(
            gear("a", spur(z[0]), 0.0, 0.0),
            gear("b", spur(z[1]), distance, 0.0),
            start(Side::Left, -4e-6),
        );
        let points = PointContact::new(1e15);
        let (scene, _, s) = rigid_pair(&spec, [21, 7], points);
        let mesh = &scene.meshes()[0];
        let party = |k: usize| Party {
            gear: scene.gears()[k].model.as_ref(),
            at: scene.gears()[k].at(s.at()),
        };
        let mut found = Vec::new();
        let begin = std::time::Instant::now();
        let turns = 1000;
        for _ in 0..turns {
            found.clear();
            let wanted = Wanted::Touching(0.0);
            mesh.search
                .candidates(party(0), party(1), &[], wanted, &mut found);
        }
        let time = begin.elapsed().as_secs_f64() / f64::from(turns);
        let work = mesh.search.work();
        println!(
            "z = {z:?}: {work:?}, {} touch: {:.1} us, {:.0} ns per point, {:.0} ns per projection",
            found.len(),
            1e6 * time,
            1e9 * time / work.points as f64,
            1e9 * time / work.projections as f64
        );
        assert!(!found.is_empty());
        assert!(work.flanks <= 12, "{work:?}");
        assert!(work.points < work.nodes, "{work:?}");
    }
}
