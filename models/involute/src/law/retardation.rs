//! Damping of elastic bodies in proportion to their stiffness, at a contact.
//!
//! Bodies whose damping is `beta` times their stiffness answer a force with a retardation time `beta`: a massless one
//! follows `u + beta u' = R f` (W. Flügge, *Viscoelasticity*, 1975, ch. 1). Two of them and a contact spring in a row,
//! all with the same `beta`, are one Kelvin-Voigt element: the law of the contact sees the gap
//!
//! ```text
//! g + beta b
//! ```
//!
//! with the rate `b` of the gap before these compliances act. Elastic forces of such gaps grow monotonically with the
//! gaps without compliance, so the damping never supplies energy. The change of the gap is at most the overlap without
//! compliance: a force begins without a jump, after touching, and a closing impact of a massless body has twice its
//! elastic force until `beta` has passed.

/// The gap that a law sees, and its derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenBy {
    /// Derivative by the gap before compliance [-].
    pub gap: f64,
    /// Derivative by the rate of the gap before compliance [s].
    pub rate: f64,
}

impl Default for SeenBy {
    fn default() -> Self {
        SeenBy {
            gap: 1.0,
            rate: 0.0,
        }
    }
}

/// Returns the gap that the law of a contact sees [m], and its derivatives: at a gap under compliance, a gap and a rate
/// before compliance [m, m/s], with a retardation time `beta` [s].
#[inline]
pub fn retarded(gap: f64, [gap0, rate]: [f64; 2], beta: f64) -> (f64, SeenBy) {
    if beta == 0.0 {
        return (gap, SeenBy::default());
    }
    let (change, overlap) = (beta * rate, (-gap0).max(0.0));
    if change.abs() <= overlap {
        let by = SeenBy {
            gap: 1.0,
            rate: beta,
        };
        return (gap + change, by);
    }
    let by = SeenBy {
        gap: if change < 0.0 { 2.0 } else { 0.0 },
        rate: 0.0,
    };
    (gap + overlap.copysign(change), by)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Derivatives agree with differences in each of the branches, which join without a jump.
    #[test]
    fn derivatives_are_those_of_the_gap() {
        let (beta, h) = (1e-6, 1e-7);
        for [gap0, rate] in [[-1e-6, -0.3], [-1e-6, 0.4], [-1e-6, -2.0], [-1e-6, 3.0]] {
            let at = |by: [f64; 2]| {
                let moved = [gap0 * (1.0 + by[0]), rate * (1.0 + by[1])];
                retarded(moved[0] - gap0, moved, beta).0
            };
            let (_, by) = retarded(0.0, [gap0, rate], beta);
            let slope = |of: [f64; 2]| (at(of) - at(of.map(|x| -x))) / (2.0 * h);
            assert!(
                (slope([h, 0.0]) / gap0 - by.gap).abs() < 1e-6,
                "{gap0} {rate}"
            );
            assert!(
                (slope([0.0, h]) / rate - by.rate).abs() < 1e-6 * beta,
                "{gap0} {rate}"
            );
        }
        for rate in [1.0_f64, -1.0] {
            let at = |rate: f64| retarded(-1e-6, [-1e-6, rate], beta).0;
            assert!((at(rate * (1.0 - 1e-9)) - at(rate * (1.0 + 1e-9))).abs() < 1e-14);
        }
        assert_eq!(
            retarded(-3e-6, [1e-6, -1.0], beta).0,
            -3e-6,
            "open without compliance"
        );
    }
}
