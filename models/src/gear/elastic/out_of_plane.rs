//! This module extends the elastic gear to a hub with out-of-plane freedom: it adds the motion of the hub by the modes, and
//! the forces of the bearing on the modes.
//!
//! The floating frame moves as a rigid body does ([`crate::kinematics::OutOfPlane`]); the modes have no momentum in
//! the free directions of the hub. The displacement of the hub from the frame follows from the modes, with the gear
//! frame rotating with the gear,
//!
//! ```text
//! h = x + u,   u = T(theta) s,   s = sum_i Phi_i q_i,   h' = x' + T s' + theta' z x u,   T = diag(R_z, R_z)
//! ```
//!
//! and the bearing exerts `F(h, h')` on it: by virtual work `F` on the frame, `Phi_i . T^T F` on mode `i`, and, as a hub
//! that stands off turns with the frame, `F . (z x u)` on `theta`.
//!
//! That a frame which tilts takes the modes' tilt of the hub along is left out: of second order in tilts.

mod newton;

use super::body::Elastic;
use super::reduced::OutOfPlaneShapes;
use crate::Vec3;
use crate::error::Reason;
use crate::kinematics::{BodyMass, Motion, OutOfPlane, Placement};
use crate::spec::Freedom;
use gearbench_integrators::system::StateView;
use nalgebra::{Matrix3, Rotation3};
use std::sync::Arc;

/// Three translations and three rotations.
type SixDirections = [f64; 6];

/// Hub shapes of the modes in all six directions.
#[derive(Clone, Debug)]
pub(super) struct HubShapes(pub Vec<SixDirections>);

/// Rotation of the gear frame into the axes of the hub.
#[derive(Clone, Copy, Debug)]
struct FrameRotation {
    cos: f64,
    sin: f64,
    /// True if the gear frame rotates with the hub's own motion.
    turns: bool,
}

impl FrameRotation {
    fn to_hub(self, s: &SixDirections) -> SixDirections {
        let FrameRotation { cos, sin, .. } = self;
        let of = |x: f64, y: f64| [cos * x - sin * y, sin * x + cos * y];
        let ([a, b], [c, d]) = (of(s[0], s[1]), of(s[3], s[4]));
        [a, b, s[2], c, d, s[5]]
    }

    fn to_own(self, f: &SixDirections) -> SixDirections {
        FrameRotation {
            sin: -self.sin,
            ..self
        }
        .to_hub(f)
    }

    /// Computes `dT/dtheta s` from `T s`.
    fn slope(self, u: &SixDirections) -> SixDirections {
        if self.turns {
            [-u[1], u[0], 0.0, -u[4], u[3], 0.0]
        } else {
            [0.0; 6]
        }
    }
}

/// Motion of frame and hub at a state.
struct LateralMotion {
    turned: FrameRotation,
    frame: Motion,
    hub: Motion,
    /// Displacement of the hub from the frame, and the part of its rate from the modal velocities.
    off: SixDirections,
    rate: SixDirections,
}

fn dot(a: &SixDirections, b: &SixDirections) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn add(a: &mut SixDirections, factor: f64, b: &SixDirections) {
    a.iter_mut().zip(b).for_each(|(a, b)| *a += factor * b);
}

