//! Tests of the command `gearbench reduce`, and of `compare` with its results: gears from decks of another program.

use super::{Folder, has};
use gearbench_reference::reduction::store::{self, Motion};
use std::f64::consts::TAU;
use std::path::Path;

/// A folder with a cache of its own.
fn cached() -> Folder {
    Folder {
        cached: true,
        ..Folder::new()
    }
}

fn repository(path: &str) -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"))
        .ancestors()
        .nth(2)
        .unwrap();
    root.join(path).to_string_lossy().into_owned()
}

fn deck(name: &str) -> String {
    repository(&format!("reference/calculix/modal/{name}.inp.gz"))
}

/// Frequencies [Hz] that CalculiX printed, column `C3D8_hz`.
fn calculix(table: &str) -> Vec<f64> {
    let path = repository(&format!("reference/calculix/modal/{table}.csv"));
    let text = std::fs::read_to_string(path).unwrap();
    let lines = text.lines().skip(1);
    lines
        .map(|l| l.split(',').nth(1).unwrap().parse().unwrap())
        .collect()
}

#[test]
fn foreign_decks_are_reduced_and_compared() {
    let folder = cached();
    let decks = [deck("impA_g1_C3D8"), deck("impA_g2_C3D8")];
    let reduce = format!(
        "reduce {} {} --modes 200 --out reduced/",
        decks[0], decks[1]
    );
    let said = folder.says(&reduce);
    let words = [
        "gear with 20 teeth, tip radius 44.000 mm",
        "module 4.000 mm at 20.0 degrees",
        "40 flanks with 524 nodes and 222 faces",
        "gear with 30 teeth, tip radius 64.000 mm",
        "208 nodes at 15.000 mm tied to the hub, which is free to rotate",
        "impA_g2_C3D8.npz",
    ];
    has(&said, &words);
    let reduced = |name: &str| folder.at(&format!("reduced/{name}.npz"));
    let before = std::fs::read(reduced("impA_g2_C3D8")).unwrap();
    let stored = store::read(&reduced("impA_g1_C3D8")).unwrap();
    assert_eq!((stored.meta.teeth, stored.meta.motion), (20, Motion::Turn));
    // Mass matrix of the mesh from the reference.
    assert!((stored.basis.inertia / 3.102056e-4 - 1.0).abs() < 1e-6);
    assert!((199..=200).contains(&stored.basis.omega.len()));

    // Again from the cache: the same file.
    let again = folder.says(&reduce);
    assert_eq!(again.matches("from the cache").count(), 2, "{again}");
    assert_eq!(std::fs::read(reduced("impA_g2_C3D8")).unwrap(), before);

    // The example `own_gears` runs from another folder, with its reductions in its own.
    let scene = repository("benchmarks/examples/foreign_gears.toml");
    std::fs::copy(scene, folder.at("foreign_gears.toml")).unwrap();
    std::fs::create_dir(folder.at("elsewhere")).unwrap();
    let arguments = "compare ../foreign_gears.toml --models elastic --integrators velocity-verlet@5e-7 --repeats 1 --out cmp";
    let mut command = folder.command(arguments);
    assert!(
        command
            .current_dir(folder.at("elsewhere"))
            .output()
            .unwrap()
            .status
            .success()
    );
    let record = folder.read("elsewhere/cmp/results.json");
    let record: serde_json::Value = serde_json::from_str(&record).unwrap();
    let run = &record["runs"][0];
    assert_eq!(run["status"], "converged");
    let metrics = run["metrics"].as_array().unwrap();
    let against = metrics.iter().find(|m| m["against"] == "calculix").unwrap();
    let error = against["force_l2_aligned"].as_f64().unwrap();
    assert!(error < 0.02, "{error}");
}

