//! Normal and tangential contact laws: force, its derivatives and its elastic energy.
//!
//! Convention, stated here once: the gap `g` (m) is positive when open, the penetration is
//! `d = -g`, the gap rate `g' < 0` while the bodies approach, and the normal force `N >= 0` is
//! compressive. `v0 > 0` is the approach speed `-g'` at the instant of first touch.
//!
//! The normal force is
//!
//! ```text
//! none            N = k d^n
//! Kelvin-Voigt    N = k d^n + c d'
//! all others      N = k d^n (1 + chi d' / v0)
//! ```
//!
//! | damping | chi | source |
//! |---|---|---|
//! | Hunt-Crossley | 3 (1 - e) / 2 | J. Appl. Mech. 42 (1975) 440-445 |
//! | Lankarani-Nikravesh | 3 (1 - e^2) / 4 | J. Mech. Des. 112 (1990) 369-376 |
//! | Flores et al. | 8 (1 - e) / (5 e) | Multibody Syst. Dyn. 25 (2011) 357-375 |
//! | Gonthier et al. | (1 - e^2) / e | Multibody Syst. Dyn. 11 (2004) 209-233 |
//!
//! The restitution `r` such a law really gives in a free impact is the same for every exponent:
//! it solves `chi (1 + r) = ln((1 + chi) / (1 - chi r))` ([`realised_restitution`]). The first two
//! factors meet `r = e` only near `e = 1`; the last two stay close to it over the whole range.
//!
//! Event-located integration needs a branch that stays smooth while a root is sought, so
//! [`Law::smooth`] continues the law oddly into the open gap and does not clip; the force that acts
//! is [`Law::clipped`]: zero when open, zero instead of tensile (contact never pulls).

use crate::error::Reason;
use std::fmt;

mod friction;

pub use friction::{Friction, FrictionForce};

/// Default floor of the impact speed `v0` (m/s), see [`Law::with_speed_floor`].
pub const DEFAULT_SPEED_FLOOR: f64 = 1e-3;

/// Why a law cannot be used as specified.
#[derive(Debug, Clone, PartialEq)]
pub enum LawError {
    /// The penetration exponent is outside `[1, 3]`.
    Exponent {
        /// The value given.
        value: f64,
    },
    /// The coefficient of restitution is outside `(0, 1]`.
    Restitution {
        /// Id of the damping.
        law: &'static str,
        /// The value given.
        value: f64,
    },
    /// A Kelvin-Voigt coefficient or ratio is negative or not finite.
    KelvinVoigt {
        /// Coefficient or ratio.
        what: &'static str,
        /// The value given.
        value: f64,
    },
    /// A damping ratio reached a law before it became a coefficient.
    UnresolvedRatio,
    /// A damping ratio was given for a nonlinear law.
    RatioOfNonlinearLaw {
        /// The exponent of the law.
        exponent: f64,
    },
    /// A quantity that must be positive is not.
    NotPositive {
        /// Which quantity, with its unit.
        what: &'static str,
        /// The value given.
        value: f64,
    },
    /// A friction parameter is out of range.
    Friction {
        /// Which parameter.
        what: &'static str,
        /// The value given.
        value: f64,
        /// What is allowed.
        rule: &'static str,
    },
}

impl LawError {
    /// Cause and way out.
    #[must_use]
    pub fn reason(&self) -> Reason {
        let (cause, help) = match self {
            Self::Exponent { value } => (
                format!("exponent of the contact law is {value}"),
                "it must lie in [1, 3] (1 linear, 10/9 line, 3/2 point contact)".to_owned(),
            ),
            Self::Restitution { law, value } => (
                format!("coefficient of restitution of {law} is {value}"),
                "it must lie in (0, 1]".to_owned(),
            ),
            Self::KelvinVoigt { what, value } => (
                format!("Kelvin-Voigt damping {what} is {value}"),
                "it must be finite and not negative".to_owned(),
            ),
            Self::UnresolvedRatio => (
                "a damping ratio needs stiffness and reduced mass".to_owned(),
                "call Damping::resolved first, or give c in N s/m".to_owned(),
            ),
            Self::RatioOfNonlinearLaw { exponent } => (
                format!(
                    "a damping ratio is defined for the linear law only, the exponent is \
                     {exponent}"
                ),
                "give c in N s/m, or a restitution law".to_owned(),
            ),
            Self::NotPositive { what, value } => (
                format!("{what} is {value}"),
                "it must be finite and positive".to_owned(),
            ),
            Self::Friction { what, value, rule } => {
                (format!("friction {what} is {value}"), (*rule).to_owned())
            }
        };
        Reason { cause, help }
    }
}

