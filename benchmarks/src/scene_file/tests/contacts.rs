//! Values of contacts: stiffness, laws, flank points.

use super::read;
use gearbench_models::law::Damping;
use gearbench_models::spec::{Passes, PointContact, PointRule, SurfaceKind};
use gearbench_models::stiffness::{
    Ends, Foundation, Hertz, Interpolation, IsoVariation, PairOrMesh, PairStiffness, RootLength,
    ToothModel,
};

#[test]
fn stiffness_and_laws() {
    let stiffness = |text: &str| {
        read("stiffness = \"iso6336\"", &format!("stiffness = {text}")).models[1]
            .modelling
            .contacts[0]
            .stiffness
            .clone()
    };
    assert_eq!(
        stiffness("{ kind = \"iso6336\", variation = \"cai-hayashi\" }"),
        PairStiffness::Iso6336 {
            variation: IsoVariation::CaiHayashi
        }
    );
    // One spring for the whole mesh suits rigid gears only.
    let scene = read(
        "stiffness_n_per_m2 = 1.4e10",
        "stiffness_n_per_m2 = 2e10, of = \"mesh\"",
    );
    assert_eq!(
        scene.models[0].modelling.contacts[0].stiffness,
        PairStiffness::Constant {
            per_width: 2e10,
            of: PairOrMesh::Mesh
        }
    );
    assert_eq!(
        stiffness(
            "{ kind = \"compliance\", tooth = \"cornell\", root_length = \"2 rb theta\", hertz = \"weber-banaschek\", \
             reference_load_n = 1000 }"
        ),
        PairStiffness::Compliance {
            tooth: ToothModel::Cornell,
            foundation: Foundation::SainsotVelex(RootLength::TwoRbThetaF),
            hertz: Hertz::WeberBanaschek {
                reference_load: 1000.0
            },
        }
    );
    assert_eq!(
        stiffness(
            "{ kind = \"table\", path_coordinate_m = [0.004, 0.024], stiffness_n_per_m = [1e8, 2e8], interpolation = \"linear\" }"
        ),
        PairStiffness::Table {
            s: vec![0.004, 0.024],
            k: vec![1e8, 2e8],
            of: PairOrMesh::Pair,
            ends: Ends::Clamped,
            interpolation: Interpolation::Linear,
        }
    );
    let damping = |text: &str| {
        read("damping = { law = \"flores\", e = 0.9 }", text).models[0]
            .modelling
            .contacts[0]
            .clone()
    };
    for id in Damping::IDS {
        let value = match id {
            "none" => "",
            "kelvin-voigt" => ", damping_ns_per_m = 100",
            "kelvin-voigt-ratio" => ", ratio = 0.05",
            _ => ", e = 0.8",
        };
        assert_eq!(
            damping(&format!("damping = {{ law = \"{id}\"{value} }}"))
                .damping
                .id(),
            id
        );
    }
    let contact = damping("friction = { mu = 0.05, v_ref_m_s = 0.01 }, slices = 4, exponent = 1.5");
    assert_eq!(contact.friction.unwrap().mu(), 0.05);
    assert_eq!((contact.slices, contact.exponent), (Some(4), 1.5));
}

#[test]
fn flank_points_with_and_without_their_settings() {
    let of = |text: &str| {
        read("stiffness = \"iso6336\"", text).models[1]
            .modelling
            .contacts[0]
            .points
    };
    assert_eq!(of("stiffness = \"iso6336\""), None);
    assert_eq!(of("penalty_pa_per_m = 1e15"), Some(PointContact::new(1e15)));
    let all = "penalty_pa_per_m = 2e14, points = { along = 5, across = 1 }, surface = \"faceted\", \
               passes = \"both\", damping_ns_per_m3 = 1e7, reach_m = 1e-4";
    assert_eq!(
        of(all),
        Some(PointContact {
            damping: 1e7,
            rule: PointRule::Quadrature {
                along: 5,
                across: 1
            },
            surface: SurfaceKind::Faceted,
            passes: Passes::Both,
            reach: Some(1e-4),
            ..PointContact::new(2e14)
        })
    );
    let nodes = of("penalty_pa_per_m = 1e15, points = \"nodes\"").unwrap();
    assert_eq!(nodes.rule, PointRule::Nodes);
    assert_eq!(
        of("law = \"penalty\", penalty_pa_per_m = 1e15"),
        of("penalty_pa_per_m = 1e15")
    );
    assert_eq!(
        of("law = \"hard\""),
        Some(PointContact::hard(PointRule::default()))
    );
    assert_eq!(
        of("law = \"hard\", points = \"nodes\", passes = \"second\""),
        Some(PointContact {
            passes: Passes::Second,
            ..PointContact::hard(PointRule::Nodes)
        })
    );
}
