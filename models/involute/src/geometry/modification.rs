//! Flank modifications as data: tip relief, profile crowning, lead crowning, end relief, helix slope, twist, and a measured
//! topography.
//!
//! Amounts are the material removed normal to the flank. Along the profile they vary with the
//! length of roll `s = sqrt(r^2 - r_b^2)` (equal to the path coordinate), as they do on a profile
//! measurement chart: relief as `((s - s_0)/(s_a - s_0))^n` with n = 1 or 2 from its start to the
//! tip, crowning as a parabola about the middle of the flank. Over the width they vary with `zeta` in [-1, 1] and with
//! `eta = (2 s - s_f - s_a)/(s_a - s_f)` in [-1, 1] over the profile:
//!
//! ```text
//! end relief    C ((l - t)/l)^n        n = 1 or 2, t <= l the distance to the end of the face
//! helix slope   (C zeta + |C|)/2       grows linearly from one end to the other, towards the upper one for C > 0
//! twist         (S zeta eta + |S|)/4   the profile slope (tip over form circle) varies by S from the lower to the upper end
//! topography    as given on a grid, see `topography`
//! ```
//!
//! Terms of ISO 21771-1 (flank modifications); relief after H. Walker, *The Engineer* 166 (1938).

use std::sync::Arc;

use super::Side;
use super::error::{GeometryError, finite, not_negative, positive};
use super::quantity::Quantity;
use super::topography::Topography;

/// Shape of a relief from its start to the tip or the end of the face.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Deserialize, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ReliefShape {
    /// The relief grows in proportion to the length of roll, or the distance.
    Linear,
    /// The relief grows with the square: smooth at the start.
    Parabolic,
}

impl ReliefShape {
    /// Returns the fraction of the amount at a fraction of the distance, with its first two derivatives by that
    /// fraction; 0 before the start.
    fn at(self, part: f64) -> [f64; 3] {
        if part <= 0.0 {
            return [0.0; 3];
        }
        match self {
            ReliefShape::Linear => [part, 1.0, 0.0],
            ReliefShape::Parabolic => [part * part, 2.0 * part, 2.0],
        }
    }
}

/// Tip relief of both flanks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TipRelief {
    /// Material removed at the tip, normal to the flank (m), above 0.
    pub amount: f64,
    /// Radius at which the relief starts (m), from the form radius to below the tip radius.
    pub start_radius: f64,
    /// Shape of the relief from the start to the tip.
    pub shape: ReliefShape,
}

/// Relief of both flanks at one end of the face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EndRelief {
    /// Material removed at the end, normal to the flank (m), above 0.
    pub amount: f64,
    /// Distance from the end at which the relief starts (m), up to the face width.
    pub length: f64,
    /// Shape of the relief from the start to the end.
    pub shape: ReliefShape,
}

/// Modifications of every tooth; the default is none. Pairs of values are those of left and right flanks.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Modifications {
    /// Tip relief of both flanks, if any.
    pub tip_relief: Option<TipRelief>,
    /// Profile crowning: material removed at the tip and at the form circle (m), 0 or above.
    pub profile_crowning: f64,
    /// Lead crowning: material removed at both ends of the face (m), 0 or above.
    pub lead_crowning: f64,
    /// End relief at the lower and the upper end of the face, along the gear axis.
    pub end_relief: [Option<EndRelief>; 2],
    /// Helix slope of left and right flanks: material removed at the upper end (m), if negative at the lower one.
    pub helix_slope: [f64; 2],
    /// Twist of left and right flanks: additional material removed from the tip relative to the form circle at the
    /// upper end, compared with the lower one (m).
    pub twist: [f64; 2],
    /// Measured topographies of left and right flanks.
    pub topography: [Option<Arc<Topography>>; 2],
}

/// Extent of a flank over profile and width.
#[derive(Clone, Copy, Debug)]
pub(super) struct FlankRange {
    /// Length of roll at the form circle, at the tip and at the start of the tip relief (m).
    pub roll: [f64; 3],
    /// Base radius (m).
    pub r_base: f64,
    /// Half of the face width (m).
    pub half_width: f64,
}

impl Modifications {
    /// Returns true when the flank is the plain involute.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }

    /// Returns true if the modifications vary over the width.
    pub fn vary_over_width(&self) -> bool {
        self.lead_crowning != 0.0
            || self.end_relief.iter().any(Option::is_some)
            || self.helix_slope != [0.0; 2]
            || Side::BOTH.iter().any(|side| self.vary_jointly(*side))
    }

