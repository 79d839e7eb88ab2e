//! Labels that only a comparison gives: against the tolerance of the scene, and against the model's own converged solution.

use gearbench_reports::numbers::{digits_apart, short};
use gearbench_reports::record::{Run, SELF, Status, Tolerance};
use gearbench_reports::series::TimeSeries;

/// Labels a run that converged but lies beyond the tolerance of its scene, once its metrics are there. A metric that
/// cannot be told of the run, as the relative error of a force that should not be there, is beyond any tolerance.
pub fn against_tolerance(run: &mut Run, tolerance: &Tolerance) {
    if !run.status.holds() {
        return;
    }
    let Some(metrics) = run.against(&tolerance.against) else {
        return;
    };
    let Tolerance {
        metric,
        against,
        limit,
        ..
    } = tolerance;
    let digits = |x: f64| digits_apart(&[x, *limit], 3);
    let message = match metrics.get(*metric) {
        Some(x) if x.abs() <= *limit => {
            run.status = Status::Converged;
            return;
        }
        Some(x) => format!(
            "{metric} against {against} is {}, beyond the scene's {}; use a smaller step or tolerance, or a finer model",
            short(x, digits(x.abs())),
            short(*limit, digits(x.abs()))
        ),
        None => format!("{metric} against {against} cannot be told of this run"),
    };
    run.status = Status::Inaccurate;
    run.message = Some(message);
}

/// Error in the L1 norm against the model's own converged solution from which on a run is inaccurate where the scene does
/// not say [-].
pub const OWN_ERROR: f64 = 0.05;

/// Labels a run by its model's own converged solution, unless the tolerance of the scene has judged it.
pub fn against_itself(run: &mut Run, tolerance: Option<&Tolerance>) {
    let judged = tolerance.is_some_and(|t| run.against(&t.against).is_some());
    if judged || !run.status.holds() {
        return;
    }
    match run.against(SELF).and_then(|m| m.force_l1) {
        Some(e) if e > OWN_ERROR => {
            run.status = Status::Inaccurate;
            run.message = Some(format!(
                "the force is {} % off the model's own converged solution; use a smaller step or tolerance",
                short(100.0 * e, 3)
            ));
        }
        Some(_) => run.status = Status::Converged,
        None => {}
    }
}

/// Errors in the L1 norm from which on a reader wants to know whether it is another sequence of contacts [-].
const OTHER_CONTACTS: f64 = 0.01;

/// When the force of a history first acts [s].
fn first_touch(series: &TimeSeries) -> Option<f64> {
    match &series.force {
        Some(force) => force.begins(),
        None => {
            let first = series.contact_force_n.iter().position(|f| f.abs() > 0.0);
            first.map(|i| series.time_s[i])
        }
    }
}

/// Labels a run without any contact whose reference, of the same model, has one: its steps went over it. Where both
/// touch but not as often, later contacts are others than those of the reference, and a large error says so.
pub fn against_contact(run: &mut Run, reference: &TimeSeries) {
    if run.status.is_failure() {
        return;
    }
    let (Some(series), Some(at)) = (&run.series, first_touch(reference)) else {
        return;
    };
    if first_touch(series).is_none() && at <= run.simulated_s {
        run.status = Status::Tunnelling;
        run.message = Some(format!(
            "no contact at all, where the teeth touch at t = {at:.4e} s: the steps went over it; use smaller ones"
        ));
        return;
    }
    let (Some(own), Some(wanted)) = (&series.force, &reference.force) else {
        return;
    };
    let error = run.against(SELF).and_then(|m| m.force_l1);
    if own.spells() != wanted.spells() && error.is_some_and(|e| e > OTHER_CONTACTS) {
        run.message.get_or_insert(format!(
            "{} spells of contact, where the converged solution has {}: another sequence of impacts, so that errors are of the order of one from the first that differs on",
            own.spells(),
            wanted.spells()
        ));
    }
}
