//! Matrices and shapes of another program over the nodes of a gear, in its own frame and in SI units.
//!
//! With the rotation `Q` from the axes of the file to those of the gear, `K_ab <- Q K_ab Q^T` for every pair of nodes.
//! Coordinates `i` of nodes that the deck does not have belong to the elements: CalculiX gives those with incompatible
//! modes (C3D8I) three nodes of their own. They are condensed statically, group by group,
//!
//! ```text
//! K <- K_nn - K_ni K_ii^-1 K_in,     M <- M_nn
//! ```
//!
//! and their mass is left out: shape functions of the nodes alone carry the whole mass, incompatible modes bend elements
//! and have no inertia (E. L. Wilson, R. L. Taylor, W. P. Doherty, J. Ghaboussi 1973).
//!
//! The mass has to be the same along all axes, and the stiffness that of an unconstrained body.

use super::error::{MatrixError, MatrixErrorKind, refused};
use super::{Coordinate, Shapes, SymmetricEntries, SystemMatrices};
use crate::assembly::{Assembly, BlockMatrix, Pattern, ScalarMatrix};
use crate::deck::{Deck, Units};
use crate::gear_deck::DeckGear;
use crate::gear_mesh::GearMesh;
use crate::hash::Hash;
use crate::mesh::quality;
use faer::Mat;
use gearbench_models::Vec3;
use gearbench_models::stiffness::Material;
use nalgebra::{DMatrix, Matrix3};
use std::collections::HashMap;
use std::sync::Arc;

/// Largest force of a rigid motion, relative to that of moving a node alone: rounding of printed digits is far below,
/// and a spring or a constraint far above.
const RIGID: f64 = 1e-6;

/// Largest relative difference of the mass along two axes.
const ISOTROPIC: f64 = 1e-6;

/// Largest relative difference of the mass from that of the mesh: sets of units differ by a factor of 10 or more,
/// integration of curved elements by a fraction of this.
const MASS: f64 = 0.02;

/// Most coordinates of a group that is condensed.
const MOST_CONDENSED: usize = 400;

/// Place of a gear in a deck: labels of its nodes, its axes, the units.
#[derive(Clone, Debug)]
pub struct MeshFrame {
    /// Label of each node of the mesh.
    labels: Vec<u32>,
    /// Labels of the other nodes of the deck.
    others: Vec<u32>,
    /// From the axes of the deck to those of the gear.
    rotation: Matrix3<f64>,
    units: Units,
}

impl MeshFrame {
    /// The place of a gear of a deck.
    ///
    /// # Errors
    /// A deck of several instances, whose labels occur more than once.
    pub fn of(deck: &Deck, gear: &DeckGear) -> Result<Self, MatrixError> {
        if deck.instances.len() > 1 {
            let expected = "one instance in the assembly";
            let found = deck.instances.len().to_string();
            let help = "write the matrices of each part on its own; labels of instances occur more than once";
            return Err(refused(
                MatrixErrorKind::Mesh,
                &deck.name,
                expected,
                found,
                help,
            ));
        }
        let own: Vec<u32> = gear.nodes.clone();
        let mut is_own = vec![false; deck.nodes.len()];
        own.iter().for_each(|n| is_own[*n as usize] = true);
        let label = |n: usize| deck.node_labels[n].number;
        Ok(MeshFrame {
            labels: own.iter().map(|n| label(*n as usize)).collect(),
            others: (0..is_own.len())
                .filter(|n| !is_own[*n])
                .map(label)
                .collect(),
            rotation: gear.rotation().transpose(),
            units: deck.units,
        })
    }
}

/// Matrices and shapes of another program for a mesh.
#[derive(Clone, Debug)]
pub struct ForeignBody {
    /// Stiffness and mass; `None` where they are those of the elements of gearbench.
    pub assembly: Option<Assembly>,
    /// Shapes at all nodes, three rows each, of any scale; `None` where modes are computed from the matrices.
    pub shapes: Option<Mat<f64>>,
    /// Frequencies that belong to the shapes [Hz]; NaN where the file states none.
    pub frequencies: Vec<f64>,
    /// Hash of the data.
    pub hash: Hash,
    /// Taken and assumed data, a sentence each.
    pub notes: Vec<String>,
}

/// Meaning of a coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Place {
    /// Displacement of the mesh, three per node.
    Mesh(u32),
    /// Coordinate inside of elements.
    Inside(u32),
    /// A node of another body, or one without a stiffness here.
    Other,
}

