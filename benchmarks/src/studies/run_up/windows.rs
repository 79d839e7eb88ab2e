//! Windows of a recorded run: windows of equal time, and windows of whole turns at even angles. Both overlap.

use super::spectrum::{Window, amplitudes};
use crate::experiment::resample::resample_smooth;

/// Default number of turn windows of a run, without their overlap.
const PARTS: f64 = 100.0;
/// Windows at most; longer runs overlap less, never less than by half.
const MOST_WINDOWS: f64 = 160.0;
/// Least number of samples per cycle of the highest order that is evaluated.
const PER_CYCLE: f64 = 8.0;
/// Largest number of lines of a map; more lines are reduced to the largest of neighbours.
const MOST_LINES: usize = 200;

/// Recording that is divided into windows: evenly spaced samples, with the turns of the reference gear at each.
pub struct SampledRecording<'a> {
    /// Time of the first sample, and the interval between samples [s].
    pub time: [f64; 2],
    /// Turns of the reference gear, ascending.
    pub turns: &'a [f64],
}

/// Windows of one kind, of equal time or of equal turns.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Windows {
    /// First and last sample of each window (of windows of turns: between which its angles lie).
    pub samples: Vec<[usize; 2]>,
    /// Turns at which each begins; empty for windows of equal time.
    starts: Vec<f64>,
    /// Number of samples of a window, a power of two.
    pub length: usize,
    /// Length of a window: time [s], or turns.
    pub span: f64,
    /// Time in the middle of each window [s].
    pub time: Vec<f64>,
    /// Mean speed of the reference gear in each window [rad/s].
    pub speed: Vec<f64>,
}

/// The first starts of windows of a length that lie in a range.
fn starts([first, last]: [f64; 2], length: f64) -> Vec<f64> {
    let room = last - first - length;
    let hop = (0.25 * length)
        .max(room / (MOST_WINDOWS - 1.0))
        .min(0.5 * length);
    let count = (room / hop + 1e-9).floor().max(0.0) as usize + 1;
    (0..count).map(|i| first + hop * i as f64).collect()
}

impl SampledRecording<'_> {
    fn at(&self, sample: f64) -> f64 {
        self.time[0] + self.time[1] * sample
    }

    /// Time at which so many turns are reached [s].
    fn reached(&self, turns: f64) -> f64 {
        let i = self.turns.partition_point(|x| *x < turns);
        let i = i.clamp(1, self.turns.len() - 1);
        let [a, b] = [self.turns[i - 1], self.turns[i]];
        self.at((i - 1) as f64 + (turns - a) / (b - a))
    }

    /// Returns windows of whole turns for orders up to `highest`.
    pub fn by_turns(&self, highest: f64, wanted: Option<f64>) -> Option<Windows> {
        let range = [*self.turns.first()?, *self.turns.last()?];
        let all = range[1] - range[0];
        let span = wanted.unwrap_or((all / PARTS).floor().max(1.0));
        if span > 0.5 * all {
            return None;
        }
        let starts = starts(range, span);
        let around = |start: &f64| {
            let first = self.turns.partition_point(|x| *x < *start);
            let last = self.turns.partition_point(|x| *x <= start + span);
            // One sample more at each end, for cubics.
            [first.saturating_sub(2), (last + 2).min(self.turns.len())]
        };
        let ends = |start: &f64| [*start, start + span].map(|turns| self.reached(turns));
        let ends: Vec<[f64; 2]> = starts.iter().map(ends).collect();
        Some(Windows {
            samples: starts.iter().map(around).collect(),
            length: ((PER_CYCLE * highest * span).ceil().max(16.0) as usize).next_power_of_two(),
            span,
            time: ends.iter().map(|[a, b]| 0.5 * (a + b)).collect(),
            speed: ends
                .iter()
                .map(|[a, b]| std::f64::consts::TAU * span / (b - a))
                .collect(),
            starts,
        })
    }

    /// Windows of equal time: as long as lets a mesh frequency that rises by so many hertz a second pass through one bin.
    pub fn by_time(&self, rising: f64) -> Option<Windows> {
        let n = self.turns.len();
        let apart = self.time[1];
        // n apart = 1/sqrt(rising): what it rises by in a window is the width of a bin.
        let wanted = rising.max(f64::MIN_POSITIVE).sqrt().recip() / apart;
        let length = wanted
            .clamp(16.0, (n / 8).max(16) as f64)
            .log2()
            .round()
            .exp2() as usize;
        if 2 * length > n {
            return None;
        }
        let starts = starts([0.0, n as f64], length as f64);
        let samples: Vec<[usize; 2]> = (starts.iter())
            .map(|s| s.round() as usize)
            .filter(|first| first + length < n)
            .map(|first| [first, first + length])
            .collect();
        let speed = |[a, b]: &[usize; 2]| {
            let turned = self.turns[*b] - self.turns[*a];
            std::f64::consts::TAU * turned / (apart * (b - a) as f64)
        };
        Some(Windows {
            length,
            span: apart * length as f64,
            time: samples
                .iter()
                .map(|[a, b]| self.at(0.5 * (a + b) as f64))
                .collect(),
            speed: samples.iter().map(speed).collect(),
            samples,
            starts: Vec::new(),
        })
    }

    /// Returns the samples of a history in each window.
    pub fn within<'w>(
        &'w self,
        windows: &'w Windows,
        history: &'w [f64],
    ) -> impl Iterator<Item = Vec<f64>> + 'w {
        windows.samples.iter().enumerate().map(|(i, [a, b])| {
            let Some(start) = windows.starts.get(i) else {
                return history[*a..*b].to_vec();
            };
            let step = windows.span / windows.length as f64;
            let at: Vec<f64> = (0..windows.length)
                .map(|j| start + step * j as f64)
                .collect();
            resample_smooth(&self.turns[*a..*b], &history[*a..*b], &at)
        })
    }
}