/// Transforms the reduction to the out-of-plane directions of a hub.
///
/// # Errors
/// What of the directions the modes do not know.
pub(super) fn on_hub(
    lateral: &OutOfPlane,
    shapes: Option<&Arc<OutOfPlaneShapes>>,
    placement: &Placement,
) -> Result<OutOfPlane, Reason> {
    let driven = |f: &Freedom| matches!(f, Freedom::Driven(_));
    if lateral.directions.iter().any(driven) {
        return Err((
            "an out-of-plane direction of its hub is driven, which the modes do not include",
            "fix or free it, or use a rigid gear or movable teeth",
        )
            .into());
    }
    let free = [0, 1, 2, 3, 4, 5].map(|d| lateral.directions[d] == Freedom::Free);
    let Some(shapes) = shapes.filter(|s| s.free == own_order(free, placement.slides)) else {
        return Err((
            "the modes are those of a hub with other free directions",
            "reduce the gear for this mount",
        )
            .into());
    };
    // From own axes to those of the hub at the assembled position.
    let to_hub = if placement.slides {
        Matrix3::new(0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0)
    } else {
        *Rotation3::from_axis_angle(&Vec3::z_axis(), placement.phase).matrix()
    };
    let inertia = Matrix3::from_row_slice(&shapes.inertia);
    Ok(OutOfPlane {
        body: BodyMass {
            mass: shapes.mass,
            inertia: to_hub * inertia * to_hub.transpose(),
            centre: to_hub * Vec3::from(shapes.centre),
        },
        ..lateral.clone()
    })
}

/// Returns the directions of a hub in the axes of the gear frame: the hub of a rack has its direction of motion, the y
/// axis of the gear frame, first.
fn own_order(free: [bool; 6], slides: bool) -> [bool; 6] {
    let [a, b, c, d, e, f] = free;
    if slides { [b, a, c, e, d, f] } else { free }
}

impl Elastic {
    fn lateral(&self) -> Option<(&OutOfPlane, &HubShapes)> {
        Some((self.hub.lateral.as_deref()?, self.shapes.as_ref()?))
    }

    fn turned(&self, t: f64, q: &[f64]) -> FrameRotation {
        if self.placement.slides {
            // Own y is the first axis of the hub.
            return FrameRotation {
                cos: 0.0,
                sin: -1.0,
                turns: false,
            };
        }
        let (sin, cos) = (self.placement.phase + self.hub.displacement(t, q)).sin_cos();
        FrameRotation {
            cos,
            sin,
            turns: true,
        }
    }

    /// Computes `sum_i Phi_i x_i` over the modes of a vector of coordinates.
    fn of_modes(&self, shapes: &HubShapes, x: &[f64]) -> SixDirections {
        let mut sum = [0.0; 6];
        for (phi, x) in shapes.0.iter().zip(&x[self.own..]) {
            add(&mut sum, *x, phi);
        }
        sum
    }

    fn lateral_motion(&self, shapes: &HubShapes, at: StateView<'_>) -> LateralMotion {
        let frame = self.hub.motion(at.t, at.q, at.v);
        let turned = self.turned(at.t, at.q);
        let off = turned.to_hub(&self.of_modes(shapes, at.q));
        let rate = turned.to_hub(&self.of_modes(shapes, at.v));
        let mut hub = frame;
        add(&mut hub.x, 1.0, &off);
        add(&mut hub.v, 1.0, &rate);
        add(&mut hub.v, frame.v[self.hub.moving()], &turned.slope(&off));
        LateralMotion {
            turned,
            frame,
            hub,
            off,
            rate,
        }
    }

    /// Returns position and velocity of the hub.
    pub(super) fn hub_motion_on_frame(&self, at: StateView<'_>) -> Motion {
        match self.lateral() {
            Some((_, shapes)) => self.lateral_motion(shapes, at).hub,
            None => self.hub.motion(at.t, at.q, at.v),
        }
    }

    /// Returns the bearing forces on the hub, or zeros without a bearing.
    pub(super) fn bearing_on_hub(&self, at: StateView<'_>) -> SixDirections {
        self.lateral().map_or([0.0; 6], |(lateral, shapes)| {
            lateral.bearing_forces(&self.lateral_motion(shapes, at).hub)
        })
    }

