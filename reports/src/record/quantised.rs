//! Sequences of numbers as small integers in text, for many numbers of limited precision in records and pages.
//!
//! A number `x` is stored as the nearest integer `k` of `x = low + k step`, `0 <= k < 2^bits`, in 1, 2 or 4 bytes, the
//! least significant byte first. The bytes are in base64 (RFC 4648, section 4).

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

const ALPHABET: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

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
            data: to_base64(&bytes),
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
        let bytes = from_base64(&self.data)?;
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

fn to_base64(bytes: &[u8]) -> String {
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let at = |i: usize| u32::from(chunk.get(i).copied().unwrap_or(0));
        let all = at(0) << 16 | at(1) << 8 | at(2);
        for i in 0..4 {
            let digit = (all >> (18 - 6 * i)) as usize & 63;
            text.push(if i <= chunk.len() {
                char::from(ALPHABET[digit])
            } else {
                '='
            });
        }
    }
    text
}

fn from_base64(text: &str) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3);
    if !text.len().is_multiple_of(4) {
        return Err(format!(
            "has {} characters of data, expected a multiple of 4",
            text.len()
        ));
    }
    let last = text.len() / 4;
    for (i, chunk) in text.as_bytes().chunks_exact(4).enumerate() {
        let padding = chunk.iter().rev().take_while(|c| **c == b'=').count();
        if padding > 2 || (padding > 0 && i + 1 < last) {
            return Err("has padding within its data".into());
        }
        let mut all: u32 = 0;
        for c in &chunk[..4 - padding] {
            let Some(digit) = ALPHABET.iter().position(|a| a == c) else {
                return Err("has a character that is not base64".into());
            };
            all = all << 6 | digit as u32;
        }
        all <<= 6 * padding;
        bytes.extend_from_slice(&all.to_be_bytes()[1..4 - padding]);
    }
    Ok(bytes)
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

    /// Examples of RFC 4648, section 10.
    #[test]
    fn base64_is_that_of_the_standard() {
        for (bytes, text) in [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
            ("fooba", "Zm9vYmE="),
            ("foobar", "Zm9vYmFy"),
        ] {
            assert_eq!(to_base64(bytes.as_bytes()), text);
            assert_eq!(from_base64(text).unwrap(), bytes.as_bytes());
        }
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
            (of("Zm9", 8), "multiple of 4"),
            (of("Zm9v", 16), "multiple of 2"),
            (of("Zm9<", 8), "not base64"),
            (of("Zg==Zg==", 8), "padding"),
            (of("Zg==", 7), "7 `bits`"),
        ] {
            let found = broken.values().unwrap_err();
            assert!(found.contains(message), "{found}");
        }
        assert!(of("Zm9v", 8).validate(2).unwrap_err().contains("3 numbers"));
    }
}
