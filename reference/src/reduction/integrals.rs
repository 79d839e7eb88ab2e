//! Inertia integrals of a mesh with its modes, for [`Integrals`].
//!
//! With the nodal mass `M` and `V = M U` for shapes `U` all are sums over nodes. A gear made of copies of a sector
//! needs one sum per harmonic: in-plane products of shapes do not change when both turn with their tooth, and
//! products over different harmonics vanish. For shapes `u`, `w` of the same harmonic and `H = u^H M w` the real modes
//! `Re(u exp(i k mu))` and `Im(u exp(i k mu))` have
//!
//! ```text
//! cos cos = sin sin = z/2 Re H,   cos sin = z/2 Im H,   sin cos = -z/2 Im H
//! ```
//!
//! and `z Re H` in the harmonics 0 and z/2.

use crate::assembly::ScalarMatrix;
use crate::modes::cyclic::{CyclicModes, Part};
use crate::vector::turned;
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, Par};
use gearbench_models::Vec3;
use gearbench_models::gear::elastic::inertia::Integrals;
use std::f64::consts::TAU;

/// Beyond so many modes the square integrals are left out: they would outgrow everything else.
const MOST_MODES: usize = 2000;

/// Columns at a time.
const BLOCK: usize = 64;

/// Moments of the undeformed body: mass, first moment, second moment `int X X^T dm`.
pub(super) struct Moments {
    mass: f64,
    first: Vec3,
    second: [f64; 9],
}

impl Moments {
    pub(super) fn of(mass: &ScalarMatrix, nodes: &[Vec3]) -> Self {
        let places: Vec<f64> = nodes
            .iter()
            .flat_map(|x| -> [f64; 3] { (*x).into() })
            .collect();
        let (mut ones, mut image) = (vec![0.0; places.len()], vec![0.0; places.len()]);
        ones.iter_mut().step_by(3).for_each(|x| *x = 1.0);
        mass.apply(&ones, &mut image);
        let total = image.iter().step_by(3).sum();
        mass.apply(&places, &mut image);
        let mut first = Vec3::zeros();
        let mut second = [0.0; 9];
        for (x, m) in places.chunks_exact(3).zip(image.chunks_exact(3)) {
            first += Vec3::new(m[0], m[1], m[2]);
            for (k, s) in second.iter_mut().enumerate() {
                *s += x[k / 3] * m[k % 3];
            }
        }
        Moments {
            mass: total,
            first,
            second,
        }
    }

    /// Of this body and its copies turned by `teeth` equal angles.
    pub(super) fn repeated(&self, teeth: u32) -> Self {
        let mut sum = Moments {
            mass: self.mass * f64::from(teeth),
            first: Vec3::zeros(),
            second: [0.0; 9],
        };
        for tooth in 0..teeth {
            let angle = TAU * f64::from(tooth) / f64::from(teeth);
            let (s, c) = angle.sin_cos();
            let r = [c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0];
            sum.first += turned(self.first, angle);
            for (k, out) in sum.second.iter_mut().enumerate() {
                for a in 0..3 {
                    for b in 0..3 {
                        *out += r[3 * (k / 3) + a] * self.second[3 * a + b] * r[3 * (k % 3) + b];
                    }
                }
            }
        }
        sum
    }

    /// Returns the integrals without modes.
    pub(super) fn integrals(&self) -> Integrals {
        let trace = self.second[0] + self.second[4] + self.second[8];
        let mut tensor = self.second.map(|s| -s);
        for i in [0, 4, 8] {
            tensor[i] += trace;
        }
        Integrals {
            mass: self.mass,
            centre: (self.first / self.mass).into(),
            tensor,
            ..Integrals::default()
        }
    }
}

/// Sums over the nodes of `v` and `X x v`, and of the in-plane product `X.v`.
fn sums(nodes: &[Vec3], v: &[f64]) -> (Vec3, Vec3, f64) {
    let (mut sum, mut moment, mut radial) = (Vec3::zeros(), Vec3::zeros(), 0.0);
    for (x, v) in nodes.iter().zip(v.chunks_exact(3)) {
        let v = Vec3::new(v[0], v[1], v[2]);
        sum += v;
        moment += x.cross(&v);
        radial += x.x * v.x + x.y * v.y;
    }
    (sum, moment, radial)
}

/// Of a whole mesh; `shape(i, u)` writes the displacements of all nodes in mode `i`, hub included.
pub(super) fn of_mesh(
    mass: &ScalarMatrix,
    nodes: &[Vec3],
    modes: usize,
    shape: impl Fn(usize, &mut [f64]),
) -> Option<Integrals> {
    if modes > MOST_MODES {
        return None;
    }
    let mut out = Moments::of(mass, nodes).integrals();
    let n = nodes.len();
    let (mut u, mut v) = (vec![0.0; 3 * n], vec![0.0; 3 * n]);
    // In-plane parts: x of all nodes, then y.
    let mut shapes = Mat::<f64>::zeros(2 * n, modes);
    for mode in 0..modes {
        shape(mode, &mut u);
        for node in 0..n {
            shapes[(node, mode)] = u[3 * node];
            shapes[(n + node, mode)] = u[3 * node + 1];
        }
    }
    let (mut planar, mut gyroscopic) = (Mat::zeros(modes, modes), Mat::zeros(modes, modes));
    for first in (0..modes).step_by(BLOCK) {
        let count = BLOCK.min(modes - first);
        let mut images = Mat::<f64>::zeros(2 * n, count);
        for column in 0..count {
            shape(first + column, &mut u);
            mass.apply(&u, &mut v);
            let (sum, moment, radial) = sums(nodes, &v);
            out.translation.extend(sum.iter());
            out.rotation.extend(moment.iter());
            out.radial.push(radial);
            for node in 0..n {
                images[(node, column)] = v[3 * node];
                images[(n + node, column)] = v[3 * node + 1];
            }
        }
        let (x, y) = (images.subrows(0, n), images.subrows(n, n));
        let (ux, uy) = (shapes.subrows(0, n), shapes.subrows(n, n));
        let mut g = planar.subcols_mut(first, count);
        matmul(&mut g, Accum::Replace, ux.transpose(), x, 1.0, Par::Seq);
        matmul(&mut g, Accum::Add, uy.transpose(), y, 1.0, Par::Seq);
        // z x (x, y) = (-y, x).
        let mut c = gyroscopic.subcols_mut(first, count);
        matmul(&mut c, Accum::Replace, ux.transpose(), y, 1.0, Par::Seq);
        matmul(&mut c, Accum::Add, uy.transpose(), x, -1.0, Par::Seq);
    }
    fill(&mut out, modes, |i, j| (planar[(i, j)], gyroscopic[(i, j)]));
    Some(out)
}

