//! Tests that files of a wrong kind are recognised, with advice on how to use them.

use super::{Folder, has};

#[test]
fn files_of_other_programs_are_named_for_what_they_are() {
    let folder = Folder::new();
    for (file, words) in [
        (
            "gear.step",
            &[
                "is CAD geometry, not a scene",
                "gmsh -3 gear.step -o gear.msh",
                "gearbench init",
            ][..],
        ),
        ("gear.stl", &["surface of triangles", "mesh the volume"]),
        (
            "gearbox.rexs",
            &["REXS", "not read yet", "gearbench help limits"],
        ),
        (
            "part.cae",
            &["Abaqus", "Write Input", "gearbench reduce part.inp"],
        ),
        ("part.odb", &["Abaqus"]),
        ("part.cdb", &["is a mesh", "gearbench reduce part.cdb"]),
        (
            "part.rst",
            &["Ansys", "CDWRITE", "gearbench reduce part.cdb"],
        ),
        ("part.bdf", &["Nastran", "meshio"]),
        ("part.vtu", &["ParaView", "gearbench reduce part.inp"]),
        (
            "part.inp",
            &["is a mesh", "gearbench reduce part.inp", "mesh ="],
        ),
        (
            "results.json",
            &["is a record", "gearbench report", "gearbench rerun"],
        ),
        (
            "press.csv",
            &["is a table", "reference = { csv = \"press.csv\" }"],
        ),
        (
            "press.xlsx",
            &["spreadsheet", "export the histories as CSV"],
        ),
        (
            "pair.yaml",
            &["another format than TOML", "gearbench help scene"],
        ),
    ] {
        folder.write(file, "x");
        folder.refuses(&format!("compare {file}"), words);
    }
    for command in [
        "reduce gear.step",
        "mesh gear.step",
        "stiffness gear.step",
        "check gear.step",
    ] {
        folder.refuses(command, &["gear.step", "CAD geometry"]);
    }
}

#[test]
fn folders_and_names_without_an_ending_lead_to_what_is_there() {
    let folder = Folder::new();
    folder.refuses("compare .", &["is a folder", "gearbench init"]);
    folder.says("init pair");
    folder.refuses(
        "compare pair",
        &[
            "there is no scene `pair`",
            "write `pair.toml`, the file in this folder",
        ],
    );
    folder.refuses(
        "compare .",
        &["name a scene file in it, such as", "pair.toml"],
    );
    folder.says(
        "compare pair.toml --models rigid --yardstick rigid --integrators dopri5@1e-4 --repeats 1",
    );
    folder.refuses(
        "compare out/pair/compare",
        &["gearbench report out/pair/compare"],
    );
    for named in ["out/pair", "out"] {
        folder.refuses(
            &format!("report {named}"),
            &["name one of the studies in this folder", "out/pair/compare"],
        );
    }
    folder.refuses(
        "report pair.toml",
        &["this is a scene", "gearbench compare pair.toml"],
    );
    folder.refuses("report nowhere", &["name the output folder of a study"]);
    folder.refuses(
        "identify pair.toml",
        &["reference = { csv =", "gearbench reference pair.toml"],
    );
}

/// Inputs that a scene names are recognised by the same table.
#[test]
fn inputs_of_a_scene_are_named_for_what_they_are() {
    let folder = Folder::new();
    folder.says("init pair");
    let scene = folder.read("pair.toml");
    folder.write("press.xlsx", "x");
    folder.write("gear.step", "x");
    let with = scene.replace(
        "duration_s = 15e-3",
        "duration_s = 15e-3\nreference = { csv = \"press.xlsx\" }",
    );
    assert_ne!(with, scene);
    folder.write("measured.toml", &with);
    folder.refuses(
        "compare measured.toml --models rigid",
        &["press.xlsx", "spreadsheet", "CSV"],
    );
    let with = scene.replace(
        "parameters = { modes = 20",
        "parameters = { mesh = \"gear.step\", modes = 20",
    );
    assert_ne!(with, scene);
    folder.write("meshed.toml", &with);
    folder.refuses(
        "compare meshed.toml --models elastic",
        &["gear.step", "CAD geometry", "gmsh -3"],
    );
}

/// Warnings about the scene come before the first line of results, with file and line.
#[test]
fn warnings_of_a_scene_come_first() {
    let folder = Folder::new();
    folder.says("init pair");
    let wrong = folder
        .read("pair.toml")
        .replace("speed_rad_s = -46.34", "speed_rad_s = 46.34");
    folder.write("wrong.toml", &wrong);
    let command =
        "compare wrong.toml --models rigid --yardstick rigid --integrators dopri5@1e-4 --repeats 1";
    let out = std::process::Command::new("sh")
        .args([
            "-c",
            &format!("{} {command} 2>&1", env!("CARGO_BIN_EXE_gearbench")),
        ])
        .current_dir(folder.path())
        .env("NO_COLOR", "1")
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&out.stdout).into_owned();
    let first = text.lines().next().unwrap_or_default();
    has(
        first,
        &[
            "warning: wrong.toml:",
            "`wheel` starts at 46.341 rad/s",
            "speed_rad_s = -46.34146",
        ],
    );
}
