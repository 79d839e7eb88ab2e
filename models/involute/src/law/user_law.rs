//! Contact laws that a program adds: a function of gap and gap rate in place of exponent and damping.
//!
//! A law is evaluated where flanks overlap, `g <= 0`. A step that passes the end of a contact needs a smooth continuation
//! into the open gap, which is the point reflection of the law about its force at touch,
//!
//! ```text
//! N(g, g') = 2 N(0, g') - N(-g, g'),    g > 0
//! ```
//!
//! It continues every law of this module as [`Law::smooth`](super::Law::smooth) does. The elastic part of a law is its force
//! at rest, `N(g, 0)`; its integral over the penetration is the potential, and the rest of the force dissipates.

use super::normal::LawForce;
use std::fmt;
use std::sync::Arc;

/// Smallest impact speed that a law receives [m/s]; it keeps quotients finite.
const LEAST_SPEED: f64 = 1e-15;
/// Step of central differences, relative to the value, and its smallest values for gap [m] and gap rate [m/s].
const RELATIVE_STEP: f64 = 1e-5;
const LEAST_GAP_STEP: f64 = 1e-13;
const LEAST_RATE_STEP: f64 = 1e-9;

/// State of a closed contact, the argument of a [`ForceLaw`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactState {
    /// Gap along the normal of the flanks [m], zero or negative.
    pub gap: f64,
    /// Gap rate [m/s], negative while the flanks approach.
    pub gap_rate: f64,
    /// Stiffness of the tooth pair from the key `stiffness` of the contact, at the place of the contact on the path
    /// [N/m].
    pub stiffness: f64,
    /// Approach speed at first touch [m/s], positive.
    pub impact_speed: f64,
}

/// A contact law of a program: the normal force of a tooth pair over its whole face width.
///
/// The stiffness of the contact remains a key of the scene: it scales step sizes and tolerances, and a law may use it.
pub trait ForceLaw: fmt::Debug + Send + Sync {
    /// Returns the name by which scenes select the law, `contact = { normal_force = "NAME" }`.
    fn name(&self) -> &str;

    /// Computes the compressive normal force [N]. A negative value counts as zero.
    fn force(&self, at: &ContactState) -> f64;

    /// Computes the force with its derivatives, or returns `None`: the derivatives are then computed by central
    /// differences, with six more evaluations of the force.
    fn force_with_derivatives(&self, _: &ContactState) -> Option<LawForce> {
        None
    }

    /// Returns the potential of the force at rest [J], zero at touch, or `None`: it is then integrated from the force.
    fn potential(&self, _gap: f64, _stiffness: f64) -> Option<f64> {
        None
    }

    /// Returns true if the force depends on the gap alone.
    fn is_elastic(&self) -> bool {
        false
    }

    /// Returns true if the force depends on the stiffness of the tooth pair.
    fn uses_stiffness(&self) -> bool {
        true
    }

    /// Returns true if the force depends on the impact speed.
    fn uses_impact_speed(&self) -> bool {
        true
    }
}

/// A law of a program at a share of the face width.
#[derive(Clone, Debug)]
pub(super) struct SharedUserLaw {
    law: Arc<dyn ForceLaw>,
    share: f64,
}

impl PartialEq for SharedUserLaw {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.law, &other.law) && self.share == other.share
    }
}

impl SharedUserLaw {
    pub(super) fn new(law: Arc<dyn ForceLaw>) -> Self {
        SharedUserLaw { law, share: 1.0 }
    }

    pub(super) fn law(&self) -> &dyn ForceLaw {
        self.law.as_ref()
    }

    pub(super) fn shared(&self, share: f64) -> Self {
        SharedUserLaw {
            law: self.law.clone(),
            share: self.share * share,
        }
    }

    fn state(&self, gap: f64, gap_rate: f64, v0: f64, k: f64) -> ContactState {
        ContactState {
            gap,
            gap_rate,
            stiffness: k / self.share,
            impact_speed: v0.max(LEAST_SPEED),
        }
    }

    /// Returns the force of the smooth branch.
    pub(super) fn force(&self, g: f64, g_rate: f64, v0: f64, k: f64) -> f64 {
        let at = |g: f64| self.share * self.law.force(&self.state(g, g_rate, v0, k));
        if g > 0.0 {
            2.0 * at(0.0) - at(-g)
        } else {
            at(g)
        }
    }

    /// Returns the force of the smooth branch with its derivatives.
    pub(super) fn smooth(&self, g: f64, g_rate: f64, v0: f64, k: f64) -> LawForce {
        let given = |g: f64| {
            let own = (self.law).force_with_derivatives(&self.state(g, g_rate, v0, k))?;
            // The stiffness of a share is the share of the stiffness.
            Some(LawForce {
                n: self.share * own.n,
                dn_dg: self.share * own.dn_dg,
                dn_dgdot: self.share * own.dn_dgdot,
                dn_dk: own.dn_dk,
            })
        };
        let whole = if g > 0.0 {
            given(0.0).zip(given(-g)).map(|(touch, own)| LawForce {
                n: 2.0 * touch.n - own.n,
                dn_dg: own.dn_dg,
                dn_dgdot: 2.0 * touch.dn_dgdot - own.dn_dgdot,
                dn_dk: 2.0 * touch.dn_dk - own.dn_dk,
            })
        } else {
            given(g)
        };
        whole.unwrap_or_else(|| self.by_differences(g, g_rate, v0, k))
    }

