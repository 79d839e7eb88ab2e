//! Commands of the documents run, and print what the documents show.
//!
//! Every command in a code block is in one of two lists: [`QUICK`] runs here, [`LONG`] names the reason why not. The
//! printed output is compared word by word; `[...]` in a document stands for output that is left out, and durations
//! may differ.

use super::{Folder, stderr, stdout};
use document_commands::{DocumentCommand, commands, documents};
use gearbench::cli::command_line;
use std::collections::BTreeSet;
use std::path::Path;

#[path = "../../../src/cli/document_commands.rs"]
mod document_commands;

/// Commands that end within a few seconds of processor time, without the name of the program.
const QUICK: &[&str] = &[
    "list",
    "list models",
    "list integrators",
    "init",
    "init train --out gearbox.toml",
    "init spur_impact",
    "init own_gears",
    "init check",
    "init workflow",
    "init snakemake",
    "scan spur_impact --vary gears.pinion.speed_rad_s=10..100:10 --models rigid",
    "scan spur_impact --vary gears.pinion.speed_rad_s=10..100:10 --models rigid,movable-teeth",
    "scan spur_impact --models rigid,movable-teeth --against elastic --vary gears.pinion.speed_rad_s=10..40:7",
    "mesh spur_impact",
    "mesh spur_impact --gear pinion --out pinion.inp",
    "mesh spur_impact --flank 20 --out fine.inp",
    "stiffness my_pair.toml --models rigid",
    "modes driveline",
    "modes my_pair.toml --models rigid",
    "modes pin_error.toml --models rigid",
    "modes floating_sun.toml --models rigid",
    "check check.toml --update",
    "check check.toml",
    "check check.toml --quick",
    "check check.toml --history peak_force_n",
    "fmu loaded_mesh",
    "fmu loaded_mesh --model rigid",
    "fmu loaded_mesh --model rigid --method rk4@500ns",
    "fmu loaded_mesh --move pinion",
    "fmu loaded_mesh --move pinion --out half.fmu",
    "fmu hammer --model rigid --method rk4@1us --out hammer.fmu",
    "fmu loaded_mesh --fmi 2",
    "export loaded_mesh --rexs loaded_mesh.rexs",
    "export loaded_mesh --rexs gearbox.rexs",
    "man",
    "completions bash",
    "completions fish",
    "compare hammer --models rigid --integrators dopri5@1e-8,generalised-alpha(rho_inf=0.5)@1e-6",
];

