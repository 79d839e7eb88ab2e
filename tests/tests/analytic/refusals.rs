//! Scenes that cannot be assembled: every message has the cause and a remedy.

use gearbench::context::Context;
use gearbench::scene_file::{Origin, SceneFile};
use gearbench_models::gear::parameters::ModelParameters;
use gearbench_models::geometry::Side;
use gearbench_models::law::Damping;
use gearbench_models::scene::Scene;
use gearbench_models::spec::{
    ContactSpec, Load, MeshSpec, ModelSpec, Modelling, Mount, Profile, SceneSpec, Start,
    mesh_layout,
};
use gearbench_models::stiffness::{PairOrMesh, PairStiffness};
use gearbench_tests::*;
use serde_json::Value;

/// Checks that a scene is refused with a message that contains all of the words.
fn refused(spec: &SceneSpec, gears: &[ModelSpec], contact: &ContactSpec, words: &[&str]) {
    let message = match try_build(spec, gears, contact) {
        Ok(_) => panic!("was built, expected a refusal with {words:?}"),
        Err(e) => e.to_string(),
    };
    says(&message, words);
}

/// Checks that a message contains all of the words.
fn says(message: &str, words: &[&str]) {
    for word in words {
        assert!(message.contains(word), "`{message}` does not say `{word}`");
    }
}

/// Checks that a changed scene of rigid gears is refused.
fn scene(change: impl FnOnce(&mut SceneSpec), words: &[&str]) {
    let mut spec = case_a(3e-6);
    change(&mut spec);
    let gears = vec![rigid(); spec.gears.len()];
    refused(&spec, &gears, &contact(1.5e10), words);
}

/// Checks that a model of the pinion is refused.
fn model(pinion: ModelSpec, words: &[&str]) {
    let gears = [pinion, rigid()];
    refused(&case_a(3e-6), &gears, &contact(1.5e10), words);
}

/// Checks that a parameter of a model is refused, where it is given or where the gear is built.
fn parameter(mut pinion: ModelSpec, key: &str, value: impl Into<Value>, words: &[&str]) {
    match pinion.set(key, value) {
        Ok(()) => model(pinion, words),
        Err(e) => says(&e.to_string(), words),
    }
}

const START: Start = Start {
    side: Side::Left,
    gap: 3e-6,
    path_coordinate: None,
    loaded: false,
};

#[test]
fn positions_and_starts() {
    let pair = "`pinion` and `wheel`";
    scene(
        |s| s.gears[1].position = [0.12, 0.0, 0.0],
        &[pair, "distance must stay below"],
    );
    scene(|s| s.gears[1].position = [0.09, 0.0, 0.0], &[pair]);
    scene(
        |s| s.meshes[0].start.path_coordinate = Some(0.1),
        &["outside the path of contact", "1.000000e-1"],
    );
    for (gap, words) in [
        (500e-6, ["right flanks overlap", "use a gap"]),
        (500e-6, ["backlash", "use a gap"]),
        (-500e-6, ["left flanks overlap", "use a gap"]),
        (f64::NAN, ["gap", "no"]),
    ] {
        scene(|s| s.meshes[0].start.gap = gap, &words);
    }
    // Three gears in a triangle: the last mesh finds both of its gears placed, and teeth where teeth are.
    scene(
        |s| {
            s.gears[1] = gear("wheel", spur(20), 0.0801, 0.0);
            let mut third = gear("third", spur(20), 0.04005, 0.0);
            third.position[1] = 0.0801 * 0.75_f64.sqrt();
            s.gears.push(third);
            let start = START;
            s.meshes = [[0, 1], [1, 2], [0, 2]]
                .map(|gears| MeshSpec { gears, start })
                .to_vec();
        },
        &["`pinion` and `third`", "flanks overlap", "another position"],
    );
}

#[test]
fn mounts_loads_and_inertias() {
    scene(
        |s| s.gears[1].mount = Mount::Prismatic,
        &["`wheel`", "prismatic", "use revolute"],
    );
    let on_rack = |s: &mut SceneSpec| {
        let pinion = gear("pinion", spur(20), 0.0, 1.0);
        *s = pair_of(pinion, rack("rack", 20, 0.0401, 0.0), START);
    };
    scene(
        |s| {
            on_rack(s);
            s.gears[1].mount = Mount::Revolute;
        },
        &["`rack`", "cannot turn", "use prismatic"],
    );
    scene(
        |s| {
            on_rack(s);
            s.meshes[0].gears = [1, 0];
        },
        &["rack", "name the gear first"],
    );
    scene(
        |s| s.gears[0].inertia = Some(0.0),
        &["`pinion`", "inertia 0", "not positive"],
    );
    let backwards = Profile::Ramp {
        from: 0.0,
        to: 1.0,
        start: 0.2,
        end: 0.1,
    };
    let applied = Load::Applied(backwards.clone());
    scene(
        |s| s.gears[0].loads = vec![applied],
        &["`pinion`", "load", "no length"],
    );
    scene(
        |s| s.gears[0].loads = vec![Load::Viscous(-1.0)],
        &["`pinion`", "viscous coefficient -1"],
    );
    scene(
        |s| s.gears[0].mount = Mount::Driven(backwards),
        &["`pinion`", "driven motion", "no length"],
    );
}

