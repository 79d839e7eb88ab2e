//! Guides: what holds a hub to the ground along its own motion. A guide is a link of one member to the ground, an elastic
//! one with the spring and the damper of the guide, and the friction of the guide on top,
//!
//! ```text
//! F = -k x - c x' - F_c z(x; x_0, z_0)
//! ```
//!
//! The position `x_0` and the fraction `z_0` of the sliding force at the last accepted state are part of the discrete
//! state, and so is the direction of the motion: friction is a function of the displacement as long as the direction
//! does not change, so that reversals are events where events are located. A reversal is detected by a speed slightly
//! beyond zero, so that rounding does not reverse a body at rest.

use super::links::{Link, Origin, to_ground};
use crate::error::{BuildError, GearPart};
use crate::law::{DryFriction, Part};
use crate::scene::assembled::Scene;
use crate::scene::members::SceneGear;
use crate::spec::{Guide, Mount, SceneSpec};
use gearbench_integrators::system::{Change, State, StateView};

/// Length of the history of a guide in the discrete state.
pub(in crate::scene) const CELLS: usize = 3;
/// Speed, relative to the typical one, at which a motion counts as reversed.
const TURNED: f64 = 1e-9;

/// A guide of a member of a scene.
#[derive(Clone, Debug)]
pub(in crate::scene) struct Guided {
    member: usize,
    guide: Guide,
}

/// Friction of a link with its history.
#[derive(Clone, Copy, Debug)]
pub(super) struct GuideFriction {
    pub law: DryFriction,
    /// Offset of its history in the discrete state.
    pub cell: usize,
    /// Speed at which the motion counts as reversed; set with the scales of the scene.
    pub turned: f64,
}

impl Guided {
    /// Returns the number of its event functions.
    pub(in crate::scene) fn events(&self) -> usize {
        let sticks = self.guide.friction.is_some_and(|law| law.sticks());
        usize::from(sticks)
    }
}

impl GuideFriction {
    /// Returns the fraction of the sliding force at a position and speed.
    pub fn part(&self, [x, v]: [f64; 2], discrete: &[f64]) -> Part {
        let start = [discrete[self.cell], discrete[self.cell + 1]];
        self.law.part(x, v, start)
    }

    /// Stores the fraction of the sliding force at a position and speed.
    fn remember(&self, motion: [f64; 2], discrete: &mut [f64]) {
        let reached = self.part(motion, discrete).z;
        discrete[self.cell..][..2].copy_from_slice(&[motion[0], reached]);
    }

    /// Returns an event function that is positive while the motion keeps its direction.
    fn goes_on(&self, v: f64, discrete: &[f64]) -> f64 {
        discrete[self.cell + 2] * v + self.turned
    }
}

/// Returns the guides of a scene where mounts leave hubs free; `gears` are its members, with bodies of shafts behind
/// the gears.
///
/// # Errors
/// A number that cannot be, a planet, or a member whose rigid shaft is held or driven.
pub(in crate::scene) fn guides(
    spec: &SceneSpec,
    gears: &[SceneGear],
) -> Result<Vec<Guided>, BuildError> {
    let of_gears = spec.gears.iter().map(|g| (&g.guide, &g.mount));
    let all = of_gears.chain(spec.bodies().map(|b| (&b.guide, &b.mount)));
    let mut found = Vec::new();
    for (member, (guide, mount)) in all.enumerate() {
        let free = matches!(mount, Mount::Revolute | Mount::Prismatic);
        let Some(guide) = guide.filter(|_| free) else {
            continue;
        };
        let name = spec.member_name(member);
        let refuse = |why: (&str, &str)| Err(BuildError::gear(name, GearPart::Mount, why));
        for (what, x) in [("stiffness", guide.stiffness), ("damping", guide.damping)] {
            if !(x >= 0.0 && x.is_finite()) {
                let why = format!("the {what} {x} of its guide is not zero or positive");
                return Err(BuildError::gear(name, GearPart::Mount, why));
            }
        }
        if !gears[member].model.hub().is_free() {
            return refuse((
                "its mount has a guide, but its rigid shaft is fixed or driven",
                "remove the guide, or let the shaft rotate freely",
            ));
        }
        if spec.bodies().any(|b| b.planets.contains(&member)) {
            return refuse((
                "a guide is fixed to the ground, but this gear is on a carrier",
                "remove the guide",
            ));
        }
        found.push(Guided { member, guide });
    }
    Ok(found)
}

