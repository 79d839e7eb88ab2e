//! The fingerprint of all studies: what every command computes on small scenes, as a flat list of keys and values.
//!
//! Commands run as the program runs them, in this process, and only their files are read, so that the same list is made
//! before and after a change of the code between. Bounds of time are far away and bounds of steps near: nothing
//! depends on the clock. Left out is what does: times, machine, commit, date, command, choices by measured cost.
//!
//! Numbers keep all bits (shortest text that reads back the same). Long lists become their length, sum, sum of
//! magnitudes, first and last value, and a hash of all bits ([`BITS`]).

mod compare;
mod flat;

pub use compare::{Difference, Renames, differences, golden_form, off_golden};
pub use flat::List;

use clap::Parser;
use gearbench::cli::Cli;
use gearbench::context::Context;
use gearbench::experiment::parallel::{in_parallel, lock, thread_count};
use gearbench_reference::reduction::cache::Cache;
use std::convert::Infallible;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

/// End of the keys that hold a hash of bits: equal on one machine, not between machines.
pub const BITS: &str = ".bits";

/// Time limit far above that of any run [s].
const PATIENCE: &str = "900000";

/// One part of the fingerprint: commands that share a folder.
struct Part {
    study: &'static str,
    name: &'static str,
    /// Commands, parted by `;`. `X.toml` is a scene of `tests/fingerprint`, what begins with `OUT` lies in the folder.
    commands: &'static str,
}

const fn part(study: &'static str, name: &'static str, commands: &'static str) -> Part {
    Part {
        study,
        name,
        commands,
    }
}

/// Commands of every study; every model occurs in at least one of them.
const PARTS: &[Part] = &[
    part(
        "compare",
        "impact",
        "compare impact.toml --any-reference --repeats 1 --timeout T --out OUT",
    ),
    part(
        "compare",
        "laws",
        "compare laws.toml --repeats 1 --timeout T --out OUT",
    ),
    part(
        "compare",
        "train",
        "compare train.toml --repeats 1 --timeout T --out OUT",
    ),
    part(
        "compare",
        "loaded",
        "compare loaded.toml --repeats 1 --timeout T --out OUT",
    ),
    part(
        "compare",
        "hammer",
        "compare hammer.toml --repeats 1 --timeout T --out OUT",
    ),
    part(
        "compare",
        "no-events",
        "compare hammer.toml --models rigid,movable-teeth --no-events --repeats 1 --timeout T --out OUT",
    ),
    part(
        "compare",
        "shaft",
        "compare shaft.toml --repeats 1 --timeout T --out OUT",
    ),
    part(
        "compare",
        "carrier",
        "compare carrier.toml --repeats 1 --timeout T --out OUT",
    ),
    part(
        "compare",
        "internal",
        "compare internal.toml --repeats 1 --timeout T --out OUT",
    ),
    part(
        "compare",
        "bearing",
        "compare bearing.toml --repeats 1 --timeout T --out OUT",
    ),
    part(
        "compare",
        "guide",
        "compare guide.toml --repeats 1 --timeout T --out OUT",
    ),
    part(
        "compare",
        "half-space",
        "compare half_space.toml --repeats 1 --timeout T --out OUT",
    ),
    part(
        "truncation",
        "impact",
        "truncation impact.toml --any-reference --models elastic,fe --counts 0,5,20 --repeats 1 --timeout T --out OUT",
    ),
    part(
        "penalty",
        "nodes",
        "penalty impact.toml --model elastic-nodes --from 1e14 --to 1e16 --points 3 --positions 4 --timeout T --out OUT",
    ),
    part(
        "sweep",
        "loaded",
        "sweep loaded.toml --models rigid,movable-teeth,elastic,elastic-spin,fe --positions 6 --timeout T --out OUT",
    ),
    part(
        "sweep",
        "bearing",
        "sweep bearing.toml --models rigid --positions 4 --timeout T --out OUT",
    ),
    part("run-up", "run-up", "run-up run_up.toml --out OUT"),
    part(
        "coupling",
        "loaded",
        "coupling loaded.toml --models rigid --steps 1e-6:1e-4:3 --threads 2 --timeout T --out OUT",
    ),
    part(
        "stability",
        "impact",
        "stability impact.toml --threads 2 --timeout T --out OUT",
    ),
    part(
        "precision",
        "impact",
        "precision impact.toml --any-reference --repeats 1 --timeout T --out OUT",
    ),
    part(
        "choose",
        "hammer",
        "choose hammer.toml --metric impulse --tolerance 0.05 --out OUT",
    ),
    part(
        "identify",
        "impact",
        "identify impact.toml --any-reference --write --out OUT",
    ),
    part(
        "modes",
        "loaded",
        "modes loaded.toml --models rigid,movable-teeth,elastic --count 12 --out OUT",
    ),
    part("modes", "shaft", "modes shaft.toml --count 12 --out OUT"),
    part(
        "modes",
        "carrier",
        "modes carrier.toml --count 12 --out OUT",
    ),
    part(
        "modes",
        "conical",
        "modes conical.toml --count 12 --out OUT",
    ),
    part(
        "modes",
        "bearing",
        "modes bearing.toml --count 12 --out OUT",
    ),
    part(
        "response",
        "bearing",
        "response bearing.toml --points 20 --phases 16 --out OUT",
    ),
    part(
        "response",
        "carrier",
        "response carrier.toml --points 20 --phases 16 --out OUT",
    ),
    part(
        "stiffness",
        "conical",
        "stiffness conical.toml --models rigid,movable-teeth,elastic --positions 4 --out OUT",
    ),
    part(
        "stiffness",
        "loaded",
        "stiffness loaded.toml --models rigid,movable-teeth,elastic,fe --positions 6 --load 100 --out OUT",
    ),
    part(
        "reduce",
        "hammer",
        "reduce hammer.toml --modes 12 --out hammer.npz; compare reduced.toml --repeats 1 --timeout T --out OUT",
    ),
    part(
        "reference",
        "conical",
        "reference conical.toml --model rigid --out OUT.csv",
    ),
    part(
        "check",
        "check",
        "check check.toml --update --no-runtime --out OUT; check check.toml --no-runtime --out OUT",
    ),
    part(
        "mesh",
        "train",
        "mesh train.toml --flank 3 --width 1 --vtu OUT.vtu --out OUT.inp",
    ),
    part(
        "mesh",
        "sector",
        "mesh hammer.toml --gear wheel --sector --element C3D20R --flank 3 --width 1 --out OUT.inp",
    ),
    part(
        "mesh",
        "fine",
        "mesh hammer.toml --gear pinion --fine-teeth 1,2 --width 1 --out OUT.inp",
    ),
];

