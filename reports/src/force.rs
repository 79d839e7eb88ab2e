//! The contact force of a run as a function of time: polynomials between the events of the run.
//!
//! The force of a damped contact jumps at touch-down, at a time between two samples of a history: interpolation has an
//! error of the jump over a whole sample. A run therefore stores its force in *pieces*. A piece is a polynomial through
//! a few values of the step's dense output and ends at a located event; a jump is two pieces that end and begin at one
//! time with two values. Between pieces there is no force. Integrals over pieces (Gauss, exact for their degree) have
//! the error of the integrator alone.

use serde::{Deserialize, Serialize};

/// Nodes of a piece at most: polynomials of degree five.
pub const MOST_NODES: usize = 6;

/// Nodes and weights of Gauss-Legendre quadrature on [0, 1], exact to degree eleven: squares of pieces.
pub(crate) const GAUSS: [(f64, f64); 6] = [
    (0.033_765_242_898_423_99, 0.085_662_246_189_585_17),
    (0.169_395_306_766_867_74, 0.180_380_786_524_069_3),
    (0.380_690_406_958_401_55, 0.233_956_967_286_345_52),
    (0.619_309_593_041_598_5, 0.233_956_967_286_345_52),
    (0.830_604_693_233_132_3, 0.180_380_786_524_069_3),
    (0.966_234_757_101_576, 0.085_662_246_189_585_17),
];

/// Force over time in polynomial pieces, zero between them.
///
/// The nodes of all pieces are in one list of times \[s\], which does not decrease, and one of forces \[N\]. The nodes
/// of a piece go from its first one up to the first one of the next piece.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ForceHistory {
    time_s: Vec<f64>,
    force_n: Vec<f64>,
    /// First node of each piece.
    first: Vec<usize>,
}

impl ForceHistory {
    /// Makes the piecewise linear force through samples; two at one time are both sides of a jump. It ends before the
    /// first sample that is not finite.
    pub fn polyline(t: &[f64], force: &[f64]) -> Self {
        let mut history = Self::default();
        let finite = |(t, f): &(&f64, &f64)| t.is_finite() && f.is_finite();
        let samples: Vec<(f64, f64)> = (t.iter().zip(force))
            .take_while(finite)
            .map(|(t, f)| (*t, *f))
            .collect();
        for line in samples.windows(2) {
            history.push(line);
        }
        history
    }

    /// Appends the polynomial through nodes, times \[s\] with forces \[N\], ascending and at most [`MOST_NODES`]. A piece
    /// without force, without length, or with a node that is not finite is none.
    pub fn push(&mut self, nodes: &[(f64, f64)]) {
        let finite = nodes.iter().all(|(t, f)| t.is_finite() && f.is_finite());
        let ascending = nodes.windows(2).all(|w| w[0].0 < w[1].0);
        let within = (2..=MOST_NODES).contains(&nodes.len());
        if !(finite && ascending && within) || nodes.iter().all(|(_, f)| *f == 0.0) {
            return;
        }
        self.first.push(self.time_s.len());
        self.time_s.extend(nodes.iter().map(|n| n.0));
        self.force_n.extend(nodes.iter().map(|n| n.1));
    }

    /// Returns the number of pieces.
    pub fn len(&self) -> usize {
        self.first.len()
    }

    /// True if the force was zero throughout, so that there are no pieces.
    pub fn is_empty(&self) -> bool {
        self.first.is_empty()
    }

    /// Returns the time at which the force first acts \[s\].
    pub fn begins(&self) -> Option<f64> {
        self.time_s.first().copied()
    }

    /// Returns the number of intervals of contact, that is, of sequences of pieces without a gap.
    pub fn spells(&self) -> usize {
        let meet = |w: &&[usize]| self.time_s[w[1] - 1] < self.time_s[w[1]];
        usize::from(!self.is_empty()) + self.first.windows(2).filter(meet).count()
    }

