//! Comparison with the same gear in another position, with the gear of one direction, and with its own points.

use super::*;
use gearbench_models::kinematics::{Hub, Locus, Point, Row, Tooth};

/// On rotated axes the forces on the hub are equal and those on nodes rotate.
#[test]
fn a_gear_does_not_know_where_its_axis_points() {
    let turn = Matrix3::from_columns(&some_axes());
    let directions = || [FREE, FREE, FREE, FREE, FREE, HELD];
    for mount in [
        Mount::Revolute,
        Mount::Fixed,
        Mount::Driven(ramp(30.0, 80.0)),
    ] {
        let of = |axes: Option<[Vec3; 3]>| {
            let lateral = Some((directions(), bearing()));
            floating((mount.clone(), None), axes, lateral, MassKind::Consistent)
        };
        let (mut a, mut b) = (of(None), of(Some(some_axes())));
        let (q, v) = moved(&a, 1.0);
        let own = a.own;
        let turned = |x: &[f64]| -> Vec<f64> {
            let nodes = x[own..].chunks_exact(3);
            let nodes =
                nodes.flat_map(|x| -> [f64; 3] { (turn * Vec3::from_column_slice(x)).into() });
            x[..own].iter().copied().chain(nodes).collect()
        };
        let forces = |gear: &mut FullOrder, q: &[f64], v: &[f64]| {
            let mut f = vec![0.0; q.len()];
            gear.forces(at(T, q, v), &mut f);
            f
        };
        let (tq, tv) = (turned(&q), turned(&v));
        let (f, g) = (turned(&forces(&mut a, &q, &v)), forces(&mut b, &tq, &tv));
        let largest = f.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        for (f, g) in f.iter().zip(&g) {
            assert!((f - g).abs() < 1e-9 * largest, "{f} {g}");
        }
        let (e, t) = (a.energy(at(T, &q, &v)), b.energy(at(T, &tq, &tv)));
        assert!((e.total() - t.total()).abs() < 1e-9 * e.total());
        let wrench = Default::default();
        let x = a.mount_reaction(at(T, &q, &v), &[], &wrench);
        let y = b.mount_reaction(at(T, &tq, &tv), &[], &wrench);
        assert!((turn * x.force - y.force).norm() < 1e-9 * x.force.norm());
        assert!((x.torque - y.torque).abs() <= 1e-9 * x.torque.abs());
    }
}

/// About z, in its own direction alone, it is the gear that was there before.
#[test]
fn a_hub_about_z_is_that_of_one_direction() {
    let slide = Some(Vec3::new(0.6, 0.8, 0.0));
    for mass in [MassKind::Consistent, MassKind::Lumped] {
        for (mount, slide) in [
            (Mount::Revolute, None),
            (Mount::Prismatic, slide),
            (Mount::Fixed, None),
            (Mount::Driven(ramp(30.0, 80.0)), None),
        ] {
            let hub: Hub = hub(mount, slide);
            let placement = Placement::new(&hub, 0.3);
            let own = if slide.is_some() { 0.02 } else { 1e-5 };
            let added = AddedInertia {
                own,
                mass: 0.02,
                tilting: 6e-6,
            };
            let (steel, mesh) = (&Material::STEEL, || ring(10));
            let body = Body::new(mesh(), steel, &placement, &hub.mount, mass, own).unwrap();
            let mut plain = FullOrder::new(hub.clone(), 0.04, body);
            let body = Body::floating(mesh(), steel, &placement, &hub, mass, added).unwrap();
            let mut floats = FullOrder::new(hub, 0.04, body);
            let (q, v) = moved(&floats, 1.0);
            let now = at(T, &q, &v);
            let n = q.len();
            let close = |a: &[f64], b: &[f64], what: &str| {
                let largest = a.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
                for (a, b) in a.iter().zip(b) {
                    assert!((a - b).abs() <= 1e-9 * largest, "{what}: {a} {b}");
                }
            };
            let (mut f, mut g) = (vec![0.0; n], vec![0.0; n]);
            plain.forces(now, &mut f);
            floats.forces(now, &mut g);
            close(&f, &g, "forces");
            let (x, c) = (
                noise(n, 1e-3),
                Coeffs {
                    m: 1.0,
                    d: 1e-6,
                    k: 1e-12,
                },
            );
            let (mut a, mut b) = (x.clone(), x.clone());
            plain.correct(now, c, 2.0, &mut a).unwrap();
            floats.correct(now, c, 2.0, &mut b).unwrap();
            close(&a, &b, "correction");
            CoupledMass::apply(&plain, now, &x, &mut a);
            CoupledMass::apply(&floats, now, &x, &mut b);
            close(&a, &b, "mass");
            assert!((plain.hub().inertia / floats.hub().inertia - 1.0).abs() < 1e-12);
            let wrench = Default::default();
            let (x, y) = (
                plain.mount_reaction(now, &f, &wrench),
                floats.mount_reaction(now, &g, &wrench),
            );
            close(x.force.as_slice(), y.force.as_slice(), "reaction");
            // The load of a translating drive is reported as a force.
            if slide.is_none() {
                assert!((x.torque - y.torque).abs() <= 1e-9 * x.torque.abs());
            }
            let (x, y) = (plain.hub_state(now), floats.hub_state(now));
            close(&[x.momentum], &[y.momentum], "momentum");
        }
    }
}

/// A point of a smooth flank moves as its row predicts.
#[test]
fn rows_are_slopes_of_points() {
    for gear in floating_cases() {
        let (q, v) = moved(&gear, 1.0);
        let n = Vec3::new(0.3, -0.5, 0.8);
        let node = gear.body().free[7];
        // Above its node by what turns with the frame.
        let above = Vec3::new(1e-4, 2e-4, -3e-4);
        let place = |at: StateView<'_>| {
            let mut x = [Vec3::zeros()];
            gear.positions(at, &[node], &mut x);
            x[0] + gear.frame_pose(at).turn * above
        };
        let mut row = Row::default();
        row.clear();
        row.target(0, 1.0);
        let p = Point {
            tooth: Tooth { index: 0, mesh: 0 },
            locus: Locus::Node(node),
            x: place(at(T, &q, &v)),
        };
        let prescribed = gear.row(at(T, &q, &v), &p, &n, &mut row);
        let none = vec![0.0; q.len()];
        let speed = rate(&q, &v, &none, |at| place(at).dot(&n));
        let found = row.dot(&v) + prescribed;
        let scale = v.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        assert!((speed - found).abs() < 1e-6 * scale, "{speed} {found}");
    }
}

/// At the start nodes move with their hub.
#[test]
fn a_gear_starts_without_strain() {
    for mut gear in floating_cases() {
        let n = gear.hub().len();
        let (mut q, mut v) = (vec![0.0; n], vec![0.0; n]);
        gear.initialise(25.0, &mut q, &mut v, &mut []);
        let start = at(0.0, &q, &v);
        assert!(gear.energy(start).strain < 1e-20);
        let mut f = vec![0.0; n];
        gear.forces(start, &mut f);
        let (linear, hub) = (gear.momenta(start), gear.hub_state(start));
        if gear.hub().is_free() {
            let expected = gear.hub().inertia * 25.0;
            assert!((hub.momentum / expected - 1.0).abs() < 1e-9, "{linear:?}");
        }
    }
}
