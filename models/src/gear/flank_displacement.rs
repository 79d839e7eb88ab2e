//! The flank displacement operator: outward displacements of flank nodes from the rigid flank, for nodal contact.

use gearbench_integrators::system::StateView;
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
    /// Computes `out_k = sum_i b_ki x_i` with the coordinates, or velocities, `x` of the gear.
    fn displacements(&self, x: &[f64], nodes: &[u32], out: &mut [f64]);

    /// Subtracts the generalised nodal forces: `f_i -= sum_k b_ki F_k`.
    fn apply_nodal_forces(&self, nodes: &[u32], forces: &[f64], f: &mut [f64]);

    /// Adds the mobility of the nodes, `out_kl += sum_i b_ki b_li w_i` in `out[k * n + l]`: the velocities of nodes
    /// under forces on them, with weights of the gear's coordinates (times over masses).
    fn add_mobility(&self, weights: &[f64], nodes: &[u32], out: &mut [f64]);

    /// Returns the offset of a node's number for its displacement along the profile, counted along the transverse part
    /// of its outward normal rotated by 90 degrees counter-clockwise. `None` where it is not available: flanks then
    /// move along their profile with the hub alone.
    fn along_profile(&self) -> Option<u32> {
        None
    }

    /// Returns the displacement of the [lines](crate::gear::elastic::lines) of each flank under line loads; `None`
    /// where nodes are not lines.
    fn near_field(&self) -> Option<&Arc<Vec<Vec<f64>>>> {
        None
    }

    /// Returns the natural frequencies of the kept modes of the body [rad/s], in the order of its coordinates.
    fn mode_frequencies(&self) -> &[f64];

    /// Returns true if there is a residual compliance.
    fn is_compliant(&self) -> bool;

    /// Computes the residual compliance `R_kl` between nodes [m/N], `out[k * n + l]`; zeros where there is none.
    fn compliance(&self, nodes: &[u32], out: &mut [f64]);

    /// Computes the displacements `r_k` per unit load on the hub.
    fn hub_compliance(&self, nodes: &[u32], out: &mut [f64]);

    /// Returns the largest displacement of a flank node per unit load on the hub.
    fn largest_hub_compliance(&self) -> f64;

    /// Returns the rotation (displacement) of the hub per unit load on it that the residual compliance carries.
    fn hub_residual_compliance(&self) -> f64;

    /// Returns a bound of `|B q|` at any flank node [m]: `sqrt(c) sqrt(2 U)` with the largest modal compliance `c` of
    /// a node and the strain energy `U` (Cauchy and Schwarz).
    fn bound(&self, at: StateView<'_>) -> f64;
}
