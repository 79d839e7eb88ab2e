//! Energy ledger: work of loads, dissipated energy, and the unexplained energy of a run.
//!
//! `E(t) - E(0) = W_external - W_dissipated + J + residual`. Powers are integrated over each step by a rule of the
//! order of the method: up to order two the trapezoidal rule on the states between steps, otherwise three-point Gauss
//! quadrature on the interpolant. A method with impulses at the ends of its steps (Verlet, trigonometric) dissipates
//! in a linear damper the work `h c v^2` at the velocity between both halves of an impulse, which is that of the
//! state: there the trapezoidal rule is the balance of the method itself, and each state is evaluated once, which
//! saves time where contact takes a solve. `J` is the sum of the jumps of energy at transitions of the branch. A step of flight is exact: its loss of energy
//! beyond the work of loads is booked as dissipated. The residual is the integration error (and that of the
//! quadrature), in joule.
//!
//! **Growth** is relative to the energy of vibration: a gear that rotates under load has a thousand times the energy
//! of its teeth, so that errors of the vibration would be invisible relative to the total. The unexplained energy (the
//! residual, and jumps at transitions beyond the dissipated energy) is divided by the largest energy of vibration,
//! that is strain, contact, and the relative motion of bodies ([`Rotation`]), plus the energy that the contacts have
//! stored since the start, of which an integrator may lose or generate a part.

use crate::method::{AcceptedStep, Control, Sink};
use crate::system::{Energy, Outputs, Power, SecondOrderSystem, State, StateView};

/// Gauss-Legendre nodes and weights on [0, 1].
const GAUSS: [(f64, f64); 3] = [
    (0.112_701_665_379_258_31, 5.0 / 18.0),
    (0.5, 8.0 / 18.0),
    (0.887_298_334_620_741_7, 5.0 / 18.0),
];

/// Highest order of a method for which powers are evaluated only between steps.
const BY_ENDS: u32 = 2;

/// Number of steps between two energy evaluations of a system without powers.
const LOOK_EVERY: u32 = 16;

/// Fraction of the total energy below which changes are indistinguishable from rounding.
const ROUNDING: f64 = 1e-9;

/// A body that takes part in a common rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Member {
    /// Index of the channel of its speed [rad/s or m/s].
    pub channel: usize,
    /// Inertia [kg m^2] or mass [kg] of the body.
    pub inertia: f64,
    /// Ratio of its speed to that of the common motion.
    pub ratio: f64,
    /// True if its motion is prescribed.
    pub held: bool,
}

/// Bodies that rotate together at fixed speed ratios, as gears in mesh do. Deviations from the ratios are vibration.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rotation {
    /// Bodies of the common motion.
    pub members: Vec<Member>,
}

impl Rotation {
    /// Returns the kinetic energy of the motion of the bodies relative to their common motion [J]. The common motion
    /// is the prescribed one, or otherwise that of their momentum.
    pub fn vibration(&self, channels: &[f64]) -> f64 {
        let speed = |m: &Member| channels.get(m.channel).copied().unwrap_or(0.0);
        let common = match self.members.iter().find(|m| m.held) {
            Some(lead) => speed(lead) / lead.ratio,
            None => {
                let (momentum, inertia) = self.members.iter().fold((0.0, 0.0), |(p, j), m| {
                    let weight = m.inertia * m.ratio;
                    (p + weight * speed(m), j + weight * m.ratio)
                });
                momentum / inertia
            }
        };
        let free = self.members.iter().filter(|m| !m.held);
        free.map(|m| 0.5 * m.inertia * (speed(m) - m.ratio * common).powi(2))
            .sum()
    }
}

/// Energy balance of a run.
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
    /// Jumps of energy at switches [J].
    pub jumps: f64,
    /// Sum of the positive jumps of energy at switches [J].
    pub gained: f64,
    /// Largest total energy of the run [J].
    pub peak: f64,
    /// Common rotations, which are not vibration.
    rotations: Vec<Rotation>,
    /// Largest energy of vibration in the run [J]: strain, contact, and relative motion of the bodies.
    pub vibration: f64,
    /// Energy that the contacts stored, summed over all increases [J].
    pub through_contact: f64,
    q: Vec<f64>,
    v: Vec<f64>,
    out: Outputs,
    unseen: u32,
    /// State of the last evaluation of powers, and these powers.
    known: Option<State>,
    powers: Power,
}

impl Ledger {
    /// Creates a ledger for bodies with common rotations.
    pub fn of(rotations: Vec<Rotation>) -> Self {
        Ledger {
            rotations,
            ..Ledger::default()
        }
    }

    /// Adds the energy of the last state of a run.
    pub fn close(&mut self, sys: &mut dyn SecondOrderSystem, s: &State) {
        sys.output(s.at(), &mut self.out);
        self.looked();
        self.unseen = 0;
    }

