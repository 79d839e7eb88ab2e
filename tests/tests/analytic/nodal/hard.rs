//! Hard contact: limit of penalties, open gaps, one potential, refusals.

use super::potential::gradient_error;
use super::*;

fn scene_with(points: PointContact, residual: f64) -> (Scene, State) {
    let spec = case_a(-12e-6);
    let model = toy(21, 2, 6, residual);
    let scene = build(&spec, &[model.clone(), model], &with_points(points));
    let mut s = scene.initial();
    deform(&scene, &mut s, 2e-6, 3);
    (scene, s)
}

fn total(scene: &mut Scene, s: &State) -> f64 {
    channel(scene, s, "force:0")
}

/// Penalties at nodes converge to hard contact at nodes, with the first power of their inverse.
#[test]
fn penalties_come_to_hard_contact() {
    for surface in [SurfaceKind::Smooth, SurfaceKind::Faceted] {
        let at_nodes = |points: PointContact| PointContact {
            rule: PointRule::Nodes,
            surface,
            passes: Passes::First,
            ..points
        };
        let (mut hard, s) = scene_with(at_nodes(PointContact::hard(PointRule::Nodes)), 2e-9);
        let want = total(&mut hard, &s);
        assert!(want > 100.0, "{want}");
        let penalties = [1e17, 1e18, 1e19, 1e20];
        let errors = penalties.map(|p| {
            let (mut soft, s) = scene_with(at_nodes(PointContact::new(p)), 2e-9);
            (total(&mut soft, &s) / want - 1.0).abs()
        });
        let order = -slope(&penalties[1..], &errors[1..]);
        println!("{surface:?}: hard {want:.1} N, penalties off by {errors:?}, order {order:.3}");
        assert!((order - 1.0).abs() < 0.05, "order {order}");
        assert!(errors[3] < 1e-4);
        // Averaged gaps hold nearly the same force on these fine flanks.
        let points = PointContact {
            surface,
            ..PointContact::hard(quadrature(4, 2))
        };
        let (mut mortar, s) = scene_with(points, 2e-9);
        let averaged = total(&mut mortar, &s);
        println!("{surface:?}: mortar {averaged:.1} N");
        // Nodes stand out of facets, whose averaged gaps are larger.
        let apart = if surface == SurfaceKind::Smooth {
            0.1
        } else {
            0.25
        };
        assert!((averaged / want - 1.0).abs() < apart, "{averaged} {want}");
    }
}

/// Forces are compressive, repeat bit for bit, and derive from one potential; so does the tangent.
#[test]
fn hard_contact_derives_from_a_potential() {
    for rule in [PointRule::Nodes, quadrature(4, 2)] {
        let (mut scene, s) = scene_with(PointContact::hard(rule), 2e-9);
        let forces = scene.contact_forces(s.at());
        assert!(forces.len() > 2 && forces.iter().all(|f| f.normal_force > 0.0));
        if rule == PointRule::Nodes {
            assert!(forces.iter().all(|f| f.gap.abs() < 1e-15), "closed");
        }
        let error = gradient_error(&mut scene, &s);
        println!("{rule:?}: {} points, off by {error:.1e}", forces.len());
        assert!(error < 1e-6, "{error:.2e}");

        let first = force(&mut scene, &s);
        let (sq, sv) = scales(&scene);
        let mut numbers = Numbers::new(9);
        for round in 0..20 {
            let mut other = s.clone();
            let size = [1e-3, 0.1, 1.0, 10.0][round % 4];
            for (q, d) in other.q.iter_mut().zip(numbers.vector(&sq)) {
                *q += size * d;
            }
            force(&mut scene, &other);
            assert_eq!(first, force(&mut scene, &s), "round {round}");
        }

        let (dq, dv) = (numbers.vector(&sq), numbers.vector(&sv));
        let mut df = vec![0.0; s.q.len()];
        scene.tangent_times(s.at(), &dq, &dv, &mut df);
        let h = 1e-10 / scene.magnitudes().deflection;
        let mut moved = |x: f64| {
            let mut m = s.clone();
            (m.q.iter_mut().zip(&dq)).for_each(|(q, d)| *q += x * d);
            (m.v.iter_mut().zip(&dv)).for_each(|(v, d)| *v += x * d);
            force(&mut scene, &m)
        };
        let (above, below) = (moved(h), moved(-h));
        let mut worst = 0.0_f64;
        let largest = (0..df.len()).fold(0.0_f64, |m, i| m.max((df[i] * sq[i]).abs()));
        for i in 0..df.len() {
            let slope = (above[i] - below[i]) / (2.0 * h);
            worst = worst.max(((slope - df[i]) * sq[i]).abs() / largest);
        }
        println!("{rule:?}: tangent off by {worst:.1e}");
        assert!(worst < 5e-3, "{worst:.2e}");

        // Newton's matrix holds the same tangent.
        let c = gearbench_integrators::system::Coeffs {
            m: 1.0,
            d: 0.0,
            k: 1e-11,
        };
        let mut rhs = vec![0.0; s.q.len()];
        scene.apply_mass(s.at(), &dq, &mut rhs);
        let mut change = vec![0.0; s.q.len()];
        let still = vec![0.0; s.q.len()];
        scene.tangent_times(s.at(), &dq, &still, &mut change);
        for (r, f) in rhs.iter_mut().zip(&change) {
            *r -= c.k * f;
        }
        scene.correct(s.at(), c, &mut rhs).unwrap();
        for i in 0..rhs.len() {
            assert!(
                (rhs[i] - dq[i]).abs() < 1e-8 * sq[i],
                "{i}: {} {}",
                rhs[i],
                dq[i]
            );
        }
    }
}

#[test]
fn singular_hard_contact_is_refused() {
    let spec = case_a(3e-6);
    let elastic = || toy(9, 2, 4, 2e-9);
    let plain = || toy(9, 2, 4, 0.0);
    let hard = PointContact::hard(PointRule::Nodes);
    for (models, points, words) in [
        ([plain(), plain()], hard, ["pinion", "residual compliance"]),
        (
            [plain(), elastic()],
            hard,
            ["use the points of `wheel`", "second"],
        ),
        (
            [elastic(), elastic()],
            PointContact {
                passes: Passes::Both,
                ..hard
            },
            ["both passes", "first or the second"],
        ),
    ] {
        let Err(e) = try_build(&spec, &models, &with_points(points)) else {
            panic!("accepted: {words:?}")
        };
        let e = e.to_string();
        for word in words {
            assert!(e.contains(word), "no `{word}` in: {e}");
        }
    }
    // The first gear's points meet a rigid wheel.
    build(&spec, &[elastic(), rigid()], &with_points(hard));
}
