//! Time and size of generated meshes: `cargo bench --bench meshing`.
//!
//! Criterion times them; nodes, elements, unknowns and the bytes that a mesh holds are printed beside.

use criterion::Criterion;
use gearbench_models::geometry::{Gear, GearParams, Rack, RackParams};
use gearbench_reference::gear_mesh::{self, FineTeeth, GearMesh, GearMeshParams, Tooth};
use gearbench_reference::mesh::ElementKind;

fn bytes(m: &GearMesh) -> usize {
    let sets: usize = m.mesh.node_sets.values().map(|s| 4 * s.capacity()).sum();
    let faces: usize = m.mesh.face_sets.values().map(|s| 8 * s.capacity()).sum();
    let flanks: usize = m
        .flanks
        .iter()
        .map(|f| 4 * f.nodes.capacity() + 24 * f.positions.capacity())
        .sum();
    24 * m.mesh.nodes.capacity()
        + 4 * (m
            .mesh
            .blocks
            .iter()
            .map(|b| b.connectivity.capacity())
            .sum::<usize>()
            + m.bore.capacity())
        + sets
        + faces
        + flanks
}

#[allow(clippy::print_stdout)]
fn row(criterion: &mut Criterion, name: &str, make: impl Fn() -> GearMesh) {
    criterion.bench_function(name, |bencher| bencher.iter(&make));
    let m = make();
    println!(
        "{name:<34} {:>8} nodes {:>8} elements {:>9} unknowns {:>11} bytes",
        m.mesh.nodes.len(),
        m.mesh.element_count(),
        3 * m.mesh.nodes.len(),
        bytes(&m)
    );
}

#[allow(clippy::print_stdout)]
fn main() {
    let gear = |teeth, helix_angle| {
        Gear::new(GearParams {
            teeth,
            module: 4e-3,
            helix_angle,
            face_width: 20e-3,
            bore_radius: 20e-3,
            ..GearParams::default()
        })
        .expect("a gear that can be cut")
    };
    let mut criterion = Criterion::default().sample_size(20);
    let mut row = |name: &str, make: &dyn Fn() -> GearMesh| row(&mut criterion, name, make);
    let g = gear(24, 0.0);
    let p = GearMeshParams {
        width: 5,
        ..GearMeshParams::default()
    };
    let with = |change: &dyn Fn(&mut GearMeshParams)| {
        let mut p = p.clone();
        change(&mut p);
        p
    };
    let made = |g: &Gear, p: &GearMeshParams| gear_mesh::gear(g, p).expect("a sound mesh");
    row("spur, z = 24, C3D8I", &|| made(&g, &p));
    let wide = with(&|p| p.width = 6);
    row("the same, 6 layers over the width", &|| made(&g, &wide));
    let helical = gear(24, 0.35);
    row("helical, 20 degrees, 6 layers", &|| made(&helical, &wide));
    let quadratic = with(&|p| (p.kind, p.width) = (ElementKind::C3D20R, 2));
    row("spur, C3D20R, 2 layers", &|| made(&g, &quadratic));
    let sector = with(&|p| p.sector = true);
    row("one sector, C3D8I", &|| made(&g, &sector));
    let fine = with(&|p| {
        p.tooth.flank = 20;
        p.fine_teeth = Some(FineTeeth {
            teeth: vec![0, 1, 23],
            others: Tooth::coarse(),
        });
    });
    row("3 fine teeth, others coarse", &|| made(&g, &fine));
    let large = gear(120, 0.0);
    let huge = with(&|p| {
        p.tooth = Tooth {
            flank: 16,
            fillet: 8,
            root: 4,
            across: 12,
        };
        (p.layers, p.rim, p.width) = (4, 8, 10);
    });
    row("spur, z = 120, twice as fine", &|| made(&large, &huge));
    let rack = Rack::new(RackParams {
        teeth: 20,
        module: 4e-3,
        body_height: 12e-3,
        ..RackParams::default()
    })
    .expect("a rack that can be cut");
    row("rack, 20 teeth, C3D8I", &|| {
        gear_mesh::rack(&rack, &GearMeshParams::default()).expect("a sound mesh")
    });
}
