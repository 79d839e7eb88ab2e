//! Contact lines of a pair in its plane of action: their total length over a mesh cycle.
//!
//! A tooth in contact at the path coordinate `s` in the middle of the common width is in contact at `s + z
//! tan(beta_b)` at the height `z` above it: a straight line, inclined by the base helix angle. The parts of the lines,
//! one base pitch apart, that lie on the path of contact add up:
//!
//! ```text
//! L(s) = sum over k of |{z in [-b/2, b/2] : s_A <= s + k p_bt + z tan(beta_b) <= s_E}| / cos(beta_b)
//! mean over a mesh cycle = eps_alpha b / cos(beta_b)
//! ```
//!
//! `L` is linear between the places where an end of a line enters or leaves, so that its extremes are among these four. For
//! spur teeth it is the width times the number of pairs. W. Steeds, *Mechanics of Gearing* (1942); ISO 6336-2 counts the
//! mean with its factor `Z_eps`.

use super::pair::Pair;

/// Total length of the contact lines of a mesh over a mesh cycle (m).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactLines {
    /// Smallest length over the cycle.
    pub least: f64,
    /// Largest length over the cycle.
    pub greatest: f64,
    /// Mean length over the cycle.
    pub mean: f64,
}

impl Pair {
    /// Returns the total length of the contact lines (m) when one pair has the path coordinate `s` (m) in the middle
    /// of the common face width; periodic with the base pitch.
    pub fn contact_line_length(&self, s: f64) -> f64 {
        let (half, tan) = (0.5 * self.face_width, self.beta_b.tan().abs());
        let reach = half * tan;
        let pitch = self.base_pitch;
        // The first line whose forward end is on the path or beyond its start.
        let first = ((self.s_start - reach - s) / pitch).ceil();
        let lines = (0..).map(|k| s + (first + f64::from(k)) * pitch);
        let on_path = lines.take_while(|line| line - reach <= self.s_end);
        let length = |line: f64| {
            if tan == 0.0 {
                return 2.0 * half;
            }
            let from = ((self.s_start - line) / tan).max(-half);
            let to = ((self.s_end - line) / tan).min(half);
            (to - from).max(0.0)
        };
        on_path.map(length).sum::<f64>() / self.beta_b.cos()
    }

    /// Returns the smallest, largest and mean total length of the contact lines over a mesh cycle.
    pub fn contact_lines(&self) -> ContactLines {
        let mean = self.contact_ratio() * self.face_width / self.beta_b.cos();
        let reach = 0.5 * self.face_width * self.beta_b.tan().abs();
        if reach == 0.0 {
            let pairs = self.contact_ratio();
            return ContactLines {
                least: pairs.floor() * self.face_width,
                greatest: pairs.ceil() * self.face_width,
                mean,
            };
        }
        let ends = [self.s_start, self.s_end].map(|s| [s - reach, s + reach]);
        let lengths = ends.as_flattened().iter();
        let lengths = lengths.map(|s| self.contact_line_length(*s));
        let (least, greatest) = lengths.fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), l| {
            (low.min(l), high.max(l))
        });
        ContactLines {
            least,
            greatest,
            mean,
        }
    }
}

#[cfg(test)]
#[path = "contact_lines_tests.rs"]
mod tests;
