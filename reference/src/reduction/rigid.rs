//! Rigid motion of a gear whose hub is free in several directions, and the momentum of its modes in them.
//!
//! With the motions `e_p` of the whole gear by unit coordinates of the hub, about and along axes through its origin, and what
//! is added there, the rigid mass matrix and the momentum of a shape `phi` that moves the hub by `h` are
//!
//! ```text
//! J_pq = e_p^T M e_q + delta_pq added_p,     p_p = e_p^T M phi + added_p h_p
//! ```
//!
//! so a centre of mass beside the origin couples translations with rotations. A shape is rigid when `p^T J^-1 p = 1`. Modes are
//! orthogonal to that space up to the tolerance of their search; `phi - E J^-1 p` is so up to rounding.
//!
//! Of a gear made of copies of a sector motions along and about z belong to harmonic 0. Those across belong to harmonic 1 as
//! `E = e_x + i e_y`: in the frame turned with tooth k, `Re(E exp(i k mu))` is `e_x` and `Im(E exp(i k mu))` is `e_y`. With the
//! sums `H` over a sector two shapes `Re(u exp(i k mu))` and `Im(u exp(i k mu))` then have the momenta `z/2 (Re H, -Im H)` and
//! `z/2 (Im H, Re H)` along x and y, `H = E^H M u`.

use super::integrals::Moments;
use super::mounting::{Mounting, field};
use crate::assembly::ScalarMatrix;
use crate::assembly::tie::Tie;
use crate::modes::cyclic::{CyclicModes, Part};
use crate::vector::dot;
use faer::prelude::Solve;
use faer::{Mat, c64};
use gearbench_models::Vec3;
use gearbench_models::gear::elastic::reduced::OutOfPlaneShapes;

/// Motion of the hub and momentum of the whole gear in a mode, in the six directions; zero where the hub is not free.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ModeMotion {
    /// Displacement of the hub.
    pub hub: [f64; 6],
    /// Momentum of the whole gear.
    pub momentum: [f64; 6],
}

/// The rigid mass matrix over some directions.
pub(super) struct RigidMass {
    directions: Vec<usize>,
    inverse: Mat<f64>,
}

impl RigidMass {
    /// Of the free directions of a gear.
    pub fn of(body: &OutOfPlaneShapes, mounting: &Mounting) -> Self {
        let directions: Vec<usize> = mounting.directions().collect();
        let all = rigid_mass(body);
        let n = directions.len();
        let mass = Mat::from_fn(n, n, |i, j| all[directions[i]][directions[j]]);
        let inverse = mass.partial_piv_lu().solve(Mat::<f64>::identity(n, n));
        RigidMass {
            directions,
            inverse,
        }
    }

    /// Share of a shape that is rigid, `p^T J^-1 p`.
    pub fn share(&self, momentum: &[f64; 6]) -> f64 {
        let p: Vec<f64> = self.directions.iter().map(|d| momentum[*d]).collect();
        let n = p.len();
        let entries = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
        entries
            .map(|(i, j)| p[i] * self.inverse[(i, j)] * p[j])
            .sum()
    }
}

/// The mass matrix of a rigid body in the six directions, about the origin.
pub(super) fn rigid_mass(body: &OutOfPlaneShapes) -> [[f64; 6]; 6] {
    let (m, c) = (body.mass, Vec3::from(body.centre));
    let axes = [Vec3::x(), Vec3::y(), Vec3::z()];
    let mut out = [[0.0; 6]; 6];
    for i in 0..3 {
        out[i][i] = m;
        for j in 0..3 {
            let across = m * axes[i].dot(&axes[j].cross(&c));
            (out[i][3 + j], out[3 + j][i]) = (across, across);
            let moved = axes[i].cross(&c).dot(&axes[j].cross(&c));
            out[3 + i][3 + j] = body.inertia[3 * i + j] + m * moved;
        }
    }
    out
}

