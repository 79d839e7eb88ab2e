//! The sector: its matrices split by the phase of the cuts, and the matrices of one harmonic.
//!
//! With the nodes of `cut_high` expressed by those of `cut_low` every block of the harmonic's stiffness is
//! `A + B exp(i mu) + C exp(-i mu)` with real A, B, C, collected once; a harmonic is then a sum.

mod hub;

use super::Hub;
use crate::Material;
use crate::assembly::{Assembly, assemble};
use crate::mesh::Mesh;
use crate::modes::ModesError;
use crate::solve::{Scalar, SolveError, Symbolic};
use crate::vector::turned;
use faer::c64;
use faer::sparse::{SparseColMat, SymbolicSparseColMat};
use hub::{Motion, motions};
use std::collections::BTreeMap;

pub(super) const HELD: u32 = u32::MAX;
/// Cuts may mismatch by this fraction of a node's radius.
const CUT_TOLERANCE: f64 = 1e-6;

/// A real matrix of three axes, row by row.
type Block = [f64; 9];

/// Parts of a block: without phase, with `exp(i mu)`, with `exp(-i mu)`.
type PhaseBlocks = [Block; 3];

/// Mesh of one of the equal sectors that a body with cyclic symmetry about z consists of.
#[derive(Clone, Copy, Debug)]
pub struct SectorMesh<'a> {
    /// Nodes and elements. The node sets `cut_low` and `cut_high` are the cuts to the neighbours: node `i` of `cut_high`
    /// is node `i` of `cut_low`, rotated by one pitch.
    pub mesh: &'a Mesh,
    /// Number of sectors of the whole body.
    pub sectors: u32,
    /// Nodes that are rigidly tied to the hub.
    pub bore: &'a [u32],
}

/// One sector of a body, ready for any harmonic.
#[derive(Clone, Debug)]
pub struct Sector {
    sectors: u32,
    pub(super) assembly: Assembly,
    /// Per node of the sector its free node and whether it is that node's image on the high cut.
    pub(super) place: Vec<(u32, bool)>,
    free: usize,
    /// Pairs of free nodes, the column's first: lower triangle of nodes.
    pairs: Vec<(u32, u32)>,
    stiffness: Vec<PhaseBlocks>,
    mass: Vec<PhaseBlocks>,
    motions: Vec<Motion>,
}

/// Stiffness and mass of a harmonic, lower triangles of the same pattern.
#[derive(Clone, Debug)]
pub(super) struct Pair<T> {
    pub stiffness: SparseColMat<usize, T>,
    pub mass: SparseColMat<usize, T>,
}

/// Where an entry of a harmonic's matrices comes from.
enum Source {
    /// A pair of free nodes, and the place in its block.
    Pair(usize, usize),
    /// The row of a hub motion, and the unknown.
    Hub(usize, usize),
}

fn sector_error(text: impl Into<String>) -> ModesError {
    ModesError::Sector(text.into())
}

/// Returns the product `A^T B`.
fn transposed_times(a: &Block, b: &Block) -> Block {
    std::array::from_fn(|k| (0..3).map(|l| a[3 * l + k / 3] * b[3 * l + k % 3]).sum())
}

/// Returns the product `A B`.
fn times(a: &Block, b: &Block) -> Block {
    std::array::from_fn(|k| (0..3).map(|l| a[3 * (k / 3) + l] * b[3 * l + k % 3]).sum())
}

fn transposed(a: &Block) -> Block {
    std::array::from_fn(|k| a[3 * (k % 3) + k / 3])
}

