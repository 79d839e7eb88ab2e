//! Every form of the report names the quantities beyond their tolerance.

use super::*;

fn record() -> CheckRecord {
    let held = Finding {
        kind: Kind::Metric,
        what: "impulse_ns".into(),
        now: 0.2.into(),
        before: 0.2.into(),
        allowed: "1e-6 of it".into(),
        ..Finding::default()
    };
    let moved = Finding {
        kind: Kind::Work,
        what: "newton_iterations".into(),
        now: 813.0.into(),
        before: 812.0.into(),
        change: Some(1.0 / 812.0),
        allowed: "no change".into(),
        verdict: Verdict::Moved,
    };
    let measured = MeasuredEntry {
        case: "impact <1> & \"more\"".into(),
        scene: "spur_impact".into(),
        model: "rigid".into(),
        method: "newmark@5e-7".into(),
        ..MeasuredEntry::default()
    };
    CheckRecord {
        file: "check.toml".into(),
        stored: Some(Stored {
            baseline: 2,
            created: "2026-11-22T10:09:15Z".into(),
            ..Stored::default()
        }),
        entries: vec![CheckedEntry {
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

/// Values are numbers with all their digits in the record and in the table, and short for people.
#[test]
fn numbers_are_numbers() {
    let mut record = record();
    let finding = &mut record.entries[0].findings[0];
    finding.now = (-1.359_912_345_678_9e-8).into();
    finding.before = (-1.359_912_345_678_8e-8).into();
    let saved = serde_json::to_value(&record).unwrap();
    let saved = &saved["entries"][0]["findings"][0];
    assert_eq!(saved["now"].as_f64(), Some(-1.359_912_345_678_9e-8));
    assert_eq!(saved["before"].as_f64(), Some(-1.359_912_345_678_8e-8));
    let table = files::tables(&record)[0].text();
    assert!(
        table.contains(",-1.3599123456789e-8,-1.3599123456788e-8,"),
        "{table}"
    );
    assert!(!table.contains('\u{2212}'), "{table}");
    let old: CheckedValue = serde_json::from_str("\"0.2\"").unwrap();
    assert_eq!(old, "0.2".into());
    // The text has as many digits as distinguish both values, with one minus sign.
    let [now, before] = record.entries[0].findings[0].texts();
    assert!(now != before && now.starts_with("\u{2212}1.3599"), "{now}");
    assert_eq!(record.entries[0].findings[1].texts(), ["813", "812"]);
}

/// Names cannot break the summary, add links to it or be formulas of a spreadsheet.
#[test]
fn names_are_text_in_the_summary_and_in_tables() {
    let mut record = record();
    record.entries[0].measured.case = "<img src=x onerror=y>\n| [a](https://b)".into();
    record.entries[0].measured.model = "=cmd|' /C calc'!A0".into();
    let text = markdown(&record);
    let row = text.lines().find(|l| l.contains("newton_iterations"));
    let row = row.unwrap();
    assert!(
        row.contains("&lt;img") && row.contains("https&#58;"),
        "{row}"
    );
    assert_eq!(row.replace("\\|", "").matches('|').count(), 7, "{row}");
    let table = files::tables(&record)[0].text();
    assert!(table.contains(",'=cmd|' /C calc'!A0,"), "{table}");
}

/// Names of the user cannot break the XML.
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

/// Markup in any name is text in the summary, in JUnit's XML, on the page and in the chart.
#[test]
fn markup_in_names_is_text() {
    let evil = "<script>x</script>\"&'</testcase>]]>";
    let mut record = record();
    let measured = &mut record.entries[0].measured;
    for name in [
        &mut measured.case,
        &mut measured.scene,
        &mut measured.model,
        &mut measured.method,
    ] {
        *name = evil.into();
    }
    record.entries[0].findings[1].what = evil.into();
    record.history[0].entry = evil.into();
    record.file = evil.into();
    let page = report(&record).unwrap();
    let texts = [
        markdown(&record),
        junit(&record),
        page.tables.0.clone() + &page.details.0,
        page.charts[0].svg.clone(),
    ];
    for text in texts {
        assert!(text.contains("&lt;script"), "{text}");
        assert!(!text.contains("<script") && !text.contains("]]>"), "{text}");
    }
    let text = junit(&record);
    assert_eq!(
        text.matches("<testcase").count(),
        text.matches("</testcase>").count()
    );
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