impl fmt::Display for LawError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.reason().fmt(f)
    }
}

impl std::error::Error for LawError {}

impl From<&LawError> for Reason {
    fn from(e: &LawError) -> Self {
        e.reason()
    }
}

/// How a contact dissipates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Damping {
    /// Elastic contact.
    None,
    /// Linear dashpot in parallel, `c` (N s/m).
    KelvinVoigt {
        /// Coefficient (N s/m).
        c: f64,
    },
    /// Linear dashpot given by its ratio to critical damping, `c = 2 ratio sqrt(k m)`.
    KelvinVoigtRatio {
        /// Damping ratio (-).
        ratio: f64,
    },
    /// Hunt and Crossley with restitution `e` (-).
    HuntCrossley {
        /// Coefficient of restitution aimed at, in (0, 1].
        e: f64,
    },
    /// Lankarani and Nikravesh with restitution `e` (-).
    LankaraniNikravesh {
        /// Coefficient of restitution aimed at, in (0, 1].
        e: f64,
    },
    /// Flores, Machado, Silva and Martins with restitution `e` (-).
    Flores {
        /// Coefficient of restitution aimed at, in (0, 1].
        e: f64,
    },
    /// Gonthier, McPhee, Lange and Piedboeuf with restitution `e` (-).
    Gonthier {
        /// Coefficient of restitution aimed at, in (0, 1].
        e: f64,
    },
}

impl Damping {
    /// Every id [`Damping::id`] can return.
    pub const IDS: [&'static str; 7] = [
        "none",
        "kelvin-voigt",
        "kelvin-voigt-ratio",
        "hunt-crossley",
        "lankarani-nikravesh",
        "flores",
        "gonthier",
    ];

    /// The name used in scenes and reports.
    pub fn id(&self) -> &'static str {
        let index = match self {
            Damping::None => 0,
            Damping::KelvinVoigt { .. } => 1,
            Damping::KelvinVoigtRatio { .. } => 2,
            Damping::HuntCrossley { .. } => 3,
            Damping::LankaraniNikravesh { .. } => 4,
            Damping::Flores { .. } => 5,
            Damping::Gonthier { .. } => 6,
        };
        Self::IDS[index]
    }

    /// The same damping with a ratio turned into `c = 2 ratio sqrt(k m)` (N s/m); every other kind
    /// is returned as it is. `stiffness` (N/m) is the linear contact stiffness, `reduced_mass`
    /// (kg) that of the two bodies along the line of action.
    ///
    /// # Errors
    /// [`LawError`] when the law is nonlinear or a value is not positive.
    pub fn resolved(
        self,
        exponent: f64,
        stiffness: f64,
        reduced_mass: f64,
    ) -> Result<Damping, LawError> {
        let Damping::KelvinVoigtRatio { ratio } = self else {
            return Ok(self);
        };
        if !(ratio.is_finite() && ratio >= 0.0) {
            return Err(LawError::KelvinVoigt {
                what: "ratio",
                value: ratio,
            });
        }
        if exponent != 1.0 {
            return Err(LawError::RatioOfNonlinearLaw { exponent });
        }
        for (what, value) in [
            ("contact stiffness (N/m)", stiffness),
            ("reduced mass (kg)", reduced_mass),
        ] {
            if !(value.is_finite() && value > 0.0) {
                return Err(LawError::NotPositive { what, value });
            }
        }
        Ok(Damping::KelvinVoigt {
            c: 2.0 * ratio * (stiffness * reduced_mass).sqrt(),
        })
    }

    /// A law that is given by its coefficient of restitution, by its id.
    #[must_use]
    pub fn of_restitution(id: &str, e: f64) -> Option<Damping> {
        let all = [
            Damping::HuntCrossley { e },
            Damping::LankaraniNikravesh { e },
            Damping::Flores { e },
            Damping::Gonthier { e },
        ];
        all.into_iter().find(|law| law.id() == id)
    }

    /// The factor chi of `1 + chi d'/v0`, zero for laws without it.
    fn chi(&self) -> f64 {
        match *self {
            Damping::HuntCrossley { e } => 1.5 * (1.0 - e),
            Damping::LankaraniNikravesh { e } => 0.75 * (1.0 - e * e),
            Damping::Flores { e } => 1.6 * (1.0 - e) / e,
            Damping::Gonthier { e } => (1.0 - e * e) / e,
            Damping::None | Damping::KelvinVoigt { .. } | Damping::KelvinVoigtRatio { .. } => 0.0,
        }
    }

    fn restitution(&self) -> Option<f64> {
        match *self {
            Damping::HuntCrossley { e }
            | Damping::LankaraniNikravesh { e }
            | Damping::Flores { e }
            | Damping::Gonthier { e } => Some(e),
            Damping::None | Damping::KelvinVoigt { .. } | Damping::KelvinVoigtRatio { .. } => None,
        }
    }
}

