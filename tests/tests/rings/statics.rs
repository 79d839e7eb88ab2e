//! Statics of elastic pairs: compared with full finite elements of the same mesh and with the geometry of rigid
//! flanks, exchanged and rotated.

use super::*;
use gearbench_models::geometry::Modifications;
use gearbench_models::spec::{PointRule, mesh_layout};
use gearbench_models::stiffness::Material;
use gearbench_reference::statics::{Load, LoadedContact, LoadedPair};

/// Returns the equilibrium with the pinion at a position [m] and an approach [m] or a force.
fn equilibrium_at(
    spec: &SceneSpec,
    model: &ModelSpec,
    contact: &ContactSpec,
    (s, load): (f64, Load),
) -> LoadedContact {
    let mut spec = spec.clone();
    spec.meshes[0].start.path_coordinate = Some(s);
    let modelling = modelling(&spec, model, contact);
    let mut pair = LoadedPair::new(&spec, &modelling, gearbench::models::models()).unwrap();
    match load {
        Load::Force(force) => pair.under_force(s, force).unwrap(),
        Load::Approach(approach) => pair.at_approach(s, approach).unwrap(),
    }
}

/// Returns positions over a base pitch about the pitch point, and the length of the line of action [m].
fn positions(spec: &SceneSpec, count: u32) -> (Vec<f64>, f64) {
    let l = mesh_layout(&spec.gears[0], &spec.gears[1]).unwrap();
    let part = |i: u32| f64::from(i) / f64::from(count) - 0.5;
    let all = (0..count).map(|i| l.pitch_point + part(i) * l.base_pitch);
    (all.collect(), l.length)
}

/// Returns equilibria at positions over a base pitch.
fn cycle(
    spec: &SceneSpec,
    model: &ModelSpec,
    contact: &ContactSpec,
    load: Load,
    count: u32,
) -> Vec<LoadedContact> {
    let (all, _) = positions(spec, count);
    let at = |s: f64| equilibrium_at(spec, model, contact, (s, load));
    all.into_iter().map(at).collect()
}

/// Compares the force at the same approach of elastic gears of some modes with full finite elements.
fn beside_fe(name: &str, contact: &ContactSpec, approaches: [f64; 2], limit: f64) {
    let spec = pair(0.0);
    for approach in approaches {
        let of = |model: &ModelSpec| cycle(&spec, model, contact, Load::Approach(approach), 5);
        let fe = of(&meshed("fe", [8.0, 1.0], &[]));
        for modes in [0.0, 60.0] {
            let found = of(&elastic([8.0, 1.0], modes));
            let off: Vec<f64> = (found.iter().zip(&fe))
                .map(|(a, b)| a.force / b.force - 1.0)
                .collect();
            let worst = off.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
            println!(
                "{name}, approach {:.0} um, {modes} modes: {:.0} to {:.0} N, off `fe` by {worst:.1e}",
                1e6 * approach,
                fe.iter().map(|p| p.force).fold(f64::INFINITY, f64::min),
                fe.iter().map(|p| p.force).fold(0.0, f64::max),
            );
            assert!(worst < limit, "{name}: {off:?}");
        }
    }
}

#[test]
fn forces_are_those_of_full_finite_elements() {
    beside_fe(
        "points",
        &touching(PointContact::new(1e15), None),
        [5e-6, 2e-5],
        0.02,
    );
    beside_fe(
        "half-spaces",
        &touching(FlankContact::HalfSpace, Some(1)),
        [5e-6, 2e-5],
        0.02,
    );
}

/// Returns parameters of teeth that are thinner at root and tip.
fn crowned(p: &GearParams) -> GearParams {
    GearParams {
        modifications: Modifications {
            profile_crowning: 2e-6,
            ..Modifications::default()
        },
        ..p.clone()
    }
}

/// Gears a million times as stiff as steel follow the geometry of their flanks: what their teeth leave of it is what splines
/// through the nodes leave.
#[test]
fn nearly_rigid_rings_have_the_transmission_error_of_their_flanks() {
    let [pinion, ring] = params(0.0);
    let crowned = [crowned(&pinion), crowned(&ring)];
    for (name, params, limit) in [("plain", [pinion, ring], 1e-9), ("crowned", crowned, 1e-8)] {
        for turned_round in [false, true] {
            let mut spec = pair_in(0.4, params.clone(), Side::Left, 0.0);
            for g in &mut spec.gears {
                g.material = Material {
                    young: 1e6 * g.material.young,
                    ..g.material
                };
            }
            if turned_round {
                spec = exchanged(spec);
            }
            let load = Load::Force(10.0);
            // Many points, so that one stands where the flanks touch.
            let points = PointContact {
                rule: PointRule::Quadrature {
                    along: 10,
                    across: 1,
                },
                ..PointContact::new(1e18)
            };
            let points = touching(points, None);
            let found = cycle(&spec, &elastic([48.0, 1.0], 0.0), &points, load, 12);
            let rigid = gearbench_tests::rigid();
            let exact = cycle(&spec, &rigid, &contact(1e14), load, 12);
            let off = found
                .iter()
                .zip(&exact)
                .map(|(a, b)| (a.approach - b.approach).abs());
            let worst = off.fold(0.0, f64::max);
            let spread = exact.iter().map(|p| p.approach).fold(0.0, f64::max);
            println!(
                "{name}, ring first {turned_round}: transmission error up to {spread:.1e} m, off by {worst:.1e} m"
            );
            assert!(worst < limit, "{name}: {worst:.2e}");
        }
    }
}

const APPROACH: f64 = 1e-5;

/// Results do not depend on the order of the gears or on the position of the pair.
#[test]
fn exchanged_and_turned_pairs_have_the_same_forces() {
    for (name, contact) in [
        ("points", touching(PointContact::new(1e15), None)),
        ("half-spaces", touching(FlankContact::HalfSpace, Some(1))),
    ] {
        let model = elastic([8.0, 1.0], 40.0);
        let load = Load::Approach(APPROACH);
        let spec = pair(0.0);
        let (all, length) = positions(&spec, 6);
        let of = |spec: &SceneSpec, s: f64| equilibrium_at(spec, &model, &contact, (s, load));
        let turned = pair_in(1.9, params(0.0), Side::Left, 0.0);
        let other = exchanged(spec.clone());
        for s in all {
            let first = of(&spec, s);
            // The gear that is named first stands ahead by the approach.
            for (what, found) in [
                ("turned", of(&turned, s)),
                ("exchanged", of(&other, length - s - APPROACH)),
            ] {
                let off = (found.force / first.force - 1.0).abs();
                println!(
                    "{name}, {what}, at {s:.4e} m: {:.3} N, off by {off:.1e}",
                    first.force
                );
                assert!(
                    off < 1e-9 && first.force > 1000.0,
                    "{name}, {what}: {off:.2e}"
                );
            }
        }
    }
}
