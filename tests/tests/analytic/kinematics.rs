//! Torque ratio, magnitude of the contact force, and invariants of the line of action.

use gearbench_integrators::{Events, Outputs, Report, SecondOrderSystem, State};
use gearbench_models::geometry::{
    Gear, GearParams, Modifications, Pair, ReliefShape, Side, TipRelief,
};
use gearbench_models::law::Damping;
use gearbench_models::spec::{Body, ContactSpec, SceneSpec};
use gearbench_models::stiffness::{
    Ends, Foundation, Hertz, Interpolation, IsoVariation, PairOrMesh, PairStiffness, RootLength,
    ToothModel,
};
use gearbench_tests::*;

fn stiffnesses() -> Vec<PairStiffness> {
    let s: Vec<f64> = (0..9).map(|i| 4e-3 + 2e-3 * f64::from(i)).collect();
    let k = vec![
        1.1e8, 1.2e8, 1.4e8, 1.5e8, 1.6e8, 1.5e8, 1.35e8, 1.2e8, 1.15e8,
    ];
    vec![
        PairStiffness::Constant {
            per_width: 1.5e10,
            of: PairOrMesh::Pair,
        },
        PairStiffness::Constant {
            per_width: 2.2e10,
            of: PairOrMesh::Mesh,
        },
        PairStiffness::Iso6336 {
            variation: IsoVariation::IsoMean,
        },
        PairStiffness::Iso6336 {
            variation: IsoVariation::CaiHayashi,
        },
        PairStiffness::Compliance {
            tooth: ToothModel::WeberBanaschek,
            foundation: Foundation::SainsotVelex(RootLength::TwoRfThetaF),
            hertz: Hertz::Linear,
        },
        PairStiffness::Table {
            s,
            k,
            of: PairOrMesh::Pair,
            ends: Ends::Clamped,
            interpolation: Interpolation::Linear,
        },
    ]
}

fn base_radii(spec: &SceneSpec) -> [f64; 2] {
    [0, 1].map(|i| match &spec.gears[i].body {
        Body::Gear(g) => g.r_base(),
        Body::Rack(_) => unreachable!("two gears"),
    })
}

