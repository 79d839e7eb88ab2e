//! Cost of a step of the elastic model compared with its lower bound: `cargo bench --bench elastic_step`.
//!
//! Case A fine, one impact, steps of a microsecond. The states of the impact are taken from a run; all evaluations
//! then take turns on the same states, so that ratios are those of one machine in one mood. The kernel does nothing but
//! what no solve on nodes can do without: it gathers the residual compliance of the nodes that carry force, multiplies
//! their shapes with the modes both ways, and factorises one dense matrix of their number. On half-spaces
//! (`loaded_mesh` as shipped) the nodes are lines about the contacts, and the matrix has a row for each contact.

mod support;

use gearbench_integrators::system::{SecondOrderSystem, State};
use gearbench_integrators::{AcceptedStep, Control, NullSink, Resolution, Sink, TimePlan};
use gearbench_models::gear::parameters::ModelParameters;
use gearbench_models::scene::Scene;
use gearbench_reference::full_order::FullOrderParameters;
use gearbench_reference::reduction::ElasticParameters;
use gearbench_reference::reduction::cache::Cache;
use gearbench_reference::resources::Resources;
use nalgebra::DMatrix;
use std::hint::black_box;
use std::sync::Arc;
use support::helical::{Motion, against_full, bearings, compare};
use support::ratio::{by_turns, ratios, seconds};
use support::scenes::{changed, file, run};

const STEP: f64 = 1e-6;

/// Returns the scene of the finite elements with elastic gears in their place.
fn scene(modes: usize, surface: &str) -> (Scene, f64) {
    let file = file("spur_impact");
    let scene = changed(&file, "fe", |modelling| {
        for gear in &mut modelling.gears {
            let full = FullOrderParameters::of(gear).expect("full finite elements");
            let elastic = ElasticParameters {
                modes: Some(modes),
                // All 200 modes are wanted, whatever their frequency.
                step_s: Some(2e-7),
                mesh: full.mesh.clone(),
                ..ElasticParameters::default()
            };
            *gear = elastic.spec();
        }
        for contact in &mut modelling.contacts {
            if let Some(points) = contact.flanks.points_mut()
                && surface == "smooth"
            {
                points.surface = gearbench_models::spec::SurfaceKind::Smooth;
            }
        }
    });
    (scene, file.duration)
}

/// Sink that records the states of a run.
struct States(Vec<State>);

impl Sink for States {
    fn accepted(&mut self, _sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        self.0.push(step.to.clone());
        Control::Continue
    }
}

/// Returns states of the impact with and without contact.
fn states(scene: &mut Scene, end: f64) -> [Vec<State>; 2] {
    let mut method = gearbench_integrators::table::TRIGONOMETRIC.build();
    let mut sink = States(vec![]);
    let plan = TimePlan::new(end, Resolution::Step(STEP));
    run(scene, method.as_mut(), &plan, &mut sink);
    let touches = |s: &State, scene: &mut Scene| !scene.contact_forces(s.at()).is_empty();
    let (mut contact, mut apart) = (vec![], vec![]);
    for s in sink.0 {
        if touches(&s, scene) {
            &mut contact
        } else {
            &mut apart
        }
        .push(s);
    }
    [contact, apart]
}

/// Returns the time of the evaluations at all states, per state.
fn evaluations(scene: &mut Scene, states: &[State]) -> f64 {
    let mut a = vec![0.0; scene.layout().n];
    let time = seconds(|| {
        for s in states {
            scene.modal().unwrap().remainder(black_box(s.at()), &mut a);
        }
    });
    time / states.len() as f64
}

/// Work of the kernel at all states.
struct Kernel {
    /// Loaded nodes, by state and gear.
    nodes: Vec<[Vec<u32>; 2]>,
    /// Number of unknowns of the solve at each state.
    unknowns: Vec<usize>,
    /// Matrices of every size.
    matrices: Vec<DMatrix<f64>>,
}

impl Kernel {
    fn new(scene: &mut Scene, states: &[State]) -> Self {
        let mut f = vec![0.0; scene.layout().n];
        let pressed = states.iter().map(|s| {
            scene.force(s.at(), &mut f);
            [0, 1].map(|g| scene.pressed_nodes(g))
        });
        let nodes: Vec<[Vec<u32>; 2]> = pressed.collect();
        let on_lines = scene.meshes()[0].search.lines().is_some();
        let unknowns = (states.iter().zip(&nodes))
            .map(|(s, nodes)| match on_lines {
                true => scene.contact_forces(s.at()).len(),
                false => nodes[0].len() + nodes[1].len(),
            })
            .collect();
        let matrix =
            |n: usize| DMatrix::from_fn(n, n, |i, j| if i == j { n as f64 + 1.0 } else { 1.0 });
        Self {
            nodes,
            unknowns,
            matrices: (0..=256).map(matrix).collect(),
        }
    }

    fn mean_nodes(&self) -> f64 {
        let all: usize = self.nodes.iter().flatten().map(Vec::len).sum();
        all as f64 / self.nodes.len() as f64
    }

