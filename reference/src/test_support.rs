//! Bodies, meshes and numbers that several tests share.

use crate::assembly::assemble;
use crate::assembly::tie::{HubMotion, MassKind, Reduced, Tie};
use crate::deck::{self, Deck, ElementBlock, Place};
use crate::element::natural;
use crate::mesh::{ElementKind, GearMesh, GearMeshParams, Mesh, Shape, Tooth};
use faer::sparse::SparseColMat;
use gearbench_models::Vec3;
use gearbench_models::gear::table::GearContext;
use gearbench_models::geometry::{Gear, GearParams, Rack, RackParams};
use gearbench_models::kinematics::{Hub, Placement};
use gearbench_models::spec::{Body, ModelSpec, Mount};
use gearbench_models::stiffness::Material;

/// A deck of the stored references.
pub(crate) fn calculix(name: &str) -> Deck {
    deck::read(format!("{}/calculix/{name}", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

/// A deck from its text, without includes.
pub(crate) fn parsed(name: &str, text: &str) -> Deck {
    let read = deck::read_str(name, text, &mut |_| {
        Err(std::io::Error::other("no includes"))
    });
    read.unwrap_or_else(|e| panic!("{e}"))
}

/// A deck without sets.
pub(crate) fn bare(mesh: &Mesh) -> Deck {
    let kind = mesh.kind().unwrap();
    Deck {
        name: "bare.inp".to_owned(),
        nodes: mesh.nodes.clone(),
        node_labels: (1..=mesh.nodes.len() as u32).map(Into::into).collect(),
        blocks: vec![ElementBlock {
            kind,
            set: None,
            first: 0,
            connectivity: mesh.connectivity().collect(),
            place: Place {
                file: "bare.inp".into(),
                line: 1,
            },
        }],
        element_labels: (1..=mesh.element_count() as u32).map(Into::into).collect(),
        ..Deck::default()
    }
}

/// A gear of the default toothing, changed where a test needs it.
pub(crate) fn gear(teeth: u32, module: f64, change: impl FnOnce(&mut GearParams)) -> Gear {
    let mut params = GearParams {
        teeth,
        module,
        ..GearParams::default()
    };
    change(&mut params);
    Gear::new(params).unwrap()
}

/// Builds a rack from its number of teeth and module.
pub(crate) fn rack(teeth: u32, module: f64, change: impl FnOnce(&mut RackParams)) -> Rack {
    let mut params = RackParams {
        teeth,
        module,
        ..RackParams::default()
    };
    change(&mut params);
    Rack::new(params).unwrap()
}

/// Builds a thick-walled gear with stub teeth: a few hundred unknowns.
pub(crate) fn stub(teeth: u32, helix_angle: f64) -> Gear {
    gear(teeth, 4e-3, |p| {
        p.helix_angle = helix_angle;
        p.pressure_angle = 0.5;
        p.profile_shift = 0.35;
        p.addendum = 0.7;
        p.dedendum = 1.0;
        p.tip_radius = 0.15;
        p.bore_radius = 0.25 * 4e-3 * f64::from(teeth);
    })
}

/// Returns the parameters of a coarse mesh, for tests that do not depend on the number of elements.
pub(crate) fn coarse(rim: usize, width: usize) -> GearMeshParams {
    GearMeshParams {
        kind: ElementKind::C3D8,
        tooth: Tooth::coarse(),
        layers: 1,
        rim,
        width,
        ..GearMeshParams::default()
    }
}

/// The default mesh of a kind of element, with so many layers over the width.
pub(crate) fn layered(kind: ElementKind, width: usize) -> GearMeshParams {
    GearMeshParams {
        kind,
        width,
        ..GearMeshParams::default()
    }
}

/// The default mesh with other counts along a flank, of the rim and over the width.
pub(crate) fn counted(flank: usize, rim: usize, width: usize) -> GearMeshParams {
    let mut params = layered(ElementKind::C3D8I, width);
    (params.tooth.flank, params.rim) = (flank, rim);
    params
}

/// Nodes of the elements that make up a cell, in steps of half an edge: two wedges, or six tetrahedra about a
/// diagonal (H. W. Kuhn 1960).
fn of_cell(kind: ElementKind) -> Vec<Vec<[usize; 3]>> {
    let whole = |corners: Vec<[usize; 3]>| -> Vec<[usize; 3]> {
        let edges = kind.edges().iter().take(kind.nodes() - kind.corners());
        let middles = edges.map(|&[a, b]| [0, 1, 2].map(|i| (corners[a][i] + corners[b][i]) / 2));
        let middles: Vec<[usize; 3]> = middles.collect();
        corners.into_iter().chain(middles).collect()
    };
    let at = |x: usize, y: usize, z: usize| [2 * x, 2 * y, 2 * z];
    match kind.shape() {
        Shape::Hexahedron => {
            let nodes = (0..kind.nodes()).map(|a| natural(kind, a).map(|c| (c + 1.0) as usize));
            vec![nodes.collect()]
        }
        Shape::Wedge => [[[0, 0], [1, 0], [1, 1]], [[0, 0], [1, 1], [0, 1]]]
            .map(|t| {
                let layer = |z| t.map(|[x, y]| at(x, y, z));
                whole(layer(0).into_iter().chain(layer(1)).collect())
            })
            .into(),
        Shape::Tetrahedron => [
            [0, 1, 2],
            [1, 2, 0],
            [2, 0, 1],
            [0, 2, 1],
            [1, 0, 2],
            [2, 1, 0],
        ]
        .iter()
        .enumerate()
        .map(|(i, order)| {
            let mut corners = vec![[0; 3]];
            for &axis in order {
                let mut next = corners[corners.len() - 1];
                next[axis] = 2;
                corners.push(next);
            }
            if i >= 3 {
                corners.swap(1, 2);
            }
            whole(corners)
        })
        .collect(),
    }
}

/// A box from the origin, cut into equal cells; nodes ascend along z first, x last.
pub(crate) fn brick(kind: ElementKind, cells: [usize; 3], size: [f64; 3]) -> Mesh {
    let points = cells.map(|c| 2 * c + 1);
    let at = |i: [usize; 3]| (i[0] * points[1] + i[1]) * points[2] + i[2];
    let mut used = vec![false; points.iter().product()];
    let of_cell = of_cell(kind);
    let mut elements = Vec::new();
    for x in 0..cells[0] {
        for y in 0..cells[1] {
            for z in 0..cells[2] {
                elements.extend(of_cell.iter().flatten().map(|n| {
                    let place = at([2 * x + n[0], 2 * y + n[1], 2 * z + n[2]]);
                    used[place] = true;
                    place
                }));
            }
        }
    }
    let mut number = vec![u32::MAX; used.len()];
    let mut nodes = Vec::new();
    for x in 0..points[0] {
        for y in 0..points[1] {
            for z in 0..points[2] {
                if used[at([x, y, z])] {
                    number[at([x, y, z])] = nodes.len() as u32;
                    let part = |i: usize, k: usize| size[k] * i as f64 / (points[k] - 1) as f64;
                    nodes.push(Vec3::new(part(x, 0), part(y, 1), part(z, 2)));
                }
            }
        }
    }
    let connectivity = elements.into_iter().map(|place| number[place]);
    Mesh::new(kind, nodes, connectivity.collect())
}

/// A hub away from the origin, with unit inertia.
pub(crate) fn hub(mount: Mount, slide: Option<Vec3>) -> Hub {
    Hub::new(mount, Vec3::new(0.1, -0.2, 0.0), slide, 1.0)
}

/// Returns the context of a steel gear without meshes.
pub(crate) fn context<'a>(body: &'a Body, hub: &'a Hub, model: &'a ModelSpec) -> GearContext<'a> {
    GearContext {
        name: "pinion",
        body,
        material: Material::STEEL,
        hub,
        added_inertia: 0.0,
        placement: Placement::new(hub, 0.1),
        effective_radius: 1.0,
        meshes: &[],
        slides: false,
        lines: None,
        speed: 0.0,
        time_of_first_teeth: f64::INFINITY,
        model,
    }
}

/// Returns the largest absolute value.
pub(crate) fn largest(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |m, x| m.max(x.abs()))
}

/// `A x` of a lower triangle.
pub(crate) fn product(a: &SparseColMat<usize, f64>, x: &[f64]) -> Vec<f64> {
    let mut y = vec![0.0; x.len()];
    for j in 0..a.ncols() {
        for (i, v) in a.row_idx_of_col(j).zip(a.val_of_col(j)) {
            y[i] += v * x[j];
            if i != j {
                y[j] += v * x[i];
            }
        }
    }
    y
}

/// A mesh on its hub: the tie, stiffness and consistent mass.
pub(crate) fn tied(gear: &GearMesh, motions: &[HubMotion], added: &[f64]) -> (Tie, Reduced) {
    let assembly = assemble(&gear.mesh, &Material::STEEL).unwrap();
    let tie = Tie::new(&gear.mesh.nodes, &gear.bore, motions);
    let reduced = tie.reduce(&assembly, added, MassKind::Consistent);
    (tie, reduced)
}

/// Numbers that look random and repeat.
pub(crate) fn noise(n: usize, size: f64) -> Vec<f64> {
    (0..n)
        .map(|i| size * ((i as f64 * 12.9898).sin() * 43_758.545_3).fract())
        .collect()
}
