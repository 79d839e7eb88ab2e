//! Own matrices come back from the formats of other programs, and damaged files are refused with their lines.

mod mutations;
mod printed;
mod refusals;

use super::*;
use crate::assembly::{Assembly, assemble};
use crate::deck::Deck;
use crate::gear_deck::{self, DeckGear};
use crate::gear_mesh::{self, GearMesh};
use crate::reduction::{Basis, ModeSelection, Mounting, Request};
use crate::test_support::{bare, coarse, stub};
use gearbench_models::Vec3;
use gearbench_models::gear::elastic::reduced::FlankCompliance;
use gearbench_models::stiffness::Material;
use printed::Files;

const STEEL: Material = Material::STEEL;

/// A gear with the deck that describes it.
struct Body {
    deck: Deck,
    gear: DeckGear,
    assembly: Assembly,
}

impl Body {
    fn of(deck: Deck) -> Self {
        let mut gears = gear_deck::gears_with(&deck, Some(STEEL)).unwrap();
        let gear = gears.swap_remove(0);
        // In the axes of the deck.
        let assembly = assemble(&deck.mesh(), &STEEL).unwrap();
        Body {
            deck,
            gear,
            assembly,
        }
    }

    /// Eight teeth of a coarse mesh in its own frame.
    fn small() -> Self {
        let own = gear_mesh::gear(&stub(8, 0.0), &coarse(1, 1)).unwrap();
        Body::of(bare(&own.mesh))
    }

    fn frame(&self) -> MeshFrame {
        MeshFrame::of(&self.deck, &self.gear).unwrap()
    }

    fn foreign(&self, names: &[&str], files: &Files) -> Result<ForeignBody, MatrixError> {
        let names: Vec<String> = names.iter().map(|n| (*n).to_owned()).collect();
        let read = read(&names, &mut |name| files.read(name))?;
        ForeignBody::new(Some(&read), None, &self.frame(), &self.gear.mesh, &STEEL)
    }

    fn basis(&self, foreign: Option<&ForeignBody>, mounting: Mounting, count: usize) -> Basis {
        basis(&self.gear.mesh, foreign, mounting, count)
    }
}

fn basis(
    mesh: &GearMesh,
    foreign: Option<&ForeignBody>,
    mounting: Mounting,
    count: usize,
) -> Basis {
    let request = Request {
        along_profile: false,
        foreign,
        mesh,
        sector: false,
        material: STEEL,
        mounting,
        wanted: ModeSelection::Count(count),
    };
    request.compute().unwrap()
}

/// Largest relative differences of frequencies and of compliances, the latter over the largest one.
fn differences(a: &Basis, b: &Basis) -> [f64; 2] {
    assert_eq!(a.omega.len(), b.omega.len());
    let relative = |(a, b): (&f64, &f64)| (a / b - 1.0).abs();
    let frequencies = a.omega.iter().zip(&b.omega).map(relative);
    let [x, y] = [a, b].map(|b| match &b.compliance.flanks {
        FlankCompliance::Full(c) => c.clone(),
        _ => panic!("the compliance is that of the whole mesh"),
    });
    let scale = x.iter().fold(0.0, |m: f64, c| m.max(c.abs()));
    let compliances = x.iter().zip(&y).map(|(x, y)| (x - y).abs() / scale);
    [
        frequencies.fold(0.0, f64::max),
        compliances.fold(0.0, f64::max),
    ]
}

/// All formats, with the digits that they print.
fn formats(a: &Assembly) -> Vec<(&'static str, &'static str, Files, f64)> {
    let market = "%%MatrixMarket matrix coordinate real general";
    vec![
        ("CalculiX", "g.sti", printed::calculix(a, "g"), 1e-13),
        (
            "Abaqus by nodes",
            "job_STIF1.mtx",
            printed::abaqus(a, "job"),
            1e-15,
        ),
        (
            "Abaqus by rows",
            "job_STIF2.mtx",
            printed::numbered(a, "job", ""),
            0.0,
        ),
        (
            "Matrix Market",
            "j_STIF2.mtx",
            printed::numbered(a, "j", market),
            0.0,
        ),
        ("Ansys", "w_stiff.hb", printed::ansys(a, "w"), 1e-15),
        (
            "numpy",
            "a.npz",
            Files::default().with("a.npz", printed::arrays(a, None)),
            0.0,
        ),
    ]
}

