//! Data of a full-order gear: its mesh in the assembled position, stiffness, mass, and the inertia that couples its
//! nodes to the hub. All of them are constant in time.

use super::tied_nodes::{self, TiedNodes};
use crate::assembly::tie::{HubMotion, MassKind, Reduced, Tie};
use crate::assembly::{Assembly, assemble};
use crate::element::ElementError;
use crate::gear_mesh::GearMesh;
use crate::limits;
use crate::mesh::vtu;
use crate::vector::dot;
use gearbench_models::Vec3;
use gearbench_models::geometry::Flanks;
use gearbench_models::geometry::swept::Cells;
use gearbench_models::kinematics::{Hub, Placement};
use gearbench_models::spec::Mount;
use gearbench_models::stiffness::Material;
use std::sync::Arc;

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
    /// Elements of the mesh, for figures.
    pub cells: Arc<Cells>,
    /// Kind of the mass matrix.
    pub mass: MassKind,
    /// Stiffness and mass over the coordinates in the frame: `3 free`, then the hub's if it is free.
    pub reduced: Reduced,
    /// Inertia [kg m^2] or mass [kg] of the whole gear, including that added at the hub.
    pub inertia: f64,
    /// Inertia of the hub coordinate: that of the fixed nodes and that added.
    pub hub_inertia: f64,
    /// Inertia added at the hub.
    pub added_inertia: f64,
    /// Products of nodal masses and positions of nodes tied to the hub, `M_fb X_b`, per affected entry of `free` [kg
    /// m].
    pub pull: Vec<(u32, [f64; 3])>,
    /// Stiffness between tied and free nodes, summed over the tied ones, row by row, per affected entry of `free`: the
    /// force of the elements on the hub is that of these nodes alone [N/m].
    pub grip: Vec<(u32, [f64; 9])>,
    /// Mass of the nodes tied to the hub, including the coupling, as if their neighbours moved rigidly [kg].
    pub held_mass: f64,
    /// First moment of that mass [kg m].
    pub held_moment: Vec3,
    /// Coupling of the tied nodes, where the hub moves in several directions or about a tilted axis: the matrices are
    /// then those of the free nodes alone.
    pub held: Option<TiedNodes>,
    /// Mass [kg] and inertia about the hub axes [kg m^2] added at such a hub.
    pub added: (f64, Vec3),
}

/// Mass and inertia added at a hub with several directions.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AddedInertia {
    /// In its own motion [kg m^2], of a rack [kg].
    pub own: f64,
    /// Added mass [kg].
    pub mass: f64,
    /// Added inertia about each axis except that of the own motion [kg m^2].
    pub tilting: f64,
}

/// Memory of a gear of `n` unknowns, `FACTORED n^(4/3)`: the fill of nested dissection in three dimensions (George
/// 1973), including the matrices; measured from 64,000 to 213,000 unknowns [bytes].
const FACTORED: f64 = 163.0;

