//! Coupling of the nodes tied to a hub of several directions with the other nodes.
//!
//! With the six unit motions `e_p` of the held nodes in the assembled position (along and about the axes of space through the
//! hub's centre) the elements couple them to the others by `K_fb e_p` and `M_fb e_p`, and have among themselves the stiffness
//! `e_p^T K_bb e_q` and the mass of a rigid body. None of these changes in the frame on the hub.

use crate::assembly::tie::{HubMotion, Reduced};
use faer::sparse::SparseColMat;
use gearbench_models::Vec3;
use gearbench_models::kinematics::BodyMass;
use nalgebra::{Matrix3, Matrix6};

/// Along the axes of space, then about them.
pub(super) fn motions() -> [HubMotion; 6] {
    let axes = [Vec3::x(), Vec3::y(), Vec3::z()];
    std::array::from_fn(|d| match d {
        0..3 => HubMotion::Slide(axes[d]),
        _ => HubMotion::TurnAbout(axes[d - 3]),
    })
}

/// Matrices that couple the tied nodes to the others.
#[derive(Clone, Debug)]
pub struct TiedNodes {
    /// Per coordinate of the others that has any: `K_fb e_p` and `M_fb e_p`.
    pub coupling: Vec<(u32, [[f64; 6]; 2])>,
    /// Stiffness matrix `e_p^T K_bb e_q`.
    pub stiffness: Matrix6<f64>,
    /// Per place among the others that has any: `M_fb 1` [kg] and `M_fb X_b` [kg m].
    pub mass: Vec<(u32, f64, Vec3)>,
    /// Rigid body of the tied nodes with the mass added at the hub, in the axes of the hub.
    pub body: BodyMass,
}

impl TiedNodes {
    /// Splits matrices over the coordinates of the other nodes and the six motions into those of the nodes alone and the rest;
    /// a mass [kg] and inertias about its `axes` [kg m^2] are `added` at the hub.
    pub fn split(
        all: &Reduced,
        mass: Vec<(u32, f64, Vec3)>,
        axes: &[Vec3; 3],
        added: (f64, Vec3),
    ) -> (Reduced, TiedNodes) {
        let n = all.mass.ncols() - 6;
        let is_hub: Vec<bool> = (0..n + 6).map(|i| i >= n).collect();
        let mut coupling = vec![[[0.0; 6]; 2]; n];
        let mut own = [Matrix6::zeros(); 2];
        let parts: [&SparseColMat<usize, f64>; 2] = [&all.stiffness, &all.mass];
        for (which, matrix) in parts.into_iter().enumerate() {
            for column in 0..n + 6 {
                let rows = matrix.row_idx_of_col(column);
                for (row, value) in rows.zip(matrix.val_of_col(column)) {
                    match (row.checked_sub(n), column.checked_sub(n)) {
                        (Some(p), Some(q)) => {
                            own[which][(p, q)] = *value;
                            own[which][(q, p)] = *value;
                        }
                        (Some(p), None) => coupling[column][which][p] = *value,
                        _ => {}
                    }
                }
            }
        }
        let some = |c: &[[f64; 6]; 2]| c.iter().flatten().any(|x| *x != 0.0);
        let held = TiedNodes {
            coupling: (0..).zip(coupling).filter(|(_, c)| some(c)).collect(),
            stiffness: own[0],
            mass,
            body: body_of(&own[1], axes, added),
        };
        (all.held(&is_hub), held)
    }
}

/// Returns the rigid body of a mass matrix over six motions and of the added mass, in the axes of a hub.
fn body_of(m: &Matrix6<f64>, axes: &[Vec3; 3], added: (f64, Vec3)) -> BodyMass {
    let turn = Matrix3::from_columns(axes).transpose();
    // The motion about an axis moves the first moment `s` along the next but one by what it has along the next.
    let moment = Vec3::new(m[(1, 5)], m[(2, 3)], m[(0, 4)]);
    let about_origin =
        turn * m.fixed_view::<3, 3>(3, 3) * turn.transpose() + Matrix3::from_diagonal(&added.1);
    let mass = m[(0, 0)] + added.0;
    let centre = match mass > 0.0 {
        true => turn * moment / mass,
        false => Vec3::zeros(),
    };
    let off = centre.norm_squared() * Matrix3::identity() - centre * centre.transpose();
    BodyMass {
        mass,
        inertia: about_origin - mass * off,
        centre,
    }
}