impl ForeignBody {
    /// Brings matrices and shapes, at least one of them, to a mesh.
    ///
    /// # Errors
    /// Data that do not belong to the mesh or are not those of an unconstrained elastic body.
    pub fn new(
        matrices: Option<&SystemMatrices>,
        shapes: Option<&Shapes>,
        frame: &MeshFrame,
        gear: &GearMesh,
        material: &Material,
    ) -> Result<Self, MatrixError> {
        let mut hash = Hash::START;
        let mut notes = Vec::new();
        let assembly = match matrices {
            Some(matrices) => Some(matrices.on_mesh(frame, gear, material, &mut hash, &mut notes)?),
            None => {
                notes.push("matrices: those of the elements of gearbench".to_owned());
                None
            }
        };
        let placed = match shapes {
            Some(shapes) => Some(shapes.on_mesh(frame, gear, &mut hash, &mut notes)?),
            None => None,
        };
        let frequencies = shapes.map_or(&[][..], |s| &s.frequencies);
        Ok(ForeignBody {
            assembly,
            shapes: placed,
            frequencies: frequencies.iter().map(|f| f / frame.units.time).collect(),
            hash,
            notes,
        })
    }
}

/// Index of each coordinate of a mesh.
fn places(
    coordinates: &[Coordinate],
    frame: &MeshFrame,
    file: &str,
) -> Result<(Vec<Place>, usize), MatrixError> {
    let own: HashMap<u32, u32> = (frame.labels.iter().copied()).zip(0..).collect();
    let other: std::collections::HashSet<u32> = frame.others.iter().copied().collect();
    let mut seen = vec![false; 3 * frame.labels.len()];
    let mut inside = 0;
    let mut all = Vec::with_capacity(coordinates.len());
    for c in coordinates {
        let place = match own.get(&c.node) {
            Some(node) if c.direction <= 3 => {
                let place = 3 * node + u32::from(c.direction) - 1;
                if std::mem::replace(&mut seen[place as usize], true) {
                    let found = format!("direction {} of node {} twice", c.direction, c.node);
                    let expected = "each coordinate once";
                    return Err(refused(MatrixErrorKind::Mesh, file, expected, found, ""));
                }
                Place::Mesh(place)
            }
            Some(_) => {
                let found = format!("rotation {} of node {}", c.direction - 3, c.node);
                let help = "solid elements alone: shells, beams and rigid bodies are not read";
                let expected = "displacements only";
                return Err(refused(MatrixErrorKind::Mesh, file, expected, found, help));
            }
            None if other.contains(&c.node) => Place::Other,
            None => {
                inside += 1;
                Place::Inside(inside - 1)
            }
        };
        all.push(place);
    }
    if let Some(missing) = seen.iter().position(|s| !s) {
        let (node, direction) = (frame.labels[missing / 3], missing % 3 + 1);
        let help = "boundary conditions, ties, equations and rigid bodies remove coordinates: leave them out of the step that \
                    writes the matrices; or the deck is another one";
        return Err(refused(
            MatrixErrorKind::Mesh,
            file,
            "three displacements of every node of the mesh",
            format!("none in direction {direction} of node {node}"),
            help,
        ));
    }
    Ok((all, inside as usize))
}

/// Entries over the coordinates of a mesh, and those that are condensed.
struct Split {
    /// Between displacements of the mesh, the lower number first.
    mesh: Vec<(u32, u32, f64)>,
    /// Between a displacement of the mesh and one inside.
    across: Vec<(u32, u32, f64)>,
    inside: Vec<(u32, u32, f64)>,
}

fn split(entries: &SymmetricEntries, places: &[Place], file: &str) -> Result<Split, MatrixError> {
    let mut split = Split {
        mesh: Vec::with_capacity(entries.0.len()),
        across: Vec::new(),
        inside: Vec::new(),
    };
    for &(row, column, value) in &entries.0 {
        match (places[row as usize], places[column as usize]) {
            (Place::Mesh(a), Place::Mesh(b)) => split.mesh.push((a.min(b), a.max(b), value)),
            (Place::Mesh(a), Place::Inside(i)) | (Place::Inside(i), Place::Mesh(a)) => {
                split.across.push((a, i, value));
            }
            (Place::Inside(i), Place::Inside(j)) => {
                split.inside.push((i.min(j), i.max(j), value));
            }
            (Place::Other, Place::Other) => {}
            _ if value == 0.0 => {}
            _ => {
                let found = format!("{value:e} between rows {} and {}", row + 1, column + 1);
                let help = "bodies that are connected by ties, springs or contact cannot be reduced one by one";
                let expected = "no entries between this body and another";
                return Err(refused(MatrixErrorKind::Mesh, file, expected, found, help));
            }
        }
    }
    Ok(split)
}

