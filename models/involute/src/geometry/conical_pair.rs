//! Conical gears (beveloids) in mesh with each other or with cylindrical gears, on axes that are parallel, meet or cross.
//!
//! Flanks of both gears are involute helicoids of one normal base pitch, so that they turn against each other at a constant
//! ratio wherever their axes stand, but touch in a point: in every transverse section of one gear there is a place that is
//! nearest to the mate, at the length of roll `rho` with the roll `rho'` of its foot there. While the gears turn, both change
//! by the arcs of the base circles, so that with `c = cos(beta_b)/cos(beta_b0)` of each flank
//!
//! ```text
//! c_1 rho_1 + c_2 rho_2 = L'                gap = cos(beta_b0) (L' - c_1 rho_1 - c_2 rho_2)
//! tip of gear 1: rho_1 = rho_a1(z_1)        tip of gear 2: rho_2 = rho_a2(z_2)
//! ```
//!
//! which is a line of action of its own for either side and every section. The pair is described as the cylindrical one of
//! the same rack, helix angle and number of teeth (index 0), whose line of action is the mean of those of both sides at the
//! section that is nearest, `L = r_b1 tan(alpha_w) + r_b2 tan(alpha_w)`; the rolls of each side and section are mapped to
//! its path coordinates, `s = c rho + u`, so that the middles of the paths of contact coincide. J. Zhu, C. Song and others
//! (beveloid gears on crossed axes, Mech. Mach. Theory 2016 to 2020) have the same as two lines of action of crossed helical
//! gears.

mod member;

use super::Side;
use super::conical::ConicalError;
use super::error::GeometryError;
use super::frame::Frame;
use super::gear::Gear;
use super::meshing::{FORM_SLACK, SLACK, check_clearance, check_same_rack};
use super::pair::{Mate, MateFlanks, Pair};
use member::{Member, Nearest, common_face, index, nearest};

/// Largest number of secant steps in the search for the nearest section.
const MOST_SECANTS: usize = 40;

/// Number of iterations that bring the contact to the middle of its path.
const REPETITIONS: usize = 6;

/// Linear map from lengths of roll to path coordinates, `s = scale rho + shift`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RollMap {
    /// Ratio of the cosines of the base helix angles.
    pub scale: f64,
    /// Constant part of the map [m].
    pub shift: f64,
}

impl RollMap {
    /// Returns the path coordinate of a length of roll [m].
    #[inline]
    pub fn s(&self, roll: f64) -> f64 {
        self.scale * roll + self.shift
    }

    /// Returns the length of roll of a path coordinate [m].
    #[inline]
    pub fn roll(&self, s: f64) -> f64 {
        (s - self.shift) / self.scale
    }
}

/// A pair of gears of which at least one is conical.
#[derive(Clone, Debug)]
pub struct ConicalPair {
    /// Equivalent cylindrical pair.
    pub pair: Pair,
    /// Half angles on the base circles that the gears of [`ConicalPair::pair`] would need to touch as these do [rad];
    /// of both gears, left and right flanks.
    pub half_angles: [[f64; 2]; 2],
    /// Middle of the common face width along either axis, from the middle of each face [m].
    pub heights: [f64; 2],
    /// Common face width [m].
    pub face_width: f64,
    /// Largest extension of the paths of contact of sections beyond that of the middle, at either end [m].
    pub margin: f64,
    members: [Member; 2],
    /// Path coordinates of the tips for the middle section [m].
    ends: [f64; 2],
    /// Angles of a tooth of either gear at which left and right flanks touch in the middle of the path, and the
    /// rotation of that tooth from the one of [`ConicalPair::half_angles`] [rad].
    angles: [[f64; 2]; 2],
    turned: [[f64; 2]; 2],
}

