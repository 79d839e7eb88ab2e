//! Statics of rigid gears: it must return the law's own curve.

use super::{Load, LoadedPair, MeshCycle, PairForce, StaticsError};
use gearbench_models::gear::{rigid as rigid_gear, table::MODELS};
use gearbench_models::geometry::{Gear, GearParams, Rack, RackParams, Side};
use gearbench_models::law::Damping;
use gearbench_models::spec::{
    Body, ContactSpec, FlankContact, GearSpec, Load as HubLoad, MeshSpec, Modelling, Mount,
    Profile, SceneSpec, Start, UPRIGHT, mesh_layout, stiffness_curve,
};
use gearbench_models::stiffness::{
    IsoVariation, Material, PairOrMesh, PairStiffness, Path, mesh_stiffness,
};

fn gear(teeth: u32, x: f64) -> GearSpec {
    let params = GearParams {
        teeth,
        module: 4e-3,
        tip_radius: 0.3,
        ..Default::default()
    };
    GearSpec {
        name: format!("z{teeth}"),
        body: Body::Gear(Gear::new(params).unwrap()),
        material: Material::STEEL,
        inertia: None,
        added_inertia: 0.0,
        mount: Mount::Revolute,
        guide: None,
        lateral: None,
        axes: UPRIGHT,
        position: [x, 0.0, 0.0],
        facing: 0.0,
        speed: 30.0,
        loads: vec![HubLoad::Applied(Profile::Constant(7.0))],
    }
}

fn pair(side: Side) -> SceneSpec {
    SceneSpec {
        duration: f64::INFINITY,
        gears: vec![gear(20, 0.0), gear(30, 0.1001)],
        meshes: vec![MeshSpec {
            gears: [0, 1],
            start: Start {
                side,
                gap: 20e-6,
                path_coordinate: None,
                loaded: false,
            },
        }],
        shafts: vec![],
        stages: Vec::new(),
    }
}

fn rigid(stiffness: PairStiffness, exponent: f64) -> Modelling {
    let rigid = rigid_gear::spec();
    Modelling {
        gears: vec![rigid.clone(), rigid],
        contacts: vec![ContactSpec {
            stiffness,
            exponent,
            damping: Damping::None,
            normal_force: None,
            friction: None,
            slices: None,
            flanks: FlankContact::Toothing,
        }],
    }
}

fn iso() -> PairStiffness {
    PairStiffness::Iso6336 {
        variation: IsoVariation::IsoMean,
    }
}

#[test]
fn rigid_gears_return_their_stiffness_curve() {
    for side in [Side::Left, Side::Right] {
        let (spec, modelling) = (pair(side), rigid(iso(), 1.0));
        let mut loaded = LoadedPair::new(&spec, &modelling, MODELS).unwrap();
        let layout = mesh_layout(&spec.gears[0], &spec.gears[1]).unwrap();
        let curve = stiffness_curve(
            &spec.gears[0],
            &spec.gears[1],
            &layout,
            &modelling.contacts[0],
        )
        .unwrap();
        let cycle = MeshCycle::solve(&mut loaded, Load::Force(3e3), 13, |_| {}).unwrap();
        let mut seen = 0;
        for (p, tangent) in cycle.positions.iter().zip(&cycle.tangent) {
            assert!((p.force - 3e3).abs() < 1e-3);
            // The pairs stand in the middle of where the approach has brought one of both gears.
            let at = p.s + 0.5 * p.approach;
            let place = |pair: &PairForce| at + pair.offset as f64 * layout.base_pitch;
            let on_path = |pair: &PairForce| {
                (layout.path[0] + p.approach..layout.path[1] - p.approach).contains(&place(pair))
            };
            if !p.pairs.iter().all(on_path) {
                // The edge of a tip carries a part.
                continue;
            }
            seen += 1;
            let want: f64 = p.pairs.iter().map(|pair| curve.eval(place(pair)).0).sum();
            assert!(
                (p.force / p.approach / want - 1.0).abs() < 1e-6,
                "{side:?} {}: {} {want}",
                p.s,
                p.force / p.approach
            );
            let path = Path {
                start: layout.path[0],
                end: layout.path[1],
                base_pitch: layout.base_pitch,
            };
            let whole = mesh_stiffness(&curve, path, at);
            assert!((want / whole - 1.0).abs() < 1e-12, "{side:?}");
            assert!((tangent / want - 1.0).abs() < 0.01);
        }
        assert!(seen > 6, "{seen} positions");
        // The mean of the norm's curve is its c_gamma; sampled over the cycle.
        let mean = cycle.mesh_stiffness();
        assert!((mean / 1e9 - 19.0).abs() < 2.0, "{mean}");
        assert!(cycle.peak_to_peak() > 0.2 * cycle.mean_error());
    }
}

#[test]
fn a_constant_pair_stiffness_shares_the_load_evenly() {
    let stiffness = PairStiffness::Constant {
        per_width: 1.2e10,
        of: PairOrMesh::Pair,
    };
    let mut loaded = LoadedPair::new(&pair(Side::Left), &rigid(stiffness, 1.0), MODELS).unwrap();
    let width = loaded.layout().face_width;
    let cycle = MeshCycle::solve(&mut loaded, Load::Approach(10e-6), 12, |_| {}).unwrap();
    for p in &cycle.positions {
        let whole = 1.2e10 * width * 10e-6;
        let layout = loaded.layout();
        let mut on_path = 0;
        for pair in &p.pairs {
            let at = p.s + 5e-6 + pair.offset as f64 * layout.base_pitch;
            if (layout.path[0] + 10e-6..layout.path[1] - 10e-6).contains(&at) {
                on_path += 1;
                assert!((pair.force - whole).abs() < 1e-6);
            } else {
                // The edge of a tip.
                assert!(pair.force > 0.0 && pair.force <= whole);
            }
        }
        assert!((1..=2).contains(&on_path) && p.pairs.len() <= 3);
        assert_eq!(p.pair(5), 0.0);
    }
    for value in [cycle.at_pitch_point(), cycle.single_stiffness()] {
        assert!((value / 1.2e10 - 1.0).abs() < 1e-9, "{value}");
    }
    assert_eq!(cycle.peak_to_peak(), 0.0);
    let ratio = cycle.mesh_stiffness() / 1.2e10;
    // Sampled at twelve positions the mean is the contact ratio to a twelfth, and a little more by the edges of tips.
    let contact_ratio = loaded.layout().contact_ratio;
    assert!(
        (-1.0 / 12.0..1.0 / 6.0).contains(&(ratio - contact_ratio)),
        "{ratio} {contact_ratio}"
    );
}

