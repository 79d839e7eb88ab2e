//! Histories of a run: channels on a grid and around contacts, and the force between events.
//!
//! Plots use channels at equidistant times, and at the steps in contact between them, without which plots of long runs
//! would miss the peaks of short impacts. Metrics use the [force between events](super::force). The state at the
//! largest force is kept for the contact snapshot.

use super::contact_log::ContactLog;
use super::force::{ForceRecorder, is_located};
use super::pictures::Frames;
use gearbench_integrators::system::{Outputs, SecondOrderSystem, State};
use gearbench_integrators::{AcceptedStep, Control, Sink};
use gearbench_models::scene::{OfMesh, Scene};

/// Least distance of rows in contact, in characteristic times of the system.
const ROW_DISTANCE: f64 = 0.1;
/// Largest number of rows beyond the sampling times; they serve for plots.
const MOST_ROWS: usize = 100_000;

/// Largest total size of the states stored for plots, in numbers.
const MOST_NUMBERS: usize = 4_000_000;

/// Largest number of stored states in contact, and of those in free flight.
const MOST_STATES: [usize; 2] = [128, 48];

/// A bounded number of states of a run, at equal numbers of samples apart.
#[derive(Clone, Debug, Default)]
pub struct Instants {
    /// States at the times that the run reached.
    pub states: Vec<State>,
    /// Samples between two stored states, as a power of two.
    doubled: u32,
    seen: u64,
}

impl Instants {
    /// Visits every state; drops every second stored one when they become more than `most`.
    fn take(&mut self, sample: &State, most: usize) {
        let most = (MOST_NUMBERS / (2 * sample.q.len()).max(1)).clamp(8, most);
        if self.seen.is_multiple_of(1 << self.doubled) {
            if self.states.len() == most {
                let mut place = 0;
                self.states.retain(|_| {
                    place += 1;
                    place % 2 == 1
                });
                self.doubled += 1;
            }
            if self.seen.is_multiple_of(1 << self.doubled) {
                self.states.push(sample.clone());
            }
        }
        self.seen += 1;
    }
}

/// Evaluates the state at a time within a step: the end points exactly, the interpolant between them.
pub fn state_within(step: &AcceptedStep<'_>, t: f64, state: &mut State) {
    let (t0, t1) = (step.from.t, step.to.t);
    state.copy_from(step.from);
    let State { q, v, .. } = state;
    if t >= t1 {
        q.copy_from_slice(&step.to.q);
        v.copy_from_slice(&step.to.v);
    } else if t > t0 {
        step.dense.eval((t - t0) / (t1 - t0), q, v);
    }
    state.t = t;
}

/// Records channels of a run at sampling times and around contacts.
#[derive(Clone, Debug, Default)]
pub struct History {
    grid: Vec<f64>,
    next: usize,
    /// Channels of the contact force of each mesh and of its part in the transverse plane.
    forces: Vec<[usize; 2]>,
    /// Channels of the least normal force, by mesh.
    least: Vec<usize>,
    also_steps: bool,
    /// Times of the rows [s].
    pub time: Vec<f64>,
    /// Channels at each time, one row per time.
    pub rows: Vec<Vec<f64>>,
    /// Indices of the rows at sampling times.
    pub on_grid: Vec<usize>,
    /// Log of contacts, if requested.
    pub contacts: Option<ContactLog>,
    /// Contact forces between events, if requested.
    pub pieces: Option<ForceRecorder>,
    /// Steps that begin before this time are not recorded in `pieces` [s].
    pub pieces_from: f64,
    /// State at the largest force so far.
    pub peak_state: Option<State>,
    /// States in contact for plots; empty without a contact log.
    pub instants: Instants,
    /// States at sampling times without contact, for the motion; empty without a contact log.
    pub flight: Instants,
    /// States at requested times for frames of whole bodies.
    pub frames: Frames,
    /// Largest contact force of any mesh [N].
    pub peak: f64,
    /// Least normal force of any contact [N].
    pub least_normal: f64,
    /// The latest sample that was not stored.
    skipped: Option<(f64, Vec<f64>)>,
    /// Meshes that bear a force at the sample before.
    in_contact: Vec<bool>,
    sample: State,
    /// True if the sample is the end of its step.
    at_end: bool,
    out: Outputs,
    /// Sampling times within the present step.
    looks: Vec<f64>,
}

impl History {
    /// Creates a recorder for the channels of a scene at ascending sampling times [s].
    pub fn new(scene: &Scene, grid: Vec<f64>) -> Self {
        let channels = |what| scene.channels_of_meshes(what);
        let forces = channels(OfMesh::Force).into_iter();
        let forces = forces.zip(channels(OfMesh::Transverse));
        let forces: Vec<[usize; 2]> = forces.map(|(a, b)| [a, b]).collect();
        History {
            grid,
            in_contact: vec![false; forces.len()],
            forces,
            least: scene.channels_of_meshes(OfMesh::LeastNormal),
            ..Default::default()
        }
    }

    /// A history with the contact forces between events; `also_steps` adds the accepted steps in contact.
    pub fn whole(scene: &Scene, grid: Vec<f64>, also_steps: bool) -> Self {
        let plain = Self::new(scene, grid);
        History {
            also_steps,
            pieces: Some(ForceRecorder::new(plain.forces.len(), also_steps)),
            ..plain
        }
    }