/// Condenses the coordinates inside of elements; returns the number of groups.
fn condense(split: &mut Split, count: usize, file: &str) -> Result<usize, MatrixError> {
    if count == 0 {
        return Ok(0);
    }
    // Coordinates that are joined by an entry have the same root.
    let mut root: Vec<u32> = (0..count as u32).collect();
    fn find(root: &mut [u32], mut i: u32) -> u32 {
        while root[i as usize] != i {
            root[i as usize] = root[root[i as usize] as usize];
            i = root[i as usize];
        }
        i
    }
    for &(i, j, value) in &split.inside {
        if value != 0.0 {
            let (a, b) = (find(&mut root, i), find(&mut root, j));
            root[a.max(b) as usize] = a.min(b);
        }
    }
    let mut group_of = vec![(0, 0); count];
    let mut members: Vec<Vec<u32>> = Vec::new();
    let mut number: HashMap<u32, usize> = HashMap::new();
    for i in 0..count as u32 {
        let group = *number.entry(find(&mut root, i)).or_insert_with(|| {
            members.push(Vec::new());
            members.len() - 1
        });
        group_of[i as usize] = (group, members[group].len());
        members[group].push(i);
    }
    let body = MatrixErrorKind::Body;
    if let Some(large) = members.iter().find(|m| m.len() > MOST_CONDENSED) {
        let help = "coordinates of nodes that the deck does not have are condensed where they belong to single elements";
        let expected = format!("groups of at most {MOST_CONDENSED} coordinates inside of elements");
        return Err(refused(body, file, expected, large.len().to_string(), help));
    }
    let mut square: Vec<DMatrix<f64>> = (members.iter())
        .map(|m| DMatrix::zeros(m.len(), m.len()))
        .collect();
    for &(i, j, value) in &split.inside {
        let ((group, a), (other, b)) = (group_of[i as usize], group_of[j as usize]);
        if group == other {
            (square[group][(a, b)], square[group][(b, a)]) = (value, value);
        }
    }
    let mut around: Vec<HashMap<u32, Vec<f64>>> = vec![HashMap::new(); members.len()];
    for &(a, i, value) in split.across.iter().filter(|e| e.2 != 0.0) {
        let (group, place) = group_of[i as usize];
        let size = members[group].len();
        let column = around[group].entry(a).or_insert_with(|| vec![0.0; size]);
        column[place] = value;
    }
    for (group, (square, around)) in square.into_iter().zip(around).enumerate() {
        let size = members[group].len();
        let Some(factor) = square.cholesky() else {
            let found = format!("a group of {size} coordinates that is not");
            let help =
                "Lagrange multipliers of hybrid elements and of constraints cannot be condensed";
            let expected = "a positive definite stiffness inside of elements";
            return Err(refused(body, file, expected, found, help));
        };
        let mut nodes: Vec<(u32, Vec<f64>)> = around.into_iter().collect();
        nodes.sort_by_key(|n| n.0);
        let coupling = DMatrix::from_fn(size, nodes.len(), |i, j| nodes[j].1[i]);
        let response = factor.solve(&coupling);
        let lost = coupling.transpose() * response;
        for (i, (a, _)) in nodes.iter().enumerate() {
            for (j, (b, _)) in nodes.iter().enumerate().skip(i) {
                split.mesh.push((*a, *b, -lost[(i, j)]));
            }
        }
    }
    Ok(members.len())
}

