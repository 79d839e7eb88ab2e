//! The converged solution of a model: a run against which the integration error of its other runs is measured.
//!
//! Candidates are tried from the finest on, and the first that reaches the end within its bound of work is taken. Work is
//! steps times coordinates, and never time: the solution, and with it every error against it, is the same on every
//! machine and under every load. The record names the candidate that was taken ([`ConvergedSettings`]).
//!
//! | model | candidates |
//! |---|---|
//! | without modes, adaptive methods alone | Dormand-Prince with located events at a thousandth of their finest tolerance, then a hundredth, a tenth |
//! | without modes | Dormand-Prince with located events at 1e-12, 1e-10, 1e-8 |
//! | without modes, stiff beyond these | methods with a step among those of the study, at a tenth of it |
//! | with modes, adaptive methods among those of the study | Dormand-Prince at a tenth of their finest tolerance |
//! | with modes | the method that is exact for these at a tenth of its shortest step, then at a tenth of its finest tolerance or 1e-4 |
//!
//! **Which runs it judges.** A run is judged by a solution whose own error is at most a tenth of the run's
//! ([`Converged::judges`]): never by itself, and never by one that is hardly finer.

use super::run::{Job, NO_BOUND, RunError, run};
use gearbench_integrators::table::{DOPRI5, TRIGONOMETRIC};
use gearbench_integrators::{MethodSpec, Resolution, Scheme};
use gearbench_reports::numbers::quantity;
use gearbench_reports::record::{ConvergedSettings, Run, Status};
use gearbench_reports::series::TimeSeries;
use serde::{Deserialize, Serialize};

/// Tolerances of the converged solution with bounds on steps times coordinates: a hundredth of the tightest common
/// tolerance where it takes seconds, the last one for long stiff scenes.
const TIGHT: [(f64, u64); 3] = [(1e-12, 4_000_000), (1e-10, 4_000_000), (1e-8, 8_000_000)];
/// Tolerances relative to the finest one of adaptive methods, if there are no others.
const RELATIVE: [f64; 3] = [1e-3, 1e-2, FINER];
/// Relative tolerance of the method that is exact for modes, where the study uses no tighter one.
const EXACT_RTOL: f64 = 1e-4;
/// Bound on the number of steps of a solution by this method.
const EXACT_STEPS: u64 = 1_000_000;
/// Share of the simulated time on which an adaptive candidate is tried first where a stepped one follows, and the share of
/// its bound on steps that it may take there.
const PROBE: [f64; 2] = [0.02, 0.06];
/// Largest error of a converged solution relative to the error of the run that it judges.
const FINER: f64 = 0.1;
/// Largest number of coordinates for which a converged solution is computed: beyond, it costs more than all the runs.
pub const SMALL: usize = 2000;

/// A candidate method and its bound on attempted steps.
pub type Candidate = (Scheme, u64);

/// The converged solution of a model.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Converged {
    /// Method, step or tolerance of the solution.
    pub by: ConvergedSettings,
    /// The contact force and other channels of the solution over time.
    pub series: TimeSeries,
}

/// The converged solution, or the reason why there is none.
pub type ConvergedResult = Result<Converged, String>;

impl Converged {
    /// Checks that this solution is accurate enough to measure the error of a run under a method.
    ///
    /// # Errors
    /// The reason why it cannot, for the message of the run.
    pub fn judges(&self, method: &Scheme, row: &Run) -> Result<(), String> {
        let same =
            (self.by.integrator.parse::<MethodSpec>()).is_ok_and(|m| m.id() == method.method.id());
        let order = method.method.info().order as i32;
        // Remaining share of the error of a run, from the resolution of both.
        let left = match (method.resolution, self.by.step, self.by.rtol) {
            (Resolution::Tolerance(own), _, Some(rtol)) => rtol / own,
            (Resolution::Step(own), Some(step), _) if same => (step / own).powi(order),
            _ if same => (row.steps as f64 / self.by.steps.max(1) as f64).powi(order),
            // Two methods have no error in common.
            _ => 0.0,
        };
        if left <= FINER * (1.0 + 1e-9) {
            return Ok(());
        }
        Err(format!(
            "the model's own converged solution ({}) is not ten times finer than this run",
            self.by
        ))
    }
}

