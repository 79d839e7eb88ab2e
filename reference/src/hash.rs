//! Hash of the data that a reduction depends on: FNV-1a with 128 bits.
//!
//! `h <- (h xor byte) p` from `h_0`, with the constants of G. Fowler, L. C. Noll, K.-P. Vo and D. Eastlake (RFC 9923).
//! It distinguishes data that differ by chance or by edits; it is no protection against forgery.

pub use gearbench_solid_fe::hash::spread;

use gearbench_models::Vec3;
use std::fmt;

/// Hash of a sequence of numbers and texts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Hash(u128);

const PRIME: u128 = 0x0000_0000_0100_0000_0000_0000_0000_013b;

impl Hash {
    /// Hash of an empty input.
    pub const START: Hash = Hash(0x6c62_272e_07bb_0142_62b8_2175_6295_c58d);

    /// Goes on with bytes.
    pub fn bytes(&mut self, bytes: &[u8]) {
        for &b in bytes {
            self.0 = (self.0 ^ u128::from(b)).wrapping_mul(PRIME);
        }
    }

    /// Adds a text; its length separates it from the following input.
    pub fn text(&mut self, text: &str) {
        self.count(text.len());
        self.bytes(text.as_bytes());
    }

    /// Goes on with a count.
    pub fn count(&mut self, n: usize) {
        self.bytes(&(n as u64).to_le_bytes());
    }

    /// Goes on with a number, bit by bit.
    pub fn number(&mut self, x: f64) {
        self.bytes(&x.to_bits().to_le_bytes());
    }

    /// Goes on with a vector.
    pub fn vector(&mut self, x: &Vec3) {
        x.iter().for_each(|x| self.number(*x));
    }

    /// Goes on with a list of numbers.
    pub fn numbers(&mut self, list: &[u32]) {
        self.count(list.len());
        list.iter().for_each(|n| self.bytes(&n.to_le_bytes()));
    }

    /// Goes on with another hash.
    pub fn hash(&mut self, other: Hash) {
        self.bytes(&other.0.to_le_bytes());
    }

    /// Reads 32 hexadecimal digits.
    pub fn from_hex(text: &str) -> Option<Hash> {
        let digits = text.len() == 32 && text.bytes().all(|b| b.is_ascii_hexdigit());
        digits.then(|| u128::from_str_radix(text, 16).ok().map(Hash))?
    }
}

impl fmt::Display for Hash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:032x}", self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::Hash;

    /// Values that the authors of the hash give for these texts.
    #[test]
    fn published_values() {
        let of = |text: &str| {
            let mut h = Hash::START;
            h.bytes(text.as_bytes());
            h.to_string()
        };
        assert_eq!(of(""), "6c62272e07bb014262b821756295c58d");
        assert_eq!(of("a"), "d228cb696f1a8caf78912b704e4a8964");
        assert_eq!(of("foobar"), "343e1662793c64bf6f0d3597ba446f18");
        assert_eq!(Hash::from_hex(&of("a")).unwrap().to_string(), of("a"));
        for bad in ["", "d228", "+228cb696f1a8caf78912b704e4a8964"] {
            assert_eq!(Hash::from_hex(bad), None);
        }
    }
}
