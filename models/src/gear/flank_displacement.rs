//! The flank displacement operator: how far flank nodes stand outward of the rigid flank, for contacts of nodes.

use gearbench_integrators::system::At;
use std::sync::Arc;

/// Outward displacements of flank nodes, linear in the gear's coordinates and in the forces on the nodes:
/// `a = B q - R F + r T`. Nodes are those of the gear's [`Flanks`](crate::geometry::Flanks), `F`
/// presses into the tooth, `T` is the load on the hub.
///
/// Where friction loads the flanks, [`along_profile`](FlankDisplacement::along_profile) gives each node a second number,
/// by which all of these functions know it along the profile: displacements, and forces against them, alike.
///
/// With constant `B` and `R` the contact forces derive from one potential of `q`, whatever nodes touch.
pub trait FlankDisplacement {
    /// `out_k = sum_i b_ki x_i` with the gear's coordinates, or velocities, `x`.
    fn displacements(&self, x: &[f64], nodes: &[u32], out: &mut [f64]);

    /// `f_i -= sum_k b_ki F_k`.
    fn apply_nodal_forces(&self, nodes: &[u32], forces: &[f64], f: &mut [f64]);

    /// `out_kl += sum_i b_ki b_li w_i`: how velocities of nodes answer to forces on them, with weights of the gear's
    /// coordinates (times over masses), `out[k * n + l]`.
    fn add_mobility(&self, weights: &[f64], nodes: &[u32], out: &mut [f64]);

    /// What is added to a node's number for its displacement along the profile, counted along the transverse part of its
    /// outward normal turned by 90 degrees counter-clockwise; `None` where that is not known: the flanks then move along
    /// their profile with the hub alone.
    fn along_profile(&self) -> Option<u32> {
        None
    }

    /// Displacement of the [lines](crate::gear::elastic::lines) of each flank by line loads; `None` where nodes are not
    /// lines.
    fn near_field(&self) -> Option<&Arc<Vec<Vec<f64>>>> {
        None
    }

    /// True when there is a residual compliance.
    fn is_compliant(&self) -> bool;

    /// Residual compliance `R_kl` between nodes [m/N], `out[k * n + l]`; zeros where there is none.
    fn compliance(&self, nodes: &[u32], out: &mut [f64]);

    /// Displacement `r_k` by unit load on the hub.
    fn hub_compliance(&self, nodes: &[u32], out: &mut [f64]);

    /// Largest displacement of a flank node by unit load on the hub.
    fn largest_hub_compliance(&self) -> f64;

    /// Turn (displacement) of the hub by unit load on it that the residual compliance carries.
    fn hub_residual_compliance(&self) -> f64;

    /// A bound of `|B q|` at any flank node [m]: `sqrt(c) sqrt(2 U)` with the largest modal compliance `c` of a node
    /// and the strain energy `U` (Cauchy and Schwarz).
    fn bound(&self, at: At<'_>) -> f64;
}
