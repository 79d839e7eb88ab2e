//! Contact of flank points: gaps and normals on exact involutes against the lines of action, forces, rows,
//! moments, edges.

use gearbench_integrators::system::Coeffs;
use gearbench_integrators::{Outputs, SecondOrderSystem, State};
use gearbench_models::contact::candidate::Candidate;
use gearbench_models::contact::flank_points::{Passes, PointContact, PointRule};
use gearbench_models::geometry::{GearParams, Side, inv};
use gearbench_models::scene::Scene;
use gearbench_models::scene::build::lever;
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
