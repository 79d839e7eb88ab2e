//! Alternating integration of host and gears, and the energy balance between them.

use super::frames::{Frame, PrescribedScene};
use super::host::Hub;
use super::step_polynomial::{Extrapolation, Motion, StepPolynomial};
use crate::experiment::history::History;
use gearbench_integrators::system::{Change, Outputs, SecondOrderSystem, State};
use gearbench_integrators::{AcceptedStep, Control, Scheme, Sink, StepError, TimePlan, Work};
use gearbench_models::scene::Scene;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

/// Gauss-Legendre nodes and weights on [0, 1].
const GAUSS: [(f64, f64); 3] = [
    (0.112_701_665_379_258_31, 5.0 / 18.0),
    (0.5, 8.0 / 18.0),
    (0.887_298_334_620_741_7, 5.0 / 18.0),
];
/// Highest order of a method for which the power is evaluated at the ends of steps alone.
const BY_ENDS: u32 = 2;
/// Part of a communication step below which a remainder is merged with the last step.
const SLIVER: f64 = 1e-6;

/// Scheme of the coupling: extrapolation, interpolation and communication step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CouplingScheme {
    /// Extrapolation of the forces on the hubs in the host.
    pub extrapolation: Extrapolation,
    /// Interpolation of the motions of the hubs in the gears.
    pub motion: Motion,
    /// Communication step [s], the interval between exchanges.
    pub step: f64,
}

/// Bounds of a coupled run: end time, steps, processor time and energy error.
#[derive(Clone, Copy, Debug)]
pub struct Bounds<'a> {
    /// End of the simulated time [s].
    pub t_end: f64,
    /// True if contact events are located.
    pub events: bool,
    /// Largest number of steps of the gears, rejected ones included.
    pub max_steps: u64,
    /// Bound of processor time, if there is one.
    pub timeout: Option<Duration>,
    /// Energy error of the coupling at which the run is given up [J].
    pub hopeless: f64,
    /// The flag that ends the run.
    pub cancel: &'a AtomicBool,
}

/// Result of a run in two coupled parts, host and gears.
#[derive(Clone, Debug)]
pub struct CoupledRun {
    /// Displacements and velocities of the hubs at the end.
    pub hubs: Vec<[f64; 2]>,
    /// Energy error of the coupling [J]: work on the host minus work of the gears on their hubs.
    pub energy: f64,
    /// Largest magnitude of this energy in one communication step [J].
    pub largest: f64,
    /// Number of communication steps.
    pub exchanges: u64,
    /// Simulated time that was reached [s].
    pub reached: f64,
    /// Reason for the end of the run.
    pub end: End,
}

/// Reason for the end of a run in two parts.
#[derive(Clone, Debug, PartialEq)]
pub enum End {
    /// The end time was reached.
    Reached,
    /// The gears could not go on.
    Gears(StepError),
    /// A hub, or the energy, is no number or beyond all bounds.
    RanAway,
    /// The run exceeded its bound on processor time.
    Timeout,
}

/// Records a history, and the work that the gears give on their hubs.
struct HubWorkRecorder<'h> {
    history: &'h mut History,
    work: f64,
    out: Outputs,
    q: Vec<f64>,
    v: Vec<f64>,
}

impl HubWorkRecorder<'_> {
    fn power(
        &mut self,
        sys: &mut dyn SecondOrderSystem,
        at: gearbench_integrators::StateView<'_>,
    ) -> f64 {
        sys.output(at, &mut self.out);
        self.out.power.external
    }
}

impl Sink for HubWorkRecorder<'_> {
    fn accepted(&mut self, sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        self.history.accepted(sys, step);
        let h = step.to.t - step.from.t;
        if step.dense.order() <= BY_ENDS {
            let ends = self.power(sys, step.from.at()) + self.power(sys, step.to.at());
            self.work += 0.5 * h * ends;
            return Control::Continue;
        }
        let (mut q, mut v) = (std::mem::take(&mut self.q), std::mem::take(&mut self.v));
        q.resize(step.from.q.len(), 0.0);
        v.resize(step.from.q.len(), 0.0);
        for (theta, weight) in GAUSS {
            step.dense.eval(theta, &mut q, &mut v);
            let at = gearbench_integrators::StateView {
                t: step.from.t + theta * h,
                q: &q,
                v: &v,
                discrete: &step.from.discrete,
            };
            self.work += weight * h * self.power(sys, at);
        }
        (self.q, self.v) = (q, v);
        Control::Continue
    }

    fn restarted(&mut self, sys: &mut dyn SecondOrderSystem, before: &State, after: &State) {
        self.history.restarted(sys, before, after);
    }
}