/// Reasons why commands do not run here, with the commands.
const LONG: &[(&str, &[&str])] = &[
    (
        "They read or write files of the reader; `rexs` tests their kind",
        &[
            "import gearbox.rexs",
            "import gearbox.rexs --bearings --out on_bearings.toml",
            "import gearbox.rexsz --out scenes/gearbox.toml --bearings",
            "import gearbox.rexsj --load-case 2 --rigid-shafts",
            "export my_scene.toml --rexs my_scene.rexsj --model rigid",
            "man --out ~/.local/share/man/man1",
        ],
    ),
    (
        "A choice tries many models on the scene: tens of seconds",
        &[
            "choose my_pair.toml --metric peak --tolerance 0.05",
            "choose spur_impact --metric force-aligned --tolerance 0.05",
            "choose hammer --metric impulse --tolerance 0.02",
        ],
    ),
    (
        "They follow on `init own_gears` in its folder, and recognise and reduce meshes of thousands of nodes",
        &[
            "reduce pinion.inp.gz wheel.msh.gz",
            "compare press.toml",
            "identify press.toml --write",
            "check --update",
            "check",
            "mesh press.toml --out hexa.inp",
        ],
    ),
    (
        "All models and integrators of a scene, with converged solutions: tens of seconds to minutes",
        &[
            "compare spur_rotation",
            "compare spur_impact --models elastic --vtu 60",
            "compare spur_impact --integrators dopri5,bdf",
            "compare spur_impact --integrators dopri5@1e-9,rk4@200ns",
            "compare spur_impact --integrators generalised-alpha(rho_inf=0.5)@1e-6",
            "compare spur_impact --models rigid,rigid-iso6336 --out out/norm",
            "compare hammer --no-events --repeats 1",
            "compare spur_impact --models elastic --vtu 60 --vtu-window 0,1.5e-4",
            "compare my_pair.toml",
            "compare helical.toml",
            "compare set.toml",
        ],
    ),
    (
        "Another choice of models than that of an example before them, in the same folder",
        &[
            "scan spur_impact --vary gears.pinion.speed_rad_s | duration_s = 20 | 4e-4, 40 | 2e-4",
            "scan spur_impact --models rigid --against elastic --vary gears.pinion.speed_rad_s=10..100:10",
        ],
    ),
    (
        "They need files of the user, which the document does not have",
        &[
            "compare my_scene.toml --out results/my_scene",
            "choose my_scene.toml --metric peak --tolerance 0.05",
            "reference my_scene.toml --model fe --out fe.csv --add",
            "report results/my_scene",
            "view results",
            "rerun results/my_scene",
            "compare pair.toml --yardstick refined",
            "scan pair.toml --vary meshes.1.backlash_m=normal(80e-6,5e-6) --samples 200",
            "scan pair.toml --vary models.*.contact.friction.mu=0.02,0.05,0.1 --outputs efficiency,peak_force_n",
            "scan pair.toml --vary gears.pinion.deviations.class=6,8 --vary gears.pinion.deviations.seed=seeds(200)",
            "scan pair.toml --vary gears.*.deviations.class=6,8 --vary gears.*.deviations.seed=seeds(200)",
            "scan pair.toml --vary meshes.1.backlash_m=normal(80e-6,5e-6) --samples 10000 --shard 1/50 --out shards/1",
            "scan pair.toml --vary meshes.1.backlash_m=normal(80e-6,5e-6) --samples 10000 --shard 2/50 --out shards/2",
            "merge shards/* --out merged",
            "merge shards/* --out out/pair/scan",
            "precision my_scene.toml --modes 0,25,100 --timeout 10",
            "choose my_scene.toml --metric peak --tolerance 0.1 --out out/peak",
            "choose my_scene.toml --references",
            "choose my_scene.toml --runs 1000",
            "choose my_scene.toml --timeout 5 --budget 60",
            "identify my_scene.toml --write=scene",
            "identify my_scene.toml --measured rig.csv",
            "stiffness my_scene.toml --torque 80 --positions 48 --out out/te",
            "truncation my_scene.toml --models elastic,fe --no-refine",
            "modes my_scene.toml --up-to 5000 --out out/modes",
            "response my_scene.toml --points 400 --out out/response",
            "penalty my_scene.toml --model elastic --hard elastic-without-penalty",
            "cost my_scene.toml --simulate 10",
            "sweep my_scene.toml --from 200 --to 6000 --out out/run_up",
            "coupling my_scene.toml --steps 1e-7:1e-4:16 --tolerance 0.01",
            "run-up my_scene.toml --from 50 --to 1500 --over 0.5 --models rigid",
            "mesh my_scene.toml --element C3D20R --sector --out sector.inp",
            "mesh old_deck.inp --vtu old_deck.vtu",
            "reduce gear.inp",
            "reduce gear.inp.gz --modes 200 --out gear.npz",
            "reduce old.inp --gear wheel --mount held --max-frequency 80e3 --out wheel.npz",
            "reduce gear.inp --mount free,x,y,z,tilt_x,tilt_y --added-mass 0.4 --out floating.npz",
            "mesh my_scene.toml --gear wheel --modal calculix --out wheel.inp",
            "mesh my_scene.toml --gear wheel --modal ansys --modes 50 --out wheel.cdb",
            "reduce wheel.inp --matrices wheel.sti --out wheel.npz",
            "reduce wheel.inp --matrices wheel_STIF1.mtx --out wheel.npz",
            "reduce wheel.cdb --matrices wheel_stiff.hb --out wheel.npz",
            "reduce turned.inp --axis 0,0.2,1 --axis-point 0.1,0,0 --out turned.npz",
            "reduce a.inp b.inp --modes 100 --out reduced/",
            "rerun out/spur_impact/compare",
            "rerun results.json --out again",
        ],
    ),
    (
        "Studies of many runs: tens of seconds to minutes",
        &[
            "compare beveloid beveloid_corrected",
            "compare beveloid beveloid_corrected --models rigid,movable-teeth --integrators dopri5",
            "sweep beveloid beveloid_corrected",
            "sweep beveloid beveloid_corrected --models rigid,movable-teeth",
            "precision spur_impact",
            "stability spur_rotation",
            "truncation spur_impact",
            "penalty spur_impact",
            "sweep loaded_mesh",
            "run-up run_up",
            "identify spur_impact",
            "coupling spur_impact",
            "precision spur_impact --metric force-aligned,peak,rebound",
            "precision rack_pinion --against fe-nodes --models elastic-nodes,fe-nodes",
            "precision hammer --integrators rk4,dopri5 --steps 500ns,1us,2us --rtols 1e-3,1e-5",
            "stability spur_impact",
            "stability spur_impact --grid 24x16",
            "stability spur_impact --models rigid --integrators velocity-verlet,rk4 --steps 1e-7:1e-4",
            "stability spur_rotation --models movable-teeth-3.6e9 --axis tooth-stiffness=5.6e7:3.6e9",
            "stability hammer --axis damping=0,0.05,0.2 --axis speed=0.5:2:3",
            "identify spur_impact --model rigid",
            "identify spur_impact --write",
            "identify spur_impact --model movable-teeth --fit pinion.tooth_mass_kg,wheel.tooth_mass_kg",
            "identify spur_impact --to running --load 27 --write",
            "truncation",
            "truncation spur_impact_large --counts 0,25,50,100",
            "cost",
            "cost rack_pinion --models rigid,movable-teeth --integrators rk4@1us,dopri5@1e-6",
            "penalty",
            "penalty spur_impact --from 1e14 --to 1e16 --points 5",
            "sweep",
            "sweep loaded_mesh --models rigid --points 100",
            "coupling",
            "coupling loaded_mesh --duration 1e-3 --models rigid,elastic",
            "coupling spur_impact --extrapolations quadratic --motions linear,cubic",
            "run-up",
            "run-up planetary_run_up --gear sun",
        ],
    ),
    (
        "They reduce elastic gears or solve finite elements: many seconds",
        &[
            "stiffness spur_impact --models fe",
            "response loaded_mesh",
            "reduce spur_impact --modes 200 --out spur.npz",
            "stiffness spur_impact --load 100",
            "modes loaded_mesh --models elastic --count 60",
            "response planetary --models rigid --from 100 --to 3000",
            "mesh spur_impact --flank 20 --fine-teeth 1,2,20 --out fine.inp --vtu fine.vtu",
            "reference loaded_mesh --model elastic --load wheel=-40 --out loaded.csv",
        ],
    ),
];

