//! Every class of failure, caused on purpose, through the real scene wherever the shipped laws can produce it.
//!
//! The table: `cargo test --release -p gearbench-tests --test failures -- --nocapture`.
#![allow(clippy::print_stdout)]

mod wrong_laws;

use gearbench::context::Context;
use gearbench::experiment::run::{Job, NO_BOUND, run};
use gearbench::experiment::status::{RunMonitor, against_contact, judge};
use gearbench_integrators::Scheme;
use gearbench_integrators::{NullSink, Resolution, TimePlan, Work};
use gearbench_models::law::Damping;
use gearbench_models::scene::Scene;
use gearbench_models::spec::{
    ContactSpec, Load, ModelSpec, Modelling, Profile, SceneSpec, effective_radius,
};
use gearbench_reports::metrics::{Metric, compare};
use gearbench_reports::record::{Results, Run, Status, StudyHeader, Tolerance};
use gearbench_tests::*;
use std::sync::LazyLock;
use wrong_laws::{WrongLaw, WrongScene};

/// End after the impact of case A, before the opposite flanks touch, and initial gap.
const T_END: f64 = 1.5e-4;
const GAP: f64 = 3.1e-6;
const STIFFNESS: f64 = 1.54e10;

/// A scene with the settings of its run.
#[derive(Clone)]
struct FailureCase {
    scene: SceneSpec,
    model: ModelSpec,
    contact: ContactSpec,
    t_end: f64,
    events: bool,
    max_steps: u64,
}

impl FailureCase {
    fn rigid() -> Self {
        FailureCase {
            scene: case_a(GAP),
            model: rigid(),
            contact: contact(STIFFNESS),
            t_end: T_END,
            events: true,
            max_steps: 200_000,
        }
    }

    fn movable() -> Self {
        FailureCase {
            model: movable(5.3e8, 4.8e-3, 0.0),
            contact: contact(5e10),
            ..Self::rigid()
        }
    }

    fn modelling(&self) -> Modelling {
        Modelling {
            gears: vec![self.model.clone(); 2],
            contacts: vec![self.contact.clone()],
        }
    }

    fn run(&self, text: &str, resolution: Resolution) -> Run {
        let grid: Vec<f64> = (0..=300)
            .map(|i| self.t_end * f64::from(i) / 300.0)
            .collect();
        run(&Job {
            scene: &self.scene,
            modelling: &self.modelling(),
            context: &Context {
                models: models().into(),
                ..Context::default()
            },
            method: &Scheme {
                method: text.parse().unwrap(),
                resolution,
            },
            t_end: self.t_end,
            grid: &grid,
            also_steps: true,
            forces: false,
            measurable: false,
            paths: false,
            histories: false,
            motion: false,
            pictures: None,
            events: self.events,
            repeats: 0,
            timeout: NO_BOUND,
            max_steps: self.max_steps,
        })
        .unwrap_or_else(|e| panic!("{text}: {e}"))
    }

    /// Runs the same scene under a wrong law; the record has only the data of a verdict.
    fn run_wrong(&self, wrong: WrongLaw, text: &str, resolution: Resolution) -> Run {
        let scene = Scene::build(&self.scene, &self.modelling(), &models()).unwrap();
        let effective_radii = [0, 1].map(|i: usize| effective_radius(&self.scene.gears[i].body));
        let mut monitor = RunMonitor::new(&self.scene, &scene, vec![0.0, self.t_end], true);
        let mut s = scene.initial();
        let mut sys = WrongScene::new(
            scene,
            wrong,
            effective_radii,
            self.scene.meshes[0].start.gap,
        );
        let plan = TimePlan {
            events: self.events,
            max_steps: self.max_steps,
            ..TimePlan::new(self.t_end, resolution)
        };
        let mut method = gearbench_integrators::method(text).unwrap();
        let mut work = Work::default();
        let outcome = method.run(&mut sys, &mut s, &plan, &mut monitor, &mut work);
        let (status, message) = monitor.status(&mut sys, &s, &outcome);
        Run {
            integrator: text.into(),
            status,
            message,
            simulated_s: s.t,
            steps: work.steps,
            ..Run::default()
        }
    }
}

fn step(h: f64) -> Resolution {
    Resolution::Step(h)
}

