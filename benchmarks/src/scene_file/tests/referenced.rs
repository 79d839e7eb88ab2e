//! Stored references against the gears of scenes.

use super::super::{SHIPPED, load_unbuilt};
use super::{changed, parse, render};
use gearbench_reference::REFERENCES;

#[test]
fn shipped_scenes_are_of_their_references() {
    let mut held = 0;
    for s in SHIPPED {
        let mut scene = load_unbuilt(s.name).unwrap();
        let found = scene.held_reference(false);
        held += usize::from(found.unwrap_or_else(|e| panic!("{}", render(&e))).is_some());
    }
    assert_eq!(held, 3);
}

#[test]
fn a_reference_of_other_gears_is_refused_with_both_values() {
    // The base scene has a torque that its reference has not, and another inertia.
    let own = "reference = \"calculix/case-a-fine\"";
    let mut scene = parse(super::BASE).unwrap();
    let shown = render(&scene.held_reference(false).unwrap_err());
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
    let shown = render(&scene.held_reference(false).unwrap_err());
    for word in [
        "teeth of `pinion` 37 (reference: 20)",
        "module of `pinion` 4 mm (reference: 2)",
        "initial speed of `pinion` 20 rad/s (reference: 100)",
        "`wheel` is a gear (reference: a rack)",
        "no stored reference is of these gears",
    ] {
        assert!(shown.contains(word), "{word}\n{shown}");
    }
    // Who insists has it, and the scene says so.
    assert_eq!(
        scene.held_reference(true).unwrap().unwrap().id,
        "calculix/rack-pinion"
    );
    assert!(scene.odd.last().unwrap().told().contains("of another run"));
}

/// Messages that suggest a reference suggest one that fits.
#[test]
fn only_references_that_fit_are_suggested() {
    let scene = load_unbuilt("spur_impact").unwrap();
    let lines = scene.fitting().unwrap();
    assert!(lines.contains("calculix/case-a-fine"), "{lines}");
    assert!(
        !lines.contains("case-c") && !lines.contains("rack"),
        "{lines}"
    );
    assert!(load_unbuilt("hammer").unwrap().fitting().is_none());
    assert!(REFERENCES.len() > 2);
}