impl ConicalPair {
    /// Meshes two gears in their frames, whose origins are in the middles of the face widths.
    ///
    /// # Errors
    /// [`GeometryError`] for gears that were not cut by one rack, overlap, do not reach each other, or lose contact.
    pub fn new(gears: [&Gear; 2], frames: [Frame; 2]) -> Result<Self, GeometryError> {
        let [one, two] = gears;
        check_same_rack(one, Mate::Gear(two))?;
        let apart = frames[1].origin - frames[0].origin;
        let members = [0, 1].map(|k| {
            let to = if k == 0 { apart } else { -apart };
            Member::new(gears[k], frames[k], to)
        });
        let (heights, face_width) = common_face(gears, &members)?;
        let middle = (frames[0].axes[2] + frames[1].axes[2]).normalize();
        let across = (apart - middle.dot(&apart) * middle).norm();
        let base_sum = one.r_base() + two.r_base();
        if across <= base_sum {
            return Err(GeometryError::CentreDistanceTooSmall {
                centre_distance: across,
                base_sum,
            });
        }
        let mut pair = ConicalPair {
            pair: Pair::of_rolls([one, two], 0.0, face_width),
            half_angles: [[0.0; 2]; 2],
            heights,
            face_width,
            margin: 0.0,
            members,
            ends: [0.0; 2],
            angles: [[0.0; 2]; 2],
            turned: [[0.0; 2]; 2],
        };
        let start = (base_sum / across).acos();
        let touching = Side::BOTH.map(|side| pair.touching(side, start));
        let length = touching.iter().map(|n| pair.reach(n.0, &n.1)).sum::<f64>() / 2.0;
        let tips = [one.roll_length_tip(), two.roll_length_tip()];
        if tips[0] + tips[1] <= length || !length.is_finite() {
            let distance = base_sum.hypot(length);
            return Err(GeometryError::NoEngagement {
                centre_distance: distance,
                max_distance: base_sum.hypot(tips[0] + tips[1]),
            });
        }
        pair.pair = Pair::of_rolls([one, two], length, face_width);
        pair.ends = [length - tips[1], tips[0]];
        let alpha = pair.pair.working_pressure_angle();
        for (i, (side, near)) in touching.iter().enumerate() {
            let maps = pair.maps(*side, near);
            for k in 0..2 {
                let m = &pair.members[k];
                let turned = side.sign() * (pair.angles[i][k] - m.towards);
                // Path coordinate of the nearest tooth.
                let found = maps[k].s(near.roll[k]) / m.r_base - turned - alpha;
                pair.turned[i][k] = ((found - m.half_angle) / m.pitch).round() * m.pitch;
                pair.half_angles[k][i] = found - pair.turned[i][k];
            }
        }
        pair.check(gears)?;
        Ok(pair)
    }

    /// Checks the conditions that need the assembled pair; sets backlash and margin.
    fn check(&mut self, gears: [&Gear; 2]) -> Result<(), GeometryError> {
        let [one, two] = gears;
        let alpha = self.pair.alpha_w;
        let length = self.pair.line_length();
        let arcs: f64 = (self.members.iter().zip(&self.half_angles))
            .map(|(m, chi)| m.r_base * (2.0 * alpha + chi[0] + chi[1]))
            .sum();
        let backlash = 2.0 * length + self.pair.base_pitch - arcs;
        if backlash < -SLACK * self.pair.distance {
            return Err(GeometryError::Conical(ConicalError::Overlap {
                overlap: -backlash,
            }));
        }
        self.pair.backlash_base = backlash.max(0.0);
        self.pair.backlash_circ = self.pair.backlash_base / alpha.cos();
        for (tip_of, tip, mate) in [("gear 1", one, two), ("gear 2", two, one)] {
            let below = mate.roll_length_form() - (length - tip.roll_length_tip());
            if below > FORM_SLACK * one.params().module {
                let allowed = tip.r_base().hypot(length - mate.roll_length_form());
                return Err(GeometryError::Interference {
                    tip_of,
                    below,
                    reduce_by: tip.r_tip() - allowed,
                });
            }
        }
        let to_mate = (self.members[1].frame.origin - self.members[0].frame.origin).normalize();
        let apart = self.members[1].frame.axes[2] - self.members[0].frame.axes[2];
        let opens = apart.dot(&to_mate);
        for end in [-0.5, 0.5] {
            let z = self.heights.map(|h| h + end * self.face_width);
            let distance = self.pair.distance + end * self.face_width * opens;
            let root =
                |k: usize| gears[k].r_root() + z[k] * gears[k].params().profile_shift_angle.tan();
            let clearance = [(0, 1), (1, 0)].map(|(tip, mate): (usize, usize)| {
                distance - gears[tip].r_tip_at(z[tip]) - root(mate)
            });
            check_clearance(["gear 1", "gear 2"], clearance, self.pair.distance)?;
        }
        let path = self.pair.s_end() - self.pair.s_start();
        for side in Side::BOTH {
            for end in [-0.5, 0.0, 0.5] {
                let near = self.nearest(0, side, self.heights[0] + end * self.face_width);
                let [from, to] = self.path(side, &near);
                self.margin = self.margin.max(0.5 * (to - from - path));
            }
        }
        if self.pair.total_contact_ratio() < 1.0 {
            return Err(GeometryError::ContactRatio {
                value: self.pair.total_contact_ratio(),
            });
        }
        Ok(())
    }

