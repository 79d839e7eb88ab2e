use super::*;
use crate::sampling;
use gearbench::studies::choose::plan::MODES;

/// Choices on some scenes of the tuning set are validated to the end, with consistent results for any choice.
#[test]
fn choices_are_judged() {
    let set = sampling::set("refined-tuning").unwrap();
    // Single impacts: without a cache on disk most of the time goes into the modes of four gears.
    for number in [5, 33] {
        let sample = sampling::sample(&set, number).unwrap();
        let row = validate(&sample).unwrap();
        let place = format!("{row:?}");
        assert_ne!(row.outcome, Outcome::NotValidated, "{place}");
        assert!(row.outcome.is_met(), "{}: {}", row.scene, row.why_missed());
        assert_eq!(row.tried.len(), row.candidates, "{place}");
        assert!(row.candidates > 10 * MODES.len() && row.cut_short < row.candidates);
        assert!(
            row.reference_error.is_some_and(|e| e < row.tolerance),
            "{place}"
        );
        let cheapest = row.cheapest_cost_s.unwrap();
        // Nothing that keeps the tolerance was cheaper than the cheapest by more than the clock's noise.
        for t in row.tried.iter().filter(|t| t.status == ADEQUATE) {
            assert!(t.error.unwrap() <= row.tolerance);
            assert!(t.cost_s.unwrap() > 0.1 * cheapest, "{t:?}, {place}");
        }
        if let Some(ratio) = row.cost_ratio() {
            assert!((0.99..1000.0).contains(&ratio), "{ratio}");
        }
    }
}

/// The more expensive variant has finer steps or more modes, never another integrator or another kind of gears.
#[test]
fn kin_is_ordered() {
    let set = sampling::set("tuning").unwrap();
    let problem = Problem::of(&sampling::sample(&set, 33).unwrap().scene);
    let all = CandidateData::of(&problem).unwrap().candidates(&problem);
    let of = |level: &str, text: &str| -> Vec<&Candidate> {
        (all.iter())
            .filter(|c| c.level.name() == level && c.method.method == text.parse().unwrap())
            .filter(|c| matches!(c.method.resolution, Resolution::Step(_)))
            .collect()
    };
    let few = of("elastic, 10 modes", "trigonometric");
    let many = of("elastic, 100 modes", "trigonometric");
    let rigid = of("rigid, ISO 6336", "trigonometric");
    assert!(is_dearer_kin(few[1], few[0]) && !is_dearer_kin(few[0], few[1]));
    assert!(is_dearer_kin(many[0], few[0]) && !is_dearer_kin(few[0], many[0]));
    assert!(!is_dearer_kin(many[0], few[1]));
    assert!(!is_dearer_kin(many[1], rigid[0]) && !is_dearer_kin(rigid[1], many[0]));
    assert!(effort(rigid[0]) < effort(few[0]) && effort(few[0]) < effort(many[0]));
}
