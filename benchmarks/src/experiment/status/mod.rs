//! Status of a run: one label for every kind of failure, with time, magnitude and advice.
//!
//! | label | condition |
//! |---|---|
//! | newton failure | Newton's method did not converge, its matrix was singular, or the solver of a library failed |
//! | step underflow | the tolerance required steps below the resolution of time |
//! | chatter | contacts open and close at one instant without end |
//! | timeout | the bound of processor time of the run with its recording, or of steps, was reached |
//! | blow-up | a coordinate or an energy is not finite, or the energy has grown [`BLOWN_UP`]-fold |
//! | energy growth | unexplained energy at the end ([`ENERGY_GROWTH`], [`Ledger::growth`]), or earlier ([`HOPELESS`]) |
//! | tunnelling | teeth passed through each other, or overlapped without a force, or a step passed over a contact |
//! | adhesive force | a contact pulled |
//! | inaccurate | the error exceeds the tolerance of the scene, or [`OWN_ERROR`] against the converged solution |
//! | converged | the error is within the tolerance of the scene, or within [`OWN_ERROR`] of the converged solution |
//! | unchecked | none of these, and no comparison; the method's own tolerance is no comparison |
//!
//! Errors of the integrator ([`status_of`]) have priority. Findings of the [`RunMonitor`] over the whole run come next:
//! the first one sets the status, as later ones are its consequences. Results of comparisons come last
//! ([`against_contact`], [`judge`]).

mod accuracy;
mod tunnelling;

use super::history::History;
use gearbench_integrators::observers::ledger::{Ledger, Member, Rotation};
use gearbench_integrators::{
    AcceptedStep, Control, Resolution, SecondOrderSystem, Sink, State, StepError, TimePlan,
};
use gearbench_models::scene::{Channel, OfGear, OfMesh, Scene};
use gearbench_models::spec::{SceneSpec, signed_base_radius};
use gearbench_reports::numbers::short;
use gearbench_reports::record::Status;
use std::time::{Duration, Instant};

pub use accuracy::{OWN_ERROR, against_contact, judge};
pub use tunnelling::TunnellingDetector;

/// Unexplained energy, relative to the largest energy, above which a run counts as growing.
pub const ENERGY_GROWTH: f64 = 0.02;
/// Unexplained energy, relative to the largest energy, above which a run is stopped.
pub const HOPELESS: f64 = 0.5;
/// Energy, relative to the energy supplied by start and loads, above which a stopped run counts as blown up.
pub const BLOWN_UP: f64 = 1e3;
/// Tensile contact force, relative to the peak force, from which on a run counts as adhesive. The interpolant of a
/// coarse step may be slightly negative just before the contact opens; the force law itself never is.
const ADHESION: f64 = 1e-3;

/// The status of a run that ended with an integration error. [`StepError::Unsupported`] and [`StepError::Interrupted`]
/// are refusals, not statuses: [`run`](super::run::run) returns them as errors.
pub fn status_of(e: &StepError) -> Status {
    match e {
        // What a library's solver gives up on without a reason of its own are its implicit equations.
        StepError::NewtonDiverged { .. }
        | StepError::SingularTangent { .. }
        | StepError::Library { .. }
        | StepError::Unsupported { .. } => Status::NewtonFailure,
        StepError::NonFinite { .. } => Status::BlowUp,
        StepError::StepTooSmall { .. } => Status::StepUnderflow,
        StepError::Chatter { .. } => Status::Chatter,
        StepError::Timeout { .. } | StepError::Interrupted { .. } => Status::Timeout,
    }
}

/// The message of an integration error with advice; a method with a `fixed` step has no tolerance to loosen.
pub fn message_of(e: &StepError, fixed: bool) -> String {
    match e {
        StepError::NewtonDiverged { t, h, residual, .. } if !residual.is_finite() => format!(
            "Newton's method failed at t = {t:.6e} s down to a step of {h:.3e} s; use a smaller tolerance, or an explicit method"
        ),
        StepError::SingularTangent { .. } => {
            format!("{e}; use another step, or an explicit method")
        }
        StepError::StepTooSmall { t, h } if fixed => {
            format!(
                "a step of {h:.3e} s at t = {t:.6e} s does not advance the time; use a larger step"
            )
        }
        StepError::StepTooSmall { .. } => {
            format!("{e}; loosen it, locate events, or use a fixed step")
        }
        StepError::Chatter { .. } => {
            format!("{e}; add damping to the contact, or run without locating events")
        }
        StepError::Timeout { .. } => {
            format!("{e}; raise it, or use larger steps or another method")
        }
        StepError::Library { .. } => format!("{e}; use another method"),
        other => other.to_string(),
    }
}

