//! Points on the section of a flank and their distance from the mate's flank, in the axes of the mate's hub.

use super::flanks::{FlankForm, Helicoid};
use crate::Vec3;
use crate::geometry::{FlankDistance, Frame, InvoluteHelicoid, PlaneAngle, Side};
use std::cell::Cell;

/// Largest number of corrections of the length of roll.
const MAX_CORRECTIONS: usize = 40;

/// Relative correction of the length of roll whose square is neglected: the nearest point is then updated to first
/// order, its distance to second. Corrections converge quadratically, so that points are accurate to 1e-12, as errors
/// of 1e-12 in time require.
const SMALL_STEP: f64 = 1e-6;

/// Relative correction of the length of roll that is neglected where the curvature differs from that of the gap, as
/// near kinks: there convergence is linear.
const SMALL_STEP_BOUNDED: f64 = 1e-11;

/// Smallest assumed curvature: of the distance relative to that of the involute, for poor initial guesses, and of a
/// modified pair relative to that of its involutes, for modifications of opposite curvature.
const LEAST_BEND: f64 = 0.2;

/// Transverse section of a flank at a height, with the flank of the mate.
pub(super) struct Section<'a> {
    pub(super) own: &'a Helicoid,
    pub(super) flank: &'a InvoluteHelicoid,
    pub(super) mate: &'a FlankForm,
    pub(super) side: Side,
    /// Height on the axis of the gear [m].
    pub(super) z: f64,
    /// Number and angle (position of a rack) of the teeth.
    pub(super) tooth: (i64, f64),
    pub(super) of_mate: (i64, f64),
    /// Hub frame of the gear.
    pub(super) hub: &'a Frame,
    /// Point of the gear axis at the height [m].
    pub(super) middle: Vec3,
    /// Inverse of the base radius [1/m].
    pub(super) per_base: f64,
    /// Counter of evaluated points.
    pub(super) evaluated: &'a Cell<u64>,
}

/// Point on a section.
#[derive(Clone, Copy, Debug)]
pub(super) struct SectionPoint {
    /// Length of roll [m].
    pub(super) roll: f64,
    /// Angle of the base radius about the hub of the gear, its direction, and the direction a quarter of a turn ahead.
    pub(super) base: PlaneAngle,
    pub(super) direction: Vec3,
    tangent: Vec3,
    /// Position [m].
    pub(super) x: Vec3,
    /// Distance from the mate.
    pub(super) near: FlankDistance,
}

/// Derivatives of the gap along a section by the length of roll.
pub(super) struct Slopes {
    /// First derivative of the whole gap and of the distance from the mate.
    pub(super) gap: f64,
    distance: f64,
    /// Second derivatives of both.
    gap_bend: f64,
    distance_bend: f64,
    /// First and second derivative of the material removed from the mate, by its own length of roll.
    removed: [f64; 2],
    /// Relative correction of the length of roll whose square is neglected.
    small: f64,
}