/// Returns the rigid body of a gear with the inertia added at its hub, without modes; the moments are those of the
/// whole mesh.
pub(super) fn body(moments: &Moments, mounting: &Mounting) -> OutOfPlaneShapes {
    let mesh = moments.integrals();
    let added = mounting.added();
    let mass = mesh.mass + mounting.added_mass;
    let c = mesh.mass / mass * Vec3::from(mesh.centre);
    let inertia = std::array::from_fn(|k| {
        let (i, j) = (k / 3, k % 3);
        let own = if i == j {
            added[3 + i] - mass * c.norm_squared()
        } else {
            0.0
        };
        mesh.tensor[k] + own + mass * c[i] * c[j]
    });
    OutOfPlaneShapes {
        free: mounting.lateral,
        hub: Vec::new(),
        mass,
        centre: c.into(),
        inertia,
    }
}

/// A body made of equal sectors without the rounding of its sums: its centre of mass lies on the axis, and all lines across
/// that are alike.
pub(super) fn round(body: OutOfPlaneShapes) -> OutOfPlaneShapes {
    let i = &body.inertia;
    let across = 0.5 * (i[0] + i[4]);
    OutOfPlaneShapes {
        centre: [0.0, 0.0, body.centre[2]],
        inertia: [across, 0.0, 0.0, 0.0, across, 0.0, 0.0, 0.0, i[8]],
        ..body
    }
}

/// Rigid motions of a whole mesh in the free directions.
pub(super) struct MeshRigidMotions {
    directions: Vec<usize>,
    added: Vec<f64>,
    fields: Vec<Vec<f64>>,
    images: Vec<Vec<f64>>,
    inverse: Mat<f64>,
}

impl MeshRigidMotions {
    pub fn new(mounting: &Mounting, nodes: &[Vec3], mass: &ScalarMatrix) -> Self {
        let directions: Vec<usize> = mounting.directions().collect();
        let added = mounting.added_in_motions();
        let motions = mounting.motions();
        let fields: Vec<Vec<f64>> = motions.iter().map(|m| field(*m, nodes)).collect();
        let image = |field: &Vec<f64>| {
            let mut image = vec![0.0; field.len()];
            mass.apply(field, &mut image);
            image
        };
        let images: Vec<Vec<f64>> = fields.iter().map(image).collect();
        let n = directions.len();
        let rigid = Mat::from_fn(n, n, |i, j| {
            dot(&fields[i], &images[j]) + if i == j { added[i] } else { 0.0 }
        });
        MeshRigidMotions {
            inverse: rigid.partial_piv_lu().solve(Mat::<f64>::identity(n, n)),
            directions,
            added,
            fields,
            images,
        }
    }

    /// Momenta of a shape in the free motions, by displacements of all nodes and of the hub.
    fn momenta(&self, full: &[f64], hub: &[f64]) -> Vec<f64> {
        (self.images.iter().zip(&self.added).zip(hub))
            .map(|((image, added), h)| dot(image, full) + added * h)
            .collect()
    }

    /// Returns the motion of hub and gear in a shape.
    pub fn moved(&self, full: &[f64], hub: &[f64]) -> ModeMotion {
        let mut moved = ModeMotion::default();
        let momenta = self.momenta(full, hub);
        for ((d, h), p) in self.directions.iter().zip(hub).zip(momenta) {
            (moved.hub[*d], moved.momentum[*d]) = (*h, p);
        }
        moved
    }

    /// Takes rigid motion out of a shape over the coordinates of a tie; `full` is that shape at all nodes.
    pub fn clean(&self, tie: &Tie, vector: &mut [f64], full: &[f64]) {
        let (nodes, hub) = vector.split_at_mut(3 * tie.free.len());
        let p = self.momenta(full, hub);
        for (i, field) in self.fields.iter().enumerate() {
            let share: f64 = (0..p.len()).map(|j| self.inverse[(i, j)] * p[j]).sum();
            hub[i] -= share;
            for (&node, u) in tie.free.iter().zip(nodes.chunks_exact_mut(3)) {
                let e = &field[3 * node as usize..][..3];
                u.iter_mut().zip(e).for_each(|(u, e)| *u -= share * e);
            }
        }
    }
}

