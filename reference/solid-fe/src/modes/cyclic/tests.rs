//! Modes from one sector compared with modes of the whole mesh and with symmetry.

use super::*;
use crate::Vec3;
use crate::assembly::assemble;
use crate::assembly::tie::{MassKind, Tie};
use crate::mesh::{ElementKind, Mesh};
use crate::modes::{self, Symmetric};
use crate::vector::turned;

/// A ring, or one sector of it, with its own data.
#[derive(Clone)]
struct Ring {
    mesh: Mesh,
    sectors: u32,
    bore: Vec<u32>,
}

impl Ring {
    fn as_sector(&self) -> SectorMesh<'_> {
        SectorMesh {
            mesh: &self.mesh,
            sectors: self.sectors,
            bore: &self.bore,
        }
    }
}

/// Side of a ring that its teeth are on; the hub holds the other side.
#[derive(Clone, Copy, PartialEq)]
enum Teeth {
    Outside,
    Inside,
}

/// A ring of hexahedra with one tooth per pitch: radial bands, the last one on the first half of the pitch only.
/// `pitches` of `teeth` are meshed; a whole gear closes on itself.
fn ring(
    kind: ElementKind,
    (side, teeth): (Teeth, u32),
    pitches: u32,
    bands: usize,
    layers: usize,
) -> Ring {
    let per_pitch = 3;
    let closed = pitches == teeth;
    let steps = per_pitch * pitches as usize;
    let columns = if closed { steps } else { steps + 1 };
    let width = 0.01;
    // Radius of the hub, thickness of a band towards the teeth, and the turn of the section over the width.
    let (hub, band, twist) = match side {
        Teeth::Outside => (0.02, 0.006, 0.0),
        Teeth::Inside => (0.05, -0.006, 0.1),
    };
    let mut mesh = Mesh::new(kind, Vec::new(), Vec::new());
    let pitch = std::f64::consts::TAU / f64::from(teeth);
    let index = |column: usize, row: usize, layer: usize| {
        (((column % columns) * (bands + 2) + row) * (layers + 1) + layer) as u32
    };
    for column in 0..columns {
        for row in 0..bands + 2 {
            for layer in 0..=layers {
                let z = width * layer as f64 / layers as f64;
                let angle = pitch * column as f64 / per_pitch as f64 + twist * z / width;
                let r = hub + band * row as f64;
                mesh.nodes
                    .push(Vec3::new(r * angle.cos(), r * angle.sin(), z));
            }
        }
    }
    for step in 0..steps {
        // The tooth is one step wide.
        let rows = if step % per_pitch == 1 {
            bands + 1
        } else {
            bands
        };
        for row in 0..rows {
            for layer in 0..layers {
                for up in 0..2 {
                    let around = match side {
                        Teeth::Outside => [(0, 0), (1, 0), (1, 1), (0, 1)],
                        Teeth::Inside => [(0, 0), (0, 1), (1, 1), (1, 0)],
                    };
                    for (r, c) in around {
                        mesh.blocks[0]
                            .connectivity
                            .push(index(step + c, row + r, layer + up));
                    }
                }
            }
        }
    }
    // Nodes without an element, beside the teeth, go.
    let mut used = vec![false; mesh.nodes.len()];
    mesh.blocks[0]
        .connectivity
        .iter()
        .for_each(|&n| used[n as usize] = true);
    let mut new = vec![u32::MAX; mesh.nodes.len()];
    let mut nodes = Vec::new();
    for (i, x) in mesh.nodes.iter().enumerate().filter(|(i, _)| used[*i]) {
        new[i] = nodes.len() as u32;
        nodes.push(*x);
    }
    let cut = |column: usize| -> Vec<u32> {
        let all = (0..bands + 2).flat_map(|r| (0..=layers).map(move |l| (r, l)));
        all.map(|(r, l)| new[index(column, r, l) as usize])
            .filter(|n| *n != u32::MAX)
            .collect()
    };
    let bore = (0..columns).flat_map(|c| (0..=layers).map(move |l| (c, l)));
    let bore = bore.map(|(c, l)| new[index(c, 0, l) as usize]).collect();
    if !closed {
        mesh.node_sets.insert("cut_low".into(), cut(0));
        mesh.node_sets.insert("cut_high".into(), cut(steps));
    }
    mesh.blocks[0]
        .connectivity
        .iter_mut()
        .for_each(|n| *n = new[*n as usize]);
    mesh.nodes = nodes;
    Ring {
        mesh,
        sectors: teeth,
        bore,
    }
}