/// Describes in words how converged solutions are computed.
pub fn described() -> String {
    let [first, others @ ..] = TIGHT.map(|(rtol, _)| format!("{rtol:.0e}"));
    format!(
        "{}, rtol {first} ({} if this needs too many steps), next to adaptive methods alone a thousandth of their finest tolerance; for gears with modes {} at a tenth of the shortest of its steps, or rtol {EXACT_RTOL:.0e}; each run names its converged solution, which is at least ten times finer; a tolerance is relative to the scene's typical deflection and speed",
        DOPRI5.info().id,
        others.join(", "),
        TRIGONOMETRIC.info().id,
    )
}

/// The method that is exact for modes, at a relative tolerance.
pub fn exact_for_modes(rtol: f64) -> Scheme {
    TRIGONOMETRIC.at_tolerance(rtol)
}

/// Candidates for gears without modes, by number of coordinates. The error of fixed steps is not known before, so that
/// the solution next to them is as fine as it can be.
fn tight(coordinates: usize, asked: &[Scheme]) -> Vec<Candidate> {
    let tolerances: Option<Vec<f64>> = (asked.iter()).map(|s| s.resolution.tolerance()).collect();
    let finest = tolerances.and_then(|all| all.into_iter().min_by(f64::total_cmp));
    let candidate = |((rtol, work), relative): ((f64, u64), f64)| {
        let rtol = finest.map_or(rtol, |finest| (relative * finest).max(TIGHT[0].0));
        let steps = work / coordinates.max(1) as u64;
        (DOPRI5.at_tolerance(rtol), steps)
    };
    let mut all: Vec<Candidate> = TIGHT.into_iter().zip(RELATIVE).map(candidate).collect();
    all.dedup_by_key(|c| c.0);
    all
}

/// Candidates for the model of a `row` of the record, given the methods of the study.
pub fn candidates(row: &Run, asked: &[Scheme]) -> Vec<Candidate> {
    let exact = |s: &&Scheme| s.method.id() == TRIGONOMETRIC.id();
    let least = |all: &mut dyn Iterator<Item = f64>| all.min_by(f64::total_cmp);
    let mut all = Vec::new();
    if row.modes.is_some() {
        let mut others =
            (asked.iter().filter(|s| !exact(s))).filter_map(|s| s.resolution.tolerance());
        if let Some(rtol) = least(&mut others)
            && row.dofs <= SMALL
        {
            let (_, work) = TIGHT[1];
            let rtol = (FINER * rtol).max(TIGHT[0].0);
            all.push((DOPRI5.at_tolerance(rtol), work / row.dofs.max(1) as u64));
        }
        let of_method = || asked.iter().filter(exact);
        if let Some(h) = least(&mut of_method().filter_map(|s| s.resolution.step())) {
            let scheme = TRIGONOMETRIC.at(Resolution::Step(FINER * h));
            all.push((scheme, EXACT_STEPS));
        }
        let finest = least(&mut of_method().filter_map(|s| s.resolution.tolerance()));
        let rtol = finest.map_or(EXACT_RTOL, |r| (FINER * r).min(EXACT_RTOL));
        all.push((exact_for_modes(rtol), EXACT_STEPS));
        all.push((exact_for_modes(EXACT_RTOL), EXACT_STEPS));
        all.dedup();
    }
    if row.dofs <= SMALL {
        all.extend(tight(row.dofs, asked));
        // What is stiff, as a train with couplings, takes explicit methods more steps than they have.
        let finer = |s: &Scheme| {
            let step = s.resolution.step()?;
            Some((s.method.at(Resolution::Step(FINER * step)), EXACT_STEPS))
        };
        if row.modes.is_none() {
            all.extend(asked.iter().filter_map(finer));
        }
    }
    all
}