    /// Returns the angles at which flanks of a side touch in the middle of their path, and the nearest points.
    fn touching(&mut self, side: Side, alpha: f64) -> (Side, Nearest) {
        let sigma = side.sign();
        let i = index(side);
        self.angles[i] = self.members.each_ref().map(|m| {
            let involute = alpha.tan() - alpha;
            m.towards + sigma * (involute - m.flanks[i].half_angle)
        });
        let mut near = self.nearest_of_all(side);
        for _ in 0..REPETITIONS {
            let mate = &self.members[1];
            self.angles[i][1] +=
                sigma * near.distance / (mate.flanks[i].base_radius * mate.flanks[i].cos_helix);
            near = self.nearest_of_all(side);
            let [from, to] = self.path(side, &near);
            let by = 0.5 * (from + to) - self.scale(0, i) * near.roll[0];
            self.angles[i][0] += sigma * by / self.members[0].r_base;
            self.angles[i][1] -= sigma * by / self.members[1].r_base;
            near = self.nearest_of_all(side);
            if by.abs() < 1e-14 * self.members[0].r_base {
                break;
            }
        }
        let mate = &self.members[1];
        self.angles[i][1] +=
            sigma * near.distance / (mate.flanks[i].base_radius * mate.flanks[i].cos_helix);
        (side, self.nearest_of_all(side))
    }

    /// Returns the ratio of the cosine of the base helix angle of a flank to that of the cylindrical gear.
    fn scale(&self, k: usize, i: usize) -> f64 {
        self.members[k].flanks[i].cos_helix / self.members[k].cos_helix
    }

    /// Returns the path coordinate per length of roll of both gears, on left and right flanks.
    pub fn roll_scale(&self) -> [[f64; 2]; 2] {
        [0, 1].map(|i| [0, 1].map(|k| self.scale(k, i)))
    }

    /// Returns `L'` of a section [m].
    fn reach(&self, side: Side, near: &Nearest) -> f64 {
        let i = index(side);
        let rolls: f64 = (0..2).map(|k| self.scale(k, i) * near.roll[k]).sum();
        rolls + near.distance / self.members[0].cos_helix
    }

    /// Returns the range of contact of a section, as `c_1 rho_1` [m].
    fn path(&self, side: Side, near: &Nearest) -> [f64; 2] {
        let i = index(side);
        let tip = |k: usize| {
            let m = &self.members[k];
            let (tip, base) = (
                m.r_tip + near.height[k] * m.tip_slope,
                m.flanks[i].base_radius,
            );
            self.scale(k, i) * ((tip - base) * (tip + base)).max(0.0).sqrt()
        };
        [self.reach(side, near) - tip(1), tip(0)]
    }

