//! Static calibration, candidates and domain on a coarse pair that reduces in a fraction of a second.

use super::detail::Detail;
use super::domain;
use super::level::{Level, Stiffness};
use super::plan::{Candidate, Prepared, elastic};
use super::problem::Problem;
use super::statics::calibrate;
use crate::studies::test_scene::coarse;
use gearbench_integrators::Resolution;
use gearbench_models::spec::SurfaceKind;
use gearbench_reference::statics::{LoadedPair, StaticsError};
use std::collections::BTreeSet;

fn problem() -> Problem {
    Problem::of(&coarse("modes = 30, damping_ratio = 0.01"))
}

/// Rigid gears with the stiffness of static solves carry what the elastic ones without modes carry, at positions and
/// approaches that were not solved for.
#[test]
fn static_solves_make_rigid_gears_as_stiff_as_elastic_ones() {
    let s = problem();
    let p = Prepared::of(&s).expect("a scene that runs");
    let found = p.statics.clone().expect("a stiffness");
    assert!((1.0..1.5).contains(&found.exponent), "{}", found.exponent);
    let rigid = p.best_rigid();
    assert_eq!(rigid.level, Level::Rigid(Stiffness::Static));
    let pair = |m| LoadedPair::new(&s.scene, m, s.models).expect("a pair");
    let (mut one, mut two) = (
        pair(&rigid.modelling),
        pair(&elastic(p.details.judge(), 0, None)),
    );
    let l = two.layout();
    let (pitch, base) = (l.pitch_point, l.base_pitch);
    let mut ratio = |part: f64| {
        let (at, approach) = (pitch + part * base, 0.7 * found.approach);
        let [a, b] = [&mut one, &mut two].map(|p| p.at_approach(at, approach).expect("rest").force);
        a / b
    };
    // Flanks of four elements are softer between rows of nodes than on them, by a tenth; where two pairs carry they
    // bend the same bodies, which pairs on their own do not know.
    let found = [-0.11, 0.013, 0.22, -0.31].map(&mut ratio);
    let [single @ .., two_pairs] = found;
    assert!(single.iter().all(|r| (r - 1.0).abs() < 0.12), "{found:?}");
    assert!((1.05..1.3).contains(&two_pairs), "{found:?}");
}

/// Facets of coarse flanks lie below the involute: at a small approach none of them touches, and there is no stiffness.
#[test]
fn gears_that_do_not_touch_have_no_static_stiffness() {
    let mut s = problem();
    for c in &mut s.flexible.contacts {
        c.points.as_mut().expect("points").surface = SurfaceKind::Faceted;
    }
    let found = calibrate(&s, &s.flexible, 1e-9);
    assert!(
        matches!(found, Err(StaticsError::NoContact { .. })),
        "{found:?}"
    );
}

/// The damper of rigid gears: of a lag that sits in the patch of contact alone a stiff pair sees a part, and modal
/// damping fills the rest.
#[test]
fn dampers_of_rigid_gears_follow_the_flanks() {
    let mut s = problem();
    let lag = 2e9 / 2e15;
    let (k, force) = (8e7, 300.0);
    let both = s.relaxation(&s.flexible, 0, k, force);
    for p in &mut s.flexible.gears {
        p.damping_ratio = None;
    }
    let flanks = s.relaxation(&s.flexible, 0, k, force);
    assert!(flanks > 0.0 && flanks < lag && both > flanks);
    // More force, larger patch, stiffer: less of the lag is seen; the cube root of the force.
    let more = s.relaxation(&s.flexible, 0, k, 8.0 * force);
    assert!((flanks / more - 2.0).abs() < 1e-9);
    assert!(s.relaxation(&s.flexible, 0, 1e12, force) == lag);
}

#[test]
fn candidates_are_distinct_and_go_from_cheap_to_dear() {
    let s = problem();
    let all = Prepared::of(&s).expect("a scene that runs").candidates(&s);
    let names: BTreeSet<String> = all.iter().map(Candidate::name).collect();
    assert_eq!(names.len(), all.len());
    assert!(matches!(all[0].level, Level::Rigid(_)));
    assert_eq!(all[all.len() - 1].level, Level::elastic(300, Detail::Finer));
    for pair in all.windows(2) {
        let steps = [&pair[0], &pair[1]].map(|c| match c.method.resolution {
            Resolution::Step(h) => Some(h),
            Resolution::Tolerance(_) => None,
        });
        if pair[0].level == pair[1].level
            && pair[0].method.method == pair[1].method.method
            && let [Some(a), Some(b)] = steps
        {
            assert!(b < a, "{} before {}", pair[0].name(), pair[1].name());
        }
    }
}

#[test]
fn scenes_outside_of_the_domain_are_told() {
    let mut s = problem();
    let p = Prepared::of(&s).expect("a scene that runs");
    assert_eq!(domain::outside(&s, &p), Vec::<String>::new());
    s.duration = 1.0;
    s.scene.gears[0].speed = 5000.0;
    let found = domain::outside(&s, &p).join("; ");
    assert!(found.contains("it lasts 1.000 s"), "{found}");
    assert!(found.contains("teeth of `a` pass in a second"), "{found}");
}
