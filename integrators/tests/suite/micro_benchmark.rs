//! Time per step, for reading: `cargo test --release -p gearbench-integrators -- --ignored --nocapture
//! time_per_step`.

use crate::problems::*;
use crate::split_off;
use gearbench_integrators::{
    At, Change, Events, Layout, METHODS, Method, ModalSplit, SecondOrderSystem, State, Stepping,
    TimePlan, Work,
};
use std::time::Instant;

/// Least time of five runs, per accepted step [ns], and the work of one.
fn time(
    m: &Method,
    mut sys: impl FnMut() -> Box<dyn SecondOrderSystem>,
    s: &State,
    plan: &TimePlan<'_>,
) -> (f64, Work) {
    let mut best = f64::INFINITY;
    let mut work = Work::default();
    for _ in 0..5 {
        let mut sys = sys();
        let now = Instant::now();
        work = solve(m, &mut *sys, s.clone(), plan).1;
        best = best.min(now.elapsed().as_secs_f64());
    }
    (best / work.steps as f64 * 1e9, work)
}

#[test]
#[ignore = "measures time"]
fn time_per_step() {
    println!("ns per step (force evaluations per step)");
    println!(
        "{:20} {:>16} {:>16} {:>22}",
        "", "chain, n = 2", "chain, n = 10", "24 impacts: us, ns/step"
    );
    for m in METHODS {
        let adaptive = m.info.stepping == Stepping::Adaptive;
        print!("{:20}", m.info.id);
        for n in [2, 10] {
            let chain = || {
                Box::new(Chain {
                    masses: vec![1.0; n],
                    damping: 0.1,
                }) as Box<dyn SecondOrderSystem>
            };
            let mut s = state(&vec![0.0; n], &vec![0.0; n]);
            s.q[0] = -0.3;
            let plan = if adaptive {
                tolerance(100.0, 1e-6)
            } else {
                steps(100.0, 10_000.0)
            };
            let (ns, work) = time(m, chain, &s, &plan);
            let f = work.force_evaluations as f64 / work.steps as f64;
            print!(" {ns:9.1} ({f:4.1})");
        }
        let hammer = Hammer::gears(0.05);
        let plan = if m.info.stepping == Stepping::Fixed {
            steps(0.25, 25_000.0)
        } else {
            tolerance(0.25, 1e-6)
        };
        let (ns, work) = time(m, || Box::new(hammer.clone()), &hammer.start(), &plan);
        println!(" {:11.1} {ns:10.1}", ns * work.steps as f64 * 1e-3);
    }
}

/// A chain that asks for a restart after every step.
struct Restarting(Chain);

impl SecondOrderSystem for Restarting {
    fn layout(&self) -> Layout {
        self.0.layout()
    }
    fn scales(&self, q: &mut [f64], v: &mut [f64]) {
        self.0.scales(q, v);
    }
    fn pace(&self, at: At<'_>) -> f64 {
        self.0.pace(at)
    }
    fn modal(&mut self) -> Option<&mut dyn ModalSplit> {
        Some(self)
    }
    fn force(&mut self, at: At<'_>, f: &mut [f64]) {
        self.0.force(at, f);
    }
    fn solve_mass(&mut self, at: At<'_>, f: &mut [f64]) {
        self.0.solve_mass(at, f);
    }
    fn apply_mass(&mut self, at: At<'_>, x: &[f64], y: &mut [f64]) {
        self.0.apply_mass(at, x, y);
    }
    fn tangent_times(&mut self, at: At<'_>, dq: &[f64], dv: &[f64], df: &mut [f64]) {
        self.0.tangent_times(at, dq, dv, df);
    }
    fn events(&mut self) -> Option<&mut dyn Events> {
        Some(self)
    }
}

impl Events for Restarting {
    fn commit(&mut self, _s: &mut State) -> Change {
        Change::Restart
    }
}

split_off!(Restarting, |_own, _i| (0.0, 0.0));

#[test]
#[ignore = "measures time"]
fn time_per_restart() {
    for m in METHODS {
        let chain = || Chain {
            masses: vec![1.0; 2],
            damping: 0.1,
        };
        let s = state(&[-0.3, 0.0], &[0.0, 0.0]);
        let plan = if m.info.stepping == Stepping::Adaptive {
            tolerance(20.0, 1e-6)
        } else {
            steps(20.0, 2000.0)
        };
        let (plain, _) = time(m, || Box::new(chain()), &s, &plan);
        let (restarting, _) = time(m, || Box::new(Restarting(chain())), &s, &plan);
        println!("{:20} {:9.1} ns per restart", m.info.id, restarting - plain);
    }
}
