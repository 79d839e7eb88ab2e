//! Pass 1: modes of a gear at its flank nodes and its hub, and the static compliance there.
//!
//! Two routes to the same data. [`of_sector`] takes one tooth of a gear whose teeth are all alike: modes by
//! cyclic symmetry, and at the flank node that is node `k` of tooth 0 turned by `t` pitches
//!
//! ```text
//! b = Re or Im ( c_k exp(2 pi i n t / z) ),     c_k = n_k . u_k
//! ```
//!
//! with the complex shape `u` of harmonic `n` and the normal `n_k` of tooth 0: normals turn with their tooth.
//! [`of_mesh`] takes any mesh: modes of the whole.
//!
//! A free gear has one mode of zero frequency, `e / sqrt(J)` with the rigid motion `e` and `J = e^T M e`; it is
//! checked and left out. All others have no momentum, `phi^T M e = 0`. A hub with out-of-plane freedom has as many
//! rigid modes as free directions (`rigid`).

mod cyclic;

use super::error::ReductionError;
use super::integrals::Moments;
use super::mounting::field;
use super::rigid::{self, ModeMotion, RigidMass};
use super::surface::Surface;
use super::{Basis, ModeSelection, Mounting, compliance, integrals, near_field};
use crate::assembly::tie::{MassKind, Tie};
use crate::assembly::{Assembly, assemble};
use crate::gear_mesh::GearMesh;
use crate::limits;
use crate::matrices::ForeignBody;
use crate::modes::cyclic::{Hub, Sector};
use crate::modes::{self, Options, Target};
use crate::vector::dot;
use cyclic::{cyclic_momentum, cyclic_shape};
use faer::prelude::Solve;
use faer::{Mat, MatRef};
use gearbench_models::Vec3;
use gearbench_models::gear::elastic::inertia::Integrals;
use gearbench_models::gear::elastic::reduced::{OutOfPlaneShapes, Residual};
use gearbench_models::stiffness::Material;
use std::sync::Arc;

/// Relative difference of squared frequencies below which modes form a family: rounding and the tolerance of the
/// search are smaller.
const EQUAL: f64 = 1e-7;

/// How far the lowest mode of a free gear may be from its rigid motion.
const RIGID: f64 = 1e-6;

impl ModeSelection {
    /// Returns the search target for these modes and `rigid` further ones, for a body with a number of `unknowns`.
    fn target(self, rigid: usize, unknowns: usize) -> Target {
        match self {
            ModeSelection::Count(n) => Target::Count((n + rigid).min(unknowns)),
            ModeSelection::UpTo(f) => Target::Above((std::f64::consts::TAU * f).powi(2)),
        }
    }
}

/// Stored result of one mode.
struct Shape {
    omega2: f64,
    /// Along the directions of all flank nodes.
    flanks: Vec<f64>,
    hub: f64,
    /// Inertia coupling `phi^T M e` over the nodes, without the inertia added at the hub.
    momentum: f64,
    /// `phi^T M e_x` and `phi^T M e_y`, likewise.
    linear: [f64; 2],
    /// Motion of hub and gear in the out-of-plane directions.
    moved: ModeMotion,
}

/// The rigid motions of the hub and foreign shapes over the coordinates of a tie: their span is that of the modes.
///
/// The hub moves as the bore of a shape does on average. Held modes and rigid motions are the basis of W. C. Hurty 1965
/// and of R. R. Craig, M. C. C. Bampton 1968.
fn span(shapes: MatRef<'_, f64>, tie: &Tie, mounting: &Mounting, nodes: &[Vec3]) -> Mat<f64> {
    let motions = mounting.motions();
    let fields: Vec<Vec<f64>> = motions.iter().map(|m| field(*m, nodes)).collect();
    let held: Vec<usize> = (0..nodes.len())
        .filter(|n| tie.place[*n] == Tie::HELD)
        .flat_map(|n| 3 * n..3 * n + 3)
        .collect();
    let count = motions.len();
    let sum = |a: &dyn Fn(usize) -> f64, b: &dyn Fn(usize) -> f64| -> f64 {
        held.iter().map(|i| a(*i) * b(*i)).sum()
    };
    let gram = Mat::from_fn(count, count, |p, q| {
        sum(&|i| fields[p][i], &|i| fields[q][i])
    });
    let right = Mat::from_fn(count, shapes.ncols(), |p, mode| {
        sum(&|i| fields[p][i], &|i| shapes[(i, mode)])
    });
    let hub = match count {
        0 => right,
        _ => gram.partial_piv_lu().solve(right),
    };
    let free = 3 * tie.free.len();
    Mat::from_fn(tie.coordinates(), count + shapes.ncols(), |row, column| {
        let node = |row: usize| 3 * tie.free[row / 3] as usize + row % 3;
        match (row < free, column < count) {
            (true, true) => fields[column][node(row)],
            (false, true) => f64::from(u8::from(row - free == column)),
            (true, false) => shapes[(node(row), column - count)],
            (false, false) => hub[(row - free, column - count)],
        }
    })
}