/// Returns the displacements of a cyclic mode on the nodes of the whole mesh, matched by position.
fn on_whole(modes: &CyclicModes, i: usize, sector: &Ring, gear: &Ring) -> Vec<f64> {
    let mut full = vec![f64::NAN; 3 * gear.mesh.nodes.len()];
    let mut u = vec![0.0; 3 * sector.mesh.nodes.len()];
    let key = |x: &Vec3| [x.x, x.y, x.z].map(|c| (c * 1e8).round() as i64);
    let at: std::collections::HashMap<_, _> = gear
        .mesh
        .nodes
        .iter()
        .enumerate()
        .map(|(i, x)| (key(x), i))
        .collect();
    for tooth in 0..gear.sectors {
        modes.expand(i, tooth, &mut u);
        let angle = std::f64::consts::TAU * f64::from(tooth) / f64::from(gear.sectors);
        for (x, u) in sector.mesh.nodes.iter().zip(u.chunks_exact(3)) {
            let node = at[&key(&turned(*x, angle))];
            for axis in 0..3 {
                let old = full[3 * node + axis];
                assert!(
                    old.is_nan() || (old - u[axis]).abs() < 1e-8,
                    "cuts do not meet"
                );
                full[3 * node + axis] = u[axis];
            }
        }
    }
    full
}

/// Frequencies, residuals of the expanded shapes in the whole matrices, orthonormality.
fn agrees(kind: ElementKind, teeth: u32, bands: usize, layers: usize, hub: &Hub, count: usize) {
    let of = |pitches| ring(kind, (Teeth::Outside, teeth), pitches, bands, layers);
    agree([&of(1), &of(teeth)], hub, count);
}

/// Checks that the modes of a sector and of the whole gear agree.
fn agree([sector, gear]: [&Ring; 2], hub: &Hub, count: usize) {
    let options = Options::default();
    let cyclic = lowest(&sector.as_sector(), &Material::STEEL, hub, count, &options).unwrap();
    let assembly = assemble(&gear.mesh, &Material::STEEL).unwrap();
    let tie = Tie::new(&gear.mesh.nodes, &gear.bore, &hub.motions);
    let r = tie.reduce(&assembly, &hub.added_inertia, MassKind::Consistent);
    let full = modes::lowest(&r, count, &options).unwrap();
    assert!(cyclic.modes.len() == count || cyclic.modes.len() == count + 1);
    let scale = full.omega2[full.omega2.iter().position(|w| *w > 1e6).unwrap()];
    for i in 0..count {
        let (a, b) = (cyclic.modes[i].omega2, full.omega2[i]);
        assert!(
            (a - b).abs() < 1e-8 * a.max(scale),
            "mode {i}: {a:e} against {b:e}"
        );
    }
    let (k, m) = (
        Symmetric::new(r.stiffness.as_ref()).unwrap(),
        Symmetric::new(r.mass.as_ref()).unwrap(),
    );
    let n = k.size();
    let mut x = Mat::<f64>::zeros(n, cyclic.modes.len());
    for i in 0..cyclic.modes.len() {
        let u = on_whole(&cyclic, i, sector, gear);
        for (place, &node) in tie.free.iter().enumerate() {
            for axis in 0..3 {
                x[(3 * place + axis, i)] = u[3 * node as usize + axis];
            }
        }
        // Hub coordinates by least squares over the bore nodes.
        let motions = hub.motions.len();
        let mut normal = Mat::<f64>::zeros(motions, motions);
        let mut right = Mat::<f64>::zeros(motions, 1);
        for &node in &gear.bore {
            let at = &gear.mesh.nodes[node as usize];
            for p in 0..motions {
                let a = hub.motions[p].of(at);
                right[(p, 0)] += a.dot(&Vec3::from_column_slice(&u[3 * node as usize..][..3]));
                for q in 0..motions {
                    normal[(p, q)] += a.dot(&hub.motions[q].of(at));
                }
            }
        }
        if motions > 0 {
            use faer::prelude::Solve;
            let g = normal.partial_piv_lu().solve(&right);
            for p in 0..motions {
                x[(n - motions + p, i)] = g[(p, 0)];
            }
        }
    }
    let (mut kx, mut mx) = (Mat::zeros(n, x.ncols()), Mat::zeros(n, x.ncols()));
    k.apply(x.as_ref(), kx.as_mut());
    m.apply(x.as_ref(), mx.as_mut());
    let gram = x.transpose() * &mx;
    for i in 0..x.ncols() {
        let w2 = cyclic.modes[i].omega2;
        let rest = (kx.col(i) - faer::Scale(w2) * mx.col(i)).norm_l2();
        let elastic = kx.col(i).norm_l2().max(1e-3 * scale * mx.col(i).norm_l2());
        assert!(
            rest < 1e-8 * elastic,
            "mode {i}: residual {:e}",
            rest / elastic
        );
        for j in 0..x.ncols() {
            let expected = f64::from(u8::from(i == j));
            assert!(
                (gram[(i, j)] - expected).abs() < 1e-9,
                "{i} {j}: {}",
                gram[(i, j)]
            );
        }
    }
    // The span of the modes below the last gap is the same: sines of the angles between the spaces.
    let last = (1..count)
        .rev()
        .find(|&i| full.omega2[i] > (1.0 + 1e-4) * full.omega2[i - 1])
        .unwrap();
    let overlap = full.vectors.transpose().subrows(0, last) * mx.subcols(0, last);
    for j in 0..last {
        assert!(
            (overlap.col(j).norm_l2() - 1.0).abs() < 1e-10,
            "mode {j} leaves the space of the whole mesh"
        );
    }
}

