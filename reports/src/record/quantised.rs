//! Sequences of numbers as small integers in text, for many numbers of limited precision in records and pages.
//!
//! A number `x` is stored as the nearest integer `k` of `x = low + k step`, `0 <= k < 2^bits`, in 1, 2 or 4 bytes, the
//! least significant byte first. The bytes are in base64 (RFC 4648, section 4).

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::{Deserialize, Serialize};

/// A sequence of numbers with equal steps between the values that they can have.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Quantised {
    /// The least number.
    pub low: f64,
    /// Distance of neighbouring values.
    pub step: f64,
    /// Bits of each integer: 8, 16 or 32.
    pub bits: u8,
    /// The integers in base64, the least significant byte first.
    pub data: String,
}

impl Quantised {
    /// Quantises finite numbers with the fewest bits whose step is at most `resolution`, or with 32 bits.
    pub fn of(values: &[f64], resolution: f64) -> Quantised {
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        if values.is_empty() || !(high - low).is_finite() {
            return Quantised {
                bits: 8,
                ..Quantised::default()
            };
        }
        let most = |bits: u8| 2f64.powi(i32::from(bits)) - 1.0;
        let fits = |bits: &u8| (high - low) / most(*bits) <= resolution;
        let bits = [8, 16].into_iter().find(fits).unwrap_or(32);
        let step = (high - low) / most(bits);
        let mut bytes = Vec::with_capacity(values.len() * usize::from(bits / 8));
        for x in values {
            let part = if step > 0.0 { (x - low) / step } else { 0.0 };
            let k = part.round().clamp(0.0, most(bits)) as u32;
            bytes.extend_from_slice(&k.to_le_bytes()[..usize::from(bits / 8)]);
        }
        Quantised {
            low,
            step,
            bits,
            data: STANDARD.encode(&bytes),
        }
    }

    /// Quantises numbers in 16 bits or fewer: the error is at most 1e-5 of their range.
    pub fn relative(values: &[f64]) -> Quantised {
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        Quantised::of(values, (most - least).max(0.0) / 65_000.0)
    }

    /// Returns the numbers.
    ///
    /// # Errors
    /// The text is not base64, or has parts of integers.
    pub fn values(&self) -> Result<Vec<f64>, String> {
        let size = match self.bits {
            8 | 16 | 32 => usize::from(self.bits / 8),
            other => return Err(format!("has {other} `bits`, expected 8, 16 or 32")),
        };
        let bytes = (STANDARD.decode(&self.data))
            .map_err(|e| format!("has data that are not base64: {e}"))?;
        if !bytes.len().is_multiple_of(size) {
            return Err(format!(
                "has {} bytes of data, expected a multiple of {size}",
                bytes.len()
            ));
        }
        let of = |chunk: &[u8]| {
            let mut all = [0; 4];
            all[..size].copy_from_slice(chunk);
            self.low + f64::from(u32::from_le_bytes(all)) * self.step
        };
        Ok(bytes.chunks_exact(size).map(of).collect())
    }

    /// Checks that it has a number of finite values.
    pub(super) fn validate(&self, expected: usize) -> Result<(), String> {
        let values = self.values()?;
        if values.len() != expected {
            return Err(format!("has {} numbers, expected {expected}", values.len()));
        }
        match values.iter().all(|x| x.is_finite()) {
            true => Ok(()),
            false => Err("has numbers that are not finite".into()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(n: usize) -> Vec<f64> {
        // A sequence without pattern in the last digits: the golden-ratio rotation.
        (0..n)
            .map(|i| (i as f64 * 0.618_033_988_749_895).fract() * 3e-3 - 1e-3)
            .collect()
    }

    #[test]
    fn numbers_return_within_half_a_step() {
        for n in [0, 1, 2, 3, 4, 100] {
            for resolution in [1e-4, 1e-7, 1e-11, 0.0] {
                let values = sample(n);
                let found = Quantised::of(&values, resolution);
                let back = found.values().unwrap();
                assert_eq!(back.len(), n);
                for (x, y) in values.iter().zip(&back) {
                    assert!((x - y).abs() <= 0.500_001 * found.step, "{x} {y} {found:?}");
                }
                if n > 1 && found.bits < 32 {
                    assert!(found.step <= resolution);
                }
            }
        }
    }

    #[test]
    fn bits_follow_from_range_and_resolution() {
        let values = sample(100);
        let bits = |resolution| Quantised::of(&values, resolution).bits;
        assert_eq!((bits(1e-4), bits(1e-7), bits(1e-9)), (8, 16, 32));
        assert_eq!(Quantised::relative(&values).bits, 16);
        assert_eq!(Quantised::of(&[2.5; 3], 0.0).values().unwrap(), [2.5; 3]);
    }

    #[test]
    fn broken_data_is_an_error() {
        let of = |data: &str, bits| Quantised {
            bits,
            data: data.into(),
            step: 1.0,
            low: 0.0,
        };
        for (broken, message) in [
            (of("Zm9", 8), "not base64: Invalid padding"),
            (of("Zm9v", 16), "multiple of 2"),
            (of("Zm9<", 8), "Invalid symbol"),
            (of("Zg==Zg==", 8), "Invalid symbol"),
            (of("Zg==", 7), "7 `bits`"),
        ] {
            let found = broken.values().unwrap_err();
            assert!(found.contains(message), "{found}");
        }
        assert!(of("Zm9v", 8).validate(2).unwrap_err().contains("3 numbers"));
    }
}