/// A failure or defect of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// Time of the finding [s].
    pub time: f64,
    /// Status of the run that the finding causes.
    pub status: Status,
    /// Message with time, magnitude and advice.
    pub message: String,
}

/// Monitor of a run: records history and energy, and stops the run once most of its energy is unexplained, as an
/// unstable run would otherwise continue to ever larger numbers and ever more impacts.
pub struct RunMonitor {
    /// Recorded channels over time.
    pub history: History,
    /// Energy balance of the run.
    pub ledger: Ledger,
    tunnelling: TunnellingDetector,
    /// Channels of the mesh forces.
    forces: Vec<usize>,
    /// Time from which the unexplained energy exceeds [`ENERGY_GROWTH`] [s].
    growth: Option<f64>,
    stopped: Option<(f64, f64)>,
    /// True if the method has a fixed step.
    fixed: bool,
    /// True if events are located.
    located: bool,
    /// Wall time of the monitor, which does not count as cost of the run, but against its time bound.
    pub spent: Duration,
}

impl RunMonitor {
    /// Creates a monitor of a scene with ascending sampling times [s]; `also_steps` records the accepted steps in
    /// contact as well.
    pub fn new(spec: &SceneSpec, scene: &Scene, grid: Vec<f64>, also_steps: bool) -> Self {
        RunMonitor {
            history: History::whole(scene, grid, also_steps),
            ledger: Ledger::of(rotations(spec, scene)),
            tunnelling: TunnellingDetector::new(spec, scene),
            forces: scene.channels_of_meshes(OfMesh::Force),
            growth: None,
            stopped: None,
            fixed: false,
            located: true,
            spent: Duration::ZERO,
        }
    }

    /// Adapts the advice in messages of failure to a plan: fixed step or tolerance, with or without event location.
    #[must_use]
    pub fn under(self, plan: &TimePlan<'_>) -> Self {
        RunMonitor {
            fixed: matches!(plan.resolution, Resolution::Step(_)),
            located: plan.events,
            ..self
        }
    }

    fn check_energy(&mut self, t: f64) -> Control {
        // The energy of symplectic methods swings within each contact and comes back: growth is what stays.
        if self.ledger.growth() <= ENERGY_GROWTH {
            self.growth = None;
        } else {
            self.growth.get_or_insert(t);
        }
        let made_up = self.ledger.residual_relative();
        if made_up <= HOPELESS {
            return Control::Continue;
        }
        self.stopped = Some((t, made_up));
        Control::Stop
    }

    /// Closes the energy balance at the last state of a run that ended with `outcome`, and returns its status and
    /// message.
    pub fn status(
        &mut self,
        sys: &mut dyn SecondOrderSystem,
        end: &State,
        outcome: &Result<(), StepError>,
    ) -> (Status, Option<String>) {
        self.ledger.close(sys, end);
        if let Some(pieces) = &mut self.history.pieces {
            pieces.close();
        }
        if self.stopped.is_none() {
            let _ = self.check_energy(end.t);
        }
        let found = self.findings(end.t);
        // A failure of the method that follows from what went wrong before is its consequence; a run that never got
        // that far has only that.
        let first = found.into_iter().min_by(|a, b| a.time.total_cmp(&b.time));
        let (status, message) = match (outcome, first) {
            (Err(e), Some(f)) if f.status == Status::Tunnelling => {
                (f.status, Some(format!("{}; then: {e}", f.message)))
            }
            (Err(e), _) => (status_of(e), Some(message_of(e, self.fixed))),
            (Ok(()), Some(f)) => (f.status, Some(f.message)),
            (Ok(()), None) => (Status::Unchecked, None),
        };
        // Teeth that passed through each other have said by how much they overlap.
        let warning = self.tunnelling.warning();
        match (message, warning.filter(|_| status != Status::Tunnelling)) {
            (Some(message), Some(warning)) => (status, Some(format!("{message}; {warning}"))),
            (message, warning) => (status, message.or(warning)),
        }
    }

