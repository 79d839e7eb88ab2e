//! A model's own converged solution: Dormand-Prince with located events at a tolerance of 1e-10 (1e-8 where that takes
//! too long); of gears with modes the trigonometric method.

use super::run::{Job, RunError, run};
use gearbench_integrators::Scheme;
use gearbench_integrators::table::{DOPRI5, TRIGONOMETRIC};
use gearbench_reports::series::TimeSeries;
use std::time::Duration;

/// Tolerances tried for the converged solution and the time each may take; long stiff scenes get the second.
pub const SELF: [(f64, Duration); 2] = [
    (1e-10, Duration::from_secs(3)),
    (1e-8, Duration::from_secs(15)),
];
/// Tolerance of the converged solution of gears with modes, by the method that is exact for these.
pub const EXACT_MODES: f64 = 1e-4;
/// How converged solutions of gears without modes are computed, the best first, with the time each may take.
pub fn tight() -> [(Scheme, Duration); 2] {
    SELF.map(|(rtol, timeout)| {
        let method = DOPRI5.at_tolerance(rtol);
        (method, timeout)
    })
}

/// The method that is exact for modes, under a tolerance.
pub fn exact_for_modes(rtol: f64) -> Scheme {
    TRIGONOMETRIC.at_tolerance(rtol)
}

/// Coordinates up to which a converged solution is computed: beyond, it costs more than all the runs.
pub const SMALL: usize = 2000;

/// The model's own converged solution by the first of these methods that reaches the end in its time; `None` when it
/// is not to be had in reasonable time.
pub fn converged<'a>(
    job: &impl Fn(&'a Scheme) -> Job<'a>,
    tight: &'a [(Scheme, Duration)],
) -> Result<Option<TimeSeries>, RunError> {
    for (method, timeout) in tight {
        let row = run(&Job {
            repeats: 0,
            timeout: *timeout,
            events: true,
            ..job(method)
        })?;
        if !row.status.is_failure() {
            return Ok(row.series);
        }
    }
    Ok(None)
}
