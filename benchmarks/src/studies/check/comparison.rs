//! Comparison of each entry of a check with its baseline, and of the runtimes of all entries together.
//!
//! A program that became slower is slower in all of its entries at once: the median of the ratios to the baseline over all
//! entries tells a smaller slowdown than a single one can. What disturbs a machine may disturb all entries of that moment,
//! so that no median helps; it passes, and a ratio therefore is the least over several moments (`kernel`).

use super::file::{Rules, Runtime, WorkRule};
use super::kernel::median;
use super::quantity::Quantity;
use gearbench_reports::check::{CheckedEntry, CheckedValue, Finding, Kind, MeasuredEntry, Verdict};
use gearbench_reports::numbers::short;
use std::collections::BTreeSet;

/// Key of the runtime among the findings.
const RUNTIME: &str = "runtime";
/// Key of the median of all.
const ALL_RUNTIMES: &str = "median_runtime_ratio";
/// Entries from which on their median is judged.
const ENOUGH: usize = 8;
/// Part of the ratio that is slow from which on an entry is measured again.
pub(super) const LIKELY: f64 = 0.85;

fn change(now: f64, before: f64) -> Option<f64> {
    Some(now / before - 1.0).filter(|c| c.is_finite())
}

fn moved(yes: bool) -> Verdict {
    if yes { Verdict::Moved } else { Verdict::Held }
}

/// Compares an entry with its baseline. `same` is true if both were timed on the same kind of processor.
pub(super) fn judge(
    now: MeasuredEntry,
    before: Option<&MeasuredEntry>,
    rules: &Rules,
    same: bool,
) -> CheckedEntry {
    let mut findings = Vec::new();
    match before {
        None => findings.push(Finding {
            kind: Kind::Entry,
            what: "entry".into(),
            now: "new".into(),
            before: "absent".into(),
            allowed: "no new entries; --update stores them".into(),
            verdict: Verdict::Moved,
            ..Finding::default()
        }),
        Some(before) => {
            findings.push(status(&now, before));
            findings.extend(metrics(&now, before, rules));
            findings.extend(work(&now, before, rules));
            findings.extend(runtime(&now, before, rules, same));
            findings.extend(parameters(&now, before));
        }
    }
    findings.extend(limits(&now, rules));
    CheckedEntry {
        measured: now,
        findings,
    }
}

/// Returns the comparison for an entry that the baseline has and the check does not have.
pub(super) fn gone(before: &MeasuredEntry) -> CheckedEntry {
    CheckedEntry {
        measured: before.clone(),
        findings: vec![Finding {
            kind: Kind::Entry,
            what: "entry".into(),
            now: "absent".into(),
            before: "stored".into(),
            allowed: "all entries of the baseline; --update removes them".into(),
            verdict: Verdict::Moved,
            ..Finding::default()
        }],
    }
}

fn status(now: &MeasuredEntry, before: &MeasuredEntry) -> Finding {
    let told = |m: &MeasuredEntry| match &m.message {
        Some(why) => format!("{}: {why}", m.status),
        None => m.status.to_string(),
    };
    Finding {
        kind: Kind::Status,
        what: "status".into(),
        now: told(now).into(),
        before: told(before).into(),
        allowed: "no change".into(),
        // A check compares runs with their baseline alone: whether something else judged them is no change.
        verdict: moved(
            now.status != before.status && !(now.status.holds() && before.status.holds()),
        ),
        ..Finding::default()
    }
}

fn metrics(now: &MeasuredEntry, before: &MeasuredEntry, rules: &Rules) -> Vec<Finding> {
    let keys: BTreeSet<&String> = now.metrics.keys().chain(before.metrics.keys()).collect();
    let found = keys.into_iter().map(|key| {
        let t = rules.tolerance(key);
        let base = Finding {
            kind: Kind::Metric,
            what: key.clone(),
            allowed: format!("{:e} of it", t.relative),
            ..Finding::default()
        };
        match (now.metrics.get(key), before.metrics.get(key)) {
            (Some(&now), Some(&before)) => {
                let allowed = (t.relative * before.abs()).max(t.absolute);
                Finding {
                    now: now.into(),
                    before: before.into(),
                    change: change(now, before),
                    allowed: match allowed > t.relative * before.abs() {
                        true => format!("{:e}", t.absolute),
                        false => base.allowed.clone(),
                    },
                    verdict: moved((now - before).abs() > allowed),
                    ..base
                }
            }
            (now, before) => {
                let value = |x: Option<&f64>| x.map_or("absent".into(), |x| (*x).into());
                // Baselines of former versions have the speeds of two gears only.
                let of_more_gears =
                    before.is_none() && Quantity::of_key(key) == Some(Quantity::SpeedsEnd);
                Finding {
                    now: value(now),
                    before: value(before),
                    verdict: match of_more_gears {
                        true => Verdict::Reported,
                        false => Verdict::Moved,
                    },
                    ..base
                }
            }
        }
    });
    found.collect()
}

/// Returns the findings of limits that do not depend on the baseline.
fn limits(now: &MeasuredEntry, rules: &Rules) -> Vec<Finding> {
    let bound = |(key, x): (&String, &f64)| {
        let most = rules.tolerance(key).most?;
        Some(Finding {
            kind: Kind::Limit,
            what: key.clone(),
            now: (*x).into(),
            allowed: format!("at most {}", short(most, 5)),
            verdict: moved(x.abs() > most),
            ..Finding::default()
        })
    };
    now.metrics.iter().filter_map(bound).collect()
}