impl Section<'_> {
    /// Computes the point of a base radius and a length of roll; `around` is an angle near which the base radius of
    /// the mate lies.
    #[inline]
    fn place(&self, base: PlaneAngle, roll: f64, around: &PlaneAngle) -> SectionPoint {
        self.evaluated.set(self.evaluated.get() + 1);
        let [x, y, _] = &self.hub.axes;
        let direction = base.cos * x + base.sin * y;
        let tangent = base.cos * y - base.sin * x;
        let along = self.side.sign() * roll;
        let x = self.middle + self.flank.base_radius * direction + along * tangent;
        let near = match self.mate {
            FlankForm::Involute(h) => h.flank(self.side).near(self.of_mate.1, &x, around),
            FlankForm::Plane(p) => p.near(self.side, self.of_mate.1, &x),
        };
        SectionPoint {
            roll,
            base,
            direction,
            tangent,
            x,
            near,
        }
    }

    /// Returns the point at a length of roll [m].
    pub(super) fn at_roll(&self, roll: f64) -> SectionPoint {
        let base = self.flank.base(self.tooth.1, roll, self.z);
        self.place(base, roll, &PlaneAngle::new(0.0))
    }

    /// Returns the point with a base radius, or with the smallest length of roll.
    #[inline]
    pub(super) fn along(&self, base: PlaneAngle, least: f64, around: &PlaneAngle) -> SectionPoint {
        let roll = self.flank.roll(self.tooth.1, base.angle, self.z);
        if roll < least {
            return self.place(self.rolled(&base, least - roll), least, around);
        }
        self.place(base, roll, around)
    }

    /// Returns the base radius of a length of roll that is longer by `more` [m].
    #[inline]
    fn rolled(&self, base: &PlaneAngle, more: f64) -> PlaneAngle {
        base.turned(-self.side.sign() * more * self.per_base)
    }

    /// Returns the point with another length of roll.
    fn moved(&self, from: &SectionPoint, roll: f64) -> SectionPoint {
        let base = self.rolled(&from.base, roll - from.roll);
        self.place(base, roll, &from.near.base)
    }

    /// Moves a point outside a range of lengths of roll to the nearer end of the range.
    pub(super) fn keep_within(&self, place: &mut SectionPoint, [low, high]: [f64; 2]) {
        let roll = place.roll.clamp(low, high);
        if roll != place.roll {
            *place = self.moved(place, roll);
        }
    }

    /// Returns the point with a length of roll that is longer by a small `step` [m], to first order.
    #[inline]
    fn stepped(&self, place: &mut SectionPoint, (step, low): (f64, f64), slopes: &Slopes) {
        let sigma = self.side.sign();
        let dx = place.roll * self.per_base * step * place.direction;
        let near = &mut place.near;
        near.distance += step * (slopes.distance + 0.5 * step * slopes.distance_bend);
        match self.mate {
            FlankForm::Involute(h) => {
                let flank = h.flank(self.side);
                let PlaneAngle { cos, sin, .. } = near.base;
                let per_roll = near.roll.max(low).recip();
                let turn = -sigma * (cos * dx.x + sin * dx.y) * per_roll;
                let more = sigma * (cos * dx.y - sin * dx.x - flank.base_radius * turn);
                let turned = sigma * flank.cos_helix * turn;
                near.gradient.x -= turned * cos;
                near.gradient.y -= turned * sin;
                if slopes.removed != [0.0; 2] {
                    let [slope, bend] = slopes.removed.map(|removed| removed * per_roll);
                    let bent = (bend - slope * per_roll) * more;
                    near.gradient.x += bent * place.x.x + slope * dx.x;
                    near.gradient.y += bent * place.x.y + slope * dx.y;
                }
                near.roll += more;
                near.base = near.base.turned(turn);
            }
            FlankForm::Plane(_) => near.roll += dx.y,
        }
        place.x += dx;
        let turn = -sigma * step * self.per_base;
        place.base = place.base.turned(turn);
        place.direction += turn * place.tangent;
        place.roll += step;
    }

    /// Returns the slopes of unmodified flanks.
    #[inline]
    pub(super) fn slopes(&self, place: &SectionPoint, low: f64) -> Slopes {
        let near = &place.near;
        let per_roll = place.roll * self.per_base;
        let slope = per_roll * place.direction.dot(&near.gradient);
        let turning = -self.side.sign() * place.tangent.dot(&near.gradient);
        let bend = match self.mate {
            FlankForm::Involute(h) => {
                let PlaneAngle { cos, sin, .. } = near.base;
                let across = cos * place.direction.x + sin * place.direction.y;
                let other = near.roll.max(low);
                turning + h.flank(self.side).cos_helix * across * across * place.roll / other
            }
            FlankForm::Plane(_) => turning,
        };
        let bounded = bend < LEAST_BEND;
        let bend = per_roll * self.per_base * bend.max(LEAST_BEND);
        Slopes {
            gap: slope,
            distance: slope,
            gap_bend: bend,
            distance_bend: bend,
            removed: [0.0; 2],
            small: if bounded {
                SMALL_STEP_BOUNDED
            } else {
                SMALL_STEP
            },
        }
    }

    /// Adds the material removed from the mate to the distance; returns the slopes of modified flanks.
    pub(super) fn remove(&self, place: &mut SectionPoint, low: f64) -> Slopes {
        let mut smooth = self.own.is_smooth(self.side, place.roll, self.z);
        let per_roll = place.roll * self.per_base;
        let (mut removed, mut bent) = ([0.0; 2], 0.0);
        if let FlankForm::Involute(h) = self.mate
            && h.modified
            && place.near.roll > 0.0
        {
            let near = &mut place.near;
            smooth &= h.is_smooth(self.side, near.roll, place.x.z);
            let [e, by_roll, bend, by_z] =
                h.removed(self.of_mate.0, self.side, near.roll, place.x.z);
            let outward = Vec3::new(place.x.x, place.x.y, 0.0) / near.roll;
            near.distance += e;
            near.gradient += by_roll * outward;
            near.gradient.z += by_z;
            let dx = per_roll * place.direction.xy();
            let along = outward.xy().dot(&dx);
            bent = bend * along * along + by_roll * (dx.norm_squared() - along * along) / near.roll;
            removed = [by_roll, bend];
        }
        // The slope of the mate's distance does not vanish where that of the own flank is its opposite.
        let slopes = self.slopes(place, low);
        let distance_bend = slopes.distance_bend + bent + slopes.distance / place.roll;
        let [_, slope, bend, _] = (self.own).removed(self.tooth.0, self.side, place.roll, self.z);
        let (bend, least) = (distance_bend + bend, LEAST_BEND * slopes.gap_bend);
        Slopes {
            gap: slopes.distance + slope,
            gap_bend: bend.max(least),
            distance_bend,
            removed,
            small: if bend < least || !smooth {
                SMALL_STEP_BOUNDED
            } else {
                slopes.small
            },
            ..slopes
        }
    }

    /// Returns a lower bound of the distance at the nearest point of unmodified flanks in descent direction from a
    /// point [m], or `None` far from it.
    ///
    /// Over the arc length `u` of the section, `du = rho_1/r_b1 d rho_1`, the distance has the slope `a = e_1 . n_2` and the
    /// curvature
    ///
    /// ```text
    /// da/du = c/rho_1 + cos(beta_2) (e_1 . e_2)^2/rho_2,    c = -sigma (a_1 x e_1) . n_2,    a^2 + c^2 = 1 - (a_1 . n_2)^2
    /// ```
    ///
    /// The normal of the mate keeps the angle `beta_2` with its transverse plane, and its axis the angle `Sigma` with the own
    /// one: `a^2 + c^2 >= C^2 = cos^2(beta_2 + Sigma)`. (`n_2` of a rack does not turn: `C^2 = a^2 + c^2` at the place.) Downhill
    /// `|a|` falls, so that `c` stays positive where it is and `c >= c_0 = sqrt(C^2 - a_0^2)`. Each fall of `|a|` by `d|a|` takes
    /// `du <= rho_1 d|a|/c_0` and `d rho_1 <= r_b1 d|a|/c_0`. Hence, before the slope vanishes,
    ///
    /// ```text
    /// rho_1 <= rho = rho_1(0) + r_b1 |a_0|/c_0,    u <= rho |a_0|/c_0,    the distance falls by at most rho a_0^2/(2 c_0)
    /// ```
    ///
    /// The mate's distance is that of a helicoid outside its base cylinder, where the place stays as long as
    /// `rho_2^2 > 2 (rho_2 + r_b2) u`.
    #[inline]
    pub(super) fn lower_bound(&self, place: &SectionPoint) -> Option<f64> {
        let near = &place.near;
        let slope = place.direction.dot(&near.gradient);
        let across = -self.side.sign() * place.tangent.dot(&near.gradient);
        let whole = match self.mate {
            FlankForm::Involute(h) => {
                let flank = h.flank(self.side);
                let tilt = self.hub.axes[2].x.hypot(self.hub.axes[2].y);
                let least = flank.cos_helix * (self.hub.axes[2].z - flank.tan_helix.abs() * tilt);
                least.max(0.0).powi(2)
            }
            FlankForm::Plane(_) => slope * slope + across * across,
        };
        let left = whole - slope * slope;
        if across <= 0.0 || left <= 0.0 {
            return None;
        }
        let turn = slope.abs() / left.sqrt();
        let roll = place.roll + self.flank.base_radius * turn;
        let outside = match self.mate {
            FlankForm::Involute(h) => {
                let reach = 2.0 * (near.roll + h.flank(self.side).base_radius) * roll * turn;
                near.roll * near.roll > reach
            }
            FlankForm::Plane(_) => true,
        };
        outside.then(|| near.distance - 0.5 * roll * turn * slope.abs())
    }

    /// Moves a point within a range of lengths of roll to the one nearest to the mate; with modifications where
    /// `exact`. Unmodified flanks that are known to be `far` from each other [m] keep their point, with a lower bound
    /// of their distance.
    #[inline]
    pub(super) fn least(
        &self,
        place: &mut SectionPoint,
        [low, high]: [f64; 2],
        far: f64,
        exact: bool,
    ) {
        let (mut from, mut to) = (low, high);
        for correction in 0..MAX_CORRECTIONS {
            let slopes = match exact {
                true => self.remove(place, low),
                false => self.slopes(place, low),
            };
            let (roll, slope) = (place.roll, slopes.gap);
            let step = -slope / slopes.gap_bend;
            let ends = (roll == low && step < 0.0) || (roll == high && step > 0.0);
            if ends {
                return;
            }
            if !exact
                && place.near.distance > far
                && let Some(bound) = self.lower_bound(place).filter(|bound| *bound > far)
            {
                place.near.distance = bound;
                return;
            }
            if step.abs() <= slopes.small * roll {
                let within = (roll + step).clamp(low, high) - roll;
                return self.stepped(place, (within, low), &slopes);
            }
            // Kinks of modifications: the sign of the slope brackets the least.
            if slope > 0.0 {
                to = roll;
            } else {
                from = roll;
            }
            let next = roll + step;
            // Inside the mate's base cylinder the curvature is not that of a flank, and its corrections would creep.
            let inside = matches!(self.mate, FlankForm::Involute(_)) && place.near.roll == 0.0;
            let astray = correction > 4 && !(from..=to).contains(&next);
            let next = if (inside && to.is_finite()) || astray {
                0.5 * (from + to)
            } else {
                next.clamp(low, high)
            };
            if next == roll {
                return;
            }
            *place = self.moved(place, next);
        }
        if exact {
            self.remove(place, low);
        }
    }

    /// Returns the tip edge of the mate in the plane of the section, near a point: its distance from the flank, its
    /// position, and the derivative of the distance.
    pub(super) fn edge_of_mate(&self, place: &SectionPoint) -> (f64, Vec3, Vec3) {
        let (side, hub, axis) = (self.side, self.hub, self.hub.axes[2]);
        let mut height = place.x.z;
        let (mut edge, mut tangent) = (place.x, axis);
        let mut base = place.near.base;
        for _ in 0..3 {
            (edge, tangent) = match self.mate {
                FlankForm::Involute(h) => {
                    let (flank, tip) = (h.flank(side), h.tip(side, height));
                    base = base.turned_to(flank.angle(self.of_mate.1, tip, height));
                    let p = flank.point(&base, tip, height);
                    let turn = flank.tan_helix / flank.base_radius;
                    let along = Vec3::new(-turn * p.y, turn * p.x, 1.0);
                    // On a cone the edge moves along the profile as well.
                    let rise = h.tip_rise(side, height) * tip / flank.base_radius;
                    (p, along + rise * Vec3::new(base.cos, base.sin, 0.0))
                }
                FlankForm::Plane(plane) => plane.edge(side, self.of_mate.1, height),
            };
            let off = axis.dot(&(edge - hub.origin)) - self.z;
            height -= off / axis.dot(&tangent);
            edge -= off / axis.dot(&tangent) * tangent;
        }
        let p = hub.point_back(&edge);
        let mut near = self.flank.near(self.tooth.1, &p, &place.base);
        if self.own.modified && near.roll > 0.0 {
            let [e, by_roll, _, by_z] = self.own.removed(self.tooth.0, side, near.roll, p.z);
            near.distance += e;
            near.gradient += Vec3::new(by_roll * p.x, by_roll * p.y, 0.0) / near.roll;
            near.gradient.z += by_z;
        }
        let (removed, by_height) = match self.mate {
            FlankForm::Involute(h) => {
                let tip = h.tip(side, height);
                let [e, by_roll, _, by_z] = h.removed(self.of_mate.0, side, tip, height);
                (e, by_z + by_roll * h.tip_rise(side, height))
            }
            FlankForm::Plane(_) => (0.0, 0.0),
        };
        // The edge slides along itself to stay in the plane.
        let normal = hub.turn(&near.gradient);
        let along = (normal.dot(&tangent) + by_height) / axis.dot(&tangent);
        // The mate's surface recedes as the own one is left.
        (near.distance + removed, edge, along * axis - normal)
    }
}