impl SystemMatrices {
    /// The matrices over the nodes of a mesh.
    fn on_mesh(
        &self,
        frame: &MeshFrame,
        gear: &GearMesh,
        material: &Material,
        hash: &mut Hash,
        notes: &mut Vec<String>,
    ) -> Result<Assembly, MatrixError> {
        let file = self.files.first().map_or("", String::as_str);
        let nodes = gear.mesh.nodes.len();
        let ordered;
        let coordinates = match &self.coordinates {
            Some(coordinates) => coordinates,
            None => {
                // Three rows for each node of the deck, in ascending order of the labels.
                let mut labels: Vec<u32> =
                    frame.labels.iter().chain(&frame.others).copied().collect();
                labels.sort_unstable();
                if self.size != 3 * labels.len() {
                    let expected =
                        format!("{} rows, three for each node of the deck", 3 * labels.len());
                    let help = "give the coordinates of the rows as a third file, or let Abaqus write FORMAT=MATRIX INPUT";
                    let found = self.size.to_string();
                    return Err(refused(MatrixErrorKind::Mesh, file, expected, found, help));
                }
                notes.push("rows: three for each node in ascending order of the labels".to_owned());
                let three =
                    |node: u32| (1..=3).map(move |direction| Coordinate { node, direction });
                ordered = labels.into_iter().flat_map(three).collect();
                &ordered
            }
        };
        let (places, inside) = places(coordinates, frame, file)?;
        let mut stiffness = split(&self.stiffness, &places, file)?;
        let mass_file = self.files.get(1).map_or(file, String::as_str);
        let mass = split(&self.mass, &places, mass_file)?;
        let groups = condense(&mut stiffness, inside, file)?;
        notes.push(format!(
            "matrices: {} rows of {}{}",
            coordinates.len(),
            self.files.join(", "),
            match inside {
                0 => String::new(),
                n => format!(
                    "; {n} coordinates inside of {groups} elements are condensed statically, without their mass"
                ),
            }
        ));
        for (row, column, value) in self.stiffness.0.iter().chain(&self.mass.0) {
            hash.count(*row as usize);
            hash.count(*column as usize);
            hash.number(*value);
        }
        frame.rotation.iter().for_each(|x| hash.number(*x));
        coordinates.iter().for_each(|c| {
            hash.count(c.node as usize);
            hash.count(usize::from(c.direction));
        });

        let all = stiffness.mesh.iter().chain(&mass.mesh);
        let pairs = all.map(|(a, b, _)| (a / 3, b / 3)).collect();
        let pattern = Arc::new(Pattern::of_pairs(nodes, pairs));
        let blocks = |entries: &[(u32, u32, f64)], scale: f64| {
            let mut matrix = BlockMatrix::zeros(pattern.clone());
            for (a, b, value) in entries {
                matrix.add_coordinates([*a, *b], scale * value);
            }
            matrix
        };
        let u = &frame.units;
        let mut stiffness = blocks(&stiffness.mesh, u.mass / (u.time * u.time));
        if frame.rotation != Matrix3::identity() {
            let q = frame.rotation;
            stiffness.map(|block| {
                let turned = q * Matrix3::from_row_slice(block) * q.transpose();
                std::array::from_fn(|k| turned[(k / 3, k % 3)])
            });
        }
        let mass = scalar(&blocks(&mass.mesh, u.mass), frame, mass_file)?;
        check_mass(&mass, gear, material, mass_file)?;
        let rigid = check_rigid(&stiffness, &gear.mesh.nodes, file)?;
        notes.push(format!(
            "stiffness: rigid motions give at most {rigid:.1e} of the force of a single node"
        ));
        let ones = vec![1.0; 3 * nodes];
        let mut lumped = vec![0.0; 3 * nodes];
        mass.apply(&ones, &mut lumped);
        Ok(Assembly {
            stiffness,
            mass,
            lumped: lumped.into_iter().step_by(3).collect(),
        })
    }
}

/// A mass matrix as one number for each pair of nodes.
fn scalar(mass: &BlockMatrix, frame: &MeshFrame, file: &str) -> Result<ScalarMatrix, MatrixError> {
    let pattern = mass.pattern();
    let largest = mass.entries().iter().map(|m| m[0].abs().max(m[4].abs()));
    let scale = largest.fold(0.0, f64::max);
    for (row, column, place) in pattern.iter() {
        let m = &mass.entries()[place];
        let mean = (m[0] + m[4] + m[8]) / 3.0;
        let odd = (m.iter().enumerate()).map(|(k, m)| {
            let diagonal = k % 4 == 0;
            (m - if diagonal { mean } else { 0.0 }).abs()
        });
        let odd = odd.fold(0.0, f64::max);
        if odd > ISOTROPIC * scale {
            let [a, b] = [row, column].map(|n| frame.labels[n]);
            let found = format!("a difference of {odd:e} between nodes {a} and {b}");
            let help =
                "rotary inertia, masses of single directions and condensed bodies are not used";
            let expected = "a mass that is the same along all three axes";
            return Err(refused(MatrixErrorKind::Body, file, expected, found, help));
        }
    }
    Ok(mass.scalars(|m| (m[0] + m[4] + m[8]) / 3.0))
}