/// Memory of an unknown of a gear with lumped mass, which is never factorised: stiffness, mass and the reduced matrices;
/// measured from 41,000 to 183,000 unknowns [bytes].
const LUMPED: f64 = 2.1e3;

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
        let slide = placement.slides.then_some(placement.hub.axes[0]);
        let pose = placement.pose(0.0);
        let moves = matches!(mount, Mount::Revolute | Mount::Prismatic);
        let motion = slide.map_or(HubMotion::Turn, HubMotion::Slide);
        let motions = if moves { vec![motion] } else { Vec::new() };
        let (body, _) = Self::placed(
            mesh,
            material,
            |x| pose.point(x) - placement.hub.origin,
            (motion, &motions),
            matches!(mount, Mount::Driven(_)),
            (mass, added_inertia),
        )?;
        Ok(body)
    }

    /// Builds a body on a hub that moves in several directions, or about a tilted axis.
    pub fn floating(
        mesh: GearMesh,
        material: &Material,
        placement: &Placement,
        hub: &Hub,
        mass: MassKind,
        added: AddedInertia,
    ) -> Result<Body, ElementError> {
        let axes = &hub.axes;
        let pose = placement.pose(0.0);
        let place = |x: &Vec3| pose.point(x) - placement.hub.origin;
        let (motion, about) = match hub.slide {
            None => (HubMotion::TurnAbout(axes[2]), added.own),
            Some(slide) => (HubMotion::Slide(slide), added.tilting),
        };
        let (mut body, image_of_held) = Self::placed(
            mesh,
            material,
            place,
            (motion, &tied_nodes::motions()),
            hub.is_driven(),
            (mass, added.own),
        )?;
        let at_hub = (added.mass, Vec3::new(added.tilting, added.tilting, about));
        let (reduced, held) = TiedNodes::split(&body.reduced, image_of_held, axes, at_hub);
        (body.reduced, body.held, body.added) = (reduced, Some(held), at_hub);
        Ok(body)
    }

    /// A mesh whose nodes are brought to their places from the hub's centre; of the held nodes also what couples them to each
    /// free one by their mass: `M_fb 1` and `M_fb X_b`.
    #[expect(
        clippy::type_complexity,
        reason = "both parts of one sum over the mass matrix"
    )]
    fn placed(
        mesh: GearMesh,
        material: &Material,
        to_place: impl Fn(&Vec3) -> Vec3,
        (motion, motions): (HubMotion, &[HubMotion]),
        driven: bool,
        (mass, added_inertia): (MassKind, f64),
    ) -> Result<(Body, Vec<(u32, f64, Vec3)>), ElementError> {
        let GearMesh {
            mut mesh,
            bore,
            flanks,
            ..
        } = mesh;
        for x in &mut mesh.nodes {
            *x = to_place(x);
        }
        // Each gear is counted twice, for its mate, which is not known here.
        let unknowns = 3 * mesh.nodes.len();
        let n = unknowns as f64;
        let (with, bytes, way_out) = match mass {
            MassKind::Consistent => (
                "factors",
                FACTORED * n.powf(4.0 / 3.0),
                "use fewer elements, or mass = \"lumped\" under an explicit method",
            ),
            MassKind::Lumped => ("matrices", LUMPED * n, "use fewer elements"),
        };
        let what = format!("two gears of {unknowns} unknowns with their {with}");
        limits::check(what, 2.0 * bytes, way_out)?;
        let cells = Arc::new(vtu::cells(&mesh));
        let mut assembly = assemble(&mesh, material)?;
        let position = mesh.nodes;
        let tie = Tie::new(&position, &bore, motions);
        let (free, place) = (tie.free.clone(), tie.place.clone());
        if driven {
            assembly.mass.decouple(|node| place[node] == Tie::HELD);
        }
        // With several directions of motion the added inertia is a matrix.
        let added: Vec<f64> = match motions {
            [_] => vec![added_inertia],
            all => vec![0.0; all.len()],
        };
        let reduced = tie.reduce(&assembly, &added, mass);

        let unit = |node: usize| -> [f64; 3] { motion.of(&position[node]).into() };
        let turns = !matches!(motion, HubMotion::Slide(_));
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
            if turns {
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
        let of_held = if motions.len() > 1 {
            held_masses(&bore, &position, &free, times_mass)
        } else {
            Vec::new()
        };
        if motions.len() > 1 {
            let image = times_mass(
                &position
                    .iter()
                    .flat_map(|x| [x.x, x.y, x.z])
                    .collect::<Vec<_>>(),
            );
            held_moment = (bore.iter())
                .map(|n| Vec3::from_column_slice(&image[3 * *n as usize..][..3]))
                .sum();
        }
        let grip = grip(&assembly, &place, free.len());
        let body = Body {
            flanks: Flanks::new(flanks),
            cells,
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
            held: None,
            added: (0.0, Vec3::zeros()),
        };
        Ok((body, of_held))
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

/// `M_fb 1` and `M_fb X_b` per place among the free nodes that has any.
fn held_masses(
    bore: &[u32],
    position: &[Vec3],
    free: &[u32],
    times_mass: impl Fn(&[f64]) -> Vec<f64>,
) -> Vec<(u32, f64, Vec3)> {
    let (mut ones, mut places) = (vec![0.0; 3 * position.len()], vec![0.0; 3 * position.len()]);
    for &node in bore {
        let node = node as usize;
        ones[3 * node] = 1.0;
        places[3 * node..][..3].copy_from_slice(position[node].as_slice());
    }
    let (ones, places) = (times_mass(&ones), times_mass(&places));
    let of = |(k, &node): (u32, &u32)| {
        let at = 3 * node as usize;
        let moment = Vec3::from_column_slice(&places[at..][..3]);
        (ones[at] != 0.0 || moment != Vec3::zeros()).then_some((k, ones[at], moment))
    };
    (0..).zip(free).filter_map(of).collect()
}

/// Computes [`Body::grip`].
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
