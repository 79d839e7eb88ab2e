//! Branches of a closed contact: a bounded dashpot has two, each smooth; which one holds is the mode of the contact.
//!
//! ```text
//! saturated    N = 2 k d^n             while c d' > k d^n
//! closed       N = k d^n + c d'        while |c d'| < k d^n
//! open         N = 0                   d <= 0, or after the dashpot would have pulled
//! ```
//!
//! Other laws have one, until their force ends.

use super::damping::Damping;
use super::normal::{ENDED, Law, LawForce};

/// Mode of an open contact.
pub const OPEN: f64 = 0.0;
/// Mode of a closed contact with spring and damper.
pub const CLOSED: f64 = 1.0;
/// Mode of a closed contact whose bounded dashpot has reached the force of the spring.
pub const SATURATED: f64 = 2.0;
/// Stored impact speed [m/s] of a contact that has not touched yet. Zero is the impact speed of a contact that closes
/// without speed, so that the mark is a value that no impact speed has.
pub const UNTOUCHED: f64 = -1.0;

/// Returns the impact speed [m/s] of a contact from its stored value: the speed at first contact, or the present
/// approach speed of a contact that has not touched.
#[inline(always)]
pub fn touch_speed(stored: f64, g_rate: f64) -> f64 {
    if stored >= 0.0 { stored } else { -g_rate }
}

impl Law {
    /// Returns true if the dashpot is bounded by the elastic force: a closed contact then has two branches.
    #[inline]
    pub fn is_bounded(&self) -> bool {
        matches!(self.damping(), Damping::KelvinVoigtBounded { .. })
    }

    /// Returns the mode of a closed contact: [`CLOSED`], or [`SATURATED`].
    #[inline]
    pub fn mode(&self, g: f64, g_rate: f64, k: f64) -> f64 {
        if self.is_bounded() && -self.c * g_rate > self.elastic_force(-g, k).0 {
            SATURATED
        } else {
            CLOSED
        }
    }

    /// Returns the mode that follows that of a closed contact whose [validity](Law::valid_for) has ended.
    #[inline]
    pub fn mode_after(&self, mode: f64, g_rate: f64) -> f64 {
        match (self.is_bounded(), mode == SATURATED, g_rate < 0.0) {
            (true, true, _) => CLOSED,
            // The dashpot has outgrown the spring: by pushing, or by pulling.
            (true, false, true) => SATURATED,
            _ => OPEN,
        }
    }

    /// Computes the smooth branch of a mode; see [`Law::smooth`].
    #[inline]
    pub fn smooth_in_mode(&self, mode: f64, g: f64, g_rate: f64, v0: f64, k: f64) -> LawForce {
        if mode == SATURATED {
            return self.saturated().smooth(g, g_rate, v0, k);
        }
        self.smooth(g, g_rate, v0, k)
    }

    /// Computes the force of the smooth branch of a mode, without derivatives.
    #[inline]
    pub fn force_in_mode(&self, mode: f64, g: f64, g_rate: f64, v0: f64, k: f64) -> f64 {
        if mode == SATURATED {
            return self.saturated().force(g, g_rate, v0, k);
        }
        self.force(g, g_rate, v0, k)
    }

    /// Returns the branch in which the bounded dashpot has reached the force of the spring.
    fn saturated(&self) -> Law {
        let mut law = self.clone();
        (law.c, law.gain) = (0.0, 2.0);
        law
    }

    /// Returns the distance of the branch of a closed contact from its end (m), from a force by [`Self::as_length`]:
    /// the force itself, or for a bounded dashpot its difference from that of the spring. Where the gap is open and
    /// the flanks separate faster than the reference speed of the damper, both factors of `k d (1 + chi d'/v)` are
    /// negative; the contact is then open.
    #[inline]
    pub fn valid_for(&self, mode: f64, g: f64, g_rate: f64, v0: f64, k: f64) -> f64 {
        let left = if self.is_bounded() {
            let (elastic, dashpot) = (self.elastic_force(-g, k).0, -self.c * g_rate);
            if mode == SATURATED {
                dashpot - elastic
            } else {
                elastic - dashpot.abs()
            }
        } else {
            self.left(g, g_rate, v0, k)
        };
        let length = self.length_at(left, g, v0, k);
        if length == 0.0 && g_rate > 0.0 && self.user_law().is_some() {
            // A force that is cut off at zero does not change its sign.
            return -ENDED;
        }
        length
    }

    /// Computes the force of a point of a flank: zero when the gap is open, and with a dashpot force of at most the
    /// elastic force, `|N_d| <= N_e`.
    ///
    /// A constant dashpot alone would act with a jump at touch, where nothing is compressed yet, and pull at the end
    /// (K. H. Hunt, F. R. E. Crossley, *J. Appl. Mech.* 42 (1975) 440): an implicit step then has no solution where a
    /// point just closes. Bounded both ways the force grows from zero and ends at zero.
    #[inline]
    pub fn at_point(&self, g: f64, g_rate: f64, k: f64) -> LawForce {
        if g >= 0.0 {
            return LawForce::default();
        }
        let (elastic, stiffness, by_k) = self.elastic_force(-g, k);
        // A damper that grows with the force is known by its load: no speed of touch is.
        let per_speed = if self.load_speed > 0.0 {
            self.chi / self.load_speed
        } else {
            0.0
        };
        let c = self.c + elastic * per_speed;
        let (dashpot, factor) = (-c * g_rate, 1.0 - per_speed * g_rate);
        if dashpot > elastic {
            LawForce {
                n: 2.0 * elastic,
                dn_dg: -2.0 * stiffness,
                dn_dgdot: 0.0,
                dn_dk: 2.0 * by_k,
            }
        } else if dashpot < -elastic {
            LawForce::default()
        } else {
            LawForce {
                n: elastic + dashpot,
                dn_dg: -stiffness * factor,
                dn_dgdot: -c,
                dn_dk: by_k * factor,
            }
        }
    }
}
