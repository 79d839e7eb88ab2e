//! Flanks whose nodes no set names, and those that are no grid: modes and compliance of the same body.

use crate::gear_deck;
use crate::gear_mesh::{self, GearMesh};
use crate::mesh::{self, ElementKind, Mesh};
use crate::recognise::tests::strange;
use crate::reduction::surface::Surface;
use crate::reduction::{Basis, ModeSelection, Mounting, Request};
use crate::test_support::{bare, coarse, stub};
use gearbench_models::Vec3;
use gearbench_models::geometry::FlankGrid;
use gearbench_models::stiffness::Material;

fn found(mesh: &Mesh) -> GearMesh {
    let mut gears = gear_deck::gears_with(&bare(mesh), Some(Material::STEEL)).unwrap();
    gears.swap_remove(0).mesh
}

fn basis(mesh: &GearMesh) -> Basis {
    let request = Request {
        along_profile: false,
        foreign: None,
        mesh,
        sector: false,
        material: Material::STEEL,
        mounting: Mounting::gear(true, 0.0),
        wanted: ModeSelection::Count(20),
    };
    request.compute().unwrap()
}

/// Flank node of a basis next to a place.
fn next_to(basis: &Basis, x: &Vec3) -> (f64, u32) {
    let grids = basis.flanks.grids().iter();
    let all = grids.flat_map(|g| g.positions.iter().zip(&g.nodes));
    let near = all.min_by(|a, b| (a.0 - x).norm().total_cmp(&(b.0 - x).norm()));
    let (p, node) = near.unwrap();
    ((p - x).norm(), *node)
}

#[test]
fn hexahedra_without_sets_are_the_same_gear() {
    let own = gear_mesh::gear(&stub(8, 0.2), &coarse(2, 2)).unwrap();
    let strange = strange(
        &own.mesh,
        Vec3::new(0.4, 1.3, -2.0),
        Vec3::new(0.3, 0.2, 0.1),
    );
    let again = found(&strange);
    assert!(again.tied.is_empty());
    assert_eq!((again.teeth, again.flanks.len()), (8, 16));
    let (a, b) = (basis(&own), basis(&again));
    assert_eq!(a.normals.len(), b.normals.len());
    for (a, b) in a.omega.iter().zip(&b.omega) {
        assert!((a / b - 1.0).abs() < 1e-8, "{a} {b}");
    }
    // The teeth may be numbered from another: one turn serves all.
    let first = a.flanks.grids()[0].positions[0];
    let pitch = std::f64::consts::TAU / 8.0;
    let shift = (0..8)
        .map(|k| pitch * f64::from(k))
        .find(|t| next_to(&b, &crate::vector::turned(first, *t)).0 < 1e-9)
        .unwrap();
    for g in a.flanks.grids().iter().take(4) {
        for (x, &n) in g.positions.iter().zip(&g.nodes) {
            let (off, m) = next_to(&b, &crate::vector::turned(*x, shift));
            assert!(off < 1e-9);
            let (p, q) = (a.compliance_between(n, n), b.compliance_between(m, m));
            assert!((p / q - 1.0).abs() < 1e-7, "{p} {q}");
        }
    }
}

/// Points tied to tetrahedra: rigid motion, resultants and moments are kept, and modes and compliance are those of the
/// hexahedra that they are cut from, as far as meshes so coarse agree.
#[test]
fn points_tied_to_tetrahedra_are_the_same_flank() {
    let gear = stub(8, 0.0);
    let params = gear_mesh::GearMeshParams {
        kind: ElementKind::C3D20,
        ..coarse(2, 2)
    };
    let own = gear_mesh::gear(&gear, &params).unwrap();
    let tets = found(&mesh::tetrahedra(&own.mesh).unwrap());
    assert!(!tets.tied.is_empty());
    let surface = Surface::new(&tets).unwrap();
    assert!(!surface.is_of_nodes());
    let positions = surface.positions();
    // A linear field with a turn, a shift and strain.
    let field = |x: &Vec3| {
        Vec3::new(0.1, -0.2, 0.3)
            + Vec3::new(0.5, 0.1, -0.7).cross(x)
            + Vec3::new(0.3 * x.x - 0.1 * x.z, 0.2 * x.y, 0.4 * x.x + 0.1 * x.y)
    };
    let u: Vec<f64> = (tets.mesh.nodes.iter())
        .flat_map(|x| -> [f64; 3] { field(x).into() })
        .collect();
    let mut along = vec![0.0; surface.directions.len()];
    surface.along_directions(&u, &mut along);
    for (k, (n, found)) in surface.directions.iter().zip(&along).enumerate() {
        let foot = surface
            .follows(k)
            .map(|(node, w)| w * tets.mesh.nodes[node as usize]);
        let foot = foot.sum::<Vec3>();
        // Exact at the foot on the face, which the point leaves by what a face is not an involute.
        assert!((n.dot(&field(&foot)) - found).abs() < 1e-14);
        let off = positions[k] - foot;
        assert!(off.norm() < 3e-5, "{}", off.norm());
        // That is along the normal: a force there keeps its moment.
        assert!(off.cross(n).norm() < 0.02 * off.norm() + 1e-9);
        let weights = surface.follows(k).map(|(_, w)| w).sum::<f64>();
        assert!((weights - 1.0).abs() < 1e-12);
    }
    let (a, b) = (basis(&own), basis(&tets));
    for (a, b) in a.omega.iter().zip(&b.omega).take(10) {
        assert!((a / b - 1.0).abs() < 0.02, "{a} {b}");
    }
    assert!((a.inertia / b.inertia - 1.0).abs() < 1e-4);
    // The mean displacement of a flank under a force that is spread over it evenly: that of one point depends on the mesh
    // about it.
    let mean = |basis: &Basis, g: &FlankGrid| {
        let half_at_ends = |i: usize, n: usize| if i == 0 || i == n - 1 { 0.5 } else { 1.0 };
        let part =
            |k: usize| half_at_ends(k / g.columns, g.rows) * half_at_ends(k % g.columns, g.columns);
        let (mut sum, mut parts) = (0.0, 0.0);
        for (k, &i) in g.nodes.iter().enumerate() {
            for (l, &j) in g.nodes.iter().enumerate() {
                sum += part(k) * part(l) * basis.compliance_between(i, j);
                parts += part(k) * part(l);
            }
        }
        sum / parts
    };
    for g in a.flanks.grids() {
        let (off, m) = next_to(&b, &g.positions[0]);
        assert!(off < 1e-5, "{off}");
        let mut others = b.flanks.grids().iter();
        let other = others.find(|o| o.nodes.contains(&m)).unwrap();
        assert_eq!((other.rows, other.columns), (2 * g.rows - 1, g.columns));
        let (p, q) = (mean(&a, g), mean(&b, other));
        // Corners of hexahedra of 20 nodes are softer under forces at nodes than tetrahedra are under twice the points, 11 %;
        // the support behind the loads is the same to 1 % (`near_field`).
        assert!((p / q - 1.0).abs() < 0.13, "{p} {q}");
    }
}
