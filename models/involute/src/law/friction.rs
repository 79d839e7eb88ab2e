//! Tangential force of a contact: Coulomb friction with a coefficient that is given or that of a lubricated mesh, in two
//! forms that have a derivative at rest.
//!
//! ```text
//! regularised    T = -mu N tanh(v / v_ref)
//! stick-slip     T = -mu N z,    z' = (v - |v| z) / l
//! ```
//!
//! The first form carries no static load, so that it creeps where friction should stick; the second carries static
//! loads by an elastic displacement before it slides (P. R. Dahl, *A solid friction model*, Aerospace Corp. TOR-0158,
//! 1968): `z` from -1 to 1 is the fraction of the sliding force, with a slope of `1/l` at rest. Over a step of length
//! `h` from `z0` at a steady speed
//!
//! ```text
//! z = s + (z0 - s) exp(-|v| h / l),    s = sign(v)
//! ```
//!
//! which never leaves its range, whatever the step: nothing to chatter.
//!
//! The mean coefficient of a lubricated mesh under mixed friction is that of H. Schlenk (Dissertation, TU Munich 1994;
//! G. Niemann, H. Winter, *Maschinenelemente* 2; ISO/TR 14179-2), in N/mm, m/s, mm, mPa s and um
//!
//! ```text
//! mu = 0.048 (F_bt / b / (v_S rho))^0.2 eta^-0.05 Ra^0.25 X_L
//! ```
//!
//! with the load per width, at least 150 N/mm, and at the pitch point the sum of both speeds along the profile and the
//! relative radius of curvature. It is held below [`DRY`], where slow gears have no film.

use super::error::LawError;

/// Largest coefficient of a film: that of boundary lubrication.
const DRY: f64 = 0.2;
/// Smallest load per width in the range of the film formula [N/m].
const LEAST_LOAD: f64 = 150e3;

/// Lubricant of a mesh and roughness of its flanks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Film {
    /// Dynamic viscosity at operating temperature [Pa s].
    pub viscosity: f64,
    /// Arithmetic mean roughness of both flanks [m].
    pub roughness: f64,
    /// Lubricant factor `X_L`: 1 for mineral oil, about 0.6 for polyglycols that dissolve in water, 0.8 for other
    /// synthetic oils.
    pub lubricant: f64,
}

/// Mesh data on which the friction coefficient of a film depends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshFilm {
    /// Load per width [N/m].
    pub force_per_width: f64,
    /// Relative radius of curvature at the pitch point [m].
    pub radius: f64,
    /// Sum of the speeds of both flanks along the profile at the pitch point, per unit speed of the first hub.
    pub per_speed: f64,
}

/// Rise of friction from rest to sliding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FrictionForm {
    /// Rise over a sliding speed [m/s], at which 76 % of the sliding force are reached.
    Regularised(f64),
    /// Rise over a displacement [m], after which 63 % of the sliding force are reached.
    StickSlip(f64),
}

/// Coulomb friction with presliding and an optional film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction {
    mu: f64,
    form: FrictionForm,
    film: Option<Film>,
    /// Sum of the flank speeds per unit speed of the first hub, for a film in its mesh.
    per_speed: f64,
    /// Initial fraction of the sliding force of a step, and the time since then [s], for stick-slip friction.
    start: (f64, f64),
}

/// Friction force and its derivatives.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FrictionForce {
    /// Tangential force along the sliding direction (N), opposite in sign to the sliding speed.
    pub f: f64,
    /// Derivative `dF/dN` (-).
    pub df_dn: f64,
    /// Derivative `dF/dv` (N s/m).
    pub df_dv: f64,
}

fn check(what: &'static str, value: f64, rule: &'static str, fits: bool) -> Result<(), LawError> {
    if value.is_finite() && fits {
        return Ok(());
    }
    Err(LawError::Friction { what, value, rule })
}

impl FrictionForm {
    pub(super) fn check(self) -> Result<(), LawError> {
        let (what, value, rule) = match self {
            FrictionForm::Regularised(v) => (
                "regularisation speed [m/s]",
                v,
                "it must be finite and positive (1 % of the sliding speed is usual)",
            ),
            FrictionForm::StickSlip(l) => (
                "displacement before sliding [m]",
                l,
                "it must be finite and positive (1e-6 m is usual)",
            ),
        };
        check(what, value, rule, value > 0.0)
    }
}

