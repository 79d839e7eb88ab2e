//! A model's own converged solution: Dormand-Prince with located events at the tightest tolerance that is affordable; of
//! gears with modes the trigonometric method at a tenth of the step that is asked of it, which leaves a hundredth of its
//! error, or under a tolerance. A run by the same method at the same tolerance is this solution, and its errors are 0.

use super::run::{Job, RunError, run};
use gearbench_integrators::table::{DOPRI5, TRIGONOMETRIC};
use gearbench_integrators::{Resolution, Scheme};
use gearbench_reports::record::Run;
use gearbench_reports::series::TimeSeries;

/// Tolerances tried for the converged solution, and the steps times coordinates that each may take: a hundredth of the
/// tightest that people ask for where it takes seconds; long stiff scenes get the last.
const TIGHT: [(f64, u64); 3] = [
    (1e-12, 10_000_000),
    (1e-10, 20_000_000),
    (1e-8, 100_000_000),
];
/// Of gears with modes, by the method that is exact for these: the part of the shortest step that is asked of it, a
/// tolerance where none is or where that takes too long, and the steps that either may take.
const EXACT_MODES: (f64, f64, u64) = (0.1, 1e-4, 1_000_000);

/// How converged solutions of gears without modes are computed, the best first, with the work that each may take.
pub fn tight() -> [(Scheme, u64); TIGHT.len()] {
    TIGHT.map(|(rtol, work)| (DOPRI5.at_tolerance(rtol), work))
}

/// How converged solutions are computed, for a reader.
pub fn described() -> String {
    let [first, others @ ..] = TIGHT.map(|(rtol, _)| format!("{rtol:.0e}"));
    format!(
        "{}, rtol {first} ({} where that takes too long), a run at the same tolerance is this very solution; of gears with modes {} at a tenth of the shortest of its steps, rtol {:.0e} where it has none or that takes too long; a tolerance multiplies the scene's typical deflection and speed",
        DOPRI5.info().id,
        others.join(", "),
        TRIGONOMETRIC.info().id,
        EXACT_MODES.1,
    )
}

/// The method that is exact for modes, under a tolerance.
pub fn exact_for_modes(rtol: f64) -> Scheme {
    TRIGONOMETRIC.at_tolerance(rtol)
}

/// How converged solutions of gears with modes are computed where these methods are asked for, the best first, with the
/// steps that each may take.
pub fn exact(asked: &[Scheme]) -> Vec<(Scheme, u64)> {
    let (part, rtol, steps) = EXACT_MODES;
    let of_trigonometric = |s: &Scheme| match s.resolution {
        Resolution::Step(h) if s.method.id() == TRIGONOMETRIC.id() => Some(h),
        _ => None,
    };
    let shortest = asked.iter().filter_map(of_trigonometric);
    let shortest = shortest.min_by(f64::total_cmp);
    let finer = shortest.map(|h| TRIGONOMETRIC.at(Resolution::Step(part * h)));
    let all = finer.into_iter().chain([exact_for_modes(rtol)]);
    all.map(|scheme| (scheme, steps)).collect()
}

/// Coordinates up to which a converged solution is computed: beyond, it costs more than all the runs.
pub const SMALL: usize = 2000;

/// The converged solution of the model that a `row` of the record is of, which says how large it is: of gears with modes by
/// one of the methods that are `exact` for these. Where terms of rotation couple the modes there is none that is, and they
/// are taken as others are.
pub fn of_model<'a>(
    job: &impl Fn(&'a Scheme) -> Job<'a>,
    row: &Run,
    exact: &'a [(Scheme, u64)],
    tight: &'a [(Scheme, u64)],
) -> Result<Option<TimeSeries>, RunError> {
    if row.modes.is_some() {
        match converged(job, 1, exact) {
            Err(RunError::NoLinearPart(_)) => {}
            found => return found,
        }
    }
    if row.dofs > SMALL {
        return Ok(None);
    }
    converged(job, row.dofs, tight)
}

/// The model's own converged solution by the first of these methods that reaches the end with its work,
/// steps times `coordinates`; `None` when none does.
pub fn converged<'a>(
    job: &impl Fn(&'a Scheme) -> Job<'a>,
    coordinates: usize,
    tight: &'a [(Scheme, u64)],
) -> Result<Option<TimeSeries>, RunError> {
    for (method, work) in tight {
        let row = run(&Job {
            repeats: 0,
            max_steps: work / coordinates.max(1) as u64,
            events: true,
            histories: false,
            ..job(method)
        })?;
        if !row.status.is_failure() {
            return Ok(row.series);
        }
    }
    Ok(None)
}