    /// Returns the maps from lengths of roll of a section to path coordinates.
    fn maps(&self, side: Side, near: &Nearest) -> [RollMap; 2] {
        let length = self.pair.line_length();
        let [from, to] = self.path(side, near);
        let middle = 0.5 * (self.ends[0] + self.ends[1]);
        let first = middle - 0.5 * (from + to);
        let shifts = [first, length - self.reach(side, near) - first];
        [0, 1].map(|k| RollMap {
            scale: self.scale(k, index(side)),
            shift: shifts[k],
        })
    }

    /// Returns, for a transverse section of gear `own` at a height [m], the maps from lengths of roll to path
    /// coordinates, and the offsets of the path coordinates of both gears from those at height zero [m].
    pub fn section(&self, own: usize, side: Side, height: f64) -> ([RollMap; 2], [f64; 2]) {
        let i = index(side);
        let near = self.nearest(own, side, height);
        let maps = self.maps(side, &near);
        let alpha = self.pair.alpha_w;
        let ahead = [0, 1].map(|k| {
            let m = &self.members[k];
            let turned = side.sign() * (self.angles[i][k] - m.towards);
            let found = turned + alpha + self.half_angles[k][i] + self.turned[i][k];
            maps[k].s(near.roll[k]) - m.r_base * found
        });
        (maps, ahead)
    }

    /// Returns the point of a transverse section of gear `own` nearest to its mate, at the angles at which the flanks
    /// touch.
    fn nearest(&self, own: usize, side: Side, height: f64) -> Nearest {
        nearest(&self.members, self.angles[index(side)], (own, side), height)
    }

    /// Returns the section of gear 1 nearest to gear 2 on the common face width; both flanks are convex.
    fn nearest_of_all(&self, side: Side) -> Nearest {
        let half = 0.5 * self.face_width;
        let at = |z: f64| self.nearest(0, side, z);
        let [low, high] = [-half, half].map(|z| at(self.heights[0] + z));
        if low.rise >= 0.0 || high.rise <= 0.0 {
            return if low.distance < high.distance {
                low
            } else {
                high
            };
        }
        // The regula falsi, which halves the weight of an end that stays (Illinois).
        let mut ends = [(low.height[0], low.rise), (high.height[0], high.rise)];
        let (mut near, mut last) = (low, None);
        for _ in 0..MOST_SECANTS {
            let [(a, f), (b, g)] = ends;
            near = at(b - g * (b - a) / (g - f));
            let moved = (near.height[0], near.rise);
            let end = usize::from(near.rise > 0.0);
            let step = (ends[end].0 - near.height[0]).abs();
            ends[end] = moved;
            if last == Some(end) {
                ends[1 - end].1 *= 0.5;
            }
            last = Some(end);
            if step < 1e-14 * half || near.rise == 0.0 {
                break;
            }
        }
        near
    }
}

impl Pair {
    /// Returns the cylindrical pair with a length between its tangent points (m).
    fn of_rolls([one, two]: [&Gear; 2], length: f64, face_width: f64) -> Self {
        let r_base = [one.r_base(), two.r_base()];
        let base_sum = r_base[0] + r_base[1];
        let alpha_w = (length / base_sum).atan();
        let ends = [length - two.roll_length_tip(), one.roll_length_tip()];
        let forms = [one.roll_length_form(), length - two.roll_length_form()];
        Self {
            distance: base_sum / alpha_w.cos(),
            alpha_w,
            base_pitch: one.base_pitch(),
            s_start: ends[0].max(forms[0]),
            s_end: ends[1].min(forms[1]),
            r_base: r_base[0],
            chi: one.half_angle_base(),
            second: MateFlanks::Gear {
                length,
                r_base: r_base[1],
                chi: two.half_angle_base(),
                towards: std::f64::consts::PI,
            },
            pitch_radii: r_base.map(|rb| rb / alpha_w.cos()),
            face_width,
            beta_b: one.base_helix_angle(),
            backlash_base: 0.0,
            backlash_circ: 0.0,
        }
    }
}
