//! Histories of a run: channels on a grid, and on every accepted step while teeth touch.
//!
//! A grid alone would cut the peaks of short impacts in a long run; steps alone would leave gaps where a
//! method strides. The state of the largest force is kept for the picture.

use gearbench_integrators::system::{At, Outputs, SecondOrderSystem, State};
use gearbench_integrators::{AcceptedStep, Control, Sink};

/// Rows kept beyond the grid at most.
const MOST_STEPS: usize = 40_000;

/// Records channels of a run.
#[derive(Clone, Debug, Default)]
pub struct History {
    grid: Vec<f64>,
    next: usize,
    /// Channel of the contact force.
    force: usize,
    /// Channel of the least normal force.
    least: usize,
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
    sample: State,
    out: Outputs,
}

impl History {
    /// Records on an ascending grid [s]; `also_steps` adds the accepted steps in contact.
    pub fn new(grid: Vec<f64>, force: usize, least: usize, also_steps: bool) -> Self {
        History { grid, force, least, also_steps, ..Default::default() }
    }

    /// One channel over time.
    pub fn column(&self, channel: usize) -> Vec<f64> {
        self.rows.iter().map(|r| r[channel]).collect()
    }

    fn take(&mut self, sys: &mut dyn SecondOrderSystem, keep: bool) {
        sys.output(self.sample.at(), &mut self.out);
        let force = self.out.channels[self.force].abs();
        self.least_normal = self.least_normal.min(self.out.channels[self.least]);
        if force > self.peak {
            self.peak = force;
            match &mut self.peak_state {
                Some(s) => s.copy_from(&self.sample),
                none => *none = Some(self.sample.clone()),
            }
        }
        if keep || force > 0.0 {
            self.time.push(self.sample.t);
            self.rows.push(self.out.channels.clone());
        }
    }
}

impl Sink for History {
    fn accepted(&mut self, sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        let h = step.to.t - step.from.t;
        while self.next < self.grid.len() && self.grid[self.next] <= step.to.t {
            let t = self.grid[self.next];
            self.sample.copy_from(step.from);
            let State { q, v, .. } = &mut self.sample;
            if t >= step.to.t {
                q.copy_from_slice(&step.to.q);
                v.copy_from_slice(&step.to.v);
            } else if t > step.from.t && h > 0.0 {
                step.dense.eval((t - step.from.t) / h, q, v);
            }
            self.sample.t = t;
            self.next += 1;
            self.take(sys, true);
        }
        let on_grid = self.time.last().is_some_and(|&t| t >= step.to.t);
        if self.also_steps && !on_grid && self.rows.len() < self.grid.len() + MOST_STEPS {
            self.sample.copy_from(step.to);
            let At { memory, .. } = step.from.at();
            self.sample.memory.copy_from_slice(memory);
            self.take(sys, false);
        }
        Control::Continue
    }
}
