//! Static compliance of a whole gear between its flank nodes and its hub.
//!
//! Let `K_c` be the stiffness with the hub held, `c_k` the outward normal at flank node `k`, `e` the rigid motion of
//! the hub that the mount leaves free and `J = e^T M e`. Loads on a free body are balanced by the inertia of its
//! rigid motion, `P = I - M e e^T / J` (inertia relief; M. Geradin, D. J. Rixen, *Mechanical Vibrations*, 3rd ed.
//! 2015, section 2.8), and
//!
//! ```text
//! A = C^T P^T K_c^-1 P C:     A_kl = X_kl - (g_k a_l + a_k g_l) / J + a_k a_l gamma / J^2
//! X = C^T K_c^-1 C,   a_k = e^T c_k,   g_k = c_k^T K_c^-1 M e,   gamma = (M e)^T K_c^-1 M e
//! ```
//!
//! so the hub held serves every mount and every inertia added at the hub. Unit torque at the hub is one more column
//! with `X = g = 0` and `a = 1`. `A` does not depend on the support: rigid motion neither enters nor leaves it.
//!
//! A hub that is free in several directions has as many motions `e_p`: with the matrix `J_pq = e_p^T M e_q` and what is added,
//! vectors `a_k`, `g_k` and the matrix `Gamma` over them,
//!
//! ```text
//! A_kl = X_kl + b_k^T (Gamma b_l - g_l) - g_k^T b_l,   b_k = J^-1 a_k
//! ```
//!
//! **What the mesh does not resolve.** A line load `p` flattens a half space by the logarithm of the length it is
//! spread over (H. Hertz 1881; K. L. Johnson, *Contact Mechanics*, 1985, section 4.2), elements of length `h` spread it
//! over about `h`: the compliance of a row of nodes grows by `2 (1 - nu^2) ln 2 / (pi E)` each time `h` is halved, 5 %
//! of a pair of gears of module 4.5 mm from 12 to 24 elements on the flank, down to the half width of contact, about
//! 0.2 mm there. Between two rows it is 8 % less than on one. A Hertz law that leaves out what the mesh has would
//! have to add the difference: to the load of the whole line, for a logarithm does not add up over points, and more
//! between rows than on them, which no law of single points can do, and which their own share would rather turn
//! round. So there is none; finer flanks are what takes the error away.
//!
//! | route | for |
//! |---|---|
//! | [`of_assembly`] | any mesh: one factorisation, all flank nodes as right-hand sides |
//! | [`of_sector`] | gears made of copies of a sector: forces on one tooth, one small problem per harmonic |

mod relief;

use super::error::ReductionError;
use super::mounting::{Mounting, field};
use super::rigid::{self, CyclicMotion};
use super::surface::Surface;
use super::truncation::{symmetrise, symmetrise_blocks};
use crate::assembly::Assembly;
use crate::assembly::tie::{HubMotion, MassKind, Tie};
use crate::gear_mesh::GearMesh;
use crate::limits;
use crate::modes::cyclic::{Column, Hub, Sector};
use crate::solve::{Cholesky, SolveMemory};
use crate::vector::dot;
use faer::{Mat, Par, c64};
use gearbench_models::Vec3;
use gearbench_models::gear::elastic::reduced::{FlankCompliance, Residual};
use gearbench_models::stiffness::Material;
use rayon::prelude::*;
use relief::FixedHubCompliance;
use std::sync::{Mutex, PoisonError};

/// Right-hand sides at a time.
const BLOCK: usize = 48;

/// Compliance of a whole mesh between all its flank nodes and towards the hub.
pub fn of_assembly(
    gear: &GearMesh,
    assembly: &Assembly,
    surface: &Surface,
    mounting: &Mounting,
) -> Result<Residual, ReductionError> {
    Ok(held_of_assembly(gear, assembly, surface, mounting)?.mounted(mounting))
}