/// Compares the mass with that of the mesh, which catches other units and other bodies.
fn check_mass(
    mass: &ScalarMatrix,
    gear: &GearMesh,
    material: &Material,
    file: &str,
) -> Result<(), MatrixError> {
    let n = 3 * gear.mesh.nodes.len();
    let mut image = vec![0.0; n];
    mass.apply(&vec![1.0; n], &mut image);
    let found: f64 = image.iter().step_by(3).sum();
    let expected = material.density * quality(&gear.mesh).volume;
    if (found / expected - 1.0).abs() <= MASS {
        return Ok(());
    }
    Err(refused(
        MatrixErrorKind::Body,
        file,
        format!(
            "the mass of the mesh, {expected:.4e} kg (density {} kg/m^3)",
            material.density
        ),
        format!("{found:.4e} kg"),
        "check the units (--units) and the density (--density), and that both files are of this deck",
    ))
}

/// Largest force of a rigid motion relative to that of moving a node alone as far.
fn check_rigid(stiffness: &BlockMatrix, nodes: &[Vec3], file: &str) -> Result<f64, MatrixError> {
    let diagonal = (stiffness.pattern().iter())
        .filter(|(row, column, _)| row == column)
        .map(|(_, _, place)| {
            let k = &stiffness.entries()[place];
            k[0].abs().max(k[4].abs()).max(k[8].abs())
        });
    let scale = diagonal.fold(0.0, f64::max);
    let (mut u, mut force) = (vec![0.0; 3 * nodes.len()], vec![0.0; 3 * nodes.len()]);
    let mut worst: (f64, &str) = (0.0, "");
    let names = [
        "displacement along x",
        "displacement along y",
        "displacement along z",
        "rotation about x",
        "rotation about y",
        "rotation about z",
    ];
    for (motion, name) in names.into_iter().enumerate() {
        let mut axis = Vec3::zeros();
        axis[motion % 3] = 1.0;
        for (u, x) in u.chunks_exact_mut(3).zip(nodes) {
            let moved = if motion < 3 { axis } else { axis.cross(x) };
            u.copy_from_slice(moved.as_slice());
        }
        let size = u.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        stiffness.apply(&u, &mut force);
        let largest = force.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        let relative = largest / (scale * size);
        if relative > worst.0 || !relative.is_finite() {
            worst = (relative, name);
        }
    }
    if worst.0 <= RIGID {
        return Ok(worst.0);
    }
    Err(refused(
        MatrixErrorKind::Body,
        file,
        format!(
            "the stiffness of an unconstrained body: forces of a rigid motion below {RIGID:e} of that of a single node"
        ),
        format!("{:.1e} for a {}", worst.0, worst.1),
        "leave springs, boundary conditions and large displacements out of the step that writes the matrices; or the deck is another one",
    ))
}

impl Shapes {
    /// The shapes at the nodes of a mesh, in its axes.
    fn on_mesh(
        &self,
        frame: &MeshFrame,
        gear: &GearMesh,
        hash: &mut Hash,
        notes: &mut Vec<String>,
    ) -> Result<Mat<f64>, MatrixError> {
        let (places, _) = places(&self.coordinates, frame, &self.file)?;
        let modes = self.values.ncols();
        let mut shapes = Mat::zeros(3 * gear.mesh.nodes.len(), modes);
        for (row, place) in places.iter().enumerate() {
            if let Place::Mesh(at) = place {
                for mode in 0..modes {
                    shapes[(*at as usize, mode)] = self.values[(row, mode)];
                }
            }
        }
        if frame.rotation != Matrix3::identity() {
            for mode in 0..modes {
                for node in 0..gear.mesh.nodes.len() {
                    let u = Vec3::from_fn(|k, _| shapes[(3 * node + k, mode)]);
                    let turned = frame.rotation * u;
                    for k in 0..3 {
                        shapes[(3 * node + k, mode)] = turned[k];
                    }
                }
            }
        }
        for mode in 0..modes {
            shapes.col(mode).iter().for_each(|x| hash.number(*x));
        }
        notes.push(format!("shapes: {modes} of {}", self.file));
        Ok(shapes)
    }
}