/// A class of failure: the expected status, its cause, and the run.
struct FailureRun(Status, &'static str, Run);

/// Returns a pinion whose motion a torque reverses half a micrometre after first contact, 55 us after the start.
fn grazing() -> FailureCase {
    let mut case = FailureCase::rigid();
    case.scene.meshes[0].start.gap = 20e-6;
    let pinion = &mut case.scene.gears[0];
    let r = effective_radius(&pinion.body);
    // It returns after v^2 / (2 a).
    let v = pinion.speed * r;
    let a = v * v / (2.0 * 20.5e-6);
    let torque = -a / r * pinion.inertia.unwrap();
    pinion.loads = vec![Load::Applied(Profile::Constant(torque))];
    case.events = false;
    case
}

/// Returns flanks that approach slowly, with a damper whose force jumps: 0.07 s after the start the step that resolves
/// the jump to this tolerance is below the resolution of time.
fn jump() -> FailureCase {
    let mut case = FailureCase::rigid();
    case.scene.gears[0].speed = 0.02;
    case.scene.meshes[0].start.gap = 5e-5;
    case.contact.damping = Damping::KelvinVoigtRatio { ratio: 0.5 };
    case.events = false;
    case.t_end = 0.1;
    case
}

/// Returns stiff restitution: in long steps Newton's method alternates between contact and none.
fn restitution() -> FailureCase {
    let mut case = FailureCase::rigid();
    case.contact.exponent = 1.5;
    case.contact.damping = Damping::HuntCrossley { e: 0.3 };
    case.events = false;
    case.t_end = 1e-2;
    case
}

/// Returns the same scene with a common rotation.
fn fast(mut case: FailureCase) -> FailureCase {
    let [a, b] = [0, 1].map(|i: usize| effective_radius(&case.scene.gears[i].body));
    case.scene.gears[0].speed += 300.0;
    case.scene.gears[1].speed -= 300.0 * a / b;
    case
}

fn lasting(t_end: f64, case: FailureCase) -> FailureCase {
    FailureCase { t_end, ..case }
}

/// All classes of failure, run once.
static DRIVEN: LazyLock<Vec<FailureRun>> = LazyLock::new(drive);

fn drive() -> Vec<FailureRun> {
    let rigid = FailureCase::rigid();
    let movable = FailureCase::movable();
    let clipped = FailureCase {
        events: false,
        ..FailureCase::rigid()
    };
    let fine = rigid.run("rk4", step(1e-7));
    let reference = fine.series.clone().unwrap();

    let mut coarse = rigid.run("velocity-verlet", step(1e-5));
    let metrics = compare(coarse.finished().unwrap(), &reference, "self");
    coarse.metrics.push(metrics);
    let tolerance = Tolerance {
        metric: Metric::ForceL1,
        limit: 1e-3,
        against: "self".into(),
        except: Vec::new(),
    };
    judge(&mut coarse, (Some(&tolerance), None), None);
    // That a method kept its own tolerance is no judgement; a comparison is one.
    let mut tight = rigid.run("dopri5", Resolution::Tolerance(1e-8));
    assert_eq!(tight.status, Status::Unchecked);
    let metrics = compare(tight.finished().unwrap(), &reference, "self");
    tight.metrics.push(metrics);
    judge(&mut tight, (Some(&tolerance), None), None);

    // This method turns back a few micrometres too early; the other flank is not met yet.
    let early = lasting(1.1e-4, grazing());
    let mut missed = early.run("semi-implicit-euler", step(8e-6));
    let touched = early.run("rk4", step(1e-7)).series.unwrap();
    against_contact(&mut missed, &touched);

    let graze = lasting(1.6e-4, grazing());
    let glue = WrongLaw::Glue {
        stiffness: 1e7,
        range: 2e-6,
    };
    vec![
        FailureRun(Status::Converged, "a tolerance of 1e-8", tight),
        FailureRun(Status::Unchecked, "steps of 0.1 us", fine),
        FailureRun(Status::Inaccurate, "ten steps per contact", coarse),
        // Movable teeth are stable up to 3.8 us.
        FailureRun(
            Status::EnergyGrowth,
            "1.1 times the largest stable step",
            movable.run("velocity-verlet", step(4.2e-6)),
        ),
        // What the teeth make up is nothing beside the energy of gears that turn fast.
        FailureRun(
            Status::EnergyGrowth,
            "the same on gears that turn fast",
            fast(movable.clone()).run("velocity-verlet", step(4.2e-6)),
        ),
        FailureRun(
            Status::BlowUp,
            "26 times the largest stable step",
            movable.run("velocity-verlet", step(1e-4)),
        ),
        FailureRun(
            Status::BlowUp,
            "a force that is no number (test only)",
            clipped.run_wrong(WrongLaw::NoNumber, "rk4", step(1e-7)),
        ),
        FailureRun(
            Status::NewtonFailure,
            "restitution in steps of ten contacts",
            restitution().run("newmark", step(1e-3)),
        ),
        FailureRun(
            Status::StepUnderflow,
            "a damper's jump at a tolerance of 1e-15",
            jump().run("dopri5", Resolution::Tolerance(1e-15)),
        ),
        FailureRun(
            Status::Chatter,
            "a contact that lets go at once (test only)",
            rigid.run_wrong(WrongLaw::Flips, "rk4", step(1e-6)),
        ),
        FailureRun(
            Status::Tunnelling,
            "a step of one pitch",
            lasting(0.05, clipped.clone()).run("semi-implicit-euler", step(0.0157)),
        ),
        FailureRun(
            Status::Tunnelling,
            "a contact that begins and ends within a step",
            graze.run("velocity-verlet", step(4.1e-5)),
        ),
        FailureRun(
            Status::Tunnelling,
            "no contact where the converged solution has one",
            missed,
        ),
        FailureRun(
            Status::AdhesiveForce,
            "a law that pulls (test only)",
            clipped.run_wrong(glue, "rk4", step(1e-7)),
        ),
        FailureRun(
            Status::Timeout,
            "a bound of ten steps",
            FailureCase {
                max_steps: 10,
                ..FailureCase::rigid()
            }
            .run("rk4", step(1e-7)),
        ),
    ]
}

/// Returns true if a text has no invalid numbers.
fn is_finite_text(text: &str) -> bool {
    text.split(|c: char| !c.is_alphanumeric())
        .all(|word| !["nan", "inf", "infinity"].contains(&word.to_lowercase().as_str()))
}

#[test]
fn every_class_is_driven_and_labelled() {
    let list = &*DRIVEN;
    for FailureRun(status, how, run) in list {
        println!(
            "{:16} {how:48} {}: {}",
            status.as_str(),
            run.integrator,
            run.message.as_deref().unwrap_or("-")
        );
    }
    for FailureRun(status, how, run) in list {
        assert_eq!(run.status, *status, "{how}: {:?}", run.message);
        // All but success says when or how much, and what to do.
        let said = run.message.as_deref().unwrap_or_default();
        let told = said.contains(|c: char| c.is_ascii_digit()) && said.len() > 40;
        assert!(told || status.holds(), "{how}: {said}");
        assert!(is_finite_text(said), "{how}: {said}");
    }
    // What is not the doing of a run is driven where it happens: by the runner, by signals, by models that cannot run.
    let of_runs =
        |s: &Status| !matches!(s, Status::Refused | Status::Aborted | Status::Interrupted);
    for status in Status::ALL.into_iter().filter(of_runs) {
        assert!(list.iter().any(|d| d.0 == status), "{status} is not driven");
    }
}

/// The record of all failures, with its tables and its page, has valid numbers only.
#[test]
fn records_of_failures_hold_finite_numbers() {
    let mut runs: Vec<Run> = DRIVEN.iter().map(|d| d.2.clone()).collect();
    for (i, run) in runs.iter_mut().enumerate() {
        run.model = "rigid".into();
        run.variant = Some(format!("case {i}"));
        // A run that failed in its first step has no history.
        if let Some(series) = &run.series {
            assert!(run.simulated_s == 0.0 || !series.time_s.is_empty());
            let columns = series.columns.iter().map(|c| &c.values);
            for column in columns.chain([&series.time_s]) {
                assert!(column.iter().all(|x| x.is_finite()), "{}", run.status);
            }
        }
    }
    let results = Results {
        header: StudyHeader {
            scene: "failures".into(),
            title: "failures".into(),
            ..StudyHeader::default()
        },
        runs,
        ..Results::default()
    };
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("failures");
    gearbench_reports::write_results(&dir, &results).unwrap();
    let mut files = 0;
    let mut folders = vec![dir];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap().map(Result::unwrap) {
            if entry.path().is_dir() {
                folders.push(entry.path());
                continue;
            }
            let text = std::fs::read_to_string(entry.path()).unwrap();
            // The code of the scripts of a page may have these words.
            let mut parts = text.split("<script>");
            let first = parts.next().unwrap_or_default().to_owned();
            let text = parts.fold(first, |kept, part| {
                kept + part.split_once("</script>").map_or("", |(_, after)| after)
            });
            assert!(is_finite_text(&text), "{:?}", entry.path());
            files += 1;
        }
    }
    assert!(files > 3, "{files} files");
}

