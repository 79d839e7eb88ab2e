//! An elastic gear in contact with any other, racks included, and an idler that couples its meshes.

use super::potential::gradient_error;
use super::*;
use gearbench_models::geometry::Side;
use gearbench_models::spec::Mount;

/// The gradient with partners without fields, on either side. Partners with nodes of their own leave out what the
/// closest point's sliding brings beyond first order.
#[test]
fn any_partner_derives_from_the_potential() {
    let elastic = || toy(13, 3, 6, 2e-9);
    let mut with_rack = pair_of(
        gear("a", spur(20), 0.0, 0.0),
        rack("r", 15, 0.04005, 0.0),
        start(Side::Right, -11e-6),
    );
    with_rack.gears[1].speed = 0.1;
    let teeth = || movable(5.3e8, 4.8e-3, 0.0);
    for (name, spec, models, tolerance) in [
        ("rigid", case_a(-11e-6), [elastic(), rigid()], 1e-6),
        ("rigid first", case_a(-11e-6), [rigid(), elastic()], 1e-6),
        ("movable", case_a(-11e-6), [elastic(), teeth()], 1e-6),
        ("rack", with_rack.clone(), [elastic(), elastic()], 1e-6),
        ("rigid rack", with_rack, [elastic(), rigid()], 1e-6),
        (
            "nodes on springs",
            case_a(-11e-6),
            [elastic(), nodes_on_springs(9)],
            1e-4,
        ),
        (
            "nodes on springs first",
            case_a(-11e-6),
            [nodes_on_springs(9), elastic()],
            1e-4,
        ),
    ] {
        for passes in [Passes::First, Passes::Second] {
            let points = PointContact {
                rule: quadrature(6, 2),
                passes,
                ..PointContact::new(1e15)
            };
            let mut scene = build(&spec, &models, &with_points(points));
            let mut s = scene.initial();
            roll(&spec, &scene, &mut s, 0.02);
            if name.contains("springs") || name == "movable" {
                s = scene.initial();
            }
            deform(&scene, &mut s, 3e-6, 11);
            let touching = scene.contact_forces(s.at()).len();
            let error = gradient_error(&mut scene, &s);
            println!("{name}, {passes:?}: {touching} points, off by {error:.1e}");
            assert!(touching > 3, "{name}: {touching} points");
            assert!(error < tolerance, "{name}: {error:.2e}");
        }
    }
}

/// Pinion, idler and wheel: residual compliance of the idler couples both meshes in one solve.
#[test]
fn an_idler_joins_its_meshes() {
    let idler = 1;
    let mut spec = case_a(-11e-6);
    let third = gear("third", spur(25), 0.1001 + 4e-3 * 27.5 + 1e-4, 0.0);
    spec.gears.push(third);
    spec.meshes
        .push(mesh([idler, 2], start(Side::Right, -11e-6)));
    let points = PointContact {
        rule: quadrature(6, 2),
        ..PointContact::new(1e15)
    };
    let elastic = toy(13, 2, 6, 2e-9);
    let models = vec![elastic; 3];
    let mut scene = build(&spec, &models, &with_points(points));
    let mut s = scene.initial();
    deform(&scene, &mut s, 1e-6, 11);
    let forces = scene.contact_forces(s.at());
    for mesh in 0..2 {
        let n = forces.iter().filter(|f| f.mesh == mesh).count();
        assert!(n > 5, "{n} points of mesh {mesh}");
    }
    let error = gradient_error(&mut scene, &s);
    println!("idler: off by {error:.1e}");
    assert!(error < 1e-6, "{error:.2e}");
    // What the second mesh presses shows in the first: open it and the first mesh's force changes.
    let of_first = |scene: &mut Scene, s: &State| channel(scene, s, "force:0");
    let together = of_first(&mut scene, &s);
    let range = scene.gears()[2].range();
    // The third gear turns away from its right flanks.
    let apart = [1.0, -1.0].map(|sign| {
        let mut t = s.clone();
        t.q[range.start] += sign * 2e-5 / 0.047;
        (channel(&mut scene, &t, "force:1"), of_first(&mut scene, &t))
    });
    let open = apart.iter().find(|x| x.0 == 0.0).expect("one way opens it");
    let change = (open.1 - together).abs() / together;
    println!("the second mesh changes the first mesh's force by {change:.1e}");
    assert!(change > 1e-6 && change < 0.2, "{change}");
}

/// A wheel held and a pinion driven: no free hub, effective base radii show in the powers alone.
#[test]
fn driven_and_held_gears_keep_their_powers() {
    let mut spec = case_a(-5e-6);
    spec.gears[0].mount = Mount::Driven(Profile::Constant(0.2));
    let points = PointContact {
        rule: quadrature(6, 2),
        ..PointContact::new(1e15)
    };
    let elastic = toy(13, 2, 6, 2e-9);
    let mut scene = build(&spec, &[elastic.clone(), elastic], &with_points(points));
    let outcome = run(
        &mut scene,
        "dopri5",
        gearbench_integrators::Resolution::Tolerance(1e-9),
        2e-4,
    )
    .unwrap("driven");
    let drift = outcome.ledger.residual_relative().abs();
    println!(
        "driven pinion: ledger closes to {drift:.1e}, peak {:.0} N",
        outcome.peak
    );
    assert!(outcome.peak > 10.0);
    assert!(drift < 1e-5, "{drift:.2e}");
}
