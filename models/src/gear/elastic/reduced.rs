//! The reduction of an elastic gear: plain data of one gear on one kind of mount.
//!
//! Conventions, stated once:
//!
//! - Flank nodes are numbered through from 0, tooth by tooth, left flank before right flank, row by row as in
//!   [`FlankGrid`](crate::geometry::FlankGrid); those numbers are the nodes of [`Reduced::flanks`].
//! - Shapes and displacements at flank nodes are along the outward normal of the undeformed flank, positive out of
//!   the tooth; forces on them are positive into the tooth.
//! - Where friction loads the flanks, `nodes + k` is the number of node `k` along the profile: its outward normal's
//!   transverse part, turned by 90 degrees counter-clockwise. Displacements count that way, forces against it. In
//!   memory the row along the profile of a node follows its outward one, so that a tooth stands together.
//! - Modes are orthonormal in the mass of the whole gear with what is added at the hub: shapes in 1/sqrt(kg),
//!   coordinates in sqrt(kg) m.
//! - A hub that moves turns counter-clockwise (a rack travels along its slide) for positive angle, torque and shape.

use super::deflated::Deflated;
use super::inertia::Integrals;
use crate::Vec3;
use crate::geometry::Flanks;
use std::sync::Arc;

/// Reduced data of a gear: modes, flank shapes and residual compliance.
#[derive(Clone, Debug)]
pub struct Reduced {
    /// Flanks in the gear frame.
    pub flanks: Flanks,
    /// Outward unit normal at each flank node, in the gear frame.
    pub normals: Vec<Vec3>,
    /// True if displacements of the flank nodes along the profile are included.
    pub along_profile: bool,
    /// True if the hub is free in the direction of the mount; otherwise the modes are those of a fixed hub.
    pub free: bool,
    /// Inertia about the axis [kg m^2], or mass [kg] of a rack, including that added at the hub.
    pub inertia: f64,
    /// Angular frequencies of the kept modes [rad/s], positive.
    pub omega: Vec<f64>,
    /// Damping ratios of the kept modes [-].
    pub damping: Vec<f64>,
    /// Shapes at the flank nodes, `row * modes + mode` [1/sqrt(kg)]; see [`Self::shapes_at`].
    pub shapes: Vec<f64>,
    /// Rotation [rad] (displacement [m]) of a free hub relative to the frame per unit coordinate; zeros for a fixed
    /// hub.
    pub hub: Vec<f64>,
    /// Inertia coupling `phi_i^T M e` of a fixed hub with the prescribed motion `e`; zeros for a free hub.
    pub participation: Vec<f64>,
    /// Momentum of each mode per unit velocity of its coordinate, `phi_i^T M e_x` and `phi_i^T M e_y` with the unit
    /// translations of the whole gear along x and y of its frame [sqrt(kg)]. Its acceleration loads the bearing.
    pub momentum: Vec<[f64; 2]>,
    /// Mass of the gear times the position of its centre of mass, x and y in its frame [kg m].
    pub unbalance: [f64; 2],
    /// Static compliance of the truncated modes; `None` for plain truncation.
    pub residual: Option<Residual>,
    /// Displacement of a row of nodes under a line load at a row, from the mesh near a flank without any support,
    /// divided by `A = 2 (1 - nu^2)/(pi E)`; lengths are in m, `rows x rows` values for each of the flanks.
    pub near_field: Option<Arc<Vec<Vec<f64>>>>,
    /// Inertia integrals of the kept modes, for gears at high speed.
    pub integrals: Option<Integrals>,
    /// Data of a hub with out-of-plane freedom.
    pub lateral: Option<Arc<OutOfPlaneShapes>>,
}

/// Motion of a hub with out-of-plane freedom by the modes, and rigid-body inertia of the gear.
#[derive(Clone, Debug, PartialEq)]
pub struct OutOfPlaneShapes {
    /// Free out-of-plane directions: translations along x, y, z of the gear frame, rotations about them.
    pub free: [bool; 6],
    /// Translation [m] and rotation [rad] of the hub relative to the frame per unit coordinate of each mode, in the
    /// gear frame; zero in fixed directions and in that of the own motion.
    pub hub: Vec<[f64; 6]>,
    /// Mass of the gear including that added at the hub [kg].
    pub mass: f64,
    /// Centre of mass in the gear frame [m].
    pub centre: [f64; 3],
    /// Inertia tensor about the centre of mass, row-major [kg m^2].
    pub inertia: [f64; 9],
}

