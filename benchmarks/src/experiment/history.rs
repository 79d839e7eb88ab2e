//! Histories of a run: channels on a grid, and on every accepted step while teeth touch.
//!
//! A grid alone would cut the peaks of short impacts in a long run; steps alone would leave gaps where a
//! method strides. The state of the largest force is kept for the picture.

use gearbench_integrators::system::{Outputs, SecondOrderSystem, State};
use gearbench_integrators::{AcceptedStep, Control, Sink};
use gearbench_models::scene::{Channel, OfMesh, Scene};

/// Longest distance of samples in contact, in characteristic times of the system.
const SAMPLE_DISTANCE: f64 = 0.2;
/// Samples in one step at most.
const MOST_PARTS: f64 = 24.0;
/// Rows kept beyond the grid at most.
const MOST_STEPS: usize = 100_000;

/// Records channels of a run.
#[derive(Clone, Debug, Default)]
pub struct History {
    grid: Vec<f64>,
    next: usize,
    /// Channel of the contact force of the first mesh.
    force: Option<usize>,
    /// Channels of the least normal forces.
    least: Vec<usize>,
    also_steps: bool,
    /// Times of the rows [s].
    pub time: Vec<f64>,
    /// Rows of channels.
    pub rows: Vec<Vec<f64>>,
    /// State at the largest force.
    pub peak_state: Option<State>,
    /// Largest force [N].
    pub peak: f64,
    /// Least normal force of any contact [N].
    pub least_normal: f64,
    /// The latest sample that was not kept.
    skipped: Option<(f64, Vec<f64>)>,
    in_contact: bool,
    sample: State,
    out: Outputs,
}

impl History {
    /// Records the channels of a scene on an ascending grid [s]; `also_steps` adds the accepted steps in contact.
    pub fn new(scene: &Scene, grid: Vec<f64>, also_steps: bool) -> Self {
        History {
            grid,
            force: scene.channel(Channel::Mesh(0, OfMesh::Force)),
            least: scene.channels_of_meshes(OfMesh::LeastNormal),
            also_steps,
            ..Default::default()
        }
    }

    /// One channel over time.
    pub fn column(&self, channel: usize) -> Vec<f64> {
        self.rows.iter().map(|r| r[channel]).collect()
    }

    /// The force of the first mesh over time; 0 where there is none.
    pub fn force(&self) -> Vec<f64> {
        (self.force).map_or_else(|| vec![0.0; self.rows.len()], |c| self.column(c))
    }

    fn take(&mut self, sys: &mut dyn SecondOrderSystem, keep: bool) {
        sys.output(self.sample.at(), &mut self.out);
        let force = self.force.map_or(0.0, |c| self.out.channels[c].abs());
        for &c in &self.least {
            self.least_normal = self.least_normal.min(self.out.channels[c]);
        }
        if force > self.peak {
            self.peak = force;
            match &mut self.peak_state {
                Some(s) => s.copy_from(&self.sample),
                none => *none = Some(self.sample.clone()),
            }
        }
        if keep || force > 0.0 || self.in_contact {
            // The last sample without force and the first with it frame a jump of a damped contact.
            if let Some((t, row)) = self.skipped.take()
                && force > 0.0
            {
                self.time.push(t);
                self.rows.push(row);
            }
            self.time.push(self.sample.t);
            self.rows.push(self.out.channels.clone());
            self.skipped = None;
        } else {
            let mut row = self.skipped.take().map_or_else(Vec::new, |(_, row)| row);
            row.clone_from(&self.out.channels);
            self.skipped = Some((self.sample.t, row));
        }
        self.in_contact = force > 0.0;
    }
}

/// The time at a part of a step. Rounded, the last one may lie beyond the end, which no sample ever reaches.
fn within(t0: f64, t1: f64, part: f64) -> f64 {
    (t0 + (t1 - t0) * part).min(t1)
}

impl Sink for History {
    fn accepted(&mut self, sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        let (t0, t1) = (step.from.t, step.to.t);
        let h = t1 - t0;
        // A long step through a contact is resolved as finely as the contact's own characteristic time asks. Where no
        // damper lets the force jump the grid shows all of it; in flight there is no force.
        let finely = self.also_steps && sys.has_jumps() && !step.flight;
        let parts = if finely && self.rows.len() < self.grid.len() + MOST_STEPS {
            (h / (SAMPLE_DISTANCE * sys.characteristic_time(step.to.at())))
                .ceil()
                .clamp(1.0, MOST_PARTS)
        } else {
            -1.0
        };
        let mut part = 0.0;
        while self.next < self.grid.len() && self.grid[self.next] <= t1 || part <= parts {
            let on_step = if part <= parts {
                within(t0, t1, part / parts)
            } else {
                f64::INFINITY
            };
            let on_grid = self.grid.get(self.next).copied().unwrap_or(f64::INFINITY);
            let t = on_step.min(on_grid).min(t1);
            let keep = on_grid <= t;
            if on_grid <= t {
                self.next += 1;
            }
            if on_step <= t {
                part += 1.0;
            }
            self.sample.copy_from(step.from);
            let State { q, v, .. } = &mut self.sample;
            if t >= t1 {
                q.copy_from_slice(&step.to.q);
                v.copy_from_slice(&step.to.v);
            } else if t > t0 && h > 0.0 {
                step.dense.eval((t - t0) / h, q, v);
            }
            self.sample.t = t;
            self.take(sys, keep);
        }
        Control::Continue
    }
}

#[cfg(test)]
mod tests {
    use super::within;

    /// `t0 + (t1 - t0)` may exceed `t1` by a rounding: steps of this kind occur in runs.
    #[test]
    fn the_last_part_of_a_step_is_its_end() {
        let mut beyond = 0;
        for i in 1..2000 {
            let (t0, t1) = (f64::from(i) * 1.37e-8, f64::from(i + 700) * 1.11e-7);
            beyond += usize::from(t0 + (t1 - t0) > t1);
            assert!(within(t0, t1, 1.0) <= t1 && within(t0, t1, 0.0) == t0);
        }
        assert!(beyond > 0);
    }
}