/// Computes the converged solution of the model of a `row` of the record.
///
/// # Errors
/// [`RunError`] where the model cannot be built, or the user interrupts.
pub fn of_model(
    job: &Job<'_>,
    row: &Run,
    candidates: &[Candidate],
) -> Result<ConvergedResult, RunError> {
    match converged(job, candidates)? {
        Ok(found) => Ok(Ok(found)),
        Err(_) if candidates.is_empty() => Ok(Err(format!(
            "{} coordinates are too many: a converged solution is computed for at most {SMALL}",
            row.dofs
        ))),
        Err(why) => Ok(Err(why)),
    }
}

/// Computes the solution by the first candidate that reaches the end within its bound of steps. A candidate that would
/// exceed its bound, judged by the progress of a finer one, is not tried.
///
/// # Errors
/// [`RunError`] where the model cannot be built, or the user interrupts.
pub fn converged(job: &Job<'_>, candidates: &[Candidate]) -> Result<ConvergedResult, RunError> {
    let mut tried: Vec<String> = Vec::new();
    // A finer candidate that did not get through, and the steps that the whole time would have taken at its pace.
    let mut pace: Option<(&Scheme, f64)> = None;
    for (method, steps) in candidates {
        let order = f64::from(method.method.info().order);
        if let Some((finer, needed)) = pace.filter(|(finer, _)| finer.method == method.method)
            && let [Some(rtol), Some(finer)] = [method, finer].map(|s| s.resolution.tolerance())
            && needed * (finer / rtol).powf(order.recip()) > *steps as f64
        {
            tried.push(format!("{}: more than {steps} steps", method.described()));
            continue;
        }
        let job = Job {
            method,
            repeats: 0,
            timeout: NO_BOUND,
            max_steps: *steps,
            events: true,
            histories: false,
            motion: false,
            pictures: None,
            ..*job
        };
        if method.resolution.tolerance().is_some() && stepped_follows(candidates, method) {
            let [time, share] = PROBE;
            let probe = Job {
                t_end: time * job.t_end,
                grid: &[],
                max_steps: (share * *steps as f64) as u64,
                ..job
            };
            if let Ok(row) = run(&probe)
                && row.status == Status::Timeout
            {
                tried.push(format!(
                    "{}: {} steps over the first {}",
                    method.described(),
                    probe.max_steps,
                    quantity(row.simulated_s, "s", 3)
                ));
                continue;
            }
        }
        let row = match run(&job) {
            // Terms of rotation couple the modes, or a carrier turns: this method is not for the model.
            Err(RunError::NoLinearPart(..)) => continue,
            row => row?,
        };
        let by = ConvergedSettings::from(&row);
        match row.series.filter(|_| !row.status.is_failure()) {
            Some(series) => return Ok(Ok(Converged { by, series })),
            None => tried.push(format!("{}: {}", method.described(), row.status)),
        }
        let part = row.simulated_s / job.t_end;
        pace = (part > 0.0 && row.status == Status::Timeout)
            .then(|| (method, (row.steps + row.rejected) as f64 / part));
    }
    Ok(Err(format!(
        "no converged solution of the model reached the end within its bound of steps ({})",
        tried.join("; ")
    )))
}

/// True if a candidate with a step follows an adaptive one of another method.
fn stepped_follows(candidates: &[Candidate], method: &Scheme) -> bool {
    let mut later = candidates.iter().skip_while(|(own, _)| own != method);
    later.any(|(other, _)| other.resolution.step().is_some())
}

#[cfg(test)]
mod tests {
    use super::*;
    use gearbench_integrators::table::{RK4, VELOCITY_VERLET};

    fn by(integrator: &str, step: Option<f64>, rtol: Option<f64>) -> Converged {
        Converged {
            by: ConvergedSettings {
                integrator: integrator.into(),
                step,
                rtol,
                steps: 1000,
            },
            series: TimeSeries::default(),
        }
    }