#[test]
fn matrices_come_back_from_every_format() {
    let body = Body::small();
    let own = body.basis(None, Mounting::gear(true, 1e-6), 20);
    for (name, file, files, digits) in formats(&body.assembly) {
        let foreign = body
            .foreign(&[file], &files)
            .unwrap_or_else(|e| panic!("{name}: {e}"));
        let found = foreign.assembly.as_ref().unwrap();
        let [a, b] = [&body.assembly, found].map(printed::entries);
        for (what, (a, b)) in ["stiffness", "mass"].iter().zip(a.iter().zip(&b)) {
            let scale = a.iter().fold(0.0, |m: f64, e| m.max(e.2.abs()));
            let values: HashMapOf = b.iter().map(|e| ((e.0, e.1), e.2)).collect();
            for (r, c, v) in a {
                let w = values.get(&(*r, *c)).copied().unwrap_or(0.0);
                let allowed = digits * v.abs() + 1e-15 * scale;
                assert!(
                    (v - w).abs() <= allowed,
                    "{name}: {what} ({r}, {c}): {v} {w}"
                );
            }
        }
        // The scale of lumped masses is that of the elements.
        for (a, b) in body.assembly.lumped.iter().zip(&found.lumped) {
            assert!((a / b - 1.0).abs() < 1e-9);
        }
        let again = body.basis(Some(&foreign), Mounting::gear(true, 1e-6), 20);
        let [f, c] = differences(&again, &own);
        assert!(
            f < 1e-9 && c < 1e-9,
            "{name}: frequencies {f:e}, compliances {c:e}"
        );
        assert_ne!(foreign.notes.len(), 0);
    }
}

type HashMapOf = std::collections::HashMap<(usize, usize), f64>;

/// The deck is elsewhere in space and in other units: the matrices are turned and scaled.
#[test]
fn matrices_follow_axes_and_units() {
    let own = gear_mesh::gear(&stub(8, 0.2), &coarse(1, 1)).unwrap();
    let strange = crate::recognise::tests::strange(
        &own.mesh,
        Vec3::new(0.4, 1.3, -2.0),
        Vec3::new(0.3, 0.2, 0.1),
    );
    let mut body = Body::of(bare(&strange));
    body.deck.units = crate::deck::Units::from_name("mm-t-s").unwrap();
    // N/mm and t in the file.
    let scaled = Assembly {
        stiffness: {
            let mut k = body.assembly.stiffness.clone();
            k.map(|b| b.map(|k| 1e-3 * k));
            k
        },
        mass: {
            let mut blocks = crate::assembly::BlockMatrix::zeros(std::sync::Arc::new(
                body.assembly.mass.pattern().clone(),
            ));
            for (row, column, place) in body.assembly.mass.pattern().iter() {
                let m = 1e-3 * body.assembly.mass.entries()[place];
                for axis in 0..3 {
                    blocks
                        .add_coordinates([(3 * row + axis) as u32, (3 * column + axis) as u32], m);
                }
            }
            blocks.scalars(|b| b[0])
        },
        lumped: body.assembly.lumped.clone(),
    };
    let files = printed::calculix(&scaled, "g");
    let foreign = body.foreign(&["g.sti"], &files).unwrap();
    let mount = Mounting::gear(true, 0.0).lateral([true, true, false, false, false, false]);
    for mounting in [
        Mounting::gear(true, 0.0),
        Mounting::gear(false, 0.0),
        mount.unwrap(),
    ] {
        let own = body.basis(None, mounting, 15);
        let again = body.basis(Some(&foreign), mounting, 15);
        let [f, c] = differences(&again, &own);
        assert!(f < 1e-9 && c < 1e-9, "frequencies {f:e}, compliances {c:e}");
        let [a, b] = [&own, &again].map(|b| b.integrals.as_ref().unwrap().tensor);
        assert!(
            a.iter()
                .zip(&b)
                .all(|(a, b)| (a - b).abs() < 1e-9 * a.abs().max(1e-6))
        );
    }
    // As SI units the mass is a thousandth.
    body.deck.units = crate::deck::Units::SI;
    let e = body.foreign(&["g.sti"], &files).unwrap_err().to_string();
    assert!(e.contains("g.mas") && e.contains("--units"), "{e}");
}

