//! A force history as the metrics use it: peak, impulse, duration, and the distance between two histories.

use crate::force::{ForceHistory, Piece, gauss, minimum};
use crate::series::{CONTACT_FORCE, TimeSeries};
use std::borrow::Cow;

/// Returns the pieces of the contact force of a mesh, which a run has; the mesh is given by the names of its gears, `_`
/// between them.
pub(super) fn pieces_of<'s>(series: &'s TimeSeries, mesh: &str) -> Option<&'s ForceHistory> {
    let mut meshes = series.all_of(CONTACT_FORCE);
    let place = meshes.position(|(name, _)| name == mesh)?;
    series.forces.get(place)
}

/// Returns the contact force of a mesh: its pieces where it has them, else its samples joined by lines.
pub(super) fn force_of<'s>(series: &'s TimeSeries, mesh: &str) -> Cow<'s, ForceHistory> {
    match pieces_of(series, mesh) {
        Some(force) => Cow::Borrowed(force),
        None => Cow::Owned(ForceHistory::polyline(
            &series.time_s,
            samples_of(series, mesh),
        )),
    }
}

/// Returns the samples of the contact force of a mesh; empty where the series does not have it.
pub(super) fn samples_of<'s>(series: &'s TimeSeries, mesh: &str) -> &'s [f64] {
    series.of(CONTACT_FORCE, mesh).unwrap_or_default()
}

/// A force up to a time.
pub(super) struct Force<'a> {
    pieces: Vec<Piece<'a>>,
}

/// Integrals of a difference over those of the reference: of magnitudes, and the root of those of squares.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Distance {
    pub l1: f64,
    pub l2: f64,
}

impl<'a> Force<'a> {
    pub fn until(history: &'a ForceHistory, end: f64) -> Self {
        Self {
            pieces: history.until(end),
        }
    }

    /// Returns the greatest force and its time [N, s].
    pub fn peak(&self) -> (f64, f64) {
        let at_nodes = |p: &Piece<'_>| p.nodes().fold(0.0_f64, |m, (_, f)| m.max(f));
        let highest = self.pieces.iter().map(at_nodes).fold(0.0, f64::max);
        // A polynomial exceeds its nodes by a fraction of its range.
        (self.pieces.iter())
            .filter(|p| at_nodes(p) >= 0.5 * highest)
            .map(Piece::peak)
            .fold(
                (0.0, 0.0),
                |best, (t, f)| {
                    if f > best.0 { (f, t) } else { best }
                },
            )
    }

    fn integral(&self, of: impl Fn(f64, f64) -> f64) -> f64 {
        let piece =
            |p: &Piece<'_>| -> f64 { p.quadrature().map(|(t, w)| w * of(t, p.at(t))).sum() };
        self.pieces.iter().map(piece).sum()
    }

    pub fn impulse(&self) -> f64 {
        self.integral(|_, f| f)
    }

    /// Computes the integral of the square of the force [N^2 s].
    pub fn square(&self) -> f64 {
        self.integral(|_, f| f * f)
    }

    /// Computes the centroid of the force in time \[s\].
    fn centroid(&self) -> f64 {
        self.integral(|t, f| t * f) / self.impulse()
    }

