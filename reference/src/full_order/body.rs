//! What a full-order gear is made of: its mesh in the assembled position, stiffness, mass, and the inertia
//! that couples its nodes to the hub. Nothing here changes in time.

use super::frame::unit_motion;
use crate::assembly::tie::{HubMotion, MassKind, Reduced, Tie};
use crate::assembly::{Assembly, assemble};
use crate::element::ElementError;
use crate::limits;
use crate::mesh::GearMesh;
use crate::vector::dot;
use gearbench_models::Vec3;
use gearbench_models::geometry::Flanks;
use gearbench_models::kinematics::Placement;
use gearbench_models::spec::Mount;
use gearbench_models::stiffness::Material;

/// A gear's finite elements with the hub's nodes taken out.
#[derive(Debug)]
pub struct Body {
    /// Undeformed positions [m], from the hub's centre, in the assembled position.
    pub position: Vec<Vec3>,
    /// Stiffness and mass over all nodes.
    pub assembly: Assembly,
    /// Nodes with displacements of their own, in the order of their coordinates.
    pub free: Vec<u32>,
    /// Per node its place in `free`, or [`Tie::HELD`].
    pub place: Vec<u32>,
    /// Flanks, in the gear's own frame (before it is turned into the assembled position).
    pub flanks: Flanks,
    /// Which mass matrix.
    pub mass: MassKind,
    /// Stiffness and mass over the coordinates in the frame: `3 free`, then the hub's if it is free.
    pub reduced: Reduced,
    /// Inertia [kg m^2] or mass [kg] of the whole gear with what is added at the hub.
    pub inertia: f64,
    /// Inertia of the hub's coordinate with itself: held nodes and what is added.
    pub hub_inertia: f64,
    /// What is added at the hub.
    pub added_inertia: f64,
    /// Nodal masses times the places of held nodes, `M_fb X_b`, per place in `free` that has any [kg m].
    pub pull: Vec<(u32, [f64; 3])>,
    /// Stiffness between held and free nodes summed over the held ones, row by row, per place in `free` that has any:
    /// the force of the elements on the hub is that of these nodes alone [N/m].
    pub grip: Vec<(u32, [f64; 9])>,
    /// Mass of the held nodes, coupling included, as if the nodes beside them moved rigidly [kg].
    pub held_mass: f64,
    /// The same times the place [kg m].
    pub held_moment: Vec3,
}

/// Memory of a gear of `n` unknowns, `FACTORED n^(4/3)`: the fill of nested dissection in three dimensions (George 1973),
/// with the matrices beside it; measured from 64,000 to 213,000 unknowns [bytes].
const FACTORED: f64 = 163.0;

