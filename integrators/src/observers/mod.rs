//! Observers of a run: they receive accepted steps and never change the run.

pub mod ledger;
pub mod recorder;

use crate::method::{AcceptedStep, Control, Sink};
use crate::system::{SecondOrderSystem, State};

/// Several sinks as one; it stops the run when any of them does.
pub struct Tee<'a>(pub Vec<&'a mut dyn Sink>);

impl Sink for Tee<'_> {
    fn accepted(&mut self, sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        let mut control = Control::Continue;
        for sink in &mut self.0 {
            if sink.accepted(sys, step) == Control::Stop {
                control = Control::Stop;
            }
        }
        control
    }

    fn restarted(&mut self, sys: &mut dyn SecondOrderSystem, before: &State, after: &State) {
        for sink in &mut self.0 {
            sink.restarted(sys, before, after);
        }
    }
}