    /// Returns begin and end of the first interval of contact \[s\].
    pub fn first_spell(&self) -> Option<[f64; 2]> {
        let begin = self.begins()?;
        let mut nodes = self.first.iter().skip(1).copied();
        let last = nodes.find(|&next| self.time_s[next - 1] < self.time_s[next]);
        Some([begin, self.time_s[last.unwrap_or(self.time_s.len()) - 1]])
    }

    /// Checks the invariants, which data from a file may break.
    ///
    /// # Errors
    /// A sentence that names the violated rule.
    pub fn validate(&self) -> Result<(), String> {
        let n = self.time_s.len();
        let ends = self.first.iter().skip(1).copied().chain([n]);
        let sound = self.force_n.len() == n
            && (self.first.iter().zip(ends)).all(|(&a, b)| {
                b <= n
                    && (2..=MOST_NODES).contains(&(b.saturating_sub(a)))
                    && self.time_s[a..b].windows(2).all(|w| w[0] < w[1])
            })
            && self.time_s.windows(2).all(|w| w[0] <= w[1])
            && self.first.first().is_none_or(|f| *f == 0);
        let finite = |x: &f64| x.is_finite();
        match sound && self.time_s.iter().chain(&self.force_n).all(finite) {
            true => Ok(()),
            false => Err("the pieces of the force history are not in order".into()),
        }
    }

    /// Computes greatest force \[N\], impulse \[N s\] and time in contact \[s\] between two times \[s\].
    pub fn within(&self, from: f64, to: f64) -> ForceSummary {
        let mut all = ForceSummary::default();
        for p in self.until(to).iter().filter(|p| p.end > from) {
            // Nodes lie far closer than anything swings; between them a polynomial may overshoot a kink.
            let first = p.at(p.start.max(from));
            let inner = p.nodes().filter(|n| n.0 > from).map(|n| n.1);
            let peak = inner.fold(first, f64::max);
            let clipped = Piece {
                start: p.start.max(from),
                ..*p
            };
            all.peak_n = all.peak_n.max(peak);
            all.contact_s += clipped.end - clipped.start;
            let parts = clipped.quadrature().map(|(t, w)| w * clipped.at(t));
            all.impulse_ns += parts.sum::<f64>();
        }
        all
    }

    /// Returns the pieces up to a time \[s\].
    pub(crate) fn until(&self, end: f64) -> Vec<Piece<'_>> {
        let ends = (self.first.iter().skip(1).copied()).chain([self.time_s.len()]);
        (self.first.iter().zip(ends))
            .map(|(&a, b)| Piece::through(&self.time_s[a..b], &self.force_n[a..b]))
            .take_while(|p| p.start < end)
            .map(|p| Piece {
                end: p.end.min(end),
                ..p
            })
            .collect()
    }
}

/// Peak, impulse and contact time of a force between two times.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ForceSummary {
    /// Greatest force \[N\].
    pub peak_n: f64,
    /// Integral of the force over time \[N s\].
    pub impulse_ns: f64,
    /// Time during which the force acts \[s\].
    pub contact_s: f64,
}

/// Integrates the polynomial through nodes, times \[s\] with values, ascending and at most [`MOST_NODES`]; 0 for nodes
/// that make no piece.
pub fn integral(nodes: &[(f64, f64)]) -> f64 {
    let mut one = ForceHistory::default();
    one.push(nodes);
    let whole = one.until(f64::INFINITY);
    whole
        .iter()
        .flat_map(|p| p.quadrature().map(|(t, w)| w * p.at(t)))
        .sum()
}

/// A polynomial over a stretch of time, in Newton's form over its nodes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece<'a> {
    /// Times of the nodes \[s\].
    pub t: &'a [f64],
    /// Forces at these times \[N\].
    pub f: &'a [f64],
    /// Time at which the piece begins \[s\].
    pub start: f64,
    /// Time at which the piece ends \[s\]: its last node or earlier.
    pub end: f64,
    scale: f64,
    /// Divided differences over times from the start, in lengths of the piece.
    c: [f64; MOST_NODES],
}

