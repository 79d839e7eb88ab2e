//! Values of contacts: stiffness, laws, flank points.

use super::super::{Origin, SceneFile};
use super::{changed, render};
use crate::context::Context;
use gearbench_models::law::{Damping, DampingKeys, FrictionForm};
use gearbench_models::spec::{
    ContactSpec, FlankContact, Passes, PointContact, PointRule, SurfaceKind,
};
use gearbench_models::stiffness::{
    Ends, Foundation, Hertz, Interpolation, IsoVariation, PairOrMesh, PairStiffness, RootLength,
    ToothModel,
};

/// The contact of a model of the base scene with a piece replaced; the model need not have contact points.
fn contact(model: usize, from: &str, to: &str) -> ContactSpec {
    let text = changed(from, to);
    let scene = SceneFile::unbuilt(
        &Context::default(),
        "test.toml",
        &text,
        Origin::Shipped,
        true,
    );
    let scene = scene.unwrap_or_else(|e| panic!("{}", render(&e)));
    scene.models[model].modelling.contacts[0].clone()
}

#[test]
fn stiffness() {
    let pair = PairOrMesh::Pair;
    for (text, expected) in [
        (
            "{ kind = \"iso6336\", variation = \"cai-hayashi\" }",
            PairStiffness::Iso6336 {
                variation: IsoVariation::CaiHayashi,
            },
        ),
        (
            "{ kind = \"compliance\", tooth = \"cornell\", foundation = \"sainsot-velex\", root_length = \"2 rb theta\", \
               hertz = \"weber-banaschek\", reference_load_n = 1000 }",
            PairStiffness::Compliance {
                tooth: ToothModel::Cornell,
                foundation: Foundation::SainsotVelex(RootLength::TwoRbThetaF),
                hertz: Hertz::WeberBanaschek {
                    reference_load: Some(1000.0),
                },
            },
        ),
        (
            "{ kind = \"parabola\", stiffness_n_per_m2 = 1.4e10, path_slope = -0.2 }",
            PairStiffness::Parabola {
                per_width: 1.4e10,
                along: [-0.2, 0.0],
                of: pair,
            },
        ),
        (
            "{ kind = \"table\", path_coordinate_m = [0.004, 0.024], stiffness_n_per_m = [1e8, 2e8], \
               interpolation = \"linear\" }",
            PairStiffness::Table {
                s: vec![0.004, 0.024],
                k: vec![1e8, 2e8],
                of: pair,
                ends: Ends::Clamped,
                interpolation: Interpolation::Linear,
            },
        ),
    ] {
        let to = format!("stiffness = {text}");
        let found = contact(1, "stiffness = \"iso6336\"", &to).stiffness;
        assert_eq!(found, expected, "{text}");
    }
    // One spring for the whole mesh suits rigid gears only.
    let whole = "stiffness_n_per_m2 = 2e10, of = \"mesh\"";
    assert_eq!(
        contact(0, "stiffness_n_per_m2 = 1.4e10", whole).stiffness,
        PairStiffness::Constant {
            per_width: 2e10,
            of: PairOrMesh::Mesh
        }
    );
}

#[test]
fn laws() {
    let of = |text: &str| contact(0, "damping = { law = \"flores\", e = 0.9 }", text);
    for DampingKeys { id, keys } in Damping::LAWS {
        let value: String = keys
            .iter()
            .map(|(key, _)| format!(", {key} = 0.5"))
            .collect();
        let damping = of(&format!("damping = {{ law = \"{id}\"{value} }}")).damping;
        assert_eq!(damping.id(), *id);
    }
    let contact = of("friction = { mu = 0.05, v_ref_m_s = 0.01 }, slices = 4, exponent = 1.5");
    assert_eq!(contact.friction.unwrap().mu(), 0.05);
    assert_eq!((contact.slices, contact.exponent), (Some(4), 1.5));
    let sticks = of("friction = { mu = 0.05, stick_m = 1e-6 }").friction;
    assert_eq!(sticks.unwrap().form(), FrictionForm::StickSlip(1e-6));
    let film =
        "friction = { film = { viscosity_pa_s = 0.04, roughness_m = 4e-7 }, v_ref_m_s = 0.01 }";
    let film = of(film).friction.unwrap().film().unwrap();
    assert_eq!((film.roughness, film.lubricant), (4e-7, 1.0));
}

#[test]
fn flank_points_with_and_without_their_settings() {
    let all = "penalty_pa_per_m = 2e14, points = { along = 5, across = 1 }, surface = \"faceted\", \
               passes = \"both\", damping_ns_per_m3 = 1e7, reach_m = 1e-4";
    let penalty = PointContact::new(1e15);
    for (text, expected) in [
        ("stiffness = \"iso6336\"", FlankContact::Toothing),
        ("penalty_pa_per_m = 1e15", penalty.into()),
        ("law = \"penalty\", penalty_pa_per_m = 1e15", penalty.into()),
        (
            all,
            FlankContact::Points(PointContact {
                rule: PointRule::Quadrature {
                    along: 5,
                    across: 1,
                },
                surface: SurfaceKind::Faceted,
                passes: Passes::Both,
                reach: Some(1e-4),
                ..PointContact::new(2e14).damped(1e7)
            }),
        ),
        (
            "penalty_pa_per_m = 1e15, points = \"nodes\"",
            FlankContact::Points(PointContact {
                rule: PointRule::Nodes,
                ..penalty
            }),
        ),
        (
            "penalty_n_per_m = 3.5e7, points = \"nodes\"",
            FlankContact::Points(PointContact {
                rule: PointRule::EachNode,
                ..PointContact::new(3.5e7)
            }),
        ),
        ("local = \"half-space\"", FlankContact::HalfSpace),
        ("local = \"mesh\", penalty_pa_per_m = 1e15", penalty.into()),
        (
            "law = \"hard\"",
            FlankContact::Points(PointContact::hard(PointRule::default())),
        ),
        (
            "law = \"hard\", points = \"nodes\", passes = \"second\"",
            FlankContact::Points(PointContact {
                passes: Passes::Second,
                ..PointContact::hard(PointRule::Nodes)
            }),
        ),
    ] {
        let found = contact(1, "stiffness = \"iso6336\"", text).flanks;
        assert_eq!(found, expected, "{text}");
    }
}
