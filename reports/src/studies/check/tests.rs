//! What moved is named in every form of the report.

use super::*;

fn record() -> CheckRecord {
    let held = Finding {
        kind: Kind::Metric,
        what: "impulse_ns".into(),
        now: "0.2".into(),
        before: "0.2".into(),
        allowed: "1e-6 of it".into(),
        ..Finding::default()
    };
    let moved = Finding {
        kind: Kind::Work,
        what: "newton_iterations".into(),
        now: "813".into(),
        before: "812".into(),
        value: Some(813.0),
        change: Some(1.0 / 812.0),
        allowed: "no change".into(),
        verdict: Verdict::Moved,
    };
    let measured = Measured {
        case: "impact <1> & \"more\"".into(),
        scene: "spur_impact".into(),
        model: "rigid".into(),
        method: "newmark@5e-7".into(),
        ..Measured::default()
    };
    CheckRecord {
        file: "check.toml".into(),
        stored: Some(Stored {
            baseline: 2,
            created: "2026-11-22T10:09:15Z".into(),
            ..Stored::default()
        }),
        entries: vec![Checked {
            measured,
            findings: vec![held, moved],
        }],
        quantity: "runtime".into(),
        history: vec![Trend {
            entry: "impact / rigid / newmark@5e-7".into(),
            points: vec![(1, 1.0), (2, 1.5), (3, 1.4)],
        }],
    }
}

#[test]
fn what_moved_is_named_everywhere() {
    let record = record();
    assert!(!record.holds());
    assert!(
        record.verdict().contains("1 of 1 entry moved"),
        "{}",
        record.verdict()
    );
    for text in [markdown(&record), junit(&record)] {
        assert!(
            text.contains("newton_iterations") && text.contains("813"),
            "{text}"
        );
    }
    let page = report(&record).unwrap();
    assert!(page.tables.0.contains("newton_iterations"));
    assert_eq!(page.charts.len(), 1);
    assert_eq!(page.csv[0].rows.len(), 2);
}

/// Names of the user's cannot break the XML.
#[test]
fn junit_is_xml() {
    let text = junit(&record());
    assert!(text.starts_with("<?xml"), "{text}");
    assert!(
        text.contains("name=\"impact &lt;1&gt; &amp; &quot;more&quot;\""),
        "{text}"
    );
    assert!(text.contains("tests=\"2\" failures=\"1\""), "{text}");
    assert_eq!(
        text.matches("<testcase").count(),
        text.matches("</testcase>").count()
    );
    assert_eq!(text.matches("<failure").count(), 1);
}

#[test]
fn nothing_moved_holds() {
    let mut record = record();
    record.entries[0].findings.pop();
    assert!(record.holds());
    assert!(
        markdown(&record).contains("1 entry hold 1 quantity"),
        "{}",
        markdown(&record)
    );
}
