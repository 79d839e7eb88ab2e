//! Motions of the hub in the frame of the sector, sorted by the harmonic they belong to.

use super::{HELD, Sector, sector_error};
use crate::Vec3;
use crate::assembly::tie::HubMotion;
use crate::modes::ModesError;
use crate::modes::cyclic::Hub;
use crate::vector::turned;
use faer::c64;

/// A motion of the hub in the frame of the sector: complex displacement of each bore node.
#[derive(Clone, Debug)]
pub(super) struct Motion {
    /// Harmonic it belongs to.
    pub(super) harmonic: u32,
    /// Real and imaginary part of the displacement, three per node of the sector.
    pub(super) parts: [Vec<f64>; 2],
    /// Inertia that the hub adds, per sector.
    inertia: f64,
}

impl Sector {
    /// Rows of the hub motions of a harmonic: stiffness and mass towards each free unknown and each hub motion.
    pub(super) fn hub_rows(&self, harmonic: u32) -> Vec<Vec<[c64; 2]>> {
        let motions: Vec<_> = self.motions_of(harmonic).collect();
        let (sin, cos) = self.phase(harmonic).sin_cos();
        let back = c64::new(cos, -sin);
        let pitch = std::f64::consts::TAU / f64::from(self.sectors);
        let size = 3 * self.place.len();
        (motions.iter().enumerate())
            .map(|(own, motion)| {
                let zero = c64::new(0.0, 0.0);
                let mut row = vec![[zero; 2]; 3 * self.free + motions.len()];
                for which in 0..2 {
                    let image: [Vec<f64>; 2] = std::array::from_fn(|part| {
                        let mut y = vec![0.0; size];
                        match which {
                            0 => self.assembly.stiffness.apply(&motion.parts[part], &mut y),
                            _ => self.assembly.mass.apply(&motion.parts[part], &mut y),
                        }
                        y
                    });
                    for (node, &(place, high)) in self.place.iter().enumerate() {
                        if place == HELD {
                            continue;
                        }
                        let at =
                            |part: usize| Vec3::from_column_slice(&image[part][3 * node..][..3]);
                        let (mut re, mut im) = (at(0), at(1));
                        if high {
                            (re, im) = (turned(re, -pitch), turned(im, -pitch));
                        }
                        for axis in 0..3 {
                            let mut e = c64::new(re[axis], im[axis]);
                            if high {
                                e *= back;
                            }
                            // The row of the lower triangle is the conjugate of this column.
                            row[3 * place as usize + axis][which] += e.conj();
                        }
                    }
                    for (other, with) in motions.iter().enumerate() {
                        let dot = |a: usize, b: usize| -> f64 {
                            with.parts[a]
                                .iter()
                                .zip(&image[b])
                                .map(|(x, y)| x * y)
                                .sum()
                        };
                        // with^H A own, conjugated: the entry of row `own`, column `other`.
                        let e = c64::new(dot(0, 0) + dot(1, 1), dot(0, 1) - dot(1, 0)).conj();
                        row[3 * self.free + other][which] = e;
                    }
                }
                row[3 * self.free + own][1] += c64::new(motion.inertia, 0.0);
                row
            })
            .collect()
    }
}

/// Sorts the hub's motions by harmonic.
pub(super) fn motions(
    hub: &Hub,
    nodes: &[Vec3],
    is_bore: &[bool],
    sectors: u32,
) -> Result<Vec<Motion>, ModesError> {
    if hub.motions.len() != hub.added_inertia.len() {
        return Err(sector_error(format!(
            "{} hub motions with {} added inertias: give one for each",
            hub.motions.len(),
            hub.added_inertia.len()
        )));
    }
    let field = |motion: HubMotion| -> Vec<f64> {
        let at = |(x, bore): (&Vec3, &bool)| if *bore { motion.of(x) } else { Vec3::zeros() };
        nodes
            .iter()
            .zip(is_bore)
            .flat_map(|n| -> [f64; 3] { at(n).into() })
            .collect()
    };
    let mut sorted = Vec::new();
    // Directions across the axis, and their inertias: slides, then tilts.
    let mut across: [Vec<(Vec3, f64)>; 2] = Default::default();
    for (&motion, &inertia) in hub.motions.iter().zip(&hub.added_inertia) {
        let (kind, direction) = match motion {
            HubMotion::Turn => (1, Vec3::z()),
            HubMotion::TurnAbout(axis) => (1, axis),
            HubMotion::Slide(direction) => (0, direction),
        };
        if direction.x.hypot(direction.y) <= 1e-12 * direction.z.abs() {
            sorted.push(Motion {
                harmonic: 0,
                parts: [field(motion), vec![0.0; 3 * nodes.len()]],
                inertia: inertia / f64::from(sectors),
            });
        } else {
            across[kind].push((direction, inertia));
        }
    }
    for (kind, pair) in across.iter().enumerate() {
        match pair[..] {
            [] => {}
            [(a, ja), (b, jb)]
                if a.z.abs().max(b.z.abs()) < 1e-12
                    && a.dot(&b).abs() < 1e-12
                    && (a.norm() - 1.0).abs().max((b.norm() - 1.0).abs()) < 1e-12
                    && ja == jb =>
            {
                let make = |d: Vec3| {
                    field(if kind == 0 {
                        HubMotion::Slide(d)
                    } else {
                        HubMotion::TurnAbout(d)
                    })
                };
                // (1, i) turns into exp(i pitch) (1, i): harmonic 1. Both real directions of the whole body
                // share z/2 sectors' worth of the complex amplitude.
                sorted.push(Motion {
                    harmonic: 1,
                    parts: [make(Vec3::x()), make(Vec3::y())],
                    inertia: 2.0 * ja / f64::from(sectors),
                });
            }
            _ => {
                return Err(sector_error(
                    "hub motions across the axis must be two perpendicular unit directions with the same \
                     inertia, else the gear is not cyclic: use the modes of a whole mesh",
                ));
            }
        }
    }
    Ok(sorted)
}