    /// All findings of a run, one for each kind.
    fn findings(&self, end: f64) -> Vec<Finding> {
        let mut found = Vec::new();
        if let Some(time) = self.growth {
            found.push(self.energy(time, end));
        }
        let rows = self.history.time.iter().zip(&self.history.rows);
        let overlap = self.tunnelling.finding(rows, &self.forces, self.located);
        found.extend(overlap);
        if self.history.least_normal < -ADHESION * self.history.peak {
            found.push(Finding {
                // What made the contact pull was there from its first touch on: only other failures that came before
                // the end explain it.
                time: end,
                status: Status::AdhesiveForce,
                message: format!(
                    "the contact force is tensile, {:.3e} N or {:.1} % of the largest force; a contact law must be compressive",
                    -self.history.least_normal,
                    -100.0 * self.history.least_normal / self.history.peak.max(f64::MIN_POSITIVE)
                ),
            });
        }
        found
    }

    fn energy(&self, time: f64, end: f64) -> Finding {
        let (t, made_up) = self
            .stopped
            .unwrap_or((end, self.ledger.residual_relative()));
        let energy = self.ledger.end.total();
        let start = self.ledger.start.unwrap_or_default().total();
        let given = start + self.ledger.external.abs();
        let (status, message) = if !(made_up.is_finite() && energy.is_finite()) {
            (
                Status::BlowUp,
                format!("the energy is not a number at t = {t:.4e} s; use a smaller step"),
            )
        } else if energy > BLOWN_UP * given {
            (
                Status::BlowUp,
                format!(
                    "the energy grows without bound: at t = {t:.4e} s it is {energy:.1e} J, but initial state and loads account for {given:.1e} J; use a smaller step"
                ),
            )
        } else {
            let ledger = &self.ledger;
            let (jumps, residual) = (ledger.unpaid_jumps(), ledger.residual());
            let by = if jumps > residual {
                "by contacts whose force jumps when they close, at any step size; use a contact whose force grows from zero"
            } else if self.fixed {
                "by the integration; use a smaller step"
            } else {
                "by the integration; use a smaller tolerance"
            };
            (
                Status::EnergyGrowth,
                format!(
                    "{:.2e} J at t = {t:.4e} s, {} % of the vibration energy, are added {by}",
                    residual + jumps,
                    short(100.0 * ledger.growth(), 3),
                ),
            )
        };
        Finding {
            time,
            status,
            message,
        }
    }
}

/// Groups of gears that meshes connect, for their energy balance.
fn rotations(spec: &SceneSpec, scene: &Scene) -> Vec<Rotation> {
    let mut ratios: Vec<Option<f64>> = vec![None; spec.gears.len()];
    let mut all = Vec::new();
    for first in 0..spec.gears.len() {
        if ratios[first].is_some() {
            continue;
        }
        ratios[first] = Some(1.0);
        let mut joined = vec![first];
        let mut next = 0;
        while let Some(&gear) = joined.get(next) {
            next += 1;
            for mesh in spec.meshes.iter().filter(|m| m.gears.contains(&gear)) {
                let rates = mesh.gears.map(|i| signed_base_radius(&spec.gears[i].body));
                let (here, there) = if mesh.gears[0] == gear {
                    (0, 1)
                } else {
                    (1, 0)
                };
                let other = mesh.gears[there];
                if let (None, Some(ratio)) = (ratios[other], ratios[gear]) {
                    ratios[other] = Some(-ratio * rates[here] / rates[there]);
                    joined.push(other);
                }
            }
        }
        let member = |&i: &usize| {
            let hub = scene.gears()[i].model.hub();
            Some(Member {
                channel: scene.channel(Channel::Gear(i, OfGear::Speed))?,
                inertia: hub.hub.inertia,
                ratio: ratios[i]?,
                held: !hub.hub.is_free(),
            })
        };
        all.push(Rotation {
            members: joined.iter().filter_map(member).collect(),
        });
    }
    all
}

impl Sink for RunMonitor {
    fn accepted(&mut self, sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        let begin = Instant::now();
        self.history.accepted(sys, step);
        self.ledger.accepted(sys, step);
        self.tunnelling.accepted(sys, step);
        let control = self.check_energy(step.to.t);
        self.spent += begin.elapsed();
        control
    }

    fn restarted(&mut self, sys: &mut dyn SecondOrderSystem, before: &State, after: &State) {
        let begin = Instant::now();
        self.history.restarted(sys, before, after);
        self.ledger.restarted(sys, before, after);
        self.spent += begin.elapsed();
    }

    fn spent(&self) -> Duration {
        self.spent
    }
}