    fn by_differences(&self, g: f64, g_rate: f64, v0: f64, k: f64) -> LawForce {
        let slope = |h: f64, of: &dyn Fn(f64) -> f64| (of(h) - of(-h)) / (2.0 * h);
        let of_gap = RELATIVE_STEP * g.abs() + LEAST_GAP_STEP;
        let of_rate = RELATIVE_STEP * g_rate.abs().max(v0) + LEAST_RATE_STEP;
        LawForce {
            n: self.force(g, g_rate, v0, k),
            dn_dg: slope(of_gap, &|h| self.force(g + h, g_rate, v0, k)),
            dn_dgdot: match self.law.is_elastic() {
                true => 0.0,
                false => slope(of_rate, &|h| self.force(g, g_rate + h, v0, k)),
            },
            dn_dk: match self.law.uses_stiffness() {
                true => slope(RELATIVE_STEP * k, &|h| self.force(g, g_rate, v0, k + h)),
                false => 0.0,
            },
        }
    }

    /// Returns the potential of a closed contact [J].
    pub(super) fn potential(&self, g: f64, k: f64) -> f64 {
        let stiffness = k / self.share;
        let own = self.law.potential(g, stiffness);
        let whole = own.unwrap_or_else(|| integral(-g, |x| self.at_rest(-x, stiffness)));
        self.share * whole
    }

    /// Returns the derivative of the potential by the stiffness.
    pub(super) fn d_potential_dk(&self, g: f64, k: f64) -> f64 {
        if !self.law.uses_stiffness() {
            return 0.0;
        }
        let k = k / self.share;
        let h = RELATIVE_STEP * k;
        let given = |k: f64| self.law.potential(g, k);
        if let Some((more, less)) = given(k + h).zip(given(k - h)) {
            return (more - less) / (2.0 * h);
        }
        let slope = |x: f64| (self.at_rest(-x, k + h) - self.at_rest(-x, k - h)) / (2.0 * h);
        integral(-g, slope)
    }

    /// Returns the force of the whole width at rest.
    fn at_rest(&self, gap: f64, stiffness: f64) -> f64 {
        self.law.force(&ContactState {
            gap,
            gap_rate: 0.0,
            stiffness,
            impact_speed: LEAST_SPEED,
        })
    }
}

/// Nodes of Kronrod's rule of 15 points on [-1, 1] from the largest to zero, with its weights, and those of Gauss's rule on
/// each second node (QUADPACK, `qk15`).
const KRONROD: [[f64; 3]; 8] = [
    [0.991_455_371_120_812_6, 0.022_935_322_010_529_224, 0.0],
    [
        0.949_107_912_342_758_5,
        0.063_092_092_629_978_55,
        0.129_484_966_168_869_7,
    ],
    [0.864_864_423_359_769_1, 0.104_790_010_322_250_18, 0.0],
    [
        0.741_531_185_599_394_4,
        0.140_653_259_715_525_92,
        0.279_705_391_489_276_67,
    ],
    [0.586_087_235_467_691_1, 0.169_004_726_639_267_9, 0.0],
    [
        0.405_845_151_377_397_2,
        0.190_350_578_064_785_4,
        0.381_830_050_505_118_9,
    ],
    [0.207_784_955_007_898_47, 0.204_432_940_075_298_9, 0.0],
    [0.0, 0.209_482_141_084_727_82, 0.417_959_183_673_469_4],
];
/// Difference of the two rules, relative to the integral, above which an interval is halved, and the number of times that this
/// is done at most. The error of Kronrod's rule is far below the difference.
const TOLERANCE: f64 = 1e-9;
const MOST_HALVINGS: usize = 12;

/// Integrates a force from touch to a penetration. Forces grow as fractional powers of the penetration; with `x = d t^4`
/// the integrand is smooth at touch.
fn integral(d: f64, force: impl Fn(f64) -> f64) -> f64 {
    let of = |t: f64| {
        let cube = t * t * t;
        force(d * cube * t) * 4.0 * d * cube
    };
    refined(&of, [0.0, 1.0], None, MOST_HALVINGS)
}

/// Integrates over an interval, which is halved until both rules agree within a part of the whole.
fn refined(
    of: &dyn Fn(f64) -> f64,
    [from, to]: [f64; 2],
    whole: Option<f64>,
    halvings: usize,
) -> f64 {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let (mut kronrod, mut gauss) = (0.0, 0.0);
    for [x, by_kronrod, by_gauss] in KRONROD {
        let mut sum = of(middle + half * x);
        if x > 0.0 {
            sum += of(middle - half * x);
        }
        kronrod += half * by_kronrod * sum;
        gauss += half * by_gauss * sum;
    }
    let whole = whole.unwrap_or(kronrod);
    // A sum that is not a number does not count as a difference.
    let differs = (kronrod - gauss).abs() > TOLERANCE * whole.abs();
    if halvings == 0 || !differs {
        return kronrod;
    }
    let halves = [[from, middle], [middle, to]];
    let parts = halves.map(|half| refined(of, half, Some(whole), halvings - 1));
    parts.iter().sum()
}

