//! Conical gears (beveloids): profile shift and tip radius that grow along the axis, flanks that differ, and the
//! errors that only they have.
//!
//! ```text
//! x(z) m_n = x m_n + z tan(theta)      r_a(z) = r + m_n (h_a* + x) + z tan(theta_a)
//! ```
//!
//! with the height `z` over the middle of the face width, the profile-shift angle `theta` and the angle of the tip cone
//! `theta_a`. Flanks are those of [`InvoluteHelicoid`]; each end of the face has to be a gear that can be cut.

use super::Side;
use super::error::GeometryError;
use super::gear::Gear;
use super::helicoid::InvoluteHelicoid;
use super::involute::inv_of_tangent;
use super::modification::Modifications;
use super::parameters::GearParams;
use crate::error::Reason;

/// Error of a conical gear or its mesh. Lengths are in metre.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "what the fields are the messages say")]
pub enum ConicalError {
    /// The teeth are too thick for the relative position of the gears.
    Overlap { overlap: f64 },
    /// The face widths have no common part.
    FacesApart { offset: f64 },
    /// The gear is impossible at one end of its face.
    FaceEnd {
        height: f64,
        profile_shift: f64,
        why: Box<GeometryError>,
    },
    /// Conical gears mesh with gears only, not with racks.
    OnRack,
}

impl ConicalError {
    /// Returns cause and remedy.
    pub fn reason(&self) -> Reason {
        let (cause, help) = match self {
            Self::Overlap { overlap } => (
                format!(
                    "flanks overlap: at the positions of the conical gears the backlash is {:.3e} m",
                    -overlap
                ),
                "move one along its axis towards the side where its teeth are thinner, lower a profile shift, or thin \
                 the teeth"
                    .to_owned(),
            ),
            Self::FacesApart { offset } => (
                format!(
                    "the face widths do not overlap: their middles are {offset:.4e} m apart along the axis"
                ),
                "give positions that bring the gears in front of each other".to_owned(),
            ),
            Self::FaceEnd {
                height,
                profile_shift,
                why,
            } => {
                let Reason { cause, help } = why.reason();
                (
                    format!(
                        "at the height {height:.4} m, the end of the face where the profile shift is \
                         {profile_shift:.4}: {cause}"
                    ),
                    format!("{help}, there; or take a smaller profile-shift angle or face width"),
                )
            }
            Self::OnRack => (
                "a conical gear meshes with a rack".to_owned(),
                "conical gears mesh with gears, conical or cylindrical".to_owned(),
            ),
        };
        Reason { cause, help }
    }
}

impl Gear {
    /// Adds the flanks that a tilted rack generates.
    pub(super) fn conical(mut self) -> Result<Self, GeometryError> {
        if self.deviates() {
            return Err(GeometryError::Deviations {
                what: "deviations of single teeth",
                found: "a conical gear".to_owned(),
                expected: "a cylindrical one, or no deviations".to_owned(),
            });
        }
        let cut = |side| InvoluteHelicoid::of_tilted_rack(self.params(), side);
        self.flanks = Box::new(Side::BOTH.map(cut));
        for end in [-0.5, 0.5] {
            let height = end * self.face_width();
            let section = self.section(height);
            let profile_shift = section.profile_shift;
            Gear::new(section).map_err(|why| {
                GeometryError::Conical(ConicalError::FaceEnd {
                    height,
                    profile_shift,
                    why: Box::new(why),
                })
            })?;
        }
        Ok(self)
    }

    /// Returns the parameters of [`Gear::transverse_section`].
    fn section(&self, height: f64) -> GearParams {
        let p = self.params();
        let grown = height * p.profile_shift_angle.tan();
        let tip = height * p.tip_cone_angle.tan();
        GearParams {
            profile_shift: p.profile_shift + grown / p.module,
            addendum: p.addendum + (tip - grown) / p.module,
            profile_shift_angle: 0.0,
            tip_cone_angle: 0.0,
            modifications: Modifications::default(),
            ..p.clone()
        }
    }

    /// Returns the cylindrical gear of a transverse section at a height over the middle of the face width [m], or
    /// `None` where all sections are that of the gear itself.
    pub(super) fn at_height(&self, height: f64) -> Option<Gear> {
        if !self.is_conical() {
            return None;
        }
        self.transverse_section(height).ok()
    }

