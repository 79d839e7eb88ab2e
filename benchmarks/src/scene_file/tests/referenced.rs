//! References of scenes: their tables, and their agreement with the gears of the scene.

use super::super::references::Role;
use super::super::{Origin, SHIPPED, SceneError, SceneFile, load_unbuilt};
use super::{BASE, changed, parse, render};
use crate::context::Context;
use gearbench_models::spec::{Load, Profile};
use gearbench_reference::REFERENCES;
use gearbench_reference::data::Quantity;
use tempfile::TempDir;

#[test]
fn shipped_scenes_are_of_their_references() {
    let mut held = 0;
    for s in SHIPPED {
        let mut scene = load_unbuilt(&Context::default(), s.name).unwrap();
        let found = scene.load_references(false);
        held += found.unwrap_or_else(|e| panic!("{}", render(&e))).len();
    }
    assert_eq!(held, 6);
}

/// The impact with an inclined axis belongs to other gears, and so does that of spur gears.
#[test]
fn a_helical_scene_is_of_its_own_reference_alone() {
    let text = crate::scene_file::shipped::shipped("helical_impact")
        .unwrap()
        .text;
    for (other, word) in [
        (
            "helical-tilted",
            "axis of `wheel` (0.000000, 0.000000, 1.000000) (reference: (0.000178, 0.000467, 1.000000))",
        ),
        (
            "case-a-fine",
            "helix angle of `wheel` −15 degrees (reference: 0)",
        ),
    ] {
        let other = format!("reference = \"calculix/{other}\"");
        let text = text.replace("reference = \"calculix/helical\"", &other);
        let mut scene = SceneFile::unbuilt(
            &Context::default(),
            "test.toml",
            &text,
            Origin::Shipped,
            true,
        )
        .unwrap();
        let shown = render(&scene.load_references(false).unwrap_err());
        let shown = shown.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(shown.contains(word), "{shown}");
        assert!(shown.contains("calculix/helical"), "{shown}");
    }
}

#[test]
fn a_reference_of_other_gears_is_refused_with_both_values() {
    // The base scene has a torque that its reference has not, and another inertia.
    let own = "reference = \"calculix/case-a-fine\"";
    let mut scene = parse(super::BASE).unwrap();
    let shown = render(&scene.load_references(false).unwrap_err());
    for word in [
        "test.toml:5:",
        "loads of `pinion` 1 (reference: none)",
        "--any-reference",
    ] {
        assert!(shown.contains(word), "{word}\n{shown}");
    }
    let text = changed(own, "reference = \"calculix/rack-pinion\"");
    let text = text.replace("teeth = 20", "teeth = 37");
    let text = text.replace("centre_distance_m = 0.1001", "backlash_m = 1e-4");
    let mut scene = parse(&text).unwrap();
    let shown = render(&scene.load_references(false).unwrap_err());
    for word in [
        "teeth of `pinion` 37 (reference: 20)",
        "module of `pinion` 4 mm (reference: 2)",
        "initial speed of `pinion` 20 rad/s (reference: 100)",
        "`wheel` is a gear (reference: a rack)",
        "no stored reference belongs to these gears",
    ] {
        assert!(shown.contains(word), "{word}\n{shown}");
    }
    // With `--any-reference` the reference is read, and the scene has a warning.
    let held = scene.load_references(true).unwrap();
    assert_eq!(held[0].named.stored(), Some("calculix/rack-pinion"));
    assert_eq!(held[0].data.id, "calculix");
    assert!(
        scene
            .odd
            .last()
            .unwrap()
            .to_text()
            .contains("belongs to other conditions")
    );
}

/// Suggested references suit the scene.
#[test]
fn only_references_that_fit_are_suggested() {
    let scene = load_unbuilt(&Context::default(), "spur_impact").unwrap();
    let lines = scene.fitting().unwrap();
    assert!(lines.contains("calculix/case-a-fine"), "{lines}");
    assert!(
        !lines.contains("case-c") && !lines.contains("rack"),
        "{lines}"
    );
    assert!(
        load_unbuilt(&Context::default(), "hammer")
            .unwrap()
            .fitting()
            .is_none()
    );
    assert!(REFERENCES.len() > 2);
}

/// A table of the press.
const PRESS: &str = "t [us];Fn [kN];n1 [1/min]\n0,0;0;190,9859317\n25,0;1,5;180\n50,0;0;170\n";

/// A scene with references in place of that of the base scene, and a table next to it.
fn beside(references: &str, table: &str) -> (TempDir, Result<SceneFile, SceneError>) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("press.csv"), table).unwrap();
    let (one, several) = match references.starts_with("[[") {
        true => ("", references),
        false => (references, ""),
    };
    let text = BASE.replace("reference = \"calculix/case-a-fine\"", one);
    let text = format!("{text}\n{several}\n");
    let origin = Origin::File(folder.path().join("test.toml"));
    let scene = SceneFile::unbuilt(&Context::default(), "test.toml", &text, origin, true);
    (folder, scene)
}