impl Sector {
    /// Assembles a sector with node sets `cut_low` and `cut_high`; its bore is tied to the hub.
    pub fn new(of: &SectorMesh<'_>, material: &Material, hub: &Hub) -> Result<Self, ModesError> {
        let SectorMesh {
            mesh,
            sectors,
            bore,
        } = *of;
        if sectors < 3 {
            return Err(sector_error(format!(
                "a gear of {sectors} sectors has no cyclic harmonics: use the modes of a whole mesh"
            )));
        }
        let set = |name: &str| {
            mesh.node_sets.get(name).ok_or_else(|| {
                sector_error(format!(
                    "node set `{name}` is missing: mesh the gear with the sector option"
                ))
            })
        };
        let (low, high) = (set("cut_low")?, set("cut_high")?);
        if low.len() != high.len() || low.is_empty() {
            return Err(sector_error(format!(
                "cut_low has {} nodes, cut_high {}: they must be images of each other",
                low.len(),
                high.len()
            )));
        }
        let pitch = std::f64::consts::TAU / f64::from(sectors);
        let mut is_bore = vec![false; mesh.nodes.len()];
        for &node in bore {
            is_bore[node as usize] = true;
        }
        let mut image_of = BTreeMap::new();
        for (&a, &b) in low.iter().zip(high) {
            let (from, to) = (mesh.nodes[a as usize], mesh.nodes[b as usize]);
            let miss = (turned(from, pitch) - to).norm();
            if miss > CUT_TOLERANCE * from.norm() {
                return Err(sector_error(format!(
                    "node {b} of cut_high is {miss:.2e} m from the image of node {a} of cut_low"
                )));
            }
            if is_bore[a as usize] != is_bore[b as usize] {
                return Err(sector_error(format!(
                    "the bore holds only one of the images {a} and {b} on the cuts"
                )));
            }
            image_of.insert(b, a);
        }
        let mut place = vec![(HELD, false); mesh.nodes.len()];
        let mut free = 0;
        for node in 0..mesh.nodes.len() as u32 {
            if !is_bore[node as usize] && !image_of.contains_key(&node) {
                place[node as usize].0 = free;
                free += 1;
            }
        }
        for (&b, &a) in &image_of {
            place[b as usize] = (place[a as usize].0, true);
        }
        let assembly = assemble(mesh, material).map_err(|e| sector_error(e.to_string()))?;
        let motions = motions(hub, &mesh.nodes, &is_bore, sectors)?;
        let mut sector = Self {
            sectors,
            assembly,
            place,
            free: free as usize,
            pairs: Vec::new(),
            stiffness: Vec::new(),
            mass: Vec::new(),
            motions,
        };
        sector.collect(pitch);
        Ok(sector)
    }

    /// Returns the number of sectors of the whole body.
    pub fn sectors(&self) -> u32 {
        self.sectors
    }

    /// Returns the number of unknowns of one harmonic, without hub motions.
    pub fn unknowns(&self) -> usize {
        3 * self.free
    }

    /// Displacements of all nodes of the sector, three each.
    pub(super) fn displacements(&self) -> usize {
        3 * self.place.len()
    }

    /// Hub coordinates of a harmonic.
    pub(super) fn hub_coordinates(&self, harmonic: u32) -> usize {
        self.motions_of(harmonic).count()
    }

    fn motions_of(&self, harmonic: u32) -> impl Iterator<Item = &Motion> {
        self.motions.iter().filter(move |m| m.harmonic == harmonic)
    }

    /// Returns the angle from one sector to the next in a harmonic.
    pub(super) fn phase(&self, harmonic: u32) -> f64 {
        std::f64::consts::TAU * f64::from(harmonic) / f64::from(self.sectors)
    }

    /// Splits the blocks of the assembly by phase.
    fn collect(&mut self, pitch: f64) {
        let (s, c) = pitch.sin_cos();
        let rotation: Block = [c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0];
        // Contributions as (column, row, phase, transposed, place).
        let mut parts: Vec<(u32, u32, usize, Block, Block)> = Vec::new();
        let masses = self.assembly.mass.entries();
        for ((a, b, at), block) in self
            .assembly
            .stiffness
            .pattern()
            .iter()
            .zip(self.assembly.stiffness.entries())
        {
            let ((pa, high_a), (pb, high_b)) = (self.place[a], self.place[b]);
            if pa == HELD || pb == HELD {
                continue;
            }
            let mut k = *block;
            let mut m: Block = [0.0; 9];
            (m[0], m[4], m[8]) = (masses[at], masses[at], masses[at]);
            for block in [&mut k, &mut m] {
                if high_a {
                    *block = transposed_times(&rotation, block);
                }
                if high_b {
                    *block = times(block, &rotation);
                }
            }
            // The block stands at row a, column b, and carries exp(i mu) once for b, its conjugate for a.
            let phase = match (high_a, high_b) {
                (false, true) => 1,
                (true, false) => 2,
                _ => 0,
            };
            let opposite = [0, 2, 1][phase];
            if pa >= pb {
                parts.push((pb, pa, phase, k, m));
            }
            if pa < pb || (pa == pb && a != b) {
                parts.push((pa, pb, opposite, transposed(&k), transposed(&m)));
            }
        }
        parts.sort_by_key(|p| (p.0, p.1));
        for (column, row, phase, k, m) in parts {
            if self.pairs.last() != Some(&(column, row)) {
                self.pairs.push((column, row));
                self.stiffness.push([[0.0; 9]; 3]);
                self.mass.push([[0.0; 9]; 3]);
            }
            let last = self.pairs.len() - 1;
            for i in 0..9 {
                self.stiffness[last][phase][i] += k[i];
                self.mass[last][phase][i] += m[i];
            }
        }
    }

