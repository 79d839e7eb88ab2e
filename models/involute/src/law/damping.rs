//! Damping laws of a contact: their declaration, their keys in scene files, and all that differs between them.

use super::error::LawError;
use serde::{Deserialize, Serialize};

/// Keys of a damping law in scene files.
#[derive(Clone, Copy, Debug)]
pub struct DampingKeys {
    /// Identifier of the law.
    pub id: &'static str,
    /// Keys with their units in their names, each with its meaning.
    pub keys: &'static [(&'static str, &'static str)],
}

/// Declares every damping law once: variant, identifier in scenes and reports, and its parameter with its key and meaning.
macro_rules! damping_laws {
    ($(
        $(#[$outer:meta])+
        $law:ident = $id:literal $({ $(#[doc = $meaning:literal])+ $field:ident = $key:literal })?,
    )+) => {
        /// Damping of a contact; scene files have the identifier under the key `law`.
        #[derive(Debug, Clone, Copy, Default, PartialEq, Deserialize, Serialize)]
        #[serde(rename = "<law>", deny_unknown_fields)]
        pub enum Damping {
            $(
                $(#[$outer])+
                #[serde(rename = $id)]
                $law $({ $(#[doc = $meaning])+ #[serde(rename = $key)] $field: f64 })?,
            )+
        }

        impl Damping {
            /// Identifiers and keys of all laws.
            pub const LAWS: &'static [DampingKeys] = &[
                $(DampingKeys { id: $id, keys: &[$(($key, concat!($($meaning),+)))?] },)+
            ];

            /// Returns the identifier in scenes and reports.
            pub fn id(&self) -> &'static str {
                match self {
                    $(Damping::$law { .. } => $id,)+
                }
            }
        }
    };
}

damping_laws! {
    /// The contact is elastic.
    #[default]
    None = "none",
    /// Linear dashpot in parallel with a coefficient.
    KelvinVoigt = "kelvin-voigt" {
        /// damper in N s/m, zero or more, for example { law = "kelvin-voigt", damping_ns_per_m = 500.0 }
        c = "damping_ns_per_m"
    },
    /// Linear dashpot given by its ratio to critical damping, `c = 2 ratio sqrt(k m)`.
    KelvinVoigtRatio = "kelvin-voigt-ratio" {
        /// damping over critical damping of the pair, for example { law = "kelvin-voigt-ratio", ratio = 0.05 }
        ratio = "ratio"
    },
    /// Damper proportional to the force, with a given ratio to critical damping at the load of the mesh, `N = k d^n (1 +
    /// d'/v_L)`: smooth where a contact opens and closes.
    RatioAtLoad = "ratio-at-load" {
        /// damping over critical damping at the load of the mesh, for example { law = "ratio-at-load", ratio = 0.02 }
        ratio = "ratio"
    },
    /// Hunt and Crossley with a restitution.
    HuntCrossley = "hunt-crossley" {
        /// coefficient of restitution, above 0 up to 1, for example { law = "hunt-crossley", e = 0.9 }
        e = "e"
    },
    /// Lankarani and Nikravesh with a restitution.
    LankaraniNikravesh = "lankarani-nikravesh" {
        /// coefficient of restitution, above 0 up to 1, for example { law = "lankarani-nikravesh", e = 0.9 }
        e = "e"
    },
    /// Flores, Machado, Silva and Martins with a restitution.
    Flores = "flores" {
        /// coefficient of restitution, above 0 up to 1, for example { law = "flores", e = 0.9 }
        e = "e"
    },
    /// Gonthier, McPhee, Lange and Piedboeuf with a restitution.
    Gonthier = "gonthier" {
        /// coefficient of restitution, above 0 up to 1, for example { law = "gonthier", e = 0.9 }
        e = "e"
    },
    /// Linear dashpot in parallel whose force is at most the elastic one, `|c d'| <= k d^n`: it has no jump at first
    /// contact and no tension at the end.
    KelvinVoigtBounded = "kelvin-voigt-bounded" {
        /// damper in N s/m, zero or more, for example { law = "kelvin-voigt-bounded", damping_ns_per_m = 500.0 }
        c = "damping_ns_per_m"
    },
}

impl Damping {
    /// Converts a ratio to critical damping to `c = 2 ratio sqrt(k m)` (N s/m) and returns every other kind unchanged.
    /// `stiffness` (N/m) is the linear contact stiffness, `reduced_mass` (kg) that of the two bodies along the line of
    /// action.
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

    /// Checks the parameters and returns the coefficient of the dashpot (N s/m), zero for laws without it.
    ///
    /// # Errors
    /// [`LawError`] names the parameter out of range; a ratio must be [resolved](Self::resolved) first.
    pub(super) fn checked_dashpot(&self) -> Result<f64, LawError> {
        let not_negative = |what, value: f64| match value.is_finite() && value >= 0.0 {
            true => Ok(value),
            false => Err(LawError::KelvinVoigt { what, value }),
        };
        if let Some(value) = self.restitution().filter(|e| !(*e > 0.0 && *e <= 1.0)) {
            let law = self.id();
            return Err(LawError::Restitution { law, value });
        }
        match *self {
            Damping::KelvinVoigt { c } | Damping::KelvinVoigtBounded { c } => {
                not_negative("c (N s/m)", c)
            }
            Damping::KelvinVoigtRatio { .. } => Err(LawError::UnresolvedRatio),
            Damping::RatioAtLoad { ratio } => not_negative("ratio at load", ratio).map(|_| 0.0),
            _ => Ok(0.0),
        }
    }

    /// Returns the damping of a share of a contact: constant dashpots are multiplied by it.
    #[inline]
    pub(super) fn shared(self, share: f64) -> Damping {
        match self {
            Damping::KelvinVoigt { c } => Damping::KelvinVoigt { c: c * share },
            Damping::KelvinVoigtBounded { c } => Damping::KelvinVoigtBounded { c: c * share },
            other => other,
        }
    }

    /// True if the load of the mesh determines the damping.
    pub fn is_by_load(&self) -> bool {
        matches!(self, Damping::RatioAtLoad { .. })
    }

    /// Returns the damping ratio of the law for small vibrations about a load: the loss of a restitution `e` in half a
    /// period of a linear oscillator, `zeta = -ln(e)/pi`; zero for laws independent of a load.
    pub(super) fn ratio_at_load(&self) -> f64 {
        match *self {
            Damping::RatioAtLoad { ratio } => ratio,
            _ => self
                .restitution()
                .map_or(0.0, |e| -e.ln() / std::f64::consts::PI),
        }
    }

    /// Returns the factor chi of `1 + chi d'/v`, zero for laws without it.
    pub(super) fn chi(&self) -> f64 {
        match *self {
            Damping::HuntCrossley { e } => 1.5 * (1.0 - e),
            Damping::LankaraniNikravesh { e } => 0.75 * (1.0 - e * e),
            Damping::Flores { e } => 1.6 * (1.0 - e) / e,
            Damping::Gonthier { e } => (1.0 - e * e) / e,
            // A ratio at load has a factor once the load is known.
            Damping::None
            | Damping::KelvinVoigt { .. }
            | Damping::KelvinVoigtBounded { .. }
            | Damping::KelvinVoigtRatio { .. }
            | Damping::RatioAtLoad { .. } => 0.0,
        }
    }

    pub(super) fn restitution(&self) -> Option<f64> {
        match *self {
            Damping::HuntCrossley { e }
            | Damping::LankaraniNikravesh { e }
            | Damping::Flores { e }
            | Damping::Gonthier { e } => Some(e),
            Damping::None
            | Damping::KelvinVoigt { .. }
            | Damping::KelvinVoigtBounded { .. }
            | Damping::KelvinVoigtRatio { .. }
            | Damping::RatioAtLoad { .. } => None,
        }
    }
}

/// Returns the restitution of a law with factor `chi >= 0` in a free impact, whatever its exponent: the root in `(0,
/// 1]` of `chi (1 + r) = ln((1 + chi) / (1 - chi r))`.
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
