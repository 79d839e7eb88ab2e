//! Dry friction of a guide: a force of constant magnitude against the motion, with presliding.
//!
//! ```text
//! regularised    F = -F_c tanh(v / v_ref)
//! stick-slip     F = -F_c z,    dz/dx = (1 - z sign(dx)) / l
//! ```
//!
//! The first form carries no static load: it creeps where friction should stick. The second (P. R. Dahl, *A solid
//! friction model*, Aerospace Corp. TOR-0158, 1968) carries a force below `F_c` permanently, by a displacement of the
//! order of `l`. It is a function of the displacement alone: from the fraction `z0` at the position `x0` of the last
//! accepted step,
//!
//! ```text
//! z = s + (z0 - s) exp(-|x - x0| / l),    s = sign(x - x0)
//! ```
//!
//! exactly, however long the step and whatever the speed, as long as the motion does not turn within it. Within a step it
//! is a spring of the slope `F_c (1 - s z)/l`, at most `2 F_c/l`, as one that has slid turns back.

use super::error::LawError;
use super::friction::FrictionForm;

/// Dry friction of a guide under a constant normal force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DryFriction {
    force: f64,
    form: FrictionForm,
}

/// Fraction of the sliding force that acts against the motion, and its slopes by position and speed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Part {
    /// Fraction from -1 to 1.
    pub z: f64,
    /// Derivative by the position [1/m or 1/rad].
    pub by_place: f64,
    /// Derivative by the speed [s/m or s/rad].
    pub by_speed: f64,
}

impl DryFriction {
    /// Creates friction with the sliding force `force >= 0` [N], or torque [N m].
    ///
    /// # Errors
    /// [`LawError::Friction`] names the parameter out of range.
    pub fn new(force: f64, form: FrictionForm) -> Result<Self, LawError> {
        if !(force.is_finite() && force >= 0.0) {
            return Err(LawError::Friction {
                what: "force [N] or torque [N m]",
                value: force,
                rule: "it must be finite and not negative",
            });
        }
        form.check()?;
        Ok(DryFriction { force, form })
    }

    /// Returns the sliding force [N] or torque [N m].
    pub fn force(&self) -> f64 {
        self.force
    }

    /// Returns the form of the rise from rest.
    pub fn form(&self) -> FrictionForm {
        self.form
    }

    /// Returns true for stick-slip friction, which carries static loads.
    pub fn sticks(&self) -> bool {
        matches!(self.form, FrictionForm::StickSlip(_))
    }

    /// Returns the fraction at a position and speed, from the fraction `start[1]` at the position `start[0]`.
    #[inline]
    pub fn part(&self, x: f64, v: f64, start: [f64; 2]) -> Part {
        match self.form {
            FrictionForm::Regularised(v_ref) => {
                let z = (v / v_ref).tanh();
                Part {
                    z,
                    by_place: 0.0,
                    by_speed: (1.0 - z * z) / v_ref,
                }
            }
            FrictionForm::StickSlip(length) => {
                let [x0, z0] = start;
                let way = x - x0;
                // Without displacement the velocity determines the direction.
                let s = if way == 0.0 { v } else { way }.signum();
                let left = (z0 - s) * (-way.abs() / length).exp();
                Part {
                    z: s + left,
                    by_place: -s * left / length,
                    by_speed: 0.0,
                }
            }
        }
    }

    /// Returns the largest slopes of the force by position and speed [N/m], [N s/m].
    pub fn steepest(&self) -> [f64; 2] {
        match self.form {
            FrictionForm::Regularised(v_ref) => [0.0, self.force / v_ref],
            FrictionForm::StickSlip(length) => [2.0 * self.force / length, 0.0],
        }
    }
}
