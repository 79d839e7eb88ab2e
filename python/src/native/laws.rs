//! Contact laws that are functions of Python.
//!
//! A law is called with the interpreter lock wherever the run evaluates the force of a tooth pair. An exception ends the run:
//! the force is then not a number, nothing is called any more, and the caller of the run raises the exception.

use gearbench::context::Context;
use gearbench::experiment::interruption::Interruption;
use gearbench::experiment::parallel::lock;
use gearbench_models::law::{ContactState, ForceLaw, LawForce};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyFloat, PyTuple};
use std::fmt;
use std::sync::atomic::{AtomicU8, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::{ThreadId, current};

/// Step of central differences by the stiffness, relative to it.
const STIFFNESS_STEP: f64 = 1e-5;

/// A law as the package hands it over: its name, a text that no other law has, the function and the number of its arguments,
/// the potential and the number of its arguments, and whether the force depends on the gap alone.
pub type GivenLaw = (
    String,
    String,
    (Py<PyAny>, usize),
    Option<(Py<PyAny>, usize)>,
    bool,
);

/// Exceptions of laws, by the thread in which they occurred.
#[derive(Default)]
pub struct Failures {
    all: Mutex<Vec<(ThreadId, PyErr)>>,
    number: AtomicUsize,
    /// Ends the studies whose runs failed.
    interruption: Option<Interruption>,
}

impl Failures {
    /// Creates the failures of a study, which the first exception interrupts.
    pub fn of_study(interruption: Interruption) -> Self {
        Failures {
            interruption: Some(interruption),
            ..Failures::default()
        }
    }

    fn add(&self, e: PyErr) {
        lock(&self.all).push((current().id(), e));
        self.number.fetch_add(1, Ordering::Relaxed);
        if let Some(interruption) = &self.interruption {
            interruption.request();
        }
    }

    /// Returns true if a law has failed in this thread, or in the study.
    fn is_failed(&self) -> bool {
        if self.number.load(Ordering::Relaxed) == 0 {
            return false;
        }
        let id = current().id();
        self.interruption.is_some() || lock(&self.all).iter().any(|(of, _)| *of == id)
    }

    /// Takes the exception of this thread.
    pub fn take_own(&self) -> Option<PyErr> {
        let id = current().id();
        self.take(|of| of == id)
    }

    /// Takes the first exception.
    pub fn take_first(&self) -> Option<PyErr> {
        self.take(|_| true)
    }

    fn take(&self, is_wanted: impl Fn(ThreadId) -> bool) -> Option<PyErr> {
        let mut all = lock(&self.all);
        let place = all.iter().position(|(of, _)| is_wanted(*of))?;
        self.number.fetch_sub(1, Ordering::Relaxed);
        Some(all.remove(place).1)
    }
}

/// Adds laws of Python to a context.
pub fn with_laws(context: Context, laws: Vec<GivenLaw>, failures: &Arc<Failures>) -> Context {
    laws.into_iter().fold(context, |context, given| {
        let (name, identity, function, potential, is_elastic) = given;
        context.with_law(Arc::new(PythonLaw {
            name,
            identity,
            function,
            potential,
            is_elastic,
            returns: AtomicU8::new(UNKNOWN),
            failures: failures.clone(),
        }))
    })
}

/// Result of a function: not known yet, the force, or the force and its derivatives.
const UNKNOWN: u8 = 0;
const FORCE: u8 = 1;
const DERIVATIVES: u8 = 2;

/// A contact law that is a function of Python.
struct PythonLaw {
    name: String,
    identity: String,
    function: (Py<PyAny>, usize),
    potential: Option<(Py<PyAny>, usize)>,
    is_elastic: bool,
    returns: AtomicU8,
    failures: Arc<Failures>,
}

impl fmt::Debug for PythonLaw {
    /// Pieces of a study are reused where this text is equal: it is that of one function in one program.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.name, self.identity)
    }
}

/// Force, and derivatives by gap and gap rate where the function returns them.
type Returned = (f64, Option<[f64; 2]>);

fn returned(value: &Bound<'_, PyAny>) -> PyResult<Returned> {
    if let Ok(force) = value.cast_exact::<PyFloat>() {
        return Ok((force.value(), None));
    }
    if let Ok(all) = value.cast::<PyTuple>() {
        if let Ok((n, by_gap, by_rate)) = all.extract::<(f64, f64, f64)>() {
            return Ok((n, Some([by_gap, by_rate])));
        }
    } else if let Ok(force) = value.extract::<f64>() {
        return Ok((force, None));
    }
    Err(PyTypeError::new_err(format!(
        "a contact law returns the force, or (force, derivative by the gap, derivative by the gap rate) as numbers, not {}",
        value
            .repr()
            .map_or_else(|_| "this".to_owned(), |r| r.to_string())
    )))
}

impl PythonLaw {
    /// Calls a function of Python; not a number after an exception.
    fn call<T>(&self, of: impl FnOnce(Python<'_>) -> PyResult<T>) -> Option<T> {
        if self.failures.is_failed() {
            return None;
        }
        // Without an interpreter the program ends.
        Python::try_attach(|py| of(py).map_err(|e| self.failures.add(e)).ok()).flatten()
    }

    fn evaluate(&self, at: &ContactState) -> Option<Returned> {
        let (function, arguments) = &self.function;
        self.call(|py| {
            let ContactState {
                gap,
                gap_rate,
                stiffness,
                impact_speed,
            } = *at;
            let value = match arguments {
                2 => function.call1(py, (gap, gap_rate)),
                3 => function.call1(py, (gap, gap_rate, stiffness)),
                _ => function.call1(py, (gap, gap_rate, stiffness, impact_speed)),
            };
            let made = returned(value?.bind(py))?;
            let kind = made.1.map_or(FORCE, |_| DERIVATIVES);
            self.returns.store(kind, Ordering::Relaxed);
            Ok(made)
        })
    }
}

impl ForceLaw for PythonLaw {
    fn name(&self) -> &str {
        &self.name
    }

    fn force(&self, at: &ContactState) -> f64 {
        self.evaluate(at).map_or(f64::NAN, |(n, _)| n)
    }

    fn force_with_derivatives(&self, at: &ContactState) -> Option<LawForce> {
        if self.returns.load(Ordering::Relaxed) == FORCE {
            return None;
        }
        let (n, derivatives) = self.evaluate(at).unwrap_or((f64::NAN, Some([f64::NAN; 2])));
        let [dn_dg, dn_dgdot] = derivatives?;
        let dn_dk = if self.uses_stiffness() {
            let h = STIFFNESS_STEP * at.stiffness;
            let with = |stiffness: f64| self.force(&ContactState { stiffness, ..*at });
            (with(at.stiffness + h) - with(at.stiffness - h)) / (2.0 * h)
        } else {
            0.0
        };
        Some(LawForce {
            n,
            dn_dg,
            dn_dgdot,
            dn_dk,
        })
    }

    fn potential(&self, gap: f64, stiffness: f64) -> Option<f64> {
        let (function, arguments) = self.potential.as_ref()?;
        let value = self.call(|py| {
            let value = match arguments {
                1 => function.call1(py, (gap,)),
                _ => function.call1(py, (gap, stiffness)),
            };
            value?.extract::<f64>(py)
        });
        Some(value.unwrap_or(f64::NAN))
    }

    fn is_elastic(&self) -> bool {
        self.is_elastic
    }

    fn uses_stiffness(&self) -> bool {
        self.function.1 > 2 || self.potential.as_ref().is_some_and(|p| p.1 > 1)
    }

    fn uses_impact_speed(&self) -> bool {
        self.function.1 > 3
    }
}
