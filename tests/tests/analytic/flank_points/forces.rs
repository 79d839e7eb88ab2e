//! Forces and moments of flank points, and refusals.

use super::*;
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
        for (k, name) in ["pinion", "wheel"].into_iter().enumerate() {
            let torque = channel(&mut scene, &s, &format!("contact_torque:{name}"));
            let rb = effective_radius(&spec.gears[k].body);
            // Both turn alike: the driven flank pushes the wheel with the same sense about its own axis.
            let error = (torque.abs() / (force * rb) - 1.0).abs();
            println!("{side:?} {name}: effective_radius off by {error:.1e}");
            assert!(error < 2e-4, "{side:?} {name}: {torque} of {}", force * rb);
        }
        let mut f = vec![0.0; s.q.len()];
        scene.force(s.at(), &mut f);
        assert!(f[0] * f[1] > 0.0 && f[0] * side.sign() < 0.0, "{f:?}");
    }
}

/// Settings that flank points do not support are refused with a remedy.
#[test]
fn what_flank_points_cannot_do_is_refused() {
    let spec = case_a(3e-6);
    let own = flanked("rigid-flanks-test", 9, 2);
    let refused = |models: [ModelSpec; 2], contact: ContactSpec, words: &[&str]| {
        let e = match try_build(&spec, &models, &contact) {
            Ok(_) => panic!("accepted: {words:?}"),
            Err(e) => e.to_string(),
        };
        for word in words {
            assert!(e.contains(word), "no `{word}` in: {e}");
        }
    };
    let points = || with_points(PointContact::new(1e15));
    let pair = || [own.clone(), rigid()];
    refused(pair(), contact(1.5e10), &["pinion", "penalty_pa_per_m"]);
    refused(
        pair(),
        with_points(PointContact::new(-1.0)),
        &["-1 Pa/m", "positive"],
    );
    refused(
        pair(),
        ContactSpec {
            damping: Damping::Flores { e: 0.9 },
            ..points()
        },
        &["flores", "damping_ns_per_m3"],
    );
    let by_radius = with(
        with(
            movable(5.3e8, 4.8e-3, 0.0),
            "stiffness_radius_m",
            vec![0.036, 0.062],
        ),
        "stiffness_at_radius_n_per_m",
        vec![7e8, 3e8],
    );
    refused([own, by_radius], points(), &["wheel", "contact radius"]);
}
