//! The flank nodes of a mesh: their numbers, outward normals and areas.
//!
//! Flank nodes are numbered through from 0, tooth by tooth, left flank before right flank, row by row, whatever the
//! order of the mesh; a node at the edge between two flanks has a number on each. Modes and compliances of a
//! reduction share these numbers, and the normals: displacements count outwards, forces into the tooth.
//!
//! Where friction loads the flanks, each node has a second direction behind its normal: along the profile
//! ([`Surface::with_profile`]). Shapes and compliances then have two rows per node, first outwards.

use super::error::ReductionError;
use crate::gear_mesh::{GearMesh, TiedPoint};
use gearbench_models::Vec3;
use gearbench_models::contact::points::{nodal_normals, reference_areas};
use gearbench_models::geometry::{FlankGrid, Flanks, along_profile};
use gearbench_models::spec::PointRule;

/// Weight above which a point counts as tied to a node, where that node must not be tied to the hub.
const TOUCHES: f64 = 1e-9;

/// The flank nodes of a gear.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// Flanks in the gear's own frame with the numbers of the flank nodes.
    pub flanks: Flanks,
    /// Node of the mesh per flank node (of the sector, for a gear of equal sectors); numbers from the number of nodes
    /// of the mesh on are tied points.
    pub mesh_nodes: Vec<u32>,
    /// Nodes to which tied points are tied.
    tied: TiedPoints,
    /// Directions in which nodes move, own frame: the outward unit normals of the smooth undeformed flanks.
    pub directions: Vec<Vec3>,
    /// Each normal is followed by the direction along the profile; `mesh_nodes` come twice then.
    pub along_profile: bool,
    /// Flank area of each node [m^2].
    pub areas: Vec<f64>,
}

/// Points of flanks that follow several nodes: their numbers go on after those of the nodes.
#[derive(Clone, Debug, PartialEq)]
struct TiedPoints {
    nodes: usize,
    points: Vec<TiedPoint>,
}

impl TiedPoints {
    fn of(gear: &GearMesh) -> Self {
        TiedPoints {
            nodes: gear.mesh.nodes.len(),
            points: gear.tied.clone(),
        }
    }

    fn get(&self, point: u32) -> Option<&TiedPoint> {
        self.points.get((point as usize).checked_sub(self.nodes)?)
    }
}

fn flank_error(text: String) -> ReductionError {
    ReductionError::Flanks(text)
}

impl Surface {
    /// The flank nodes of a mesh, whole or of some teeth.
    pub fn new(gear: &GearMesh) -> Result<Self, ReductionError> {
        let mut order: Vec<&FlankGrid> = gear.flanks.iter().collect();
        order.sort_by_key(|g| (g.tooth, g.side));
        if order.is_empty() {
            return Err(flank_error(
                "the mesh names none; give the node sets of the flanks that may touch, such as `flank_1l`".into(),
            ));
        }
        let name = |g: &FlankGrid| format!("the {:?} flank of tooth {}", g.side, g.tooth + 1);
        for pair in order.windows(2) {
            if (pair[0].tooth, pair[0].side) == (pair[1].tooth, pair[1].side) {
                return Err(flank_error(format!("{} is given twice", name(pair[0]))));
            }
        }
        let mut held = vec![false; gear.mesh.nodes.len()];
        for &node in &gear.bore {
            held[node as usize] = true;
        }
        let tied = TiedPoints::of(gear);
        let holds = |node: u32| match tied.get(node) {
            Some(point) => {
                let nodes = point.0.iter().filter(|(_, w)| w.abs() > TOUCHES);
                (nodes.map(|(n, _)| held.get(*n as usize).copied()))
                    .try_fold(false, |any, held| Some(any || held?))
            }
            None => held.get(node as usize).copied(),
        };
        let (mut mesh_nodes, mut grids) = (Vec::new(), Vec::with_capacity(order.len()));
        for g in order {
            let n = g.rows * g.columns;
            if g.rows < 2 || g.columns < 2 || g.nodes.len() != n || g.positions.len() != n {
                return Err(flank_error(format!(
                    "{} has {} nodes and {} positions for a grid of {} x {}, which must be at least 2 x 2",
                    name(g),
                    g.nodes.len(),
                    g.positions.len(),
                    g.rows,
                    g.columns
                )));
            }
            for &node in &g.nodes {
                match holds(node) {
                    Some(false) => {}
                    Some(true) => {
                        return Err(flank_error(format!(
                            "node {node} of {} belongs to the bore as well: the hub holds it, so it cannot yield to contact",
                            name(g)
                        )));
                    }
                    None => {
                        return Err(flank_error(format!(
                            "{} names node {node}, but the mesh has {}",
                            name(g),
                            held.len()
                        )));
                    }
                }
            }
            let first = mesh_nodes.len() as u32;
            mesh_nodes.extend_from_slice(&g.nodes);
            grids.push(FlankGrid {
                nodes: (first..).take(n).collect(),
                ..g.clone()
            });
        }
        let flanks = Flanks::new(grids);
        let (mut normals, mut areas) = (Vec::new(), Vec::new());
        for g in 0..flanks.grids().len() {
            normals.extend(nodal_normals(&flanks, g));
            areas.extend(reference_areas(&flanks, g, PointRule::Nodes));
        }
        if let Some(i) = normals
            .iter()
            .position(|n| !n.iter().all(|x| x.is_finite()))
        {
            return Err(flank_error(format!(
                "no normal at node {}: the nodes of its flank about it coincide or lie in a line",
                mesh_nodes[i]
            )));
        }
        Ok(Surface {
            flanks,
            mesh_nodes,
            tied,
            directions: normals,
            along_profile: false,
            areas,
        })
    }

