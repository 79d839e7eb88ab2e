//! Random numbers of the sampling: SplitMix64 (Steele, Lea, Flood, OOPSLA 2014, fig. 14), one stream per scene and
//! attempt, so that no scene depends on how many numbers another took.

/// Increment of the state, the odd number nearest to 2^64 over the golden ratio.
const GAMMA: u64 = 0x9e37_79b9_7f4a_7c15;

/// A stream of random numbers.
#[derive(Clone, Debug)]
pub struct Random {
    state: u64,
}

/// Stafford's mixing function, variant 13.
fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

impl Random {
    /// The stream that starts at a state.
    pub fn new(state: u64) -> Self {
        Random { state }
    }

    /// The stream of an attempt at a scene of a set.
    pub fn of(seed: u64, number: usize, attempt: u32) -> Self {
        let scene = mix(seed.wrapping_add(GAMMA.wrapping_mul(number as u64 + 1)));
        Random::new(mix(
            scene.wrapping_add(GAMMA.wrapping_mul(u64::from(attempt) + 1))
        ))
    }

    /// Returns the next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(GAMMA);
        mix(self.state)
    }

    /// Returns a uniform number in `[0, 1)`, in steps of 2^-53.
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 * (0.5 / (1_u64 << 52) as f64)
    }

    /// Returns a uniform number in `[low, high)`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Returns a standard normal number (G. E. P. Box, M. E. Muller, *Ann. Math. Stat.* 29 (1958) 610).
    pub fn normal(&mut self) -> f64 {
        let (u, v) = (1.0 - self.unit(), self.unit());
        (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
    }

    /// Returns a number in `[low, high)` with uniform logarithm.
    pub fn decades(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.unit())
    }

    /// Returns one of several values with equal probability.
    pub fn one<T: Copy>(&mut self, all: &[T]) -> T {
        all[((self.unit() * all.len() as f64) as usize).min(all.len() - 1)]
    }

    /// Returns true with a probability.
    pub fn chance(&mut self, probability: f64) -> bool {
        self.unit() < probability
    }
}

/// Rounds a number to four significant digits, so that the scene file contains exactly the sampled value.
pub fn short(x: f64) -> f64 {
    format!("{x:.3e}").parse().unwrap_or(x)
}

/// Rounds a number to ten significant digits, for values that are derived from sampled ones and must fit them.
pub fn fitting(x: f64) -> f64 {
    format!("{x:.9e}").parse().unwrap_or(x)
}
