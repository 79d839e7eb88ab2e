//! Runs of one model of a scene under one integrator, as often as wanted: the scene is read and built once.

use super::errors::{input_error, refusal, run_error, scene_error};
use super::laws::{Failures, GivenLaw, with_laws};
use super::records::Classes;
use super::scenes::context;
use gearbench::cli::terminal::integrators_of;
use gearbench::context::Context;
use gearbench::experiment::conditions::{Conditions, even};
use gearbench::experiment::configuration::Configuration;
use gearbench::experiment::parallel::lock;
use gearbench::experiment::run::{Job, RunError, bare, run_in, run_with_observer};
use gearbench::scene_file::{SceneFile, Selection, load_for};
use gearbench::small_signals::{Patience, assemble};
use gearbench_integrators::{AcceptedStep, Control, Scheme, Sink, system::SecondOrderSystem};
use gearbench_models::scene::Scene;
use gearbench_reports::record::Run;
use numpy::PyArray1;
use pyo3::prelude::*;
use std::cell::RefCell;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// Time between two looks for signals.
const EVERY: Duration = Duration::from_millis(20);

/// A run before its conversion to an object of Python, which happens when one of its fields is first used.
#[pyclass(module = "gearbench._native", frozen)]
struct RecordedRun {
    run: Mutex<Option<Box<Run>>>,
}

#[pymethods]
impl RecordedRun {
    /// Converts the run and hands its histories over; None the second time.
    fn convert<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let run = lock(&self.run).take();
        let classes = Classes::of(py)?;
        run.map(|run| classes.whole_run(*run)).transpose()
    }
}

/// A model of a scene under an integrator.
#[pyclass(module = "gearbench._native", frozen)]
struct Simulation {
    context: Context,
    file: SceneFile,
    entry: Configuration,
    method: Scheme,
    conditions: Conditions,
    histories: bool,
    /// Exceptions of its contact laws.
    failures: Arc<Failures>,
    grid: Vec<f64>,
    /// Number of the simulation, by which a thread finds the scene that it has built.
    number: u64,
}

/// Number of built scenes that a thread keeps.
const MOST_BUILT: usize = 4;

/// A built scene with the number of its simulation, and the time that it took.
struct BuiltScene {
    number: u64,
    scene: Scene,
    setup: Duration,
}

thread_local! {
    /// Scenes that the simulations of this thread have built, the last used at the end: a built scene stays in its thread.
    static BUILT: RefCell<Vec<BuiltScene>> = const { RefCell::new(Vec::new()) };
}

impl Drop for Simulation {
    fn drop(&mut self) {
        // At the end of a thread its scenes are gone already.
        let _ = BUILT.try_with(|all| all.borrow_mut().retain(|b| b.number != self.number));
    }
}

/// Observes a run for Python: looks for signals, and calls a function after each accepted step.
struct Observer<'o> {
    callback: Option<&'o Py<PyAny>>,
    looked: Instant,
    failure: Option<PyErr>,
    context: Context,
}

impl Observer<'_> {
    fn stop(&mut self, e: PyErr) -> Control {
        self.failure = Some(e);
        self.context.interruption.request();
        Control::Stop
    }
}

impl Sink for Observer<'_> {
    fn accepted(&mut self, _: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        if let Some(callback) = self.callback {
            let called = Python::attach(|py| {
                let [q, v] = [&step.to.q, &step.to.v].map(|x| PyArray1::from_slice(py, x));
                let wanted = callback.call1(py, (step.to.t, q, v))?;
                wanted.extract::<Option<bool>>(py)
            });
            match called {
                Ok(Some(true)) => return Control::Stop,
                Ok(_) => {}
                Err(e) => return self.stop(e),
            }
        }
        if self.looked.elapsed() < EVERY {
            return Control::Continue;
        }
        self.looked = Instant::now();
        match Python::attach(|py| py.check_signals()) {
            Ok(()) => Control::Continue,
            Err(e) => self.stop(e),
        }
    }

    fn wants_restarts(&self) -> bool {
        false
    }
}

