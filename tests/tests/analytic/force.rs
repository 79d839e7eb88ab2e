//! The force is a pure function, event functions mark the end of its branch, and elastic laws switch without a jump.

use gearbench_integrators::{Change, Events, SecondOrderSystem, State};
use gearbench_models::law::{Damping, Friction};
use gearbench_models::scene::Scene;
use gearbench_models::spec::{ContactSpec, ModelSpec};
use gearbench_tests::*;

fn force(scene: &mut Scene, s: &State) -> Vec<f64> {
    let mut f = vec![0.0; s.q.len()];
    scene.force(s.at(), &mut f);
    f
}

fn pairs() -> Vec<[ModelSpec; 2]> {
    let teeth = movable(5.3e8, 4.8e-3, 20.0);
    vec![
        [rigid(), rigid()],
        [teeth.clone(), teeth],
        [web(0.02), web(0.02)],
    ]
}

/// Builds a scene near first contact, with the pinion ahead by `depth` [m].
fn around_touch(
    models: &[ModelSpec; 2],
    contact: &ContactSpec,
    depth: f64,
    numbers: &mut Numbers,
) -> (Scene, State) {
    let scene = build(&case_a(0.0), models, contact);
    let mut s = scene.initial();
    let (sq, sv) = scales(&scene);
    for i in 0..s.q.len() {
        s.q[i] += 0.05 * sq[i] * numbers.draw();
        s.v[i] += 0.5 * sv[i] * numbers.draw();
    }
    let range = scene.gears()[0].range();
    range.for_each(|i| s.q[i] += depth / 0.0376);
    (scene, s)
}

fn contacts() -> Vec<ContactSpec> {
    let friction = Some(Friction::new(0.05, 0.02).unwrap());
    let mut all = Vec::new();
    for (exponent, damping) in [
        (1.0, Damping::None),
        (1.5, Damping::Flores { e: 0.7 }),
        (1.0, Damping::KelvinVoigt { c: 500.0 }),
        (10.0 / 9.0, Damping::HuntCrossley { e: 0.8 }),
    ] {
        all.push(ContactSpec {
            exponent,
            damping,
            ..contact(1.5e10)
        });
        all.push(ContactSpec {
            exponent,
            damping,
            friction,
            ..contact(1.5e10)
        });
    }
    all
}

#[test]
fn force_repeats_bit_for_bit_whatever_is_evaluated_in_between() {
    let mut numbers = Numbers::new(1);
    for models in pairs() {
        for contact in contacts() {
            for located in [false, true] {
                let (mut scene, mut s) = around_touch(&models, &contact, 3e-6, &mut numbers);
                scene.begin(&mut s, located);
                let first = force(&mut scene, &s);
                let kept = s.clone();
                // Other states, tangents, event functions and outputs leave no trace.
                let (_, other) = around_touch(&models, &contact, -2e-6, &mut numbers);
                let other = State {
                    discrete: s.discrete.clone(),
                    ..other
                };
                force(&mut scene, &other);
                let mut df = vec![0.0; s.q.len()];
                scene.tangent_times(other.at(), &other.v, &other.v, &mut df);
                let mut event_functions = vec![0.0; scene.layout().event_functions];
                scene.event_functions(other.at(), &mut event_functions);
                channel(&mut scene, &other, "force:0");
                let again = force(&mut scene, &s);
                let bits = |f: &[f64]| f.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
                assert_eq!(bits(&first), bits(&again));
                assert_eq!(s, kept, "a force changed its state");
            }
        }
    }
}

#[test]
fn closed_contacts_with_positive_event_functions_push_and_others_do_not() {
    // Just after `begin` every event function is positive or at its root, and the located force is the clipped one.
    let mut numbers = Numbers::new(2);
    for models in pairs() {
        for contact in contacts() {
            for i in -20..=20 {
                let depth = 2e-7 * f64::from(i) + 1e-8;
                let (mut scene, mut s) = around_touch(&models, &contact, depth, &mut numbers);
                scene.begin(&mut s, true);
                let mut event_functions = vec![0.0; scene.layout().event_functions];
                scene.event_functions(s.at(), &mut event_functions);
                // A linear damper that has let go while the flanks still overlap may sit below its root.
                let lowest = event_functions.iter().fold(f64::INFINITY, |m, &g| m.min(g));
                assert!(
                    lowest >= -1e-9,
                    "{:?} at depth {depth}: event {lowest:e}",
                    contact.damping
                );
                assert!(channel(&mut scene, &s, "normal_min:0") >= 0.0);
                let located = force(&mut scene, &s);
                let mut clipped = s.clone();
                scene.begin(&mut clipped, false);
                let want = force(&mut scene, &clipped);
                let size = want.iter().fold(1e-9_f64, |m, x| m.max(x.abs()));
                for (a, b) in located.iter().zip(&want) {
                    assert!(
                        (a - b).abs() <= 1e-9 * size,
                        "{:?} {depth}: {a} {b}",
                        contact.damping
                    );
                }
            }
        }
    }
}

#[test]
fn elastic_laws_switch_without_a_jump_of_the_force() {
    for models in pairs() {
        for exponent in [1.0, 1.5] {
            let contact = ContactSpec {
                exponent,
                ..contact(1.5e10)
            };
            let scene = build(&case_a(3e-6), &models, &contact);
            let mut scene = scene;
            let mut s = scene.initial();
            scene.begin(&mut s, true);
            // To where the pair of the start touches exactly: the smallest gap is zero.
            let gap = candidates(&scene, &s)
                .iter()
                .map(|(_, c)| c.gap)
                .fold(f64::INFINITY, f64::min);
            let range = scene.gears()[0].range();
            let effective_radius =
                gearbench_models::spec::effective_radius(&case_a(3e-6).gears[0].body);
            range.for_each(|i| s.q[i] += gap / effective_radius);
            let mut event_functions = vec![0.0; scene.layout().event_functions];
            scene.event_functions(s.at(), &mut event_functions);
            let at_root: Vec<usize> = (0..event_functions.len())
                .filter(|&i| event_functions[i].abs() < 1e-15)
                .collect();
            assert!(!at_root.is_empty(), "no event at its root");
            let before = force(&mut scene, &s);
            for &event in &at_root {
                assert_eq!(scene.transition(&mut s, event), Change::Restart);
            }
            let after = force(&mut scene, &s);
            for (a, b) in before.iter().zip(&after) {
                assert!(
                    (a - b).abs() < 1e-6,
                    "{} {exponent}: the force jumps from {a} to {b}",
                    models[0].id()
                );
            }
            // And back: opening there changes nothing either.
            for &event in &at_root {
                scene.transition(&mut s, event);
            }
            assert_eq!(force(&mut scene, &s), before);
        }
    }
}
