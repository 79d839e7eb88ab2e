//! Cost of a step of the full-order model compared with its lower bound: `cargo bench --bench full_order`.
//!
//! Case A fine, both gears, one impact. An explicit step cannot cost less than the product of both stiffness
//! matrices with a vector; an implicit one not less than two solves with both factors (the step without
//! contact, and the answer to its forces). Product or solve follows every step of the run, so that both see the same
//! machine; the medians of a run are compared.

mod support;

use faer::sparse::SparseColMat;
use gearbench_integrators::system::SecondOrderSystem;
use gearbench_integrators::{AcceptedStep, Control, Resolution, Sink, TimePlan, Work};
use gearbench_models::stiffness::Material;
use gearbench_reference::assembly::tie::{HubMotion, MassKind, Reduced, Tie};
use gearbench_reference::assembly::{Assembly, assemble};
use gearbench_reference::solve::Cholesky;
use gearbench_reference::{deck, gear_deck, reference};
use std::hint::black_box;
use std::time::Instant;
use support::ratio::{Ratios, by_turns, median, ratios, seconds};
use support::scenes::{built, file, method, run};

/// Returns `m + k` on the pattern of both (that of the stiffness includes that of the mass).
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

/// Times of steps, and of the work that bounds them, in alternation.
struct Clock<'b> {
    bound: &'b mut dyn FnMut(),
    last: Instant,
    steps: Vec<f64>,
    bounds: Vec<f64>,
}

impl Sink for Clock<'_> {
    fn accepted(&mut self, _sys: &mut dyn SecondOrderSystem, _step: &AcceptedStep<'_>) -> Control {
        self.steps.push(self.last.elapsed().as_secs_f64());
        self.bounds.push(seconds(&mut self.bound));
        self.last = Instant::now();
        Control::Continue
    }
}

/// Returns median times of a step and of its bound, the work of a run through the impact, and the number of
/// coordinates.
fn compare(
    criterion: &mut Ratios,
    label: &str,
    text: &str,
    h: f64,
    bound: &mut dyn FnMut(),
) -> ([f64; 2], Work, usize) {
    let file = file("spur_impact");
    let mut scene = built(&file, label, &[]);
    let plan = TimePlan::new(file.duration, Resolution::Step(h));
    let mut work = Work::default();
    let times = by_turns(criterion, "step / bound", text, || {
        let mut clock = Clock {
            bound,
            last: Instant::now(),
            steps: vec![],
            bounds: vec![],
        };
        work = run(&mut scene, method(text).as_mut(), &plan, &mut clock).1;
        [median(clock.steps), median(clock.bounds)]
    });
    (times, work, scene.layout().n)
}

#[allow(clippy::print_stdout)]
fn main() {
    let external = reference("calculix/case-a-fine").unwrap();
    let decks = gear_deck::gears(&deck::read_bytes("case A", external.deck).unwrap()).unwrap();
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
        for (a, (x, y)) in assemblies.iter().zip(&mut vectors) {
            a.stiffness.apply(black_box(x), y);
        }
    };
    let mut factors = factors;
    let mut right: Vec<Vec<f64>> = factors.iter().map(|f| vec![1.0; f.unknowns()]).collect();
    let mut solves = || {
        for (f, x) in factors.iter_mut().zip(&mut right) {
            for _ in 0..2 {
                x.fill(1.0);
                f.solve(black_box(x));
            }
        }
    };
    let mut criterion = ratios(10.0);
    let ([explicit, product], kicks, n) = compare(
        &mut criterion,
        "fe-lumped",
        "velocity-verlet",
        3e-8,
        &mut products,
    );
    let ([implicit, solves], newton, _) = compare(
        &mut criterion,
        "fe",
        "hht-alpha(alpha=0.05)",
        h,
        &mut solves,
    );
    println!("full-order case A fine, {n} coordinates");
    println!(
        "explicit step (velocity Verlet)  {:8.1} us; product of both gears {:8.1} us; ratio {:.2}",
        explicit * 1e6,
        product * 1e6,
        explicit / product
    );
    println!(
        "implicit step (HHT-alpha)        {:8.1} us; two solves of both gears {:8.1} us; ratio {:.2}",
        implicit * 1e6,
        solves * 1e6,
        implicit / solves
    );
    println!(
        "Newton iterations per implicit step {:.2}; whole impact: explicit {:.2} s, implicit {:.2} s; CalculiX took {:.0} s of processor time",
        newton.newton_iterations as f64 / newton.steps as f64,
        explicit * kicks.steps as f64,
        implicit * newton.steps as f64,
        external.summary.cpu_s
    );
}
