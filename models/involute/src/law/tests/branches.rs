//! Tests of the branches of closed contacts and of their ends.

use super::*;

/// An open contact whose flanks separate fast has no force, although the smooth branch of the law would: both factors
/// of its force have passed zero, which may happen within one step.
#[test]
fn parting_faster_than_the_damper_knows_is_no_push() {
    for damping in [
        Damping::RatioAtLoad { ratio: 0.1 },
        Damping::Flores { e: 0.3 },
    ] {
        let law = Law::new(1.0, damping).unwrap();
        let load = MeshLoad {
            force: 20.0,
            stiffness: K,
            mass: MASS,
        };
        let law = law.under_load(load).unwrap();
        let (g, v0) = (1e-8, 1e-4);
        assert!(law.smooth(g, 0.5, v0, K).n > 0.0);
        assert!(law.valid_for(CLOSED, g, 0.5, v0, K) < 0.0);
        assert!(law.valid_for(CLOSED, -g, -0.5, v0, K) > 0.0);
        assert!(law.valid_for(CLOSED, -g, 0.5, v0, K) < 0.0);
        assert!(law.valid_for(CLOSED, g, -0.5, v0, K) < 0.0);
    }
}

/// The force of a bounded dashpot is that of the branch of its mode, and branches agree where they end.
#[test]
fn branches_of_a_bounded_dashpot_make_up_its_force() {
    let bounded = Law::new(1.0, Damping::KelvinVoigtBounded { c: 900.0 }).unwrap();
    let k = stiffness(&bounded);
    for i in 1..=40 {
        for j in -40..=40 {
            let (g, rate) = (-1e-6 * f64::from(i), 0.11 * f64::from(j));
            let mode = bounded.mode(g, rate, k);
            let acts = bounded.clipped(g, rate, V0, k);
            if bounded.valid_for(mode, g, rate, V0, k) > 0.0 {
                let branch = bounded.smooth_in_mode(mode, g, rate, V0, k);
                assert_eq!(acts, branch, "{g} {rate}");
                let force = bounded.force_in_mode(mode, g, rate, V0, k);
                assert_eq!(acts.n, force, "{g} {rate}");
            } else {
                assert_eq!((mode, acts), (CLOSED, LawForce::default()), "{g} {rate}");
            }
        }
        let g = -1e-6 * f64::from(i);
        let rate = k * g / 900.0;
        let [two, one] = [SATURATED, CLOSED].map(|m| bounded.force_in_mode(m, g, rate, V0, k));
        assert!((two - one).abs() < 1e-9 * two);
        assert_eq!(bounded.mode_after(SATURATED, rate), CLOSED);
        assert_eq!(bounded.mode_after(CLOSED, rate), SATURATED);
        assert_eq!(bounded.mode_after(CLOSED, -rate), OPEN);
    }
    let plain = Law::new(1.0, Damping::KelvinVoigt { c: 900.0 }).unwrap();
    assert_eq!(plain.mode(-1e-6, -1.0, k), CLOSED);
    assert_eq!(plain.mode_after(CLOSED, -1.0), OPEN);
}