fn held_of_assembly(
    gear: &GearMesh,
    assembly: &Assembly,
    surface: &Surface,
    mounting: &Mounting,
) -> Result<FixedHubCompliance, ReductionError> {
    let nodes = &gear.mesh.nodes;
    let n = surface.directions.len();
    check_whole(surface)?;
    let tie = Tie::new(nodes, &gear.bore, &[]);
    let columns = loads(surface, &tie)?;
    let stiffness = tie.reduce(assembly, &[], MassKind::Consistent).stiffness;
    let factor = Cholesky::new(stiffness.as_ref())?;
    drop(stiffness);

    // Blocks share the memory of as many as are solved at a time.
    let pool: Mutex<Vec<(Mat<f64>, SolveMemory)>> = Mutex::new(Vec::new());
    let kept = || pool.lock().unwrap_or_else(PoisonError::into_inner);
    let solve = |block: &[Load]| {
        let taken = kept().pop();
        let (mut whole, mut memory) = taken.unwrap_or_else(|| {
            let x = Mat::zeros(factor.unknowns(), BLOCK);
            (x, SolveMemory::default())
        });
        let mut x = whole.as_mut().subcols_mut(0, block.len());
        x.fill(0.0);
        for (j, load) in block.iter().enumerate() {
            for (place, force) in load {
                for axis in 0..3 {
                    x[(3 * place + axis, j)] = force[axis];
                }
            }
        }
        factor.solve_many_in(x.as_mut(), Par::Seq, &mut memory);
        let mut rows = vec![0.0; block.len() * n];
        for (j, row) in rows.chunks_exact_mut(n).enumerate() {
            let x = x.as_ref().col(j);
            for (c, load) in row.iter_mut().zip(&columns) {
                *c = work(load, |i| x[i]);
            }
        }
        kept().push((whole, memory));
        rows
    };
    let solved: Vec<Vec<f64>> = columns.par_chunks(BLOCK).map(solve).collect();
    let mut compliance = solved.concat();
    symmetrise(&mut compliance, n);

    let motions = relieved(mounting);
    let n = motions.len();
    let fields: Vec<Vec<f64>> = motions.iter().map(|m| field(*m, nodes)).collect();
    let mut inertia = vec![0.0; n * n];
    let mut response = Mat::zeros(tie.coordinates(), n);
    let mut pulls = vec![vec![0.0; tie.coordinates()]; n];
    let mut image = vec![0.0; 3 * nodes.len()];
    for (q, unit) in fields.iter().enumerate() {
        assembly.mass.apply(unit, &mut image);
        for (p, unit) in fields.iter().enumerate() {
            inertia[p * n + q] = dot(unit, &image);
        }
        tie.gather(&image, &mut pulls[q]);
        for (i, f) in pulls[q].iter().enumerate() {
            response[(i, q)] = *f;
        }
    }
    factor.solve_many(response.as_mut(), Par::Seq);
    let along =
        |load: &Load| -> Vec<f64> { (0..n).map(|q| work(load, |i| response[(i, q)])).collect() };
    let of_pulls = |(p, q): (usize, usize)| -> f64 {
        let u = response.col(q).iter();
        pulls[p].iter().zip(u).map(|(a, b)| a * b).sum()
    };
    Ok(FixedHubCompliance {
        flanks: FlankCompliance::Full(compliance),
        motions: n,
        arms: arms(surface, &motions),
        inertial: columns.iter().flat_map(along).collect(),
        hub: (0..n * n).map(|i| of_pulls((i / n, i % n))).collect(),
        inertia,
    })
}

/// Returns the free motions of a hub, or the fixed motion of a fixed one.
fn relieved(mounting: &Mounting) -> Vec<HubMotion> {
    let motions = mounting.motions();
    match motions.is_empty() {
        true => vec![mounting.motion],
        false => motions,
    }
}

/// Computes the compliance of a whole gear from one sector of it; `surface` is that of [`Surface::of_sector`].
pub fn of_sector(
    sector: &GearMesh,
    material: &Material,
    surface: &Surface,
    mounting: &Mounting,
) -> Result<Residual, ReductionError> {
    Ok(held_of_sector(sector, material, surface, mounting)?.mounted(mounting))
}

