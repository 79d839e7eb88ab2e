//! Stages without teeth: a fixed ratio between two members that the scene does not resolve as a mesh.
//!
//! A stage stands for gears, belts or chains of a drive train whose teeth are not of interest. With the angles `theta`
//! of its two members and its ratio `i`,
//!
//! ```text
//! d = theta_2 - theta_1 / i,    T_2 = -(k d + c d'),    T_1 = -T_2 / i
//! ```
//!
//! with the stiffness `k` and the damper `c` at the second member. A rigid stage has `d = 0`. Power is conserved but
//! for the damper.

use super::scene::SceneSpec;
use crate::error::BuildError;

/// A stage without teeth between two members.
#[derive(Clone, Debug, PartialEq)]
pub struct StageSpec {
    /// Name, unique among the stages of a scene.
    pub name: String,
    /// Its members: gears by index and, behind them, bodies on shafts.
    pub members: [usize; 2],
    /// Speed of the first member over that of the second [-]; negative if they turn in opposite directions.
    pub ratio: f64,
    /// Torsional stiffness at the second member [N m/rad]; infinite for a rigid stage.
    pub stiffness: f64,
    /// Damping over stiffness [s]; zero for a rigid stage.
    pub damping: f64,
}

impl StageSpec {
    /// Checks the stage within its scene.
    ///
    /// # Errors
    /// [`BuildError`] about a ratio, stiffness or damping that cannot be, one member twice, a rack, or a gear on a
    /// planet carrier.
    pub(crate) fn check(&self, spec: &SceneSpec) -> Result<(), BuildError> {
        let refuse = |why: String, help: &str| Err(BuildError::stage(&self.name, (why, help)));
        if !(self.ratio.is_finite() && self.ratio != 0.0) {
            return refuse(
                format!("the ratio {} is not a number other than zero", self.ratio),
                "give the speed of the first member over that of the second",
            );
        }
        if self.stiffness.is_nan() || self.stiffness <= 0.0 {
            return refuse(
                format!("the stiffness {} N m/rad is not positive", self.stiffness),
                "give a positive one, or none for a rigid stage",
            );
        }
        if !(self.damping >= 0.0 && self.damping.is_finite()) {
            return refuse(
                format!("the damping {} s is not zero or positive", self.damping),
                "give a positive damper, or none",
            );
        }
        if self.stiffness.is_infinite() && self.damping > 0.0 {
            return refuse(
                "damping has no effect on a rigid stage".into(),
                "give its stiffness, or remove the damping",
            );
        }
        if self.members[0] == self.members[1] {
            return refuse(
                format!(
                    "it joins `{}` with itself",
                    spec.member_name(self.members[0])
                ),
                "name two members",
            );
        }
        for member in self.members {
            let name = spec.member_name(member);
            if spec.is_rack(member) {
                return refuse(
                    format!("`{name}` is a rack, which translates"),
                    "join gears or bodies on shafts",
                );
            }
            if spec.bodies().any(|b| b.planets.contains(&member)) {
                return refuse(
                    format!("`{name}` is on a planet carrier"),
                    "join members on fixed axes",
                );
            }
        }
        Ok(())
    }
}