    /// Records the energies of the outputs as those of the last state.
    fn looked(&mut self) {
        let energy = self.out.energy;
        self.through_contact += (energy.contact - self.end.contact).max(0.0);
        self.end = energy;
        self.peak = self.peak.max(energy.total());
        let channels = &self.out.channels;
        let rotations = self.rotations.iter().map(|r| r.vibration(channels));
        let vibrating = energy.strain + energy.contact + rotations.sum::<f64>();
        self.vibration = self.vibration.max(vibrating);
    }

    /// Returns the energy that took part in vibration so far [J]: the largest energy of vibration plus the energy that
    /// the contacts stored.
    pub fn vibrating(&self) -> f64 {
        (self.vibration + self.through_contact).max(ROUNDING * self.peak)
    }

    /// Returns the energy that switches added beyond the dissipated energy [J].
    pub fn unpaid_jumps(&self) -> f64 {
        (self.jumps - self.dissipated).max(0.0)
    }

    /// Returns the growth: unexplained energy and unpaid jumps, relative to the energy of vibration.
    pub fn growth(&self) -> f64 {
        let scale = self.vibrating();
        let made_up = self.residual() + self.unpaid_jumps();
        if scale > 0.0 { made_up / scale } else { 0.0 }
    }

    /// Books a step without contact. The step is exact and may be long compared with the periods of its oscillators,
    /// so that a quadrature of powers would show its own error. The power of steady loads follows the speeds of
    /// bodies, which are linear in time except for vibration of modes at the hubs. The change of energy minus the work
    /// of loads is dissipation, or, without dampers, rounding.
    fn fly(&mut self, sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) {
        let h = step.to.t - step.from.t;
        let (mut external, mut damped) = (0.0, false);
        for (theta, weight) in GAUSS {
            step.dense.eval(theta, &mut self.q, &mut self.v);
            let at = StateView {
                t: step.from.t + theta * h,
                q: &self.q,
                v: &self.v,
                discrete: &step.from.discrete,
            };
            sys.output(at, &mut self.out);
            external += weight * h * self.out.power.external;
            damped |= self.out.power.dissipated > 0.0;
        }
        // Work that the system computes itself has no quadrature error from oscillations.
        if let Some(work) = sys.steady_work(step.from.at(), step.to.at()) {
            external = work;
        }
        let before = self.end.total();
        sys.output(step.to.at(), &mut self.out);
        self.looked();
        self.external += external;
        if damped {
            self.dissipated += (before + external - self.end.total()).max(0.0);
        }
    }

    /// Returns the unexplained energy [J].
    pub fn residual(&self) -> f64 {
        let start = self.start.unwrap_or_default().total();
        self.end.total() - start - self.external + self.dissipated - self.jumps
    }

    /// Stores the powers of the outputs as those of a state.
    fn know(&mut self, s: &State) {
        self.powers = self.out.power;
        match &mut self.known {
            Some(known) => known.copy_from(s),
            none => *none = Some(s.clone()),
        }
    }

    /// Books a step by the powers at both ends.
    fn between(&mut self, sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) {
        let half = 0.5 * (step.to.t - step.from.t);
        // Changes that were switched or committed since the last step act from here on.
        if self.known.as_ref() != Some(step.from) {
            sys.output(step.from.at(), &mut self.out);
            self.know(step.from);
        }
        let before = self.powers;
        sys.output(step.to.at(), &mut self.out);
        self.know(step.to);
        // A load on a hub works on its displacement: the speed at the ends tells little of modes that swing between.
        let loads = half * (before.loads + self.powers.loads);
        let external = half * (before.external + self.powers.external);
        let known = sys.work_of_loads(step.from.at(), step.to.at());
        self.external += known.map_or(external, |work| external - loads + work);
        self.dissipated += half * (before.dissipated + self.powers.dissipated);
        self.looked();
    }

    /// Returns the unexplained energy relative to the largest energy of the run.
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
            self.looked();
            self.know(step.from);
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
        if step.dense.order() <= BY_ENDS {
            self.between(sys, step);
            return Control::Continue;
        }
        for (theta, weight) in GAUSS {
            step.dense.eval(theta, &mut self.q, &mut self.v);
            let at = StateView {
                t: step.from.t + theta * h,
                q: &self.q,
                v: &self.v,
                discrete: &step.from.discrete,
            };
            sys.output(at, &mut self.out);
            self.external += weight * h * self.out.power.external;
            self.dissipated += weight * h * self.out.power.dissipated;
        }
        sys.output(step.to.at(), &mut self.out);
        self.looked();
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
        self.know(after);
        self.end = self.out.energy;
        let jump = self.end.total() - e0;
        self.jumps += jump;
        self.gained += jump.max(0.0);
    }
}