/// A rigid motion of a gear made of copies of a sector, at the nodes of that of tooth 0.
pub(super) struct CyclicMotion {
    pub harmonic: u32,
    /// The direction of its real part, and that of its imaginary part in harmonic 1.
    pub directions: [usize; 2],
    pub field: Vec<c64>,
    /// Inertia added at the hub per sector.
    added: f64,
}

/// The motions that belong to these directions of the whole gear; x and y come together.
pub(super) fn cyclic_motions(
    mounting: &Mounting,
    directions: impl Iterator<Item = usize>,
    nodes: &[Vec3],
    teeth: u32,
) -> Vec<CyclicMotion> {
    let added = mounting.added();
    let of = |d: usize| field(mounting.motion_of(d), nodes);
    let motion = |d: usize| match d {
        0 | 3 => Some(CyclicMotion {
            harmonic: 1,
            directions: [d, d + 1],
            field: (of(d).iter().zip(of(d + 1)))
                .map(|(x, y)| c64::new(*x, y))
                .collect(),
            added: 2.0 * added[d] / f64::from(teeth),
        }),
        1 | 4 => None,
        _ => Some(CyclicMotion {
            harmonic: 0,
            directions: [d; 2],
            field: of(d).into_iter().map(|x| c64::new(x, 0.0)).collect(),
            added: added[d] / f64::from(teeth),
        }),
    };
    directions.filter_map(motion).collect()
}

/// `M u` of complex displacements.
pub(super) fn image(mass: &ScalarMatrix, u: &[c64]) -> Vec<c64> {
    let part = |of: fn(&c64) -> f64| {
        let x: Vec<f64> = u.iter().map(of).collect();
        let mut y = vec![0.0; x.len()];
        mass.apply(&x, &mut y);
        y
    };
    let (re, im) = (part(|c| c.re), part(|c| c.im));
    re.into_iter()
        .zip(im)
        .map(|(re, im)| c64::new(re, im))
        .collect()
}

/// Returns the scalar product `a^H b`.
pub(super) fn hermitian<'a>(
    a: impl Iterator<Item = &'a c64>,
    b: impl Iterator<Item = &'a c64>,
) -> c64 {
    a.zip(b)
        .fold(c64::new(0.0, 0.0), |sum, (a, b)| sum + a.conj() * b)
}

/// Rigid motions of a gear made of copies of a sector, in the free directions.
pub(super) struct SectorRigidMotions {
    teeth: u32,
    /// Motions of harmonic 0, then those of harmonic 1.
    of_harmonic: [Vec<CyclicMotion>; 2],
    images: [Vec<Vec<c64>>; 2],
    /// Entries of the nodes tied to the hub.
    bore: Vec<usize>,
}

impl SectorRigidMotions {
    pub fn new(
        mounting: &Mounting,
        nodes: &[Vec3],
        bore: &[u32],
        mass: &ScalarMatrix,
        teeth: u32,
    ) -> Self {
        let all = cyclic_motions(mounting, mounting.directions(), nodes, teeth);
        let (along, across): (Vec<_>, Vec<_>) = all.into_iter().partition(|m| m.harmonic == 0);
        let of_harmonic = [along, across];
        SectorRigidMotions {
            teeth,
            images: of_harmonic.each_ref().map(|motions| {
                let images = motions.iter().map(|m| image(mass, &m.field));
                images.collect()
            }),
            of_harmonic,
            bore: (bore.iter())
                .flat_map(|n| (0..3).map(move |axis| 3 * *n as usize + axis))
                .collect(),
        }
    }

