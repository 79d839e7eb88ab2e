//! Sets a gear and its mate at a distance, and refuses what does not mesh there; equations in `pair`.

use std::f64::consts::{FRAC_PI_2, PI};

use super::conical::ConicalError;
use super::error::{GeometryError, not_negative, positive};
use super::gear::Gear;
use super::internal::Meshing;
use super::internal_error::InternalError;
use super::involute::inv;
use super::pair::{Mate, Pair, Second};
use super::quantity::Quantity;
use super::rack::Rack;

/// Relative slack on lengths that decide a refusal, far above rounding and far below any tolerance
/// of manufacture.
pub(super) const SLACK: f64 = 1e-10;

/// How far a tip may pass the start of the mate's involute, in modules along the line of action,
/// before it counts as interference: ISO 53 rounds the tip radius factor 0.25 / (1 - sin 20 deg) =
/// 0.3799 to 0.38, so that a standard gear on a standard rack would miss by 1e-4. The path of
/// contact is then cut at the form circle.
pub(super) const FORM_SLACK: f64 = 2e-4;

/// Refuses members cut by different basic racks.
pub(super) fn check_same_rack(gear: &Gear, mate: Mate<'_>) -> Result<(), GeometryError> {
    // Normal module, normal pressure angle and helix angle.
    let of_gear = |g: &Gear| {
        let p = g.params();
        (p.module, p.pressure_angle, p.helix_angle)
    };
    let (one, two) = match mate {
        Mate::Gear(two) => (of_gear(gear), of_gear(two)),
        Mate::Rack(rack) => {
            let p = rack.params();
            (of_gear(gear), (p.module, p.pressure_angle, p.helix_angle))
        }
    };
    if (one.0 - two.0).abs() > 1e-9 * one.0 {
        return Err(GeometryError::UnequalModules {
            first: one.0,
            second: two.0,
        });
    }
    if (one.1 - two.1).abs() > 1e-9 {
        return Err(GeometryError::UnequalPressureAngles {
            first_deg: one.1.to_degrees(),
            second_deg: two.1.to_degrees(),
        });
    }
    // The hands of an internal gear and its mate are the same.
    let hand = match mate {
        Mate::Gear(two) => gear.sign() * two.sign(),
        Mate::Rack(_) => 1.0,
    };
    if (one.2 + hand * two.2).abs() > 1e-9 {
        return Err(GeometryError::HelixMismatch {
            first_deg: one.2.to_degrees(),
            second_deg: two.2.to_degrees(),
        });
    }
    Ok(())
}

/// `p_bt - 2 (r_b1 chi_1 + r_b2 chi_2)`: the backlash on the line of action at `inv(alpha_w) = 0`.
fn backlash_constant(one: &Gear, two: &Gear) -> f64 {
    let chi = one.r_base() * one.half_angle_base() + two.r_base() * two.half_angle_base();
    one.base_pitch() - 2.0 * chi
}

/// Sum of the base radii, that of an internal gear negative.
fn base_sum(one: &Gear, two: &Gear) -> f64 {
    one.sign() * one.r_base() + two.sign() * two.r_base()
}

/// Refuses internal gears that no centre distance brings into mesh.
fn check_inside(one: &Gear, two: &Gear) -> Result<(), GeometryError> {
    let [ring, mate] = match (one.is_internal(), two.is_internal()) {
        (false, false) => return Ok(()),
        (true, true) => return Err(InternalError::BothInternal.into()),
        (true, false) => [one, two],
        (false, true) => [two, one],
    };
    let [ring, mate] = [ring, mate].map(Gear::teeth);
    if mate >= ring {
        return Err(InternalError::ToothDifference { ring, mate }.into());
    }
    if one.is_conical() || two.is_conical() {
        let what = "conical mates";
        return Err(InternalError::Not { what }.into());
    }
    Ok(())
}

