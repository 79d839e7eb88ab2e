//! Detection of event functions that fall through zero and rise again within a step, which its two ends do not show.
//!
//! A method under a tolerance takes long steps in free flight, along which it is exact. Where the flanks of teeth come
//! close to each other at the turning point of such a flight, a step may lead from open to open over a contact between:
//! the gap is all but a parabola, and one look in the middle of the step shows whether its least value may lie below zero.

use super::Watch;

/// Ratio of step to characteristic time up to which steps are not searched for dips. Loads alone change a gap within
/// such a step by `(h/T)^2/8` of the deflection under these loads, which is negligible.
pub(crate) const SHORT: f64 = 0.2;
/// Lowest value of a parabola, relative to its drop, above which no dip is searched.
const NEAR: f64 = 0.1;
/// Depth relative to drop below which a dip does not count, because rounding and the error of the interpolant can
/// cause it.
const LEAST: f64 = 1e-3;

impl Watch {
    /// Searches for an event function that is positive `before` and `after` the step and fell within it, whatever else
    /// fell. The bottom of the first dip then replaces the end of the step, so that later events are found after it
    /// and no contact is left overlapping. `events_at` evaluates event functions as in [`Watch::first_root`].
    pub(crate) fn any_dipped(&mut self, mut events_at: impl FnMut(f64, &mut [f64])) -> bool {
        let stays = |i: usize, before: &[f64], after: &[f64]| before[i] > 0.0 && after[i] > 0.0;
        // `after` was read here.
        let end = self.until;
        events_at(0.5 * end, &mut self.peak);
        let mut tried = 0.0;
        loop {
            let mut next: Option<f64> = None;
            for i in 0..self.before.len() {
                if !stays(i, &self.before, &self.after) {
                    continue;
                }
                let place = bottom(self.before[i], self.peak[i], self.after[i]);
                next = match (place.filter(|x| *x > tried), next) {
                    (Some(x), Some(first)) => Some(first.min(x)),
                    (found, first) => found.or(first),
                };
            }
            let Some(theta) = next else { return false };
            events_at(theta * end, &mut self.here);
            let dips = |i: usize| {
                let (before, here) = (self.before[i], self.here[i]);
                stays(i, &self.before, &self.after) && here <= -LEAST * (before - here)
            };
            if (0..self.before.len()).any(dips) {
                self.after.copy_from_slice(&self.here);
                self.any_fell();
                self.until = theta * end;
                return true;
            }
            tried = theta;
        }
    }
}

/// Returns the abscissa of the minimum of the parabola through values at the start, the middle and the end of a step,
/// if it lies inside the step and its value is not clearly positive.
fn bottom(start: f64, middle: f64, end: f64) -> Option<f64> {
    let slope = 4.0 * middle - 3.0 * start - end;
    let curvature = 2.0 * (start + end - 2.0 * middle);
    let place = -slope / (2.0 * curvature);
    let least = start + 0.5 * slope * place;
    let inside = curvature > 0.0 && place > 0.0 && place < 1.0;
    (inside && least <= NEAR * (start - least)).then_some(place)
}

#[cfg(test)]
mod tests {
    use super::super::Root;
    use super::*;

    type Function<'a> = &'a dyn Fn(f64) -> f64;

    fn watch(g: &[Function<'_>]) -> (Watch, bool) {
        let mut w = Watch::new(g.len());
        for (i, g) in g.iter().enumerate() {
            (w.before[i], w.after[i]) = (g(0.0), g(1.0));
        }
        assert!(!w.any_fell());
        let dipped = w.any_dipped(|x, out| fill(g, x, out));
        (w, dipped)
    }

    fn fill(g: &[Function<'_>], x: f64, out: &mut [f64]) {
        for (out, g) in out.iter_mut().zip(g) {
            *out = g(x);
        }
    }

    #[test]
    fn a_parabola_that_dips_below_zero_is_found_with_its_first_root() {
        for (a, b) in [(0.2, 0.3), (0.6, 0.95), (0.05, 0.9), (0.49, 0.51)] {
            let g: [Function<'_>; 2] = [&|_| 1.0, &|x| 3e-5 * (x - a) * (x - b)];
            let (mut w, dipped) = watch(&g);
            // The last thousandth of the drop is negligible.
            assert_eq!(dipped, b - a > 0.03, "{a} {b}");
            if !dipped {
                continue;
            }
            let root = w.first_root(1e-14, |x, out| fill(&g, x, out));
            let Root::Inside(x) = root else {
                panic!("inside")
            };
            assert!((x - a).abs() < 1e-12, "{x} {a}");
            assert_eq!(w.falling, [1]);
        }
    }

    #[test]
    fn the_first_of_several_dips_comes_first() {
        let g: [Function<'_>; 2] = [&|x| (x - 0.7) * (x - 0.8), &|x| {
            1e-6 * (x - 0.1) * (x - 0.3)
        }];
        let (mut w, dipped) = watch(&g);
        assert!(dipped);
        let Root::Inside(x) = w.first_root(1e-14, |x, out| fill(&g, x, out)) else {
            panic!("inside")
        };
        assert!((x - 0.1).abs() < 1e-12, "{x}");
        assert_eq!(w.falling, [1]);
    }

    /// A function that falls for good may mask one that dips before: at the root of the first the second would be far
    /// below zero.
    #[test]
    fn a_dip_shows_beside_what_falls() {
        let g: [Function<'_>; 3] = [&|x| 0.6 - x, &|x| (x - 0.3) * (x - 0.9), &|x| 0.2 - x];
        for (n, first, falls) in [(2, 0.3, vec![1]), (3, 0.2, vec![2])] {
            let g = &g[..n];
            let mut w = Watch::new(n);
            for (i, g) in g.iter().enumerate() {
                (w.before[i], w.after[i]) = (g(0.0), g(1.0));
            }
            assert!(w.any_fell());
            assert!(w.any_dipped(|x, out| fill(g, x, out)));
            let Root::Inside(x) = w.first_root(1e-14, |x, out| fill(g, x, out)) else {
                panic!("inside")
            };
            assert!((x - first).abs() < 1e-12, "{x}");
            fill(g, x, &mut w.here);
            w.select();
            assert_eq!(w.falling, falls);
        }
    }

    #[test]
    fn what_stays_open_or_is_at_its_root_is_no_dip() {
        let open: [Function<'_>; 3] = [&|x| (x - 0.5) * (x - 0.5) + 1e-9, &|x| 1.0 + x, &|x| {
            x * (x - 0.5)
        }];
        assert!(!watch(&open).1);
    }
}