    /// Analysis of the pattern that all harmonics without hub motions have.
    pub(super) fn symbolic(&self) -> Result<Symbolic, SolveError> {
        let (pattern, _) = self.pattern(&[]);
        Symbolic::new(pattern.as_ref())
    }

    /// Lower triangle of a harmonic and where its entries come from; `hub` rows follow in the columns where they have an
    /// entry.
    fn pattern(&self, hub: &[Vec<[c64; 2]>]) -> (SymbolicSparseColMat<usize>, Vec<Source>) {
        let own = 3 * self.free;
        let (mut start, mut rows, mut sources) = (vec![0], Vec::new(), Vec::new());
        let mut first = 0;
        for column in 0..self.free {
            let count = self.pairs[first..]
                .iter()
                .take_while(|p| p.0 as usize == column)
                .count();
            for axis in 0..3 {
                for pair in first..first + count {
                    let row = self.pairs[pair].1 as usize;
                    let from = if row == column { axis } else { 0 };
                    rows.extend((from..3).map(|i| 3 * row + i));
                    sources.extend((from..3).map(|i| Source::Pair(pair, 3 * i + axis)));
                }
                let at = 3 * column + axis;
                for (h, entries) in hub.iter().enumerate() {
                    if entries[at].iter().any(|e| e.norm_sqr() != 0.0) {
                        rows.push(own + h);
                        sources.push(Source::Hub(h, at));
                    }
                }
                start.push(rows.len());
            }
            first += count;
        }
        for h in 0..hub.len() {
            rows.extend((h..hub.len()).map(|l| own + l));
            sources.extend((h..hub.len()).map(|l| Source::Hub(l, own + h)));
            start.push(rows.len());
        }
        let n = own + hub.len();
        let pattern = SymbolicSparseColMat::new_checked(n, n, start, None, rows);
        (pattern, sources)
    }

    /// Matrices of a harmonic; real numbers serve harmonics 0 and z/2 only.
    pub(super) fn matrices<T: Scalar>(&self, harmonic: u32) -> Pair<T> {
        let (sin, cos) = self.phase(harmonic).sin_cos();
        let hub = self.hub_rows(harmonic);
        let (pattern, sources) = self.pattern(&hub);
        let values = |of: &[PhaseBlocks], which: usize| -> Vec<T> {
            let value = |source: &Source| match *source {
                Source::Pair(pair, i) => {
                    let [a, b, c] = of[pair].map(|part| part[i]);
                    T::complex(a + cos * (b + c), sin * (b - c))
                }
                Source::Hub(h, at) => T::complex(hub[h][at][which].re, hub[h][at][which].im),
            };
            sources.iter().map(value).collect()
        };
        Pair {
            stiffness: SparseColMat::new(pattern.clone(), values(&self.stiffness, 0)),
            mass: SparseColMat::new(pattern, values(&self.mass, 1)),
        }
    }

    /// Displacements of all nodes of the sector from the unknowns of a harmonic, times `scale`.
    pub(super) fn expand<T: Scalar>(
        &self,
        harmonic: u32,
        reduced: &[T],
        scale: f64,
        full: &mut [c64],
    ) {
        let (sin, cos) = self.phase(harmonic).sin_cos();
        let pitch = std::f64::consts::TAU / f64::from(self.sectors);
        let (turn_sin, turn_cos) = pitch.sin_cos();
        let number = |x: T| {
            let [re, im] = x.parts();
            c64::new(scale * re, scale * im)
        };
        for (&(place, high), u) in self.place.iter().zip(full.chunks_exact_mut(3)) {
            if place == HELD {
                u.fill(c64::new(0.0, 0.0));
                continue;
            }
            let v: [c64; 3] =
                std::array::from_fn(|axis| number(reduced[3 * place as usize + axis]));
            if high {
                let e = c64::new(cos, sin);
                u[0] = e * (v[0] * turn_cos - v[1] * turn_sin);
                u[1] = e * (v[0] * turn_sin + v[1] * turn_cos);
                u[2] = e * v[2];
            } else {
                u.copy_from_slice(&v);
            }
        }
        for (h, motion) in self.motions_of(harmonic).enumerate() {
            let amplitude = number(reduced[3 * self.free + h]);
            for ((u, re), im) in full.iter_mut().zip(&motion.parts[0]).zip(&motion.parts[1]) {
                *u += amplitude * c64::new(*re, *im);
            }
        }
    }
}