/// Fills the symmetric and skew matrices, without their parts of the other symmetry, which are rounding.
fn fill(out: &mut Integrals, modes: usize, entry: impl Fn(usize, usize) -> (f64, f64)) {
    out.planar = vec![0.0; modes * modes];
    out.gyroscopic = vec![0.0; modes * modes];
    for i in 0..modes {
        for j in 0..modes {
            let ((g, c), (gt, ct)) = (entry(i, j), entry(j, i));
            out.planar[i * modes + j] = 0.5 * (g + gt);
            out.gyroscopic[i * modes + j] = 0.5 * (c - ct);
        }
    }
}

/// Of a gear made of copies of a sector, without the first `skip` modes; `mass` and `nodes` are the sector's.
pub(super) fn of_sector(
    mass: &ScalarMatrix,
    nodes: &[Vec3],
    found: &CyclicModes,
    skip: usize,
) -> Option<Integrals> {
    let modes = &found.modes[skip.min(found.modes.len())..];
    if modes.len() > MOST_MODES {
        return None;
    }
    let teeth = f64::from(found.sectors);
    let mut out = Moments::of(mass, nodes).repeated(found.sectors).integrals();
    // Per harmonic: images of its shapes, real and imaginary part.
    let images: Vec<Vec<[Vec<f64>; 2]>> = (found.shapes.iter())
        .map(|shapes| {
            let columns = 0..shapes.ncols();
            columns
                .map(|c| {
                    [0, 1].map(|part| {
                        let u: Vec<f64> = (shapes.col(c).iter())
                            .map(|u| if part == 0 { u.re } else { u.im })
                            .collect();
                        let mut v = vec![0.0; u.len()];
                        mass.apply(&u, &mut v);
                        v
                    })
                })
                .collect()
        })
        .collect();
    for m in modes {
        let [re, im] = &images[m.harmonic as usize][m.column];
        let (re, im) = (sums(nodes, re), sums(nodes, im));
        let (mut sum, mut moment) = (Vec3::zeros(), Vec3::zeros());
        for tooth in 0..found.sectors {
            let turns = (u64::from(tooth) * u64::from(m.harmonic)) % u64::from(found.sectors);
            let (sin, cos) = (TAU * turns as f64 / teeth).sin_cos();
            let (a, b) = match m.part {
                Part::Single | Part::Cosine => (cos, -sin),
                Part::Sine => (sin, cos),
            };
            let angle = TAU * f64::from(tooth) / teeth;
            sum += turned(a * re.0 + b * im.0, angle);
            moment += turned(a * re.1 + b * im.1, angle);
        }
        out.translation.extend(sum.iter());
        out.rotation.extend(moment.iter());
        out.radial
            .push(if m.harmonic == 0 { teeth * re.2 } else { 0.0 });
    }
    // Products of the shapes of each harmonic: in-plane, and with the first turned by a quarter.
    let products: Vec<Mat<[f64; 4]>> = (found.shapes.iter().zip(&images))
        .map(|(shapes, images)| {
            Mat::from_fn(shapes.ncols(), shapes.ncols(), |i, j| {
                let u = shapes.col(i);
                let [re, im] = &images[j];
                let mut p = [0.0; 4];
                for at in (0..re.len()).step_by(3) {
                    let (ux, uy) = (u[at], u[at + 1]);
                    let (x, y) = ((re[at], im[at]), (re[at + 1], im[at + 1]));
                    p[0] += ux.re * x.0 + ux.im * x.1 + uy.re * y.0 + uy.im * y.1;
                    p[1] += ux.re * x.1 - ux.im * x.0 + uy.re * y.1 - uy.im * y.0;
                    p[2] += ux.re * y.0 + ux.im * y.1 - uy.re * x.0 - uy.im * x.1;
                    p[3] += ux.re * y.1 - ux.im * y.0 - uy.re * x.1 + uy.im * x.0;
                }
                p
            })
        })
        .collect();
    fill(&mut out, modes.len(), |i, j| {
        let (a, b) = (&modes[i], &modes[j]);
        if a.harmonic != b.harmonic {
            return (0.0, 0.0);
        }
        let p = products[a.harmonic as usize][(a.column, b.column)];
        match (a.part, b.part) {
            (Part::Single, _) | (_, Part::Single) => (teeth * p[0], teeth * p[2]),
            (Part::Cosine, Part::Sine) => (0.5 * teeth * p[1], 0.5 * teeth * p[3]),
            (Part::Sine, Part::Cosine) => (-0.5 * teeth * p[1], -0.5 * teeth * p[3]),
            _ => (0.5 * teeth * p[0], 0.5 * teeth * p[2]),
        }
    });
    Some(out)
}

#[cfg(test)]
mod tests;