#[cfg(test)]
mod tests {
    use super::super::{Damping, Law, UNTOUCHED};
    use super::*;

    /// The law of Hunt and Crossley with Hertz's exponent, as a program would write it.
    #[derive(Debug)]
    struct HuntCrossley {
        exponent: f64,
        e: f64,
    }

    impl ForceLaw for HuntCrossley {
        fn name(&self) -> &str {
            "own"
        }

        fn force(&self, at: &ContactState) -> f64 {
            assert!(at.gap <= 0.0, "{at:?}");
            let v = at.impact_speed.max(at.gap_rate.abs());
            let factor = 1.0 - 1.5 * (1.0 - self.e) * at.gap_rate / v;
            at.stiffness * (-at.gap).powf(self.exponent) * factor
        }
    }

    fn same(x: f64, y: f64, tolerance: f64) -> bool {
        (x - y).abs() <= tolerance * x.abs().max(y.abs())
    }

    /// A law of a program with the formula of a built-in law has its force, its derivatives, its potential and its event
    /// functions, on both sides of touch and at a share of the width.
    #[test]
    fn a_law_of_a_program_equals_the_built_in_one() {
        for (exponent, e) in [(1.5, 0.8), (1.0, 0.5), (10.0 / 9.0, 1.0)] {
            let own = Law::of_program(Arc::new(HuntCrossley { exponent, e }));
            let known = Law::new(exponent, Damping::HuntCrossley { e }).unwrap();
            let k = 3e8 * 1e-5_f64.powf(1.0 - exponent);
            for share in [1.0, 0.25] {
                let laws = [own.shared(share), known.shared(share)];
                for g in [-2e-5, -3e-7, 4e-6] {
                    for rate in [-0.3, -0.02, 0.1, 0.4] {
                        let [a, b] = laws
                            .each_ref()
                            .map(|law| law.smooth(g, rate, 0.2, share * k));
                        assert!(same(a.n, b.n, 1e-13), "{a:?} {b:?}");
                        assert!(same(a.dn_dg, b.dn_dg, 1e-7), "{a:?} {b:?}");
                        let scale = b.n.abs() / 0.2;
                        assert!(
                            (a.dn_dgdot - b.dn_dgdot).abs() < 1e-6 * scale,
                            "{a:?} {b:?}"
                        );
                        assert!(same(a.dn_dk, b.dn_dk, 1e-7), "{a:?} {b:?}");
                        let force = laws[0].force(g, rate, 0.2, share * k);
                        assert_eq!(force.to_bits(), a.n.to_bits());
                    }
                    let [a, b] = laws.each_ref().map(|law| law.potential(g, share * k));
                    assert!(same(a, b, 1e-12), "{a} {b}");
                    let by_k = laws.each_ref().map(|law| law.d_potential_dk(g, share * k));
                    assert!(same(by_k[0], by_k[1], 1e-9), "{by_k:?}");
                }
            }
            assert!(own.is_dissipative());
            assert!(!own.is_linear_elastic() && !own.is_piecewise_linear());
        }
    }

    /// A law without damping and with a kink has the potential of its force, and a force that is cut off at zero ends the
    /// contact.
    #[test]
    fn potential_and_end_of_a_law_with_kinks() {
        #[derive(Debug)]
        struct Bilinear;

        impl ForceLaw for Bilinear {
            fn name(&self) -> &str {
                "bilinear"
            }

            fn force(&self, at: &ContactState) -> f64 {
                let d = -at.gap;
                let spring = 1e8 * d + 4e8 * (d - 1e-5).max(0.0);
                (spring - 300.0 * at.gap_rate).max(0.0)
            }
        }

        let law = Law::of_program(Arc::new(Bilinear));
        let (d, k) = (3e-5, 1e8);
        let exact = 0.5e8 * d * d + 2e8 * 2e-5 * 2e-5;
        assert!(same(law.potential(-d, k), exact, 5e-9));
        assert_eq!(law.potential(1e-6, k), 0.0);
        // Separation at a speed at which the dashpot would pull.
        assert!(law.valid_for(1.0, -1e-6, 0.2, 0.1, k) > 0.0);
        assert!(law.valid_for(1.0, -1e-6, 0.4, 0.1, k) < 0.0);
        assert!(law.until_it_pushes(-1e-6, 0.4, UNTOUCHED, k) > 0.0);
        assert!(law.until_it_pushes(-1e-6, 0.2, UNTOUCHED, k) < 0.0);
        assert_eq!(law.clipped(-1e-6, 0.4, 0.1, k).n, 0.0);
    }
}