    /// Computes the time in which the force exceeds `level` \[s\].
    pub fn time_above(&self, level: f64) -> f64 {
        let between = |p: &Piece<'_>, a: (f64, f64), b: (f64, f64)| {
            let whole = b.0 - a.0;
            if (a.1 > level) == (b.1 > level) {
                return if a.1 > level { whole } else { 0.0 };
            }
            let (mut above, mut below) = if a.1 > level { (a.0, b.0) } else { (b.0, a.0) };
            for _ in 0..52 {
                let middle = 0.5 * (above + below);
                if p.at(middle) > level {
                    above = middle;
                } else {
                    below = middle;
                }
            }
            (above - if a.1 > level { a.0 } else { b.0 }).abs()
        };
        let piece = |p: &Piece<'_>| -> f64 {
            let nodes: Vec<(f64, f64)> = p.nodes().collect();
            nodes.windows(2).map(|w| between(p, w[0], w[1])).sum()
        };
        self.pieces.iter().map(piece).sum()
    }

    /// Computes the width of the highest peak at half its height \[s\].
    fn half_width(&self) -> f64 {
        let (peak, at) = self.peak();
        let nodes: Vec<(f64, f64)> = self.pieces.iter().flat_map(Piece::nodes).collect();
        let split = nodes.partition_point(|(t, _)| *t < at);
        let below = |n: &&(f64, f64)| n.1 < 0.5 * peak;
        let left = nodes[..split].iter().rev().find(below).or(nodes.first());
        let right = nodes[split..].iter().find(below).or(nodes.last());
        match (left, right) {
            (Some(left), Some(right)) => right.0 - left.0,
            _ => 0.0,
        }
    }

    /// Returns the force at ascending times, each moved by `-shift`; 0 between pieces.
    pub fn at_times(
        &self,
        times: impl Iterator<Item = f64>,
        shift: f64,
    ) -> impl Iterator<Item = f64> {
        let mut next = 0;
        times.map(move |t| {
            let t = t - shift;
            while next < self.pieces.len() && self.pieces[next].end < t {
                next += 1;
            }
            match self.pieces.get(next) {
                Some(p) if p.start <= t => p.at(t),
                _ => 0.0,
            }
        })
    }
}

/// Reference force that a run is compared with.
pub(super) enum Target<'a> {
    /// Pieces, up to an end \[s\].
    Pieces { force: Force<'a>, end: f64 },
    /// Times, forces and trapezoidal weights of samples; between samples the force is unknown.
    Samples {
        t: &'a [f64],
        y: &'a [f64],
        weights: Vec<f64>,
    },
}

impl<'a> Target<'a> {
    /// Returns the force of a mesh of a reference: pieces where it has them, else its samples up to the first that is not
    /// finite.
    pub fn of(series: &'a TimeSeries, mesh: &str) -> Self {
        let (t, y) = (&series.time_s, samples_of(series, mesh));
        match pieces_of(series, mesh) {
            Some(history) => {
                let end = t.last().copied().unwrap_or(f64::INFINITY);
                Self::Pieces {
                    force: Force::until(history, end),
                    end,
                }
            }
            None => {
                let n = (t.iter().zip(y))
                    .position(|(t, y)| !(t.is_finite() && y.is_finite()))
                    .unwrap_or(t.len().min(y.len()));
                Self::Samples {
                    t: &t[..n],
                    y: &y[..n],
                    weights: trapezoid_weights(&t[..n]),
                }
            }
        }
    }

    /// Returns the last time at which the force is known \[s\].
    pub fn end(&self) -> f64 {
        match self {
            Self::Pieces { end, .. } => *end,
            Self::Samples { t, .. } => t.last().copied().unwrap_or(f64::INFINITY),
        }
    }

    /// True if the reference has a force history, which may be zero throughout.
    fn is_known(&self) -> bool {
        match self {
            Self::Pieces { .. } => true,
            Self::Samples { t, .. } => t.len() > 1,
        }
    }

    /// Computes the distance between the reference and a run moved by `shift`: over the union of all pieces, or at the
    /// reference's own times.
    pub fn distance(&self, run: &Force<'_>, shift: f64) -> Distance {
        // Difference and reference: magnitudes, squares.
        let mut sums = [[0.0; 2]; 2];
        let mut add = |w: f64, f: f64, r: f64| {
            for (sum, x) in sums.iter_mut().zip([f - r, r]) {
                sum[0] += w * x.abs();
                sum[1] += w * x * x;
            }
        };
        match self {
            Self::Pieces { force, end } => {
                let edges = |p: &Piece<'_>| [p.start, p.end];
                let own = force.pieces.iter().flat_map(edges);
                let moved = run.pieces.iter().flat_map(edges).map(|t| t + shift);
                let mut edges: Vec<f64> = own.chain(moved).map(|t| t.min(*end)).collect();
                // Two ascending runs: the sort merges them.
                edges.sort_by(f64::total_cmp);
                let (mut a, mut b) = (Cursor::of(&run.pieces), Cursor::of(&force.pieces));
                for w in edges.windows(2).filter(|w| w[0] < w[1]) {
                    let middle = 0.5 * (w[0] + w[1]);
                    let (f, r) = (a.covering(middle - shift), b.covering(middle));
                    if f.is_none() && r.is_none() {
                        continue;
                    }
                    let value = |p: Option<&Piece<'_>>, t: f64| p.map_or(0.0, |p| p.at(t));
                    for (t, weight) in gauss(w[0], w[1]) {
                        add(weight, value(f, t - shift), value(r, t));
                    }
                }
            }
            Self::Samples { t, y, weights } => {
                let found = run.at_times(t.iter().copied(), shift);
                for ((f, r), w) in found.zip(*y).zip(weights) {
                    add(*w, f, *r);
                }
            }
        }
        let [missed, norm] = sums;
        // A force that is zero throughout agrees with one that is: teeth that never touch are no unknown error.
        if missed == [0.0; 2] && norm == [0.0; 2] && self.is_known() {
            return Distance { l1: 0.0, l2: 0.0 };
        }
        Distance {
            l1: missed[0] / norm[0],
            l2: (missed[1] / norm[1]).sqrt(),
        }
    }

