//! Results that the pages of studies state for records with a known answer.

use crate::{contents, finding, has_only_numbers, holds, made_up, written};
use gearbench_reports::store::PAGE;
use gearbench_reports::{load_results, write_results};

#[test]
fn long_histories_stay_small_and_keep_their_peaks() {
    let files = written(&made_up::rotation_results());
    assert!(
        files["force.svg"].len() < 400_000,
        "{}",
        files["force.svg"].len()
    );
    // The highest peak defines the axis of the zoom panel; its window is named in the caption.
    assert!(files[PAGE].contains("around the highest peak"));
}

#[test]
fn a_sweep_names_its_resonances_and_shows_what_failed() {
    let dir = tempfile::tempdir().unwrap();
    let mut results = made_up::sweep_results();
    // A number that is none takes its run from the charts, not the report with it.
    if let Some(s) = &mut results.runs[3].steady {
        s.error_harmonics_m[2] = f64::NAN;
    }
    write_results(dir.path(), &results).unwrap();
    let files = contents(dir.path());
    holds(
        &files,
        &[
            "sweep.svg",
            "sweep_spectra.svg",
            "sweep_harmonics.svg",
            "sweep_cycles.svg",
            "sweep.csv",
            "sweep_cycles.csv",
            "statics.csv",
        ],
    );
    let finding = finding(&files[PAGE]);
    // The speeds next to 6 and 5.5 kHz.
    assert!(finding.contains("5.90\u{a0}kHz"), "{finding}");
    assert!(finding.contains("5.60\u{a0}kHz"), "{finding}");
    assert!(finding.contains("lift off"), "{finding}");
    assert!(finding.contains("1 of 60 runs failed"), "{finding}");
    assert!(files["sweep.svg"].contains("failed") && files["sweep.svg"].contains("fn/2"));
    assert_eq!(files["sweep.csv"].lines().count(), 1 + 59);
    let saved = load_results(dir.path()).unwrap();
    assert!(saved.runs[3].steady.is_none());
    let [now, then] = [&saved, &results].map(|r| r.runs[4].steady.clone().unwrap());
    assert_eq!(now.error_harmonics_m.len(), then.error_harmonics_m.len());
    assert!((now.error_rms_m / then.error_rms_m - 1.0).abs() < 1e-12);
}

#[test]
fn a_table_has_page_charts_and_file() {
    let files = written(&made_up::penalty_results());
    holds(
        &files,
        &["penalty.svg", "penalty_distance.svg", "penalty.csv"],
    );
    let finding = finding(&files[PAGE]);
    assert!(finding.contains("1e16 Pa/m"), "{finding}");
    assert!(files[PAGE].contains("Off: deviation from hard contact."));
    assert!(
        files[PAGE].contains("<title>impact: penalty")
            || files[PAGE].contains(": penalty - gearbench")
    );
    assert!(
        files["penalty.svg"].contains("failed") && files["penalty.svg"].contains("hard contact")
    );
    assert_eq!(files["penalty.csv"].lines().count(), 1 + 10);
}

#[test]
fn an_identification_says_what_the_data_do_not_tell() {
    let files = written(&made_up::identify_results());
    holds(
        &files,
        &[
            "identify.svg",
            "identify_profiles.svg",
            "identify.csv",
            "identify_data.csv",
            "identify_residuals.csv",
            "identify_profiles.csv",
        ],
    );
    has_only_numbers(&files);
    let finding = finding(&files[PAGE]);
    assert!(
        finding.contains("tooth mass is not determined"),
        "{finding}"
    );
    assert!(finding.contains("of what was not fitted"), "{finding}");
    assert!(files[PAGE].contains("not identifiable") && files[PAGE].contains("at bound"));
    assert!(files[PAGE].contains("parameters 1 and 3"));
    assert!(files["identify.svg"].contains("not fitted"));
    // An open end is empty.
    let parameters = &files["identify.csv"];
    assert!(
        parameters
            .lines()
            .nth(1)
            .unwrap()
            .contains(",2.430000000e10,,7.5"),
        "{parameters}"
    );
    assert_eq!(files["identify_residuals.csv"].lines().count(), 1 + 3 * 60);
}