/// Code blocks of a kind in a tutorial.
fn blocks(tutorial: &str, kind: &str) -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/book/src/tutorials");
    let text = std::fs::read_to_string(folder.join(tutorial)).unwrap();
    let fence = format!("```{kind}\n");
    let blocks = text.split(&fence).skip(1);
    blocks
        .map(|b| b.split("```").next().unwrap().to_owned())
        .collect()
}

/// Replaces a text that occurs exactly once.
fn replaced(text: &str, from: &str, to: &str) -> String {
    assert_eq!(text.matches(from).count(), 1, "`{from}` in\n{text}");
    text.replace(from, to)
}

/// Writes the scenes and the check that the tutorials tell the reader to save.
fn write_scenes(folder: &Folder) {
    let pair = blocks("first-pair.md", "toml").swap_remove(0);
    folder.write("my_pair.toml", &pair);
    folder.write("check.toml", &blocks("checks-in-ci.md", "toml")[0]);
    let [set, direction, sun]: [String; 3] = blocks("planetary-set.md", "toml").try_into().unwrap();
    let pin_error = replaced(&set, "name = \"set\"", "name = \"pin_error\"");
    let pin_error = replaced(&pin_error, "direction_deg = 120.0\n", &direction);
    folder.write("pin_error.toml", &pin_error);
    let floating = replaced(&pin_error, "\"pin_error\"", "\"floating_sun\"");
    let floating = replaced(&floating, "sun = {", &format!("sun = {{ {},", sun.trim()));
    folder.write("floating_sun.toml", &floating);
}

/// Words of an output, with `TIME` in place of durations.
fn words(text: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        let unit = word.trim_end_matches([',', '.', ';']);
        match words.last_mut() {
            Some(last) if ["us", "ms", "s"].contains(&unit) && last.parse::<f64>().is_ok() => {
                *last = "TIME".into();
            }
            _ => words.push(word.to_owned()),
        }
    }
    words
}