#[test]
fn the_torque_ratio_is_the_tooth_ratio_in_the_mean_of_a_mesh_cycle() {
    // Loaded rotation over five pitches, both flanks, every stiffness, with profile shift and damping as well.
    let shifted = || {
        let (a, b) = (
            GearParams {
                profile_shift: 0.3,
                ..spur(20)
            },
            GearParams {
                profile_shift: 0.2,
                ..spur(31)
            },
        );
        let (ga, gb) = (Gear::new(a.clone()).unwrap(), Gear::new(b.clone()).unwrap());
        let x = Pair::centre_distance_for_backlash(&ga, &gb, 50e-6).unwrap();
        pair_of(
            gear("pinion", a, 0.0, 3.0),
            gear("wheel", b, x, 0.0),
            start(Side::Left, 0.0),
        )
    };
    for spec in [case_a(0.0), shifted()] {
        for side in Side::BOTH {
            for stiffness in stiffnesses() {
                for damping in [Damping::None, Damping::Flores { e: 0.8 }] {
                    let mut spec = spec.clone();
                    spec.meshes[0].start = start(side, 0.0);
                    let z = [0, 1].map(|i| match &spec.gears[i].body {
                        Body::Gear(g) => f64::from(g.teeth()),
                        Body::Rack(_) => unreachable!("two gears"),
                    });
                    let contact = ContactSpec {
                        stiffness: stiffness.clone(),
                        damping,
                        ..contact(1.5e10)
                    };
                    let constant = matches!(stiffness, PairStiffness::Constant { .. });
                    let mut scene = build(&spec, &[rigid(), rigid()], &contact);
                    let [r1, r2] = base_radii(&spec);
                    let depth = side.sign() * 4e-6;
                    let (mut sums, mut on_path) = ([0.0; 2], 0);
                    // One pitch of the pinion in equal steps.
                    let places = 400;
                    let step = std::f64::consts::TAU / z[0] / f64::from(places);
                    for place in 0..places {
                        let roll = step * f64::from(place);
                        let mut s = scene.initial();
                        s.q = vec![roll + depth / r1, -roll * r1 / r2];
                        s.v = vec![side.sign() * 3.0, -side.sign() * 2.9 * r1 / r2];
                        scene.begin(&mut s, place % 2 == 0);
                        let t = [
                            channel(&mut scene, &s, "contact_torque:pinion"),
                            channel(&mut scene, &s, "contact_torque:wheel"),
                        ];
                        let force = channel(&mut scene, &s, "force:0");
                        assert!(force > 100.0, "{} at {roll}: {force} N", stiffness.id());
                        // Both torques have one sign: the driver is held back, the wheel is driven backwards.
                        let ratio = t[1] / t[0] / (z[1] / z[0]);
                        // On the path, with constant stiffness, the ratio holds at every angle.
                        let pressed = candidates(&scene, &s);
                        let mut pressed = pressed.iter().filter(|(_, c)| c.gap < 0.0);
                        if constant && pressed.all(|(_, c)| c.scale == [1.0; 2]) {
                            on_path += 1;
                            assert!(
                                (ratio - 1.0).abs() < 1e-9,
                                "{} {side:?} {roll}: {ratio}",
                                stiffness.id()
                            );
                            assert!(
                                (t[0].abs() / (force * r1) - 1.0).abs() < 1e-9,
                                "force off the line of action"
                            );
                        }
                        assert!((ratio - 1.0).abs() < 0.05, "{ratio}");
                        assert!(t[0] * side.sign() < 0.0);
                        sums = [sums[0] + t[0], sums[1] + t[1]];
                        // The channel is what acts on the coordinates.
                        let mut f = vec![0.0; 2];
                        scene.force(s.at(), &mut f);
                        assert!(
                            (f[0] / t[0] - 1.0).abs() < 1e-12 && (f[1] / t[1] - 1.0).abs() < 1e-12
                        );
                    }
                    assert!(!constant || on_path > 300, "{on_path}");
                    // Elastic contact does no work over a cycle; a damper does, as flanks part and close.
                    let mean = sums[1] / sums[0] / (z[1] / z[0]);
                    let allowed = if damping == Damping::None { 2e-5 } else { 2e-3 };
                    assert!((mean - 1.0).abs() < allowed, "{}: {mean}", stiffness.id());
                }
            }
        }
    }
}

#[test]
fn on_modified_flanks_the_torques_follow_the_slope_of_the_flank() {
    // Relief turns the normal: the torque ratio is z2/z1 times (1 - e_2')/(1 - e_1'), and the channels are
    // what acts on the coordinates, energy included: the force is the gradient of the contact's energy.
    let tip = Gear::new(spur(20)).unwrap().r_tip();
    let relief = Modifications {
        tip_relief: Some(TipRelief {
            amount: 20e-6,
            start_radius: tip - 2.5e-3,
            shape: ReliefShape::Parabolic,
        }),
        ..Modifications::default()
    };
    let mut spec = case_a(0.0);
    spec.gears[0].body = Body::Gear(
        Gear::new(GearParams {
            modifications: relief,
            ..spur(20)
        })
        .unwrap(),
    );
    let mut scene = build(&spec, &[rigid(), rigid()], &contact(1.5e10));
    let [r1, r2] = base_radii(&spec);
    let mut turned = 0.0_f64;
    for place in 0..60 {
        let roll = 0.0079 * f64::from(place);
        let mut s = scene.initial();
        s.q = vec![roll + 30e-6 / r1, -roll * r1 / r2];
        let t =
            ["pinion", "wheel"].map(|n| channel(&mut scene, &s, &format!("contact_torque:{n}")));
        let mut f = vec![0.0; 2];
        scene.force(s.at(), &mut f);
        assert!(
            (f[0] / t[0] - 1.0).abs() < 1e-12 && (f[1] / t[1] - 1.0).abs() < 1e-12,
            "{f:?} {t:?}"
        );
        let energy = |s: &State, scene: &mut gearbench_models::scene::Scene| {
            let mut out = Outputs::default();
            scene.output(s.at(), &mut out);
            out.energy.contact
        };
        for i in 0..2 {
            let h = 1e-8;
            let mut above = s.clone();
            let mut below = s.clone();
            above.q[i] += h;
            below.q[i] -= h;
            let slope = (energy(&above, &mut scene) - energy(&below, &mut scene)) / (2.0 * h);
            // Not where a pair enters or leaves between the two.
            if candidates(&scene, &above).len() == candidates(&scene, &below).len() {
                assert!((f[i] + slope).abs() < 1e-5 * f[i].abs(), "{} {slope}", f[i]);
            }
        }
        turned = turned.max((t[1] / t[0] / 1.5 - 1.0).abs());
    }
    assert!(turned > 1e-4, "the relief turns nothing");
}

