//! Sparse stiffness and mass of a whole mesh, and the rigid tie of its bore to the hub.
//!
//! Coordinates of the whole mesh are `3 node + axis`. The stiffness is kept in 3x3 blocks, the mass as one
//! scalar per pair of nodes (times the unit matrix of three axes), both symmetric with the upper part stored.
//!
//! | part | owns |
//! |---|---|
//! | [`assemble`], `blocks` | the matrices and their products |
//! | [`tie`] | the bore that moves with the hub, reduced matrices |

mod blocks;
pub mod tie;

#[cfg(test)]
mod tests;

use crate::Material;
use crate::element::{ElementError, Integrator};
use crate::limits;
use crate::mesh::Mesh;
pub use blocks::{BlockMatrix, NodalMatrix, Pattern, ScalarMatrix};
use std::sync::Arc;

/// Stiffness and mass over all nodes of a mesh.
#[derive(Clone, Debug)]
pub struct Assembly {
    /// Stiffness matrix [N/m].
    pub stiffness: BlockMatrix,
    /// Consistent mass [kg], times the unit matrix of three axes.
    pub mass: ScalarMatrix,
    /// Lumped mass per node [kg]: row sums for linear elements, the scaled diagonal (E. Hinton, T. Rock,
    /// O. C. Zienkiewicz, *Earthquake Eng. Struct. Dyn.* 4 (1976) 245) for quadratic ones.
    pub lumped: Vec<f64>,
}

/// Memory of a node in stiffness and mass, assembled and reduced, with up to 27 neighbours [bytes].
const NODE_BYTES: f64 = 5e3;

/// Assembles the matrices of a mesh.
///
/// # Panics
/// If an element names a node that the mesh does not have.
pub fn assemble(mesh: &Mesh, material: &Material) -> Result<Assembly, ElementError> {
    let nodes = mesh.nodes.len();
    let what = format!("the matrices of {} unknowns", 3 * nodes);
    limits::check(what, NODE_BYTES * nodes as f64, "use fewer elements")?;
    let pattern = Arc::new(Pattern::of(mesh));
    let mut stiffness = BlockMatrix::zeros(pattern.clone());
    let mut mass = ScalarMatrix::zeros(pattern);
    let mut lumped = vec![0.0; mesh.nodes.len()];
    let mut before = 0;
    for block in &mesh.blocks {
        let n = block.kind.nodes();
        let integrator = Integrator::new(block.kind);
        let (mut k, mut m) = (vec![0.0; 9 * n * n], vec![0.0; n * n]);
        let mut x = Vec::with_capacity(n);
        for (e, nodes) in block.elements().enumerate() {
            x.clear();
            x.extend(nodes.iter().map(|&node| mesh.nodes[node as usize]));
            integrator.matrices(before + e, &x, material, &mut k, &mut m)?;
            stiffness.add(nodes, &k);
            mass.add(nodes, &m);
            if block.kind.is_quadratic() {
                let total: f64 = m.iter().sum();
                let trace: f64 = (0..n).map(|a| m[a * n + a]).sum();
                for (a, &node) in nodes.iter().enumerate() {
                    lumped[node as usize] += m[a * n + a] * total / trace;
                }
            } else {
                for (a, &node) in nodes.iter().enumerate() {
                    lumped[node as usize] += m[a * n..][..n].iter().sum::<f64>();
                }
            }
        }
        before += block.element_count();
    }
    Ok(Assembly {
        stiffness,
        mass,
        lumped,
    })
}
