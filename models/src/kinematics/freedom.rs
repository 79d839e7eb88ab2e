//! Out-of-plane directions of a hub (fixed, free on a bearing, or driven) and the inertia of a body that moves in
//! them.
//!
//! With the displacement `u` of the hub along its axes and the Cardan angles `alpha`, `beta` of its tilt the body stands at
//! `R = Rx(alpha) Ry(beta) Rz(gamma)`; `gamma` is the gear's own turn (of a rack a third tilt). Velocity and spin are linear
//! in the rates `x' = (u', alpha', beta', gamma')`: the axes of the three rotations are `e_x`, `Rx e_y`, `Rx Ry e_z`. With
//! the centre of mass at `c` from the hub (D'Alembert in the form of Jourdain),
//!
//! ```text
//! sum_j M_ij x_j'' = Q_i - m v_i . (w_b x c + w x (w x c)) - w_i . (I w_b + w x I w)
//! M_ij = m v_i . v_j + w_i . I w_j,     w_b = sum over i < j of x_i' x_j' (w_i x w_j)
//! ```
//!
//! `v_i`, `w_i` velocity of the centre of mass and spin by a unit rate. The terms of second order in the rates, and that `M`
//! turns with the body, are the **spin terms**: gyroscopic, centrifugal and Coriolis. Without them each direction has a mass
//! of its own and keeps it. The tilt is singular at 90 degrees, where no gear is in mesh.
//!
//! The bearing exerts `-K x - C x'` on the hub; with a clearance `c` the radial part is `-k (r - c) e_r`.

use crate::Vec3;
use crate::spec::{Bearing, Freedom};
use gearbench_integrators::dense_solve::solve_in_place;
use gearbench_integrators::system::Singular;
use nalgebra::Matrix3;

/// Mass properties of a body on a hub.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyMass {
    /// Mass of the body [kg].
    pub mass: f64,
    /// Inertia tensor about the centre of mass, in the axes of the hub at the assembled position [kg m^2].
    pub inertia: Matrix3<f64>,
    /// Position of the centre of mass from the hub, in the same axes [m].
    pub centre: Vec3,
}

impl BodyMass {
    /// Returns true if the gear axis is an axis of symmetry: the mass matrix does not change with its rotation.
    pub fn is_round(&self) -> bool {
        let i = &self.inertia;
        let off = i[(0, 1)].abs() + i[(0, 2)].abs() + i[(1, 2)].abs();
        let uneven = (i[(0, 0)] - i[(1, 1)]).abs() + off;
        self.centre == Vec3::zeros() && uneven <= 1e-9 * i.trace()
    }
}

/// Freedom of a hub in addition to its own rotation or translation.
#[derive(Clone, Debug, PartialEq)]
pub struct OutOfPlane {
    /// Freedom of three translations and three rotations; the entry of the hub's own motion is not used.
    pub directions: [Freedom; 6],
    /// Bearing of the hub.
    pub bearing: Bearing,
    /// Mass properties of the body.
    pub body: BodyMass,
    /// True if gyroscopic, centrifugal and Coriolis terms act.
    pub spins: bool,
}

/// Position, rate and prescribed acceleration of a hub in its six directions.
#[derive(Clone, Copy, Debug, Default)]
pub struct Motion {
    /// Displacements [m] and rotations [rad].
    pub x: [f64; 6],
    /// Velocities [m/s] and angular velocities [rad/s].
    pub v: [f64; 6],
    /// Accelerations of driven directions; otherwise zero.
    pub prescribed: [f64; 6],
}