    /// Returns the time per state.
    fn time(&self, scene: &Scene, states: &[State]) -> f64 {
        let mut f = vec![0.0; states[0].q.len()];
        let (mut a, mut r) = ([0.0; 256], vec![0.0; 256 * 256]);
        let time = seconds(|| {
            for ((s, nodes), unknowns) in states.iter().zip(&self.nodes).zip(&self.unknowns) {
                for (g, nodes) in scene.gears().iter().zip(nodes) {
                    let (field, range) = (g.model.displacement().unwrap(), g.range());
                    let count = nodes.len();
                    field.compliance(nodes, &mut r[..count * count]);
                    field.displacements(&s.q[range.clone()], nodes, &mut a[..count]);
                    field.apply_nodal_forces(nodes, &a[..count], &mut f[range]);
                }
                black_box(self.matrices[*unknowns].clone().cholesky());
            }
            black_box((&f, &r));
        });
        time / states.len() as f64
    }
}

#[allow(clippy::print_stdout)]
fn main() {
    // Reductions of the gears, which take most of the time, are kept for the next run.
    let resources = Resources {
        cache: Arc::new(Cache::standard()),
        ..Resources::default()
    };
    resources.within(all);
}

#[allow(clippy::print_stdout)]
fn all() {
    let mut criterion = ratios(2.0);
    for label in ["elastic", "elastic-half-space"] {
        for motion in [Motion::Impact, Motion::Load(75.0)] {
            for helix in [8.0, 15.0, 25.0] {
                compare(&mut criterion, helix, motion, label);
            }
            if label == "elastic" {
                for helix in [0.0, 15.0] {
                    bearings(&mut criterion, helix, motion, label);
                }
            }
        }
    }
    against_full(&mut criterion, 15.0);
    if std::env::args().any(|a| a == "--helical") {
        return;
    }
    for surface in ["faceted", "smooth"] {
        let (mut none, end) = scene(0, surface);
        let (mut many, _) = scene(200, surface);
        let [quasi_static, _] = states(&mut none, end);
        let [contact, apart] = states(&mut many, end);
        let modes = many.layout().n - 2;
        let group = format!("evaluation, {surface}");
        let [full, zero] = by_turns(&mut criterion, &group, "modes / none", || {
            [
                evaluations(&mut many, &contact),
                evaluations(&mut none, &quasi_static),
            ]
        });
        let kernel = Kernel::new(&mut many, &contact);
        let [beside, bare] = by_turns(&mut criterion, &group, "modes / kernel", || {
            [
                evaluations(&mut many, &contact),
                kernel.time(&many, &contact),
            ]
        });
        println!(
            "{surface}: {} states of the impact in contact, {:.0} nodes carry force on average",
            contact.len(),
            kernel.mean_nodes()
        );
        println!("  evaluation without modes          {:8.2} us", zero * 1e6);
        println!(
            "  with {modes:3} modes of both gears      {:8.2} us; ratio {:.2} (bar 1.5)",
            full * 1e6,
            full / zero
        );
        println!(
            "  gather, products, factorisation   {:8.2} us; ratio {:.2} (bar 2)",
            bare * 1e6,
            beside / bare
        );
        if !apart.is_empty() {
            let times = (0..200).map(|_| evaluations(&mut many, &apart));
            println!(
                "  apart, with the modes             {:8.2} us",
                times.fold(f64::INFINITY, f64::min) * 1e6
            );
        }
    }
    let file = file("loaded_mesh");
    let mut lines = changed(&file, "elastic", |_| {});
    let [contact, _] = states(&mut lines, 0.2 * file.duration);
    let kernel = Kernel::new(&mut lines, &contact);
    let [evaluation, bare] = by_turns(
        &mut criterion,
        "evaluation, lines",
        "evaluation / kernel",
        || {
            [
                evaluations(&mut lines, &contact),
                kernel.time(&lines, &contact),
            ]
        },
    );
    let (mut out, mut walls) = (vec![], vec![]);
    for _ in 0..5 {
        let plan = TimePlan::new(0.2 * file.duration, Resolution::Step(STEP));
        let mut method = gearbench_integrators::table::TRIGONOMETRIC.build();
        let (_, work, wall) = run(&mut lines, method.as_mut(), &plan, &mut NullSink);
        walls.push(wall);
        out.push(work.steps);
    }
    let step = walls.iter().copied().fold(f64::INFINITY, f64::min) / out[0] as f64;
    println!(
        "lines on half-spaces: {} states under load, {:.1} lines carry force on average",
        contact.len(),
        kernel.mean_nodes()
    );
    println!(
        "  evaluation                        {:8.2} us; a whole step {:.2} us",
        evaluation * 1e6,
        step * 1e6
    );
    println!(
        "  gather, products, one solve       {:8.2} us; evaluation {:.1} times, step {:.1} times (bar 2.5)",
        bare * 1e6,
        evaluation / bare,
        step / bare
    );
}
