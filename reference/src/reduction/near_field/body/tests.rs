//! Elements cut out of a body against the lattice, and half-spaces on tetrahedra against those on hexahedra.
#![allow(clippy::print_stdout, reason = "observed figures")]

use super::super::of_lattices;
use super::*;
use crate::gear_deck;
use crate::gear_mesh::{self, GearMeshParams, Tooth};
use crate::mesh::ElementKind;
use crate::reduction::{Basis, ModeSelection, Mounting, Request};
use crate::test_support::bare;
use gearbench_models::gear::elastic::lines::{LinesOfFlanks, Strips, spread};
use gearbench_models::geometry::{Gear, GearParams};

fn gear(teeth: u32) -> Gear {
    Gear::new(GearParams {
        teeth,
        module: 4e-3,
        face_width: 10e-3,
        tip_radius: 0.3,
        bore_radius: f64::from(teeth) * 1e-3,
        profile_shift: if teeth < 17 { 0.4 } else { 0.0 },
        ..GearParams::default()
    })
    .unwrap()
}

fn params(kind: ElementKind, flank: usize) -> GearMeshParams {
    GearMeshParams {
        kind,
        tooth: Tooth {
            flank,
            fillet: flank.div_ceil(2).max(2),
            root: 1,
            across: flank,
        },
        layers: 1,
        rim: flank.div_ceil(2).max(2),
        width: 2,
        ..GearMeshParams::default()
    }
}

/// Hexahedra on both routes: the same but for the curvature of the flank far from the load, and for the elements next to
/// the tip, which are no squares.
#[test]
fn hexahedra_answer_as_their_lattice_does() {
    for (flank, most) in [(8, 0.09), (16, 0.08)] {
        let mesh = gear_mesh::sector(&gear(24), &params(ElementKind::C3D8I, flank)).unwrap();
        let surface = Surface::new(&mesh).unwrap();
        let steel = Material::STEEL;
        let lattice = of_lattices(&mesh, ElementKind::C3D8I, &steel);
        let lattice = lattice.unwrap().unwrap();
        let own = of_flanks(&mesh, &steel, &surface).unwrap().unwrap();
        assert_eq!((lattice.len(), own.len()), (2, 2));
        let n = flank + 1;
        for (a, b) in lattice.iter().zip(&own) {
            for i in 0..=3 * flank / 4 {
                for j in (i.saturating_sub(2)..=i + 2).filter(|j| *j < 3 * flank / 4) {
                    let off = b[i * n + j] - a[i * n + j];
                    assert!(off.abs() < most, "{flank}, {i}, {j}: {off:.3}");
                }
            }
        }
    }
}

/// Returns the compliance of a line load without the near field, over `A`, at radii of the right flank of a tooth.
fn support(basis: &Basis, radii: &[f64]) -> Vec<f64> {
    let near_field = basis.near_field.as_ref().unwrap();
    let lines = LinesOfFlanks::new(&basis.flanks, near_field, Strips::Count(1)).unwrap();
    let steel = Material::STEEL;
    let a = 2.0 * (1.0 - steel.poisson.powi(2)) / (PI * steel.young);
    let width = 10e-3;
    let grid = &lines.flanks.grids()[0];
    let n = grid.rows;
    let between = |i: usize, j: usize| -> f64 {
        let [i, j] = [i, j].map(|row| &lines.sums[grid.nodes[row] as usize]);
        let pairs = i.iter().flat_map(|p| j.iter().map(move |q| (p, q)));
        (pairs.map(|((p, u), (q, v))| u * v * basis.compliance_between(*p as u32, *q as u32))).sum()
    };
    let left: Vec<f64> = (0..n * n)
        .map(|k| between(k / n, k % n) * width / a - lines.near_field[0][k])
        .collect();
    let found = (0..40 * (n - 1)).map(|k| {
        let s = spread(k / 40, (k % 40) as f64 / 40.0, n);
        let (mut radius, mut sum) = (0.0, 0.0);
        for i in 0..4 {
            radius += s.weights[i] * grid.positions[s.first + i].xy().norm();
            for j in 0..4 {
                sum += s.weights[i] * s.weights[j] * left[(s.first + i) * n + s.first + j];
            }
        }
        (radius, sum)
    });
    let found: Vec<(f64, f64)> = found.collect();
    let at = |r: &f64| {
        let nearest = (found.iter()).min_by(|a, b| (a.0 - r).abs().total_cmp(&(b.0 - r).abs()));
        nearest.map_or(f64::NAN, |f| f.1)
    };
    radii.iter().map(at).collect()
}

/// By how much the approach exceeds the compliance of the body, both in the unit of [`support`], at a half-width of 0.1 mm.
const APPROACH: f64 = 9.2;

/// The compliance of the body behind half-spaces does not depend on the elements: hexahedra with incompatible modes
/// (lattice), quadratic ones, and tetrahedra without sets (elements themselves). With `-ln b` of a half-width of 0.1
/// mm the approach is larger by 9.2: 1 % of it is 0.1.
#[test]
fn the_support_behind_half_spaces_does_not_depend_on_the_elements() {
    let gear = gear(12);
    let radii: Vec<f64> = (0..7).map(|k| 1e-3 * (23.5 + 0.6 * f64::from(k))).collect();
    let of = |mesh: &GearMesh, sector: bool| {
        let request = Request {
            along_profile: false,
            foreign: None,
            mesh,
            sector,
            material: Material::STEEL,
            mounting: Mounting::gear(false, 0.0),
            wanted: ModeSelection::Count(1),
        };
        support(&request.compute().unwrap(), &radii)
    };
    let of_sector = |kind, flank| {
        of(
            &gear_mesh::sector(&gear, &params(kind, flank)).unwrap(),
            true,
        )
    };
    let truth = of_sector(ElementKind::C3D8I, 24);
    let cut = gear_mesh::gear(&gear, &params(ElementKind::C3D20, 3)).unwrap();
    let bare = bare(&mesh::tetrahedra(&cut.mesh).unwrap());
    let mut found = gear_deck::gears_with(&bare, Some(Material::STEEL)).unwrap();
    let tetrahedra = found.swap_remove(0).mesh;
    assert!(!tetrahedra.tied.is_empty());
    for (name, most, found) in [
        ("8 hexahedra", 0.16, of_sector(ElementKind::C3D8I, 8)),
        ("8 quadratic ones", 0.12, of_sector(ElementKind::C3D20, 8)),
        ("3 tetrahedra", 0.11, of(&tetrahedra, false)),
    ] {
        let off = truth.iter().zip(&found).map(|(a, b)| (b - a).abs());
        println!(
            "{name}: compliance behind half-spaces off by {:.2} % of the approach",
            100.0 * off.fold(0.0, f64::max) / APPROACH
        );
        for ((r, a), b) in radii.iter().zip(&truth).zip(&found) {
            assert!((b - a).abs() < most, "{name} at {:.1} mm: {a} {b}", 1e3 * r);
        }
    }
}
