use super::*;
use crate::gear_mesh;
use crate::reduction::choose::{Criterion, choose};
use crate::reduction::{ModeSelection, Mounting, basis};
use crate::test_support::{coarse, gear};
use gearbench_models::stiffness::Material;

const LEVER: f64 = 0.0188;

fn pinion() -> Basis {
    let gear = gear(20, 2e-3, |p| {
        p.face_width = 5e-3;
        p.bore_radius = 8e-3;
    });
    let sector = gear_mesh::sector(&gear, &coarse(2, 1)).unwrap();
    let mounting = Mounting::gear(true, 0.0);
    basis::of_sector(
        &sector,
        &Material::STEEL,
        &mounting,
        ModeSelection::Count(300),
        false,
    )
    .unwrap()
}

fn choice(count: usize, by: Criterion) -> Choice {
    Choice {
        by,
        count,
        candidates: usize::MAX,
        highest: f64::INFINITY,
        time: f64::INFINITY,
        even_over_width: true,
    }
}

/// Without modes it is a mass on a spring: half a sine.
#[test]
fn without_modes_the_impact_is_half_a_sine() {
    let basis = pinion();
    let impacts = Impacts::new(&basis, LEVER, true);
    for probe in &impacts.probes {
        let compliance = (1.0 + LAW) * probe.compliance;
        let force = impacts.force(probe, &[]);
        let peak = (impacts.mass / compliance).sqrt();
        let end = HALF_PERIODS * std::f64::consts::PI;
        for (i, f) in force.iter().enumerate() {
            let angle = end * (i + 1) as f64 / SAMPLES as f64;
            let exact = if angle < std::f64::consts::PI {
                peak * angle.sin()
            } else {
                0.0
            };
            assert!((f - exact).abs() < 0.01 * peak, "{i}: {f} {exact}");
        }
    }
}

#[test]
fn more_modes_are_nearer_and_all_modes_are_the_reference() {
    let basis = pinion();
    let impacts = Impacts::new(&basis, LEVER, true);
    let error = |count: usize, by: Criterion| impacts.error(&choose(&basis, &choice(count, by)));
    let by = Criterion::FlankCompliance;
    assert_eq!(error(usize::MAX, by), 0.0);
    // A few modes without their likes may be worse than none.
    let errors = [0, 80, 110, 140].map(|count| error(count, by));
    for pair in errors.windows(2) {
        assert!(pair[1] < pair[0], "{errors:?}");
    }
    assert!(errors[0] > 0.02 && errors[3] < 0.01, "{errors:?}");
    // Of equally many, those that yield most at the flanks are nearer than the lowest.
    assert!(error(80, by) < error(80, Criterion::Frequency));
}

#[test]
fn the_fewest_modes_meet_the_target_and_one_family_less_does_not() {
    let basis = pinion();
    let impacts = Impacts::new(&basis, LEVER, true);
    let all = choice(usize::MAX, Criterion::FlankCompliance);
    let mut before = 0;
    for target in [0.02, 0.01, 0.005] {
        let kept = impacts.fewest(&all, target).unwrap();
        assert!(impacts.error(&kept) <= target && kept.len() >= before);
        before = kept.len();
        let fewer = choose(
            &basis,
            &Choice {
                count: kept.len() - 1,
                ..all
            },
        );
        let families = ranked(&basis, &all);
        let mut count = 0;
        let place = families.iter().position(|f| {
            count += f.modes.len();
            count == kept.len()
        });
        // The last family taken is the one that made it.
        let last = &families[place.unwrap()].modes;
        let without: Vec<usize> = kept.iter().copied().filter(|i| !last.contains(i)).collect();
        assert!(impacts.error(&without) > target);
        assert!(fewer.len() < kept.len());
    }
    let message = impacts
        .fewest(&Choice { count: 10, ..all }, 1e-4)
        .unwrap_err()
        .to_string();
    assert!(message.contains("allow more modes"), "{message}");
}