impl<'a> Piece<'a> {
    fn through(t: &'a [f64], f: &'a [f64]) -> Self {
        let n = t.len();
        let (start, end) = (t[0], t[n - 1]);
        let scale = 1.0 / (end - start);
        let mut c = [0.0; MOST_NODES];
        c[..n].copy_from_slice(f);
        for k in 1..n {
            for i in (k..n).rev() {
                c[i] = (c[i] - c[i - 1]) / ((t[i] - t[i - k]) * scale);
            }
        }
        Self {
            t,
            f,
            start,
            end,
            scale,
            c,
        }
    }

    /// Returns the force at a time of the piece \[N\].
    pub fn at(&self, t: f64) -> f64 {
        let n = self.t.len();
        let mut y = self.c[n - 1];
        for i in (0..n - 1).rev() {
            y = y * ((t - self.t[i]) * self.scale) + self.c[i];
        }
        y
    }

    /// Returns times and weights of Gauss quadrature over the piece \[s\].
    pub fn quadrature(&self) -> impl Iterator<Item = (f64, f64)> {
        gauss(self.start, self.end)
    }

    /// Returns the nodes that lie before its end, and its end, with their forces.
    pub fn nodes(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        let last = if self.end < self.t[self.t.len() - 1] {
            self.at(self.end)
        } else {
            self.f[self.f.len() - 1]
        };
        let inner = self.t.iter().copied().zip(self.f.iter().copied());
        (inner.take_while(|(t, _)| *t < self.end)).chain([(self.end, last)])
    }

    /// Returns time and value of the maximum \[s, N\]: of the nodes, and of the polynomial around the greatest of them.
    pub fn peak(&self) -> (f64, f64) {
        let nodes: Vec<(f64, f64)> = self.nodes().collect();
        let best = (0..nodes.len()).max_by(|&a, &b| nodes[a].1.total_cmp(&nodes[b].1));
        let Some(i) = best else {
            return (self.start, 0.0);
        };
        if nodes.len() < 3 {
            return nodes[i];
        }
        let near = [i.saturating_sub(1), (i + 1).min(nodes.len() - 1)];
        let [a, b] = near.map(|k| nodes[k].0);
        let (t, below) = minimum([a, b], &mut |t| -self.at(t));
        if -below > nodes[i].1 {
            (t, -below)
        } else {
            nodes[i]
        }
    }
}

/// Returns times and weights of Gauss quadrature between two times \[s\].
pub(crate) fn gauss(start: f64, end: f64) -> impl Iterator<Item = (f64, f64)> {
    let h = end - start;
    GAUSS.into_iter().map(move |(x, w)| (start + x * h, w * h))
}

