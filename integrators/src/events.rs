//! Location of the zero crossings of event functions inside a step.
//!
//! An event function is falling when it is not positive at the end of the step and lower than at its start. So a
//! event function that starts at its root (it was switched there, and rounding may have left it a hair below) may
//! rise freely; it counts again once it has been positive or falls from the start. Roots are found on an
//! interpolant of the step by regula falsi (Illinois variant: M. Dowell, P. Jarratt, *BIT* 11 (1971) 168)
//! with bisection where that stalls. One that falls and rises again within a step shows at neither end: see [`dips`].

pub(crate) mod dips;

/// Fractions of a step at which an event function that starts at its root is sampled. The two ends of the step cannot
/// tell a function that falls at once from one that rises first and then falls.
const PROBES: [f64; 6] = [1e-3, 1.0 / 64.0, 0.125, 0.25, 0.5, 0.75];

/// Position of the first event of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Root {
    /// At the start of the step: the event function was at its root and falls from there.
    Start,
    /// At this fraction of the step.
    Inside(f64),
}

/// Event functions at both ends of a step, and the list of those that fell through zero.
#[derive(Clone, Debug, Default)]
pub(crate) struct Watch {
    /// Event functions at the start of the step.
    pub(crate) before: Vec<f64>,
    /// Event functions at its end.
    pub(crate) after: Vec<f64>,
    /// Event functions at the last sampled point.
    pub(crate) here: Vec<f64>,
    /// Event functions that fell, by index; after [`Watch::select`] the ones to switch.
    pub(crate) falling: Vec<usize>,
    /// One over the drop of each falling event function over the step. Event functions have different units (a gap of
    /// micrometres, a position in pitches): divided by their drop they all fall by one.
    per_drop: Vec<f64>,
    peak: Vec<f64>,
    /// Fraction of the step at which `after` was read: its end, or the bottom of a dip.
    pub(crate) until: f64,
}

impl Watch {
    /// Buffers for a number of event functions.
    pub(crate) fn new(event_functions: usize) -> Self {
        Watch {
            before: vec![1.0; event_functions],
            after: vec![1.0; event_functions],
            here: vec![1.0; event_functions],
            falling: Vec::with_capacity(event_functions),
            per_drop: vec![1.0; event_functions],
            peak: vec![0.0; event_functions],
            until: 1.0,
        }
    }

    /// Reads which event functions fell between `before` and `after`.
    #[inline]
    pub(crate) fn any_fell(&mut self) -> bool {
        self.falling.clear();
        self.until = 1.0;
        for i in 0..self.after.len() {
            if self.after[i] <= 0.0 && self.after[i] < self.before[i] {
                self.falling.push(i);
                self.per_drop[i] = 1.0 / (self.before[i] - self.after[i]);
            }
        }
        !self.falling.is_empty()
    }

    /// Returns the lowest of the falling event functions in `here`, each divided by its drop. It is positive before
    /// the first event, not positive after it, and approximates the distance to it as a fraction of the step.
    pub(crate) fn lowest_here(&self) -> f64 {
        self.lowest(&self.here)
    }

    fn lowest(&self, g: &[f64]) -> f64 {
        self.falling
            .iter()
            .fold(f64::INFINITY, |m, &i| m.min(g[i] * self.per_drop[i]))
    }