/// Teeth that a step moves far beyond their gears end a run: windows that follow them tooth by tooth would never
/// arrive.
#[test]
fn movable_teeth_that_blow_up_come_to_an_end() {
    let case = FailureCase::movable();
    for (text, h) in [("velocity-verlet", 8e-6), ("semi-implicit-euler", 3e-5)] {
        let mut scene = Scene::build(&case.scene, &case.modelling(), &models()).unwrap();
        let mut s = scene.initial();
        let plan = TimePlan {
            events: false,
            max_steps: 3000,
            ..TimePlan::new(0.02, step(h))
        };
        let mut method = gearbench_integrators::method(text).unwrap();
        let mut work = Work::default();
        let ended = method.run(&mut scene, &mut s, &plan, &mut NullSink, &mut work);
        println!(
            "{text}: {ended:?} after {} steps, {:.1e} rad",
            work.steps, s.q[0]
        );
        assert!(ended.is_err() || s.q[0].abs() > 1e6, "{text}: {:?}", s.q[0]);
    }
}

/// A deflection of more than a tenth of the module gives a warning in the message of an otherwise successful run: no
/// contact law and no linear tooth is valid there.
#[test]
fn deflections_beyond_a_tenth_of_the_module_are_warned_of() {
    for (speed, warned) in [(20.0, false), (1500.0, true)] {
        let mut case = FailureCase::rigid();
        case.scene.gears[0].speed = speed;
        // The flanks part again before the others meet.
        case.t_end = 0.9 * T_END;
        let run = case.run("dopri5", Resolution::Tolerance(1e-8));
        let message = run.message.unwrap_or_default();
        println!("{speed} rad/s: {:?} {message}", run.status);
        assert_eq!(message.contains("of the module"), warned, "{message}");
    }
}
