//! Location of events in the last step of a solver, on its interpolant.

use super::{Session, SessionError};
use crate::diffsol_adapter::kernel::{Kernel, copy, read};
use crate::events::dips::SHORT;
use crate::events::{Root, Watch};

impl Session<'_, '_> {
    /// Runs `find` on the event functions over the last step, at fractions of it, with the length of the step [s] and
    /// the characteristic time of the system. The state at the last evaluated fraction remains in `to`.
    fn on_step<T>(
        &mut self,
        kernel: &dyn Kernel,
        find: impl FnOnce(&mut Watch, [f64; 2], &mut dyn FnMut(f64, &mut [f64])) -> T,
    ) -> Result<T, SessionError> {
        let (s, to, y, watch) = (&*self.s, &mut self.to, self.y.get_mut(), &mut self.watch);
        let shared = self.shared;
        let h = to.t - s.t;
        let time = shared.sys.borrow().characteristic_time(s.at());
        let mut failed = None;
        let found = find(watch, [h, time], &mut |theta, out| {
            to.t = s.t + theta * h;
            match read(kernel, to.t, y, &mut to.q, &mut to.v) {
                Ok(()) => shared.event_functions(to.at(), out),
                Err(e) => {
                    out.fill(0.0);
                    failed = Some(e);
                }
            }
        });
        failed.map_or(Ok(found), |e| Err(e.into()))
    }

    /// Returns true if event functions fell and rose again in the last step.
    pub(super) fn dipped(&mut self, kernel: &dyn Kernel) -> Result<bool, SessionError> {
        let end = self.to.t;
        let dipped = self.on_step(kernel, |watch, [h, time], look| {
            h > SHORT * time && watch.any_dipped(look)
        })?;
        self.to.t = end;
        copy(kernel.y(), &mut self.to.q, &mut self.to.v);
        Ok(dipped)
    }

    /// Finds the first event in the last step and stores its state in `to`. Returns false when it lies at the start of
    /// the step.
    pub(super) fn locate(&mut self, kernel: &dyn Kernel) -> Result<bool, SessionError> {
        self.on_step(kernel, |watch, [h, time], look| {
            loop {
                let Root::Inside(theta) = watch.first_root(1e-15, &mut *look) else {
                    return false;
                };
                // A function that is no parabola over the whole step may be one up to this time.
                look(theta, &mut watch.after);
                watch.until = theta;
                if h * theta > SHORT * time && watch.any_dipped(&mut *look) {
                    continue;
                }
                look(theta, &mut watch.here);
                watch.select();
                return true;
            }
        })
    }
}
