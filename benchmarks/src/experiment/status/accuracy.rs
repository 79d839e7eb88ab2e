//! Statuses that follow from a comparison: with the tolerance of the scene, or with the model's own converged solution.

use gearbench_reports::Adequacy;
use gearbench_reports::comparison::Yardstick;
use gearbench_reports::force::ForceHistory;
use gearbench_reports::numbers::{digits_apart, short};
use gearbench_reports::record::{Run, SELF, Status, Tolerance};
use gearbench_reports::series::{CONTACT_FORCE, TimeSeries};

/// Default limit of the L1 error against the model's own converged solution, above which a run is inaccurate [-].
pub const OWN_ERROR: f64 = 0.05;

/// Sets the status of a completed run from its metrics: by the tolerance of the scene and the error of the yardstick,
/// or, without a tolerance, by the model's own converged solution; `missing` is the reason why there is no such
/// solution for this run. A run that neither can judge is `unchecked` and has not passed.
pub fn judge(
    run: &mut Run,
    (tolerance, yardstick): (Option<&Tolerance>, Option<&Yardstick>),
    missing: Option<&str>,
) {
    if !run.status.holds() {
        return;
    }
    let verdict = match tolerance {
        Some(tolerance) => by_tolerance(run, (tolerance, yardstick), missing),
        None => by_own_solution(run, missing),
    };
    match verdict {
        Verdict::Within => run.status = Status::Converged,
        Verdict::Beyond(message) => {
            run.status = Status::Inaccurate;
            run.message = Some(message);
        }
        Verdict::NotDecided(why) => {
            run.status = Status::Unchecked;
            run.message.get_or_insert(format!("not decided: {why}"));
        }
        Verdict::NotJudged(why) => {
            run.status = Status::Unchecked;
            run.message.get_or_insert(format!("not judged: {why}"));
        }
    }
}

/// Result of the comparison with the tolerance of the scene.
enum Verdict {
    Within,
    Beyond(String),
    NotDecided(String),
    NotJudged(String),
}

/// The advice that reduces the error of a run against a reference; for a model's own converged solution it is an
/// integration error.
fn remedy(run: &Run, against: &str, limit: f64) -> &'static str {
    const FINER: &str = "use a smaller step or tolerance";
    if against == SELF {
        return FINER;
    }
    // The error of integration is known where the model's own converged solution is.
    match run.against(SELF).and_then(|m| m.force_l1) {
        Some(own) if own <= 0.25 * limit => {
            "the integration is accurate enough; use a finer model, or another one"
        }
        Some(own) if own >= limit => {
            "the integration error alone exceeds the limit; use a smaller step or tolerance first"
        }
        _ => "use a smaller step or tolerance, or a finer model",
    }
}

fn by_tolerance(
    run: &Run,
    (tolerance, yardstick): (&Tolerance, Option<&Yardstick>),
    missing: Option<&str>,
) -> Verdict {
    let Tolerance {
        metric,
        against,
        limit,
        ..
    } = tolerance;
    if run.against(against).is_none() {
        let why = missing.filter(|_| against == SELF);
        let none = || format!("the run was not compared with {against}");
        return Verdict::NotJudged(why.map_or_else(none, str::to_owned));
    }
    let digits = |x: f64| digits_apart(&[x, *limit], 3);
    match tolerance.verdict(run, yardstick) {
        Some((_, Adequacy::Adequate)) => Verdict::Within,
        Some((x, Adequacy::NotDecided)) if run.agrees_by_chance(*metric, *limit) => {
            let own = run.integration_error(*metric).unwrap_or(f64::NAN);
            Verdict::NotDecided(format!(
                "{metric} is {}, but its error of integration is {}, above the limit of {}: steps like those of {against}, or errors \
                 that cancel; use a smaller step or tolerance",
                short(x, digits(x.abs())),
                short(own, 2),
                short(*limit, digits(x.abs())),
            ))
        }
        Some((x, Adequacy::NotDecided)) => Verdict::NotDecided(format!(
            "{metric} is {} with a limit of {}, and {against} itself {}",
            short(x, digits(x.abs())),
            short(*limit, digits(x.abs())),
            match yardstick.and_then(|y| y.error) {
                Some(own) => format!("has an error of about {}", short(own, 2)),
                None => "has an unknown error".into(),
            }
        )),
        Some((x, Adequacy::NotAdequate)) => Verdict::Beyond(format!(
            "{metric} against {against} is {}, above the limit of the scene, {}; {}",
            short(x, digits(x.abs())),
            short(*limit, digits(x.abs())),
            remedy(run, against, *limit)
        )),
        None => Verdict::NotJudged(format!(
            "{metric} against {against} is not defined for this run"
        )),
    }
}