/// Runs a scene in two coupled parts, host and gears.
pub fn exchange(
    scene: &mut Scene,
    frames: &[Frame],
    method: &Scheme,
    manner: CouplingScheme,
    bounds: Bounds<'_>,
    history: &mut History,
) -> CoupledRun {
    let begin = Instant::now();
    let mut s = scene.initial();
    let mut gears = PrescribedScene::new(scene, frames);
    let mut integrator = method.method.build();
    let mut given = HubWorkRecorder {
        history,
        work: 0.0,
        out: Outputs::default(),
        q: Vec::new(),
        v: Vec::new(),
    };
    let mut hubs: Vec<Hub<'_>> = (frames.iter())
        .map(|f| Hub::new(f, [f.mean(&s.q), f.mean(&s.v)]))
        .collect();
    let mut work = Work::default();
    let (mut forces, mut watched) = (Vec::new(), vec![0.0; gears.layout().event_functions]);
    (&mut gears as &mut dyn SecondOrderSystem).begin(&mut s, bounds.events);
    let mut found = CoupledRun {
        hubs: Vec::new(),
        energy: 0.0,
        largest: 0.0,
        exchanges: 0,
        reached: s.t,
        end: End::Reached,
    };
    while s.t < bounds.t_end {
        gears.forces(s.at(), &mut forces);
        for (hub, force) in hubs.iter_mut().zip(&forces) {
            hub.record_force(s.t, *force);
        }
        let from = s.t;
        let next = manner.step * (found.exchanges + 1) as f64;
        let to = match next < bounds.t_end - SLIVER * manner.step {
            true => next,
            false => bounds.t_end,
        };
        let mut taken = 0.0;
        for (i, hub) in hubs.iter_mut().enumerate() {
            let before = hub.at;
            taken += hub.advance([from, to], manner.extrapolation);
            let course = StepPolynomial::between(from, to - from, [before, hub.at], manner.motion);
            frames[i].move_to(&mut s.q, course.c[0]);
            frames[i].move_to(&mut s.v, course.c[1]);
            gears.courses[i] = course;
        }
        if !hubs.iter().flat_map(|h| h.at).all(f64::is_finite) {
            found.end = End::RanAway;
            break;
        }
        // A jump of the speed of a hub may end the branch of a damped contact where no event function falls.
        let sys: &mut dyn SecondOrderSystem = &mut gears;
        if bounds.events && !watched.is_empty() {
            sys.event_functions(s.at(), &mut watched);
            if watched.iter().any(|g| *g < 0.0) {
                sys.begin(&mut s, true);
            }
        }
        let plan = TimePlan {
            events: bounds.events,
            max_steps: bounds.max_steps.saturating_sub(work.steps + work.rejected),
            cancel: Some(bounds.cancel),
            ..TimePlan::new(to, method.resolution)
        };
        let before = given.work;
        if let Err(e) =
            integrator.resume(sys, &mut s, Change::Restart, &plan, &mut given, &mut work)
        {
            found.end = End::Gears(e);
            break;
        }
        for (hub, frame) in hubs.iter().zip(frames) {
            frame.move_to(&mut s.q, hub.at[0]);
            frame.move_to(&mut s.v, hub.at[1]);
        }
        found.exchanges += 1;
        found.reached = s.t;
        let error = taken - (given.work - before);
        found.energy += error;
        found.largest = found.largest.max(error.abs());
        let bounded = found.energy.is_finite() && found.energy.abs() <= bounds.hopeless;
        if !bounded {
            found.end = End::RanAway;
            break;
        }
        if bounds.timeout.is_some_and(|limit| begin.elapsed() > limit) {
            found.end = End::Timeout;
            break;
        }
    }
    if let Some(pieces) = &mut given.history.pieces {
        pieces.close();
    }
    found.hubs = hubs.iter().map(|h| h.at).collect();
    found
}