    /// Returns true if the removed material on the flanks of a side is not a sum of a part along the profile and one
    /// over the width.
    pub fn vary_jointly(&self, side: Side) -> bool {
        let k = side.index();
        self.twist[k] != 0.0 || self.topography[k].is_some()
    }

    /// Returns true if left and right flanks are mirror images.
    pub fn are_symmetric(&self) -> bool {
        let same = |pair: [f64; 2]| pair[0] == pair[1];
        same(self.helix_slope) && same(self.twist) && self.topography[0] == self.topography[1]
    }

    /// Checks signs, and that reliefs start on the involute; radii and width are in metre. `inward` is true for an
    /// internal gear, whose tips have the smaller radius.
    pub(super) fn check(
        &self,
        radii: [f64; 2],
        width: f64,
        inward: bool,
    ) -> Result<(), GeometryError> {
        not_negative(Quantity::ProfileCrowning, self.profile_crowning)?;
        not_negative(Quantity::LeadCrowning, self.lead_crowning)?;
        let [r_form, r_tip] = radii;
        if let Some(relief) = &self.tip_relief {
            positive(Quantity::ReliefAmount, relief.amount)?;
            positive(Quantity::ReliefStart, relief.start_radius)?;
            let above = |a: f64, b: f64| if inward { a < b } else { a > b };
            if above(r_form, relief.start_radius) || !above(r_tip, relief.start_radius) {
                return Err(GeometryError::ReliefStart {
                    start: relief.start_radius,
                    r_form,
                    r_tip,
                });
            }
        }
        for relief in self.end_relief.iter().flatten() {
            positive(Quantity::EndReliefAmount, relief.amount)?;
            positive(Quantity::EndReliefLength, relief.length)?;
            if relief.length > width {
                return Err(GeometryError::EndRelief {
                    length: relief.length,
                    width,
                });
            }
        }
        for slope in self.helix_slope {
            finite(Quantity::HelixSlope, slope)?;
        }
        for twist in self.twist {
            finite(Quantity::Twist, twist)?;
        }
        for topography in self.topography.iter().flatten() {
            topography.check(radii, width)?;
        }
        Ok(())
    }

    /// Returns the material removed by modifications over the face width alone (m), at `zeta` in [-1, 1], and its
    /// derivative by `zeta`.
    pub(super) fn over_width(&self, side: Side, zeta: f64, half_width: f64) -> [f64; 2] {
        let mut removed = self.lead_crowning * zeta * zeta;
        let mut slope = 2.0 * self.lead_crowning * zeta;
        for (relief, sign) in self.end_relief.iter().zip([-1.0, 1.0]) {
            if let Some(relief) = relief {
                let to_the_end = half_width * (1.0 - sign * zeta);
                let [share, rise, _] = relief.shape.at(1.0 - to_the_end / relief.length);
                removed += relief.amount * share;
                slope += relief.amount * rise * sign * half_width / relief.length;
            }
        }
        let helix = self.helix_slope[side.index()];
        if helix != 0.0 {
            removed += 0.5 * (helix * zeta + helix.abs());
            slope += 0.5 * helix;
        }
        [removed, slope]
    }

    /// Returns the material removed (m) from the flanks of a side at length of roll `s`; `zeta` in [-1, 1] runs over
    /// the face width. Its first and second derivative by `s` and its derivative by `zeta` follow. Below the form
    /// circle and beyond the tip the amount is that at the border.
    pub(super) fn removed(&self, side: Side, s: f64, of: &FlankRange, zeta: f64) -> [f64; 4] {
        let [s_form, s_tip, s_relief] = of.roll;
        let length = s_tip - s_form;
        // The border itself belongs to the flank, rounding included.
        let on_flank = (s - 0.5 * (s_form + s_tip)).abs() <= 0.5 * length.abs() * (1.0 + 1e-9);
        let inside = f64::from(u8::from(on_flank));
        let s = s.clamp(s_form, s_tip);
        let [mut removed, mut by_roll, mut bend] = self.tip_relief.map_or([0.0; 3], |relief| {
            let length = s_tip - s_relief;
            let [share, rise, bends] = relief.shape.at((s - s_relief) / length);
            [share, rise / length, bends / (length * length)].map(|part| relief.amount * part)
        });
        let height = (2.0 * s - s_form - s_tip) / length;
        let rise = 2.0 / length;
        let [over_width, mut by_zeta] = self.over_width(side, zeta, of.half_width);
        removed = removed + self.profile_crowning * height * height + over_width;
        by_roll += 2.0 * self.profile_crowning * height * rise;
        bend += 2.0 * self.profile_crowning * rise * rise;
        if self.vary_jointly(side) {
            let twist = self.twist[side.index()];
            removed += 0.25 * (twist * zeta * height + twist.abs());
            by_roll += 0.25 * twist * zeta * rise;
            by_zeta += 0.25 * twist * height;
            if let Some(topography) = &self.topography[side.index()] {
                let [e, slope, bends, across] = topography.removed(s, of, zeta);
                removed += e;
                by_roll += slope;
                bend += bends;
                by_zeta += across;
            }
        }
        [removed, inside * by_roll, inside * bend, by_zeta]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Gear, GearParams};

