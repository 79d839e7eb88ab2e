//! An entry beside its baseline.

use super::file::{Rules, Work};
use gearbench_reports::check::{Checked, Finding, Kind, Measured, Verdict};
use gearbench_reports::numbers::{digits_apart, short};
use std::collections::BTreeSet;

/// Key of the runtime among the findings.
const RUNTIME: &str = "runtime";

/// Two numbers with as many digits as tell them apart.
fn apart(now: f64, before: f64) -> [String; 2] {
    let digits = digits_apart(&[now, before], 5);
    [now, before].map(|x| short(x, digits))
}

fn change(now: f64, before: f64) -> Option<f64> {
    Some(now / before - 1.0).filter(|c| c.is_finite())
}

fn moved(yes: bool) -> Verdict {
    if yes { Verdict::Moved } else { Verdict::Held }
}

/// Holds an entry against its baseline. `same` says that both were timed on one kind of processor.
pub(super) fn judge(
    now: Measured,
    before: Option<&Measured>,
    rules: &Rules,
    same: bool,
) -> Checked {
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
    Checked {
        measured: now,
        findings,
    }
}

/// An entry that the baseline has and the check has not.
pub(super) fn gone(before: &Measured) -> Checked {
    Checked {
        measured: before.clone(),
        findings: vec![Finding {
            kind: Kind::Entry,
            what: "entry".into(),
            now: "absent".into(),
            before: "stored".into(),
            allowed: "all entries of the baseline; --update forgets them".into(),
            verdict: Verdict::Moved,
            ..Finding::default()
        }],
    }
}

fn status(now: &Measured, before: &Measured) -> Finding {
    let told = |m: &Measured| match &m.message {
        Some(why) => format!("{}: {why}", m.status),
        None => m.status.to_string(),
    };
    Finding {
        kind: Kind::Status,
        what: "status".into(),
        now: told(now),
        before: told(before),
        allowed: "no change".into(),
        verdict: moved(now.status != before.status),
        ..Finding::default()
    }
}

fn metrics(now: &Measured, before: &Measured, rules: &Rules) -> Vec<Finding> {
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
                let [now_text, before_text] = apart(now, before);
                let allowed = (t.relative * before.abs()).max(t.absolute);
                Finding {
                    now: now_text,
                    before: before_text,
                    value: Some(now),
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
                let text = |x: Option<&f64>| x.map_or("absent".into(), |x| short(*x, 5));
                Finding {
                    now: text(now),
                    before: text(before),
                    value: now.copied(),
                    verdict: Verdict::Moved,
                    ..base
                }
            }
        }
    });
    found.collect()
}

/// Bounds whatever the baseline.
fn limits(now: &Measured, rules: &Rules) -> Vec<Finding> {
    let bound = |(key, x): (&String, &f64)| {
        let most = rules.tolerance(key).most?;
        Some(Finding {
            kind: Kind::Limit,
            what: key.clone(),
            now: short(*x, 5),
            value: Some(*x),
            allowed: format!("at most {}", short(most, 5)),
            verdict: moved(x.abs() > most),
            ..Finding::default()
        })
    };
    now.metrics.iter().filter_map(bound).collect()
}

fn work(now: &Measured, before: &Measured, rules: &Rules) -> Vec<Finding> {
    let found = now.work.iter().map(|(key, &n)| {
        let was = before.work.get(key).copied();
        let same = was == Some(n);
        let (allowed, different) = match rules.work {
            Work::Exact => ("no change", Verdict::Moved),
            Work::Report => ("", Verdict::Reported),
        };
        Finding {
            kind: Kind::Work,
            what: key.clone(),
            now: n.to_string(),
            before: was.map_or("absent".into(), |n| n.to_string()),
            value: Some(n as f64),
            change: was.and_then(|was| change(n as f64, was as f64)),
            allowed: allowed.into(),
            verdict: if same { Verdict::Held } else { different },
        }
    });
    found.collect()
}

fn runtime(now: &Measured, before: &Measured, rules: &Rules, same: bool) -> Option<Finding> {
    let (now, before) = (now.runtime?, before.runtime?);
    let ratio = now / before;
    let [now_text, before_text] = [now, before].map(|x| short(x, 4));
    let gate = rules.gate && same;
    Some(Finding {
        kind: Kind::Runtime,
        what: RUNTIME.into(),
        now: now_text,
        before: before_text,
        value: Some(now),
        change: change(now, before),
        allowed: match (gate, rules.gate) {
            (true, _) => format!("up to {} times", short(rules.factor, 4)),
            (_, true) => "any, the baseline is of another processor".into(),
            _ => "any, it does not gate".into(),
        },
        verdict: if ratio > rules.factor {
            if gate {
                Verdict::Moved
            } else {
                Verdict::Reported
            }
        } else if ratio < 1.0 / rules.factor {
            Verdict::Reported
        } else {
            Verdict::Held
        },
    })
}

/// Constants that differ: what was changed, where a change of the scene moves results.
fn parameters(now: &Measured, before: &Measured) -> Vec<Finding> {
    let flat = |m: &Measured| {
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
        let texts = match numbers {
            [Some(a), Some(b)] => apart(a, b),
            _ => [now.get(key), before.get(key)]
                .map(|v| v.map_or("absent".into(), ToString::to_string)),
        };
        let [now, before] = texts;
        Finding {
            kind: Kind::Parameter,
            what: key.clone(),
            now,
            before,
            value: numbers[0],
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
pub(super) fn slow_from(before: Option<&Measured>, rules: &Rules) -> Option<f64> {
    Some(rules.factor * before?.runtime?)
}

#[cfg(test)]
mod tests;