/// Static compliance of the truncated modes.
#[derive(Clone, Debug)]
pub struct Residual {
    /// Compliance between flank nodes.
    pub flanks: FlankCompliance,
    /// Displacement of each row of a flank node per unit torque at a free hub [m/(N m)] (per unit force on a rack
    /// [m/N]); zeros for a fixed hub.
    pub hub: Vec<f64>,
    /// Rotation (displacement) of the hub per unit torque (force) at it.
    pub hub_hub: f64,
}

/// Inward displacement [m] of a flank node per unit force [N] into another.
#[derive(Clone, Debug)]
pub enum FlankCompliance {
    /// Compliance between any two nodes: symmetric, row-major over all flank nodes.
    Full(Vec<f64>),
    /// Compliance of a cyclic gear, with equal teeth: `blocks[d][i][j]` is the displacement of node `i` of tooth `t +
    /// d` by a force on node `j` of tooth `t`, `d` from 0 to `teeth - 1`, row-major.
    Cyclic {
        /// Number of teeth of the gear.
        teeth: usize,
        /// Number of flank nodes of a tooth.
        per_tooth: usize,
        /// Blocks of the compliance, one after the other.
        blocks: Vec<f64>,
    },
    /// Compliance of a cyclic gear without that of modes fitted to some of its teeth.
    Deflated(Box<Deflated>),
}

impl FlankCompliance {
    /// Returns the compliance between two of `nodes` flank nodes [m/N].
    #[inline]
    pub fn between(&self, i: u32, j: u32, nodes: usize) -> f64 {
        let (i, j) = (i as usize, j as usize);
        match self {
            FlankCompliance::Full(c) => c[i * nodes + j],
            FlankCompliance::Cyclic {
                teeth,
                per_tooth: m,
                blocks,
            } => {
                let apart = (i / m + teeth - j / m) % teeth;
                blocks[(apart * m + i % m) * m + j % m]
            }
            FlankCompliance::Deflated(c) => c.between(i as u32, j as u32),
        }
    }

    /// Writes the compliances between all of `nodes` to `out`, row-major; `all` is the number of flank nodes.
    pub fn gather(&self, nodes: &[u32], all: usize, out: &mut [f64]) {
        let rows = out.chunks_exact_mut(nodes.len().max(1)).zip(nodes);
        match self {
            FlankCompliance::Full(c) => {
                for (row, &i) in rows {
                    let of_node = &c[i as usize * all..][..all];
                    for (x, &j) in row.iter_mut().zip(nodes) {
                        *x = of_node[j as usize];
                    }
                }
            }
            FlankCompliance::Cyclic {
                teeth,
                per_tooth: m,
                blocks,
            } => {
                for (row, &i) in rows {
                    let (tooth, place) = (i as usize / m, i as usize % m);
                    // Nodes come tooth by tooth: the block changes seldom.
                    let (mut first, mut line) = (usize::MAX, &blocks[..0]);
                    for (x, &j) in row.iter_mut().zip(nodes) {
                        let j = j as usize;
                        if !(first..first.saturating_add(*m)).contains(&j) {
                            let of_j = j / m;
                            first = of_j * m;
                            let apart = (tooth + teeth - of_j) % teeth;
                            line = &blocks[(apart * m + place) * m..][..*m];
                        }
                        *x = line[j - first];
                    }
                }
            }
            FlankCompliance::Deflated(c) => {
                for (row, &i) in rows {
                    for (x, &j) in row.iter_mut().zip(nodes) {
                        *x = c.between(i, j);
                    }
                }
            }
        }
    }

    /// Returns a description of the problem if the compliance does not match the number of rows.
    pub(super) fn problem(&self, rows: usize) -> Option<String> {
        let (c, expected) = match self {
            FlankCompliance::Full(c) => (c, rows * rows),
            FlankCompliance::Cyclic {
                teeth,
                per_tooth,
                blocks,
            } => {
                if teeth * per_tooth != rows {
                    return Some(format!(
                        "{teeth} teeth with {per_tooth} rows of flank nodes, but {rows} in all"
                    ));
                }
                (blocks, teeth * per_tooth * per_tooth)
            }
            FlankCompliance::Deflated(c) => return c.problem(rows),
        };
        if c.len() != expected {
            return Some(format!("{} compliances, expected {expected}", c.len()));
        }
        (!c.iter().all(|x| x.is_finite())).then(|| "a number is not finite".into())
    }
}