#[test]
fn held_modes_are_those_of_calculix() {
    let folder = cached();
    let input = deck("impA_g1_C3D8");
    folder.says(&format!(
        "reduce {input} --modes 21 --mount held --out held.npz"
    ));
    let basis = store::read(&folder.at("held.npz")).unwrap().basis;
    assert!(!basis.free && basis.omega.len() >= 20);
    for (w, f) in basis.omega.iter().zip(calculix("eig_impA_g1")) {
        let found = w / TAU;
        assert!((found / f - 1.0).abs() < 1e-6, "{found} Hz for {f} Hz");
    }
    // A scene whose gear is free to rotate does not take it.
    let scene = repository("benchmarks/examples/foreign_gears.toml");
    let scene = std::fs::read_to_string(scene).unwrap();
    let wrong = scene.replace("reduced/impA_g1_C3D8.npz", "held.npz");
    folder.write("wrong.toml", &wrong);
    let words = [
        "wrong.toml",
        "held.npz: its hub is held, but the mount of `pinion` leaves it free",
        "`--mount free`",
    ];
    folder.refuses("compare wrong.toml", &words);
    let swapped = scene.replace("reduced/impA_g2_C3D8.npz", "held.npz").replace(
        "gears.pinion = { model = \"elastic\", parameters = { reduction = \"reduced/impA_g1_C3D8.npz\" } }",
        "gears.pinion = { model = \"rigid\" }",
    );
    folder.write("swapped.toml", &swapped);
    let words = ["gear with 20 teeth, but `wheel` is a gear with 30"];
    folder.refuses("compare swapped.toml --models elastic", &words);
    // Nor one that is not there.
    folder.write("missing.toml", &scene);
    folder.refuses(
        "compare missing.toml",
        &["impA_g1_C3D8.npz", "gearbench reduce"],
    );
    assert!(!folder.at("out").exists(), "nothing is written");
}

#[test]
fn a_floating_hub_is_told_and_does_not_suit_a_held_one() {
    let folder = cached();
    let input = deck("impA_g1_C3D8");
    let told = folder.says(&format!(
        "reduce {input} --modes 20 --mount free,x,y,z,tilt_x,tilt_y --added-mass 0.1 --out floating.npz"
    ));
    let words = "free to rotate and free in x, y, z, tilt_x, tilt_y";
    assert!(told.contains(words), "{told}");
    let basis = store::read(&folder.at("floating.npz")).unwrap().basis;
    let lateral = basis.lateral.as_ref().unwrap();
    assert_eq!(lateral.free, [true, true, true, true, true, false]);
    assert_eq!(
        (lateral.hub.len(), basis.added),
        (basis.omega.len(), [0.1, 0.0])
    );
    let scene = repository("benchmarks/examples/foreign_gears.toml");
    let scene = std::fs::read_to_string(scene).unwrap();
    let wrong = scene.replace("reduced/impA_g1_C3D8.npz", "floating.npz");
    folder.write("wrong.toml", &wrong);
    let words = [
        "its hub is free, x, y, z, tilt_x, tilt_y, but the mount of `pinion` leaves it free",
        "`--mount free`",
    ];
    folder.refuses("compare wrong.toml", &words);
}

