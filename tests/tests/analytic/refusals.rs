//! Scenes that cannot be assembled: every message names the cause and a way out.

use gearbench_models::geometry::Side;
use gearbench_models::law::Damping;
use gearbench_models::scene::Scene;
use gearbench_models::spec::{
    ContactSpec, Load, MeshSpec, ModelSpec, Modelling, Mount, Profile, SceneSpec, Value,
};
use gearbench_models::stiffness::{PairOrMesh, PairStiffness};
use gearbench_tests::*;

/// The message with which a scene is refused; it must contain all of the words.
fn refused(spec: &SceneSpec, gears: &[ModelSpec], contact: &ContactSpec, words: &[&str]) {
    let message = match try_build(spec, gears, contact) {
        Ok(_) => panic!("was built, expected a refusal with {words:?}"),
        Err(e) => e.to_string(),
    };
    for word in words {
        assert!(message.contains(word), "`{message}` does not say `{word}`");
    }
}

fn rigid_pair() -> [ModelSpec; 2] {
    [rigid(), rigid()]
}

#[test]
fn positions_and_starts() {
    let c = contact(1.5e10);
    let mut far = case_a(3e-6);
    far.gears[1].position = [0.12, 0.0];
    refused(
        &far,
        &rigid_pair(),
        &c,
        &["`pinion` and `wheel`", "distance must stay below"],
    );
    let mut near = case_a(3e-6);
    near.gears[1].position = [0.09, 0.0];
    refused(&near, &rigid_pair(), &c, &["`pinion` and `wheel`"]);

    let mut start = case_a(3e-6);
    start.meshes[0].start.path_coordinate = Some(0.1);
    refused(
        &start,
        &rigid_pair(),
        &c,
        &["outside the path of contact", "1.000000e-1"],
    );
    refused(
        &case_a(500e-6),
        &rigid_pair(),
        &c,
        &["right flanks overlap", "backlash", "use a gap"],
    );
    refused(
        &case_a(-500e-6),
        &rigid_pair(),
        &c,
        &["left flanks overlap", "use a gap"],
    );
    refused(&case_a(f64::NAN), &rigid_pair(), &c, &["gap", "no"]);

    // Three gears in a triangle: the last mesh finds both of its gears placed, and teeth where teeth are.
    let mut closed = case_a(3e-6);
    closed.gears[1] = gear("wheel", spur(20), 0.0801, 0.0);
    let mut third = gear("third", spur(20), 0.04005, 0.0);
    third.position[1] = 0.0801 * 0.75_f64.sqrt();
    closed.gears.push(third);
    closed.meshes = [[0, 1], [1, 2], [0, 2]]
        .map(|gears| MeshSpec {
            gears,
            start: start_of(),
        })
        .to_vec();
    refused(
        &closed,
        &[rigid(), rigid(), rigid()],
        &c,
        &["`pinion` and `third`", "flanks overlap", "another position"],
    );
}

fn start_of() -> gearbench_models::spec::Start {
    start(Side::Left, 3e-6)
}

#[test]
fn mounts_loads_and_inertias() {
    let c = contact(1.5e10);
    let mut slide = case_a(3e-6);
    slide.gears[1].mount = Mount::Prismatic;
    refused(
        &slide,
        &rigid_pair(),
        &c,
        &["`wheel`", "prismatic", "use revolute"],
    );
    let mut turn = pair_of(
        gear("pinion", spur(20), 0.0, 1.0),
        rack("rack", 20, 0.0401, 0.0),
        start_of(),
    );
    turn.gears[1].mount = Mount::Revolute;
    refused(
        &turn,
        &rigid_pair(),
        &c,
        &["`rack`", "cannot turn", "use prismatic"],
    );
    turn.gears[1].mount = Mount::Prismatic;
    turn.meshes[0].gears = [1, 0];
    refused(&turn, &rigid_pair(), &c, &["rack", "name the gear first"]);

    let mut weightless = case_a(3e-6);
    weightless.gears[0].inertia = Some(0.0);
    refused(
        &weightless,
        &rigid_pair(),
        &c,
        &["`pinion`", "inertia 0", "not positive"],
    );

    let mut ramp = case_a(3e-6);
    let backwards = Profile::Ramp {
        from: 0.0,
        to: 1.0,
        start: 0.2,
        end: 0.1,
    };
    ramp.gears[0].loads = vec![Load::Applied(backwards.clone())];
    refused(&ramp, &rigid_pair(), &c, &["`pinion`", "load", "no length"]);
    ramp.gears[0].loads = vec![Load::Viscous(-1.0)];
    refused(
        &ramp,
        &rigid_pair(),
        &c,
        &["`pinion`", "viscous coefficient -1"],
    );
    ramp.gears[0].loads.clear();
    ramp.gears[0].mount = Mount::Driven(backwards);
    refused(
        &ramp,
        &rigid_pair(),
        &c,
        &["`pinion`", "driven motion", "no length"],
    );
}

