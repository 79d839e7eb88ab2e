//! Frequency response of a scene to its tooth meshing: linear in the forces, at any speed, as long as flanks stay in
//! contact.
//!
//! Each mesh follows its own force law over its cycle ([`cycle`](super::cycle)). With `e` the closing by the hubs, `b`
//! the deflection of teeth and modes, and `u = e - b` the deflection of the contact,
//!
//! ```text
//! N = N_s + k (u - u_s) + c u'
//! b = (C - 1/k) R N          R: dynamic over quasi-static compliance of teeth and modes, 1 at frequency zero
//! M x'' + D x' + K x = loads - sum w N,      e = h x
//! ```
//!
//! The stiffness varies with the tooth meshing: forces at all multiples of the mesh frequency are solved together
//! (harmonic balance), which is exact for a linear law. Meshes of other frequencies keep the law of the first phase.
//! `R` is that of the first phase.

use super::cycle::{MeshCycle, MeshRow, Running};
use super::{AdmissibleMotions, LoadedStateError};
use gearbench_models::scene::Scene;
use nalgebra::{Complex, DMatrix, DVector};
use std::f64::consts::TAU;

/// Coupling of modes by dampers, relative to the largest damping, that counts as zero.
const COUPLED: f64 = 1e-9;

type C = Complex<f64>;

/// A force on the ground as linear function of displacements, velocities and mesh forces.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GroundForce {
    /// Index of the gear in the scene.
    pub gear: usize,
    /// Stiffness rows of both directions across the axis over displacements [N/m].
    pub stiffness: [Vec<f64>; 2],
    /// Damping rows of both directions over velocities [N s/m].
    pub damping: [Vec<f64>; 2],
    /// Share of each mesh force in both directions [-].
    pub of_meshes: [Vec<f64>; 2],
}

/// Response of one mesh at a mesh frequency.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshVibration {
    /// Index of the mesh in the scene.
    pub mesh: usize,
    /// Transmission error without its mean over a mesh cycle [m].
    pub error: Vec<f64>,
    /// Mesh force over a mesh cycle [N].
    pub force: Vec<f64>,
}

/// Response of the scene at the mesh frequency of a group of meshes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GroupVibration {
    /// Mesh frequency [Hz].
    pub frequency: f64,
    /// Responses of the meshes of the group.
    pub meshes: Vec<MeshVibration>,
    /// Forces on the ground without their mean, two directions over a mesh cycle [N].
    pub grounds: Vec<[Vec<f64>; 2]>,
}

/// The scene without the meshes of a group, in modal coordinates.
struct UnmeshedScene {
    squares: Vec<f64>,
    damping: DMatrix<f64>,
    /// True if dampers couple the modes.
    coupled: bool,
    /// Closing of the flanks of each mesh by the modes.
    flanks: Vec<DVector<f64>>,
    hubs: Vec<DVector<f64>>,
    grounds: Vec<[[DVector<f64>; 2]; 2]>,
}

/// Frequency response of a scene to the meshes of a group.
pub struct Response<'a> {
    cycle: &'a MeshCycle,
    grounds: &'a [GroundForce],
    rest: UnmeshedScene,
    /// Quasi-static compliance of teeth and modes of each mesh under its own force [m/N].
    slowly: Vec<f64>,
}

fn row(x: &[f64]) -> DMatrix<f64> {
    DMatrix::from_row_slice(1, x.len(), x)
}

/// Quasi-static compliance of teeth and modes under a unit force of their mesh that is balanced by loads on the hubs
/// [m/N].
fn quasi_static_compliance(
    scene: &Scene,
    running: &Running,
    mesh: usize,
    stiffness: &DMatrix<f64>,
) -> Result<f64, LoadedStateError> {
    let row = &running.rows[mesh];
    let gears = scene.meshes()[mesh].gears.map(|i| &scene.gears()[i]);
    let own = gears.map(|g| g.range().start + g.model.hub().first()..g.range().end);
    let own: Vec<usize> = own.into_iter().flatten().collect();
    if own.is_empty() {
        return Ok(0.0);
    }
    let block = DMatrix::from_fn(own.len(), own.len(), |i, j| stiffness[(own[i], own[j])]);
    // The load that holds the flank up acts on the hub, and on modes that turn it.
    let between = own.iter().map(|i| row.flanks[*i] - row.hubs[*i]);
    let between = DVector::from_iterator(own.len(), between);
    let moved = block.lu().solve(&between);
    let moved = moved.ok_or(LoadedStateError::Matrices(
        "internal coordinates have no stiffness",
    ))?;
    Ok(between.dot(&moved))
}