/// Returns place and value of the minimum of a function between two times, by golden section.
pub(crate) fn minimum([mut a, mut b]: [f64; 2], f: &mut dyn FnMut(f64) -> f64) -> (f64, f64) {
    const RATIO: f64 = 0.618_033_988_749_894_8;
    let (mut c, mut d) = (b - RATIO * (b - a), a + RATIO * (b - a));
    let (mut fc, mut fd) = (f(c), f(d));
    for _ in 0..44 {
        if fc < fd {
            (b, d, fd) = (d, c, fc);
            c = b - RATIO * (b - a);
            fc = f(c);
        } else {
            (a, c, fc) = (c, d, fd);
            d = a + RATIO * (b - a);
            fd = f(d);
        }
    }
    if fc < fd { (c, fc) } else { (d, fd) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quintic(t: f64) -> f64 {
        3.0 + t * (1.0 + t * (-2.0 + t * (0.5 + t * (0.25 - 0.1 * t))))
    }

    #[test]
    fn pieces_are_their_polynomials() {
        let nodes: Vec<(f64, f64)> = [0.0, 0.1, 0.4, 0.6, 0.9, 1.0]
            .map(|t| (2.0 + t, quintic(t)))
            .to_vec();
        let mut history = ForceHistory::default();
        history.push(&nodes);
        // Neither of these is a piece.
        history.push(&nodes[..1]);
        history.push(&[(4.0, 0.0), (5.0, 0.0)]);
        history.push(&[(4.0, 1.0), (4.0, 2.0)]);
        history.push(&[(4.0, f64::NAN), (5.0, 1.0)]);
        assert_eq!((history.len(), history.spells()), (1, 1));
        history.validate().unwrap();
        let piece = history.until(f64::INFINITY)[0];
        for i in 0..=20 {
            let t = 0.05 * f64::from(i);
            assert!((piece.at(2.0 + t) - quintic(t)).abs() < 1e-13);
        }
        let integral: f64 = piece.quadrature().map(|(t, w)| w * piece.at(t)).sum();
        let exact = 3.0 + 0.5 - 2.0 / 3.0 + 0.125 + 0.05 - 0.1 / 6.0;
        assert!((integral - exact).abs() < 1e-13, "{integral} {exact}");
        assert_eq!(history.until(2.5)[0].end, 2.5);
        assert!(history.until(2.0).is_empty());
    }

    #[test]
    fn the_peak_lies_between_nodes() {
        let f = |t: f64| 5.0 - (t - 0.23) * (t - 0.23);
        let nodes: Vec<(f64, f64)> = [0.0, 0.5, 1.0].map(|t| (t, f(t))).to_vec();
        let mut history = ForceHistory::default();
        history.push(&nodes);
        let (t, peak) = history.until(9.0)[0].peak();
        assert!((t - 0.23).abs() < 1e-7 && (peak - 5.0).abs() < 1e-14);
        // At a jump the peak is a node.
        let mut jump = ForceHistory::default();
        jump.push(&[(0.0, 7.0), (1.0, 1.0)]);
        assert_eq!(jump.until(9.0)[0].peak(), (0.0, 7.0));
    }

    #[test]
    fn a_window_cuts_pieces_at_both_ends() {
        let mut history = ForceHistory::default();
        history.push(&[(0.0, 0.0), (1.0, 4.0), (2.0, 0.0)]);
        history.push(&[(3.0, 2.0), (5.0, 4.0)]);
        // The parabola 4 - 4 (t - 1)^2 from 1.5 on, then nothing, then 2 to 3 over one second.
        let w = history.within(1.5, 4.0);
        assert!((w.peak_n - 3.0).abs() < 1e-14 && (w.contact_s - 1.5).abs() < 1e-14);
        assert!(
            (w.impulse_ns - (2.0 - 4.0 / 3.0 * 0.875 + 2.5)).abs() < 1e-13,
            "{w:?}"
        );
        assert_eq!(history.within(2.0, 3.0), ForceSummary::default());
        assert!((history.within(0.0, 9.0).peak_n - 4.0).abs() < 1e-14);
    }

    #[test]
    fn spells_are_told_apart_and_broken_data_are_refused() {
        let samples = ForceHistory::polyline(
            &[0.0, 1.0, 1.0, 2.0, 3.0, 4.0, 5.0],
            &[0.0, 0.0, 2.0, 0.0, 0.0, 1.0, 1.0],
        );
        assert_eq!((samples.len(), samples.spells()), (3, 2));
        assert_eq!(samples.begins(), Some(1.0));
        assert_eq!(samples.first_spell(), Some([1.0, 2.0]));
        let text = serde_json::to_string(&samples).unwrap();
        let back: ForceHistory = serde_json::from_str(&text).unwrap();
        assert_eq!(back, samples);
        for broken in [
            r#"{"time_s":[0,1],"force_n":[1],"first":[0]}"#,
            r#"{"time_s":[0,1],"force_n":[1,1],"first":[0,9]}"#,
            r#"{"time_s":[1,0],"force_n":[1,1],"first":[0]}"#,
            r#"{"time_s":[0,1,2],"force_n":[1,1,1],"first":[1]}"#,
        ] {
            let history: ForceHistory = serde_json::from_str(broken).unwrap();
            assert!(history.validate().is_err(), "{broken}");
        }
    }
}