/// Refuses tips that run into the root of their mate.
pub(super) fn check_clearance(
    names: [&'static str; 2],
    clearance: [f64; 2],
    distance: f64,
) -> Result<(), GeometryError> {
    for (tip_of, clearance) in names.into_iter().zip(clearance) {
        if clearance < -SLACK * distance {
            return Err(GeometryError::TipRootCollision { tip_of, clearance });
        }
    }
    Ok(())
}

/// Refuses tips that foul beside the path of contact of an internal gear.
fn check_tips(one: &Gear, two: &Gear, distance: f64, alpha_w: f64) -> Result<(), GeometryError> {
    let [ring, mate] = if one.is_internal() {
        [one, two]
    } else {
        [two, one]
    };
    let meshing = Meshing {
        distance,
        alpha_w,
        r_base: mate.r_base(),
        chi: mate.half_angle_base(),
    };
    let half_tip = |g: &Gear| g.half_angle_at_roll(g.roll_length_tip());
    let of_ring = [
        ring.r_base(),
        ring.half_angle_base(),
        ring.r_tip(),
        half_tip(ring),
    ];
    let room = meshing.room_at_tips(of_ring, [[mate.r_tip(), half_tip(mate)]]);
    if room < -SLACK * distance {
        return Err(InternalError::TipsFoul {
            overlap: -room,
            difference: ring.teeth() - mate.teeth(),
        }
        .into());
    }
    Ok(())
}

impl Pair {
    /// Sets a gear and its mate on parallel axes at a centre distance, or at a distance from the gear's centre to the reference line of
    /// a rack (m).
    ///
    /// # Errors
    /// [`GeometryError`] for members that do not belong together, a distance without engagement or with overlapping
    /// flanks, tips that reach root or fillet of the mate, and a total contact ratio below 1.
    pub fn new<'a>(
        gear: &Gear,
        mate: impl Into<Mate<'a>>,
        distance: f64,
    ) -> Result<Self, GeometryError> {
        let mate = mate.into();
        if let Mate::Rack(_) = mate {
            if gear.is_conical() {
                return Err(GeometryError::Conical(ConicalError::OnRack));
            }
            if gear.is_internal() {
                return Err(InternalError::OnRack.into());
            }
        }
        let pair = match mate {
            Mate::Gear(two) => {
                positive(Quantity::CentreDistance, distance)?;
                check_same_rack(gear, mate)?;
                Self::of_gears(gear, two, distance)?
            }
            Mate::Rack(rack) => {
                positive(Quantity::RackDistance, distance)?;
                check_same_rack(gear, mate)?;
                Self::on_rack(gear, rack, distance)?
            }
        };
        if pair.total_contact_ratio() < 1.0 {
            return Err(GeometryError::ContactRatio {
                value: pair.total_contact_ratio(),
            });
        }
        Ok(pair)
    }

    fn of_gears(one: &Gear, two: &Gear, distance: f64) -> Result<Self, GeometryError> {
        check_inside(one, two)?;
        let signs = [one.sign(), two.sign()];
        let internal = signs[0] * signs[1] < 0.0;
        // Radii and the distance with the signs of the numbers of teeth.
        let a = if internal { -distance } else { distance };
        let signed = |k: usize, x: f64| signs[k] * x;
        let r_base = [signed(0, one.r_base()), signed(1, two.r_base())];
        let chi = [
            signed(0, one.half_angle_base()),
            signed(1, two.half_angle_base()),
        ];
        let base_sum = r_base[0] + r_base[1];
        if distance <= base_sum.abs() {
            return Err(match internal {
                true => InternalError::DistanceTooSmall {
                    distance,
                    difference: -base_sum,
                }
                .into(),
                false => GeometryError::CentreDistanceTooSmall {
                    centre_distance: distance,
                    base_sum,
                },
            });
        }
        let alpha_w = (base_sum / a).acos();
        let length = ((a - base_sum) * (a + base_sum)).sqrt().copysign(a);
        let s_start = length - two.roll_length_tip();
        let s_end = one.roll_length_tip();
        let tips = signed(0, one.r_tip()) + signed(1, two.r_tip());
        if a >= tips || s_end <= s_start {
            let reach = one.roll_length_tip() + two.roll_length_tip();
            return Err(match internal {
                // The distance at which both reach the same place of the line of action.
                true => InternalError::NoEngagement {
                    distance,
                    least: base_sum.hypot(reach.min(0.0)).max(-tips),
                }
                .into(),
                false => GeometryError::NoEngagement {
                    centre_distance: distance,
                    max_distance: base_sum.hypot(reach).min(tips),
                },
            });
        }
        let backlash_base = backlash_constant(one, two) + 2.0 * base_sum * inv(alpha_w);
        if backlash_base < -SLACK * distance {
            let backlash = backlash_base / alpha_w.cos();
            let touching = Self::centre_distance_for_backlash(one, two, 0.0)?;
            return Err(match internal {
                true => InternalError::FlanksOverlap {
                    distance,
                    backlash,
                    greatest: touching,
                }
                .into(),
                false => GeometryError::FlanksOverlap {
                    centre_distance: distance,
                    backlash,
                    min_distance: touching,
                },
            });
        }
        let clearance = [
            a - signed(0, one.r_tip()) - signed(1, two.r_root()),
            a - signed(1, two.r_tip()) - signed(0, one.r_root()),
        ];
        check_clearance(["gear 1", "gear 2"], clearance, distance)?;
        // The tip of each gear must meet its mate on the involute.
        for (tip_of, tip, mate) in [("gear 1", one, two), ("gear 2", two, one)] {
            let reach = length - tip.roll_length_tip();
            let below = mate.roll_length_form() - reach;
            if below > FORM_SLACK * one.params().module {
                let allowed = tip.r_base().hypot(length - mate.roll_length_form());
                return Err(GeometryError::Interference {
                    tip_of,
                    below,
                    reduce_by: tip.sign() * (tip.r_tip() - allowed),
                });
            }
        }
        if internal {
            check_tips(one, two, distance, alpha_w)?;
        }
        let backlash_base = backlash_base.max(0.0);
        Ok(Self {
            distance,
            alpha_w,
            base_pitch: one.base_pitch(),
            s_start: s_start.max(one.roll_length_form()),
            s_end: s_end.min(length - two.roll_length_form()),
            r_base: r_base[0],
            chi: chi[0],
            second: Second::Gear {
                length,
                r_base: r_base[1],
                chi: chi[1],
                towards: if internal { 0.0 } else { PI },
            },
            pitch_radii: r_base.map(|rb| rb / alpha_w.cos()),
            face_width: one.face_width().min(two.face_width()),
            beta_b: one.base_helix_angle(),
            backlash_base,
            backlash_circ: backlash_base / alpha_w.cos(),
        })
    }

    fn on_rack(gear: &Gear, rack: &Rack, distance: f64) -> Result<Self, GeometryError> {
        let alpha = gear.transverse_pressure_angle();
        let (sin, cos) = alpha.sin_cos();
        let (r, r_base) = (gear.r_reference(), gear.r_base());
        let s_of_x = |x: f64| (x - r_base * cos) / sin;
        let s_start = s_of_x(distance - rack.tip_height());
        let s_end = gear.roll_length_tip();
        if s_end <= s_start || distance - rack.tip_height() >= gear.r_tip() {
            let reach = (r_base * cos + s_end * sin).min(gear.r_tip());
            return Err(GeometryError::NoEngagement {
                centre_distance: distance,
                max_distance: reach + rack.tip_height(),
            });
        }
        // Thickness of both teeth and the pitch, on the reference circle rolling on the pitch line.
        let rack_half = rack.half_thickness_on_flank(distance - r);
        let backlash_circ = rack.pitch() - 2.0 * r * gear.half_angle_reference() - 2.0 * rack_half;
        if backlash_circ < -SLACK * distance {
            return Err(GeometryError::FlanksOverlap {
                centre_distance: distance,
                backlash: backlash_circ,
                min_distance: distance - backlash_circ / (2.0 * alpha.tan()),
            });
        }
        let clearance = [
            distance + rack.root_depth() - gear.r_tip(),
            distance - rack.tip_height() - gear.r_root(),
        ];
        check_clearance(["gear 1", "the rack"], clearance, distance)?;
        let below = gear.roll_length_form() - s_start;
        if below > FORM_SLACK * gear.params().module {
            return Err(GeometryError::Interference {
                tip_of: "the rack",
                below,
                reduce_by: below * sin,
            });
        }
        let s_rack_form = s_of_x(distance + rack.form_depth());
        if s_end - s_rack_form > FORM_SLACK * gear.params().module {
            return Err(GeometryError::Interference {
                tip_of: "gear 1",
                below: s_end - s_rack_form,
                reduce_by: gear.r_tip() - r_base.hypot(s_rack_form),
            });
        }
        let backlash_circ = backlash_circ.max(0.0);
        Ok(Self {
            distance,
            alpha_w: alpha,
            base_pitch: gear.base_pitch(),
            s_start: s_start.max(gear.roll_length_form()),
            s_end: s_end.min(s_rack_form),
            r_base,
            chi: gear.half_angle_base(),
            second: Second::Rack {
                half_thickness: rack.half_thickness_reference(),
            },
            pitch_radii: [r, f64::INFINITY],
            face_width: gear.face_width().min(rack.face_width()),
            beta_b: gear.base_helix_angle(),
            backlash_base: backlash_circ * alpha.cos(),
            backlash_circ,
        })
    }

    /// Centre distance (m) at which two gears have the circumferential backlash `backlash` (m) at
    /// the working pitch circle; 0 gives the closest mesh free of backlash, in an internal gear the one furthest off its axis.
    ///
    /// # Errors
    /// [`GeometryError`] for gears that do not belong together, a negative backlash, or teeth so
    /// thin that the backlash is larger at every centre distance.
    pub fn centre_distance_for_backlash(
        one: &Gear,
        two: &Gear,
        backlash: f64,
    ) -> Result<f64, GeometryError> {
        not_negative(Quantity::Backlash, backlash)?;
        check_same_rack(one, Mate::Gear(two))?;
        check_inside(one, two)?;
        let base_sum = base_sum(one, two);
        let constant = backlash_constant(one, two);
        // Backlash grows with the distance of external gears, and falls with it in an internal one.
        let excess = |aw: f64| {
            let sign = base_sum.signum();
            sign * (constant + 2.0 * base_sum * inv(aw) - backlash * aw.cos())
        };
        if excess(0.0) >= 0.0 {
            return Err(GeometryError::Invalid {
                what: Quantity::Backlash,
                value: backlash,
                expected: match base_sum > 0.0 {
                    true => "more: the thinned teeth have a larger backlash at any centre distance",
                    false => {
                        "less: at any centre distance in the internal gear the backlash is smaller"
                    }
                },
            });
        }
        // The excess rises with the working pressure angle: bisection cannot miss it.
        let (mut lo, mut hi) = (0.0, FRAC_PI_2 - 1e-9);
        for _ in 0..100 {
            let mid = 0.5 * (lo + hi);
            if excess(mid) < 0.0 {
                lo = mid;
            } else {
                hi = mid;
            }
        }
        Ok(base_sum.abs() / hi.cos())
    }
}
