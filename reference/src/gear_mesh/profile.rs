//! Half a tooth unrolled: its boundary in the plane in which gears and racks are meshed alike.
//!
//! A gear is unrolled by the conformal map `U = r_f theta`, `V = r_f ln(r / r_f)`: circles become lines
//! `V = const`, radii become lines `U = const`, and right angles stay right angles, so that what is square in
//! the plane is square in the gear. An internal gear, whose teeth point to the axis, is unrolled by the same map turned by half a
//! turn, `U = -r_f theta`, `V = -r_f ln(r / r_f)`. A rack is unrolled by a shift. In all `V = 0` is the root, `U = 0` the
//! centreline of the tooth, `U > 0` its left side as one looks from the root to the tip.

use gearbench_models::geometry::{Gear, Rack};
use std::f64::consts::FRAC_PI_2;

/// A point of the unrolled plane [m].
pub(super) type Plane = [f64; 2];

/// Points of the fillet's table.
const TABLE: usize = 160;

/// The body whose tooth is meshed.
#[derive(Clone, Copy, Debug)]
pub(super) enum Body<'a> {
    Gear(&'a Gear),
    Rack(&'a Rack),
}

impl Body<'_> {
    /// Returns true if the left side of the unrolled tooth is the clockwise one: the teeth point to the axis.
    pub(super) fn points_inwards(self) -> bool {
        matches!(self, Body::Gear(g) if g.is_internal())
    }

    /// Half a pitch at the root [m].
    pub(super) fn half_pitch(self) -> f64 {
        match self {
            Body::Gear(g) => 0.5 * g.pitch_angle() * g.r_root(),
            Body::Rack(r) => 0.5 * r.pitch(),
        }
    }

    /// Depth of the body below the root, unrolled [m].
    pub(super) fn depth(self) -> f64 {
        match self {
            Body::Gear(g) => -self.unrolled_radius(g.seat_radius()),
            Body::Rack(r) => r.params().body_height,
        }
    }

    /// Height over the root of a radius, unrolled [m]; of a rack, of a height over the reference line.
    pub(super) fn unrolled_radius(self, r: f64) -> f64 {
        match self {
            Body::Gear(g) => g.sign() * g.r_root() * (r / g.r_root()).ln(),
            Body::Rack(rack) => r + rack.root_depth(),
        }
    }

    fn unroll(self, (r, half): (f64, f64)) -> Plane {
        let v = self.unrolled_radius(r);
        match self {
            Body::Gear(g) => [half * g.r_root(), v],
            Body::Rack(_) => [half, v],
        }
    }

    /// The transverse section: (radius, angle) of a gear, (height over the reference line, distance from the
    /// tooth's centreline) of a rack.
    pub(super) fn rolled(self, [u, v]: Plane) -> [f64; 2] {
        match self {
            Body::Gear(g) => {
                let per = g.sign() / g.r_root();
                [g.r_root() * (per * v).exp(), per * u]
            }
            Body::Rack(r) => [v - r.root_depth(), u],
        }
    }

    /// Point of the flank at the part `t` of its arc length from the form circle to the tip, and its length
    /// of roll [m] (0 on a rack). The arc length of an involute is `s^2 / (2 r_b)`.
    pub(super) fn flank(self, t: f64) -> (Plane, f64) {
        match self {
            Body::Gear(g) => {
                let (a, b) = (g.roll_length_form(), g.roll_length_tip());
                let s = g.sign() * (a * a + (b * b - a * a) * t).sqrt();
                let point = (g.r_base().hypot(s), g.half_angle_at_roll(s));
                (self.unroll(point), s)
            }
            Body::Rack(r) => {
                let (a, b) = (-r.form_depth(), r.tip_height());
                let h = a + (b - a) * t;
                (self.unroll((h, r.half_thickness_at(h))), 0.0)
            }
        }
    }

    fn fillet(self, t: f64) -> Plane {
        self.unroll(match self {
            Body::Gear(g) => g.fillet_at(t),
            Body::Rack(r) => r.fillet_at(t),
        })
    }
}

/// The root from the form circle over the fillet to the middle of the tooth space, by arc length.
#[derive(Clone, Debug)]
pub(super) struct Root<'a> {
    body: Body<'a>,
    /// Arc length [m] at the fillet's parameter `1 - i / (TABLE - 1)`.
    length: Vec<f64>,
    /// Length of the root arc [m].
    arc: f64,
    half_pitch: f64,
}

impl<'a> Root<'a> {
    pub(super) fn new(body: Body<'a>) -> Self {
        let mut length = Vec::with_capacity(TABLE);
        let mut last = body.fillet(1.0);
        let mut sum = 0.0;
        for i in 0..TABLE {
            let p = body.fillet(1.0 - i as f64 / (TABLE - 1) as f64);
            sum += (p[0] - last[0]).hypot(p[1] - last[1]);
            length.push(sum);
            last = p;
        }
        let half_pitch = body.half_pitch();
        Root {
            body,
            length,
            arc: (half_pitch - last[0]).max(0.0),
            half_pitch,
        }
    }

    /// Length of the fillet [m].
    pub(super) fn fillet_length(&self) -> f64 {
        self.length[TABLE - 1]
    }

    /// Length of the root arc [m].
    pub(super) fn arc_length(&self) -> f64 {
        self.arc
    }

    /// Length of both [m].
    pub(super) fn total(&self) -> f64 {
        self.fillet_length() + self.arc
    }

    /// The point at an arc length from the form circle [m].
    pub(super) fn at(&self, length: f64) -> Plane {
        let fillet = self.fillet_length();
        if length >= fillet {
            let u = self.half_pitch - (self.total() - length).max(0.0);
            return [u.min(self.half_pitch), 0.0];
        }
        let i = self
            .length
            .partition_point(|&l| l <= length)
            .clamp(1, TABLE - 1);
        let (a, b) = (self.length[i - 1], self.length[i]);
        let within = if b > a { (length - a) / (b - a) } else { 0.0 };
        let at = (i - 1) as f64 + within.clamp(0.0, 1.0);
        self.body.fillet(1.0 - at / (TABLE - 1) as f64)
    }

    /// Angle [rad] by which the inward normal dips below the line towards the tooth's centre: 0 to pi/2. Taken
    /// over a short stretch, so that it is smooth even where a sharp tool leaves an edge.
    pub(super) fn dip(&self, length: f64) -> f64 {
        let window = 0.04 * self.total();
        let a = self.at((length - window).max(0.0));
        // Beyond the middle of the space lies the mirror image: flat enough.
        let b = self.at((length + window).min(self.total()));
        (b[0] - a[0]).atan2(a[1] - b[1]).clamp(0.0, FRAC_PI_2)
    }
}