    /// Finds the first root on an interpolant, to `tolerance` (a fraction of the step). `events_at` evaluates all
    /// event functions at a fraction of the step. Event functions that fall later may be removed from `falling`.
    pub(crate) fn first_root(
        &mut self,
        tolerance: f64,
        mut events_at: impl FnMut(f64, &mut [f64]),
    ) -> Root {
        let (mut lo, mut hi) = (0.0, self.until);
        let mut f_lo = self.lowest(&self.before);
        let mut f_hi = self.lowest(&self.after);
        if f_lo <= 0.0 {
            self.peak.fill(f64::NEG_INFINITY);
            for theta in PROBES {
                events_at(theta, &mut self.here);
                for &i in &self.falling {
                    self.peak[i] = self.peak[i].max(self.here[i]);
                }
            }
            let (before, peak) = (&self.before, &self.peak);
            let at_once = |i: usize| before[i] <= 0.0 && peak[i] <= 0.0;
            if self.falling.iter().any(|&i| at_once(i)) {
                self.falling.retain(|&i| at_once(i));
                return Root::Start;
            }
            // Every event function is positive somewhere: bracket the first that falls from there. `peak` holds the
            // event functions at the previous point from here on.
            self.peak.copy_from_slice(&self.before);
            let mut previous = 0.0;
            for theta in PROBES.into_iter().chain([1.0]) {
                if theta == 1.0 {
                    self.here.copy_from_slice(&self.after);
                } else {
                    events_at(theta, &mut self.here);
                }
                let (was, is) = (&self.peak, &self.here);
                let fell = |i: usize| was[i] > 0.0 && is[i] <= 0.0;
                if self.falling.iter().any(|&i| fell(i)) {
                    self.falling.retain(|&i| fell(i));
                    (lo, f_lo) = (previous, self.lowest(&self.peak));
                    (hi, f_hi) = (theta, self.lowest(&self.here));
                    break;
                }
                previous = theta;
                std::mem::swap(&mut self.peak, &mut self.here);
            }
        }
        if f_hi == 0.0 && hi == 1.0 {
            return Root::Inside(1.0);
        }
        let mut bracket = Bracket::new((lo, f_lo), (hi, f_hi));
        let mut x = bracket.propose();
        for _ in 0..100 {
            events_at(x, &mut self.here);
            let f = self.lowest_here();
            bracket.update(x, f);
            let next = bracket.propose();
            if f == 0.0 {
                break;
            }
            let moved = (next - x).abs();
            x = next;
            // A small move alone does not make a root: regula falsi creeps where the event function is flat.
            if (moved <= tolerance && f.abs() <= 10.0 * tolerance) || bracket.width() <= tolerance {
                break;
            }
        }
        Root::Inside(x)
    }

    /// Reduces `falling` to the event functions that are at their root in `here`, because equal tooth pairs come into
    /// contact at the same time.
    pub(crate) fn select(&mut self) {
        let floor = self.lowest_here().max(0.0);
        let (g, per_drop) = (&self.here, &self.per_drop);
        self.falling.retain(|&i| g[i] * per_drop[i] <= floor + 1e-9);
    }

    /// Makes the end of a step without event the start of the next step.
    #[inline]
    pub(crate) fn advance(&mut self) {
        std::mem::swap(&mut self.before, &mut self.after);
    }
}

/// An interval that contains a root: the value is positive at `lo` and not positive at `hi`.
#[derive(Clone, Copy, Debug)]
struct Bracket {
    lo: f64,
    hi: f64,
    f_lo: f64,
    f_hi: f64,
    side: i8,
    stalled: u8,
}

impl Bracket {
    fn new((lo, f_lo): (f64, f64), (hi, f_hi): (f64, f64)) -> Self {
        Bracket {
            lo,
            hi,
            f_lo,
            f_hi,
            side: 0,
            stalled: 0,
        }
    }

    fn width(&self) -> f64 {
        self.hi - self.lo
    }

    /// Returns the next abscissa of the root search.
    fn propose(&self) -> f64 {
        let x = (self.lo * self.f_hi - self.hi * self.f_lo) / (self.f_hi - self.f_lo);
        if self.stalled >= 4 || !(x >= self.lo && x <= self.hi) {
            0.5 * (self.lo + self.hi)
        } else {
            x
        }
    }