/// Several histories that are amplitudes together: root of the sum of their squares.
fn together(of_each: impl Iterator<Item = f64>) -> f64 {
    of_each.map(|a| a * a).sum::<f64>().sqrt()
}

/// Map of amplitudes over lines and windows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Map {
    /// Frequencies [Hz] or orders of the lines.
    pub lines: Vec<f64>,
    /// Amplitudes at these lines, by window.
    pub amplitudes: Vec<Vec<f64>>,
}

/// Computes the amplitudes of histories (those of one quantity together) in all bins up to `highest` (in cycles per
/// unit of the span).
pub fn map(
    cut: &SampledRecording<'_>,
    windows: &Windows,
    histories: &[Vec<f64>],
    highest: f64,
) -> Map {
    let bins = ((highest * windows.span).ceil() as usize + 1).min(windows.length / 2);
    let group = bins.div_ceil(MOST_LINES).max(1);
    let mut all: Vec<Vec<Vec<f64>>> = Vec::new();
    for h in histories {
        all.push(cut.within(windows, h).map(|x| amplitudes(&x)).collect());
    }
    let row = |w: usize| {
        let of = |bin: usize| together(all.iter().map(|h| h[w][bin]));
        let values: Vec<f64> = (0..bins).map(of).collect();
        (values.chunks(group))
            .map(|c| c.iter().copied().fold(0.0, f64::max))
            .collect()
    };
    let middle = |i: usize| {
        let last = (i * group + group).min(bins) - 1;
        0.5 * (i * group + last) as f64 / windows.span
    };
    Map {
        lines: (0..bins.div_ceil(group)).map(middle).collect(),
        amplitudes: (0..windows.samples.len()).map(row).collect(),
    }
}

/// Computes the amplitudes at given orders in each window.
pub fn follow(
    cut: &SampledRecording<'_>,
    windows: &Windows,
    histories: &[Vec<f64>],
    orders: &[f64],
) -> Vec<Vec<f64>> {
    let mut all = vec![vec![0.0_f64; windows.samples.len()]; orders.len()];
    for h in histories {
        for (w, x) in cut.within(windows, h).enumerate() {
            let window = Window::of(&x);
            for (line, order) in all.iter_mut().zip(orders) {
                line[w] = line[w].hypot(window.amplitude(order * windows.span));
            }
        }
    }
    all
}

/// Rounds a number for the record to four digits, the resolution of a window.
pub fn rounded(x: f64) -> f64 {
    if x == 0.0 || !x.is_finite() {
        return 0.0;
    }
    let scale = 10f64.powi(3 - x.abs().log10().floor() as i32);
    (x * scale).round() / scale
}