/// Modes of a gear by its whole mesh.
pub fn of_mesh(
    mesh: &GearMesh,
    material: &Material,
    mounting: &Mounting,
    wanted: ModeSelection,
    along_profile: bool,
    foreign: Option<&ForeignBody>,
) -> Result<Basis, ReductionError> {
    let nodes = Surface::new(mesh)?;
    let nodes = match along_profile {
        true => nodes.with_profile(),
        false => nodes,
    };
    compliance::check_whole(&nodes)?;
    check_shapes(&nodes, wanted, 3 * mesh.mesh.nodes.len())?;
    let own;
    let assembly = match foreign.and_then(|f| f.assembly.as_ref()) {
        Some(assembly) => assembly,
        None => {
            own = assemble(&mesh.mesh, material)?;
            &own
        }
    };
    let motions = mounting.motions();
    let tie = Tie::new(&mesh.mesh.nodes, &mesh.bore, &motions);
    let added = mounting.added_in_motions();
    let reduced = tie.reduce(assembly, &added, MassKind::Consistent);
    let rigid = mounting.rigid(&mesh.mesh.nodes);
    let mut pull = vec![0.0; rigid.len()];
    assembly.mass.apply(&rigid, &mut pull);
    let inertia = mounting.added_inertia + dot(&rigid, &pull);
    let residual = compliance::of_assembly(mesh, assembly, &nodes, mounting)?;
    let masses = nodal_masses(assembly);
    let mut unbalance = [0.0; 2];
    for (x, m) in mesh.mesh.nodes.iter().zip(&masses) {
        unbalance[0] += m * x.x;
        unbalance[1] += m * x.y;
    }
    let mass = &assembly.mass;

    let target = wanted.target(motions.len(), tie.coordinates());
    let found = match foreign.and_then(|f| f.shapes.as_ref()) {
        Some(shapes) => {
            let span = span(shapes.as_ref(), &tie, mounting, &mesh.mesh.nodes);
            modes::ritz(&reduced, span.as_ref(), target)?
        }
        None => modes::find(&reduced, target, &Options::default())?,
    };
    let skip = motions.len();
    let lateral = (mounting.is_lateral())
        .then(|| rigid::MeshRigidMotions::new(mounting, &mesh.mesh.nodes, mass));
    // A mode over the coordinates of the tie, and at all nodes.
    let expand = |mode: usize, full: &mut [f64]| -> Vec<f64> {
        let mut vector: Vec<f64> = found.vectors.col(mode).iter().copied().collect();
        tie.expand(&vector, full);
        if let Some(lateral) = lateral.as_ref().filter(|_| mode >= skip) {
            lateral.clean(&tie, &mut vector, full);
            tie.expand(&vector, full);
        }
        vector
    };
    let mut full = vec![0.0; rigid.len()];
    let shapes = (0..found.omega2.len())
        .map(|mode| {
            let vector = expand(mode, &mut full);
            let hub = &vector[3 * tie.free.len()..];
            let mut flanks = vec![0.0; nodes.directions.len()];
            nodes.along_directions(&full, &mut flanks);
            Shape {
                omega2: found.omega2[mode],
                flanks,
                hub: if mounting.free { hub[0] } else { 0.0 },
                momentum: dot(&full, &pull),
                linear: [0, 1].map(|axis| {
                    let along = masses.iter().zip(full[axis..].iter().step_by(3));
                    along.map(|(m, u)| m * u).sum()
                }),
                moved: (lateral.as_ref()).map_or_else(ModeMotion::default, |l| l.moved(&full, hub)),
            }
        })
        .collect();
    let integrals = if found.omega2.len() < skip {
        None
    } else {
        let of_mode = |mode: usize, u: &mut [f64]| {
            expand(skip + mode, u);
        };
        let modes = found.omega2.len() - skip;
        integrals::of_mesh(mass, &mesh.mesh.nodes, modes, of_mode)
    };
    let near_field = near_field::of_flanks(mesh, material, &nodes)?;
    let body = Body {
        inertia,
        unbalance,
        unknowns: tie.coordinates(),
        near_field,
        lateral: (mounting.is_lateral())
            .then(|| rigid::body(&Moments::of(mass, &mesh.mesh.nodes), mounting)),
    };
    finish(nodes, mounting, body, shapes, (residual, integrals))
}