/// Computes the compliance with fixed hub.
///
/// With the forces on tooth 0 alone the load of every harmonic is that tooth's, and the teeth respond by the inverse
/// transform, in the frame turned with each:
///
/// ```text
/// X_d = 1/z sum_n exp(i d mu_n) C^T K_n^-1 C,   mu_n = 2 pi n / z
/// ```
fn held_of_sector(
    sector: &GearMesh,
    material: &Material,
    surface: &Surface,
    mounting: &Mounting,
) -> Result<FixedHubCompliance, ReductionError> {
    let teeth = sector.teeth as usize;
    if surface.nodes() == 0 || !surface.nodes().is_multiple_of(teeth.max(1)) {
        return Err(ReductionError::Mismatch(format!(
            "{} flank nodes of {teeth} teeth that are alike: take the surface of the sector, repeated",
            surface.nodes()
        )));
    }
    if mounting.motion != HubMotion::Turn {
        return Err(ReductionError::Mismatch(
            "a gear made of copies of a sector turns about z: a rack needs its whole mesh".into(),
        ));
    }
    let cyclic = Sector::new(&sector.as_sector(), material, &Hub::fixed())?;
    let per_tooth = surface.directions.len() / teeth;
    check_sector(surface, teeth, cyclic.unknowns())?;
    let columns = columns(surface, per_tooth, |node| cyclic.place_of(node))?;
    let found = cyclic.static_responses(&columns)?;
    let relief = relief_of_sector(&cyclic, sector, &columns, mounting)?;
    let m = per_tooth;
    let mut blocks = vec![0.0; teeth * m * m];
    for (n, g) in found.compliance.iter().enumerate() {
        let weight = if n == 0 || 2 * n == teeth { 1.0 } else { 2.0 } / teeth as f64;
        for (d, block) in blocks.chunks_exact_mut(m * m).enumerate() {
            let turns = (d * n) % teeth;
            let (sin, cos) = (std::f64::consts::TAU * turns as f64 / teeth as f64).sin_cos();
            for (c, g) in block.iter_mut().zip(g) {
                *c += weight * (cos * g.re - sin * g.im);
            }
        }
    }
    symmetrise_blocks(&mut blocks, teeth, m);
    Ok(FixedHubCompliance {
        flanks: FlankCompliance::Cyclic {
            teeth,
            per_tooth,
            blocks,
        },
        arms: arms(surface, &relieved(mounting)),
        ..relief
    })
}

/// Computes the data of inertia relief for a gear of equal sectors: each motion has a harmonic of its own.
fn relief_of_sector(
    cyclic: &Sector,
    sector: &GearMesh,
    columns: &[Column],
    mounting: &Mounting,
) -> Result<FixedHubCompliance, ReductionError> {
    let (teeth, m) = (sector.teeth as usize, columns.len());
    let directions: Vec<usize> = mounting.directions().collect();
    let directions = match directions.is_empty() {
        true => vec![mounting.own()],
        false => directions,
    };
    let place = |d: usize| directions.iter().position(|own| *own == d).unwrap_or(0);
    let n = directions.len();
    let all = directions.iter().copied();
    let motions = rigid::cyclic_motions(mounting, all, &sector.mesh.nodes, sector.teeth);
    let mut inertial = vec![0.0; teeth * m * n];
    let (mut hub, mut inertia) = (vec![0.0; n * n], vec![0.0; n * n]);
    for harmonic in [0, 1] {
        let own: Vec<&CyclicMotion> = motions.iter().filter(|m| m.harmonic == harmonic).collect();
        if own.is_empty() {
            continue;
        }
        let fields: Vec<&[c64]> = own.iter().map(|m| m.field.as_slice()).collect();
        let found = cyclic.inertial_responses(harmonic, columns, &fields)?;
        for (p, motion) in own.iter().enumerate() {
            let [a, b] = motion.directions.map(place);
            for tooth in 0..teeth {
                // Re(w exp(i t mu)) by the real part of the motion, Im of it by the imaginary one.
                let turns = std::f64::consts::TAU * tooth as f64 / teeth as f64;
                let (sin, cos) = (f64::from(harmonic) * turns).sin_cos();
                for k in 0..m {
                    let w = found.inertial[k * own.len() + p];
                    let row = &mut inertial[(tooth * m + k) * n..][..n];
                    if harmonic == 0 {
                        row[a] = w.re;
                    } else {
                        row[a] = w.re * cos - w.im * sin;
                        row[b] = w.re * sin + w.im * cos;
                    }
                }
            }
            for (q, with) in own.iter().enumerate() {
                let [c, d] = with.directions.map(place);
                for (out, of) in [(&mut hub, &found.hub), (&mut inertia, &found.inertia)] {
                    let h = of[p * own.len() + q];
                    if harmonic == 0 {
                        out[a * n + c] = h.re * teeth as f64;
                        continue;
                    }
                    let h = 0.5 * teeth as f64 * h;
                    (out[a * n + c], out[b * n + d]) = (h.re, h.re);
                    (out[a * n + d], out[b * n + c]) = (h.im, -h.im);
                }
            }
        }
    }
    Ok(FixedHubCompliance {
        flanks: FlankCompliance::Full(Vec::new()),
        motions: n,
        arms: Vec::new(),
        inertial,
        hub,
        inertia,
    })
}