    const LEFT: Side = Side::Left;

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
                ..Modifications::default()
            },
            ..GearParams::default()
        })
        .unwrap()
    }

    #[test]
    fn amounts_are_reached_where_they_are_defined() {
        let g = gear(ReliefShape::Linear);
        let at = |r, zeta| g.flank_deviation(LEFT, r, zeta);
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
        let difference =
            linear.flank_deviation(LEFT, r, 0.0) - parabolic.flank_deviation(LEFT, r, 0.0);
        assert!((difference - 5e-6).abs() < 1e-15, "half against a quarter");
        assert_eq!(
            linear.flank_deviation(LEFT, 46.5e-3, 0.3),
            parabolic.flank_deviation(LEFT, 46.5e-3, 0.3)
        );
    }

    #[test]
    fn the_plain_flank_deviates_nowhere() {
        let plain = Gear::new(GearParams {
            teeth: 30,
            ..GearParams::default()
        })
        .unwrap();
        assert_eq!(plain.flank_deviation(LEFT, plain.r_tip(), 1.0), 0.0);
    }

    #[test]
    fn slopes_are_those_of_differences() {
        let topography = Topography::new(
            &[
                vec![1e-6, 3e-6, 2e-6],
                vec![0.0, -1e-6, 4e-6],
                vec![2e-6, 5e-6, 1e-6],
                vec![6e-6, 7e-6, 3e-6],
            ],
            None,
            None,
        )
        .unwrap();
        let end = |shape, length| {
            Some(EndRelief {
                amount: 9e-6,
                length,
                shape,
            })
        };
        for shape in [ReliefShape::Linear, ReliefShape::Parabolic] {
            let modifications = Modifications {
                tip_relief: gear(shape).params().modifications.tip_relief,
                profile_crowning: 4e-6,
                lead_crowning: 6e-6,
                end_relief: [end(shape, 8e-3), end(shape, 5e-3)],
                helix_slope: [7e-6, -3e-6],
                twist: [-5e-6, 8e-6],
                topography: [Some(Arc::new(topography.clone())), None],
            };
            let of = FlankRange {
                roll: [8e-3, 20e-3, 15e-3],
                r_base: 42e-3,
                half_width: 10e-3,
            };
            for side in Side::BOTH {
                for (s, zeta) in [(9.1e-3, -0.8), (13e-3, 0.15), (16.2e-3, 0.7), (19e-3, 0.96)] {
                    let at = |s, zeta| modifications.removed(side, s, &of, zeta)[0];
                    let [_, by_roll, bend, by_zeta] = modifications.removed(side, s, &of, zeta);
                    let (h, w) = (1e-6, 1e-5);
                    let slope = (at(s + h, zeta) - at(s - h, zeta)) / (2.0 * h);
                    let bends = (at(s + h, zeta) - 2.0 * at(s, zeta) + at(s - h, zeta)) / (h * h);
                    let across = (at(s, zeta + w) - at(s, zeta - w)) / (2.0 * w);
                    assert!((by_roll - slope).abs() < 1e-8, "{by_roll:e} {slope:e}");
                    assert!(
                        (bend - bends).abs() < 1e-4 * (1.0 + bends.abs()),
                        "{bend:e} {bends:e}"
                    );
                    assert!((by_zeta - across).abs() < 1e-12, "{by_zeta:e} {across:e}");
                }
                for beyond in [7e-3, 21e-3] {
                    let [_, by_roll, bend, _] = modifications.removed(side, beyond, &of, 0.3);
                    assert_eq!([by_roll, bend], [0.0; 2]);
                }
            }
        }
    }
}
