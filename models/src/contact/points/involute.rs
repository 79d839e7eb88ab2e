//! Position of a flank on the path coordinate, and its deviation from the involute at that position.

use super::search_gear::SearchGear;
use super::surface::Shape;
use crate::Vec3;
use crate::geometry::{FlankGrid, Side, inv};
use crate::kinematics::MeshView;
use crate::spec::Body;
use std::f64::consts::TAU;

/// Number of points along a face at which a surface is compared with its involute.
const SAMPLES: u32 = 8;
/// Relative margin of the largest deviation between these points.
const BETWEEN_SAMPLES: f64 = 0.05;

/// Returns the angle [rad] on the base circle (the coordinate y [m] on a rack's reference line) of the outermost node
/// of the undeformed flank, moved there along the involute and to the middle of the width.
pub(super) fn outermost(body: &Body, view: &MeshView, g: &FlankGrid) -> f64 {
    let sign = g.side.sign();
    let own = |x: &Vec3| place_of(body, view, g.side, x);
    // A left flank looks counter-clockwise, on an internal gear clockwise, on a rack to the own -y.
    let out = match body {
        Body::Gear(gear) => gear.sign() * sign,
        Body::Rack(_) => -sign,
    };
    let mut best: Option<f64> = None;
    for x in g.positions.iter() {
        let Some(mut p) = own(x) else { continue };
        if let (Some(b), Body::Gear(_)) = (best, body) {
            // Angles of one flank lie within one turn of each other.
            p -= TAU * ((p - b) / TAU).round();
        }
        best = Some(best.map_or(p, |b| if out * p > out * b { p } else { b }));
    }
    // A flank that ends below the form circle has the position of its last node.
    best.or_else(|| {
        g.positions.last().map(|x| {
            if matches!(body, Body::Gear(_)) {
                x.y.atan2(x.x)
            } else {
                x.y
            }
        })
    })
    .unwrap_or(0.0)
}

/// Returns the spread on the path coordinate [m] of the involutes through the nodes of a flank; infinite for a flank
/// without a node above the form circle.
pub(super) fn off_involute(o: &SearchGear<'_>, g: &FlankGrid) -> f64 {
    let base = o.view.base_radius.map(f64::abs);
    let per_place = base.unwrap_or_else(|| o.view.working_pressure_angle.cos());
    let mut places = (g.positions.iter()).filter_map(|x| place_of(o.body, &o.view, g.side, x));
    let Some(first) = places.next() else {
        return f64::INFINITY;
    };
    let off = |place: f64| match o.view.base_radius {
        Some(_) => place - first - TAU * ((place - first) / TAU).round(),
        None => place - first,
    };
    let (low, high) = places
        .map(off)
        .fold((0.0_f64, 0.0_f64), |(l, h), p| (l.min(p), h.max(p)));
    per_place * (high - low)
}

/// Returns the position as in [`outermost`] of a flank through a point of the gear frame; `None` below the form
/// circle.
fn place_of(body: &Body, view: &MeshView, side: Side, x: &Vec3) -> Option<f64> {
    let sign = side.sign();
    match body {
        Body::Gear(gear) if gear.is_conical() => {
            let flank = gear.flank(side);
            let rb = flank.base_radius;
            let r = x.x.hypot(x.y);
            let angle = x.y.atan2(x.x) - x.z * flank.tan_helix / rb;
            let roll = (r * r - rb * rb).max(0.0).sqrt();
            // The mesh measures positions by its own half angles.
            let own = angle + sign * (inv((roll / rb).atan()) - flank.half_angle);
            (r >= rb).then(|| own + sign * view.half_angle_of(side))
        }
        Body::Gear(gear) => {
            let rb = gear.r_base();
            let r = x.x.hypot(x.y);
            let angle = x.y.atan2(x.x) - x.z * gear.base_helix_angle().tan() / rb;
            let roll = (r * r - rb * rb).max(0.0).sqrt();
            // Seen from the root, left and right involutes of an internal gear unwind as those of an external one.
            let above = gear.sign() * (r - gear.r_form()) >= -1e-6 * gear.r_form();
            above.then(|| angle + sign * inv((roll / rb).atan()))
        }
        Body::Rack(rack) => {
            let tan = rack.transverse_pressure_angle().tan();
            let height = -x.x;
            (height >= -rack.form_depth() - 1e-6 * rack.pitch())
                .then(|| x.y + x.z * rack.params().helix_angle.tan() - sign * height * tan)
        }
    }
}

/// Returns the largest outward deviation, on the path coordinate [m], of a flank surface from the involute through its
/// outermost node. The surface is continued beyond the tip by `past` of its last face.
pub(super) fn deviation_bound(o: &SearchGear<'_>, shape: &Shape, outermost: f64, past: f64) -> f64 {
    let sign = shape.side.sign();
    let per_place = match o.view.base_radius {
        Some(rb) => sign * rb,
        None => -sign * o.view.working_pressure_angle.cos(),
    };
    let along = |row: usize, i: usize| {
        let last = if row + 2 == shape.rows {
            1.0 + past
        } else {
            1.0
        };
        last * i as f64 / f64::from(SAMPLES)
    };
    let (mut most, mut least) = (0.0_f64, 0.0_f64);
    for row in 0..shape.rows - 1 {
        for column in 0..shape.columns - 1 {
            for i in 0..=SAMPLES as usize {
                for b in [0.0, 0.5, 1.0] {
                    let x = shape.undeformed(row, column, [along(row, i), b]);
                    let Some(mut place) = place_of(o.body, &o.view, shape.side, &x) else {
                        continue;
                    };
                    place -= outermost;
                    if o.view.base_radius.is_some() {
                        place -= TAU * (place / TAU).round();
                    }
                    most = most.max(per_place * place);
                    least = least.min(per_place * place);
                }
            }
        }
    }
    // Between samples a surface that is smooth within a face rises by a small part of what it varies.
    most + BETWEEN_SAMPLES * (most - least)
}

/// Returns the path coordinate [m] of a flank at zero displacement and its tooth, from its [`outermost`] position.
pub(super) fn path_at_zero(o: &SearchGear<'_>, side: Side, outermost: f64) -> (f64, i64) {
    let (sign, v) = (side.sign(), &o.view);
    let tooth = |centre: f64| (centre / v.pitch).round() as i64;
    match v.base_radius {
        Some(rb) => (
            rb * (sign * (outermost + o.phase - v.direction) + v.working_pressure_angle),
            tooth(outermost - sign * v.half_angle_of(side)),
        ),
        None => (
            -sign * (v.assembled + outermost) * v.working_pressure_angle.cos(),
            tooth(outermost + sign * v.half_angle_of(side)),
        ),
    }
}
