//! Where in the last step of a solver events lie, on its interpolant.

use super::{Failed, Session};
use crate::diffsol_adapter::kernel::{Kernel, copy, read};
use crate::events::Root;
use crate::events::dips::SHORT;

impl Session<'_, '_> {
    /// Whether event functions fell and rose again in the last step.
    pub(super) fn dipped(&mut self, kernel: &dyn Kernel) -> Result<bool, Failed> {
        let (s, to, y, watch) = (&*self.s, &mut self.to, self.y.get_mut(), &mut self.watch);
        let (shared, end) = (self.shared, to.t);
        let h = end - s.t;
        let time = shared.sys.borrow().characteristic_time(s.at());
        if h <= SHORT * time {
            return Ok(false);
        }
        let mut failed = None;
        let dipped = watch.any_dipped(|theta, out| {
            to.t = s.t + theta * h;
            match read(kernel, to.t, y, &mut to.q, &mut to.v) {
                Ok(()) => shared.event_functions(to.at(), out),
                Err(e) => {
                    out.fill(1.0);
                    failed = Some(e);
                }
            }
        });
        to.t = end;
        copy(kernel.y(), &mut to.q, &mut to.v);
        failed.map_or(Ok(dipped), |e| Err(e.into()))
    }

    /// Finds the first event in the last step and leaves the state there in `to`. False when it lies at the
    /// start of the step.
    pub(super) fn locate(&mut self, kernel: &dyn Kernel) -> Result<bool, Failed> {
        let (s, to, y, watch) = (&*self.s, &mut self.to, self.y.get_mut(), &mut self.watch);
        let shared = self.shared;
        let h = to.t - s.t;
        let mut failed = None;
        let mut look = |theta: f64, out: &mut [f64]| {
            to.t = s.t + theta * h;
            match read(kernel, to.t, y, &mut to.q, &mut to.v) {
                Ok(()) => shared.event_functions(to.at(), out),
                Err(e) => {
                    out.fill(0.0);
                    failed = Some(e);
                }
            }
        };
        let root = watch.first_root(1e-15, &mut look);
        if let Root::Inside(theta) = root {
            look(theta, &mut watch.here);
            watch.select();
        }
        match failed {
            Some(e) => Err(e.into()),
            None => Ok(root != Root::Start),
        }
    }
}