#[pymethods]
impl Simulation {
    /// Reads the scene, and builds the model.
    #[new]
    #[pyo3(signature = (name, text, model=None, method=None, samples=None, timeout=None, events=true, histories=false, laws=vec![]))]
    #[allow(clippy::too_many_arguments)]
    fn new(
        py: Python<'_>,
        name: &str,
        text: &str,
        model: Option<&str>,
        method: Option<&str>,
        samples: Option<usize>,
        timeout: Option<f64>,
        events: bool,
        histories: bool,
        laws: Vec<GivenLaw>,
    ) -> PyResult<Self> {
        let failures = Arc::default();
        let context = with_laws(context().with_scene(name, text), laws, &failures);
        let unbuilt = load_for(&context, name, Selection::None).map_err(|e| scene_error(py, &e))?;
        let choices = unbuilt.select(model).map_err(|e| scene_error(py, &e))?;
        let label = choices[0].label.clone();
        let loaded = py.detach(|| {
            let selection = Selection::Labels(Some(&label));
            context
                .resources
                .within(|| load_for(&context, name, selection))
        });
        if let Some(e) = failures.take_own() {
            return Err(e);
        }
        let file = loaded.map_err(|e| scene_error(py, &e))?;
        let refused = file.refused.iter().find(|r| r.label == label);
        if let Some(refused) = refused {
            return Err(scene_error(py, &refused.error));
        }
        let choice = file.model(&label);
        let Some(choice) = choice else {
            return Err(input_error(py, &format!("there is no model `{label}`"), ""));
        };
        let entry = Configuration::of(&file, choice);
        let methods = integrators_of(&file, method).map_err(|e| refusal(py, e))?;
        let known = || {
            entry
                .methods
                .as_ref()
                .unwrap_or(&file.study.integrators)
                .first()
                .copied()
        };
        let method = match methods.as_deref() {
            Some([one]) => Some(*one),
            Some(_) => {
                let help = "give one method, for example dopri5@1e-8; `compare` runs several";
                return Err(input_error(py, "a run has one integrator", help));
            }
            None => known(),
        };
        let Some(method) = method else {
            let help = "name one, for example method=\"dopri5@1e-6\"";
            return Err(input_error(
                py,
                "no integrator is known for the model",
                help,
            ));
        };
        let of_scene = Conditions::of(&file);
        let conditions = Conditions {
            samples: samples.unwrap_or(of_scene.samples),
            events: of_scene.events && events,
            repeats: 0,
            timeout: timeout.map_or(of_scene.timeout, Duration::from_secs_f64),
            measurable: true,
            ..of_scene
        };
        let grid = even(conditions.samples, conditions.duration);
        let made = Simulation {
            context,
            entry,
            method,
            conditions,
            histories,
            failures,
            grid,
            file,
            number: SIMULATIONS.fetch_add(1, Ordering::Relaxed),
        };
        let built = py.detach(|| made.build().map(give_back));
        if let Some(e) = made.failures.take_own() {
            return Err(e);
        }
        built.map_err(|e| run_error(py, e))?;
        Ok(made)
    }

    /// Label of the model.
    #[getter]
    fn model(&self) -> String {
        self.entry.label.clone()
    }

    /// Integrator with its step or tolerance.
    #[getter]
    fn method(&self) -> String {
        self.method.to_string()
    }

