//! The displaced mesh behind an elastic gear, for figures.

use super::body::Elastic;
use crate::error::Reason;
use crate::gear::body::{BodyLoad, DisplacedNodes, MeshedBody, Recovery};
use crate::geometry::swept::Cells;
use gearbench_integrators::system::StateView;
use std::sync::Arc;

impl Elastic {
    fn recovered(&self) -> Result<&dyn Recovery, Reason> {
        let why = "the mesh behind the reduction is not known";
        (self.recovery.as_deref()).ok_or_else(|| why.into())
    }
}

impl MeshedBody for Elastic {
    fn cells(&self) -> Result<Arc<Cells>, Reason> {
        self.recovered()?.cells()
    }

    fn displaced(&self, at: StateView<'_>, load: &BodyLoad) -> Result<DisplacedNodes, Reason> {
        let [nodes, u] = self.recovered()?.displacements(&at.q[self.own..], load)?;
        let pose = self.pose(at);
        Ok(DisplacedNodes {
            rigid: nodes.iter().map(|x| pose.point(x)).collect(),
            displacement: u.iter().map(|u| pose.turn(u)).collect(),
        })
    }
}