impl OutOfPlane {
    /// Iterates over the free directions in the order of their coordinates; `own` is that of the hub's own motion.
    pub fn free(&self, own: usize) -> impl Iterator<Item = usize> + '_ {
        (0..6).filter(move |d| *d != own && self.directions[*d] == Freedom::Free)
    }

    /// Returns the number of out-of-plane coordinates.
    pub fn coordinates(&self) -> usize {
        let free = |d: &&Freedom| **d == Freedom::Free;
        self.directions.iter().filter(free).count()
    }

    /// Adds positions and rates of the out-of-plane directions; `q` and `v` begin with their coordinates.
    pub fn fill(&self, own: usize, t: f64, q: &[f64], v: &[f64], motion: &mut Motion) {
        let mut next = 0;
        for (d, freedom) in self.directions.iter().enumerate() {
            match freedom {
                _ if d == own => {}
                Freedom::Fixed => {}
                Freedom::Free => {
                    motion.x[d] = q[next];
                    // For the position alone the rates are empty.
                    motion.v[d] = v.get(next).copied().unwrap_or(0.0);
                    next += 1;
                }
                Freedom::Driven(speed) => {
                    motion.x[d] = speed.integral(t);
                    motion.v[d] = speed.value(t);
                    motion.prescribed[d] = speed.slope(t);
                }
            }
        }
    }

    /// Returns the masses of the six directions without spin terms [kg], [kg m^2].
    pub fn masses(&self) -> [f64; 6] {
        let (m, i) = (self.body.mass, &self.body.inertia);
        [m, m, m, i[(0, 0)], i[(1, 1)], i[(2, 2)]]
    }

    /// Returns the highest angular frequency of a direction on the bearing alone [rad/s].
    pub fn fastest(&self, own: usize) -> f64 {
        let masses = self.masses();
        let of = |d: usize| (self.bearing.stiffness[d][d] / masses[d]).sqrt();
        self.free(own).map(of).fold(0.0, f64::max)
    }

    /// Returns the bearing forces in the six directions.
    pub fn bearing_forces(&self, m: &Motion) -> [f64; 6] {
        let b = &self.bearing;
        let mut f = [0.0; 6];
        for (i, f) in f.iter_mut().enumerate() {
            for j in 0..6 {
                *f -= b.stiffness[i][j] * m.x[j] + b.damping[i][j] * m.v[j];
            }
        }
        let (short, along) = self.play(&m.x);
        for i in 0..2 {
            f[i] += b.stiffness[0][0] * short * along[i];
        }
        f
    }

    /// Returns the effective clearance of the radial spring, and its direction.
    fn play(&self, x: &[f64; 6]) -> (f64, [f64; 2]) {
        let c = self.bearing.clearance;
        let r = x[0].hypot(x[1]);
        if c == 0.0 || r == 0.0 {
            return (0.0, [0.0; 2]);
        }
        (r.min(c), [x[0] / r, x[1] / r])
    }

    /// Returns the energy in the springs [J], and the power of the dampers [W].
    pub fn bearing_energy(&self, m: &Motion) -> [f64; 2] {
        let b = &self.bearing;
        let form = |a: &[[f64; 6]; 6], x: &[f64; 6]| -> f64 {
            let row = |i: usize| (0..6).map(|j| a[i][j] * x[j]).sum::<f64>() * x[i];
            (0..6).map(row).sum()
        };
        let (short, _) = self.play(&m.x);
        let r = m.x[0].hypot(m.x[1]);
        let saved = b.stiffness[0][0] * short * (2.0 * r - short);
        [
            0.5 * (form(&b.stiffness, &m.x) - saved),
            form(&b.damping, &m.v),
        ]
    }

    /// Returns the angular frequencies and damping ratios of the directions, or `None` where these are coupled or do
    /// not oscillate.
    pub fn oscillators(&self, own: usize) -> Option<Vec<[f64; 2]>> {
        let b = &self.bearing;
        let turns = b.stiffness[own][own] != 0.0 || b.damping[own][own] != 0.0;
        if self.spins || b.clearance > 0.0 || turns {
            return None;
        }
        let masses = self.masses();
        let of = |d: usize| {
            let others = (0..6).filter(|j| *j != d);
            let mut coupled = others.map(|j| (b.stiffness[d][j], b.damping[d][j]));
            if coupled.any(|(k, c)| k != 0.0 || c != 0.0) {
                return None;
            }
            let omega = (b.stiffness[d][d] / masses[d]).sqrt();
            let c = b.damping[d][d];
            match (omega > 0.0, c == 0.0) {
                (_, true) => Some([omega, 0.0]),
                (true, false) => Some([omega, 0.5 * c / (masses[d] * omega)]),
                (false, false) => None,
            }
        };
        self.free(own).map(of).collect()
    }

    /// Returns the velocities of the centre of mass and the angular velocities for unit rates, and the position of the
    /// centre of mass and the inertia in the axes of the hub.
    fn unit_motions(&self, x: &[f64; 6]) -> ([Vec3; 6], [Vec3; 6], Vec3, Matrix3<f64>) {
        let axes = rotation_axes(x);
        let turned = tilted(x) * turn(x[5]);
        let c = turned * self.body.centre;
        let inertia = turned * self.body.inertia * turned.transpose();
        let (mut v, mut w) = ([Vec3::zeros(); 6], [Vec3::zeros(); 6]);
        for d in 0..3 {
            v[d][d] = 1.0;
            w[3 + d] = axes[d];
            v[3 + d] = axes[d].cross(&c);
        }
        (v, w, c, inertia)
    }

    /// Returns the mass matrix with the active terms; `inertia` is that of the own motion without spin terms.
    pub fn mass(&self, x: &[f64; 6], own: usize, inertia: f64) -> [[f64; 6]; 6] {
        if self.spins {
            return self.mass_matrix(x);
        }
        let mut diagonal = [[0.0; 6]; 6];
        for (d, mass) in self.masses().into_iter().enumerate() {
            diagonal[d][d] = if d == own { inertia } else { mass };
        }
        diagonal
    }

    /// Returns the mass matrix in the six directions, including spin terms.
    pub fn mass_matrix(&self, x: &[f64; 6]) -> [[f64; 6]; 6] {
        let (v, w, _, inertia) = self.unit_motions(x);
        let m = self.body.mass;
        let mut out = [[0.0; 6]; 6];
        for i in 0..6 {
            for j in 0..6 {
                out[i][j] = m * v[i].dot(&v[j]) + w[i].dot(&(inertia * w[j]));
            }
        }
        out
    }

    /// Returns the spin terms as forces, including the inertia forces of prescribed accelerations.
    pub fn spin_forces(&self, m: &Motion) -> [f64; 6] {
        let (v, w, c, inertia) = self.unit_motions(&m.x);
        let spin: Vec3 = (3..6).map(|d| m.v[d] * w[d]).sum();
        let mut second = Vec3::zeros();
        for i in 3..6 {
            for j in i + 1..6 {
                second += m.v[i] * m.v[j] * w[i].cross(&w[j]);
            }
        }
        let mut a = second.cross(&c) + spin.cross(&spin.cross(&c));
        for (d, prescribed) in m.prescribed.iter().enumerate() {
            a += *prescribed * v[d];
            second += *prescribed * w[d];
        }
        let torque = inertia * second + spin.cross(&(inertia * spin));
        std::array::from_fn(|i| -self.body.mass * v[i].dot(&a) - w[i].dot(&torque))
    }

    /// Returns the sum of bearing forces and spin terms.
    pub fn forces(&self, m: &Motion) -> [f64; 6] {
        let mut f = self.bearing_forces(m);
        if self.spins {
            let spin = self.spin_forces(m);
            f.iter_mut().zip(spin).for_each(|(f, s)| *f += s);
        }
        f
    }

    /// Returns the change of [`Self::forces`] for changes of position and rate, by central differences, which are
    /// exact for a bearing without clearance.
    pub fn force_change(&self, m: &Motion, along: &Motion) -> [f64; 6] {
        change_of(|m| self.forces(m), m, along)
    }

    /// Returns the change of [`Self::bearing_forces`] for changes of position and rate.
    pub fn bearing_change(&self, m: &Motion, along: &Motion) -> [f64; 6] {
        change_of(|m| self.bearing_forces(m), m, along)
    }

    /// Returns the change of [`Self::spin_forces`] for changes of position and rate.
    pub fn spin_change(&self, m: &Motion, along: &Motion) -> [f64; 6] {
        change_of(|m| self.spin_forces(m), m, along)
    }

    /// Solves `x <- A^-1 x` over the free directions, `A = c_m M + c_d (C - dF/dx') + c_k (K - dF/dx)`; `hub` is a
    /// further term of the own motion, `inertia` its mass without spin terms.
    ///
    /// # Errors
    /// The matrix is singular.
    pub fn correct(
        &self,
        (own, free): (usize, bool),
        m: &Motion,
        [c_m, c_d, c_k]: [f64; 3],
        (inertia, hub): (f64, f64),
        x: &mut [f64],
    ) -> Result<(), Singular> {
        let directions = free.then_some(own).into_iter().chain(self.free(own));
        let (list, n) = listed(directions);
        let list = &list[..n];
        let mass = self.mass(&m.x, own, inertia);
        let mut a = [0.0; 36];
        for (j, &dj) in list.iter().enumerate() {
            let mut along = Motion::default();
            (along.x[dj], along.v[dj]) = (c_k, c_d);
            let change = self.force_change(m, &along);
            for (i, &di) in list.iter().enumerate() {
                a[i * n + j] = c_m * mass[di][dj] - change[di];
            }
        }
        if free {
            a[0] += hub;
        }
        solve_in_place(&mut a[..n * n], &mut x[..n])
    }
}