/// The example of the issue: columns named, units from the header, converted at the edge.
#[test]
fn a_table_is_a_reference() {
    let long = "reference = { csv = \"press.csv\", columns = { time = \"t [us]\", force = \"Fn [kN]\", speed.pinion = \"n1 [1/min]\" } }";
    let short = "reference = \"press.csv\"";
    for line in [long, short] {
        let (_folder, scene) = beside(line, PRESS);
        let mut scene = scene.unwrap_or_else(|e| panic!("{}", render(&e)));
        assert_eq!(scene.tolerance.as_ref().unwrap().against, "press");
        let held = scene
            .load_references(false)
            .unwrap_or_else(|e| panic!("{}", render(&e)));
        let data = &held[0].data;
        assert_eq!((data.id.as_str(), data.title.as_str()), ("press", "press"));
        let (time, force) = data.force().unwrap();
        assert_eq!((time.len(), force[1]), (3, 1500.0));
        assert!((time[1] - 25e-6).abs() < 1e-18);
        let speed = data.channel(Quantity::Speed(0));
        // Without a word about columns `n1` is nothing that is known, and is told as passed over.
        match line == long {
            true => assert!((speed.unwrap().value[0] - 20.0).abs() < 1e-8),
            false => assert!(speed.is_none() && data.processing.join(" ").contains("`n1 [1/min]`")),
        }
        let source = scene.source();
        assert!(source.files.keys().any(|f| f.ends_with("press.csv")));
    }
}

/// A negative contact force causes a warning on its sign.
#[test]
fn a_negative_force_is_warned_about() {
    let negative = "t [us];Fn [kN]\n0,0;0,1\n25,0;-1,5\n50,0;0\n";
    for (table, warned) in [(PRESS, false), (negative, true)] {
        let (_folder, scene) = beside("reference = \"press.csv\"", table);
        let mut scene = scene.unwrap_or_else(|e| panic!("{}", render(&e)));
        let before = scene.odd.len();
        scene.load_own_references(false).unwrap();
        let odd: Vec<String> = scene.odd[before..]
            .iter()
            .map(SceneError::to_text)
            .collect();
        assert_eq!(odd.len(), usize::from(warned), "{odd:?}");
        if warned {
            assert!(odd[0].contains("\"press\" is negative"), "{odd:?}");
            assert!(odd[0].contains("1500 to 100 N"), "{odd:?}");
        }
    }
}

/// Further references may have other conditions; the scene under the conditions of one has no other changes.
#[test]
fn a_scene_stands_under_its_references() {
    let several = "[[references]]\ncsv = \"press.csv\"\n[[references]]\nname = \"fast\"\ncsv = \"press.csv\"\nduration_s = 5e-5\ngap_m = 2e-6\ncentre_distance_m = 0.1002\ngears.pinion = { speed_rad_s = 60.0, torque_nm = 5.0 }\nrole = \"validate\"";
    let (_folder, scene) = beside(several, PRESS);
    let mut scene = scene.unwrap_or_else(|e| panic!("{}", render(&e)));
    let [own, fast] = scene.references.as_slice() else {
        panic!("{:?}", scene.references)
    };
    assert!(own.is_of_the_scene() && !fast.is_of_the_scene());
    assert_eq!((own.role, fast.role), (Role::Fit, Role::Validate));
    let under = scene.with(&fast.conditions).unwrap();
    assert_eq!((under.duration, scene.duration), (5e-5, 1e-4));
    assert_eq!(under.spec.gears[0].speed, 60.0);
    let load = &under.spec.gears[0].loads;
    assert!(matches!(load.as_slice(), [Load::Applied(Profile::Constant(x))] if *x == 5.0));
    assert_eq!(under.spec.meshes[0].start.gap, 2e-6);
    assert!((under.spec.gears[1].position[0] - 0.1002).abs() < 1e-15);
    let same = scene.with(&own.conditions).unwrap();
    assert_eq!(format!("{:?}", same.spec), format!("{:?}", scene.spec));
    let lines = fast.conditions.lines(&scene.spec);
    assert_eq!(lines.len(), 5, "{lines:?}");
    assert!(lines.contains(&"gears.pinion.speed_rad_s = 60.0".to_owned()));
    // Models are compared with the first reference only; identification uses both.
    assert_eq!(scene.load_own_references(false).unwrap().len(), 1);
    assert_eq!(scene.load_references(false).unwrap().len(), 2);
}