    /// Returns the shift with the least distance, and that distance: a coarse scan about each guess (no shift, equal
    /// centroids, equal peaks), then golden section.
    pub fn best_shift(&self, run: &Force<'_>) -> (f64, f64) {
        const SCAN: i32 = 32;
        let unmoved = (0.0, self.distance(run, 0.0).l2);
        // Nothing is left to align.
        if unmoved.1 < 1e-12 {
            return unmoved;
        }
        let lines;
        let own = match self {
            Self::Pieces { force, .. } => force,
            Self::Samples { t, y, .. } => {
                lines = ForceHistory::polyline(t, y);
                &Force::until(&lines, f64::INFINITY)
            }
        };
        let step = 2.0 * own.half_width() / f64::from(SCAN);
        if !(step.is_finite() && step > 0.0) {
            return unmoved;
        }
        // The scan only has to find the valley. Between pieces the product of both forces tells it at a part of the cost.
        let places: Vec<(f64, f64)> = (own.pieces.iter())
            .flat_map(|p| {
                let h = 0.5 * (p.end - p.start);
                [0.5, 1.5].map(|x| (p.start + x * h, h * p.at(p.start + x * h)))
            })
            .collect();
        let coarse = |shift: f64| -> f64 {
            if let Self::Samples { .. } = self {
                return self.distance(run, shift).l2;
            }
            let found = run.at_times(places.iter().map(|p| p.0), shift);
            -found.zip(&places).map(|(f, (_, g))| f * g).sum::<f64>()
        };
        let mut best = (0.0, coarse(0.0));
        let peaks = own.peak().1 - run.peak().1;
        for guess in [0.0, own.centroid() - run.centroid(), peaks] {
            if !guess.is_finite() {
                continue;
            }
            for k in -SCAN..=SCAN {
                let shift = guess + f64::from(k) * step;
                let found = coarse(shift);
                if found < best.1 {
                    best = (shift, found);
                }
            }
        }
        let around = [best.0 - step, best.0 + step];
        let refined = minimum(around, &mut |shift| self.distance(run, shift).l2);
        if refined.1 < unmoved.1 {
            refined
        } else {
            unmoved
        }
    }
}

/// The piece at ascending times.
struct Cursor<'p, 'a> {
    pieces: &'p [Piece<'a>],
    next: usize,
}

impl<'p, 'a> Cursor<'p, 'a> {
    fn of(pieces: &'p [Piece<'a>]) -> Self {
        Self { pieces, next: 0 }
    }

    fn covering(&mut self, t: f64) -> Option<&'p Piece<'a>> {
        while self.pieces.get(self.next).is_some_and(|p| p.end <= t) {
            self.next += 1;
        }
        self.pieces.get(self.next).filter(|p| p.start <= t)
    }
}

pub(super) fn last_finite(values: &[f64]) -> Option<f64> {
    values.iter().rev().copied().find(|x| x.is_finite())
}

pub(crate) fn trapezoid_weights(t: &[f64]) -> Vec<f64> {
    let mut weights = vec![0.0; t.len()];
    for i in 1..t.len() {
        let half = 0.5 * (t[i] - t[i - 1]);
        weights[i - 1] += half;
        weights[i] += half;
    }
    weights
}