impl Friction {
    /// Creates friction with coefficient `mu >= 0` (-), regularised over the speed `v_ref > 0` (m/s) at which 76 % of
    /// the sliding force is reached.
    ///
    /// # Errors
    /// [`LawError::Friction`] names the parameter out of range.
    pub fn new(mu: f64, v_ref: f64) -> Result<Friction, LawError> {
        Self::of_form(mu, FrictionForm::Regularised(v_ref))
    }

    /// Creates friction with coefficient `mu >= 0` (-) in either form.
    ///
    /// # Errors
    /// [`LawError::Friction`] names the parameter out of range.
    pub fn of_form(mu: f64, form: FrictionForm) -> Result<Friction, LawError> {
        let rule = "it must be finite and not negative";
        check("coefficient mu", mu, rule, mu >= 0.0)?;
        form.check()?;
        Ok(Friction {
            mu,
            form,
            film: None,
            per_speed: 0.0,
            start: (0.0, 0.0),
        })
    }

    /// Creates friction of a lubricated mesh; [`Self::in_mesh`] computes its coefficient.
    ///
    /// # Errors
    /// [`LawError::Friction`] names the parameter out of range.
    pub fn of_film(film: Film, form: FrictionForm) -> Result<Friction, LawError> {
        let rule = "it must be finite and positive";
        for (what, value) in [
            ("viscosity [Pa s]", film.viscosity),
            ("roughness [m]", film.roughness),
            ("lubricant factor", film.lubricant),
        ] {
            check(what, value, rule, value > 0.0)?;
        }
        Ok(Friction {
            film: Some(film),
            ..Self::of_form(DRY, form)?
        })
    }

    /// Computes the coefficient of a film from the load and the speeds of a mesh; other friction is returned
    /// unchanged.
    #[must_use]
    pub fn in_mesh(self, mesh: &MeshFilm) -> Friction {
        let Some(film) = self.film else { return self };
        let load = mesh.force_per_width.max(LEAST_LOAD);
        // At a sum of the speeds of 1 m/s; N/mm over mm is N/m over m times 1e-6.
        let pressure = (load / mesh.radius) * 1e-6;
        let oil = (1e3 * film.viscosity).powf(-0.05) * (1e6 * film.roughness).powf(0.25);
        Friction {
            mu: 0.048 * pressure.powf(0.2) * oil * film.lubricant,
            per_speed: mesh.per_speed,
            ..self
        }
    }

    /// Returns the friction at a speed of the first hub.
    #[inline]
    #[must_use]
    pub fn at_speed(self, speed: f64) -> Friction {
        if self.film.is_none() {
            return self;
        }
        let sum = (self.per_speed * speed).abs();
        Friction {
            mu: (self.mu * sum.powf(-0.2)).min(DRY),
            film: None,
            ..self
        }
    }

    /// Returns stick-slip friction at a time [s] after a fraction of the sliding force was reached.
    #[inline]
    #[must_use]
    pub fn after(self, part: f64, time: f64) -> Friction {
        Friction {
            start: (part, time),
            ..self
        }
    }

    /// Returns the coefficient of friction (-); for a film the largest, until a speed is set.
    pub fn mu(&self) -> f64 {
        if self.film.is_some() { DRY } else { self.mu }
    }

    /// Returns the form of the rise from rest.
    pub fn form(&self) -> FrictionForm {
        self.form
    }

    /// Returns the film, if it determines the coefficient.
    pub fn film(&self) -> Option<Film> {
        self.film
    }

    /// Returns true for stick-slip friction, which carries static loads and has a history.
    pub fn sticks(&self) -> bool {
        matches!(self.form, FrictionForm::StickSlip(_))
    }

    /// Returns the fraction of the sliding force at the sliding speed `v` (m/s), and its derivative by the speed.
    #[inline]
    pub fn part(&self, v: f64) -> (f64, f64) {
        match self.form {
            FrictionForm::Regularised(v_ref) => {
                let t = (v / v_ref).tanh();
                (t, (1.0 - t * t) / v_ref)
            }
            FrictionForm::StickSlip(length) => {
                let (before, time) = self.start;
                let (sign, per_speed) = (v.signum(), time / length);
                let left = (before - sign) * (-v.abs() * per_speed).exp();
                (sign + left, -sign * left * per_speed)
            }
        }
    }

    /// Computes the friction force under the normal force `n` (N) at the sliding speed `v` (m/s).
    #[inline]
    pub fn force(&self, n: f64, v: f64) -> FrictionForce {
        let (part, slope) = self.part(v);
        FrictionForce {
            f: -self.mu * n * part,
            df_dn: -self.mu * part,
            df_dv: -self.mu * n * slope,
        }
    }
}
