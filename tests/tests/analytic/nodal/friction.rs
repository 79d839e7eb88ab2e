//! Friction on flank points of elastic gears: forces at the end of an impulse.

use super::*;
use gearbench_models::law::Friction;

fn rubbing(mu: f64, v_ref: f64) -> ContactSpec {
    ContactSpec {
        friction: Some(Friction::new(mu, v_ref).unwrap()),
        ..with_points(PointContact {
            rule: quadrature(3, 1),
            ..PointContact::new(1e15).damped(1e9)
        })
    }
}

/// The acceleration for an impulse is the remainder at the velocities at its end, also where friction is nearly a step
/// function.
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
            let off = off_at_the_end_of_a_kick(&mut scene, &s, &[]);
            println!("v_ref = {v_ref:e}: off by {:.1e}", off);
            // Rates tell directions without the residual displacements that dissipation adds; what they are off by counts
            // over the regularisation speed.
            let bound = (1e-6 / v_ref).max(1e-5);
            assert!(off < bound, "v_ref = {v_ref:e}: {:.1e}", off);
        }
    }
}
