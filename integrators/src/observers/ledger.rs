//! Energy ledger: what went in, what was lost, and what the integration made up.
//!
//! `E(t) - E(0) = W_external - W_dissipated + J + residual`. Powers are integrated over each step by a rule of the order
//! of the method: up to order two the trapezoidal rule on the states between steps, else three-point Gauss quadrature on
//! the interpolant. A method that kicks at the ends of its steps (Verlet, trigonometric) takes from a linear damper the
//! work `h c v^2` at the velocity between both halves of a kick, which is that of the state: there the trapezoidal rule is
//! the method's own balance, and each state is evaluated once, which counts where contact takes a solve. Damped oscillators in
//! closed form lose part of each half kick within the step, and have a velocity at the ends of steps even where they rest
//! under a steady force. The method takes that velocity out of the rule
//! ([`Dense::damping_beyond_trapezoid`](crate::method::Dense::damping_beyond_trapezoid)). `J` books the
//! jumps of energy where a branch is switched. A step of flight is exact: what its energy loses beyond the work of loads is booked as
//! dissipated. The residual is the integration error (and that of the quadrature), in joule.
//!
//! **Growth** is judged by what vibrates: a gear that turns under load carries a thousand times the energy of its teeth,
//! and nothing that these make up would show beside it. What no load paid for (the residual, and what switches brought
//! in beyond what damping took) is held against the largest energy of vibration seen, that is strain, contact, and the motion
//! of bodies against each other ([`Rotation`]), and what the contacts took up since the start: energy that passed through
//! them, of which an integrator may lose or make a part.

use crate::method::{AcceptedStep, Control, Sink};
use crate::system::{At, Energy, Outputs, Power, SecondOrderSystem, State};

/// Gauss-Legendre nodes and weights on [0, 1].
const GAUSS: [(f64, f64); 3] = [
    (0.112_701_665_379_258_31, 5.0 / 18.0),
    (0.5, 8.0 / 18.0),
    (0.887_298_334_620_741_7, 5.0 / 18.0),
];

/// Order of a method up to which powers are looked at between steps alone.
const BY_ENDS: u32 = 2;

/// Steps of a system without powers between two looks at its energy.
const LOOK_EVERY: u32 = 16;

/// Part of the total energy below which nothing is told from rounding.
const ROUNDING: f64 = 1e-9;

/// A body in a common motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Member {
    /// Channel of its speed [rad/s] or [m/s].
    pub channel: usize,
    /// Its inertia [kg m^2] or mass [kg].
    pub inertia: f64,
    /// Its speed by unit speed of the common motion.
    pub ratio: f64,
    /// Its motion is prescribed.
    pub held: bool,
}

/// Bodies that turn together as gears in mesh do: speeds in fixed ratios. What they deviate from that is vibration.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rotation {
    /// The bodies.
    pub members: Vec<Member>,
}

impl Rotation {
    /// Kinetic energy of the motion of the bodies against each other [J]: about that of their prescribed motion, else
    /// about the common one of their momentum.
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
    /// Jumps of energy at switches [J].
    pub jumps: f64,
    /// Those of them that brought energy in [J].
    pub gained: f64,
    /// Largest total energy seen [J].
    pub peak: f64,
    /// Motions that are no vibration.
    rotations: Vec<Rotation>,
    /// Largest energy of vibration seen: strain, contact, and motion of bodies against each other [J].
    pub vibration: f64,
    /// What the contacts took up [J].
    pub through_contact: f64,
    q: Vec<f64>,
    v: Vec<f64>,
    out: Outputs,
    unseen: u32,
    /// The state whose powers are known, and these.
    known: Option<State>,
    powers: Power,
}

impl Ledger {
    /// One of bodies that turn together.
    pub fn of(rotations: Vec<Rotation>) -> Self {
        Ledger {
            rotations,
            ..Ledger::default()
        }
    }

    /// Looks at the energy of the last state of a run.
    pub fn close(&mut self, sys: &mut dyn SecondOrderSystem, s: &State) {
        sys.output(s.at(), &mut self.out);
        self.looked();
        self.unseen = 0;
    }

    /// Takes the energies of the outputs as those of the last state.
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

    /// Energy that took part in vibration so far [J]: the largest there was at a time, and what passed through contacts.
    pub fn vibrating(&self) -> f64 {
        (self.vibration + self.through_contact).max(ROUNDING * self.peak)
    }

    /// What switches brought in beyond what they and damping took [J].
    pub fn unpaid_jumps(&self) -> f64 {
        (self.jumps - self.dissipated).max(0.0)
    }

    /// What nothing paid for over what vibrated.
    pub fn growth(&self) -> f64 {
        let scale = self.vibrating();
        let made_up = self.residual() + self.unpaid_jumps();
        if scale > 0.0 { made_up / scale } else { 0.0 }
    }

    /// A step in which nothing touched, exact and maybe long beside the periods of what swings in it: a quadrature of
    /// its powers would only measure itself. The loads are steady, so their power follows the speeds of bodies, which
    /// are linear in time but for the swinging of modes at the hubs; what the energy tells beyond the work of loads is
    /// lost to damping, or, where nothing damps, is the rounding that the residual shows.
    fn fly(&mut self, sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) {
        let h = step.to.t - step.from.t;
        let (mut external, mut damped) = (0.0, false);
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
            damped |= self.out.power.dissipated > 0.0;
        }
        // Where the system knows the work itself, no swinging spoils it.
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

    /// Energy that the balance does not explain [J].
    pub fn residual(&self) -> f64 {
        let start = self.start.unwrap_or_default().total();
        self.end.total() - start - self.external + self.dissipated - self.jumps
    }

    /// Keeps the powers of the outputs as those of a state.
    fn know(&mut self, s: &State) {
        self.powers = self.out.power;
        match &mut self.known {
            Some(known) => known.copy_from(s),
            none => *none = Some(s.clone()),
        }
    }

    /// A step by the powers at both ends.
    fn between(&mut self, sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) {
        let half = 0.5 * (step.to.t - step.from.t);
        // What was switched or committed since the last step acts from here on.
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
        if self.powers.dissipated != 0.0 && step.dense.damping_beyond_trapezoid(&mut self.q) {
            sys.apply_mass(step.to.at(), &self.q, &mut self.v);
            self.dissipated += self.v.iter().sum::<f64>();
        }
        self.looked();
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
            let at = At {
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
