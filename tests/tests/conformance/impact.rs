//! The impact of case A in contact of tooth pairs, where laws and order are known exactly: every model of the joined
//! table without own flanks, under every method.

use gearbench_integrators::{
    AcceptedStep, Control, Method, MethodInfo, Outputs, Resolution, SecondOrderSystem, Sink,
    Stepping, TimePlan,
};
use gearbench_models::gear::table::Model;
use gearbench_models::law::{Damping, realised_restitution};
use gearbench_models::scene::Scene;
use gearbench_models::spec::{ContactSpec, effective_radius, mesh_layout};
use gearbench_models::stiffness::{IsoVariation, PairOrMesh, PairStiffness};
use gearbench_tests::*;

/// End after the impact, before the opposite flanks touch, and initial gap.
pub const T_END: f64 = 1.5e-4;
const GAP: f64 = 3.1e-6;

/// Returns the models in contact of tooth pairs.
pub fn of_pairs() -> Vec<Model> {
    let pairs = subjects().into_iter().filter(|s| !s.flanks);
    let mut models: Vec<Model> = pairs.map(|s| s.model).collect();
    models.dedup_by_key(|m| m.id);
    models
}

/// Builds case A with one model for both gears.
pub fn scene_of(model: &Model, contact: &ContactSpec) -> Scene {
    build(&case_a(GAP), &[usual(model), usual(model)], contact)
}

/// Returns the methods that support a model.
pub fn of_model(model: &Model) -> Vec<&'static Method> {
    methods_of(&mut scene_of(model, &contact(usual_stiffness(model))))
}

/// Returns a step that resolves the impact well beyond 1e-6 of its energy.
pub fn fine(info: &MethodInfo) -> Resolution {
    match (info.stepping, info.order) {
        (Stepping::Adaptive, _) => Resolution::Tolerance(1e-9),
        (_, 0 | 1) => Resolution::Step(6e-10),
        (_, 2) => Resolution::Step(5e-8),
        _ => Resolution::Step(1e-7),
    }
}

/// Sink that checks `L1/r_b1 - L2/r_b2` at every accepted step.
struct Invariant {
    per_speed: [f64; 2],
    channels: [usize; 2],
    start: Option<[f64; 2]>,
    drift: f64,
    impulse: f64,
    out: Outputs,
}

impl Invariant {
    fn new(scene: &Scene) -> Self {
        let spec = case_a(GAP);
        Invariant {
            per_speed: [0, 1].map(|i| {
                scene.gears()[i].model.hub().inertia / effective_radius(&spec.gears[i].body)
            }),
            channels: ["speed:pinion", "speed:wheel"].map(|c| gearbench_tests::named(scene, c)),
            start: None,
            drift: 0.0,
            impulse: 0.0,
            out: Outputs::default(),
        }
    }

    fn momenta(
        &mut self,
        sys: &mut dyn SecondOrderSystem,
        s: &gearbench_integrators::State,
    ) -> [f64; 2] {
        sys.output(s.at(), &mut self.out);
        [0, 1].map(|i| self.out.channels[self.channels[i]] * self.per_speed[i])
    }
}

impl Sink for Invariant {
    fn accepted(&mut self, sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        if self.start.is_none() {
            self.start = Some(self.momenta(sys, step.from));
        }
        let [a0, b0] = self.start.unwrap_or_default();
        let [a, b] = self.momenta(sys, step.to);
        self.drift = self.drift.max(((a - b) - (a0 - b0)).abs());
        self.impulse = self.impulse.max((a - a0).abs());
        Control::Continue
    }
}

#[test]
fn momentum_along_the_line_of_action_is_invariant() {
    for model in &of_pairs() {
        for method in of_model(model) {
            for events in [true, false] {
                let mut scene = scene_of(model, &contact(usual_stiffness(model)));
                let mut watch = Invariant::new(&scene);
                let start = scene.initial();
                let plan = TimePlan {
                    events,
                    ..TimePlan::new(T_END, resolution(method.info, 2e-7, 1e-6))
                };
                watched(&mut scene, start, method.info.id, &plan, &mut watch);
                let what = format!("{} under {}, events {events}", model.id, method.info.id);
                assert!(watch.impulse > 0.1, "{what}: impulse {}", watch.impulse);
                let drift = watch.drift / watch.impulse;
                assert!(
                    drift <= 1e-10,
                    "{what}: L1/r_b1 - L2/r_b2 drifts by {drift:.2e} of the impulse"
                );
            }
        }
    }
}

