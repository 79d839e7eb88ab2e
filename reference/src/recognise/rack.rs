//! A rack recognised from its surface alone: the planes of its flanks, its pitch, its back.
//!
//! Flanks of a rack are two families of parallel planes. Faces that share a normal are gathered, two gatherings are taken
//! for the left and the right flanks, and the back is the outermost plane against their bisector. With `x` from the teeth to
//! the back, `z` normal to the end faces and `y = z x x`, a flank of side `s` (+1 right, towards +y; -1 left) of tooth `k` is
//!
//! ```text
//! y = y_0 + k p - tan(beta) z + s (h + x tan(alpha_t))
//! ```
//!
//! (the basic rack of ISO 53 in its transverse section, ISO 21771-1), and linear least squares over the corner nodes of the
//! flanks give the pitch `p`, the helix, the half thickness `h` and the pressure angle. The reference line is where the tooth
//! is half a pitch thick, `h + x tan(alpha_t) = p / 4`: a thinned tooth counts as one cut deeper. Its frame is that of
//! [`crate::mesh`].

mod flanks;
mod planes;
#[cfg(test)]
mod tests;

pub use planes::recognise;

use super::Patch;
use super::tied::Unroll;
use gearbench_models::Vec3;
use gearbench_models::geometry::Side;
use std::f64::consts::PI;

/// A rack recognised from its surface. Positions are in its own frame: the reference line is y, the teeth point to -x,
/// tooth 0 is centred on y = 0, z = 0 is the middle of the width.
#[derive(Clone, Debug, PartialEq)]
pub struct RecognisedRack {
    /// Unit vectors of its own x, y and z in the frame of the nodes.
    pub axes: [Vec3; 3],
    /// Its own origin [m].
    pub origin: Vec3,
    /// Number of teeth, those that the ends cut included.
    pub teeth: u32,
    /// Transverse pitch [m].
    pub pitch: f64,
    /// Transverse pressure angle [rad].
    pub pressure_angle: f64,
    /// Helix angle, right hand positive [rad].
    pub helix_angle: f64,
    /// Root mean square and largest distance of the nodes from their planes [m].
    pub residual: [f64; 2],
    /// Nodes that the planes were fitted to.
    pub nodes: usize,
    /// Height of the tips above the reference line [m].
    pub tip: f64,
    /// Depth of the roots below it [m].
    pub root: f64,
    /// Depth of the back below it [m].
    pub back: f64,
    /// All nodes of the back, mid-side nodes too.
    pub back_nodes: Vec<u32>,
    /// Least and greatest height of flank nodes above the reference line [m].
    pub active: [f64; 2],
    /// Width of the flanks [m].
    pub width: f64,
    /// Flanks, tooth by tooth, left before right.
    pub flanks: Vec<Patch>,
}

impl RecognisedRack {
    /// Position in its own frame.
    pub fn own(&self, x: &Vec3) -> Vec3 {
        let w = x - self.origin;
        Vec3::new(
            w.dot(&self.axes[0]),
            w.dot(&self.axes[1]),
            w.dot(&self.axes[2]),
        )
    }

    /// Normal module [m].
    pub fn module(&self) -> f64 {
        self.pitch * self.helix_angle.cos() / PI
    }

    /// Normal pressure angle [rad].
    pub fn normal_pressure_angle(&self) -> f64 {
        (self.pressure_angle.tan() * self.helix_angle.cos()).atan()
    }

    /// Steps of a tooth along y: teeth run from `-(n - 1) / 2` up.
    fn steps(&self, tooth: u32) -> f64 {
        let last = i64::from(self.teeth / 2);
        let tooth = i64::from(tooth);
        let steps = if tooth > last {
            tooth - i64::from(self.teeth)
        } else {
            tooth
        };
        steps as f64
    }

    /// Tooth of the flank of a side next to a position in the own frame.
    fn nearest(&self, x: &Vec3, side: Side) -> u32 {
        let steps = self.across(x, 0.0, side) / self.pitch;
        (steps.round() as i64).rem_euclid(i64::from(self.teeth)) as u32
    }

    /// How far a position lies towards +y from a flank of the tooth so many steps from tooth 0 [m].
    fn across(&self, x: &Vec3, steps: f64, side: Side) -> f64 {
        let half = 0.25 * self.pitch + x.x * self.pressure_angle.tan();
        x.y - steps * self.pitch + x.z * self.helix_angle.tan() - sense(side) * half
    }

    /// Returns the length of a flank's gradient: the ratio of a distance along y to one along the normal.
    fn steepness(&self) -> f64 {
        1.0_f64
            .hypot(self.pressure_angle.tan())
            .hypot(self.helix_angle.tan())
    }
}

/// Returns the direction along y that a flank of a rack faces: left ones touch left flanks of gears, towards -y.
fn sense(side: Side) -> f64 {
    -side.sign()
}

/// Along the profile counts its length, from the reference line.
impl Unroll for RecognisedRack {
    fn along(&self, x: &Vec3) -> f64 {
        -x.x / self.pressure_angle.cos()
    }

    fn arc(&self, [from, to]: [f64; 2]) -> f64 {
        to - from
    }

    fn between(&self, [from, to]: [f64; 2], part: f64) -> f64 {
        from + part * (to - from)
    }

    fn distance(&self, x: &Vec3, tooth: u32, side: Side) -> f64 {
        sense(side) * self.across(x, self.steps(tooth), side) / self.steepness()
    }

    fn point(&self, tooth: u32, side: Side, along: f64, z: f64, away: f64) -> Vec3 {
        let x = -along * self.pressure_angle.cos();
        let on = Vec3::new(x, 0.0, z);
        let y = -self.across(&on, self.steps(tooth), side);
        // Along the transverse part of the normal: place along the width stays.
        let (sin, cos) = self.pressure_angle.sin_cos();
        let shift = away * self.steepness() * cos;
        Vec3::new(x - shift * sin, y + sense(side) * shift * cos, z)
    }

    fn height(&self, x: &Vec3) -> f64 {
        -x.x
    }
}
