//! Tests of the coverage of intervals under correlated noise, and of combinations that are not determined.

use super::coordinates::{Coordinate, Scale, values};
use super::*;

/// Normal numbers from a seed: Box and Muller over xorshift.
pub struct Draws(u64);

impl Draws {
    pub fn new(seed: u64) -> Self {
        Draws(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    fn uniform(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn normal(&mut self) -> f64 {
        let (u, v) = (1.0 - self.uniform(), self.uniform());
        (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
    }
}

/// A decaying vibration of unknown amplitude, decay, frequency and begin.
fn vibration(x: &[f64], n: usize) -> Vec<f64> {
    (0..n)
        .map(|i| {
            let t = i as f64 / n as f64 - x[3];
            match t > 0.0 {
                true => x[0] * (-x[1] * t).exp() * (x[2] * t).sin(),
                false => 0.0,
            }
        })
        .collect()
}

const TRUTH: [f64; 4] = [1.0, 2.0, 9.0, 0.1];

fn coordinates() -> Vec<Coordinate> {
    let begin = Coordinate {
        scale: Scale::Linear(0.1),
        bounds: [-1.0, 1.0],
    };
    vec![
        Coordinate::POSITIVE,
        Coordinate::POSITIVE,
        Coordinate::POSITIVE,
        begin,
    ]
}

/// Returns the part of draws in which the interval of each parameter contains the true value.
fn coverage(draws: usize, coefficients: &[f64]) -> [f64; 4] {
    let (n, all) = (240, coordinates());
    let mut held = [0.0; 4];
    for seed in 0..draws {
        let mut random = Draws::new(1 + seed as u64);
        let mut noise: Vec<f64> = Vec::new();
        for i in 0..n + 200 {
            let past = coefficients.iter().enumerate();
            let past: f64 = past
                .map(|(k, f)| if i > k { f * noise[i - 1 - k] } else { 0.0 })
                .sum();
            noise.push(past + 0.004 * random.normal());
        }
        let data: Vec<f64> = (vibration(&TRUTH, n).iter().zip(&noise[200..]))
            .map(|(a, b)| a + b)
            .collect();
        let problem = Problem {
            free: vec![true; 4],
            blocks: vec![n],
            starts: vec![all.iter().zip(TRUTH).map(|(c, x)| c.of(x)).collect()],
            coordinates: all.clone(),
            courses: vec![false; 4],
            profiles: false,
        };
        let mut residuals = |z: &[f64]| {
            let found = vibration(&values(&all, z), n);
            Some(found.iter().zip(&data).map(|(a, b)| a - b).collect())
        };
        let got = estimate(&problem, &mut residuals).unwrap();
        for (j, truth) in TRUTH.iter().enumerate() {
            let [low, high] = got.values[j].1;
            held[j] += f64::from(u8::from((low..=high).contains(truth))) / draws as f64;
        }
    }
    held
}

/// The intervals have their nominal coverage under white noise, and under noise that is correlated over 30 samples of
/// 240, or oscillates.
#[test]
fn intervals_hold_under_white_and_coloured_noise() {
    for (name, coefficients) in [
        ("white", &[][..]),
        ("coloured", &[0.97][..]),
        ("ringing", &[1.86, -0.9][..]),
    ] {
        let held = coverage(100, coefficients);
        assert!(
            held.iter().all(|h| (0.89..=1.0).contains(h)),
            "{name}: {held:?}"
        );
    }
}
