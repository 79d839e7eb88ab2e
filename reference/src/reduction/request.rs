//! All that a basis depends on.

use super::store::SCHEMA;
use super::{Basis, ModeSelection, Mounting, ReductionError, basis};
use crate::assembly::tie::HubMotion;
use crate::gear_mesh::GearMesh;
use crate::hash::Hash;
use crate::matrices::ForeignBody;
use gearbench_models::stiffness::Material;

/// Version of the way a basis is computed from a request. Raise it with every change that moves a stored number by more
/// than rounding: bases that older programs computed are then no longer taken from the cache.
pub const ALGORITHM: u64 = 3;

/// Data from which a basis is computed.
#[derive(Clone, Copy, Debug)]
pub struct Request<'a> {
    /// Mesh of the gear.
    pub mesh: &'a GearMesh,
    /// The mesh is the sector of tooth 0 of a gear whose teeth are all alike.
    pub sector: bool,
    /// Material of the gear.
    pub material: Material,
    /// How the hub is mounted.
    pub mounting: Mounting,
    /// Selection of the modes to compute.
    pub wanted: ModeSelection,
    /// Flank nodes also move along the profile, where friction loads them.
    pub along_profile: bool,
    /// Matrices and mode shapes of another program in place of own ones; for whole meshes.
    pub foreign: Option<&'a ForeignBody>,
}

impl Request<'_> {
    /// Hash of the mesh.
    pub fn mesh_hash(&self) -> Hash {
        let gear = self.mesh;
        let mut h = Hash::START;
        h.text(&gear.mesh.kind_names());
        h.count(gear.mesh.nodes.len());
        gear.mesh.nodes.iter().for_each(|x| h.vector(x));
        gear.mesh
            .blocks
            .iter()
            .for_each(|b| h.numbers(&b.connectivity));
        h.count(gear.teeth as usize);
        h.numbers(&gear.bore);
        h.count(gear.flanks.len());
        for g in &gear.flanks {
            h.count(g.tooth as usize);
            h.count(g.side as usize);
            h.count(g.rows);
            h.count(g.columns);
            h.numbers(&g.nodes);
            g.positions.iter().for_each(|x| h.vector(x));
        }
        for point in &gear.tied {
            for (node, weight) in &point.0 {
                h.count(*node as usize);
                h.number(*weight);
            }
        }
        // The cuts of a sector join it to its copies.
        for name in ["cut_low", "cut_high"] {
            match gear.mesh.node_sets.get(name) {
                Some(nodes) => h.numbers(nodes),
                None => h.count(0),
            }
        }
        h
    }

    /// Hash of everything that the basis depends on: format, version of the algorithm, mesh and parameters.
    pub fn key(&self) -> Hash {
        let mut h = Hash::START;
        h.count(ALGORITHM as usize);
        h.count(SCHEMA as usize);
        h.hash(self.body_hash());
        match self.wanted {
            ModeSelection::Count(n) => {
                h.text("count");
                h.count(n);
            }
            ModeSelection::UpTo(f) => {
                h.text("up to");
                h.number(f);
            }
        }
        h
    }

    /// Returns the hash of everything except the requested modes: mesh, material, mounting.
    pub fn body_hash(&self) -> Hash {
        let mut h = Hash::START;
        h.hash(self.mesh_hash());
        let m = &self.material;
        [m.young, m.poisson, m.density]
            .iter()
            .for_each(|x| h.number(*x));
        h.count(usize::from(self.mounting.free));
        match self.mounting.motion {
            HubMotion::Turn => h.text("turn"),
            HubMotion::TurnAbout(axis) => {
                h.text("turn about");
                h.vector(&axis);
            }
            HubMotion::Slide(direction) => {
                h.text("slide");
                h.vector(&direction);
            }
        }
        h.number(self.mounting.added_inertia);
        h.count(usize::from(self.sector));
        if self.mounting.is_lateral() {
            h.text("lateral");
            self.mounting
                .lateral
                .iter()
                .for_each(|free| h.count(usize::from(*free)));
            h.number(self.mounting.added_mass);
            h.number(self.mounting.added_tilting);
        }
        if self.along_profile {
            h.text("along the profile");
        }
        if let Some(foreign) = self.foreign {
            h.text("foreign");
            h.hash(foreign.hash);
        }
        h
    }

    /// Computes the basis of the request.
    pub fn compute(&self) -> Result<Basis, ReductionError> {
        let (mesh, material, mounting) = (self.mesh, &self.material, &self.mounting);
        let (wanted, along_profile) = (self.wanted, self.along_profile);
        match (self.sector, self.foreign) {
            (true, None) => basis::of_sector(mesh, material, mounting, wanted, along_profile),
            (false, foreign) => {
                basis::of_mesh(mesh, material, mounting, wanted, along_profile, foreign)
            }
            (true, Some(_)) => Err(ReductionError::Mismatch(
                "matrices of another program belong to a whole mesh, not to a sector".into(),
            )),
        }
    }
}
