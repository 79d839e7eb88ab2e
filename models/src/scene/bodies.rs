//! Bodies of gears at a state, for figures.
//!
//! Gears of finite elements show their mesh; all others the surface of their teeth ([`SweptSurface`]), which moves with the hub, its
//! teeth by their own displacements beyond that. What a node is off the rigid motion of its gear is its displacement: that
//! motion is the hub's, of reduced gears that of their mean axes.

use super::assembled::Scene;
use crate::Vec3;
use crate::error::{BuildError, GearPart, Reason};
use crate::gear::{BodyLoad, DisplacedNodes};
use crate::geometry::Frame;
use crate::geometry::swept::{Cells, SweptSurface};
use crate::kinematics::{Placement, Pose, Tooth};
use crate::spec::{Body, SceneSpec};
use gearbench_integrators::system::StateView;
use std::sync::Arc;

/// Number of points along a flank of a surface.
const POINTS: usize = 16;

/// Body of a gear for a figure.
#[derive(Clone, Debug)]
pub struct GearPicture {
    /// Elements of the body, or faces of its surface.
    pub cells: Arc<Cells>,
    /// Surface of the body; `None` where the gear itself returns the positions of its nodes.
    swept: Option<SweptSurface>,
}

impl Scene {
    /// Returns the bodies of the gears.
    ///
    /// # Errors
    /// [`BuildError`] names a gear whose body is not known.
    pub fn bodies(&self, spec: &SceneSpec) -> Result<Vec<GearPicture>, BuildError> {
        let gears = spec.gears.iter().zip(&self.gears);
        gears
            .map(|(of, gear)| {
                let refused = |why: Reason| BuildError::gear(&of.name, GearPart::Model, why);
                if let Some(body) = gear.model.body() {
                    let cells = body.cells().map_err(refused)?;
                    return Ok(GearPicture { cells, swept: None });
                }
                if gear.model.surface().is_some() {
                    let why = (
                        format!(
                            "the model `{}` has the flanks of its teeth, but not the mesh of the body",
                            gear.id
                        ),
                        "give it a mesh in place of a stored reduction, or exclude the model from the pictures",
                    );
                    return Err(refused(why.into()));
                }
                let swept = match &of.body {
                    Body::Gear(g) => SweptSurface::gear(g, POINTS),
                    Body::Rack(r) => SweptSurface::rack(r, POINTS),
                };
                Ok(GearPicture {
                    cells: Arc::new(swept.cells.clone()),
                    swept: Some(swept),
                })
            })
            .collect()
    }

    /// Returns the nodes of a gear's body at a state.
    ///
    /// # Errors
    /// [`BuildError`] says why they are not known.
    pub fn displaced(
        &mut self,
        at: StateView<'_>,
        gear: usize,
        body: &GearPicture,
    ) -> Result<DisplacedNodes, BuildError> {
        let mut found = self.with_carrier_state(at, |scene, carrier_state| {
            scene.carrier_frame_body(carrier_state, gear, body)
        })?;
        let DisplacedNodes {
            rigid,
            displacement,
        } = &mut found;
        self.carriers.lift(gear, at, [rigid, displacement]);
        Ok(found)
    }

    /// Returns the frame of a member at a state, a gear or a body without teeth: origin and axes of its own frame in space.
    pub fn pose(&mut self, at: StateView<'_>, gear: usize) -> Pose {
        let pose = self.with_carrier_state(at, |scene, carrier_state| {
            scene.carrier_frame_pose(carrier_state, gear)
        });
        let Pose { axes, origin } = pose;
        let frame = self.carriers.frame(gear, at, Frame { axes, origin });
        Pose {
            axes: frame.axes,
            origin: frame.origin,
        }
    }

    /// Returns the displacement of a tooth beyond that of its gear [rad] (rack: [m]); `None` for gears whose teeth have
    /// no coordinates of their own.
    pub fn tooth_displacement(&self, at: StateView<'_>, gear: usize, tooth: Tooth) -> Option<f64> {
        let g = &self.gears[gear];
        let own = g.at(at);
        let teeth = g.model.teeth()?;
        let moved = g.model.hub_state(own).displacement;
        Some(teeth.displacement(own, tooth) - moved)
    }

    fn carrier_frame_pose(&self, at: StateView<'_>, gear: usize) -> Pose {
        let g = &self.gears[gear];
        let own = g.at(at);
        let hub = &g.model.hub().hub;
        let moved = g.model.hub_state(own).displacement;
        // Bodies without teeth have no phase.
        let phase = self.phases.get(gear).copied().unwrap_or(0.0);
        Placement::new(hub, phase).pose_at(hub, own.t, own.q, moved)
    }

    /// Returns the nodes of a gear's body in the carrier-frame state.
    fn carrier_frame_body(
        &mut self,
        at: StateView<'_>,
        gear: usize,
        body: &GearPicture,
    ) -> Result<DisplacedNodes, BuildError> {
        let Some(swept) = &body.swept else {
            self.evaluate_contacts(at);
            let g = &self.gears[gear];
            let load = self
                .work
                .nodal
                .gears
                .get(gear)
                .map_or_else(BodyLoad::default, |of| {
                    let forces = of.nodes.iter().zip(&of.force);
                    let forces = forces.chain(of.along.iter().zip(&of.friction_force));
                    let pressed = forces.filter(|(_, f)| **f != 0.0);
                    BodyLoad {
                        forces: pressed.map(|(k, f)| (*k, *f)).collect(),
                        hub: of.load,
                    }
                });
            let found = g.model.body().map(|b| b.displaced(g.at(at), &load));
            return found
                .unwrap_or_else(|| Ok(DisplacedNodes::default()))
                .map_err(|why| BuildError::gear(&g.name, GearPart::Model, why));
        };
        let g = &self.gears[gear];
        let own = g.at(at);
        let hub = &g.model.hub().hub;
        let moved = g.model.hub_state(own).displacement;
        let pose = self.carrier_frame_pose(at, gear);
        let rigid: Vec<Vec3> = swept.nodes.iter().map(|x| pose.point(x)).collect();
        let Some(teeth) = g.model.teeth() else {
            let displacement = vec![Vec3::zeros(); rigid.len()];
            return Ok(DisplacedNodes {
                rigid,
                displacement,
            });
        };
        let mut last = (i64::MIN, 0.0);
        let nodes = swept.nodes.iter().zip(&swept.teeth);
        let displacement = nodes
            .map(|(x, &(index, share))| {
                if last.0 != index {
                    let tooth = Tooth { index, mesh: 0 };
                    last = (index, teeth.displacement(own, tooth) - moved);
                }
                let by = share * last.1;
                pose.turn(&match hub.slide {
                    Some(_) => Vec3::new(0.0, by, 0.0),
                    None => {
                        let (sin, cos) = by.sin_cos();
                        Vec3::new(
                            cos * x.x - sin * x.y - x.x,
                            sin * x.x + cos * x.y - x.y,
                            0.0,
                        )
                    }
                })
            })
            .collect();
        Ok(DisplacedNodes {
            rigid,
            displacement,
        })
    }
}
