//! Reports of natural frequencies.

use crate::{finding, has_only_numbers, holds, written};
use gearbench_reports::modes::{
    LinearisedState, MemberPlace, MemberShape, MeshState, ModeRecord, ModelModes, ModesRecord,
};
use gearbench_reports::{Part, Results};

fn member(name: &str, x_m: f64) -> MemberPlace {
    MemberPlace {
        name: name.into(),
        x_m,
        radius_m: 0.04,
        toothed: true,
        in_plane: true,
        ..MemberPlace::default()
    }
}

fn mode(frequency_hz: f64, name: &str, strain: Vec<f64>, turns: [f64; 2]) -> ModeRecord {
    let shape = turns.map(|turn_rad| MemberShape {
        turn_rad,
        x_m: 0.1 * turn_rad * 0.04,
        ..MemberShape::default()
    });
    ModeRecord {
        frequency_hz,
        multiplicity: 1,
        damping_ratio: (frequency_hz > 0.0).then_some(0.021),
        damped_frequency_hz: None,
        name: name.into(),
        kinetic: vec![0.25, 0.75],
        strain,
        shape: shape.to_vec(),
    }
}

pub fn of_models() -> Results {
    let pair = ModelModes {
        label: "rigid".into(),
        about: LinearisedState::Loaded,
        coordinates: 2,
        steps: 7,
        residual_rel: 1e-16,
        frequencies: 3,
        highest_hz: 4321.5,
        meshes: vec![MeshState {
            name: "pinion - wheel".into(),
            force_n: 1520.0,
        }],
        members: vec![member("pinion", 0.0), member("wheel", 0.1)],
        springs: vec!["mesh pinion - wheel".into(), "torsion of <output>".into()],
        modes: vec![
            mode(0.0, "rigid motion", vec![], [2.5e-5, -1.6e-5]),
            mode(
                177.3,
                "torsion of <output>",
                vec![0.02, 0.98],
                [2.5e-5, -1.2e-5],
            ),
            mode(
                4321.5,
                "mesh pinion - wheel",
                vec![0.99, 0.01],
                [2.5e-5, 1.6e-5],
            ),
        ],
        ..ModelModes::default()
    };
    let lost = ModelModes {
        label: "elastic".into(),
        about: LinearisedState::NotFound,
        message: "no equilibrium under its loads was found".into(),
        ..ModelModes::default()
    };
    Results {
        part: Part::Modes(ModesRecord {
            vibrations: vec![pair, lost],
        }),
        ..Results::default()
    }
}

#[test]
fn natural_frequencies_are_told_with_where_their_energy_lies() {
    let files = written(&of_models());
    holds(
        &files,
        &[
            "modes.csv",
            "modes_energy.csv",
            "modes_shapes.csv",
            "modes_energy_rigid.svg",
            "modes_shapes_rigid.svg",
        ],
    );
    has_only_numbers(&files);
    let page = &files["index.html"];
    let found = finding(page);
    for words in ["177.30", "torsion of &lt;output&gt;", "no equilibrium"] {
        assert!(found.contains(words), "{words} in {found}");
    }
    assert!(
        page.contains("mesh pinion - wheel 99") && page.contains("2.10"),
        "shares and damping"
    );
    assert_eq!(files["modes_shapes.csv"].lines().count(), 1 + 3 * 2);
    assert_eq!(files["modes_energy.csv"].lines().count(), 1 + 3 * 2 + 2 * 2);
}
