//! Energy ledger: what went in, what was lost, what moving stiffness did, and what the integration made up.
//!
//! `E(t) - E(0) = W_external - W_dissipated + W_parametric + J + residual`. Powers are integrated over each
//! step by three-point Gauss quadrature on the method's interpolant; `J` books the jumps of energy where a
//! branch is switched. A step of flight is exact: what its energy loses beyond the work of loads is booked as
//! dissipated. The residual is the integration error (and that of the quadrature), in joule.

use crate::method::{AcceptedStep, Control, Sink};
use crate::system::{At, Energy, Outputs, SecondOrderSystem, State};

/// Gauss-Legendre nodes and weights on [0, 1].
const GAUSS: [(f64, f64); 3] = [
    (0.112_701_665_379_258_31, 5.0 / 18.0),
    (0.5, 8.0 / 18.0),
    (0.887_298_334_620_741_7, 5.0 / 18.0),
];

/// Steps of a system without powers between two looks at its energy.
const LOOK_EVERY: u32 = 16;

/// Accumulates the energy balance of a run.
#[derive(Clone, Debug, Default)]
pub struct Ledger {
    /// Energies at the start; set at the first step.
    pub start: Option<Energy>,
    /// Energies at the last accepted state.
    pub end: Energy,
    /// Work of loads and prescribed motions [J].
    pub external: f64,
    /// Energy lost to damping and friction [J].
    pub dissipated: f64,
    /// Work of stiffness that varies with position [J].
    pub parametric: f64,
    /// Jumps of energy at switches [J].
    pub jumps: f64,
    /// Largest total energy seen [J].
    pub peak: f64,
    q: Vec<f64>,
    v: Vec<f64>,
    out: Outputs,
    unseen: u32,
}

impl Ledger {
    /// Looks at the energy of the last state of a run.
    pub fn close(&mut self, sys: &mut dyn SecondOrderSystem, s: &State) {
        sys.output(s.at(), &mut self.out);
        self.end = self.out.energy;
        self.peak = self.peak.max(self.end.total());
        self.unseen = 0;
    }

    /// A step in which nothing touched, exact and maybe long beside the periods of what swings in it: a quadrature of
    /// its powers would only measure itself. The loads are steady, so their power follows the speeds of bodies, which
    /// are linear in time but for the swinging of modes at the hubs; what the energy tells beyond the work of loads is
    /// lost to damping, or, where nothing damps, is the rounding that the residual shows.
    fn fly(&mut self, sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) {
        let h = step.to.t - step.from.t;
        let (mut external, mut parametric, mut damped) = (0.0, 0.0, false);
        for (theta, weight) in GAUSS {
            step.dense.eval(theta, &mut self.q, &mut self.v);
            let at = At {
                t: step.from.t + theta * h,
                q: &self.q,
                v: &self.v,
                discrete: &step.from.discrete,
            };
            sys.output(at, &mut self.out);
            external += weight * h * self.out.power.external;
            parametric += weight * h * self.out.power.parametric;
            damped |= self.out.power.dissipated > 0.0;
        }
        // Where the system knows the work itself, no swinging spoils it.
        if let Some(work) = sys.steady_work(step.from.at(), step.to.at()) {
            (external, parametric) = (work, 0.0);
        }
        let before = self.end.total();
        sys.output(step.to.at(), &mut self.out);
        self.end = self.out.energy;
        self.peak = self.peak.max(self.end.total());
        self.external += external;
        self.parametric += parametric;
        if damped {
            self.dissipated += (before + external + parametric - self.end.total()).max(0.0);
        }
    }

    /// Energy that the balance does not explain [J].
    pub fn residual(&self) -> f64 {
        let start = self.start.unwrap_or_default().total();
        self.end.total() - start - self.external + self.dissipated - self.parametric - self.jumps
    }

    /// The residual over the largest energy that took part.
    pub fn residual_relative(&self) -> f64 {
        let scale = self
            .peak
            .max(self.external.abs())
            .max(self.dissipated.abs());
        if scale > 0.0 {
            self.residual() / scale
        } else {
            0.0
        }
    }
}

impl Sink for Ledger {
    fn accepted(&mut self, sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        let n = step.from.q.len();
        self.q.resize(n, 0.0);
        self.v.resize(n, 0.0);
        if self.start.is_none() {
            sys.output(step.from.at(), &mut self.out);
            self.start = Some(self.out.energy);
            self.end = self.out.energy;
            self.peak = self.out.energy.total();
        }
        if !sys.has_powers() {
            // Nothing to integrate; the end is looked at by [`Self::close`].
            self.unseen += 1;
            if self.unseen >= LOOK_EVERY {
                self.close(sys, step.to);
            }
            return Control::Continue;
        }
        let h = step.to.t - step.from.t;
        if step.flight {
            self.fly(sys, step);
            return Control::Continue;
        }
        for (theta, weight) in GAUSS {
            step.dense.eval(theta, &mut self.q, &mut self.v);
            let at = At {
                t: step.from.t + theta * h,
                q: &self.q,
                v: &self.v,
                discrete: &step.from.discrete,
            };
            sys.output(at, &mut self.out);
            self.external += weight * h * self.out.power.external;
            self.dissipated += weight * h * self.out.power.dissipated;
            self.parametric += weight * h * self.out.power.parametric;
        }
        sys.output(step.to.at(), &mut self.out);
        self.end = self.out.energy;
        self.peak = self.peak.max(self.end.total());
        Control::Continue
    }

    fn restarted(&mut self, sys: &mut dyn SecondOrderSystem, before: &State, after: &State) {
        sys.output(before.at(), &mut self.out);
        let e0 = self.out.energy.total();
        if self.start.is_none() {
            self.start = Some(self.out.energy);
            self.peak = e0;
        }
        sys.output(after.at(), &mut self.out);
        self.end = self.out.energy;
        self.jumps += self.end.total() - e0;
    }
}