impl<'a> Response<'a> {
    /// Prepares the response to one mesh cycle of a scene in quasi-static motion.
    ///
    /// # Errors
    /// [`LoadedStateError`] if the matrices do not allow a solution.
    pub fn new(
        scene: &Scene,
        running: &Running,
        cycle: &'a MeshCycle,
        grounds: &'a [GroundForce],
    ) -> Result<Self, LoadedStateError> {
        let linear = &running.start.linear;
        let (mut stiffness, mut damping) = (linear.stiffness.clone(), linear.damping.clone());
        let own = |m: &usize| &running.rows[*m];
        for r in cycle.meshes.iter().map(own) {
            let w = row(&r.flanks);
            stiffness -= r.stiffness * w.tr_mul(&w);
            damping -= r.damping * w.tr_mul(&w);
        }
        let slowly = cycle
            .meshes
            .iter()
            .map(|m| quasi_static_compliance(scene, running, *m, &stiffness));
        let slowly = slowly.collect::<Result<_, _>>()?;
        let mut space = AdmissibleMotions::new(&linear.mass)?;
        space.constrain(&scene.constraints());
        let modes = space.modes(&stiffness)?;
        let damping = modes
            .vectors
            .tr_mul(&(space.matrix(&damping) * &modes.vectors));
        let largest = damping.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let n = modes.squares.len();
        let coupled =
            (0..n).any(|i| (0..n).any(|j| i != j && damping[(i, j)].abs() > COUPLED * largest));
        let on = |x: &Vec<f64>| modes.vectors.tr_mul(&space.force(x));
        let rows: Vec<&MeshRow> = cycle.meshes.iter().map(own).collect();
        Ok(Response {
            slowly,
            rest: UnmeshedScene {
                flanks: rows.iter().map(|r| on(&r.flanks)).collect(),
                hubs: rows.iter().map(|r| on(&r.hubs)).collect(),
                grounds: (grounds.iter())
                    .map(|g| [g.stiffness.each_ref().map(on), g.damping.each_ref().map(on)])
                    .collect(),
                squares: modes.squares,
                damping,
                coupled,
            },
            cycle,
            grounds,
        })
    }

    /// Deflection of the teeth and modes of a mesh relative to its hubs.
    fn behind(&self, mesh: usize, answer: &DVector<C>) -> C {
        dot(&self.rest.flanks[mesh], answer) - dot(&self.rest.hubs[mesh], answer)
    }

    /// Number of phases of the cycle.
    fn phases(&self) -> usize {
        self.cycle.phases[0].len()
    }

    /// Computes the response at a mesh frequency [Hz]; `None` if the harmonic balance has no solution.
    pub fn at(&self, frequency: f64) -> Option<GroupVibration> {
        let (p, meshes) = (self.phases(), self.cycle.meshes.len());
        let omega = TAU * frequency;
        let harmonics = (p - 1) / 2;
        let answers: Vec<Vec<DVector<C>>> = (1..=harmonics)
            .map(|k| self.rest.answers(omega * k as f64))
            .collect::<Option<_>>()?;
        let size = meshes * (p + 1);
        let mut matrix = DMatrix::<f64>::zeros(size, size);
        let mut right = DVector::<f64>::zeros(size);
        let derivative = square(&circulant(p, |k| C::new(0.0, omega * k as f64)));
        for a in 0..meshes {
            let phases = &self.cycle.phases[a];
            let mean = mean_of(phases, |x| x.force);
            let soft = mean_of(phases, |x| x.compliance);
            for b in 0..meshes {
                // Closing of the contact of one mesh by the force of another.
                let hubs = circulant(p, |k| -dot(&self.rest.hubs[a], &answers[k - 1][b]));
                let mut closing = square(&hubs);
                if a != b {
                    closing -= square(&circulant(p, |k| self.behind(a, &answers[k - 1][b])));
                } else if self.slowly[a] != 0.0 {
                    let of = |k: usize| self.behind(a, &answers[k - 1][a]) / self.slowly[a];
                    let behind = square(&circulant(p, of));
                    for (i, x) in phases.iter().enumerate() {
                        let row = (x.compliance - x.contact) * behind.row(i);
                        closing.row_mut(i).zip_apply(&row, |to, x| *to -= x);
                    }
                }
                let rate = &derivative * &closing;
                let mut to = matrix.view_mut((a * p, b * p), (p, p));
                for (i, x) in phases.iter().enumerate() {
                    for j in 0..p {
                        to[(i, j)] -=
                            (closing[(i, j)] + x.contact * x.damping * rate[(i, j)]) / soft;
                    }
                }
            }
            for (i, x) in phases.iter().enumerate() {
                matrix[(a * p + i, a * p + i)] += x.contact / soft;
                // The mean closing, by the mean compliance.
                matrix[(a * p + i, meshes * p + a)] = -1.0;
                matrix[(meshes * p + a, a * p + i)] = 1.0;
                right[a * p + i] = (x.compliance * (x.force - mean) - x.closing) / soft;
            }
        }
        let solved = matrix.lu().solve(&right)?;
        let spectra: Vec<Vec<C>> = (0..meshes)
            .map(|a| spectrum(solved.rows(a * p, p).as_slice(), harmonics))
            .collect();
        // The motion by harmonics, in modes.
        let motion: Vec<DVector<C>> = (1..=harmonics)
            .map(|k| {
                let mut x = DVector::<C>::zeros(self.rest.squares.len());
                for (a, spectrum) in spectra.iter().enumerate() {
                    x -= &answers[k - 1][a] * spectrum[k - 1];
                }
                x
            })
            .collect();
        let through = |of: &dyn Fn(usize) -> C| -> Vec<f64> { waves(p, harmonics, of) };
        let answered = (0..meshes).map(|a| {
            let phases = &self.cycle.phases[a];
            let mean = mean_of(phases, |x| x.force);
            MeshVibration {
                mesh: self.cycle.meshes[a],
                error: through(&|k| dot(&self.rest.hubs[a], &motion[k - 1])),
                force: (0..p).map(|i| mean + solved[a * p + i]).collect(),
            }
        });
        let grounds = self.grounds.iter().zip(&self.rest.grounds);
        Some(GroupVibration {
            frequency,
            meshes: answered.collect(),
            grounds: grounds
                .map(|(ground, [springs, dampers])| {
                    [0, 1].map(|d| {
                        through(&|k| {
                            let rate = C::new(0.0, omega * k as f64);
                            let by_motion = dot(&springs[d], &motion[k - 1])
                                + rate * dot(&dampers[d], &motion[k - 1]);
                            let meshes = self.cycle.meshes.iter().zip(&spectra);
                            let by_teeth = meshes.map(|(m, s)| s[k - 1] * ground.of_meshes[d][*m]);
                            by_teeth.fold(by_motion, |sum, x| sum + x)
                        })
                    })
                })
                .collect(),
        })
    }
}