    /// Returns the flank nodes of a whole gear from a sector with tooth 0.
    pub fn of_sector(sector: &GearMesh) -> Result<Self, ReductionError> {
        let own = Self::new(sector)?;
        if let Some(g) = own.flanks.grids().iter().find(|g| g.tooth != 0) {
            return Err(flank_error(format!(
                "the sector has a flank of tooth {}, but it is tooth 1 that is repeated",
                g.tooth + 1
            )));
        }
        let (teeth, per_tooth) = (sector.teeth, own.nodes() as u32);
        let pitch = std::f64::consts::TAU / f64::from(teeth);
        let mut grids = Vec::new();
        let mut normals = Vec::new();
        for tooth in 0..teeth {
            let (s, c) = (pitch * f64::from(tooth)).sin_cos();
            let turn = |x: &Vec3| Vec3::new(c * x.x - s * x.y, s * x.x + c * x.y, x.z);
            grids.extend(own.flanks.grids().iter().map(|g| FlankGrid {
                tooth,
                nodes: g.nodes.iter().map(|k| k + tooth * per_tooth).collect(),
                positions: g.positions.iter().map(turn).collect(),
                ..g.clone()
            }));
            normals.extend(own.directions.iter().map(turn));
        }
        Ok(Surface {
            flanks: Flanks::new(grids),
            mesh_nodes: own.mesh_nodes.repeat(teeth as usize),
            tied: own.tied,
            directions: normals,
            along_profile: false,
            areas: own.areas.repeat(teeth as usize),
        })
    }

    /// Returns the surface with the direction along the profile of each node after its normal.
    #[must_use]
    pub fn with_profile(self) -> Self {
        let directions = self.directions.iter();
        Surface {
            mesh_nodes: self.mesh_nodes.iter().flat_map(|n| [*n, *n]).collect(),
            directions: directions.flat_map(|n| [*n, along_profile(n)]).collect(),
            along_profile: true,
            ..self
        }
    }

    /// Number of flank nodes.
    pub fn nodes(&self) -> usize {
        self.mesh_nodes.len() / self.per_node()
    }

    /// Number of directions in which a node moves.
    pub fn per_node(&self) -> usize {
        1 + usize::from(self.along_profile)
    }

    /// Outward normal of each flank node.
    pub fn normals(&self) -> impl Iterator<Item = &Vec3> {
        self.directions.iter().step_by(self.per_node())
    }

    /// Position of the flank node of each direction, own frame [m].
    pub fn positions(&self) -> Vec<Vec3> {
        let grids = self.flanks.grids().iter();
        let nodes = grids.flat_map(|g| g.positions.iter().copied());
        nodes
            .flat_map(|x| std::iter::repeat_n(x, self.per_node()))
            .collect()
    }

    /// `out_k = d_k . u(node of k)` for displacements of the mesh, three per node; nodes of a whole mesh only.
    pub fn along_directions(&self, u: &[f64], out: &mut [f64]) {
        let along = |n: &Vec3, node: u32| {
            let u = &u[3 * node as usize..][..3];
            n.x * u[0] + n.y * u[1] + n.z * u[2]
        };
        for ((out, n), &node) in out.iter_mut().zip(&self.directions).zip(&self.mesh_nodes) {
            *out = match self.tied.get(node) {
                None => along(n, node),
                Some(point) => point.0.iter().map(|&(node, w)| w * along(n, node)).sum(),
            };
        }
    }

    /// Iterates over the nodes of the mesh that move a flank node, given by its index in `mesh_nodes`, each with its
    /// weight: itself, or those of its face.
    pub fn follows(&self, place: usize) -> impl Iterator<Item = (u32, f64)> + '_ {
        let node = self.mesh_nodes[place];
        let tied = self.tied.get(node);
        let own = tied.is_none().then_some((node, 1.0));
        own.into_iter()
            .chain(tied.into_iter().flat_map(|p| p.0.iter().copied()))
    }

    /// Every flank node is a node of the mesh.
    pub fn is_of_nodes(&self) -> bool {
        self.tied.points.is_empty()
    }
}

#[cfg(test)]
mod tests;
