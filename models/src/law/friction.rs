//! Tangential force of a contact: Coulomb friction, regularised so that it has a derivative at rest.

use super::error::LawError;

/// Regularised Coulomb friction `F_t = -mu N tanh(v / v_ref)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Friction {
    mu: f64,
    v_ref: f64,
}

/// Friction force and its derivatives.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FrictionForce {
    /// Tangential force along the sliding direction (N), opposite in sign to the sliding speed.
    pub f: f64,
    /// `dF/dN` (-).
    pub df_dn: f64,
    /// `dF/dv` (N s/m).
    pub df_dv: f64,
}

impl Friction {
    /// Friction with coefficient `mu >= 0` (-) and the regularisation speed `v_ref > 0` (m/s) at
    /// which 76 % of the sliding force is reached.
    ///
    /// # Errors
    /// [`LawError::Friction`] names the parameter out of range.
    pub fn new(mu: f64, v_ref: f64) -> Result<Friction, LawError> {
        if !(mu.is_finite() && mu >= 0.0) {
            return Err(LawError::Friction {
                what: "coefficient mu",
                value: mu,
                rule: "it must be finite and not negative",
            });
        }
        if !(v_ref.is_finite() && v_ref > 0.0) {
            return Err(LawError::Friction {
                what: "regularisation speed [m/s]",
                value: v_ref,
                rule: "it must be finite and positive (1 % of the sliding speed is usual)",
            });
        }
        Ok(Friction { mu, v_ref })
    }

    /// Coefficient of friction (-).
    pub fn mu(&self) -> f64 {
        self.mu
    }

    /// Regularisation speed (m/s).
    pub fn v_ref(&self) -> f64 {
        self.v_ref
    }

    /// Force under the normal force `n` (N) at the sliding speed `v` (m/s).
    #[inline]
    pub fn force(&self, n: f64, v: f64) -> FrictionForce {
        let t = (v / self.v_ref).tanh();
        FrictionForce {
            f: -self.mu * n * t,
            df_dn: -self.mu * t,
            df_dv: -self.mu * n * (1.0 - t * t) / self.v_ref,
        }
    }
}