/// Normal force of a law and its derivatives.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LawForce {
    /// Normal force `N` (N).
    pub n: f64,
    /// `dN/dg` (N/m).
    pub dn_dg: f64,
    /// `dN/dg'` (N s/m).
    pub dn_dgdot: f64,
    /// `dN/dk` (m^n).
    pub dn_dk: f64,
}

/// The exponents met in practice have cheap powers.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Power {
    One,
    ThreeHalves,
    General,
}

/// A validated normal contact law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Law {
    exponent: f64,
    damping: Damping,
    power: Power,
    c: f64,
    chi: f64,
    speed_floor: f64,
}

impl Default for Law {
    /// The linear elastic law.
    fn default() -> Self {
        Law::elastic()
    }
}

impl Law {
    /// A law with the penetration exponent `n` in [1, 3] and a damping.
    ///
    /// # Errors
    /// [`LawError`] names the parameter out of range; a damping ratio must be
    /// [resolved](Damping::resolved) first.
    pub fn new(exponent: f64, damping: Damping) -> Result<Law, LawError> {
        if !(1.0..=3.0).contains(&exponent) {
            return Err(LawError::Exponent { value: exponent });
        }
        let c = match damping {
            Damping::KelvinVoigt { c } if !(c.is_finite() && c >= 0.0) => {
                return Err(LawError::KelvinVoigt {
                    what: "c (N s/m)",
                    value: c,
                });
            }
            Damping::KelvinVoigt { c } => c,
            Damping::KelvinVoigtRatio { .. } => return Err(LawError::UnresolvedRatio),
            _ => 0.0,
        };
        if let Some(value) = damping.restitution().filter(|e| !(*e > 0.0 && *e <= 1.0)) {
            return Err(LawError::Restitution {
                law: damping.id(),
                value,
            });
        }
        let power = if exponent == 1.0 {
            Power::One
        } else if exponent == 1.5 {
            Power::ThreeHalves
        } else {
            Power::General
        };
        Ok(Law {
            exponent,
            damping,
            power,
            c,
            chi: damping.chi(),
            speed_floor: DEFAULT_SPEED_FLOOR,
        })
    }

    /// The linear elastic law `N = k d`.
    pub const fn elastic() -> Law {
        Law {
            exponent: 1.0,
            damping: Damping::None,
            power: Power::One,
            c: 0.0,
            chi: 0.0,
            speed_floor: DEFAULT_SPEED_FLOOR,
        }
    }

    /// The elastic part of the law.
    pub const fn undamped(&self) -> Law {
        Law {
            damping: Damping::None,
            c: 0.0,
            chi: 0.0,
            ..*self
        }
    }

    /// The same law with its constant damper multiplied: what a point has that stands for a share of the contact.
    #[inline]
    pub fn shared(&self, share: f64) -> Law {
        let damping = match self.damping {
            Damping::KelvinVoigt { c } => Damping::KelvinVoigt { c: c * share },
            other => other,
        };
        Law {
            damping,
            c: self.c * share,
            ..*self
        }
    }

    /// The same law with another floor of the impact speed (m/s). A contact that closes from rest
    /// under load has `v0 = 0` and `d'/v0` would be infinite, so `v0` enters as `max(v0, floor)`;
    /// impacts slower than the floor are damped less than `e` asks for.
    ///
    /// # Errors
    /// [`LawError::NotPositive`] unless finite and positive.
    pub fn with_speed_floor(mut self, floor: f64) -> Result<Law, LawError> {
        if !(floor.is_finite() && floor > 0.0) {
            return Err(LawError::NotPositive {
                what: "floor of the impact speed (m/s)",
                value: floor,
            });
        }
        self.speed_floor = floor;
        Ok(self)
    }

