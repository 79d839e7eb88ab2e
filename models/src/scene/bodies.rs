//! Bodies of gears as they stand at a state, for pictures.
//!
//! Gears of finite elements show their mesh; all others the surface of their teeth ([`Swept`]), which moves with the hub, its
//! teeth by their own displacements beyond that. What a node is off the rigid motion of its gear is its displacement: that
//! motion is the hub's, of reduced gears that of their mean axes.

use super::assembled::Scene;
use crate::Vec3;
use crate::error::{BuildError, GearPart, Reason};
use crate::gear::{BodyLoad, Displaced};
use crate::geometry::swept::{Cells, Swept};
use crate::kinematics::{Placement, Tooth};
use crate::spec::{Body, SceneSpec};
use gearbench_integrators::system::At;
use std::sync::Arc;

/// Points along a flank of a surface.
const POINTS: usize = 16;

/// The body of a gear.
#[derive(Clone, Debug)]
pub struct Pictured {
    /// Its elements, or the faces of its surface.
    pub cells: Arc<Cells>,
    /// The surface; `None` where the gear itself says where its nodes are.
    swept: Option<Swept>,
}

impl Scene {
    /// The bodies of its gears.
    ///
    /// # Errors
    /// [`BuildError`] names a gear whose body is not known.
    pub fn bodies(&self, spec: &SceneSpec) -> Result<Vec<Pictured>, BuildError> {
        let gears = spec.gears.iter().zip(&self.gears);
        gears
            .map(|(of, gear)| {
                let refused = |why: Reason| BuildError::gear(&of.name, GearPart::Model, why);
                if let Some(body) = gear.model.body() {
                    let cells = body.cells().map_err(refused)?;
                    return Ok(Pictured { cells, swept: None });
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
                    Body::Gear(g) => Swept::gear(g, POINTS),
                    Body::Rack(r) => Swept::rack(r, POINTS),
                };
                Ok(Pictured {
                    cells: Arc::new(swept.cells.clone()),
                    swept: Some(swept),
                })
            })
            .collect()
    }

    /// The nodes of a gear's body at a state.
    ///
    /// # Errors
    /// [`BuildError`] says why they are not known.
    pub fn displaced(
        &mut self,
        at: At<'_>,
        gear: usize,
        body: &Pictured,
    ) -> Result<Displaced, BuildError> {
        let mut found = self.seen(at, |scene, seen| scene.seen_body(seen, gear, body))?;
        let Displaced {
            rigid,
            displacement,
        } = &mut found;
        self.carriers.lift(gear, at, [rigid, displacement]);
        Ok(found)
    }

    /// The same where carriers do not turn.
    fn seen_body(
        &mut self,
        at: At<'_>,
        gear: usize,
        body: &Pictured,
    ) -> Result<Displaced, BuildError> {
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
                    let forces = forces.chain(of.along.iter().zip(&of.rub));
                    let pressed = forces.filter(|(_, f)| **f != 0.0);
                    BodyLoad {
                        forces: pressed.map(|(k, f)| (*k, *f)).collect(),
                        hub: of.load,
                    }
                });
            let found = g.model.body().map(|b| b.displaced(g.at(at), &load));
            return found
                .unwrap_or_else(|| Ok(Displaced::default()))
                .map_err(|why| BuildError::gear(&g.name, GearPart::Model, why));
        };
        let g = &self.gears[gear];
        let own = g.at(at);
        let hub = &g.model.hub().hub;
        let moved = g.model.hub_state(own).displacement;
        let placement = Placement::new(hub, self.phases[gear]);
        let pose = placement.pose_at(hub, own.t, own.q, moved);
        let rigid: Vec<Vec3> = swept.nodes.iter().map(|x| pose.point(x)).collect();
        let Some(teeth) = g.model.teeth() else {
            let displacement = vec![Vec3::zeros(); rigid.len()];
            return Ok(Displaced {
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
        Ok(Displaced {
            rigid,
            displacement,
        })
    }
}