    fn update(&mut self, x: f64, f: f64) {
        let width = self.width();
        let side = if f > 0.0 {
            (self.lo, self.f_lo) = (x, f);
            1
        } else {
            (self.hi, self.f_hi) = (x, f);
            -1
        };
        if side == self.side {
            if side == 1 {
                self.f_hi *= 0.5;
            } else {
                self.f_lo *= 0.5;
            }
        }
        self.side = side;
        self.stalled = if self.width() > 0.5 * width {
            self.stalled + 1
        } else {
            0
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Builds event functions from functions of the fraction of a step.
    fn watch(g: &[&dyn Fn(f64) -> f64]) -> Watch {
        let mut w = Watch::new(g.len());
        for (i, g) in g.iter().enumerate() {
            w.before[i] = g(0.0);
            w.after[i] = g(1.0);
        }
        w
    }

    fn root(w: &mut Watch, g: &[&dyn Fn(f64) -> f64]) -> Root {
        assert!(w.any_fell());
        w.first_root(1e-14, |x, out| {
            for (out, g) in out.iter_mut().zip(g) {
                *out = g(x);
            }
        })
    }

    #[test]
    fn finds_the_first_of_several_roots() {
        let g: [&dyn Fn(f64) -> f64; 3] = [
            &|x| (0.7 - x) * (1.0 + x),
            &|x| 1.0 - (x / 0.3).powi(9),
            &|_| 1.0,
        ];
        let mut w = watch(&g);
        let Root::Inside(x) = root(&mut w, &g) else {
            panic!("inside")
        };
        assert!((x - 0.3).abs() < 1e-13, "{x}");
        for (i, g) in g.iter().enumerate() {
            w.here[i] = g(x);
        }
        w.select();
        assert_eq!(w.falling, [1]);
    }

    #[test]
    fn event_functions_of_different_size_do_not_hide_each_other() {
        // A gap of micrometres that closes early, a zone in pitches that is left far behind by the end.
        let g: [&dyn Fn(f64) -> f64; 3] = [&|x| 2e-5 * (0.1 - x), &|x| 0.3 - 12.0 * x * x, &|x| {
            1e-6 * (0.1 - x)
        }];
        let mut w = watch(&g);
        let Root::Inside(x) = root(&mut w, &g) else {
            panic!("inside")
        };
        assert!((x - 0.1).abs() < 1e-12, "{x}");
        for (i, g) in g.iter().enumerate() {
            w.here[i] = g(x);
        }
        w.select();
        assert_eq!(w.falling, [0, 2]);
    }

    #[test]
    fn takes_simultaneous_roots_together() {
        let g: [&dyn Fn(f64) -> f64; 2] = [&|x| 0.25 - x * x, &|x| 2.0 * (0.5 - x)];
        let mut w = watch(&g);
        let Root::Inside(x) = root(&mut w, &g) else {
            panic!("inside")
        };
        assert!((x - 0.5).abs() < 1e-13, "{x}");
        for (i, g) in g.iter().enumerate() {
            w.here[i] = g(x);
        }
        w.select();
        assert_eq!(w.falling, [0, 1]);
    }

    #[test]
    fn an_event_function_that_starts_at_its_root_may_rise_first() {
        let g: [&dyn Fn(f64) -> f64; 1] = [&|x| x * (0.4 - x) - 1e-20];
        let mut w = watch(&g);
        let Root::Inside(x) = root(&mut w, &g) else {
            panic!("inside")
        };
        assert!((x - 0.4).abs() < 1e-13, "{x}");
    }

    #[test]
    fn an_event_function_that_falls_from_its_root_is_switched_at_the_start() {
        let g: [&dyn Fn(f64) -> f64; 2] = [&|x| -x, &|x| 0.5 - x];
        let mut w = watch(&g);
        assert_eq!(root(&mut w, &g), Root::Start);
        assert_eq!(w.falling, [0]);
    }

    #[test]
    fn a_root_at_the_end_of_the_step_needs_no_search() {
        let g: [&dyn Fn(f64) -> f64; 1] = [&|x| 1.0 - x];
        let mut w = watch(&g);
        assert_eq!(root(&mut w, &g), Root::Inside(1.0));
    }

    #[test]
    fn a_rising_event_function_is_no_event() {
        let g: [&dyn Fn(f64) -> f64; 1] = [&|x| x - 1e-3];
        assert!(!watch(&g).any_fell());
        let g: [&dyn Fn(f64) -> f64; 1] = [&|x| 0.5 * x - 1.0];
        assert!(!watch(&g).any_fell());
    }

    #[test]
    fn flat_roots_are_bisected() {
        let g: [&dyn Fn(f64) -> f64; 1] = [&|x| -(x - 0.9_f64).powi(7)];
        let mut w = watch(&g);
        let Root::Inside(x) = root(&mut w, &g) else {
            panic!("inside")
        };
        assert!((x - 0.9).abs() < 3e-2, "{x}");
    }
}