impl Reduced {
    /// Returns the number of flank nodes.
    pub fn nodes(&self) -> usize {
        self.normals.len()
    }

    /// Returns the number of rows of shapes and compliances: one or two per flank node.
    pub fn rows(&self) -> usize {
        self.nodes() * self.per_node()
    }

    /// Returns the number of rows of a flank node.
    pub fn per_node(&self) -> usize {
        1 + usize::from(self.along_profile)
    }

    /// Returns the row of a number: of a flank node outwards, or, from [`Self::nodes`] on, along the profile.
    #[inline]
    pub fn row_of(&self, number: u32) -> u32 {
        if !self.along_profile {
            return number;
        }
        let nodes = self.nodes() as u32;
        if number < nodes {
            2 * number
        } else {
            2 * (number - nodes) + 1
        }
    }

    /// Returns the number of kept modes.
    pub fn modes(&self) -> usize {
        self.omega.len()
    }

    /// Returns the shapes of all modes at a number.
    #[inline]
    pub fn shapes_at(&self, number: u32) -> &[f64] {
        let n = self.omega.len();
        &self.shapes[self.row_of(number) as usize * n..][..n]
    }

    /// Returns a description of the first inconsistency, if any: lengths, and numbers that are not finite or have the
    /// wrong sign.
    pub fn problem(&self) -> Option<String> {
        let (nodes, rows, modes) = (self.nodes(), self.rows(), self.modes());
        let grid_nodes: usize = self.flanks.grids().iter().map(|g| g.nodes.len()).sum();
        let lengths = [
            ("nodes of the flanks", grid_nodes, nodes),
            ("damping ratios", self.damping.len(), modes),
            ("shapes", self.shapes.len(), rows * modes),
            ("hub shapes", self.hub.len(), modes),
            ("participations", self.participation.len(), modes),
            ("momenta", self.momentum.len(), modes),
        ];
        let lateral = self.lateral.as_deref();
        let of_hub = lateral.map(|l| ("lateral hub shapes", l.hub.len(), modes));
        for (what, found, expected) in lengths.into_iter().chain(of_hub) {
            if found != expected {
                return Some(format!("{found} {what}, expected {expected}"));
            }
        }
        if let Some(g) = self.flanks.grids().iter().find(|g| {
            g.rows < 2
                || g.columns < 1
                || g.rows * g.columns != g.nodes.len()
                || g.nodes.len() != g.positions.len()
                || g.nodes.iter().any(|n| *n as usize >= nodes)
        }) {
            return Some(format!(
                "the flank grid of tooth {} is not {} x {} of the {nodes} flank nodes",
                g.tooth, g.rows, g.columns
            ));
        }
        if let Some(r) = &self.residual {
            if let Some(problem) = r.flanks.problem(rows) {
                return Some(problem);
            }
            if r.hub.len() != rows {
                return Some(format!(
                    "{} compliances towards the hub, expected {rows}",
                    r.hub.len()
                ));
            }
        }
        if self.integrals.as_ref().is_some_and(|i| !i.fits(modes)) {
            return Some(format!(
                "the inertia integrals are not those of {modes} modes"
            ));
        }
        let finite = |x: &[f64]| x.iter().all(|x| x.is_finite());
        if !(self.omega.iter().all(|w| w.is_finite() && *w > 0.0)
            && self.damping.iter().all(|z| z.is_finite() && *z >= 0.0))
        {
            return Some("frequencies must be positive, and damping ratios 0 or more".into());
        }
        let residual =
            (self.residual.as_ref()).is_none_or(|r| finite(&r.hub) && r.hub_hub.is_finite());
        let inertia = self.inertia.is_finite() && self.inertia > 0.0;
        let lateral = lateral.is_none_or(|l| {
            let positive = l.mass > 0.0 && [0, 4, 8].iter().all(|k| l.inertia[*k] > 0.0);
            positive
                && l.mass.is_finite()
                && finite(l.hub.as_flattened())
                && finite(&l.centre)
                && finite(&l.inertia)
        });
        (!(residual
            && lateral
            && inertia
            && finite(&self.shapes)
            && finite(&self.hub)
            && finite(&self.participation)
            && finite(self.momentum.as_flattened())
            && finite(&self.unbalance)))
        .then(|| "a number is not finite".into())
    }
}
