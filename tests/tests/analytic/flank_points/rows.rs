//! Rows by differences, the Newton correction, and repeatability.

use super::*;
use gearbench_integrators::{Events, Report};
/// Largest error of `w . d` against the difference of the gap in a random direction over all candidates within
/// 10 um, hubs and movable teeth turning by as much as nodes move; and the number of candidates.
fn worst_row(scene: &Scene, s: &State) -> (f64, usize) {
    let of_teeth = |x: &Candidate, c: &Candidate| {
        (0..2).all(|k| x.points[k].tooth == c.points[k].tooth)
            && (0..2).any(|k| x.points[k].locus == c.points[k].locus)
    };
    let mut scale = vec![1.0; s.q.len()];
    for g in scene.gears() {
        let turning = if g.id == "movable-teeth" {
            g.range().len()
        } else {
            1
        };
        if g.model.hub().slide.is_none() {
            g.range().take(turning).for_each(|i| scale[i] = 25.0);
        }
    }
    let mut numbers = Numbers::new(5);
    let (mut worst, mut checked) = (0.0_f64, 0);
    for (_, c) in candidates(scene, s).iter().filter(|(_, c)| c.gap < 10e-6) {
        let w = contact_row(scene, s, 0, c);
        let direction = numbers.vector(&scale);
        let h = 2e-9;
        let gap = |x: f64| {
            let mut moved = s.clone();
            for (q, d) in moved.q.iter_mut().zip(&direction) {
                *q += x * d;
            }
            let near = candidates(scene, &moved).into_iter().map(|(_, x)| x);
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
    (worst, checked)
}

/// Rows of the nodal gears agree with differences of the gap: smooth and faceted, hub and nodes, both passes.
#[test]
fn rows_are_the_derivatives_of_the_gaps() {
    for surface in [SurfaceKind::Smooth, SurfaceKind::Faceted] {
        let points = PointContact {
            rule: quadrature(6, 3),
            surface,
            passes: Passes::Both,
            ..PointContact::new(1e15)
        };
        let models = [nodal(9, 3, true), nodal(9, 3, true)];
        let (scene, s) = pressed(&models, points, -6e-6, 1e-7);
        let (worst, checked) = worst_row(&scene, &s);
        println!("{surface:?}: {checked} rows off by {worst:.1e}");
        assert!(checked > 30, "{checked} candidates stayed");
        assert!(worst < 2e-7, "{surface:?}: rows off by {worst:.2e}");
    }
}

/// Rows of points in the tip taper agree with differences of the gap, along the path, with both passes.
#[test]
fn rows_of_points_that_leave() {
    for surface in [SurfaceKind::Smooth, SurfaceKind::Faceted] {
        let points = PointContact {
            rule: quadrature(8, 2),
            surface,
            passes: Passes::Both,
            ..PointContact::new(1e15)
        };
        let models = [nodal(9, 3, true), nodal(9, 3, true)];
        let (mut leaving, mut worst) = (0, 0.0_f64);
        for step in 0..24_u32 {
            let mut spec = case_a(-6e-6);
            spec.meshes[0].start.path_coordinate = Some(6e-3 + 0.7e-3 * f64::from(step));
            let scene = build(&spec, &models, &with_points(points));
            let mut s = scene.initial();
            let mut numbers = Numbers::new(3 + u64::from(step));
            for g in scene.gears() {
                for q in &mut s.q[g.range()][1..] {
                    *q += 1e-7 * numbers.draw();
                }
            }
            let taper_gradient = |c: &Candidate| c.taper < 1.0 && c.gap < 0.0;
            leaving += candidates(&scene, &s)
                .iter()
                .filter(|(_, c)| taper_gradient(c))
                .count();
            worst = worst.max(worst_row(&scene, &s).0);
        }
        println!("{surface:?}: {leaving} leave, rows off by {worst:.1e}");
        assert!(leaving > 5, "{surface:?}: {leaving}");
        assert!(worst < 1e-6, "{surface:?}: rows off by {worst:.2e}");
    }
}

/// Rows agree with differences for partners without flanks, on either side, and after rotations: movable teeth each
/// with its own angle, a rigid gear, a rack.
#[test]
fn rows_with_partners_that_bring_no_flanks() {
    let points = PointContact {
        rule: quadrature(6, 2),
        passes: Passes::Both,
        ..PointContact::new(1e15)
    };
    let teeth = movable(5.3e8, 4.8e-3, 0.0);
    let mut with_rack = pair_of(
        gear("a", spur(20), 0.0, 0.0),
        rack("r", 15, 0.04005, 0.0),
        start(Side::Right, -4e-6),
    );
    with_rack.gears[1].speed = 0.1;
    let own = || flanked("rigid-flanks-test", 21, 2);
    for (name, spec, models, angle) in [
        ("movable", case_a(-4e-6), [own(), teeth.clone()], 14.0),
        ("movable first", case_a(-4e-6), [teeth, own()], -9.0),
        ("rigid", case_a(-4e-6), [nodal(9, 2, false), rigid()], 0.0),
        (
            "rigid first",
            case_a(-4e-6),
            [rigid(), nodal(9, 2, false)],
            0.0,
        ),
        (
            "rack",
            with_rack.clone(),
            [nodal(9, 2, false), rigid()],
            0.0,
        ),
        ("rack far along", with_rack, [own(), rigid()], 0.5),
    ] {
        let mut scene = build(&spec, &models, &with_points(points));
        let mut s = scene.initial();
        // In small steps, so that movable teeth hand over.
        for _ in 0..100 {
            let whole = roll(&spec, &scene, 0.01 * angle);
            let start = scene.initial();
            for (k, g) in scene.gears().iter().enumerate() {
                let by = whole.q[g.range().start] - start.q[g.range().start];
                let n = if g.id == "nodal-test" {
                    1
                } else {
                    g.range().len()
                };
                g.range().take(n).for_each(|i| s.q[i] += by);
                let _ = k;
            }
            scene.commit(&mut s);
        }
        let mut numbers = Numbers::new(2);
        for q in &mut s.q {
            *q += 1e-7 * numbers.draw();
        }
        let (worst, checked) = worst_row(&scene, &s);
        println!("{name}: {checked} rows off by {worst:.1e}");
        assert!(checked >= 8, "{name}: {checked} candidates");
        assert!(worst < 1e-6, "{name}: rows off by {worst:.2e}");
    }
}

/// Both methods that add contacts to a Newton correction agree, by rows and by coordinates.
#[test]
fn the_condensed_correction_is_the_dense_one() {
    let c = Coeffs {
        m: 1.0,
        d: 1e-7,
        k: 2e-14,
    };
    for (along, across) in [(5, 2), (10, 10)] {
        let points = PointContact {
            rule: PointRule::Quadrature { along, across },
            passes: Passes::Both,
            ..PointContact::new(1e15).damped(1e8)
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
        let without = PointContact::new(1e-9).damped(0.0);
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

/// Equal states give equal bits, whatever was evaluated before.
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

/// Returns case A with the flanks of both gears overlapping by `gap < 0` and all other coordinates slightly displaced.
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

fn nodal(rows: usize, columns: usize, condensed: bool) -> ModelSpec {
    with(flanked("nodal-test", rows, columns), "condensed", condensed)
}

/// The gap rate `w . v` and what is prescribed by differences in time, with a driven gear on either side.
#[test]
fn gap_rates_with_driven_gears() {
    let own = || flanked("rigid-flanks-test", 21, 2);
    for driven in 0..2 {
        for models in [[own(), rigid()], [nodal(9, 2, false), own()]] {
            let mut spec = case_a(-4e-6);
            spec.gears[driven].mount = Mount::Driven(Profile::Constant(7.0));
            let points = PointContact {
                passes: Passes::Both,
                ..PointContact::new(1e15)
            };
            let scene = build(&spec, &models, &with_points(points));
            let mut s = scene.initial();
            let mut numbers = Numbers::new(9);
            s.v.iter_mut().for_each(|v| *v += 0.1 * numbers.draw());
            let mut checked = 0;
            for (_, c) in candidates(&scene, &s) {
                let (row, prescribed) = row_and_rate(&scene, &s, 0, &c);
                let rate: f64 = row.iter().zip(&s.v).map(|(w, v)| w * v).sum();
                let h = 1e-9;
                let gap = |dt: f64| {
                    let mut moved = s.clone();
                    moved.t += dt;
                    for (q, v) in moved.q.iter_mut().zip(&s.v) {
                        *q += dt * v;
                    }
                    let near = candidates(&scene, &moved).into_iter().map(|(_, x)| x);
                    let same = |x: &Candidate| {
                        (0..2).all(|k| x.points[k].tooth == c.points[k].tooth)
                            && (0..2).any(|k| x.points[k].locus == c.points[k].locus)
                    };
                    near.filter(same).map(|x| x.gap).next()
                };
                let (Some(above), Some(below)) = (gap(h), gap(-h)) else {
                    continue;
                };
                let slope = (above - below) / (2.0 * h);
                let error = (slope - rate - prescribed).abs();
                assert!(error < 1e-6, "driven {driven}: {slope} {rate} {prescribed}");
                checked += 1;
            }
            assert!(checked > 10, "{checked}");
        }
    }
}
