//! Free flights: every method crosses them in one step of the closed-form motion of the system.

use crate::problems::*;
use gearbench_integrators::observers::ledger::Ledger;
use gearbench_integrators::{
    AcceptedStep, Control, METHODS, Method, Resolution, SecondOrderSystem, Sink, State, Stepping,
    TimePlan, Work,
};

/// Sink that counts flights, and records the largest error inside them and whether fixed steps end on their grid.
struct Flights {
    hammer: Hammer,
    step: Option<f64>,
    number: u32,
    worst: f64,
    off_grid: f64,
    ledger: Ledger,
}

impl Sink for Flights {
    fn accepted(&mut self, sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        if let Some(h) = self.step.filter(|_| step.flight) {
            let end = step.to.t / h;
            self.off_grid = self.off_grid.max((end - end.round()).abs());
        }
        if step.flight {
            self.number += 1;
            let mut here = step.to.clone();
            for i in 0..=8 {
                let theta = f64::from(i) / 8.0;
                step.dense.eval(theta, &mut here.q, &mut here.v);
                for k in 0..2 {
                    let t = theta * (step.to.t - step.from.t);
                    let q = step.from.q[k] + t * step.from.v[k];
                    self.worst = self.worst.max((here.q[k] - q).abs());
                }
            }
        }
        self.ledger.accepted(sys, step)
    }

    fn restarted(&mut self, sys: &mut dyn SecondOrderSystem, before: &State, after: &State) {
        self.ledger.restarted(sys, before, after);
    }
}

fn hammered(row: &Method, path: &str, events: bool, plan: &TimePlan<'_>) -> (f64, Work, Flights) {
    let mut hammer = Hammer::gears(0.05);
    let mut flights = Flights {
        hammer: hammer.clone(),
        step: match plan.resolution {
            Resolution::Step(h) => Some(h),
            Resolution::Tolerance(_) => None,
        },
        number: 0,
        worst: 0.0,
        off_grid: 0.0,
        ledger: Ledger::default(),
    };
    let plan = TimePlan { events, ..*plan };
    let (text, start) = (format!("{}{path}", row.info.id), hammer.start());
    let (s, work) = watch(&text, &mut hammer, start, &plan, &mut flights);
    (flights.hammer.error(&s), work, flights)
}

/// Free flights add no error and save most steps; they are exact inside, end on the grid, and the ledger closes.
#[test]
fn free_flights_are_exact_with_every_method() {
    for row in METHODS {
        let fixed = row.info.stepping != Stepping::Adaptive;
        let plan = if fixed {
            steps(0.05, 25_000.0)
        } else {
            tolerance(0.05, 1e-7)
        };
        let (off, slow, none) = hammered(row, "", true, &plan);
        let (on, fast, flights) = hammered(row, "(free_flight=1)", true, &plan);
        println!(
            "{:20} error {off:.1e} and {on:.1e}, {} and {} steps, {} and {} evaluations, {} flights",
            row.info.id,
            slow.steps,
            fast.steps,
            slow.force_evaluations,
            fast.force_evaluations,
            flights.number
        );
        assert!(on < 1.5 * off + 1e-7, "{}: {on:.1e} {off:.1e}", row.info.id);
        assert!(flights.number >= 4 && flights.worst < 1e-12);
        let residual = flights.ledger.residual_relative();
        assert!(residual.abs() < 1e-5, "{}: {residual:.1e}", row.info.id);
        if row.info.linear_part {
            assert_eq!((slow.steps, none.number), (fast.steps, flights.number));
            continue;
        }
        assert_eq!(none.number, 0);
        if fixed {
            assert!(flights.off_grid < 1e-6, "{:.1e}", flights.off_grid);
            assert!(5 * fast.steps < slow.steps, "{}", row.info.id);
        }
    }
}

/// Free flights are found without event location as well. Contact then opens and closes anywhere in a step, so that
/// errors scatter.
#[test]
fn free_flights_need_no_event_location() {
    for row in METHODS {
        let plan = if row.info.stepping == Stepping::Adaptive {
            tolerance(0.05, 1e-6)
        } else {
            steps(0.05, 50_000.0)
        };
        let (off, _, _) = hammered(row, "", false, &plan);
        let (on, work, flights) = hammered(row, "(free_flight=1)", false, &plan);
        println!(
            "{:20} error {off:.1e} and {on:.1e}, {} steps, {} flights",
            row.info.id, work.steps, flights.number
        );
        // Steps that have grown beyond what is left of a flight need not be one.
        let least = match plan.resolution {
            Resolution::Step(_) => 10,
            Resolution::Tolerance(_) => 1,
        };
        assert!(flights.number >= least, "{}", row.info.id);
        assert!(on < 3.0 * off, "{}: {on:.1e} {off:.1e}", row.info.id);
    }
}