/// Returns the link of a guide, whose history begins at a cell of the discrete state; `speed` is a typical one along
/// lines of action.
pub(super) fn of_guide(guided: &Guided, gears: &[SceneGear], (cell, speed): (usize, f64)) -> Link {
    let Guided { member, guide } = guided;
    let radius = gears[*member].model.hub().effective_base_radius;
    Link {
        stiffness: guide.stiffness,
        damping: guide.damping,
        guide_friction: guide.friction.map(|law| GuideFriction {
            law,
            cell,
            turned: TURNED * speed / radius,
        }),
        ..to_ground(*member, gears)
    }
}

impl Scene {
    /// Returns the member that a guide supports, and the stiffness of the guide at a state, including sticking
    /// friction.
    pub(in crate::scene) fn guide_at(
        &self,
        link: &Link,
        at: StateView<'_>,
    ) -> Option<(usize, f64)> {
        let guides = matches!(link.origin(), Origin::Guide) && !link.is_rigid();
        guides.then(|| (link.members[0], link.slopes(&self.gears, at)[0]))
    }

    /// Starts the friction of guides without deformation.
    pub(in crate::scene) fn begin_guides(&self, s: &mut State) {
        for (link, guide_friction) in self.frictional_guides() {
            let kind = if link.dot(&s.v) < 0.0 { -1.0 } else { 1.0 };
            s.discrete[guide_friction.cell..][..CELLS].copy_from_slice(&[
                link.dot(&s.q),
                0.0,
                kind,
            ]);
        }
    }

    /// Stores the friction of guides at an accepted state.
    pub(in crate::scene) fn remember_guides(&self, s: &mut State) {
        for (link, guide_friction) in self.frictional_guides() {
            let motion = [link.dot(&s.q), link.dot(&s.v)];
            guide_friction.remember(motion, &mut s.discrete);
        }
    }

    /// Computes the event functions of guides: reversals of the motion.
    pub(in crate::scene) fn watch_guides(&self, at: StateView<'_>, out: &mut [f64]) {
        let turning = self
            .frictional_guides()
            .filter(|(_, guide_friction)| guide_friction.law.sticks());
        for (out, (link, guide_friction)) in out.iter_mut().zip(turning) {
            *out = guide_friction.goes_on(link.dot(at.v), at.discrete);
        }
    }

    /// Updates the discrete state when the motion of a guide has reversed.
    pub(in crate::scene) fn turn_guide(&self, s: &mut State, which: usize) -> Change {
        let turning = self
            .frictional_guides()
            .filter(|(_, guide_friction)| guide_friction.law.sticks())
            .nth(which);
        if let Some((link, guide_friction)) = turning {
            guide_friction.remember([link.dot(&s.q), link.dot(&s.v)], &mut s.discrete);
            s.discrete[guide_friction.cell + 2] *= -1.0;
        }
        Change::Restart
    }

    fn frictional_guides(&self) -> impl Iterator<Item = (&Link, &GuideFriction)> {
        let springs = self.shafts.springs().iter();
        springs.filter_map(|link| Some((link, link.guide_friction.as_ref()?)))
    }

    /// Returns the force of the guide of a member along its motion, from the last [`Self::evaluate_links`].
    pub(in crate::scene) fn force_of_guide(&self, member: usize) -> f64 {
        let links = self.shafts.springs().iter().zip(self.acting_links());
        let own =
            links.filter(|(l, _)| matches!(l.origin(), Origin::Guide) && l.members[0] == member);
        own.map(|(_, force)| force).sum()
    }
}