    /// Returns the energy in the bearing [J], the power of its dampers, and the power of a driven rotation into it
    /// [W].
    pub(super) fn bearing_books(&self, at: StateView<'_>) -> [f64; 3] {
        let Some((lateral, shapes)) = self.lateral() else {
            return [0.0; 3];
        };
        let s = self.lateral_motion(shapes, at);
        let [energy, taken] = lateral.bearing_energy(&s.hub);
        let mut driven = 0.0;
        if !self.hub.is_free() {
            let f = lateral.bearing_forces(&s.hub);
            let own = self.hub.moving();
            driven = -s.frame.v[own] * (dot(&f, &s.turned.slope(&s.off)) + f[own]);
        }
        [energy, taken, driven]
    }

    /// Adds bearing forces and the spin terms of the rigid body; without `whole` only the part of the bearing forces
    /// that modes add to those on a rigid body.
    pub(super) fn add_bearing(&self, at: StateView<'_>, whole: bool, f: &mut [f64]) {
        let Some((lateral, shapes)) = self.lateral() else {
            return;
        };
        let s = self.lateral_motion(shapes, at);
        let force = lateral.bearing_forces(&s.hub);
        let mut on_frame = force;
        if !whole {
            add(&mut on_frame, -1.0, &lateral.bearing_forces(&s.frame));
        } else if lateral.spins {
            add(&mut on_frame, 1.0, &lateral.spin_forces(&s.frame));
        }
        for (f, d) in f.iter_mut().zip(self.hub.free_directions()) {
            *f += on_frame[d];
        }
        if self.hub.is_free() {
            f[0] += dot(&force, &s.turned.slope(&s.off));
        }
        let own = s.turned.to_own(&force);
        for (f, phi) in f[self.own..].iter_mut().zip(&shapes.0) {
            *f += dot(phi, &own);
        }
    }

    /// Adds the change of bearing forces and spin terms.
    pub(super) fn add_bearing_tangent(
        &self,
        at: StateView<'_>,
        [dq, dv]: [&[f64]; 2],
        df: &mut [f64],
    ) {
        let Some((lateral, shapes)) = self.lateral() else {
            return;
        };
        let s = self.lateral_motion(shapes, at);
        let own = self.hub.moving();
        let mut along = Motion::default();
        for (k, d) in self.hub.free_directions().enumerate() {
            (along.x[d], along.v[d]) = (dq[k], dv[k]);
        }
        let (turn, spin) = (along.x[own], along.v[own]);
        let speed = s.frame.v[own];
        let (slope, rate_slope) = (s.turned.slope(&s.off), s.turned.slope(&s.rate));
        let change = s.turned.to_hub(&self.of_modes(shapes, dq));
        let rate = s.turned.to_hub(&self.of_modes(shapes, dv));
        let mut of_hub = along;
        add(&mut of_hub.x, 1.0, &change);
        add(&mut of_hub.x, turn, &slope);
        add(&mut of_hub.v, 1.0, &rate);
        add(&mut of_hub.v, turn, &rate_slope);
        add(&mut of_hub.v, spin, &slope);
        add(&mut of_hub.v, speed, &s.turned.slope(&change));
        add(&mut of_hub.v, speed * turn, &s.turned.slope(&slope));
        let force = lateral.bearing_forces(&s.hub);
        let by_hub = lateral.bearing_change(&s.hub, &of_hub);
        let mut on_frame = by_hub;
        if lateral.spins {
            add(&mut on_frame, 1.0, &lateral.spin_change(&s.frame, &along));
        }
        for (df, d) in df.iter_mut().zip(self.hub.free_directions()) {
            *df += on_frame[d];
        }
        if self.hub.is_free() {
            let turned = s.turned.slope(&slope);
            df[0] += dot(&by_hub, &slope)
                + dot(&force, &s.turned.slope(&change))
                + turn * dot(&force, &turned);
        }
        let mut on_modes = s.turned.to_own(&by_hub);
        // T_theta^T F = -(z x T^T F)
        let own = s.turned.to_own(&force);
        add(&mut on_modes, -turn, &s.turned.slope(&own));
        for (df, phi) in df[self.own..].iter_mut().zip(&shapes.0) {
            *df += dot(phi, &on_modes);
        }
    }
}