    /// Returns the cylindrical gear with the profile shift and the tip radius of the transverse section at a height
    /// over the middle of the face width (m), without modifications. Its bore is the seat of the whole gear. Tip and
    /// root circles are those of the section, flanks are nearly those of [`Gear::flank`].
    ///
    /// # Errors
    /// [`GeometryError`] for a section that cannot be cut, beyond the ends of the face only.
    pub fn transverse_section(&self, height: f64) -> Result<Gear, GeometryError> {
        Gear::new(GearParams {
            bore_radius: self.seat_radius(),
            ..self.section(height)
        })
    }

    /// Returns the angle (rad) by which the helix rotates the section at a height (m). A tilted rack crosses the
    /// transverse plane with its centreline at `z tan(beta)/cos(theta)` along its rolling motion and `z tan(theta)`
    /// further out, where it is sheared by `tan(beta) sin(theta)`.
    #[inline]
    pub fn twist_at(&self, height: f64) -> f64 {
        let p = self.params();
        height * (p.helix_angle.tan() * p.profile_shift_angle.cos()) / self.r_reference()
    }

    /// Returns the angle (rad) between the rotated centreline of a section, [`Gear::twist_at`], and the exact flank of
    /// a side at a radius (m) not below the base circle of that side.
    #[inline]
    pub fn half_angle_of_section(&self, side: Side, radius: f64, height: f64) -> f64 {
        let flank = self.flank(side);
        let base = flank.base_radius;
        let roll = ((radius - base) * (radius + base)).max(0.0).sqrt();
        let turned = height * flank.tan_helix / base - self.twist_at(height);
        flank.half_angle + side.sign() * turned - inv_of_tangent(roll / base)
    }

    /// Returns the material removed normal to the flanks of a side (m), as [`Gear::flank_deviation`], at a radius and
    /// a height over the middle of the face width (m): modifications follow the tip cone.
    pub fn flank_deviation_at(&self, side: Side, radius: f64, height: f64) -> f64 {
        let below = radius - height * self.params().tip_cone_angle.tan();
        self.flank_deviation(side, below, height / (0.5 * self.face_width()))
    }

    /// Returns the material removed normal to the flanks of a side, at a length of roll (m, that of
    /// [`Gear::roll_length`]) of the exact flank and a height over the middle of the face width (m): the amount (m),
    /// its first and second derivative by the length of roll and its derivative by the height.
    pub fn flank_deviation_at_roll(&self, side: Side, roll: f64, height: f64) -> [f64; 4] {
        let (of, modifications) = (self.flank_range(), &self.params().modifications);
        let per_height = of.half_width.recip();
        if !self.is_conical() {
            let at = modifications.removed(side, roll, &of, height * per_height);
            let [e, by_roll, bend, by_zeta] = at;
            return [e, by_roll, bend, by_zeta * per_height];
        }
        // Modifications depend on the radius less the rise of the tip cone.
        let base = self.flank(side).base_radius;
        let (radius, cone) = (base.hypot(roll), self.params().tip_cone_angle.tan());
        let below = radius - height * cone;
        let s = self.roll_length(below);
        let [e, by_s, bend, by_zeta] = modifications.removed(side, s, &of, height * per_height);
        if s == 0.0 {
            return [e, 0.0, 0.0, by_zeta * per_height];
        }
        let (rise, rises) = (roll / radius, base * base / radius.powi(3));
        let (s_rise, s_rises) = (below / s, -of.r_base * of.r_base / s.powi(3));
        [
            e,
            by_s * s_rise * rise,
            bend * (s_rise * rise).powi(2) + by_s * (s_rises * rise * rise + s_rise * rises),
            by_zeta * per_height - by_s * s_rise * cone,
        ]
    }

