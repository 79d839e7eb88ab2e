//! Two studies in one process.

use super::Context;
use crate::experiment::conditions::Progress;
use crate::experiment::journal::{JOURNAL, Journal, Subject};
use crate::experiment::parallel::lock;
use crate::experiment::runner::Runner;
use crate::scene_file::{Origin, SceneFile, Selection, load_for};
use crate::studies::compare::{self, Plan};
use crate::studies::test_scene::coarse_full;
use gearbench_integrators::table::{DOPRI5, RK4, VELOCITY_VERLET};
use gearbench_models::gear::table::Model;
use gearbench_reference::limits::Memory;
use gearbench_reports::record::{Run, Source, Status};
use std::sync::mpsc::channel;
use std::sync::{Arc, Mutex};

const SCENE: &str = "hammer";

/// Compares rigid gears under three methods, and returns the title of the scene and the runs.
fn study(context: &Context, progress: Progress<'_>) -> (String, Vec<Run>) {
    let scene = load_for(context, SCENE, Selection::Labels(Some("rigid"))).unwrap();
    let choices = scene.select(Some("rigid")).unwrap();
    let methods = vec![
        VELOCITY_VERLET.at_step(1e-5),
        RK4.at_step(1e-5),
        DOPRI5.at_tolerance(1e-6),
    ];
    let plan = Plan::of(&scene, &choices, &[]).with_methods(methods);
    let folder = tempfile::tempdir().unwrap();
    let journal = Journal::open(&folder.path().join(JOURNAL), &Subject::default(), true).unwrap();
    let results = compare::compare(&plan, &Runner::new(context.clone(), journal, progress));
    (scene.title, results.unwrap().runs)
}

/// Steps and forces of each run.
fn computed(runs: &[Run]) -> Vec<(u64, Vec<f64>)> {
    let of = |run: &Run| {
        (
            run.steps,
            run.series.clone().unwrap().contact_force().to_vec(),
        )
    };
    runs.iter().map(of).collect()
}

/// Returns whether a pair of full finite elements is built, and the reason against it.
fn builds(context: &Context) -> Result<(), String> {
    let scene = SceneFile::parse(
        context,
        "coarse.toml",
        coarse_full().text(),
        Origin::Shipped,
        false,
    );
    scene.map(|_| ()).map_err(|e| e.to_text())
}

/// The context of the study that is interrupted: little memory, another scene of the same name, one more model.
fn narrow() -> Context {
    let shipped = load_for(&Context::default(), SCENE, Selection::None).unwrap();
    let text = (shipped.text())
        .replace("title = \"", "title = \"Recorded: ")
        .replace("face_width_m = 0.01", "face_width_m = 3.5");
    let rigid = Context::default().models[0];
    let mut context = Context::default().with_model(Model {
        id: "another",
        ..rigid
    });
    context.resources.memory = Memory::of(2e6);
    context.rerun = Arc::new([Source {
        name: SCENE.into(),
        scene: text,
        ..Source::default()
    }]);
    context
}

#[test]
fn two_studies_in_one_process_do_not_know_of_each_other() {
    let alone = computed(&study(&Context::default(), &|_, _, _| {}).1);
    let (narrow, wide) = (narrow(), Context::default());
    let (tell_begun, begun) = channel();
    let (tell_interrupted, interrupted) = channel();
    let [begun, interrupted] = [begun, interrupted].map(Mutex::new);
    // What a thread sends with ends with it: the other does not wait for a thread that has failed.
    let one = || {
        let tell_interrupted = tell_interrupted;
        // After its first run, when the other is at its first.
        let progress = |done, _, _: &str| {
            if done == 1 && !narrow.interruption.is_requested() {
                lock(&begun).recv().unwrap();
                narrow.interruption.request();
                tell_interrupted.send(()).unwrap();
            }
        };
        let found = study(&narrow, &progress);
        (found, builds(&narrow))
    };
    let other = || {
        let tell_begun = tell_begun;
        let progress = |done, _, _: &str| {
            if done == 0 && !narrow.interruption.is_requested() {
                tell_begun.send(()).unwrap();
                lock(&interrupted).recv().unwrap();
            }
        };
        let found = study(&wide, &progress);
        (found, builds(&wide))
    };
    let (one, other) = std::thread::scope(|scope| {
        let one = scope.spawn(|| narrow.resources.within(one));
        let other = scope.spawn(|| wide.resources.within(other));
        (one.join().unwrap(), other.join().unwrap())
    });

    let ((title, runs), built) = one;
    assert!(title.starts_with("Recorded: "), "{title}");
    let stopped: Vec<bool> = (runs.iter())
        .map(|r| r.status == Status::Interrupted)
        .collect();
    assert_eq!(stopped, [false, true, true]);
    assert!(built.unwrap_err().contains("0.0 GB are allowed"));
    let warnings = narrow.messages.warnings();
    assert!(warnings.iter().any(|w| w.contains("face_width_m")));
    assert!(narrow.models.iter().any(|m| m.id == "another"));

    let ((title, runs), built) = other;
    assert!(title.starts_with("A free spur pair"), "{title}");
    assert_eq!(computed(&runs), alone);
    assert_eq!(built, Ok(()));
    assert_eq!(wide.messages.warnings(), [""; 0]);
    assert!(wide.models.iter().all(|m| m.id != "another"));
}
