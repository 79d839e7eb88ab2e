//! Dashpots at flank points: forces at the end of an impulse, stability, implicit methods, the ledger.

use super::*;
use gearbench_integrators::Resolution;

/// Dashpots per area [N s/m^3]; explicit ones would bear steps of a microsecond up to 2e9.
const DASHPOTS: [f64; 3] = [1e9, 4e9, 2e10];

fn damped(damping: f64) -> ContactSpec {
    with_points(PointContact {
        rule: quadrature(3, 1),
        ..PointContact::new(1e15).damped(damping)
    })
}

/// The acceleration for an impulse is the remainder at the velocities at its end, filtered or not, on compliant and
/// rigid gears.
#[test]
fn kicks_end_at_the_velocities_that_their_forces_make() {
    for (residual, partner) in [(2e-9, None), (0.0, None), (2e-9, Some(rigid()))] {
        for (damping, filtered) in [(1e9, false), (1.6e10, false), (1.6e10, true), (3e11, false)] {
            let model = toy(13, 3, 20, residual);
            let models = [model.clone(), partner.clone().unwrap_or(model)];
            let mut scene = build(&loaded(-6e-6, 200.0), &models, &damped(damping));
            let mut s = scene.initial();
            deform(&scene, &mut s, 3e-6, 5);
            let n = s.q.len();
            let filter: Vec<f64> = (0..n)
                .map(|i| if filtered && i % 3 == 2 { 0.6 } else { 1.0 })
                .collect();
            let off = off_at_the_end_of_a_kick(&mut scene, &s, &filter);
            // Rates tell directions without the residual displacements that the dashpots add.
            assert!(off < 1e-4, "c = {damping:e}: off by {:.1e}", off);
        }
    }
}

/// Dashpots lose what the points themselves are squeezed by: nodes that residual compliance holds give way as gaps close.
/// Small ones, so that the forces are all but elastic; the rates are those of gaps moved by the velocities.
#[test]
fn dashpots_see_the_rates_that_compliance_leaves() {
    let (damping, time) = (1e5, 1e-9);
    let mut before = f64::INFINITY;
    for residual in [0.0, 2e-9, 2e-8] {
        let model = toy(13, 3, 20, residual);
        let models = [model.clone(), model];
        let [mut scene, mut plain] =
            [damping, 0.0].map(|c| build(&loaded(-6e-6, 200.0), &models, &damped(c)));
        let mut s = scene.initial();
        deform(&scene, &mut s, 3e-6, 5);
        let lost = |scene: &mut Scene| {
            let mut out = Outputs::default();
            scene.output(s.at(), &mut out);
            out.power.dissipated
        };
        let found = lost(&mut scene) - lost(&mut plain);
        let mut moved = |time: f64| {
            let mut at = s.clone();
            for (q, v) in at.q.iter_mut().zip(&s.v) {
                *q += time * v;
            }
            plain.contact_forces(at.at())
        };
        let [from, to] = [-0.5 * time, 0.5 * time].map(&mut moved);
        assert_eq!(from.len(), to.len());
        let points = from.iter().zip(&to);
        let expected: f64 = points
            .map(|(a, b)| {
                let stiffness = -a.normal_force / a.gap;
                stiffness * damping / 1e15 * ((b.gap - a.gap) / time).powi(2)
            })
            .sum();
        println!("residual {residual:e}: {found:.4e} W, by the gaps {expected:.4e} W");
        // Points that are hardly closed hold their nodes by less than their stiffness.
        assert!(
            (found - expected).abs() < 0.03 * expected,
            "residual {residual:e}: {found:e} W, expected {expected:e} W"
        );
        assert!(found < 0.9 * before, "{found} {before}");
        before = found;
    }
}

/// A step of half a microsecond, a product of dashpot and step far beyond what explicit dashpots bear: no energy is made, the
/// ledger closes, and half the step says the same.
#[test]
fn dashpots_do_not_limit_the_step() {
    for damping in DASHPOTS {
        for id in ["trigonometric", "velocity-verlet"] {
            let model = toy(13, 3, 20, 2e-9);
            let mut scene = build(
                &loaded(0.0, 200.0),
                &[model.clone(), model],
                &damped(damping),
            );
            let mut run = |step: f64| {
                let outcome = run(&mut scene, id, Resolution::Step(step), 1e-3).unwrap(id);
                let work = outcome.ledger.dissipated + outcome.impulse;
                (
                    outcome.ledger.residual(),
                    outcome.ledger.dissipated,
                    work,
                    outcome.peak,
                )
            };
            let step = 5e-7;
            let ((coarse, lost, ..), (fine, less, _, peak)) = (run(step), run(0.5 * step));
            println!(
                "{id}, c = {damping:e}: {coarse:.1e}, {fine:.1e} of {lost:.2e} J, peak {peak:.0} N"
            );
            assert!(
                lost > 0.0 && (lost - less).abs() < 0.3 * less,
                "{lost} {less}"
            );
            assert!(
                fine.abs() < 0.02 * less,
                "{id}, c = {damping:e}: {fine:e} of {less:e}"
            );
        }
    }
}

/// Implicit methods end their Newton steps with dashpots, whatever their size.
#[test]
fn newton_ends_with_dashpots() {
    for damping in DASHPOTS {
        for id in ["newmark", "hht-alpha", "generalised-alpha"] {
            for step in [2e-6, 1e-6, 5e-7] {
                let model = toy(13, 3, 20, 2e-9);
                let mut scene = build(
                    &loaded(0.0, 200.0),
                    &[model.clone(), model],
                    &damped(damping),
                );
                run(&mut scene, id, Resolution::Step(step), 5e-4).unwrap(id);
                let nodes = nodes_on_springs(9);
                let mut scene = build(
                    &loaded(0.0, 200.0),
                    &[nodes.clone(), nodes],
                    &damped(damping),
                );
                run(&mut scene, id, Resolution::Step(step), 1e-4).unwrap(id);
            }
        }
    }
}