    /// Returns true if the removed material may have a kink within a distance of a length of roll at a height (m): at
    /// form circle and tip, at the start of a tip relief, and anywhere with end reliefs or a topography, which have
    /// kinks over the width as well.
    pub fn flank_kinks(&self, side: Side, roll: f64, height: f64, within: f64) -> bool {
        let modifications = &self.params().modifications;
        if modifications.topography.iter().any(Option::is_some)
            || modifications.end_relief.iter().any(Option::is_some)
        {
            return true;
        }
        let s = if self.is_conical() {
            let radius = self.flank(side).base_radius.hypot(roll);
            self.roll_length(radius - height * self.params().tip_cone_angle.tan())
        } else {
            roll
        };
        let kinks = self.flank_range().roll;
        kinks.iter().any(|kink| (s - kink).abs() <= within)
    }

    /// Returns true for a conical gear (beveloid), whose profile shift or tip radius varies along the axis. Its radii,
    /// thicknesses and angles without a height or side are those of the cylindrical gear with the profile shift of its
    /// middle section.
    #[inline]
    pub fn is_conical(&self) -> bool {
        self.params().profile_shift_angle != 0.0 || self.params().tip_cone_angle != 0.0
    }

    /// Returns a flank of a tooth at the angle zero.
    #[inline]
    pub fn flank(&self, side: Side) -> &InvoluteHelicoid {
        &self.flanks[usize::from(side == Side::Right)]
    }

    /// Returns the tip radius (m) at a height over the middle of the face width (m).
    #[inline]
    pub fn r_tip_at(&self, height: f64) -> f64 {
        self.r_tip() + height * self.params().tip_cone_angle.tan()
    }

    /// Returns the length of roll (m) of a flank at the tip, at a height over the middle of the face width (m).
    #[inline]
    pub fn roll_length_tip_at(&self, side: Side, height: f64) -> f64 {
        if !self.is_conical() {
            return self.roll_length_tip();
        }
        let (tip, base) = (self.r_tip_at(height), self.flank(side).base_radius);
        ((tip - base) * (tip + base)).max(0.0).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn params(profile_shift_angle: f64, helix_angle: f64) -> GearParams {
        GearParams {
            teeth: 35,
            module: 6.5e-3,
            profile_shift: 0.25,
            profile_shift_angle,
            tip_cone_angle: profile_shift_angle,
            helix_angle,
            face_width: 0.09,
            ..GearParams::default()
        }
    }

    #[test]
    fn a_rack_that_is_not_tilted_cuts_a_cylindrical_gear() {
        for helix in [-0.2, 0.0, 0.3] {
            let gear = Gear::new(params(0.0, helix)).unwrap();
            assert!(!gear.is_conical());
            for side in Side::BOTH {
                let cut = InvoluteHelicoid::of_tilted_rack(gear.params(), side);
                let own = gear.flank(side);
                for (x, y) in [
                    (cut.base_radius, own.base_radius),
                    (cut.tan_helix, own.tan_helix),
                    (cut.half_angle, own.half_angle),
                ] {
                    assert!((x - y).abs() < 1e-14, "{x} {y}");
                }
            }
        }
    }

    /// The flank of a section is that of the cylindrical gear with its profile shift, except for the effect of the
    /// tilt on the pressure angle: at small angles the thickness differs by their square.
    #[test]
    fn teeth_grow_as_their_profile_shift_does() {
        let gear = Gear::new(params(1e-3, 0.0)).unwrap();
        let r = gear.r_reference();
        for height in [-0.04, 0.03] {
            let section = Gear::new(gear.section(height)).unwrap();
            for side in Side::BOTH {
                let flank = gear.flank(side);
                let roll = (r * r - flank.base_radius * flank.base_radius).sqrt();
                let x = flank.point(&flank.base(0.0, roll, height), roll, height);
                let half = side.sign() * x.y.atan2(x.x);
                assert!((half - section.half_angle_reference()).abs() < 1e-7);
            }
            assert!((gear.r_tip_at(height) - section.r_tip()).abs() < 1e-15);
        }
    }

    #[test]
    fn ends_of_the_face_that_cannot_be_cut_are_refused() {
        let refused = |p: GearParams| Gear::new(p).unwrap_err().to_string();
        let pointed = refused(params(0.5, 0.0));
        assert!(pointed.contains("end of the face"), "{pointed}");
        let deviating = GearParams {
            deviations: crate::geometry::Deviations::Class { class: 6, seed: 1 },
            ..params(0.05, 0.0)
        };
        assert!(refused(deviating).contains("conical"));
    }
}