/// Modes of a gear of equal teeth by the sector of tooth 0, with node sets `cut_low` and `cut_high`.
pub fn of_sector(
    sector: &GearMesh,
    material: &Material,
    mounting: &Mounting,
    wanted: ModeSelection,
    along_profile: bool,
) -> Result<Basis, ReductionError> {
    let nodes = Surface::of_sector(sector)?;
    let nodes = match along_profile {
        true => nodes.with_profile(),
        false => nodes,
    };
    compliance::check_sector(&nodes, sector.teeth as usize, 3 * sector.mesh.nodes.len())?;
    let unknowns = 3 * sector.teeth as usize * sector.mesh.nodes.len();
    check_shapes(&nodes, wanted, unknowns)?;
    let teeth = f64::from(sector.teeth);
    let rigid = mounting.rigid(&sector.mesh.nodes);
    let mut pull = vec![0.0; rigid.len()];
    let assembly = assemble(&sector.mesh, material)?;
    assembly.mass.apply(&rigid, &mut pull);
    let masses = nodal_masses(&assembly);
    let mass = assembly.mass;
    let inertia = mounting.added_inertia + teeth * dot(&rigid, &pull);
    let hub = Hub {
        motions: mounting.motions(),
        added_inertia: mounting.added_in_motions(),
    };
    let own = hub.motions.len();
    let search = Sector::new(&sector.as_sector(), material, &hub)?;
    let target = wanted.target(own, search.unknowns() * sector.teeth as usize);
    let mut found = search.find(target, &Options::default())?;
    let lateral = mounting.is_lateral().then(|| {
        let nodes = &sector.mesh.nodes;
        rigid::SectorRigidMotions::new(mounting, nodes, &sector.bore, &mass, sector.teeth)
    });
    if let Some(lateral) = &lateral {
        lateral.clean(&mut found);
    }
    let bore = sector.bore.first().copied().unwrap_or(0) as usize;
    let shapes = (0..found.modes.len())
        .map(|mode| Shape {
            linear: cyclic_momentum(&found, mode, &masses),
            moved: (lateral.as_ref()).map_or_else(ModeMotion::default, |l| l.moved(&found, mode)),
            ..cyclic_shape(&found, mode, &nodes, &rigid, &pull, bore)
        })
        .collect();
    let residual = compliance::of_sector(sector, material, &nodes, mounting)?;
    let integrals = integrals::of_sector(&mass, &sector.mesh.nodes, &found, own);
    let near_field = near_field::of_flanks(sector, material, &nodes)?;
    // Equal teeth are balanced.
    let body = Body {
        inertia,
        unbalance: [0.0; 2],
        unknowns: found.unknowns + own,
        near_field: near_field.map(|own| vec![own; sector.teeth as usize].concat()),
        lateral: (mounting.is_lateral()).then(|| {
            let sector = Moments::of(&mass, &sector.mesh.nodes);
            rigid::round(rigid::body(&sector.repeated(found.sectors), mounting))
        }),
    };
    finish(nodes, mounting, body, shapes, (residual, integrals))
}

/// Memory of a number of a mode shape at the flank nodes: during the search, in the basis, and in a model [bytes].
const SHAPE_BYTES: f64 = 24.0;

/// Checks the memory of the shapes at the flank nodes of all teeth before modes are searched.
fn check_shapes(
    surface: &Surface,
    wanted: ModeSelection,
    unknowns: usize,
) -> Result<(), ReductionError> {
    let ModeSelection::Count(modes) = wanted else {
        return Ok(());
    };
    // There are no more modes than unknowns.
    let modes = modes.min(unknowns);
    let rows = surface.directions.len();
    let what = format!("{modes} modes at {rows} displacements of flank nodes");
    let bytes = SHAPE_BYTES * rows as f64 * modes as f64;
    let way_out = "ask for fewer modes, or use fewer elements along the flank or over the width";
    Ok(limits::check(what, bytes, way_out)?)
}