/// Coordinates inside of elements, as CalculiX has them for C3D8I: condensed they are those of the mesh.
#[test]
fn coordinates_inside_of_elements_are_condensed() {
    let body = Body::small();
    let mut files = printed::calculix(&body.assembly, "g");
    let size = 3 * body.assembly.lumped.len();
    // Two coordinates on nodes 1 and 2: [k_i b; b^T B] with B added such that the condensed stiffness is the own one.
    let k = [[4e8, 1e8], [1e8, 3e8]];
    let b = [[2e7, -1e7], [5e6, 3e7]];
    let inverse = nalgebra::Matrix2::new(k[0][0], k[0][1], k[1][0], k[1][1])
        .try_inverse()
        .unwrap();
    let b_matrix = nalgebra::Matrix2::new(b[0][0], b[0][1], b[1][0], b[1][1]);
    let added = b_matrix.transpose() * inverse * b_matrix;
    let text = String::from_utf8(files.read("g.sti").unwrap()).unwrap();
    let mut lines: Vec<String> = Vec::new();
    let places = [0, 4];
    for line in text.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        let place = |w: &str| {
            places
                .iter()
                .position(|p| p + 1 == w.parse::<usize>().unwrap())
        };
        match (place(words[0]), place(words[1])) {
            (Some(i), Some(j)) => {
                let value: f64 = words[2].parse::<f64>().unwrap() + added[(i, j)];
                lines.push(format!("{} {} {value:e}", words[0], words[1]));
            }
            _ => lines.push(line.to_owned()),
        }
    }
    for i in 0..2 {
        for j in i..2 {
            lines.push(format!("{} {} {:e}", size + 1 + i, size + 1 + j, k[i][j]));
        }
        for (j, place) in places.iter().enumerate() {
            lines.push(format!("{} {} {:e}", place + 1, size + 1 + i, b[i][j]));
        }
    }
    let coordinates = String::from_utf8(files.read("g.dof").unwrap()).unwrap();
    let inner = body.assembly.lumped.len() + 1;
    files = files
        .with("g.sti", lines.join("\n"))
        .with("g.dof", format!("{coordinates}{inner}.1\n{inner}.2\n"));
    let foreign = body.foreign(&["g.sti"], &files).unwrap();
    assert!(
        foreign.notes[0].contains("2 coordinates inside of 1 elements"),
        "{:?}",
        foreign.notes
    );
    let [own, again] = [None, Some(&foreign)].map(|f| body.basis(f, Mounting::gear(true, 0.0), 15));
    let [f, c] = differences(&again, &own);
    assert!(f < 1e-9 && c < 1e-9, "frequencies {f:e}, compliances {c:e}");
}

/// Shapes of the body with fixed bore at all nodes, and their frequencies.
fn held_shapes(body: &Body, count: usize) -> (Vec<Vec<f64>>, Vec<f64>) {
    use crate::assembly::tie::{MassKind, Tie};
    let mesh = &body.gear.mesh;
    let tie = Tie::new(&mesh.mesh.nodes, &mesh.bore, &[]);
    let reduced = tie.reduce(&body.assembly, &[], MassKind::Consistent);
    let found = crate::modes::lowest(&reduced, count, &crate::modes::Options::default()).unwrap();
    let shapes = (0..count).map(|mode| {
        let mut full = vec![0.0; 3 * mesh.mesh.nodes.len()];
        let vector: Vec<f64> = found.vectors.col(mode).iter().copied().collect();
        tie.expand(&vector, &mut full);
        full
    });
    (shapes.collect(), found.frequencies())
}

/// Printed shapes of a held bore: the same modes on a held mount, with the printed digits squared as error of the
/// frequencies, and those of a Craig-Bampton basis on a free mount.
#[test]
fn shapes_that_programs_print_span_the_modes() {
    let body = Body::small();
    let (shapes, frequencies) = held_shapes(&body, 40);
    let files = Files::default()
        .with("g.frd", printed::frd(&shapes, &frequencies))
        .with("g.dat", printed::dat(&shapes, &frequencies))
        .with("job.dat", printed::abaqus_dat(&shapes, &frequencies))
        .with("s.npz", printed::arrays(&body.assembly, Some(&shapes)));
    for (name, digits) in [
        ("g.frd", 1e-5),
        ("g.dat", 1e-6),
        ("job.dat", 1e-4),
        ("s.npz", 1e-12),
    ] {
        let read =
            read_shapes(name, &mut |name| files.read(name)).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(
            (read.values.ncols(), read.frequencies.len()),
            (40, 40),
            "{name}"
        );
        if name != "s.npz" {
            for (a, b) in read.frequencies.iter().zip(&frequencies) {
                assert!((a / b - 1.0).abs() < 1e-4, "{name}: {a} {b}");
            }
        }
        let foreign = ForeignBody::new(None, Some(&read), &body.frame(), &body.gear.mesh, &STEEL);
        let foreign = foreign.unwrap();
        let held = Mounting::gear(false, 0.0);
        let [own, again] = [None, Some(&foreign)].map(|f| body.basis(f, held, 40));
        for (a, b) in again.omega.iter().zip(&own.omega) {
            assert!(
                (a / b - 1.0).abs() < 100.0 * digits * digits + 1e-9,
                "{name}: {a} {b}"
            );
        }
        let free = Mounting::gear(true, 0.0);
        let [own, again] = [None, Some(&foreign)].map(|f| body.basis(f, free, 10));
        for (a, b) in again.omega.iter().zip(&own.omega) {
            assert!((-1e-9..1e-2).contains(&(a / b - 1.0)), "{name}: {a} {b}");
        }
        // The static compliance does not depend on the modes.
        assert!(differences(&again, &own)[1] < 1e-12);
    }
}
