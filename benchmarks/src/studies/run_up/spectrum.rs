//! Amplitude spectrum of a window after subtraction of a line, fitted with the weights of the window, so that neither a
//! mean nor a slow change leaks into the lowest bins.

use std::f64::consts::TAU;

/// Hann's window over `n` samples, periodic: an even sine in the middle of a bin reads its amplitude exactly.
fn hann(n: usize) -> impl Iterator<Item = f64> {
    (0..n).map(move |i| 0.5 * (1.0 - (TAU * i as f64 / n as f64).cos()))
}

/// Returns the sum of [`hann`].
fn weight(n: usize) -> f64 {
    0.5 * n as f64
}

/// Samples without their weighted line, weighted.
fn windowed(x: &[f64]) -> Vec<f64> {
    let n = x.len();
    let middle = 0.5 * n as f64;
    let [mut sum, mut first, mut of_x, mut along] = [0.0; 4];
    for (i, (w, x)) in hann(n).zip(x).enumerate() {
        let s = i as f64 - middle;
        sum += w;
        first += w * s * s;
        of_x += w * x;
        along += w * s * x;
    }
    // The window is even about its middle, so that mean and slope do not mix.
    let (mean, slope) = match sum > 0.0 && first > 0.0 {
        true => (of_x / sum, along / first),
        false => (0.0, 0.0),
    };
    let off = |(i, (w, x)): (usize, (f64, &f64))| w * (x - mean - slope * (i as f64 - middle));
    hann(n).zip(x).enumerate().map(off).collect()
}

/// Computes the amplitudes in the bins `0 .. n/2`; `n` is a power of two.
pub fn amplitudes(x: &[f64]) -> Vec<f64> {
    let n = x.len();
    let (mut re, mut im) = (windowed(x), vec![0.0; n]);
    transform(&mut re, &mut im);
    let scale = 2.0 / weight(n);
    (re.iter().zip(&im).take(n / 2))
        .map(|(re, im)| scale * re.hypot(*im))
        .collect()
}

/// Windowed samples of a signal, for amplitudes at any number of cycles.
pub struct Window(Vec<f64>);

impl Window {
    /// Returns the windowed samples of a signal.
    pub fn of(x: &[f64]) -> Self {
        Window(windowed(x))
    }

    /// Computes the amplitude at a number of cycles over the window, which need not be whole.
    pub fn amplitude(&self, cycles: f64) -> f64 {
        let n = self.0.len();
        // One turn of a phasor per sample; after some hundreds it is set anew, so that rounding does not grow.
        const RESET: usize = 256;
        let turn = TAU * cycles / n as f64;
        let (sin, cos) = turn.sin_cos();
        let (mut re, mut im) = (0.0, 0.0);
        let mut at = (1.0, 0.0);
        for (i, x) in self.0.iter().enumerate() {
            if i.is_multiple_of(RESET) {
                let (s, c) = (turn * i as f64).sin_cos();
                at = (c, s);
            }
            re += x * at.0;
            im += x * at.1;
            at = (at.0 * cos - at.1 * sin, at.0 * sin + at.1 * cos);
        }
        2.0 / weight(n) * re.hypot(im)
    }
}

/// The discrete Fourier transform in place, of a power of two (Cooley and Tukey, radix two).
fn transform(re: &mut [f64], im: &mut [f64]) {
    let n = re.len();
    debug_assert!(n.is_power_of_two());
    let mut j = 0;
    for i in 1..n {
        let mut bit = n >> 1;
        while j & bit != 0 {
            j ^= bit;
            bit >>= 1;
        }
        j |= bit;
        if i < j {
            re.swap(i, j);
            im.swap(i, j);
        }
    }
    let turns: Vec<(f64, f64)> = (0..n / 2)
        .map(|k| (-TAU * k as f64 / n as f64).sin_cos())
        .collect();
    let mut half = 1;
    while half < n {
        let stride = n / (2 * half);
        for block in (0..n).step_by(2 * half) {
            for k in 0..half {
                let (sin, cos) = turns[k * stride];
                let (a, b) = (block + k, block + k + half);
                let (x, y) = (re[b] * cos - im[b] * sin, re[b] * sin + im[b] * cos);
                (re[b], im[b]) = (re[a] - x, im[a] - y);
                re[a] += x;
                im[a] += y;
            }
        }
        half *= 2;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(n: usize, parts: &[(f64, f64)], mean: f64, slope: f64) -> Vec<f64> {
        let at = |i: usize| {
            let s = i as f64 / n as f64;
            let sines = parts.iter().map(|(a, k)| a * (TAU * k * s + 0.3 * k).sin());
            mean + slope * s + sines.sum::<f64>()
        };
        (0..n).map(at).collect()
    }

    /// A sine of 1 um has an amplitude of 1 um in its bin, for any other component, mean and slope.
    #[test]
    fn a_sine_reads_its_amplitude_in_its_bin() {
        let x = wave(1024, &[(1e-6, 16.0), (2.5e-7, 40.0)], 1e-3, 1e-3);
        let (a, w) = (amplitudes(&x), Window::of(&x));
        for (k, wanted) in [(16, 1e-6), (40, 2.5e-7), (28, 0.0), (3, 0.0), (1, 0.0)] {
            // The fit of the line takes a little of every sine: 1/k^3.
            assert!((a[k] - wanted).abs() < 2e-9, "{k}: {} {wanted}", a[k]);
            assert!((w.amplitude(k as f64) - a[k]).abs() < 1e-15, "{k}");
        }
        // The neighbouring bins have half of the amplitude; midway between two bins 15 % are lost.
        assert!((a[15] / a[16] - 0.5).abs() < 1e-3);
        let between = amplitudes(&wave(1024, &[(1.0, 16.5)], 0.0, 0.0));
        assert!((between[16] - 0.8488).abs() < 1e-3, "{}", between[16]);
    }

    /// A sine at a tracked order has its exact amplitude between bins as well.
    #[test]
    fn an_order_between_bins_is_followed_exactly() {
        for k in [10.25, 16.5, 37.9] {
            let w = Window::of(&wave(2048, &[(3.0, k), (1.0, k + 20.0)], 5.0, 0.0));
            assert!((w.amplitude(k) / 3.0 - 1.0).abs() < 2e-3, "{k}");
        }
    }

    /// The fast transform equals the direct sums.
    #[test]
    fn the_fast_transform_is_the_transform() {
        let x = wave(64, &[(1.0, 3.3), (0.7, 21.0)], 0.2, -0.4);
        let w = Window::of(&x);
        for (k, a) in amplitudes(&x).into_iter().enumerate() {
            assert!((a - w.amplitude(k as f64)).abs() < 1e-13, "{k}");
        }
    }
}
