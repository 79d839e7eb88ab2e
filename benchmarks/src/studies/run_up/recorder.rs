//! Recorder of few channels of a run at many even times, where a history of all channels would need too much memory.

use crate::experiment::history::state_within;
use gearbench_integrators::system::{Outputs, SecondOrderSystem, State};
use gearbench_integrators::{AcceptedStep, Control, Sink};

/// Recorder of channels at evenly spaced times.
#[derive(Clone, Debug, Default)]
pub struct Recorder {
    channels: Vec<usize>,
    begin: f64,
    apart: f64,
    most: usize,
    /// Recorded channels in the requested order, one column of samples each.
    pub columns: Vec<Vec<f64>>,
    taken: usize,
    sample: State,
    out: Outputs,
}

impl Recorder {
    /// Creates a recorder for a number of samples of channels, the first at `begin` and the last at `end` [s].
    pub fn new(channels: Vec<usize>, [begin, end]: [f64; 2], samples: usize) -> Self {
        Recorder {
            columns: vec![Vec::with_capacity(samples); channels.len()],
            channels,
            begin,
            apart: (end - begin) / samples.saturating_sub(1).max(1) as f64,
            most: samples,
            ..Recorder::default()
        }
    }

    /// Returns the time from a sample to the next [s].
    pub fn apart(&self) -> f64 {
        self.apart
    }

    /// Returns the number of samples recorded so far.
    pub fn len(&self) -> usize {
        self.taken
    }

    /// Returns the time of a sample [s].
    pub fn time(&self, sample: usize) -> f64 {
        self.begin + self.apart * sample as f64
    }
}

impl Sink for Recorder {
    fn accepted(&mut self, sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        while self.taken < self.most {
            let t = self.time(self.taken);
            // The last sample may be the end of the run, but for rounding.
            if t > step.to.t + 1e-6 * self.apart {
                break;
            }
            state_within(step, t.clamp(step.from.t, step.to.t), &mut self.sample);
            sys.sample(self.sample.at(), &mut self.out);
            for (column, channel) in self.columns.iter_mut().zip(&self.channels) {
                column.push(self.out.channels[*channel]);
            }
            self.taken += 1;
        }
        Control::Continue
    }
}
