//! What a step of the elastic model costs beside what bounds it: `cargo bench -p gearbench --bench elastic_step`.
//!
//! Case A fine, one impact, steps of a microsecond. The states of the impact are taken from a run; all evaluations
//! then take turns on the same states, so that ratios are those of one machine in one mood. The kernel does nothing but
//! what no solve on nodes can do without: it gathers the residual compliance of the nodes that carry force, multiplies
//! their shapes with the modes both ways, and factorises one dense matrix of their number.

use gearbench::scene_file;
use gearbench_integrators::system::{SecondOrderSystem, State};
use gearbench_integrators::{AcceptedStep, Control, Resolution, Sink, TimePlan, Work};
use gearbench_models::scene::Scene;
use gearbench_models::spec::Value;
use nalgebra::DMatrix;
use std::hint::black_box;
use std::time::Instant;

const REPEATS: usize = 200;
const STEP: f64 = 1e-6;

/// The scene of the finite elements with elastic gears in their place.
fn scene(modes: f64, surface: &str) -> (Scene, f64) {
    let file = scene_file::load("spur_impact").unwrap_or_else(|e| panic!("{e:?}"));
    let choice = file.model("fe").unwrap();
    let mut modelling = choice.modelling.clone();
    for gear in &mut modelling.gears {
        gear.id = "elastic".into();
        let mut set = |key: &str, value| gear.parameters.insert(key.into(), value);
        set("modes", Value::Number(modes));
        // All 200 modes are wanted, whatever their frequency.
        set("step_s", Value::Number(2e-7));
    }
    for contact in &mut modelling.contacts {
        if let Some(points) = &mut contact.points
            && surface == "smooth"
        {
            points.surface = gearbench_models::spec::SurfaceKind::Smooth;
        }
    }
    let built = Scene::build(
        &file.spec_for(choice),
        &modelling,
        gearbench::models::models(),
    );
    (built.unwrap_or_else(|e| panic!("{e}")), file.duration)
}

/// Keeps the states of a run.
struct States(Vec<State>);

impl Sink for States {
    fn accepted(&mut self, _sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        self.0.push(step.to.clone());
        Control::Continue
    }
}

/// States of the impact in contact and apart.
fn states(scene: &mut Scene, end: f64) -> [Vec<State>; 2] {
    let mut method = gearbench_integrators::table::TRIGONOMETRIC.build();
    let mut state = scene.initial();
    let mut sink = States(vec![]);
    method
        .run(
            scene,
            &mut state,
            &TimePlan::new(end, Resolution::Step(STEP)),
            &mut sink,
            &mut Work::default(),
        )
        .unwrap();
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

/// Least time per state of so many repeats.
fn least(count: usize, mut all: impl FnMut()) -> f64 {
    let times = (0..REPEATS).map(|_| {
        let begin = Instant::now();
        all();
        begin.elapsed().as_secs_f64()
    });
    times.fold(f64::INFINITY, f64::min) / count.max(1) as f64
}

/// Time of the kernel per state, and the mean number of nodes.
fn kernel(scene: &mut Scene, states: &[State]) -> (f64, f64) {
    let mut nodes = vec![];
    for s in states {
        let mut f = vec![0.0; s.q.len()];
        scene.force(s.at(), &mut f);
        nodes.push([0, 1].map(|g| scene.pressed_nodes(g)));
    }
    let n = |of: &[Vec<u32>; 2]| of[0].len() + of[1].len();
    let mean = nodes.iter().map(n).sum::<usize>() as f64 / nodes.len() as f64;
    let mut f = vec![0.0; states[0].q.len()];
    let (mut a, mut r) = ([0.0; 256], vec![0.0; 256 * 256]);
    let matrices: Vec<DMatrix<f64>> = (0..=256)
        .map(|n| DMatrix::from_fn(n, n, |i, j| if i == j { n as f64 + 1.0 } else { 1.0 }))
        .collect();
    let time = least(states.len(), || {
        for (s, nodes) in states.iter().zip(&nodes) {
            for (g, nodes) in scene.gears().iter().zip(nodes) {
                let (field, range) = (g.model.displacement().unwrap(), g.range());
                let count = nodes.len();
                field.compliance(nodes, &mut r[..count * count]);
                field.displacements(&s.q[range.clone()], nodes, &mut a[..count]);
                field.apply_nodal_forces(nodes, &a[..count], &mut f[range]);
            }
            black_box(matrices[n(nodes)].clone().cholesky());
        }
        black_box((&f, &r));
    });
    (time, mean)
}

#[allow(clippy::print_stdout)]
fn main() {
    for surface in ["faceted", "smooth"] {
        let (mut none, end) = scene(0.0, surface);
        let (mut many, _) = scene(200.0, surface);
        let [quasi_static, _] = states(&mut none, end);
        let [contact, apart] = states(&mut many, end);
        let modes = many.layout().n - 2;
        let time = |scene: &mut Scene, states: &[State]| {
            let mut a = vec![0.0; scene.layout().n];
            least(states.len(), || {
                for s in states {
                    let split = scene.modal().unwrap();
                    split.remainder(black_box(s.at()), &mut a);
                }
            })
        };
        // By turns.
        let (mut zero, mut full, mut bare, mut flight) =
            (f64::INFINITY, f64::INFINITY, f64::INFINITY, f64::INFINITY);
        let mut nodes = 0.0;
        for _ in 0..3 {
            zero = zero.min(time(&mut none, &quasi_static));
            full = full.min(time(&mut many, &contact));
            let (t, n) = kernel(&mut many, &contact);
            (bare, nodes) = (bare.min(t), n);
            if !apart.is_empty() {
                flight = flight.min(time(&mut many, &apart));
            }
        }
        println!(
            "{surface}: {} states of the impact in contact, {nodes:.0} nodes carry force on average",
            contact.len()
        );
        println!("  evaluation without modes          {:8.2} us", zero * 1e6);
        println!(
            "  with {:3} modes of both gears      {:8.2} us; ratio {:.2} (bar 1.5)",
            modes,
            full * 1e6,
            full / zero
        );
        println!(
            "  gather, products, factorisation   {:8.2} us; ratio {:.2} (bar 2)",
            bare * 1e6,
            full / bare
        );
        if flight.is_finite() {
            println!(
                "  apart, with the modes             {:8.2} us",
                flight * 1e6
            );
        }
    }
}
