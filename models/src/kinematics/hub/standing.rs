//! Where a hub that may move sideways stands at a state: what all points on its gear ask it for.
//!
//! A unit force along `n` at `x` has the wrench `[n; (x - o) x n]` about the place `o` of the hub. Of it the turn takes the
//! component along the turned axis, and the lateral directions `S^T` of it, in the axes of the mount.

use super::Hub;
use crate::Vec3;
use crate::kinematics::HubFrame;
use crate::kinematics::freedom::{self, Motion};
use crate::kinematics::row::Row;
use crate::spec::Freedom;

/// Place of a hub with lateral directions.
#[derive(Clone, Copy, Debug)]
pub struct Standing {
    motion: Motion,
    frame: HubFrame,
    /// Axes of the three rotations, in those of the mount.
    rotations: [Vec3; 3],
}

impl Hub {
    /// Where the hub stands; `None` where it only turns or slides.
    pub fn standing(&self, t: f64, q: &[f64]) -> Option<Standing> {
        self.lateral.as_ref()?;
        let motion = self.motion(t, q, &[]);
        Some(Standing {
            frame: self.frame_of(&motion.x),
            rotations: freedom::rotation_axes(&motion.x),
            motion,
        })
    }

    /// The effective radius of [`Self::effective_radius_at`] where the hub stands.
    #[inline]
    pub fn effective_radius_on(&self, standing: Option<&Standing>, x: &Vec3, n: &Vec3) -> f64 {
        let Some(Standing { frame, .. }) = standing else {
            return self.effective_radius(x, n);
        };
        match self.slide {
            None => frame.axes[2].dot(&(x - frame.origin).cross(n)),
            Some(slide) => slide.dot(n),
        }
    }

    /// Appends the lateral directions to a row; `with_own` that of its own motion as well. Returns the part of
    /// `d(x . n)/dt` [m/s] that driven directions prescribe.
    pub fn lateral_row_on(
        &self,
        t: f64,
        standing: &Standing,
        (x, n): (&Vec3, &Vec3),
        row: &mut Row,
        with_own: bool,
    ) -> f64 {
        let Some(lateral) = &self.lateral else {
            return 0.0;
        };
        let own = self.moving();
        // Force and moment in the axes of the mount.
        let local = |y: &Vec3| {
            Vec3::new(
                self.axes[0].dot(y),
                self.axes[1].dot(y),
                self.axes[2].dot(y),
            )
        };
        let r = x - standing.frame.origin;
        let (force, moment) = (local(n), local(&r.cross(n)));
        let component = |d: usize| match d {
            0..3 => force[d],
            _ => standing.rotations[d - 3].dot(&moment),
        };
        let first = usize::from(self.is_free());
        row.push_span(first, lateral.free(own).map(component));
        let mut prescribed = 0.0;
        for (d, freedom) in lateral.directions.iter().enumerate() {
            if d != own && matches!(freedom, Freedom::Driven(_)) {
                prescribed += component(d) * standing.motion.v[d];
            }
        }
        if with_own {
            if self.is_free() {
                row.push(0, component(own));
            } else {
                prescribed += component(own) * self.speed(t, &[]);
            }
        }
        prescribed
    }
}