    /// Returns the motion of the hub in a shape of a harmonic, from its bore.
    fn hub(&self, harmonic: usize, u: &[c64]) -> Mat<c64> {
        let motions = &self.of_harmonic[harmonic];
        let at = |x: &[c64]| -> Vec<c64> { self.bore.iter().map(|i| x[*i]).collect() };
        let fields: Vec<Vec<c64>> = motions.iter().map(|m| at(&m.field)).collect();
        let u = at(u);
        let n = motions.len();
        let gram = Mat::from_fn(n, n, |i, j| hermitian(fields[i].iter(), fields[j].iter()));
        let right = Mat::from_fn(n, 1, |i, _| hermitian(fields[i].iter(), u.iter()));
        gram.partial_piv_lu().solve(right)
    }

    /// Returns the momenta `E^H M u` of a shape of a sector, including the inertia added at the hub.
    fn momenta(&self, harmonic: usize, u: &[c64], hub: &Mat<c64>) -> Vec<c64> {
        let motions = self.of_harmonic[harmonic].iter();
        (motions.zip(&self.images[harmonic]).enumerate())
            .map(|(i, (m, image))| hermitian(image.iter(), u.iter()) + m.added * hub[(i, 0)])
            .collect()
    }

    /// Takes rigid motion out of all modes that are not rigid themselves.
    pub fn clean(&self, found: &mut CyclicModes) {
        for (harmonic, motions) in self.of_harmonic.iter().enumerate() {
            let n = motions.len();
            let Some(shapes) = found.shapes.get_mut(harmonic).filter(|_| n > 0) else {
                continue;
            };
            let mass = Mat::from_fn(n, n, |i, j| {
                let own = if i == j { motions[i].added } else { 0.0 };
                hermitian(motions[i].field.iter(), self.images[harmonic][j].iter()) + own
            });
            let mass = mass.partial_piv_lu();
            for column in n..shapes.ncols() {
                let u: Vec<c64> = shapes.col(column).iter().copied().collect();
                let hub = self.hub(harmonic, &u);
                let p = self.momenta(harmonic, &u, &hub);
                let share = mass.solve(Mat::from_fn(n, 1, |i, _| p[i]));
                for (i, motion) in motions.iter().enumerate() {
                    for (row, e) in motion.field.iter().enumerate() {
                        shapes[(row, column)] -= share[(i, 0)] * e;
                    }
                }
            }
        }
    }

    /// Returns the motion of hub and gear in a mode.
    pub fn moved(&self, found: &CyclicModes, mode: usize) -> ModeMotion {
        let mut moved = ModeMotion::default();
        let m = &found.modes[mode];
        let harmonic = m.harmonic as usize;
        let Some(motions) = self.of_harmonic.get(harmonic).filter(|m| !m.is_empty()) else {
            return moved;
        };
        let u: Vec<c64> = found.shapes[harmonic]
            .col(m.column)
            .iter()
            .copied()
            .collect();
        let hub = self.hub(harmonic, &u);
        let momenta = self.momenta(harmonic, &u, &hub);
        let z = f64::from(self.teeth);
        for (i, (motion, p)) in motions.iter().zip(momenta).enumerate() {
            let [a, b] = motion.directions;
            let h = hub[(i, 0)];
            if harmonic == 0 {
                (moved.hub[a], moved.momentum[a]) = (h.re, z * p.re);
                continue;
            }
            // Re(h E) moves the hub by (Re h, -Im h), Im(h E) by (Im h, Re h).
            let parts = |c: c64| match m.part {
                Part::Single | Part::Cosine => [c.re, -c.im],
                Part::Sine => [c.im, c.re],
            };
            [moved.hub[a], moved.hub[b]] = parts(h);
            [moved.momentum[a], moved.momentum[b]] = parts(p).map(|p| 0.5 * z * p);
        }
        moved
    }
}