/// Conditions that a table states must agree with the scene under the conditions of that reference.
#[test]
fn stated_conditions_are_held_against_the_scene() {
    let stating = format!("# gears.pinion.speed_rad_s = 60\n# gears.wheel.teeth = 30\n{PRESS}");
    let (_folder, scene) = beside("reference = \"press.csv\"", &stating);
    let mut scene = scene.unwrap();
    let shown = render(&scene.load_references(false).unwrap_err());
    for word in [
        "`gears.pinion.speed_rad_s` 20 (reference: 60)",
        "--any-reference",
    ] {
        assert!(shown.contains(word), "{word}\n{shown}");
    }
    assert!(!shown.contains("teeth"), "{shown}");
    assert_eq!(scene.load_references(true).unwrap().len(), 1);
    let under = "[[references]]\ncsv = \"press.csv\"\ngears.pinion.speed_rad_s = 60.0";
    let (_folder, scene) = beside(under, &stating);
    assert_eq!(scene.unwrap().load_references(false).unwrap().len(), 1);
}

/// Wrong keys of a reference are refused with their line and a help.
#[test]
fn references_that_are_no_references_are_refused() {
    let one = |keys: &str| format!("reference = {{ csv = \"press.csv\", {keys} }}");
    for (references, words) in [
        (
            "reference = \"calculix/case-b\"".to_owned(),
            "there is no reference|csv = \"press.csv\"",
        ),
        (
            "reference = { csv = \"press.csv\", stored = \"calculix/case-c\" }".into(),
            "both given",
        ),
        (
            "reference = { name = \"x\" }".into(),
            "does not specify its data",
        ),
        (one("colums = { time = \"t\" }"), "unknown key `colums`"),
        (
            one("columns = { speed.pinoin = \"n1\" }"),
            "nothing called `pinoin`",
        ),
        (
            one("units = { time = \"parsec\" }"),
            "the unit \"parsec\" of time is not known",
        ),
        (one("force_kind = \"tangential\""), "tangential"),
        (one("delimiter = \"|\""), "not known"),
        (one("to_s = -1.0"), "more than 0"),
        (one("from_s = 1.0"), "time window"),
        (
            one("gears.pinoin.speed_rad_s = 1.0"),
            "there is no gear `pinoin`",
        ),
        (
            one("gears.pinion.speed_m_s = 1.0"),
            "`pinion` is a gear|speed_rad_s",
        ),
        (one("gap_m = 1.0"), "larger than the normal backlash"),
        (
            one("centre_distance_m = 0.2"),
            "reference|centre_distance_m",
        ),
        (
            one("path_coordinate_m = 1.0"),
            "outside the path of contact",
        ),
        (
            one("name = \"rigid\""),
            "of a model or of the converged solution",
        ),
        (
            one("name = \"self\""),
            "of a model or of the converged solution",
        ),
        (one("name = \"a\\nb\""), "a short text"),
        (
            "reference = { stored = \"calculix/case-c\", offset_s = 1.0 }".into(),
            "applies to a table",
        ),
        (
            "[[references]]\ncsv = \"press.csv\"\n[[references]]\ncsv = \"press.csv\"".into(),
            "two references are called \"press\"|first here",
        ),
    ] {
        let (_folder, scene) = beside(&references, PRESS);
        let shown = render(&scene.expect_err(&references));
        for word in words.split('|').chain(["test.toml:"]) {
            assert!(shown.contains(word), "{word}\n{shown}");
        }
    }
}

/// Errors in a table are refused with line and column of the table, when a study reads it.
#[test]
fn tables_that_are_none_are_refused_at_their_line() {
    for (table, words) in [
        (
            "t [us];Fn\n0;0\n1;1\n2;2\n",
            "press.csv:1:8|a unit of contact force|none in",
        ),
        (
            "t [us];force [kN]\n0;0\n1;bad\n2;2\n",
            "press.csv:3:3|a number|`bad`",
        ),
        (
            "t [us];force [kN]\n0;0\n1;1\n1;2\n",
            "press.csv:4:1|the same time again",
        ),
        (
            "t [s];force [kN]\n5;0\n6;1\n7;2\n",
            "at least 3 samples|offset_s",
        ),
        ("", "press.csv:1:|a table"),
        (
            "t [us];speed1 [1/min]\n0;0\n1;1\n2;2\n",
            "test.toml:6:|no contact force|`metric` rebound_rel",
        ),
    ] {
        let (_folder, scene) = beside("reference = \"press.csv\"", table);
        let shown = render(&scene.unwrap().load_references(false).unwrap_err());
        for word in words.split('|') {
            assert!(shown.contains(word), "{word}\n{shown}");
        }
    }
    let (folder, scene) = beside("reference = \"press.csv\"", PRESS);
    std::fs::remove_file(folder.path().join("press.csv")).unwrap();
    let shown = render(&scene.unwrap().load_references(false).unwrap_err());
    assert!(
        shown.contains("test.toml:5") && shown.contains("press.csv"),
        "{shown}"
    );
}