/// Data of a gear that do not depend on its modes.
struct Body {
    inertia: f64,
    unbalance: [f64; 2],
    unknowns: usize,
    near_field: Option<Vec<Vec<f64>>>,
    /// Data of a hub with out-of-plane freedom, without modes.
    lateral: Option<OutOfPlaneShapes>,
}

/// Computes `M e_x`, one entry per node: the mass matrix is equal along all axes.
fn nodal_masses(assembly: &Assembly) -> Vec<f64> {
    let n = assembly.lumped.len();
    let mut image = vec![0.0; 3 * n];
    assembly.mass.apply(&vec![1.0; 3 * n], &mut image);
    image.iter().step_by(3).copied().collect()
}

/// Takes out the rigid modes of a hub that is free in several directions, and keeps how the others move it.
fn take_rigid(
    body: &mut OutOfPlaneShapes,
    mounting: &Mounting,
    shapes: &mut Vec<Shape>,
) -> Result<(), ReductionError> {
    let count = mounting.directions().count();
    let mass = RigidMass::of(body, mounting);
    let shares = shapes.iter().map(|s| mass.share(&s.moved.momentum));
    let shares = shares.chain(std::iter::repeat(0.0)).take(count);
    let share = shares.fold(1.0_f64, |least, s| {
        if (s - 1.0).abs() > (least - 1.0).abs() {
            s
        } else {
            least
        }
    });
    if (share - 1.0).abs() > RIGID {
        return Err(ReductionError::NotRigid { share });
    }
    shapes.drain(..count);
    for s in shapes.iter_mut() {
        // The mass at the hub moves with it.
        for (p, h) in s.linear.iter_mut().zip(s.moved.hub) {
            *p += mounting.added_mass * h;
        }
        s.moved.hub[mounting.own()] = 0.0;
    }
    body.hub = shapes.iter().map(|s| s.moved.hub).collect();
    Ok(())
}

/// Takes out the rigid mode, finds families, and lays the shapes out node by node.
fn finish(
    nodes: Surface,
    mounting: &Mounting,
    body: Body,
    mut shapes: Vec<Shape>,
    (compliance, integrals): (Residual, Option<Integrals>),
) -> Result<Basis, ReductionError> {
    let Body {
        inertia,
        unbalance,
        unknowns,
        near_field,
        mut lateral,
    } = body;
    if let Some(body) = &mut lateral {
        take_rigid(body, mounting, &mut shapes)?;
    } else if mounting.free {
        let share = shapes.first().map_or(0.0, |s| {
            (s.momentum + mounting.added_inertia * s.hub).powi(2) / inertia
        });
        if (share - 1.0).abs() > RIGID {
            return Err(ReductionError::NotRigid { share });
        }
        shapes.remove(0);
    }
    let count = shapes.len();
    let mut family: Vec<u32> = Vec::with_capacity(count);
    for (i, s) in shapes.iter().enumerate() {
        let number = match family.last() {
            None => 0,
            Some(last) => {
                let equal = s.omega2 - shapes[i - 1].omega2 <= EQUAL * s.omega2;
                last + u32::from(!equal)
            }
        };
        family.push(number);
    }
    let mut along = vec![0.0; nodes.directions.len() * count];
    for (mode, s) in shapes.iter().enumerate() {
        for (node, b) in s.flanks.iter().enumerate() {
            along[node * count + mode] = *b;
        }
    }
    let of = |f: fn(&Shape) -> f64| shapes.iter().map(f).collect::<Vec<_>>();
    Ok(Basis {
        normals: nodes.normals().copied().collect(),
        along_profile: nodes.along_profile,
        flanks: nodes.flanks,
        free: mounting.free,
        inertia,
        added_inertia: mounting.added_inertia,
        unknowns,
        omega: of(|s| s.omega2.max(0.0).sqrt()),
        family,
        shapes: along,
        hub: if mounting.free {
            of(|s| s.hub)
        } else {
            vec![0.0; count]
        },
        participation: if mounting.free {
            vec![0.0; count]
        } else {
            of(|s| s.momentum)
        },
        momentum: shapes.iter().map(|s| s.linear).collect(),
        unbalance,
        compliance,
        near_field: near_field.map(Arc::new),
        integrals: integrals.map(Arc::new),
        added: match lateral {
            Some(_) => [mounting.added_mass, mounting.added_tilting],
            None => [0.0; 2],
        },
        lateral: lateral.map(Arc::new),
    })
}

#[cfg(test)]
mod tests;