#[test]
fn pairs_in_contact_share_the_load() {
    // Constant stiffness: the force is k d times the number of pairs on the path of contact, which on average is the
    // contact ratio; the edges of tips beside the path carry more the deeper the flanks overlap, with the root of it.
    let spec = case_a(0.0);
    let [r1, r2] = base_radii(&spec);
    let (Body::Gear(a), Body::Gear(b)) = (&spec.gears[0].body, &spec.gears[1].body) else {
        unreachable!()
    };
    let ratio = Pair::new(a, b, 0.1001).unwrap().contact_ratio();
    let mut scene = build(&spec, &[rigid(), rigid()], &contact(1.5e10));
    let beside = [4e-6, 4e-8].map(|depth| {
        let (mut sum, n) = (0.0, 20_000);
        for i in 0..n {
            let roll = a.pitch_angle() * (f64::from(i) + 0.5) / f64::from(n);
            let mut s = scene.initial();
            s.q = vec![roll + depth / r1, -roll * r1 / r2];
            let pairs = channel(&mut scene, &s, "force:0") / (1.5e8 * depth);
            assert!((1.0 - 1e-9..=2.0 + 1e-9).contains(&pairs), "{pairs} pairs");
            sum += pairs;
        }
        sum / f64::from(n) - ratio
    });
    assert!(beside[0] > 0.0 && beside[0] < 0.05, "{beside:?}");
    assert!(
        (beside[0] / beside[1] / 10.0 - 1.0).abs() < 0.1,
        "{beside:?}"
    );
}

#[test]
fn helical_slices_share_one_stiffness() {
    // A helical pair pressed together at any angle: the force is k d times the length of the contact lines, and a little
    // beside their ends.
    let beta = 15f64.to_radians();
    let helix = |b: f64, z: u32| GearParams {
        helix_angle: b,
        face_width: 0.02,
        ..spur(z)
    };
    let x = 0.1001 / beta.cos();
    let spec = pair_of(
        gear("a", helix(beta, 20), 0.0, 0.0),
        gear("b", helix(-beta, 30), x, 0.0),
        start(Side::Left, 0.0),
    );
    let (Body::Gear(a), Body::Gear(b)) = (&spec.gears[0].body, &spec.gears[1].body) else {
        unreachable!()
    };
    let pair = Pair::new(a, b, x).unwrap();
    let mut scene = build(&spec, &[rigid(), rigid()], &contact(1.5e10));
    let depth = 4e-8;
    let (mut sum, mut sums) = (0.0, [0.0; 2]);
    let n = 800;
    for i in 0..n {
        let roll = a.pitch_angle() * (f64::from(i) + 0.5) / f64::from(n);
        let mut s: State = scene.initial();
        s.q = vec![roll + depth / a.r_base(), -roll * a.r_base() / b.r_base()];
        let mut f = vec![0.0; 2];
        scene.force(s.at(), &mut f);
        sums = [sums[0] + f[0], sums[1] + f[1]];
        // Normal gap and the effective base radius of the normal force carry a cosine of the base helix angle each.
        sum += -f[0] / (3e8 * depth * a.r_base() * a.base_helix_angle().cos().powi(2));
    }
    let ratio = sums[1] / sums[0];
    assert!((ratio / 1.5 - 1.0).abs() < 1e-6, "{ratio}");
    let mean = sum / f64::from(n);
    assert!(
        (mean - pair.contact_ratio()).abs() < 1e-2,
        "{mean} against {}",
        pair.contact_ratio()
    );
}
