//! Tests of the command `gearbench init`: its scenes run in the commands that they are for.

use super::{Folder, has};

#[test]
fn scenes_to_start_from_run_in_every_command() {
    let folder = Folder::new();
    for what in ["pair", "rack", "train"] {
        let said = folder.says(&format!("init {what}"));
        has(&said, &["written:", &format!("{what}.toml")]);
        // Nothing is written over.
        folder.refuses(&format!("init {what}"), &["exists already", "--force"]);
        folder.says(&format!("init {what} --force"));
        let scene = format!("{what}.toml");
        let rigid = "--models rigid --yardstick rigid --integrators dopri5 --repeats 1";
        folder.ends(&format!("compare {scene} {rigid}"), 0);
        folder.ends(
            &format!("compare {scene} --models elastic --yardstick elastic --repeats 1 --force"),
            0,
        );
        folder.says(&format!(
            "precision {scene} --models rigid --integrators dopri5 --rtols 1e-4 --repeats 1"
        ));
        folder.says(&format!(
            "stability {scene} --models rigid --integrators rk4 --grid 2x2 --duration 1e-4 --axis contact-stiffness=1:2 --no-refine"
        ));
        folder.says(&format!("mesh {scene} --flank 4 --width 1"));
    }
    // Gears that are not cyclic, and several of them, take minutes to refine.
    folder.says("choose pair.toml --tolerance 0.2 --metric impulse");
    folder.says("stiffness pair.toml --positions 4");
    folder.says("sweep pair.toml --models rigid --points 2 --cycles 1 --positions 4");
    // Its elastic gears touch on half-spaces, which have no penalty.
    folder.refuses(
        "penalty pair.toml --model elastic --points 2 --positions 2",
        &["the contact of `elastic` has no penalty", "flank points"],
    );
    folder.says("reduce pair.toml --modes 4 --gear pinion");
    folder.says("init spur_impact --out own.toml");
    folder.says("identify own.toml --model rigid");
}

/// The example of several files needs the program alone.
#[test]
fn the_example_with_foreign_gears_comes_with_the_program() {
    let folder = Folder::new();
    has(&folder.says("init own_gears"), &["own_gears", "press.toml"]);
    folder.refuses("init own_gears", &["exists already", "--force"]);
    folder.says("init own_gears --force");
    let run = "compare own_gears/press.toml --models rigid --integrators dopri5@1e-6 --repeats 1";
    folder.says(run);
}

/// The smallest scene of the page about scenes, whose gears have no bore.
#[test]
fn the_smallest_scene_works() {
    let folder = Folder::new();
    let page = include_str!("../../../scenes/README.md");
    let example = page.split("```toml\n").nth(1).unwrap();
    folder.write("s.toml", example.split("```").next().unwrap());
    folder.ends("choose s.toml --tolerance 0.2", 0);
    folder.says("compare s.toml --repeats 1");
    folder.says("compare out/my_scene/choose/chosen.toml --repeats 1 --out chosen");

    // A formula outside its range is reported on the terminal, in the JSON object and next to the chart.
    let shifted = example.replacen("teeth = 30", "teeth = 30\nprofile_shift = 0.1", 1);
    folder.write("s.toml", shifted.split("```").next().unwrap());
    let said = folder.says("stiffness s.toml --positions 4");
    has(
        &said,
        &["outside its range: ISO 6336-1", "fitted for x1 >= x2"],
    );
    has(
        &folder.says("stiffness s.toml --positions 4 --json"),
        &["\"limits\":[\"ISO 6336-1"],
    );
    has(
        &folder.read("out/my_scene/stiffness/stiffness.csv"),
        &["fitted for x1"],
    );
}