    /// A solution judges runs that are at least ten times coarser: by tolerances of any two methods, by steps with the
    /// order of the method, by the number of steps where one has a step and the other a tolerance.
    #[test]
    fn a_solution_judges_what_is_ten_times_coarser() {
        let row = |steps| Run {
            steps,
            ..Run::default()
        };
        let tight = by("dopri5", None, Some(1e-10));
        let judges = |own: &Converged, method: Scheme| own.judges(&method, &row(400)).is_ok();
        for (method, expected) in [
            (DOPRI5.at_tolerance(1e-10), false),
            (DOPRI5.at_tolerance(5e-10), false),
            (DOPRI5.at_tolerance(1e-9), true),
            (
                "bdf".parse::<MethodSpec>().unwrap().at_tolerance(1e-10),
                false,
            ),
            (
                "bdf".parse::<MethodSpec>().unwrap().at_tolerance(1e-6),
                true,
            ),
            (VELOCITY_VERLET.at_step(1e-6), true),
            (RK4.at_step(1e-9), true),
        ] {
            assert_eq!(judges(&tight, method), expected, "{method:?}");
        }
        // Of second order: half the step leaves a quarter of the error, a third of it a ninth, a quarter a sixteenth.
        let stepped = by("trigonometric", Some(1e-6), None);
        for (step, expected) in [(1e-6, false), (2e-6, false), (3e-6, false), (4e-6, true)] {
            assert_eq!(
                judges(&stepped, TRIGONOMETRIC.at_step(step)),
                expected,
                "{step}"
            );
        }
        // 400 steps of 1000: a sixth of the error is left.
        let exact = by("trigonometric", None, Some(1e-4));
        assert!(
            exact
                .judges(&TRIGONOMETRIC.at_step(1e-6), &row(400))
                .is_err()
        );
        assert!(
            exact
                .judges(&TRIGONOMETRIC.at_step(1e-6), &row(300))
                .is_ok()
        );
        let why = tight
            .judges(&DOPRI5.at_tolerance(1e-10), &row(1))
            .unwrap_err();
        assert!(why.contains("dopri5, rtol 1e-10"), "{why}");
    }

    /// Candidates are ten times finer than the methods of the study.
    #[test]
    fn candidates_are_finer_than_the_methods_of_the_study() {
        let asked = [
            TRIGONOMETRIC.at_step(1e-6),
            TRIGONOMETRIC.at_tolerance(1e-4),
            DOPRI5.at_tolerance(1e-6),
        ];
        let row = Run {
            modes: Some(20),
            dofs: 42,
            ..Run::default()
        };
        let all: Vec<Scheme> = candidates(&row, &asked).into_iter().map(|c| c.0).collect();
        assert_eq!(
            all[..4],
            [
                DOPRI5.at_tolerance(FINER * 1e-6),
                TRIGONOMETRIC.at(Resolution::Step(FINER * 1e-6)),
                exact_for_modes(FINER * 1e-4),
                exact_for_modes(EXACT_RTOL),
            ]
        );
        let rigid = Run {
            dofs: 2,
            ..Run::default()
        };
        let all = candidates(&rigid, &asked);
        assert_eq!(all[0], (DOPRI5.at_tolerance(1e-12), 2_000_000));
        let adaptive = [DOPRI5.at_tolerance(1e-4), DOPRI5.at_tolerance(1e-6)];
        let all: Vec<f64> = (candidates(&rigid, &adaptive).iter())
            .filter_map(|c| c.0.resolution.tolerance())
            .collect();
        assert!(
            all.len() == 3 && (all[0] / 1e-9 - 1.0).abs() < 1e-9,
            "{all:?}"
        );
        assert!((all[2] / 1e-7 - 1.0).abs() < 1e-9, "{all:?}");
        let fine = candidates(&rigid, &[DOPRI5.at_tolerance(1e-11)]);
        assert_eq!(fine[0].0, DOPRI5.at_tolerance(1e-12));
        let large = Run {
            dofs: SMALL + 1,
            ..Run::default()
        };
        assert!(candidates(&large, &asked).is_empty());
    }
}
