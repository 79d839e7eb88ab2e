//! Friction on flank points of elastic gears: forces at the end of a kick.

use super::*;
use gearbench_integrators::system::{At, HalfKick, ModalSplit};
use gearbench_models::law::Friction;

fn rubbing(mu: f64, v_ref: f64) -> ContactSpec {
    ContactSpec {
        friction: Some(Friction::new(mu, v_ref).unwrap()),
        ..with_points(PointContact {
            rule: quadrature(3, 1),
            damping: 1e9,
            ..PointContact::new(1e15)
        })
    }
}

/// Gears under load, a few micrometres into each other.
fn loaded(gap: f64, speed: f64) -> SceneSpec {
    let mut spec = case_a(gap);
    (spec.gears[0].speed, spec.gears[1].speed) = (speed, -speed / 1.5);
    spec.gears[0].loads = vec![Load::Applied(Profile::Constant(40.0))];
    spec.gears[1].loads = vec![Load::Applied(Profile::Constant(60.0))];
    spec
}

/// What a kick asks for is the remainder at the velocities in which it ends, also where friction is all but a step.
#[test]
fn kicks_end_at_the_velocities_that_their_friction_makes() {
    for (residual, partner) in [(2e-9, None), (0.0, None), (2e-9, Some(rigid()))] {
        for v_ref in [1.0_f64, 1e-2, 1e-5] {
            let model = toy(13, 3, 20, residual);
            let models = [model.clone(), partner.clone().unwrap_or(model)];
            let mut scene = build(&loaded(-6e-6, 0.0), &models, &rubbing(0.3, v_ref));
            let mut s = scene.initial();
            deform(&scene, &mut s, 3e-7, 5);
            s.v[0] = 0.1;
            let n = s.q.len();
            let kick = HalfKick {
                time: 5e-7,
                before: &s.v,
                steady: &[],
                filter: &[],
            };
            let mut a = vec![0.0; n];
            scene.remainder_after(s.at(), &kick, &mut a);
            let mut v = Vec::new();
            kick.end(&a, &mut v);
            let mut at_end = vec![0.0; n];
            scene.remainder(At { v: &v, ..s.at() }, &mut at_end);
            let largest = a.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
            let worst = (a.iter().zip(&at_end)).fold(0.0_f64, |m, (x, y)| m.max((x - y).abs()));
            println!("v_ref = {v_ref:e}: off by {:.1e}", worst / largest);
            // Rates tell directions without the residual displacements that dissipation adds; what they are off by counts
            // over the regularisation speed.
            let bound = (1e-6 / v_ref).max(1e-5);
            assert!(
                worst < bound * largest,
                "v_ref = {v_ref:e}: {:.1e}",
                worst / largest
            );
        }
    }
}