fn mean_of<T>(all: &[T], of: impl Fn(&T) -> f64) -> f64 {
    all.iter().map(of).sum::<f64>() / all.len() as f64
}

/// Product of a real row and a complex vector.
fn dot(row: &DVector<f64>, x: &DVector<C>) -> C {
    row.iter().zip(x).map(|(r, x)| x * *r).sum()
}

impl UnmeshedScene {
    /// Modal motions under unit forces of the meshes at an angular frequency [rad/s].
    fn answers(&self, omega: f64) -> Option<Vec<DVector<C>>> {
        let n = self.squares.len();
        let own = |i: usize| {
            C::new(
                self.squares[i] - omega * omega,
                omega * self.damping[(i, i)],
            )
        };
        if !self.coupled {
            let of = |w: &DVector<f64>| DVector::from_fn(n, |i, _| C::from(w[i]) / own(i));
            return Some(self.flanks.iter().map(of).collect());
        }
        let matrix = DMatrix::from_fn(n, n, |i, j| match i == j {
            true => own(i),
            false => C::new(0.0, omega * self.damping[(i, j)]),
        });
        let lu = matrix.lu();
        let of = |w: &DVector<f64>| lu.solve(&w.map(C::from));
        self.flanks.iter().map(of).collect()
    }
}

/// First column of the circulant matrix that multiplies the harmonics `1 ..` of `p` samples by a factor and removes
/// their mean.
fn circulant(p: usize, factor: impl Fn(usize) -> C) -> Vec<f64> {
    let harmonics = (p - 1) / 2;
    waves(p, harmonics, &|k| factor(k) * (2.0 / p as f64))
}

/// The circulant matrix with a first column.
fn square(column: &[f64]) -> DMatrix<f64> {
    let p = column.len();
    DMatrix::from_fn(p, p, |i, j| column[(p + i - j) % p])
}

/// Samples of `Re sum_k c_k exp(i k phi)`.
fn waves(p: usize, harmonics: usize, of: &dyn Fn(usize) -> C) -> Vec<f64> {
    let mut out = vec![0.0; p];
    for k in 1..=harmonics {
        let c = of(k);
        for (i, out) in out.iter_mut().enumerate() {
            let (sin, cos) = (TAU * ((i * k) % p) as f64 / p as f64).sin_cos();
            *out += c.re * cos - c.im * sin;
        }
    }
    out
}

/// Complex amplitudes of the harmonics `1 ..` of samples over a cycle.
pub fn spectrum(x: &[f64], harmonics: usize) -> Vec<C> {
    let p = x.len();
    let of = |k: usize| {
        let sum: C = (x.iter().enumerate())
            .map(|(i, x)| {
                let (sin, cos) = (TAU * ((i * k) % p) as f64 / p as f64).sin_cos();
                C::new(x * cos, -x * sin)
            })
            .sum();
        sum * (2.0 / p as f64)
    };
    (1..=harmonics).map(of).collect()
}
