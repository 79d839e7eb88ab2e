//! Tests of the verdicts of a check: deviations that it must detect, and differences that it must accept.

use super::super::file::tests_support::rules;
use super::*;

fn measured() -> MeasuredEntry {
    MeasuredEntry {
        case: "impact".into(),
        model: "rigid".into(),
        method: "newmark@5e-7s".into(),
        metrics: [("peak_force_n", 3600.0), ("energy_drift_rel", 1e-11)]
            .map(|(k, x)| (k.to_owned(), x))
            .into(),
        work: [("newton_iterations".to_owned(), 812)].into(),
        runtime: Some(0.5),
        parameters: [(
            "contact pinion - wheel".to_owned(),
            [("stiffness_n_per_m2".to_owned(), 1.5e10.into())].into(),
        )]
        .into(),
        ..MeasuredEntry::default()
    }
}

fn moved_of(now: MeasuredEntry, rules: &Rules, same: bool) -> Vec<String> {
    let checked = judge(now, Some(&measured()), rules, same);
    checked.moved().map(Finding::to_text).collect()
}

#[test]
fn the_same_holds() {
    assert_eq!(moved_of(measured(), &rules(""), true), Vec::<String>::new());
    // Rounding of another machine is no change, nor is a tenth more runtime.
    let mut now = measured();
    now.metrics.insert("energy_drift_rel".into(), 3e-11);
    now.metrics
        .insert("peak_force_n".into(), 3600.0 * (1.0 + 1e-9));
    now.runtime = Some(0.55);
    assert_eq!(moved_of(now, &rules(""), true), Vec::<String>::new());
}

#[test]
fn one_more_newton_iteration_is_named() {
    let mut now = measured();
    now.work.insert("newton_iterations".into(), 813);
    let found = moved_of(now.clone(), &rules(""), true);
    assert_eq!(found.len(), 1);
    assert!(
        found[0].starts_with("newton_iterations 813, baseline 812"),
        "{found:?}"
    );
    let reported = judge(now, Some(&measured()), &rules("work = \"report\""), true);
    assert_eq!(
        (reported.moved().count(), reported.reported().count()),
        (0, 1)
    );
}

#[test]
fn one_per_cent_of_stiffness_is_named_with_its_constant() {
    let mut now = measured();
    now.metrics.insert("peak_force_n".into(), 3618.0);
    let contact = now.parameters.values_mut().next().unwrap();
    contact.insert("stiffness_n_per_m2".into(), 1.515e10.into());
    let checked = judge(now, Some(&measured()), &rules(""), true);
    let moved: Vec<&str> = checked.moved().map(|f| f.what.as_str()).collect();
    assert_eq!(moved, ["peak_force_n"]);
    let reported: Vec<String> = checked.reported().map(Finding::to_text).collect();
    assert!(
        reported[0].starts_with("contact pinion - wheel: stiffness_n_per_m2"),
        "{reported:?}"
    );
}

#[test]
fn half_as_long_again_is_slow_where_processors_compare() {
    let mut now = measured();
    now.runtime = Some(0.75);
    let found = moved_of(now.clone(), &rules(""), true);
    assert!(
        found.len() == 1 && found[0].starts_with("runtime 0.75, baseline 0.5"),
        "{found:?}"
    );
    // On another processor, or without a gate, the difference is only reported.
    assert_eq!(
        moved_of(now.clone(), &rules(""), false),
        Vec::<String>::new()
    );
    let open = rules("runtime = { gate = false }");
    assert_eq!(moved_of(now.clone(), &open, true), Vec::<String>::new());
    let told = judge(now, Some(&measured()), &open, true);
    assert_eq!(told.reported().count(), 1);
    assert_eq!(slow_limit(Some(&measured()), &open), Some(1.35 * 0.5));
}

#[test]
fn failures_limits_and_what_is_missing() {
    let mut now = measured();
    now.status = gearbench_reports::Status::BlowUp;
    now.metrics.clear();
    let found = moved_of(now, &rules(""), true);
    assert_eq!(found.len(), 3, "{found:?}");
    let limited = rules("tolerances.peak_force_n.most = 3000.0");
    let found = moved_of(measured(), &limited, true);
    assert!(found[0].contains("at most 3000"), "{found:?}");
    let new = judge(measured(), None, &rules(""), true);
    assert_eq!(new.moved().count(), 1);
    assert_eq!(gone(&measured()).moved().count(), 1);
}

/// A program that is slower in all entries is detected by the median, even within the limit of each entry; a few
/// disturbed entries, or few entries, are not sufficient.
#[test]
fn a_program_that_is_slower_everywhere_is_named() {
    let rules = rules("");
    let entries = |ratio: fn(usize) -> f64, count: usize| -> Vec<MeasuredEntry> {
        let entry = |i| MeasuredEntry {
            method: format!("newmark@{i}s"),
            runtime: Some(0.5 * ratio(i)),
            ..measured()
        };
        (0..count).map(entry).collect()
    };
    let before = entries(|_| 1.0, 12);
    let told = |now: Vec<MeasuredEntry>, same| {
        let found = program(&now, &before, &rules.runtime, same)?;
        Some((found.moved().count(), found.reported().count()))
    };
    let slower = |i: usize| 1.26 + 0.007 * i as f64;
    assert_eq!(told(entries(slower, 12), true), Some((1, 0)));
    assert_eq!(told(entries(slower, 12), false), Some((0, 1)));
    let disturbed = |i: usize| if i < 5 { 3.0 } else { 1.0 };
    assert_eq!(told(entries(disturbed, 12), true), Some((0, 0)));
    assert_eq!(told(entries(slower, 7), true), None);
}
