//! A beam element as six springs: Timoshenko's stiffness matrix by its modes of deformation.
//!
//! With the displacements `u` and turns `theta` of both ends in the axes of the shaft, whose third is its axis, and
//! `Phi = 12 E I / (kappa G A l^2)`,
//!
//! ```text
//! stretching     u3_b - u3_a                                       E A / l
//! torsion        theta3_b - theta3_a                               G J / l
//! bending        theta2_b - theta2_a                               E I / l
//!   with shear   (theta2_a + theta2_b)/2 - (u1_b - u1_a)/l         12 E I / (l (1 + Phi))
//! ```
//!
//! and the same in the plane of `u2` and `-theta1`. These are all eigenvectors of deformation of the 12 x 12 matrix of
//! J. S. Przemieniecki, *Theory of Matrix Structural Analysis* (1968), section 5.6: a beam loaded at its ends is exact.
//! Shear coefficient of a tube by G. R. Cowper, *J. Appl. Mech.* 33 (1966) 335, with `m` the ratio of diameters:
//! `kappa = 6 (1 + nu) (1 + m^2)^2 / ((7 + 6 nu) (1 + m^2)^2 + (20 + 12 nu) m^2)`.

use crate::spec::{Section, SectionKind};
use std::f64::consts::PI;

/// Weights of the six directions of a hub: three translations, three rotations.
pub(in crate::scene) type SixDirections = [f64; 6];

/// Kinds of deformation of a piece of a shaft.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::scene) enum DeformationKind {
    Torsion,
    Stretching,
    Bending,
}

/// A mode of deformation of an element: the weights of the motions of both ends, and its stiffness, infinite for a
/// rigid mode [N m/rad], [N/m].
#[derive(Clone, Copy, Debug)]
pub(in crate::scene) struct Mode {
    pub kind: DeformationKind,
    pub ends: [SixDirections; 2],
    pub stiffness: f64,
}

/// Lumped mass and inertia of half an element at its end.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LumpedMass {
    /// Lumped mass [kg].
    pub mass: f64,
    /// Moments of inertia about the axis and across it [kg m^2].
    pub polar: f64,
    pub across: f64,
}

impl LumpedMass {
    pub fn add(&mut self, other: &LumpedMass) {
        self.mass += other.mass;
        self.polar += other.polar;
        self.across += other.across;
    }
}

/// Returns weights with one at a direction.
fn unit(direction: usize, value: f64) -> SixDirections {
    let mut six = [0.0; 6];
    six[direction] = value;
    six
}

fn difference(kind: DeformationKind, direction: usize, stiffness: f64) -> Mode {
    Mode {
        kind,
        ends: [unit(direction, -1.0), unit(direction, 1.0)],
        stiffness,
    }
}

/// Returns the torsion between the members of a stage, whose first member turns `ratio` times as fast as the second.
pub(super) fn stage(ratio: f64, stiffness: f64) -> Mode {
    Mode {
        kind: DeformationKind::Torsion,
        ends: [unit(5, -ratio.recip()), unit(5, 1.0)],
        stiffness,
    }
}

/// Direction of the displacement, of the rotation, and the sign of the slope of the rotation, in both planes of
/// bending.
const PLANES: [(usize, usize, f64); 2] = [(0, 4, 1.0), (1, 3, -1.0)];

/// Returns the modes of an element of a length [m] that is a piece of a section.
pub(super) fn elastic(section: &Section, length: f64) -> Vec<Mode> {
    match &section.kind {
        SectionKind::Coupling { stiffness } => {
            let k = stiffness * section.length / length;
            vec![difference(DeformationKind::Torsion, 5, k)]
        }
        SectionKind::Round {
            diameters: [outer, inner],
            material,
        } => {
            let (area, second) = properties(*outer, *inner);
            let (e, nu) = (material.young, material.poisson);
            let g = e / (2.0 * (1.0 + nu));
            let m2 = (inner / outer).powi(2);
            let kappa = 6.0 * (1.0 + nu) * (1.0 + m2).powi(2)
                / ((7.0 + 6.0 * nu) * (1.0 + m2).powi(2) + (20.0 + 12.0 * nu) * m2);
            let phi = 12.0 * e * second / (kappa * g * area * length * length);
            let mut modes = vec![
                difference(DeformationKind::Torsion, 5, 2.0 * g * second / length),
                difference(DeformationKind::Stretching, 2, e * area / length),
            ];
            for (across, turn, sign) in PLANES {
                modes.push(difference(
                    DeformationKind::Bending,
                    turn,
                    e * second / length,
                ));
                let mut ends = [unit(turn, 0.5), unit(turn, 0.5)];
                ends[0][across] = sign / length;
                ends[1][across] = -sign / length;
                modes.push(Mode {
                    kind: DeformationKind::Bending,
                    ends,
                    stiffness: 12.0 * e * second / (length * (1.0 + phi)),
                });
            }
            modes
        }
    }
}

/// Returns the modes that a rigid piece of a length [m] excludes.
pub(super) fn rigid(length: f64) -> Vec<Mode> {
    let mut modes = vec![
        difference(DeformationKind::Torsion, 5, f64::INFINITY),
        difference(DeformationKind::Stretching, 2, f64::INFINITY),
    ];
    for (across, turn, sign) in PLANES {
        modes.push(difference(DeformationKind::Bending, turn, f64::INFINITY));
        let mut shift = difference(DeformationKind::Bending, across, f64::INFINITY);
        shift.ends[0][turn] = -sign * length;
        modes.push(shift);
    }
    modes
}

/// Returns half of an element lumped at its end: mass, and rotary inertia of the cross-sections.
pub(super) fn lump(section: &Section, length: f64) -> LumpedMass {
    match &section.kind {
        SectionKind::Coupling { .. } => LumpedMass::default(),
        SectionKind::Round {
            diameters: [outer, inner],
            material,
        } => {
            let (area, second) = properties(*outer, *inner);
            let half = 0.5 * length * material.density;
            LumpedMass {
                mass: half * area,
                polar: 2.0 * half * second,
                across: half * second,
            }
        }
    }
}

/// Returns area [m^2] and second moment [m^4] of a ring.
fn properties(outer: f64, inner: f64) -> (f64, f64) {
    (
        0.25 * PI * (outer * outer - inner * inner),
        PI / 64.0 * (outer.powi(4) - inner.powi(4)),
    )
}
