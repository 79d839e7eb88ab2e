//! Flank modifications as data: tip relief, profile crowning, lead crowning.
//!
//! Amounts are the material removed normal to the flank. Along the profile they vary with the
//! length of roll `s = sqrt(r^2 - r_b^2)` (equal to the path coordinate), as they do on a profile
//! measurement chart: relief as `((s - s_0)/(s_a - s_0))^n` with n = 1 or 2 from its start to the
//! tip, crowning as a parabola about the middle of the flank. Terms of ISO 21771-1 (flank
//! modifications); relief after H. Walker, *The Engineer* 166 (1938).

use super::error::{GeometryError, not_negative, positive};
use super::quantity::Quantity;

/// Course of a relief from its start to the tip.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ReliefShape {
    /// Grows in proportion to the length of roll.
    Linear,
    /// Grows with its square: smooth at the start.
    Parabolic,
}

/// Tip relief of both flanks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TipRelief {
    /// Material removed at the tip, normal to the flank (m), above 0.
    pub amount: f64,
    /// Radius at which the relief starts (m), from the form radius to below the tip radius.
    pub start_radius: f64,
    /// Course from the start to the tip.
    pub shape: ReliefShape,
}

/// Modifications of both flanks of every tooth; the default is none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Modifications {
    /// Tip relief, if any.
    pub tip_relief: Option<TipRelief>,
    /// Profile crowning: material removed at the tip and at the form circle (m), 0 or above.
    pub profile_crowning: f64,
    /// Lead crowning: material removed at both ends of the face (m), 0 or above.
    pub lead_crowning: f64,
}

impl Modifications {
    /// True when the flank is the plain involute.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }

    /// Checks signs and that the relief starts on the involute; radii in metre.
    pub(super) fn check(&self, r_form: f64, r_tip: f64) -> Result<(), GeometryError> {
        not_negative(Quantity::ProfileCrowning, self.profile_crowning)?;
        not_negative(Quantity::LeadCrowning, self.lead_crowning)?;
        if let Some(relief) = &self.tip_relief {
            positive(Quantity::ReliefAmount, relief.amount)?;
            positive(Quantity::ReliefStart, relief.start_radius)?;
            if relief.start_radius < r_form || relief.start_radius >= r_tip {
                return Err(GeometryError::ReliefStart {
                    start: relief.start_radius,
                    r_form,
                    r_tip,
                });
            }
        }
        Ok(())
    }

    /// Material removed (m) at length of roll `s`, given those of the form circle, of the tip and
    /// of the start of the relief; `zeta` in [-1, 1] runs over the face width.
    pub(super) fn removed(&self, s: f64, s_form: f64, s_tip: f64, s_relief: f64, zeta: f64) -> f64 {
        let s = s.clamp(s_form, s_tip);
        let relief = self.tip_relief.map_or(0.0, |relief| {
            let part = ((s - s_relief) / (s_tip - s_relief)).max(0.0);
            relief.amount
                * match relief.shape {
                    ReliefShape::Linear => part,
                    ReliefShape::Parabolic => part * part,
                }
        });
        let height = (2.0 * s - s_form - s_tip) / (s_tip - s_form);
        relief + self.profile_crowning * height * height + self.lead_crowning * zeta * zeta
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Gear, GearParams};

    fn gear(shape: ReliefShape) -> Gear {
        Gear::new(GearParams {
            teeth: 30,
            module: 3e-3,
            modifications: Modifications {
                tip_relief: Some(TipRelief {
                    amount: 20e-6,
                    start_radius: 46.5e-3,
                    shape,
                }),
                profile_crowning: 4e-6,
                lead_crowning: 6e-6,
            },
            ..GearParams::default()
        })
        .unwrap()
    }

    #[test]
    fn amounts_are_reached_where_they_are_defined() {
        let g = gear(ReliefShape::Linear);
        let at = |r, zeta| g.flank_deviation(r, zeta);
        assert!((at(g.r_tip(), 0.0) - 24e-6).abs() < 1e-18);
        assert!((at(g.r_tip(), -1.0) - 30e-6).abs() < 1e-18);
        assert!((at(g.r_form(), 0.0) - 4e-6).abs() < 1e-15);
        assert!((at(g.r_form(), 1.0) - 10e-6).abs() < 1e-15);
        assert!((at(g.r_root(), 0.5) - at(g.r_form(), 0.5)).abs() < 1e-18);
        let middle = 0.5 * (g.roll_length_form() + g.roll_length_tip());
        assert!(at(g.r_base().hypot(middle), 0.0) < 1e-18);
    }

    #[test]
    fn relief_grows_with_the_length_of_roll() {
        let (linear, parabolic) = (gear(ReliefShape::Linear), gear(ReliefShape::Parabolic));
        let s = 0.5 * (linear.roll_length(46.5e-3) + linear.roll_length_tip());
        let r = linear.r_base().hypot(s);
        let difference = linear.flank_deviation(r, 0.0) - parabolic.flank_deviation(r, 0.0);
        assert!((difference - 5e-6).abs() < 1e-15, "half against a quarter");
        assert_eq!(
            linear.flank_deviation(46.5e-3, 0.3),
            parabolic.flank_deviation(46.5e-3, 0.3)
        );
    }

    #[test]
    fn the_plain_flank_deviates_nowhere() {
        let plain = Gear::new(GearParams {
            teeth: 30,
            ..GearParams::default()
        })
        .unwrap();
        assert_eq!(plain.flank_deviation(plain.r_tip(), 1.0), 0.0);
    }
}