#[test]
fn models_and_their_parameters() {
    let c = contact(1.5e10);
    let spec = case_a(3e-6);
    let both = |m: ModelSpec| [m, rigid()];
    let unknown = ModelSpec {
        id: "rubber".into(),
        parameters: Default::default(),
    };
    refused(
        &spec,
        &both(unknown),
        &c,
        &[
            "`pinion`",
            "no model `rubber`",
            "movable-teeth",
            "elastic-web",
        ],
    );
    refused(
        &spec,
        &both(with(rigid(), "k", Value::Number(1.0))),
        &c,
        &["`rigid`", "`k`", "it takes none"],
    );
    let teeth = || movable(5e8, 5e-3, 0.0);
    let set = |key: &str, value: Value| both(with(teeth(), key, value));
    refused(
        &spec,
        &set("tooth_weight", Value::Number(1.0)),
        &c,
        &["`tooth_weight`", "it takes", "tooth_mass_kg"],
    );
    refused(
        &spec,
        &set("tooth_mass_kg", Value::Number(-1.0)),
        &c,
        &["`tooth_mass_kg`", "-1 is not positive"],
    );
    refused(
        &spec,
        &set("tooth_mass_kg", Value::Number(0.5)),
        &c,
        &["`pinion`", "smaller tooth mass"],
    );
    refused(
        &spec,
        &set("tooth_mass_kg", Value::List(vec![1e-3; 7])),
        &c,
        &["7 values for 20 teeth"],
    );
    refused(
        &spec,
        &set("tooth_mass_kg", Value::Text("light".into())),
        &c,
        &["expected a number", "light"],
    );
    refused(
        &spec,
        &set("integrate", Value::Text("some".into())),
        &c,
        &["\"active\" or \"all\""],
    );
    refused(
        &spec,
        &set("stiffness_radius_m", Value::List(vec![0.04, 0.05])),
        &c,
        &["needs both"],
    );
    let mut missing = teeth();
    missing.parameters.remove("tooth_stiffness_n_per_m");
    refused(
        &spec,
        &both(missing),
        &c,
        &["`tooth_stiffness_n_per_m`", "is missing", "identify"],
    );
    // The example refuses in the same manner.
    refused(
        &spec,
        &both(with(web(0.0), "rim_share", Value::Number(1.5))),
        &c,
        &["`elastic-web`", "`rim_share`", "below 1"],
    );
}

#[test]
fn contacts() {
    let spec = case_a(3e-6);
    let c = || contact(1.5e10);
    let with_damping = |exponent, damping| ContactSpec {
        exponent,
        damping,
        ..c()
    };
    refused(
        &spec,
        &rigid_pair(),
        &with_damping(4.0, Damping::None),
        &["exponent", "[1, 3]"],
    );
    refused(
        &spec,
        &rigid_pair(),
        &with_damping(1.0, Damping::Flores { e: 0.0 }),
        &["restitution", "(0, 1]"],
    );
    let ratio = Damping::KelvinVoigtRatio { ratio: 0.1 };
    refused(
        &spec,
        &rigid_pair(),
        &with_damping(1.5, ratio),
        &["linear law only", "give c"],
    );
    let mut held = case_a(3e-6);
    held.gears[0].mount = Mount::Fixed;
    held.gears[1].mount = Mount::Driven(Profile::Constant(1.0));
    refused(
        &held,
        &rigid_pair(),
        &with_damping(1.0, ratio),
        &["both are held", "N s/m"],
    );
    refused(
        &spec,
        &rigid_pair(),
        &contact(-1.0),
        &["stiffness", "positive"],
    );
    refused(
        &spec,
        &rigid_pair(),
        &ContactSpec {
            slices: Some(0),
            ..c()
        },
        &["0 slices", "1 to 1000"],
    );
    let mesh = ContactSpec {
        stiffness: PairStiffness::Constant {
            per_width: 2e10,
            of: PairOrMesh::Mesh,
        },
        ..c()
    };
    refused(
        &spec,
        &[movable(5e8, 5e-3, 0.0), rigid()],
        &mesh,
        &["whole mesh", "`pinion`", "of a tooth pair"],
    );
    assert!(try_build(&spec, &rigid_pair(), &mesh).is_ok());
}

#[test]
fn counts_must_agree() {
    let modelling = Modelling {
        gears: vec![rigid()],
        contacts: vec![contact(1.5e10)],
    };
    let message = match Scene::build(&case_a(3e-6), &modelling, &models()) {
        Ok(_) => panic!("one model for two gears was accepted"),
        Err(e) => e.to_string(),
    };
    assert!(
        message.contains("2 gears") && message.contains("1 models"),
        "{message}"
    );
}