#[test]
fn methods_without_dissipation_keep_the_energy_of_an_elastic_impact() {
    for model in &of_pairs() {
        for method in of_model(model).into_iter().filter(|m| !m.info.dissipative) {
            let mut scene = scene_of(model, &contact(usual_stiffness(model)));
            let o =
                run(&mut scene, method.info.id, fine(method.info), T_END).unwrap(method.info.id);
            let start = o.ledger.start.unwrap().total();
            let error = o.ledger.end.total() / start - 1.0;
            let what = format!("{} under {}", model.id, method.info.id);
            assert!(error.abs() <= 1e-6, "{what}: energy changes by {error:.2e}");
            assert!(
                o.normal_min >= -1e-9 * o.peak,
                "{what}: the contact pulls with {} N",
                o.normal_min
            );
            assert!(o.ledger.end.contact == 0.0, "{what}: still in contact");
        }
    }
}

#[test]
fn the_loss_of_dissipative_methods_falls_with_the_declared_order() {
    let mut table = String::new();
    let mut bad = false;
    for model in &of_pairs() {
        for method in of_model(model).into_iter().filter(|m| m.info.dissipative) {
            let info = method.info;
            let (x, declared): (Vec<f64>, f64) = match info.stepping {
                Stepping::Adaptive => (vec![1e-4, 1e-5, 1e-6, 1e-7], info.tolerance_slope),
                _ if info.order >= 4 => (vec![3.2e-6, 1.6e-6, 8e-7, 4e-7], f64::from(info.order)),
                _ => (vec![8e-7, 4e-7, 2e-7, 1e-7], f64::from(info.order)),
            };
            let loss: Vec<f64> = x
                .iter()
                .map(|&x| {
                    let mut scene = scene_of(model, &contact(usual_stiffness(model)));
                    let r = match info.stepping {
                        Stepping::Adaptive => Resolution::Tolerance(x),
                        _ => Resolution::Step(x),
                    };
                    let o = run(&mut scene, info.id, r, T_END).unwrap(info.id);
                    (1.0 - o.ledger.end.total() / o.ledger.start.unwrap().total()).abs()
                })
                .collect();
            // What rounding leaves says nothing.
            let (x, loss): (Vec<f64>, Vec<f64>) =
                x.into_iter().zip(loss).filter(|(_, e)| *e > 1e-12).unzip();
            assert!(
                x.len() >= 3,
                "{} under {}: too fine to fit",
                model.id,
                info.id
            );
            let observed = slope(&x, &loss);
            table += &format!(
                "{:14} {:20} declared {declared:.2} observed {observed:.2} {}\n",
                model.id,
                info.id,
                loss.iter().map(|x| format!(" {x:.1e}")).collect::<String>()
            );
            bad |= observed < declared - 0.25;
        }
    }
    assert!(!bad, "the loss falls more slowly than declared:\n{table}");
    println!("{table}");
}

#[test]
fn the_ledger_closes_with_varying_stiffness() {
    let stiffnesses = [
        PairStiffness::Iso6336 {
            variation: IsoVariation::IsoMean,
        },
        PairStiffness::Parabola {
            per_width: 1.4e10,
            along: [0.2, -0.2],
            of: PairOrMesh::Pair,
        },
    ];
    let of_pairs = of_pairs();
    for (model, stiffness) in of_pairs
        .iter()
        .flat_map(|m| stiffnesses.iter().map(move |k| (m, k)))
    {
        for method in of_model(model) {
            let contact = ContactSpec {
                stiffness: stiffness.clone(),
                ..contact(1.0)
            };
            // On the rising part of the stiffness.
            let mut spec = case_a(GAP);
            let at = mesh_layout(&spec.gears[0], &spec.gears[1]).unwrap();
            spec.meshes[0].start.path_coordinate =
                Some(at.path[0] + 0.35 * (at.path[1] - at.path[0]));
            let mut scene = build(&spec, &[usual(model), usual(model)], &contact);
            let resolution = match method.info.stepping {
                Stepping::Adaptive => Resolution::Tolerance(1e-10),
                _ if method.info.order >= 4 => Resolution::Step(5e-8),
                _ if method.info.order == 1 => Resolution::Step(1.5e-9),
                _ => Resolution::Step(2e-8),
            };
            let o = run(&mut scene, method.info.id, resolution, T_END).unwrap(method.info.id);
            let residual = o.ledger.residual_relative();
            let what = format!("{}, {} under {}", model.id, stiffness.id(), method.info.id);
            // The force is the derivative of a potential: stiffness that varies along the path puts nothing in.
            assert!(
                residual.abs() <= 1e-6,
                "{what}: {residual:.2e} of the energy is not explained"
            );
        }
    }
}

