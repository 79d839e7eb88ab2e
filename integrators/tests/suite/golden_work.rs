//! Pinned counters of work, which show changes of step control or event location first.
//!
//! Counters are compared exactly. The arithmetic is plain f64 in a fixed order and the only functions of
//! the platform's mathematics library are powers in the step control, which decide a step near its limit
//! at most; a platform that differs shows the same physics with other counts.

use crate::problems::*;
use gearbench_integrators::Work;

#[test]
fn hammering_with_dormand_prince() {
    let hammer = Hammer::gears(0.05);
    let (_, work) = solve(
        by_id("dopri5"),
        &mut hammer.clone(),
        hammer.start(),
        &tolerance(0.25, 1e-6),
    );
    assert_eq!(
        work,
        Work {
            steps: 346,
            rejected: 48,
            force_evaluations: 2413,
            newton_iterations: 0,
            factorisations: 0,
            events: 48,
            restarts: 48,
        }
    );
}

#[test]
fn hammering_with_generalised_alpha() {
    let hammer = Hammer::gears(0.05);
    let (_, work) = solve(
        by_id("generalised-alpha"),
        &mut hammer.clone(),
        hammer.start(),
        &steps(0.25, 25_000.0),
    );
    assert_eq!(
        work,
        Work {
            steps: 25048,
            rejected: 71,
            force_evaluations: 25717,
            newton_iterations: 25668,
            factorisations: 25668,
            events: 48,
            restarts: 48,
        }
    );
}