    /// Warnings of the scene and its model.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.file.context.messages.warnings()
    }

    /// Runs the model from the initial state. Returns the run before its conversion, and the reason if it failed.
    #[pyo3(signature = (observer=None))]
    fn run(
        &self,
        py: Python<'_>,
        observer: Option<Py<PyAny>>,
    ) -> PyResult<(RecordedRun, Option<String>)> {
        let (made, failure) = py.detach(|| self.run_once(observer.as_ref()));
        if let Some(e) = self.failures.take_own().or(failure) {
            return Err(e);
        }
        let mut row = made.map_err(|e| run_error(py, e))?;
        self.entry.sign(&mut row);
        let failed = row.status.is_failure().then(|| {
            let status = || row.status.as_str().to_owned();
            row.message.clone().unwrap_or_else(status)
        });
        let run = Mutex::new(Some(Box::new(row)));
        Ok((RecordedRun { run }, failed))
    }

    /// Integrates without recording as often as asked, without Python; the wall time [s].
    fn integrate_repeatedly(&self, py: Python<'_>, times: usize) -> PyResult<f64> {
        py.detach(|| {
            let mut built = self.taken()?;
            let conditions = self.conditions.clone();
            let job = self.job(&conditions);
            let begin = Instant::now();
            {
                let mut integrate = bare(&job, &mut built.scene);
                (0..times).for_each(|_| integrate());
            }
            let spent = begin.elapsed().as_secs_f64();
            give_back(built);
            Ok(spent)
        })
        .map_err(|e: RunError| run_error(py, e))
    }

    /// Runs the model as often as asked, with its histories, without Python; the wall time [s].
    fn run_repeatedly(&self, py: Python<'_>, times: usize) -> PyResult<f64> {
        py.detach(|| {
            let begin = Instant::now();
            let mut built = self.taken()?;
            let job = self.job(&self.conditions);
            for _ in 0..times {
                run_in(&job, &mut built.scene, built.setup)?;
            }
            give_back(built);
            Ok(begin.elapsed().as_secs_f64())
        })
        .map_err(|e: RunError| run_error(py, e))
    }
}

/// Number of simulations so far.
static SIMULATIONS: AtomicU64 = AtomicU64::new(0);

/// Keeps a built scene for the next run in this thread.
fn give_back(built: BuiltScene) {
    BUILT.with_borrow_mut(|all| {
        if all.len() >= MOST_BUILT {
            all.remove(0);
        }
        all.push(built);
    });
}

impl Simulation {
    fn build(&self) -> Result<BuiltScene, RunError> {
        let begin = Instant::now();
        let (spec, modelling) = (&self.entry.scene, &self.entry.modelling);
        let patience = Patience::until(&self.context.interruption);
        let scene = (self.context.resources)
            .within(|| assemble(spec, modelling, &self.context.models, &patience))?;
        Ok(BuiltScene {
            number: self.number,
            scene,
            setup: begin.elapsed(),
        })
    }

    /// Takes the scene that this thread has built, or builds it.
    fn taken(&self) -> Result<BuiltScene, RunError> {
        let known = BUILT.with_borrow_mut(|all| {
            let place = all.iter().position(|b| b.number == self.number);
            place.map(|i| all.remove(i))
        });
        known.map_or_else(|| self.build(), Ok)
    }

    fn job<'j>(&'j self, conditions: &'j Conditions) -> Job<'j> {
        Job {
            histories: self.histories,
            ..conditions.job(
                (&self.entry.scene, &self.entry.modelling),
                &self.method,
                &self.grid,
            )
        }
    }

    fn run_once(&self, callback: Option<&Py<PyAny>>) -> (Result<Run, RunError>, Option<PyErr>) {
        let mut built = match self.taken() {
            Ok(built) => built,
            Err(e) => return (Err(e), None),
        };
        // A request of one run is not one of the next.
        let context = Context {
            interruption: Default::default(),
            ..self.context.clone()
        };
        let conditions = Conditions {
            context: context.clone(),
            ..self.conditions.clone()
        };
        let mut observer = Observer {
            callback,
            looked: Instant::now(),
            failure: None,
            context,
        };
        let job = self.job(&conditions);
        let made = (self.context.resources)
            .within(|| run_with_observer(&job, &mut built.scene, built.setup, &mut observer));
        if made.is_ok() {
            give_back(built);
        }
        (made, observer.failure)
    }
}

/// Adds the class to the module.
///
/// # Errors
/// Errors of Python.
pub fn add(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<RecordedRun>()?;
    module.add_class::<Simulation>()
}