fn work(now: &MeasuredEntry, before: &MeasuredEntry, rules: &Rules) -> Vec<Finding> {
    let found = now.work.iter().map(|(key, &n)| {
        let was = before.work.get(key).copied();
        let same = was == Some(n);
        let (allowed, different) = match rules.work {
            WorkRule::Exact => ("no change", Verdict::Moved),
            WorkRule::Report => ("", Verdict::Reported),
        };
        Finding {
            kind: Kind::Work,
            what: key.clone(),
            now: (n as f64).into(),
            before: was.map_or("absent".into(), |n| (n as f64).into()),
            change: was.and_then(|was| change(n as f64, was as f64)),
            allowed: allowed.into(),
            verdict: if same { Verdict::Held } else { different },
        }
    });
    found.collect()
}

fn runtime(
    now: &MeasuredEntry,
    before: &MeasuredEntry,
    rules: &Rules,
    same: bool,
) -> Option<Finding> {
    let (now, before) = (now.runtime?, before.runtime?);
    let (allowed, verdict) = slower(now / before, rules.runtime.factor, &rules.runtime, same);
    Some(Finding {
        kind: Kind::Runtime,
        what: RUNTIME.into(),
        now: now.into(),
        before: before.into(),
        change: change(now, before),
        allowed,
        verdict,
    })
}

/// Returns the permitted range of a runtime ratio in words, and the verdict on the ratio.
fn slower(ratio: f64, most: f64, rules: &Runtime, same: bool) -> (String, Verdict) {
    let gate = rules.gate && same;
    let allowed = match (gate, rules.gate) {
        (true, _) => format!("up to {} times", short(most, 4)),
        (_, true) => "any, the baseline is of another processor".into(),
        _ => "any, it does not gate".into(),
    };
    let verdict = match ratio {
        r if r > most && gate => Verdict::Moved,
        r if r > most || r < 1.0 / most => Verdict::Reported,
        _ => Verdict::Held,
    };
    (allowed, verdict)
}

/// Returns the median of the runtime ratios of all entries; `None` if there are too few.
pub(super) fn middle(ratios: &[f64]) -> Option<f64> {
    median(ratios).filter(|_| ratios.len() >= ENOUGH)
}

/// The runtimes of all entries together: an entry of its own, where there are enough of them.
pub(super) fn program(
    now: &[MeasuredEntry],
    before: &[MeasuredEntry],
    rules: &Runtime,
    same: bool,
) -> Option<CheckedEntry> {
    let ratio = |now: &MeasuredEntry| {
        let before = before.iter().find(|b| b.is(now))?;
        Some(now.runtime? / before.runtime?)
    };
    let ratios: Vec<f64> = now.iter().filter_map(ratio).collect();
    let middle = middle(&ratios)?;
    let (allowed, verdict) = slower(middle, rules.all, rules, same);
    let finding = Finding {
        kind: Kind::Runtime,
        what: ALL_RUNTIMES.into(),
        now: middle.into(),
        before: 1.0.into(),
        change: change(middle, 1.0),
        allowed,
        verdict,
    };
    Some(CheckedEntry {
        measured: MeasuredEntry {
            case: "all cases".into(),
            model: "all models".into(),
            method: format!("{} runtimes", ratios.len()),
            ..MeasuredEntry::default()
        },
        findings: vec![finding],
    })
}

/// Constants that differ: what was changed, where a change of the scene moves results.
fn parameters(now: &MeasuredEntry, before: &MeasuredEntry) -> Vec<Finding> {
    let flat = |m: &MeasuredEntry| {
        let all = m.parameters.iter();
        all.flat_map(|(of, keys)| {
            keys.iter()
                .map(move |(k, v)| (format!("{of}: {k}"), v.clone()))
        })
        .collect::<std::collections::BTreeMap<String, serde_json::Value>>()
    };
    let (now, before) = (flat(now), flat(before));
    let keys: BTreeSet<&String> = now.keys().chain(before.keys()).collect();
    let different = keys.into_iter().filter(|k| now.get(*k) != before.get(*k));
    let found = different.map(|key| {
        let numbers = [now.get(key), before.get(key)].map(|v| v.and_then(|v| v.as_f64()));
        let [now, before] = [now.get(key), before.get(key)].map(|v| match v {
            None => CheckedValue::from("absent"),
            Some(v) => v.as_f64().map_or_else(|| v.to_string().into(), Into::into),
        });
        Finding {
            kind: Kind::Parameter,
            what: key.clone(),
            now,
            before,
            change: match numbers {
                [Some(a), Some(b)] => change(a, b),
                _ => None,
            },
            allowed: "any".into(),
            verdict: Verdict::Reported,
        }
    });
    found.collect()
}

/// Runtime from which on an entry is slow, if it can be.
pub(super) fn slow_limit(before: Option<&MeasuredEntry>, rules: &Rules) -> Option<f64> {
    Some(rules.runtime.factor * before?.runtime?)
}

#[cfg(test)]
mod tests;
