//! Contact laws that a program adds, over all models with contact of tooth pairs and all methods: a law with the formula of a
//! built-in one gives its run, and an elastic law keeps the energy.

use crate::impact::{T_END, fine, of_model, of_pairs, scene_of};
use gearbench_integrators::Stepping;
use gearbench_models::law::{ContactState, Damping, ForceLaw};
use gearbench_models::spec::ContactSpec;
use gearbench_tests::*;
use std::sync::Arc;

/// `N = k d^1.5 (1 + chi d'/v)`, as a program would write it.
#[derive(Debug)]
struct HuntCrossley {
    e: f64,
}

impl ForceLaw for HuntCrossley {
    fn name(&self) -> &str {
        "hunt-crossley-of-a-program"
    }

    fn force(&self, at: &ContactState) -> f64 {
        let v = at.impact_speed.max(at.gap_rate.abs());
        let factor = 1.0 - 1.5 * (1.0 - self.e) * at.gap_rate / v;
        at.stiffness * (-at.gap).powf(1.5) * factor
    }
}

/// A stiffening spring without damping, which no exponent describes.
#[derive(Debug)]
struct Stiffening;

impl ForceLaw for Stiffening {
    fn name(&self) -> &str {
        "stiffening"
    }

    fn force(&self, at: &ContactState) -> f64 {
        let d = -at.gap;
        at.stiffness * d * (0.5 + d / (d + 4e-6))
    }

    fn is_elastic(&self) -> bool {
        true
    }
}

fn with_law(contact: ContactSpec, law: impl ForceLaw + 'static) -> ContactSpec {
    ContactSpec {
        exponent: 1.0,
        damping: Damping::None,
        normal_force: Some(Arc::new(law)),
        ..contact
    }
}

#[test]
fn a_law_of_a_program_gives_the_run_of_the_built_in_law() {
    let mut table = String::new();
    for model in &of_pairs() {
        let stiffness = usual_stiffness(model) * 1e-5_f64.powf(-0.5);
        let known = ContactSpec {
            exponent: 1.5,
            damping: Damping::HuntCrossley { e: 0.8 },
            ..contact(stiffness)
        };
        let own = with_law(contact(stiffness), HuntCrossley { e: 0.8 });
        for method in of_model(model) {
            let info = method.info;
            let resolution = resolution(info, 1e-7, 1e-6);
            let [a, b] = [&known, &own].map(|contact| {
                let mut scene = scene_of(model, contact);
                run(&mut scene, info.id, resolution, T_END).unwrap(info.id)
            });
            assert!(b.peak > 100.0 && b.ledger.dissipated > 0.0, "{}", info.id);
            let speed = |o: &Outcome| o.state.v.iter().map(|v| v * v).sum::<f64>().sqrt();
            let errors = [
                b.peak / a.peak - 1.0,
                speed(&b) / speed(&a) - 1.0,
                (b.ledger.dissipated - a.ledger.dissipated) / a.ledger.dissipated,
            ];
            let worst = errors.iter().fold(0.0_f64, |w, e| w.max(e.abs()));
            table += &format!("{:14} {:20} {worst:.1e}\n", model.id, info.id);
            // Methods with adaptive steps control them by errors that rounding and tangents by differences change.
            let bound = match info.stepping {
                Stepping::Adaptive => 1e-6,
                _ => 1e-9,
            };
            assert!(worst < bound, "{} under {}: {errors:?}", model.id, info.id);
        }
    }
    println!("largest relative difference of peak force, speed and dissipation:\n{table}");
}

#[test]
fn an_elastic_law_of_a_program_keeps_the_energy() {
    for model in &of_pairs() {
        let own = with_law(contact(usual_stiffness(model)), Stiffening);
        for method in of_model(model).into_iter().filter(|m| !m.info.dissipative) {
            let mut scene = scene_of(model, &own);
            let o =
                run(&mut scene, method.info.id, fine(method.info), T_END).unwrap(method.info.id);
            let what = format!("{} under {}", model.id, method.info.id);
            let error = o.ledger.end.total() / o.ledger.start.unwrap().total() - 1.0;
            // The step is that for a linear spring; this one is stiffer where it is deep.
            let bound = 4e-6;
            assert!(
                error.abs() <= bound,
                "{what}: energy changes by {error:.2e}"
            );
            let residual = o.ledger.residual_relative();
            assert!(residual.abs() <= bound, "{what}: ledger {residual:.2e}");
            assert!(
                o.peak > 100.0,
                "{what}: a peak of {} N is no impact",
                o.peak
            );
        }
    }
}

#[test]
fn a_law_of_a_program_needs_tooth_pairs_and_has_its_own_damping() {
    let rigid_pair = [rigid(), rigid()];
    let of = |contact: ContactSpec, models: &[_]| {
        try_build(&case_a(1e-6), models, &with_law(contact, Stiffening)).map(|_| ())
    };
    assert_eq!(of(contact(1e10), &rigid_pair), Ok(()));
    let both = ContactSpec {
        damping: Damping::HuntCrossley { e: 0.8 },
        ..with_law(contact(1e10), Stiffening)
    };
    let error = try_build(&case_a(1e-6), &rigid_pair, &both).err().unwrap();
    let text = error.to_string();
    assert!(
        text.contains("`stiffening`") && text.contains("hunt-crossley"),
        "{text}"
    );
    assert!(error.reason.help.contains("remove"), "{error:?}");
}