#[test]
fn what_cannot_be_reduced_is_refused_and_nothing_is_written() {
    let folder = cached();
    let (gear, beam) = (deck("impA_g1_C3D8"), deck("beam_C3D8"));
    folder.write("no.inp", "*NODE\n1, 0., 0.\n");
    folder.write("gear.sti", "1 1 1.0\n1 2\n");
    folder.write("gear.mas", "1 1 1.0\n");
    let cases: [(String, &[&str]); 19] = [
        (
            format!("{gear} --matrices gear.sti"),
            &["gear.sti:2", "a row, a column and a value", "`1 2`"],
        ),
        (
            format!("{gear} --matrices none.sti"),
            &["none.sti", "readable file of the stiffness"],
        ),
        (
            format!("{gear} --shapes gear.txt"),
            &["gear.txt", "readable file of mode shapes"],
        ),
        (
            "spur_impact --matrices gear.sti".into(),
            &["belong to a deck", "--modal"],
        ),
        (
            format!(
                "{} --matrices gear.sti",
                repository("reference/calculix/case-a-fine/AF8_d05.inp.gz")
            ),
            &["belong to one gear", "--gear NAME"],
        ),
        (beam, &["beam_C3D8.inp.gz", "or a node set `bore`"]),
        ("no.inp".into(), &["no.inp", "expected"]),
        ("missing.inp".into(), &["missing.inp", "readable deck"]),
        ("no_scene".into(), &["there is no scene `no_scene`"]),
        (
            "spur_impact --gear sun".into(),
            &["there is no gear `sun`", "pinion, wheel"],
        ),
        (
            format!("{gear} --gear b"),
            &["there is no gear `b`", "its gears are gear"],
        ),
        (
            format!("{gear} --model a"),
            &["--model cannot be used with a deck"],
        ),
        (
            "spur_impact --model nothing".into(),
            &["no elastic model `nothing`"],
        ),
        (format!("{gear} --poisson 0.5"), &["Poisson", "--poisson"]),
        (
            format!("{gear} --mount free,x"),
            &["translations along x and y", "hold or free both"],
        ),
        (
            format!("{gear} --mount free,sideways"),
            &["x, y, z, tilt_x, tilt_y, tilt_z", "`sideways`"],
        ),
        (
            format!("{gear} --added-mass 0.1"),
            &["this hub is fixed", "--mount free,x,y"],
        ),
        (
            format!("{gear} --out gear.txt"),
            &["gear.txt", "ends in .npz"],
        ),
        (
            format!("{gear} {gear} --out reduced/"),
            &["given twice", "one by one"],
        ),
    ];
    for (arguments, words) in cases {
        folder.refuses(&format!("reduce {arguments}"), words);
    }
    let left: Vec<_> = std::fs::read_dir(folder.path())
        .unwrap()
        .flatten()
        .collect();
    let names: Vec<_> = left.iter().map(|e| e.file_name()).collect();
    let mut names: Vec<_> = names.iter().map(|n| n.to_string_lossy()).collect();
    names.sort();
    assert_eq!(names, ["gear.mas", "gear.sti", "no.inp"]);
}

/// A pinion and a rack, meshed coarsely.
const SMALL: &str = r#"
schema = 1
name = "small"
duration_s = 1e-4

[gears.pinion]
teeth = 18
module_m = 0.002
face_width_m = 0.005
bore_radius_m = 0.006
added_inertia_kgm2 = 1e-6

[gears.rack]
kind = "rack"
teeth = 5
module_m = 0.002
face_width_m = 0.005
mount = "fixed"

[[meshes]]
gears = ["pinion", "rack"]
backlash_m = 50e-6

[[models]]
model = "elastic"
contact = { penalty_pa_per_m = 1e14 }
parameters = { flank_elements = 3, fillet_elements = 2, across_elements = 4, rim_elements = 1, width_elements = 1 }
"#;

#[test]
fn gears_of_a_scene_are_reduced_as_its_elastic_model_has_them() {
    let folder = cached();
    folder.write("small.toml", SMALL);
    let said =
        folder.says("reduce small.toml --modes 12 --choose flank-compliance --out small.npz");
    let words = [
        "one sector of 18",
        "scene small, gear rack, generated mesh",
        "including 1e-6 kg m^2 added at the hub",
        "rack with 5 teeth, tips 2.000 mm above its reference line; module 2.000 mm at 20.0 degrees",
        "of one tooth on all",
    ];
    has(&said, &words);
    let pinion = store::read(&folder.at("small-pinion.npz")).unwrap();
    let rack = store::read(&folder.at("small-rack.npz")).unwrap();
    assert!(pinion.basis.free && !rack.basis.free);
    assert_eq!(pinion.basis.added_inertia, 1e-6);
    assert_eq!(rack.meta.motion, Motion::Slide);
    for stored in [&pinion, &rack] {
        // Chosen among many: not the lowest.
        assert!((10..=12).contains(&stored.basis.omega.len()));
        assert!(
            stored
                .meta
                .asked
                .contains("chosen by flank-compliance among 400 modes")
        );
    }
    // Modes up to a frequency: all of them, and the same ones.
    folder.says("reduce small.toml --gear pinion --max-frequency 150e3 --out low.npz");
    let low = store::read(&folder.at("low.npz")).unwrap().basis;
    let highest = low.omega.last().unwrap() / TAU;
    assert!((100e3..150e3).contains(&highest), "{highest}");
}