    /// One channel at all rows.
    pub fn column(&self, channel: usize) -> Vec<f64> {
        self.rows.iter().map(|r| r[channel]).collect()
    }

    /// Sets the sample to a time within a step.
    fn sample_at(&mut self, step: &AcceptedStep<'_>, t: f64) {
        self.at_end = t >= step.to.t;
        state_within(step, t, &mut self.sample);
    }

    /// True if all contact forces of the outputs are zero.
    fn is_silent(&self) -> bool {
        (self.forces.iter()).all(|[c, _]| self.out.channels[*c] == 0.0)
    }

    /// Evaluates the sample and stores it as a row if `keep` is set or a contact begins or ends next to it.
    fn take(&mut self, sys: &mut dyn SecondOrderSystem, keep: bool, on_grid: bool) {
        sys.sample(self.sample.at(), &mut self.out);
        let mut changes = false;
        let mut force = 0.0_f64;
        for ([c, _], before) in self.forces.iter().zip(&mut self.in_contact) {
            let own = self.out.channels[*c].abs();
            force = force.max(own);
            changes |= std::mem::replace(before, own > 0.0) != (own > 0.0);
        }
        // Inside a coarse step the interpolant may dip below zero where the law never pulls: the states that the method
        // itself computed tell.
        if self.at_end {
            for &c in &self.least {
                self.least_normal = self.least_normal.min(self.out.channels[c]);
            }
        }
        if force > self.peak {
            self.peak = force;
            match &mut self.peak_state {
                Some(s) => s.copy_from(&self.sample),
                none => *none = Some(self.sample.clone()),
            }
        }
        if self.contacts.is_some() {
            if force > 0.0 {
                self.instants.take(&self.sample, MOST_STATES[0]);
            } else if on_grid {
                self.flight.take(&self.sample, MOST_STATES[1]);
            }
        }
        if keep || (changes && self.keeps_steps()) {
            if let Some((t, row)) = self.skipped.take()
                && changes
            {
                self.time.push(t);
                self.rows.push(row);
            }
            if on_grid {
                self.on_grid.push(self.rows.len());
            }
            self.time.push(self.sample.t);
            self.rows.push(self.out.channels.clone());
            self.skipped = None;
            if let Some(contacts) = &mut self.contacts {
                contacts.at_row(sys, &self.sample);
            }
        } else {
            let mut row = self.skipped.take().map_or_else(Vec::new, |(_, row)| row);
            row.clone_from(&self.out.channels);
            self.skipped = Some((self.sample.t, row));
        }
        if let (true, Some(contacts)) = (on_grid, &mut self.contacts) {
            let located = is_located(&self.sample, sys);
            contacts.on_grid(sys, &self.sample, &self.out.channels, located);
        }
    }

    /// True if the limit of rows for accepted steps is not reached.
    fn keeps_steps(&self) -> bool {
        self.also_steps && self.rows.len() < self.grid.len() + MOST_ROWS
    }
}

impl Sink for History {
    fn accepted(&mut self, sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        let t1 = step.to.t;
        while let Some(&t) = self.frames.times.get(self.frames.states.len())
            && t <= t1
        {
            self.sample_at(step, t.max(step.from.t));
            self.frames.states.push(self.sample.clone());
        }
        let mut looks = std::mem::take(&mut self.looks);
        looks.clear();
        let mut pieces = self.pieces.take();
        let recorded = step.from.t >= self.pieces_from;
        if let Some(pieces) = pieces.as_mut().filter(|_| recorded) {
            let silent = &mut |sys: &mut dyn SecondOrderSystem, t: f64| {
                self.sample_at(step, t);
                sys.sample(self.sample.at(), &mut self.out);
                self.is_silent()
            };
            pieces.sample_times(sys, step, silent, &mut looks);
        }
        // Where no damper lets the force jump the grid shows all of it.
        let rows = self.also_steps && sys.has_jumps();
        let apart = ROW_DISTANCE * sys.characteristic_time(step.to.at());
        let mut look = 0;
        loop {
            let on_grid = self.grid.get(self.next).copied().unwrap_or(f64::INFINITY);
            let of_force = looks.get(look).copied().unwrap_or(f64::INFINITY);
            let t = of_force.min(on_grid);
            if t > t1 {
                break;
            }
            self.sample_at(step, t);
            let of_grid = on_grid <= t;
            let mut keep = of_grid;
            if keep {
                self.next += 1;
            }
            if of_force <= t {
                // Both sides of a jump stay, whatever their distance.
                let begins = look == 0 && of_force == step.from.t;
                let last = self.time.last().is_none_or(|last| t - last >= apart);
                keep |= rows
                    && self.in_contact.contains(&true)
                    && (begins || last)
                    && self.keeps_steps();
                look += 1;
            }
            self.take(sys, keep, of_grid);
            if of_force <= t
                && let Some(pieces) = &mut pieces
            {
                let values = |channels: &[usize; 2]| channels.map(|c| self.out.channels[c]);
                pieces.take(sys, t, self.forces.iter().map(values));
            }
        }
        self.pieces = pieces;
        self.looks = looks;
        Control::Continue
    }

    fn restarted(&mut self, sys: &mut dyn SecondOrderSystem, before: &State, after: &State) {
        if let Some(contacts) = &mut self.contacts {
            contacts.switched(sys, before, after);
        }
    }
}