#[test]
fn the_ledger_closes_with_damped_contacts() {
    for model in &of_pairs() {
        for (exponent, damping) in [
            (1.0, Damping::KelvinVoigtRatio { ratio: 0.05 }),
            (1.0, Damping::HuntCrossley { e: 0.8 }),
            (1.5, Damping::Flores { e: 0.7 }),
            (10.0 / 9.0, Damping::Gonthier { e: 0.8 }),
            (1.0, Damping::LankaraniNikravesh { e: 0.9 }),
        ] {
            // A nonlinear law needs more than the linear stiffness for the same force.
            let stiffness = usual_stiffness(model) * 1e-5_f64.powf(1.0 - exponent);
            let contact = ContactSpec {
                exponent,
                damping,
                ..contact(stiffness)
            };
            for (id, resolution) in [
                ("dopri5", Resolution::Tolerance(1e-9)),
                ("generalised-alpha", Resolution::Step(2e-8)),
            ] {
                let mut scene = scene_of(model, &contact);
                let o = run(&mut scene, id, resolution, T_END).unwrap(id);
                let what = format!("{} with {damping:?} under {id}", model.id);
                let residual = o.ledger.residual_relative();
                assert!(
                    residual.abs() <= 2e-6,
                    "{what}: {residual:.2e} of the energy is not explained"
                );
                let lost = o.ledger.dissipated / o.ledger.start.unwrap().total();
                assert!((0.01..0.6).contains(&lost), "{what}: loses {lost:.3}");
                assert!(
                    o.normal_min >= -1e-9 * o.peak,
                    "{what}: the contact pulls with {} N",
                    o.normal_min
                );
            }
        }
    }
}

#[test]
fn rigid_gears_rebound_with_the_restitution_of_the_law() {
    let spec = case_a(GAP);
    let closing = |scene: &mut Scene, s: &gearbench_integrators::State| {
        channel(scene, s, "hub_speed:pinion") * effective_radius(&spec.gears[0].body)
            + channel(scene, s, "hub_speed:wheel") * effective_radius(&spec.gears[1].body)
    };
    for (damping, chi) in [
        (Damping::None, 0.0),
        (Damping::HuntCrossley { e: 0.8 }, 1.5 * 0.2),
        (Damping::LankaraniNikravesh { e: 0.8 }, 0.75 * (1.0 - 0.64)),
        (Damping::Flores { e: 0.6 }, 1.6 * 0.4 / 0.6),
        (Damping::Gonthier { e: 0.6 }, 0.64 / 0.6),
    ] {
        for exponent in [1.0, 1.5] {
            let stiffness = 1.54e10 * 1e-5_f64.powf(1.0 - exponent);
            let contact = ContactSpec {
                exponent,
                damping,
                ..contact(stiffness)
            };
            for method in methods_of(&mut build(&spec, &[rigid(), rigid()], &contact))
                .into_iter()
                .filter(|m| m.info.order > 1)
            {
                let mut scene = build(&spec, &[rigid(), rigid()], &contact);
                let s = scene.initial();
                let before = closing(&mut scene, &s);
                let r = resolution(method.info, 2e-8, 1e-9);
                let o = run(&mut scene, method.info.id, r, T_END).unwrap(method.info.id);
                let after = closing(&mut scene, &o.state);
                let (got, want) = (-after / before, realised_restitution(chi));
                assert!(
                    (got - want).abs() < 2e-6,
                    "{damping:?}, exponent {exponent}, {}: restitution {got}, the law gives {want}",
                    method.info.id
                );
            }
        }
    }
}
