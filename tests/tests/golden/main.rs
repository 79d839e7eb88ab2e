//! Golden results: every study on small scenes, with all models, compared with stored values.

use gearbench_tests::fingerprint::{List, Renames, fingerprint, off_golden};

#[test]
fn every_study_computes_what_is_stored() {
    let folder = tempfile::tempdir().unwrap();
    let renames = Renames::of_text(include_str!("../../golden/renames.txt"));
    let stored = renames.apply(&List::of_text(include_str!("../../golden/fingerprint.txt")));
    assert!(
        stored.0.len() > 1000,
        "{} values are stored",
        stored.0.len()
    );
    let off = off_golden(&stored, &fingerprint(None, folder.path()));
    let lines: Vec<String> = off
        .iter()
        .take(40)
        .map(|(k, d)| format!("{k}: {d:?}"))
        .collect();
    assert!(
        off.is_empty(),
        "{} values are not as stored; a change that is meant is stored by the command in tests/golden/fingerprint.txt\n{}",
        off.len(),
        lines.join("\n")
    );
}