/// True if a word equals the word of a document, in which `[...]` stands for any text.
fn is_word(shown: &str, printed: &str) -> bool {
    match shown.split_once("[...]") {
        Some((start, end)) => {
            printed.len() >= start.len() + end.len()
                && printed.starts_with(start)
                && printed.ends_with(end)
        }
        None => shown == printed,
    }
}

/// Returns the first words of a document that an output does not have; `None` if it has all of them in this order.
fn difference(shown: &str, printed: &str) -> Option<String> {
    let (shown, printed) = (words(shown), words(printed));
    let mut at = 0;
    let mut gap = false;
    let parts: Vec<&[String]> = shown.split(|w| w == "[...]").collect();
    for (k, part) in parts.iter().enumerate() {
        let fits = |from: usize| {
            let end = from + part.len();
            end <= printed.len()
                && (k + 1 < parts.len() || end == printed.len())
                && (part.iter().zip(&printed[from..end])).all(|(a, b)| is_word(a, b))
        };
        let last = if gap { printed.len() } else { at };
        match (at..=last).find(|from| fits(*from)) {
            Some(from) => at = from + part.len(),
            None => return Some(part.join(" ")),
        }
        gap = true;
    }
    None
}

/// Runs a command of a document; an error is a text.
fn run(folder: &Folder, command: &DocumentCommand) -> Result<(), String> {
    let mut program = folder.command("");
    program.args(&command.words[1..]);
    if command.words.get(1).is_some_and(|word| word == "fmu") {
        // Tests are built without the shared library that FMUs contain.
        folder.write("library.so", "the library");
        program.args(["--library", "library.so"]);
    }
    let out = program.output().unwrap();
    let printed = format!("{}\n{}", stdout(&out), stderr(&out));
    if out.status.code() != Some(0) {
        return Err(format!("ended with {:?}:\n{printed}", out.status.code()));
    }
    match difference(&command.output, &printed) {
        Some(words) if !command.output.is_empty() => {
            Err(format!("does not print\n{words}\nbut\n{printed}"))
        }
        _ => Ok(()),
    }
}

#[test]
fn commands_of_the_documents_run() {
    let long: Vec<&str> = LONG.iter().flat_map(|(_, all)| *all).copied().collect();
    let mut found = BTreeSet::new();
    let mut errors: Vec<String> = Vec::new();
    for page in documents() {
        let text = std::fs::read_to_string(&page).unwrap();
        let all = commands(&text).into_iter().filter(|c| c.in_block);
        let all: Vec<(String, DocumentCommand)> =
            all.map(|c| (c.words[1..].join(" "), c)).collect();
        let folder = Folder::new();
        write_scenes(&folder);
        if all
            .iter()
            .any(|(line, _)| line.starts_with("check check.toml"))
        {
            folder.says("check check.toml --update");
        }
        for (line, command) in all {
            // A start of one's own is made in an empty folder.
            let fresh = line.starts_with("init").then(Folder::new);
            let folder = fresh.as_ref().unwrap_or(&folder);
            let error = match (QUICK.contains(&&*line), long.contains(&&*line)) {
                (true, false) => run(folder, &command).err(),
                (false, true) => None,
                (true, true) => Some("is in both lists".into()),
                (false, false) => Some("is in neither list of this test".into()),
            };
            errors.extend(error.map(|e| format!("{}: `{line}` {e}", page.display())));
            found.insert(line);
        }
    }
    let all = QUICK.iter().chain(&long);
    let gone = all.filter(|line| !found.contains(**line));
    errors.extend(gone.map(|line| format!("no document has `{line}`")));
    assert!(errors.is_empty(), "{}", errors.join("\n\n"));
}

#[test]
fn printed_output_is_compared() {
    let printed = "model  rigid 2.5 ms\nmode 5010.9 Hz\nwritten: /tmp/a/own";
    let has = |shown: &str| difference(shown, printed).is_none();
    assert!(has(
        "model rigid 3.1 ms\nmode 5010.9 Hz\nwritten: [...]/own"
    ));
    assert!(has("model rigid 3.1 ms\n[...]\nwritten: [...]"));
    assert!(has("[...]\nmode 5010.9 Hz\n[...]"));
    assert!(!has("model rigid 3.1 ms\nmode 5010.8 Hz\n[...]"));
    assert!(!has("model rigid 3.1 ms\nmode 5010.9 Hz"));
    assert!(!has("rigid [...]"));
}
