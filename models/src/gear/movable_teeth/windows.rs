//! Displacements of individual teeth, and their exchange between windows and mean.

use super::deviations::Exchange;
use super::teeth::{HYSTERESIS, MovableTeeth, ToothSelection};
use crate::gear::capabilities::{ToothCoordinates, ToothSpring};
use crate::geometry::Side;
use crate::kinematics::Tooth;
use gearbench_integrators::system::{Change, StateView};

/// Largest number of teeth by which a gear may rotate in one step, above the limit of any method that still resolves
/// its teeth.
const MOST_TEETH: f64 = 1e4;

impl ToothCoordinates for MovableTeeth {
    #[inline]
    fn displacement(&self, at: StateView<'_>, tooth: Tooth) -> f64 {
        at.q[self.own_or_mean(at.discrete, tooth)]
    }

    #[inline]
    fn coordinate(&self, discrete: &[f64], tooth: Tooth) -> Option<usize> {
        Some(self.own_or_mean(discrete, tooth))
    }

    fn spring(&self, at: StateView<'_>, tooth: Tooth) -> Option<ToothSpring> {
        let i = self.own_coordinate(at.discrete, tooth)?;
        let deflection = at.q[i] - self.hub.displacement(at.t, at.q);
        let rate = at.v[i] - self.hub.speed(at.t, at.v);
        // About the hub, as all constants of a spring.
        let spring = MovableTeeth::spring(self, at, i - self.first(), at.q[i]);
        let torque = spring.k * deflection + spring.c * rate;
        Some(ToothSpring {
            deflection,
            force: -torque / self.springs.radius_squared.sqrt(),
        })
    }

    /// Returns the middle teeth of the windows.
    #[inline]
    fn places(&self) -> usize {
        match &self.integrated {
            ToothSelection::All => 0,
            ToothSelection::Windows(windows) => windows.len(),
        }
    }

    fn displacements(&self, at: StateView<'_>, first: Tooth, out: &mut [f64]) {
        let mean = at.q[self.first()];
        match &self.integrated {
            ToothSelection::All => {
                let own = &at.q[self.first()..];
                let mut i = (first.index as i32).rem_euclid(self.teeth as i32) as usize;
                for displacement in out {
                    *displacement = own[i];
                    i = if i + 1 == own.len() { 0 } else { i + 1 };
                }
            }
            ToothSelection::Windows(windows) => {
                let w = &windows[first.mesh as usize];
                let from = at.discrete[first.mesh as usize] as i64 - w.half;
                let own = &at.q[w.base..][..w.len() as usize];
                let mut i = (first.index as i32).rem_euclid(own.len() as i32) as usize;
                // Distance behind the window's first tooth; negative is huge.
                let mut behind = (first.index - from) as u64;
                for displacement in out {
                    *displacement = if behind < own.len() as u64 {
                        own[i]
                    } else {
                        mean
                    };
                    behind = behind.wrapping_add(1);
                    i = if i + 1 == own.len() { 0 } else { i + 1 };
                }
            }
        }
    }

    fn follows_contact(&self) -> bool {
        self.springs.radius.is_some()
    }

    fn engage(&self, discrete: &mut [f64], tooth: Tooth, side: Side, closed: bool) -> Change {
        if self.springs.radius.is_none() {
            return Change::None;
        }
        let Some(i) = self.own_coordinate(discrete, tooth) else {
            return Change::None;
        };
        let Some(slot) = self.slot(i - self.first()) else {
            return Change::None;
        };
        let cell = self.engaged_cell(slot);
        discrete[cell] = if closed {
            side.sign() * f64::from(tooth.mesh + 1)
        } else {
            0.0
        };
        Change::Restart
    }

    fn commit(&self, t: f64, q: &mut [f64], v: &mut [f64], discrete: &mut [f64]) -> Change {
        let displacement = self.hub.displacement(t, q);
        let mut change = Change::None;
        for m in 0..self.views.len() {
            let x = self.nearest(m, displacement);
            let mut centre = discrete[m];
            if (x - centre).abs() > MOST_TEETH {
                // No gear turns so far in a step: the run has blown up, and one tooth after the other would never end.
                discrete[m] = x.round();
                change = Change::Restart;
                continue;
            }
            while (x - centre).abs() > 0.5 + HYSTERESIS {
                let step = (x - centre).signum();
                let before = centre as i64;
                centre += step;
                discrete[m] = centre;
                if let ToothSelection::Windows(windows) = &self.integrated {
                    let w = &windows[m];
                    let leaves = before - step as i64 * w.half;
                    let enters = before + step as i64 * (w.half + 1);
                    let local = enters.rem_euclid(w.len()) as usize;
                    let engaged = self.engaged_cell(w.slot + local);
                    discrete[engaged] = 0.0;
                    let (mean, i) = (self.first(), w.base + local);
                    let mut state = [q[mean], v[mean], q[i], v[i]];
                    let (head, free) = discrete.split_at_mut(self.head());
                    let outside = |tooth: i64| {
                        windows.iter().zip(head.iter()).all(|(w, &centre)| {
                            let from_first = tooth - (centre as i64 - w.half);
                            from_first.rem_euclid(self.teeth as i64) >= w.len()
                        })
                    };
                    let teeth = Exchange {
                        t,
                        count: self.count(0),
                        leaves,
                        enters,
                    };
                    self.deviations()
                        .exchange(&self.springs, teeth, free, &mut state, outside);
                    [q[mean], v[mean], q[i], v[i]] = state;
                    change = Change::Restart;
                }
            }
        }
        change
    }
}