/// Lists some of the six directions, and returns their number.
pub fn listed(directions: impl Iterator<Item = usize>) -> ([usize; 6], usize) {
    let (mut list, mut n) = ([0; 6], 0);
    for d in directions {
        list[n] = d;
        n += 1;
    }
    (list, n)
}

/// Returns the change of forces for changes of position and rate, by central differences.
fn change_of(of_motion: impl Fn(&Motion) -> [f64; 6], m: &Motion, along: &Motion) -> [f64; 6] {
    let mut change = [0.0; 6];
    let largest = |x: &[f64; 6]| x.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let parts = [
        (&along.x, &[0.0; 6], 1e-7 / largest(&along.x)),
        (
            &[0.0; 6],
            &along.v,
            1e-4 * (1.0 + largest(&m.v)) / largest(&along.v),
        ),
    ];
    for (dx, dv, h) in parts {
        if !h.is_finite() {
            continue;
        }
        let of = |h: f64| {
            let mut moved = *m;
            for d in 0..6 {
                moved.x[d] += h * dx[d];
                moved.v[d] += h * dv[d];
            }
            of_motion(&moved)
        };
        let (up, down) = (of(h), of(-h));
        for d in 0..6 {
            change[d] += 0.5 * (up[d] - down[d]) / h;
        }
    }
    change
}

/// Returns the rotation `Rx(alpha) Ry(beta)`.
pub(super) fn tilted(x: &[f64; 6]) -> Matrix3<f64> {
    let ((sa, ca), (sb, cb)) = (x[3].sin_cos(), x[4].sin_cos());
    Matrix3::new(cb, 0.0, sb, sa * sb, ca, -sa * cb, -ca * sb, sa, ca * cb)
}

/// Returns the rotation `Rz(gamma)`.
pub(super) fn turn(gamma: f64) -> Matrix3<f64> {
    let (s, c) = gamma.sin_cos();
    Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0)
}

/// Returns the axes of the three rotations.
pub(super) fn rotation_axes(x: &[f64; 6]) -> [Vec3; 3] {
    let tilted = tilted(x);
    [Vec3::x(), tilted.column(1).into(), tilted.column(2).into()]
}
