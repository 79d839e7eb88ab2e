//! What a step of the full-order model costs beside what bounds it: `cargo bench -p gearbench --bench full_order`.
//!
//! Case A fine, both gears, one impact. An explicit step cannot cost less than the product of both stiffness
//! matrices with a vector; an implicit one not less than two solves with both factors (the step without
//! contact, and the answer to its forces). Products and solves are timed in the same run, before and after.

use faer::sparse::SparseColMat;
use gearbench::scene_file;
use gearbench_integrators::system::SecondOrderSystem;
use gearbench_integrators::{AcceptedStep, Control, Resolution, Sink, TimePlan, Work};
use gearbench_models::scene::Scene;
use gearbench_models::stiffness::Material;
use gearbench_reference::assembly::tie::{HubMotion, MassKind, Reduced, Tie};
use gearbench_reference::assembly::{Assembly, assemble};
use gearbench_reference::solve::Cholesky;
use gearbench_reference::{deck, reference};
use std::hint::black_box;
use std::time::Instant;

const REPEATS: usize = 30;

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

fn scene(label: &str) -> (Scene, f64) {
    let file = scene_file::load("spur_impact").unwrap_or_else(|e| panic!("{e:?}"));
    let choice = file.model(label).unwrap();
    let built = Scene::build(
        &file.spec_for(choice),
        &choice.modelling,
        gearbench::models::models(),
    );
    (built.unwrap(), file.duration)
}

/// `m + k` on the pattern of both (that of the stiffness holds the mass's).
fn newton(r: &Reduced, k: f64) -> SparseColMat<usize, f64> {
    let mut sum = r.stiffness.clone();
    for x in sum.val_mut() {
        *x *= k;
    }
    for j in 0..r.mass.ncols() {
        for (i, m) in r.mass.row_idx_of_col(j).zip(r.mass.val_of_col(j)) {
            if let Some(x) = sum.get_mut(i, j) {
                *x += m;
            }
        }
    }
    sum
}

struct Run {
    per_step: f64,
    work: Work,
}

/// Notes when steps end: the median of their times is that of the solver, whatever else runs on the machine.
struct Clock(Vec<Instant>);

impl Sink for Clock {
    fn accepted(&mut self, _sys: &mut dyn SecondOrderSystem, _step: &AcceptedStep<'_>) -> Control {
        self.0.push(Instant::now());
        Control::Continue
    }
}

/// Integrates through the impact; the median time of a step.
fn run(label: &str, method: &str, h: f64) -> (Run, usize) {
    let (mut scene, end) = scene(label);
    let mut method = gearbench_integrators::method(method).unwrap();
    let mut state = scene.initial();
    let mut work = Work::default();
    let mut clock = Clock(vec![Instant::now()]);
    method
        .run(
            &mut scene,
            &mut state,
            &TimePlan::new(end, Resolution::Step(h)),
            &mut clock,
            &mut work,
        )
        .unwrap();
    let steps = clock.0.windows(2).map(|w| (w[1] - w[0]).as_secs_f64());
    let per_step = median(steps.collect());
    (Run { per_step, work }, scene.layout().n)
}

#[allow(clippy::print_stdout)]
fn main() {
    let external = reference("calculix/case-a-fine").unwrap();
    let decks = deck::gears(&deck::read_bytes("case A", external.deck).unwrap()).unwrap();
    let assemblies: Vec<Assembly> = decks
        .iter()
        .map(|g| assemble(&g.mesh.mesh, &Material::STEEL).unwrap())
        .collect();
    let h = 5e-7;
    let factors: Vec<Cholesky> = decks
        .iter()
        .zip(&assemblies)
        .map(|(g, a)| {
            let tie = Tie::new(&g.mesh.mesh.nodes, &g.mesh.bore, &[HubMotion::Turn]);
            let reduced = tie.reduce(a, &[0.0], MassKind::Consistent);
            Cholesky::new(newton(&reduced, 0.25 * h * h).as_ref()).unwrap()
        })
        .collect();
    let mut vectors: Vec<(Vec<f64>, Vec<f64>)> = assemblies
        .iter()
        .map(|a| {
            let n = 3 * a.lumped.len();
            ((0..n).map(|i| (i as f64).sin()).collect(), vec![0.0; n])
        })
        .collect();
    let mut products = || {
        let times = (0..REPEATS).map(|_| {
            let begin = Instant::now();
            for (a, (x, y)) in assemblies.iter().zip(&mut vectors) {
                a.stiffness.apply(black_box(x), y);
            }
            begin.elapsed().as_secs_f64()
        });
        median(times.collect())
    };
    let mut factors = factors;
    let mut right: Vec<Vec<f64>> = factors.iter().map(|f| vec![1.0; f.unknowns()]).collect();
    let mut solves = || {
        let times = (0..REPEATS).map(|_| {
            let begin = Instant::now();
            for (f, x) in factors.iter_mut().zip(&mut right) {
                x.fill(1.0);
                f.solve(black_box(x));
            }
            begin.elapsed().as_secs_f64()
        });
        median(times.collect())
    };

    let before = products();
    let (explicit, n) = run("fe-lumped", "velocity-verlet", 3e-8);
    let product = 0.5 * (before + products());
    let before = solves();
    let (implicit, _) = run("fe", "hht-alpha(alpha=0.05)", h);
    let solve = 0.5 * (before + solves());

    println!("full-order case A fine, {n} coordinates");
    println!(
        "explicit step (velocity Verlet)  {:8.1} us; product of both gears {:8.1} us; ratio {:.2}",
        explicit.per_step * 1e6,
        product * 1e6,
        explicit.per_step / product
    );
    println!(
        "implicit step (HHT-alpha)        {:8.1} us; two solves of both gears {:8.1} us; ratio {:.2}",
        implicit.per_step * 1e6,
        2.0 * solve * 1e6,
        implicit.per_step / (2.0 * solve)
    );
    println!(
        "Newton iterations per implicit step {:.2}; whole impact: explicit {:.2} s, implicit {:.2} s; CalculiX took {:.0} s of processor time",
        implicit.work.newton_iterations as f64 / implicit.work.steps as f64,
        explicit.per_step * explicit.work.steps as f64,
        implicit.per_step * implicit.work.steps as f64,
        external.summary.cpu_s
    );
}