    /// Exponent `n` of the penetration.
    pub fn exponent(&self) -> f64 {
        self.exponent
    }

    /// The damping.
    pub fn damping(&self) -> Damping {
        self.damping
    }

    /// Factor chi of `1 + chi d'/v0`; zero for elastic and Kelvin-Voigt contact.
    pub fn chi(&self) -> f64 {
        self.chi
    }

    /// Id of the damping, as in scenes and reports.
    pub fn id(&self) -> &'static str {
        self.damping.id()
    }

    /// Whether the law uses the speed stored at first touch.
    pub fn needs_impact_speed(&self) -> bool {
        self.chi > 0.0
    }

    /// Whether a closed-open cycle loses energy.
    pub fn is_dissipative(&self) -> bool {
        self.chi > 0.0 || self.c > 0.0
    }

    /// `(sign(d) |d|^n, n |d|^(n-1))`.
    #[inline]
    fn powers(&self, d: f64) -> (f64, f64) {
        match self.power {
            Power::One => (d, 1.0),
            Power::ThreeHalves => {
                let root = d.abs().sqrt();
                (d * root, 1.5 * root)
            }
            Power::General => {
                let below = d.abs().powf(self.exponent - 1.0);
                (d * below, self.exponent * below)
            }
        }
    }

    /// The smooth branch: odd in the penetration, neither clipped nor switched off when open.
    /// `k` (N/m^n) is the stiffness at this point, `v0` (m/s) the impact speed (ignored by laws
    /// that do not [need](Law::needs_impact_speed) it).
    #[inline]
    pub fn smooth(&self, g: f64, g_rate: f64, v0: f64, k: f64) -> LawForce {
        let (power, slope) = self.powers(-g);
        // `max` returns the floor for a NaN v0, which is what an unset discrete state slot holds.
        let per_speed = self.chi / v0.max(self.speed_floor);
        let factor = 1.0 - per_speed * g_rate;
        LawForce {
            n: k * power * factor - self.c * g_rate,
            dn_dg: -k * slope * factor,
            dn_dgdot: -k * power * per_speed - self.c,
            dn_dk: power * factor,
        }
    }

    /// The force that acts: all zero when the gap is open (`g >= 0`) or the smooth branch would
    /// pull. NaN passes through so that the caller can detect it.
    #[inline]
    pub fn clipped(&self, g: f64, g_rate: f64, v0: f64, k: f64) -> LawForce {
        if g >= 0.0 {
            return LawForce::default();
        }
        let force = self.smooth(g, g_rate, v0, k);
        if force.n < 0.0 {
            return LawForce::default();
        }
        force
    }

    /// Elastic energy `k d^(n+1) / (n+1)` (J), zero when open.
    #[inline]
    pub fn potential(&self, g: f64, k: f64) -> f64 {
        k * self.d_potential_dk(g)
    }

    /// Derivative of [`Law::potential`] with respect to `k` (m^(n+1)); times `dk/dt` it is the
    /// parametric power of a varying stiffness.
    #[inline]
    pub fn d_potential_dk(&self, g: f64) -> f64 {
        if g >= 0.0 {
            return 0.0;
        }
        let d = -g;
        d * self.powers(d).0 / (self.exponent + 1.0)
    }
}

/// The restitution a law with factor `chi >= 0` gives in a free impact, whatever its exponent: the
/// root in `(0, 1]` of `chi (1 + r) = ln((1 + chi) / (1 - chi r))`.
pub fn realised_restitution(chi: f64) -> f64 {
    if chi.is_nan() || chi <= 0.0 {
        return 1.0;
    }
    if chi < 1e-4 {
        // The logarithms cancel here; the series of the root is r = 1 - 2 chi / 3 + O(chi^2).
        return 1.0 - 2.0 * chi / 3.0 + 4.0 * chi * chi / 9.0;
    }
    let residual = |r: f64| chi * (1.0 + r) - chi.ln_1p() + (-chi * r).ln_1p();
    // The residual is positive at r = 0 and falls to minus infinity (or below zero) at the bound.
    let (mut low, mut high) = (0.0, (1.0 / chi).min(1.0));
    for _ in 0..200 {
        let mid = 0.5 * (low + high);
        if residual(mid) > 0.0 {
            low = mid;
        } else {
            high = mid;
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests;