/// Meshes without sets, in a scene that says their units and their axes; a scene that says them wrongly.
#[test]
fn meshes_of_a_scene_are_recognised_and_corrected() {
    let folder = cached();
    folder.write("small.toml", SMALL);
    folder.says("mesh small.toml --flank 3 --rim 1 --width 1 --element c3d8 --out m.inp");
    for gear in ["pinion", "rack"] {
        let whole = folder.read(&format!("m-{gear}.inp"));
        let mut kept = true;
        let lines = whole.lines().filter(|line| {
            if line.starts_with('*') {
                let word = line.to_ascii_uppercase();
                kept = ["*NODE", "*ELEMENT"].iter().any(|k| word.starts_with(k));
                // Output requests are called alike.
                kept &= !word.contains("FILE") && !word.contains("PRINT");
            }
            kept
        });
        let text: Vec<&str> = lines.collect();
        folder.write(&format!("{gear}.inp"), &text.join("\n"));
    }
    let with = |pinion: &str, rack: &str| {
        let start = SMALL.find("parameters").unwrap();
        let of = |gear: &str, more: &str| {
            format!(
                "gears.{gear} = {{ model = \"elastic\", parameters = {{ mesh = \"{gear}.inp\"{more} }} }}\n"
            )
        };
        SMALL[..start].to_owned() + &of("pinion", pinion) + &of("rack", rack)
    };
    let good = with(
        ", units = \"m-kg-s\", axis = [0, 0, 1], axis_point_m = [0, 0, 0]",
        ", axis = [0, 0, 1]",
    );
    folder.write("good.toml", &good);
    let said = folder.says("reduce good.toml --modes 2");
    let words = [
        "units m-kg-s: as given",
        "no sets name its flanks: axis along (0.000000, 0.000000, 1.000000)",
        "36 flanks from",
        "bore 6.0000 mm",
        "units m-kg-s: an assumption",
        "pitch 6.283185 mm along (0.000000, 1.000000, 0.000000)",
        "pressure angle 20.0000 and helix 0.0000 degrees, 10 flanks",
    ];
    has(&said, &words);
    assert!(!said.contains("-0.0000"), "{said}");
    // A deck alone is told the same on the command line; the sense of the axis is the user's.
    let said = folder.says("reduce pinion.inp --modes 2 --axis 0,0,-2 --axis-point 0,0,1e-3");
    has(&said, &["axis along (0.000000, 0.000000, -1.000000)"]);
    let cases: [(&str, &[&str]); 4] = [
        (
            "pinion.inp --axis 1,0,0",
            &["`axis` says (1.0000, 0.0000, 0.0000)"],
        ),
        ("pinion.inp --axis-point 0.01,0,0", &["`axis_point_m` says"]),
        ("pinion.inp --axis 0,0", &["expected a direction x,y,z"]),
        (
            "good.toml --axis 0,0,1",
            &["--axis applies to decks", "`axis`"],
        ),
    ];
    for (arguments, words) in cases {
        folder.refuses(&format!("reduce {arguments} --modes 2"), words);
    }
    let cases: [(&str, &str, &[&str]); 4] = [
        (
            ", units = \"mm-t-s\"",
            "",
            &["base radius", "16.91", "0.0169", "read in mm-t-s", "`units"],
        ),
        (
            ", axis = [1, 0, 0]",
            "",
            &[
                "`axis` says (1.0000, 0.0000, 0.0000)",
                "(0.0000, 0.0000, 1.0000)",
            ],
        ),
        (", axes = [1, 0, 0]", "", &["no parameter `axes`", "axis"]),
        ("", ", axis = [0, 1]", &["`axis`", "[x, y, z]"]),
    ];
    for (pinion, rack, words) in cases {
        folder.write("bad.toml", &with(pinion, rack));
        folder.refuses("reduce bad.toml --modes 2", words);
    }
}