#[test]
fn clamped_bore() {
    agrees(ElementKind::C3D8, 12, 2, 1, &Hub::fixed(), 70);
    agrees(ElementKind::C3D8I, 15, 2, 2, &Hub::fixed(), 60);
}

#[test]
fn sector_large_enough_for_the_iteration() {
    agrees(ElementKind::C3D8, 8, 6, 4, &Hub::fixed(), 50);
}

#[test]
fn hub_free_to_turn_and_in_all_directions() {
    agrees(ElementKind::C3D8, 9, 2, 1, &Hub::turning(3e-5), 30);
    let all = Hub {
        motions: vec![
            HubMotion::Slide(Vec3::x()),
            HubMotion::Slide(Vec3::y()),
            HubMotion::Slide(Vec3::z()),
            HubMotion::TurnAbout(Vec3::x()),
            HubMotion::TurnAbout(Vec3::y()),
            HubMotion::Turn,
        ],
        added_inertia: vec![0.05, 0.05, 0.04, 2e-5, 2e-5, 3e-5],
    };
    agrees(ElementKind::C3D8, 10, 2, 1, &all, 40);
    agrees(ElementKind::C3D8, 8, 5, 3, &all, 30);
}

/// The hub of a ring with inner teeth is its rim, and the cuts of its sectors run from the rim inwards along a helix.
#[test]
fn inner_teeth_on_their_rim() {
    let of = |pitches| ring(ElementKind::C3D8I, (Teeth::Inside, 13), pitches, 3, 2);
    agree([&of(1), &of(13)], &Hub::turning(1e-3), 30);
}

#[test]
fn what_is_not_cyclic_is_declined() {
    let good = ring(ElementKind::C3D8, (Teeth::Outside, 12), 1, 2, 1);
    let run = |ring: &Ring, hub: &Hub, count| {
        lowest(
            &ring.as_sector(),
            &Material::STEEL,
            hub,
            count,
            &Options::default(),
        )
        .map(|_| ())
    };
    let declined = |r: Result<(), ModesError>, part: &str| {
        let text = r.unwrap_err().to_string();
        assert!(text.contains(part), "{text}");
    };
    let mut missing = good.clone();
    missing.mesh.node_sets.remove("cut_high");
    declined(run(&missing, &Hub::fixed(), 5), "cut_high");
    let mut moved = good.clone();
    let node = moved.mesh.node_sets["cut_high"][4] as usize;
    moved.mesh.nodes[node].z += 1e-4;
    declined(run(&moved, &Hub::fixed(), 5), "from the image");
    let one = Hub {
        motions: vec![HubMotion::Slide(Vec3::x())],
        added_inertia: vec![0.0],
    };
    declined(run(&good, &one, 5), "two perpendicular");
    declined(run(&good, &Hub::fixed(), 100_000), "ask for fewer");
    let few = Ring { sectors: 2, ..good };
    declined(run(&few, &Hub::fixed(), 5), "cyclic");
}
