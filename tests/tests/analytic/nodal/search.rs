//! The searches in the transverse plane and in twisted sections find the same points as the search on surfaces, and
//! their cost depends on the contact.

use super::*;
use gearbench_models::geometry::{Flanks, GearParams, Rack, RackParams};
use gearbench_models::kinematics::Locus;
use gearbench_models::spec::Body;

/// Returns the number and the force of the points that the search on surfaces finds, with displacements from the
/// field.
fn by_hand(scene: &Scene, s: &State) -> (usize, f64) {
    let (mut count, mut force) = (0, 0.0);
    for (mesh, c) in candidates(scene, s) {
        let mut gap = if c.gap < 0.0 { c.gap } else { c.taper * c.gap };
        for (k, &g) in scene.meshes()[mesh].gears.iter().enumerate() {
            let gear = &scene.gears()[g];
            let (Some(field), Locus::Quadrature { face, xi }) =
                (gear.model.displacement(), c.points[k].locus)
            else {
                continue;
            };
            let flanks = gear.model.flanks().expect("a field stands on flanks");
            let mut a = [0.0; 4];
            let range = gear.range();
            field.displacements(&s.q[range], &flanks.corners(face), &mut a);
            gap -= c.taper
                * (a.iter().zip(Flanks::weights(xi)))
                    .map(|(a, w)| a * w)
                    .sum::<f64>();
        }
        if gap < 0.0 && c.stiffness > 0.0 {
            count += 1;
            force -= c.stiffness * gap;
        }
    }
    (count, force)
}

#[test]
fn both_searches_find_the_same() {
    let with_rack = pair_of(
        gear("a", spur(20), 0.0, 0.0),
        rack("r", 15, 0.04005, 0.0),
        start(gearbench_models::geometry::Side::Right, -12e-6),
    );
    let side = gearbench_models::geometry::Side::Left;
    // Lines of contact begin and end within the width, and two pairs touch.
    let helical = |beta: f64, crowning: f64| {
        let [a, b] = [(20, beta), (30, -beta)].map(|(teeth, helix_angle)| {
            let mut params = spur(teeth);
            params.helix_angle = helix_angle;
            params.modifications.lead_crowning = crowning;
            params
        });
        let distance = 0.1001 / beta.cos();
        pair_of(
            gear("a", a, 0.0, 0.0),
            gear("b", b, distance, 0.0),
            start(side, -12e-6),
        )
    };
    let leaning = GearParams {
        helix_angle: 0.25,
        ..spur(20)
    };
    let helical_rack = || -> SceneSpec {
        let mut spec = pair_of(
            gear("a", leaning, 0.0, 0.0),
            rack("r", 15, 0.04005 / 0.25_f64.cos(), 0.0),
            start(side, -12e-6),
        );
        if let Body::Rack(r) = &spec.gears[1].body {
            let params = RackParams {
                helix_angle: -0.25,
                ..r.params().clone()
            };
            spec.gears[1].body = Body::Rack(Rack::new(params).unwrap());
        }
        spec
    };
    let wide = || [toy(21, 7, 6, 0.0), toy(15, 6, 6, 0.0)];
    for (name, spec, models) in [
        ("helical", helical(0.15, 0.0), wide()),
        ("more helical", helical(-0.4, 0.0), wide()),
        // Rigid gears bring the flanks of their geometry, crowned here.
        (
            "helical on a rigid crowned wheel",
            helical(0.25, 8e-6),
            [toy(21, 7, 6, 0.0), rigid()],
        ),
        (
            "spur on a rigid crowned wheel",
            helical(0.0, 8e-6),
            [toy(21, 7, 6, 0.0), rigid()],
        ),
        ("helical rack", helical_rack(), wide()),
        (
            "pair",
            case_a(-12e-6),
            [toy(21, 3, 6, 0.0), toy(13, 2, 6, 0.0)],
        ),
        ("rigid wheel", case_a(-12e-6), [toy(21, 3, 6, 0.0), rigid()]),
        ("rack", with_rack, [toy(21, 2, 6, 0.0), toy(15, 4, 6, 0.0)]),
    ] {
        for surface in [SurfaceKind::Smooth, SurfaceKind::Faceted] {
            for (rule, passes) in [
                (quadrature(8, 2), Passes::First),
                (quadrature(5, 1), Passes::Both),
                (PointRule::Nodes, Passes::Second),
            ] {
                let points = PointContact {
                    surface,
                    rule,
                    passes,
                    ..PointContact::new(1e15)
                };
                let mut scene = build(&spec, &models, &with_points(points));
                let mut touched = 0;
                for step in 0..20 {
                    let mut s = scene.initial();
                    roll(&spec, &scene, &mut s, 0.02 * f64::from(step));
                    deform(&scene, &mut s, 4e-6, 7 + step as u64);
                    let (count, force) = by_hand(&scene, &s);
                    let found = scene.contact_forces(s.at());
                    let sum: f64 = found.iter().map(|f| f.normal_force).sum();
                    assert_eq!(
                        found.len(),
                        count,
                        "{name} {surface:?} {rule:?} step {step}"
                    );
                    assert!(
                        (sum - force).abs() <= 1e-6 * force,
                        "{name} {surface:?} {rule:?} step {step}: {sum} {force}"
                    );
                    touched += count;
                }
                assert!(touched > 40, "{name}: {touched}");
            }
        }
    }
}

/// Out of contact no node is evaluated; in contact only nodes and points near the contact are.
#[test]
fn the_work_follows_the_contact() {
    let work = |rows: usize, gap: f64| {
        let spec = case_a(gap);
        let model = toy(rows, 2, 6, 2e-9);
        let points = PointContact::new(1e15);
        let mut scene = build(&spec, &[model.clone(), model], &with_points(points));
        let mut s = scene.initial();
        deform(&scene, &mut s, 2e-6, 3);
        force(&mut scene, &s);
        scene.meshes()[0].search.points().unwrap().work()
    };
    let apart = work(21, 60e-6);
    assert_eq!((apart.nodes, apart.points), (0, 0), "{apart:?}");
    let touching = work(21, -6e-6);
    println!("{touching:?}");
    assert!(touching.nodes > 0 && touching.nodes < 80, "{touching:?}");
    assert!(touching.projections < 120, "{touching:?}");
}