/// Returns the names of the studies, in order.
#[must_use]
pub fn studies() -> Vec<&'static str> {
    let mut all: Vec<_> = PARTS.iter().map(|p| p.study).collect();
    all.dedup();
    all
}

/// Runs the parts of one study, or all, in separate folders within `folder`.
///
/// # Panics
/// Where files cannot be read or written, or a command of the table does not exist.
pub fn fingerprint(only: Option<&str>, folder: &Path) -> List {
    // Reductions are made once.
    let mut context = Context::default();
    context.resources.cache = Arc::new(Cache::at(&folder.join("cache"), u64::MAX));
    let parts: Vec<&Part> = (PARTS.iter())
        .filter(|p| only.is_none_or(|o| o == p.study))
        .collect();
    // Studies of one process do not influence each other.
    let all: Mutex<List> = Mutex::default();
    let done: Result<(), Infallible> = in_parallel(thread_count(None), &parts, |part| {
        let own = folder.join(format!("{}-{}", part.study, part.name));
        let mut list = List::default();
        run(&context, part, &own, &mut list);
        lock(&all).0.extend(list.0);
        Ok(())
    });
    done.expect("no error");
    all.into_inner().expect("no part panicked")
}

fn scenes() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fingerprint")
}

fn run(context: &Context, part: &Part, own: &Path, list: &mut List) {
    std::fs::create_dir_all(own).expect("a folder for results");
    let shipped = std::fs::read_dir(scenes()).expect("the scenes of the fingerprint");
    let shipped: Vec<PathBuf> = shipped.flatten().map(|e| e.path()).collect();
    for scene in &shipped {
        std::fs::copy(scene, own.join(scene.file_name().expect("a file"))).expect("a copy");
    }
    let at = format!("{}/{}", part.study, part.name);
    let here = own.to_string_lossy();
    for (i, command) in part.commands.split("; ").enumerate() {
        let arguments = command.split(' ').map(|a| match a {
            "T" => PATIENCE.to_owned(),
            a if a.starts_with("OUT") || a.ends_with(".toml") || a.ends_with(".npz") => {
                format!("{here}/{a}")
            }
            a => a.to_owned(),
        });
        let arguments = std::iter::once("gearbench".to_owned()).chain(arguments);
        let cli = Cli::try_parse_from(arguments).unwrap_or_else(|e| panic!("{command}: {e}"));
        let code = gearbench::cli::run(context.clone(), cli);
        list.add(format!("{at}/command{i}.exit"), format!("{code:?}"));
    }
    let mut files = Vec::new();
    walk(own, &mut files);
    files.sort();
    for file in files {
        let name = file.strip_prefix(own).expect("inside").to_string_lossy();
        if !shipped.iter().any(|s| s.ends_with(&*name)) {
            let name = name.replace("OUT/", "").replace('\\', "/");
            flat::file(list, &format!("{at}/{name}"), &file, &here);
        }
    }
}

fn walk(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder").flatten() {
        match entry.path() {
            path if path.is_dir() => walk(&path, files),
            path => files.push(path),
        }
    }
}
