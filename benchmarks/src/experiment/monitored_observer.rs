//! A run with one more observer, whose time does not count as cost of the method.

use super::status::RunMonitor;
use gearbench_integrators::{AcceptedStep, Control, SecondOrderSystem, Sink, State};
use std::time::{Duration, Instant};

/// The monitor of a run together with a further observer.
pub struct MonitoredObserver<'w> {
    pub monitor: &'w mut RunMonitor,
    pub observer: &'w mut dyn Sink,
}

impl Sink for MonitoredObserver<'_> {
    fn accepted(&mut self, sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        let control = self.monitor.accepted(sys, step);
        let begin = Instant::now();
        let other = self.observer.accepted(sys, step);
        self.monitor.spent += begin.elapsed();
        match other {
            Control::Continue => control,
            stop => stop,
        }
    }

    fn restarted(&mut self, sys: &mut dyn SecondOrderSystem, before: &State, after: &State) {
        self.monitor.restarted(sys, before, after);
        let begin = Instant::now();
        self.observer.restarted(sys, before, after);
        self.monitor.spent += begin.elapsed();
    }

    fn spent(&self) -> Duration {
        self.monitor.spent
    }
}