fn by_own_solution(run: &Run, missing: Option<&str>) -> Verdict {
    match (run.against(SELF), missing) {
        (None, why) => Verdict::NotJudged(
            why.unwrap_or("the run was not compared with the model's own converged solution")
                .to_owned(),
        ),
        (Some(metrics), _) => match metrics.force_l1 {
            Some(e) if e > OWN_ERROR => Verdict::Beyond(format!(
                "the error of the force against the model's own converged solution is {} %; use a smaller step or tolerance",
                short(100.0 * e, 3)
            )),
            Some(_) => Verdict::Within,
            None => Verdict::NotJudged("there is no force to compare".into()),
        },
    }
}

/// L1 error above which a different sequence of contacts is reported [-].
const OTHER_CONTACTS: f64 = 0.01;

/// Time of the first contact in a force history [s].
fn first_touch(series: &TimeSeries) -> Option<f64> {
    if !series.forces.is_empty() {
        let begins = series.forces.iter().filter_map(ForceHistory::begins);
        return begins.reduce(f64::min);
    }
    let touches = |(_, force): (_, &[f64])| force.iter().position(|f| f.abs() > 0.0);
    let first = series.all_of(CONTACT_FORCE).filter_map(touches).min();
    first.map(|i| series.time_s[i])
}

/// Sets the status of a run without contact whose reference, of the same model, has one: its steps passed over it. If
/// both have contacts of different number, a large error is explained by the other sequence of contacts.
pub fn against_contact(run: &mut Run, reference: &TimeSeries) {
    if run.status.is_failure() {
        return;
    }
    let Some(series) = &run.series else {
        return;
    };
    let Some(at) = first_touch(reference) else {
        match first_touch(series) {
            None => {
                let note = "no contact: the force is zero throughout, as in the converged solution";
                run.message.get_or_insert(note.into());
            }
            Some(t) => {
                run.status = Status::Inaccurate;
                run.message = Some(format!(
                    "the teeth touch at t = {t:.4e} s, but not in the converged solution; use a smaller step or tolerance"
                ));
            }
        }
        return;
    };
    if first_touch(series).is_none() && at <= run.simulated_s {
        run.status = Status::Tunnelling;
        run.message = Some(format!(
            "no contact, but the teeth touch at t = {at:.4e} s in the converged solution: the steps are too large; use smaller ones"
        ));
        return;
    }
    let error = run.against(SELF).and_then(|m| m.force_l1);
    let differ = |(own, wanted): &(&ForceHistory, &ForceHistory)| own.spells() != wanted.spells();
    let mut meshes = series.forces.iter().zip(&reference.forces);
    if let Some((own, wanted)) = meshes.find(differ)
        && error.is_some_and(|e| e > OTHER_CONTACTS)
    {
        run.message.get_or_insert(format!(
            "{} periods of contact, but {} in the converged solution: the sequence of impacts differs, so that errors are of the order of one after the first difference",
            own.spells(),
            wanted.spells()
        ));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gearbench_reports::Metric;
    use gearbench_reports::record::Metrics;

    /// A run within the tolerance whose error of integration is beyond it is not decided: the agreement is chance.
    #[test]
    fn agreement_by_chance_is_not_decided() {
        let tolerance = Tolerance {
            metric: Metric::ForceL2,
            against: "calculix".into(),
            limit: 0.01,
            except: Vec::new(),
        };
        let judged = |error: f64, integration: Option<f64>| {
            let metrics = |against: &str, error: f64| Metrics {
                against: against.into(),
                force_l2: Some(error),
                ..Metrics::default()
            };
            let mut run = Run {
                status: Status::Unchecked,
                metrics: vec![metrics("calculix", error)],
                ..Run::default()
            };
            run.metrics.extend(integration.map(|e| metrics(SELF, e)));
            judge(&mut run, (Some(&tolerance), None), None);
            (run.status, run.message.unwrap_or_default())
        };
        assert_eq!(judged(0.004, Some(0.002)).0, Status::Converged);
        // Where the error of integration is not known, the one that is known decides.
        assert_eq!(judged(0.004, None).0, Status::Converged);
        assert_eq!(judged(0.03, Some(0.03)).0, Status::Inaccurate);
        let (status, message) = judged(0.004, Some(0.03));
        assert_eq!(status, Status::Unchecked);
        assert!(
            message.starts_with("not decided: ")
                && message.contains("error of integration is 0.03"),
            "{message}"
        );
    }
}