/// Checks the memory of the compliance of a whole mesh, before anything of it is computed.
///
/// # Errors
/// An estimate beyond the limit.
pub(super) fn check_whole(surface: &Surface) -> Result<(), ReductionError> {
    let n = surface.directions.len();
    check_memory(n, 24.0 * (n as f64).powi(2))
}

/// Checks the memory of the compliance of a gear of equal teeth, before anything of it is computed; `surface` is that of all
/// teeth.
///
/// # Errors
/// An estimate beyond the limit.
pub(super) fn check_sector(
    surface: &Surface,
    teeth: usize,
    unknowns: usize,
) -> Result<(), ReductionError> {
    let per_tooth = surface.directions.len() / teeth.max(1);
    let m = per_tooth as f64;
    let bytes = 24.0 * m * m * teeth as f64 + 64.0 * m * unknowns as f64;
    check_memory(per_tooth, bytes)
}

/// Checks the memory of a compliance [bytes] before it is computed.
fn check_memory(flank_nodes: usize, bytes: f64) -> Result<(), ReductionError> {
    let what = format!("the compliance between {flank_nodes} flank nodes");
    Ok(limits::check(
        what,
        bytes,
        "use fewer elements along the flank or over the width",
    )?)
}

/// `a_k = e^T c_k`: how far each unit motion moves each flank node outwards, a row per node.
fn arms(surface: &Surface, motions: &[HubMotion]) -> Vec<f64> {
    let positions = surface.positions();
    (positions.iter().zip(&surface.directions))
        .flat_map(|(x, n)| motions.iter().map(move |m| m.of(x).dot(n)))
        .collect()
}

/// Forces at places among the free nodes, each place once.
type Load = Vec<(usize, Vec3)>;

/// The work of a load on displacements of the free nodes.
fn work(load: &Load, u: impl Fn(usize) -> f64) -> f64 {
    let of = |(place, force): &(usize, Vec3)| -> f64 {
        (0..3).map(|axis| force[axis] * u(3 * place + axis)).sum()
    };
    load.iter().map(of).sum()
}

/// Returns the nodal loads of a unit force along each direction, without the part on nodes tied to the hub.
fn loads(surface: &Surface, tie: &Tie) -> Result<Vec<Load>, ReductionError> {
    let place = |node: u32| {
        let place = tie.place.get(node as usize).copied();
        place.filter(|p| *p != Tie::HELD).map(|p| p as usize)
    };
    if surface.is_of_nodes() {
        let columns = columns(surface, surface.directions.len(), place)?;
        return Ok(columns.into_iter().map(|c| vec![c]).collect());
    }
    let load = |(k, direction): (usize, &Vec3)| {
        let follows = surface.follows(k);
        follows
            .filter_map(|(node, weight)| Some((place(node)?, weight * direction)))
            .collect()
    };
    Ok(surface.directions.iter().enumerate().map(load).collect())
}

/// Returns the indices among the free nodes and the directions of the first `count` columns.
fn columns(
    surface: &Surface,
    count: usize,
    place: impl Fn(u32) -> Option<usize>,
) -> Result<Vec<(usize, Vec3)>, ReductionError> {
    (surface.mesh_nodes.iter().zip(&surface.directions).take(count))
        .map(|(&node, normal)| match place(node) {
            Some(place) => Ok((place, *normal)),
            None => Err(ReductionError::Mismatch(format!(
                "flank node {node} is not free to move: the surface belongs to another mesh, or reaches a cut of the sector"
            ))),
        })
        .collect()
}

#[cfg(test)]
mod tests;