#[test]
fn models_and_their_parameters() {
    // A model of another program, whose table has it.
    gearbench_models::declare_parameters! {
        /// It has none.
        struct RubberParameters model "rubber" {}
    }
    let unknown = RubberParameters {}.spec();
    let known = [
        "`pinion`",
        "no model `rubber`",
        "movable-teeth",
        "elastic-web",
    ];
    model(unknown, &known);
    parameter(
        rigid(),
        "k",
        1.0,
        &["`rigid`", "`k`", "it has no parameters"],
    );
    let teeth = || movable(5e8, 5e-3, 0.0);
    let (mass, text) = ("tooth_mass_kg", |x: &str| Value::from(x));
    let radii = Value::from(vec![0.04, 0.05]);
    for (key, value, words) in [
        ("tooth_weight", Value::from(1.0), ["`tooth_weight`", mass]),
        (
            mass,
            Value::from(-1.0),
            ["`tooth_mass_kg`", "-1 is not positive"],
        ),
        (mass, Value::from(0.5), ["`pinion`", "smaller tooth mass"]),
        (
            mass,
            Value::from(vec![1e-3; 7]),
            ["7 values", "for 20 teeth"],
        ),
        (mass, text("light"), ["expected a number", "light"]),
        (
            "integrate",
            text("some"),
            ["integrate", "\"active\" or \"all\""],
        ),
        (
            "stiffness_radius_m",
            radii,
            ["stiffness_radius_m", "needs both"],
        ),
    ] {
        parameter(teeth(), key, value, &words);
    }
    let mut missing = teeth();
    missing.unset("tooth_stiffness_n_per_m").unwrap();
    model(
        missing,
        &["`tooth_stiffness_n_per_m`", "is missing", "identify"],
    );
    // The example refuses in the same manner.
    model(
        with(web(0.0), "rim_share", 1.5),
        &["`elastic-web`", "`rim_share`", "below 1"],
    );
}

#[test]
fn contacts() {
    let spec = case_a(3e-6);
    let rigid_pair = [rigid(), rigid()];
    let with_damping = |exponent, damping| ContactSpec {
        exponent,
        damping,
        ..contact(1.5e10)
    };
    let no_slices = ContactSpec {
        slices: Some(0),
        ..contact(1.5e10)
    };
    let ratio = Damping::KelvinVoigtRatio { ratio: 0.1 };
    for (contact, words) in [
        (with_damping(4.0, Damping::None), ["exponent", "[1, 3]"]),
        (
            with_damping(1.0, Damping::Flores { e: 0.0 }),
            ["restitution", "(0, 1]"],
        ),
        (with_damping(1.5, ratio), ["linear law only", "give c"]),
        (contact(-1.0), ["stiffness", "positive"]),
        (no_slices, ["0 slices", "1 to 1000"]),
    ] {
        refused(&spec, &rigid_pair, &contact, &words);
    }
    let mut held = case_a(3e-6);
    held.gears[0].mount = Mount::Fixed;
    held.gears[1].mount = Mount::Driven(Profile::Constant(1.0));
    let words = ["both are fixed", "N s/m"];
    refused(&held, &rigid_pair, &with_damping(1.0, ratio), &words);
    let mesh = ContactSpec {
        stiffness: PairStiffness::Constant {
            per_width: 2e10,
            of: PairOrMesh::Mesh,
        },
        ..contact(1.5e10)
    };
    refused(
        &spec,
        &[movable(5e8, 5e-3, 0.0), rigid()],
        &mesh,
        &["whole mesh", "`pinion`", "of a tooth pair"],
    );
    assert!(try_build(&spec, &rigid_pair, &mesh).is_ok());
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

/// `gap_m` lies along the normal of the flank. Of helical gears the backlash in the transverse plane is larger than the normal
/// backlash by `1/cos(beta_b)`.
#[test]
fn gaps_are_compared_with_the_normal_backlash() {
    for helix in [0.0, 15.0, 25.0] {
        let text = |gap: &str| {
            format!(
                "schema = 1\nname = \"pair\"\nduration_s = 1e-3\n\
                 [gears.pinion]\nteeth = 20\nmodule_m = 0.004\nface_width_m = 0.03\nbore_radius_m = 0.01\nhelix_angle_deg = {helix:?}\nspeed_rad_s = 1.0\n\
                 [gears.wheel]\nteeth = 31\nmodule_m = 0.004\nface_width_m = 0.03\nbore_radius_m = 0.01\nhelix_angle_deg = {:?}\n\
                 [[meshes]]\ngears = [\"pinion\", \"wheel\"]\nbacklash_m = 1e-4\nstart = {{ flank = \"left\"{gap} }}\n\
                 [[models]]\nmodel = \"rigid\"\ncontact = {{ stiffness = \"iso6336\" }}\n",
                -helix
            )
        };
        let scene = SceneFile::unbuilt(
            &Context::default(),
            "pair",
            &text(""),
            Origin::Shipped,
            true,
        )
        .unwrap();
        let spec = scene.spec_for(scene.model("rigid").unwrap());
        let [one, two] = [0, 1].map(|i| &spec.gears[i]);
        let normal = mesh_layout(one, two).unwrap().pair.backlash_normal();
        let with = |part: f64| {
            let text = text(&format!(", gap_m = {:e}", part * normal));
            SceneFile::unbuilt(&Context::default(), "pair", &text, Origin::Shipped, true)
        };
        assert!(with(0.999).is_ok(), "{helix} degrees");
        let shown = with(1.001).err().unwrap().to_string();
        assert!(shown.contains("larger than the normal backlash"), "{shown}");
    }
}
