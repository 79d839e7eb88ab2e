//! Names of the arrays.

use gearbench_models::geometry::Side;

pub(super) const META: &str = "meta";
pub(super) const TOOTH: &str = "flank_tooth";
pub(super) const SIDE: &str = "flank_side";
pub(super) const ROWS: &str = "flank_rows";
pub(super) const COLUMNS: &str = "flank_columns";
pub(super) const NODES: &str = "flank_nodes_m";
pub(super) const NORMALS: &str = "flank_normals";
pub(super) const OMEGA: &str = "omega_rad_s";
pub(super) const FAMILY: &str = "mode_family";
pub(super) const SHAPES: &str = "shapes_per_sqrt_kg";
pub(super) const HUB: &str = "hub_shapes";
pub(super) const PARTICIPATION: &str = "participation";
pub(super) const MOMENTUM: &str = "modal_momentum_sqrt_kg";
pub(super) const UNBALANCE: &str = "unbalance_kg_m";
pub(super) const COMPLIANCE: &str = "flank_compliance_m_per_n";
pub(super) const HUB_FLANK: &str = "hub_flank_compliance";
pub(super) const HUB_HUB: &str = "hub_compliance";
pub(super) const NEAR_FIELD: &str = "near_field_ln_per_m";
pub(super) const INERTIA: &str = "inertia";
pub(super) const ADDED: &str = "added_inertia";
pub(super) const LATERAL_FREE: &str = "lateral_free";
pub(super) const LATERAL_HUB: &str = "lateral_hub_shapes";
pub(super) const BODY_MASS: &str = "body_mass_kg";
pub(super) const BODY_CENTRE: &str = "body_centre_m";
pub(super) const BODY_INERTIA: &str = "body_inertia_kg_m2";
pub(super) const ADDED_MASS: &str = "added_mass_kg";
pub(super) const ADDED_TILTING: &str = "added_tilting_kg_m2";
pub(super) const YOUNG: &str = "young_pa";
pub(super) const POISSON: &str = "poisson";
pub(super) const DENSITY: &str = "density_kg_m3";

/// Most flank nodes, modes or teeth that a file may name.
pub(super) const MOST: usize = u32::MAX as usize;

pub(super) fn sign(side: Side) -> i64 {
    match side {
        Side::Left => 1,
        Side::Right => -1,
    }
}
