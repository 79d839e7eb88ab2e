//! Damping laws of a contact.

use super::error::LawError;

/// Damping of a contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Damping {
    /// The contact is elastic.
    None,
    /// Linear dashpot in parallel with the coefficient `c` (N s/m).
    KelvinVoigt {
        /// Damping coefficient (N s/m).
        c: f64,
    },
    /// Linear dashpot in parallel whose force is at most the elastic one, `|c d'| <= k d^n`: it has no jump at first
    /// contact and no tension at the end.
    KelvinVoigtBounded {
        /// Damping coefficient (N s/m).
        c: f64,
    },
    /// Linear dashpot given by its ratio to critical damping, `c = 2 ratio sqrt(k m)`.
    KelvinVoigtRatio {
        /// Ratio to critical damping (-).
        ratio: f64,
    },
    /// Damper proportional to the force, with a given ratio to critical damping at the load of the mesh, `N = k d^n (1 +
    /// d'/v_L)`: smooth where a contact opens and closes.
    RatioAtLoad {
        /// Damping ratio at the load (-).
        ratio: f64,
    },
    /// Hunt and Crossley with restitution `e` (-).
    HuntCrossley {
        /// Intended coefficient of restitution, in (0, 1].
        e: f64,
    },
    /// Lankarani and Nikravesh with restitution `e` (-).
    LankaraniNikravesh {
        /// Intended coefficient of restitution, in (0, 1].
        e: f64,
    },
    /// Flores, Machado, Silva and Martins with restitution `e` (-).
    Flores {
        /// Intended coefficient of restitution, in (0, 1].
        e: f64,
    },
    /// Gonthier, McPhee, Lange and Piedboeuf with restitution `e` (-).
    Gonthier {
        /// Intended coefficient of restitution, in (0, 1].
        e: f64,
    },
}

impl Damping {
    /// Every identifier that [`Damping::id`] can return.
    pub const IDS: [&'static str; 9] = [
        "none",
        "kelvin-voigt",
        "kelvin-voigt-ratio",
        "ratio-at-load",
        "hunt-crossley",
        "lankarani-nikravesh",
        "flores",
        "gonthier",
        "kelvin-voigt-bounded",
    ];

    /// Returns the identifier in scenes and reports.
    pub fn id(&self) -> &'static str {
        let index = match self {
            Damping::None => 0,
            Damping::KelvinVoigt { .. } => 1,
            Damping::KelvinVoigtRatio { .. } => 2,
            Damping::RatioAtLoad { .. } => 3,
            Damping::HuntCrossley { .. } => 4,
            Damping::LankaraniNikravesh { .. } => 5,
            Damping::Flores { .. } => 6,
            Damping::Gonthier { .. } => 7,
            Damping::KelvinVoigtBounded { .. } => 8,
        };
        Self::IDS[index]
    }

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