#[test]
fn a_nonlinear_law_takes_its_force_and_tangent() {
    let stiffness = PairStiffness::Constant {
        per_width: 1e12,
        of: PairOrMesh::Mesh,
    };
    let mut loaded = LoadedPair::new(&pair(Side::Left), &rigid(stiffness, 1.5), MODELS).unwrap();
    let (s, k) = (
        loaded.layout().pitch_point,
        1e12 * loaded.layout().face_width,
    );
    let at = loaded.under_force(s, 2000.0).unwrap();
    let want = (2000.0 / k).powf(2.0 / 3.0);
    assert!((at.approach / want - 1.0).abs() < 1e-6);
    let tangent = loaded.tangent(&at).unwrap();
    assert!((tangent / (1.5 * k * want.sqrt()) - 1.0).abs() < 1e-4);
    assert_eq!(loaded.unknowns(), 0);
    assert!(loaded.work()[0] > 2);
}

#[test]
fn a_rack_goes_along_with_its_gear() {
    let mut spec = pair(Side::Left);
    spec.gears[1] = GearSpec {
        name: "rack".into(),
        body: Body::Rack(
            Rack::new(RackParams {
                teeth: 12,
                module: 4e-3,
                tip_radius: 0.3,
                ..Default::default()
            })
            .unwrap(),
        ),
        mount: Mount::Prismatic,
        facing: std::f64::consts::PI,
        position: [0.0401, 0.0, 0.0],
        ..gear(20, 0.0)
    };
    for side in [Side::Left, Side::Right] {
        spec.meshes[0].start.side = side;
        let modelling = rigid(iso(), 1.0);
        let mut loaded = LoadedPair::new(&spec, &modelling, MODELS).unwrap();
        let layout = loaded.layout().clone();
        let curve = stiffness_curve(
            &spec.gears[0],
            &spec.gears[1],
            &layout,
            &modelling.contacts[0],
        )
        .unwrap();
        for steps in [-0.4, 0.0, 0.4] {
            let s = layout.pitch_point + steps * layout.base_pitch;
            let p = loaded.at_approach(s, 8e-6).unwrap();
            let mut seen = 0;
            for pair in &p.pairs {
                let at = s + 4e-6 + pair.offset as f64 * layout.base_pitch;
                let want = 8e-6 * curve.eval(at).0;
                if (layout.path[0] + 8e-6..layout.path[1] - 8e-6).contains(&at) {
                    seen += 1;
                    assert!(
                        (pair.force / want - 1.0).abs() < 1e-9,
                        "{} {want}",
                        pair.force
                    );
                }
            }
            assert!(seen > 0);
        }
    }
}

#[test]
fn refusals_say_what_to_do() {
    let modelling = rigid(iso(), 1.0);
    let mut three = pair(Side::Left);
    three.gears.push(gear(25, 0.3));
    let refusal = LoadedPair::new(&three, &modelling, MODELS).err();
    assert_eq!(
        refusal,
        Some(StaticsError::NotAPair {
            gears: 3,
            meshes: 1
        })
    );
    let mut loaded = LoadedPair::new(&pair(Side::Left), &modelling, MODELS).unwrap();
    let s = loaded.layout().pitch_point;
    assert!(matches!(
        loaded.under_force(s, 1e9),
        Err(StaticsError::Force { .. })
    ));
    for bad in [-1.0, 0.0, f64::NAN] {
        assert!(matches!(
            loaded.under_force(s, bad),
            Err(StaticsError::Value { .. })
        ));
    }
    assert!(matches!(
        loaded.at_approach(f64::NAN, 1e-6),
        Err(StaticsError::Value { .. })
    ));
}

/// Every force has an equilibrium at every position; where the force jumps over the approach, it is interpolated at
/// the jump.
#[test]
fn every_load_has_a_balance_at_every_position() {
    let (spec, modelling) = (pair(Side::Left), rigid(iso(), 1.0));
    let mut loaded = LoadedPair::new(&spec, &modelling, MODELS).unwrap();
    for force in [30.0, 300.0, 3e3, 1e4] {
        for count in [48, 480] {
            let cycle = MeshCycle::solve(&mut loaded, Load::Force(force), count, |_| {}).unwrap();
            for p in &cycle.positions {
                assert!((p.force / force - 1.0).abs() < 1e-6, "{} {}", p.s, p.force);
                let sum: f64 = p.pairs.iter().map(|x| x.force).sum();
                assert!((sum / force - 1.0).abs() < 1e-6, "{} {sum}", p.s);
            }
            // The mean tangent is that of one and two pairs, whatever stands on an edge.
            let tangent = cycle.mesh_tangent() / cycle.mesh_stiffness();
            assert!((tangent - 1.0).abs() < 0.05, "{force} {count}: {tangent}");
        }
    }
}