impl Body {
    /// Prepares a mesh in its assembled position on a hub with this mount.
    ///
    /// Where the hub is driven the mass between held and free nodes is lumped: the power of the drive then
    /// follows from the state alone, without the accelerations that contact makes.
    pub fn new(
        mesh: GearMesh,
        material: &Material,
        placement: &Placement,
        mount: &Mount,
        mass: MassKind,
        added_inertia: f64,
    ) -> Result<Body, ElementError> {
        let GearMesh {
            mut mesh,
            bore,
            flanks,
            ..
        } = mesh;
        let slide = placement.slides.then_some(placement.hub.axes[0]);
        let pose = placement.pose(0.0);
        for x in &mut mesh.nodes {
            *x = pose.point(x) - placement.hub.origin;
        }
        if mass == MassKind::Consistent {
            let unknowns = 3 * mesh.nodes.len();
            let what = format!("two gears of {unknowns} unknowns with their factors");
            let bytes = 2.0 * FACTORED * (unknowns as f64).powf(4.0 / 3.0);
            limits::check(
                what,
                bytes,
                "use fewer elements, or mass = \"lumped\" under an explicit method",
            )?;
        }
        let mut assembly = assemble(&mesh, material)?;
        let position = mesh.nodes;
        let motion = slide.map_or(HubMotion::Turn, HubMotion::Slide);
        let moves = matches!(mount, Mount::Revolute | Mount::Prismatic);
        let motions: &[HubMotion] = if moves { &[motion] } else { &[] };
        let tie = Tie::new(&position, &bore, motions);
        let (free, place) = (tie.free.clone(), tie.place.clone());
        if matches!(mount, Mount::Driven(_)) {
            assembly.mass.decouple(|node| place[node] == Tie::HELD);
        }
        let added = [added_inertia];
        let reduced = tie.reduce(&assembly, &added[..motions.len()], mass);

        let unit = |node: usize| unit_motion(&position[node].into(), slide.as_ref());
        let nodes = position.len();
        let mut motion_of = vec![0.0; 3 * nodes];
        let mut held_motion = vec![0.0; 3 * nodes];
        let mut held_place = vec![0.0; 3 * nodes];
        for node in 0..nodes {
            motion_of[3 * node..][..3].copy_from_slice(&unit(node));
        }
        for &node in &bore {
            let node = node as usize;
            held_motion[3 * node..][..3].copy_from_slice(&unit(node));
            if slide.is_none() {
                let x = &position[node];
                held_place[3 * node..][..2].copy_from_slice(&[x.x, x.y]);
            }
        }
        let times_mass = |x: &[f64]| {
            let mut y = vec![0.0; x.len()];
            times_mass(&assembly, mass, x, &mut y);
            y
        };
        let of_free = |y: &[f64]| {
            let mut out = Vec::new();
            for (k, &node) in free.iter().enumerate() {
                let v = &y[3 * node as usize..][..3];
                if v.iter().any(|x| *x != 0.0) {
                    out.push((k as u32, [v[0], v[1], v[2]]));
                }
            }
            out
        };
        let inertia = added_inertia + dot(&motion_of, &times_mass(&motion_of));
        let hub_inertia = added_inertia + dot(&held_motion, &times_mass(&held_motion));
        let pull = of_free(&times_mass(&held_place));
        let (mut held_mass, mut held_moment) = (0.0, Vec3::zeros());
        let everywhere: Vec<f64> = position.iter().flat_map(|x| [x.x, x.y, 1.0]).collect();
        let image = times_mass(&everywhere);
        for &node in &bore {
            let m = &image[3 * node as usize..][..3];
            held_moment += Vec3::new(m[0], m[1], 0.0);
            held_mass += m[2];
        }
        let grip = grip(&assembly, &place, free.len());
        Ok(Body {
            flanks: Flanks::new(flanks),
            position,
            assembly,
            free,
            place,
            mass,
            reduced,
            inertia,
            hub_inertia,
            added_inertia,
            pull,
            grip,
            held_mass,
            held_moment,
        })
    }

    /// `y = M x` over all nodes, three components each.
    pub fn apply_nodal_mass(&self, x: &[f64], y: &mut [f64]) {
        times_mass(&self.assembly, self.mass, x, y);
    }
}

/// `y = M x` over all nodes, three components each.
fn times_mass(assembly: &Assembly, mass: MassKind, x: &[f64], y: &mut [f64]) {
    match mass {
        MassKind::Consistent => assembly.mass.apply(x, y),
        MassKind::Lumped => {
            let ((x, _), (y, _)) = (x.as_chunks::<3>(), y.as_chunks_mut::<3>());
            for ((y, x), m) in y.iter_mut().zip(x).zip(&assembly.lumped) {
                *y = x.map(|x| m * x);
            }
        }
    }
}

/// [`Body::grip`].
fn grip(assembly: &Assembly, place: &[u32], free: usize) -> Vec<(u32, [f64; 9])> {
    let mut sums = vec![[0.0; 9]; free];
    let blocks = assembly.stiffness.entries();
    for (row, column, at) in assembly.stiffness.pattern().iter() {
        // Stored once: the block of (row, column), its transposed of (column, row).
        let (to, transposed) = match (place[row], place[column]) {
            (Tie::HELD, other) if other != Tie::HELD => (other, false),
            (other, Tie::HELD) if other != Tie::HELD => (other, true),
            _ => continue,
        };
        for (i, sum) in sums[to as usize].iter_mut().enumerate() {
            *sum += blocks[at][if transposed { 3 * (i % 3) + i / 3 } else { i }];
        }
    }
    (0..)
        .zip(sums)
        .filter(|(_, sum)| sum.iter().any(|x| *x != 0.0))
        .collect()
}
