//! Grid recorder: channels of the system at given times, from the interpolant of each step.

use crate::method::{AcceptedStep, Control, Sink};
use crate::system::{Outputs, SecondOrderSystem, State};

/// Records the channels of a system on a grid of times, and the state at which one channel has its largest magnitude.
#[derive(Clone, Debug, Default)]
pub struct Recorder {
    /// Times of the records [s], ascending.
    pub grid: Vec<f64>,
    /// Recorded rows: one per passed grid time, channels in the order of the system.
    pub rows: Vec<Vec<f64>>,
    /// Index of the channel whose state of largest magnitude is recorded.
    pub peak_channel: Option<usize>,
    /// State of the largest magnitude of that channel on the grid.
    pub peak_state: Option<State>,
    peak: f64,
    next: usize,
    sample: State,
    out: Outputs,
}

impl Recorder {
    /// Creates a recorder on a grid of ascending times [s].
    pub fn on(grid: Vec<f64>) -> Self {
        let rows = Vec::with_capacity(grid.len());
        Recorder {
            grid,
            rows,
            ..Default::default()
        }
    }

    /// Records the state at which `channel` has its largest magnitude on the grid.
    pub fn with_peak_of(mut self, channel: usize) -> Self {
        self.peak_channel = Some(channel);
        self
    }

    /// Returns one channel as a column; it is shorter than the grid when the run ended early.
    pub fn column(&self, channel: usize) -> Vec<f64> {
        self.rows.iter().map(|r| r[channel]).collect()
    }

    fn take(&mut self, sys: &mut dyn SecondOrderSystem) {
        sys.output(self.sample.at(), &mut self.out);
        if let Some(c) = self.peak_channel {
            let x = self.out.channels[c].abs();
            if x > self.peak {
                self.peak = x;
                match &mut self.peak_state {
                    Some(s) => s.copy_from(&self.sample),
                    none => *none = Some(self.sample.clone()),
                }
            }
        }
        self.rows.push(self.out.channels.clone());
        self.next += 1;
    }
}

impl Sink for Recorder {
    fn accepted(&mut self, sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        let h = step.to.t - step.from.t;
        while self.next < self.grid.len() && self.grid[self.next] <= step.to.t {
            let t = self.grid[self.next];
            self.sample.copy_from(step.from);
            if t >= step.to.t {
                self.sample.copy_from(step.to);
            } else if t > step.from.t && h > 0.0 {
                let State { q, v, .. } = &mut self.sample;
                step.dense.eval((t - step.from.t) / h, q, v);
            }
            self.sample.t = t;
            self.take(sys);
        }
        Control::Continue
    }
}
