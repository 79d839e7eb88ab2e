//! The highest frequency against dense eigensolutions: never below, at most 1 % above.

use super::support::{brick, nodes_where};
use crate::assembly::tie::{HubMotion, MassKind, Tie};
use crate::assembly::{assemble, highest_frequency};
use crate::mesh::ElementKind;
use faer::sparse::SparseColMat;
use gearbench_models::Vec3;
use gearbench_models::stiffness::Material;
use nalgebra::DMatrix;

fn dense(a: &SparseColMat<usize, f64>) -> DMatrix<f64> {
    let mut full = DMatrix::zeros(a.nrows(), a.ncols());
    for j in 0..a.ncols() {
        for (i, v) in a.row_idx_of_col(j).zip(a.val_of_col(j)) {
            full[(i, j)] = *v;
            full[(j, i)] = *v;
        }
    }
    full
}

#[test]
fn it_bounds_the_dense_eigenvalue_closely() {
    let motions: [&[HubMotion]; 4] = [
        &[],
        &[HubMotion::Turn],
        // The same slide twice: a motion that adds nothing.
        &[HubMotion::Slide(Vec3::x()), HubMotion::Slide(Vec3::x())],
        &[HubMotion::Turn, HubMotion::Slide(Vec3::y())],
    ];
    for kind in ElementKind::ALL {
        let cells = if kind.nodes() == 8 {
            [4, 3, 2]
        } else {
            [2, 2, 1]
        };
        let mut mesh = brick(kind, cells, [8e-3, 5e-3, 3e-3]);
        for x in &mut mesh.nodes {
            x.x += 0.1 * x.y * (500.0 * x.z).sin() - 4e-3;
            x.y *= 1.0 + 40.0 * x.x;
        }
        let a = assemble(&mesh, &Material::STEEL).unwrap();
        let lowest = mesh.nodes.iter().fold(f64::INFINITY, |m, x| m.min(x.z));
        let bore = nodes_where(&mesh, |x| x.z < lowest + 1e-9);
        for motions in motions {
            let tie = Tie::new(&mesh.nodes, &bore, motions);
            // The double slide is singular in the reduced mass: its single form has the same motions.
            let single = Tie::new(
                &mesh.nodes,
                &bore,
                match motions {
                    [a, b] if a == b => &motions[..1],
                    all => all,
                },
            );
            let count = single.coordinates() - 3 * single.free().len();
            let reduced = single.reduce(&a, &vec![0.0; count], MassKind::Lumped);
            let factor = dense(&reduced.mass).cholesky().unwrap().l();
            let half = factor
                .solve_lower_triangular(&dense(&reduced.stiffness))
                .unwrap();
            let whole = factor.solve_lower_triangular(&half.transpose()).unwrap();
            let exact = ((&whole + whole.transpose()) * 0.5)
                .symmetric_eigenvalues()
                .max()
                .sqrt();
            let found = highest_frequency(&a, &tie);
            assert!(
                (1.0..1.0102).contains(&(found / exact)),
                "{kind:?} {motions:?}: {found:e} over {exact:e}"
            );
        }
    }
}

#[test]
fn a_body_that_is_held_everywhere_has_none() {
    let mesh = brick(ElementKind::C3D8, [1; 3], [1e-3; 3]);
    let a = assemble(&mesh, &Material::STEEL).unwrap();
    let all: Vec<u32> = (0..8).collect();
    assert!(highest_frequency(&a, &Tie::new(&mesh.nodes, &all, &[])) == 0.0);
    let turned = highest_frequency(&a, &Tie::new(&mesh.nodes, &all, &[HubMotion::Turn]));
    let free = highest_frequency(&a, &Tie::new(&mesh.nodes, &[], &[]));
    assert!(turned < 1e-5 * free, "{turned:e} {free:e}");
}
