//! Hub and body data of every gear, and the functions that follow from them.

use crate::Vec3;
use crate::kinematics::{Hub, Motion, Row, Wrench};
use crate::spec::Freedom;
use gearbench_integrators::FlightPath;
use gearbench_integrators::system::{Coeffs, Singular, StateView};

/// Typical magnitudes that convert a relative tolerance into absolute ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Magnitudes {
    /// Deflection along the line of action [m].
    pub deflection: f64,
    /// Speed along the line of action [m/s].
    pub speed: f64,
}

/// Displacement, speed and momentum of a gear.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HubState {
    /// Angle [rad] or displacement [m] of the hub from the assembled position.
    pub displacement: f64,
    /// Rate of the displacement [rad/s or m/s].
    pub speed: f64,
    /// Angular momentum about the axis [kg m^2/s], or momentum along the motion of a rack [kg m/s].
    pub momentum: f64,
}

/// Hub that carries a gear, with the data of a rigid body on it as defaults for all models.
#[derive(Clone, Debug, PartialEq)]
pub struct HubBody {
    /// Hub with its mount.
    pub hub: Hub,
    /// Deflection on the line of action per unit of the hub coordinate: base radius [m], or `cos(alpha)` of a rack.
    pub effective_base_radius: f64,
    /// Number of coordinates of the gear in addition to those of the hub.
    pub own: usize,
    /// Length of the gear's discrete state.
    pub discrete: usize,
    /// Effective mass of a contact at first, `1 / (w^T M^-1 w)` of its row [kg]; infinite for a fixed or driven gear.
    pub contact_mass: f64,
    /// Shortest natural time `1/omega` of the own coordinates of the gear [s]; infinite without any.
    pub characteristic_time: f64,
    /// Deflection on the line of action per unit of each coordinate; missing entries are that of the hub.
    pub scales: Vec<f64>,
    /// Diagonal of the mass matrix where it is constant and diagonal; missing entries are the inertia of the hub.
    pub masses: Vec<f64>,
    /// Rotation (displacement) of the hub per unit of each own coordinate; empty where they do not move it.
    pub hub_shapes: Vec<f64>,
    /// True if no power is lost or supplied in the own coordinates, except by a driven hub.
    pub conservative: bool,
    /// Retardation time of the body [s]: the factor of its stiffness in damping proportional to it. Flanks in contact have
    /// it as well.
    pub retardation: f64,
}

impl HubBody {
    /// Creates a rigid body on its hub.
    #[must_use]
    pub fn new(hub: Hub, effective_base_radius: f64) -> Self {
        let contact_mass = if hub.is_free() {
            hub.inertia / effective_base_radius.powi(2)
        } else {
            f64::INFINITY
        };
        let (mut scales, mut masses) = (Vec::new(), Vec::new());
        if let Some(lateral) = &hub.lateral {
            if hub.is_free() {
                scales.push(effective_base_radius);
                masses.push(hub.inertia);
            }
            let of_directions = lateral.masses();
            for d in lateral.free(hub.moving()) {
                // A turn moves the flanks by a length of the size of the gear.
                scales.push(if d < 3 { 1.0 } else { effective_base_radius });
                masses.push(of_directions[d]);
            }
        }
        let stiffest = hub
            .lateral
            .as_ref()
            .map_or(0.0, |l| l.fastest(hub.moving()));
        HubBody {
            characteristic_time: 1.0 / stiffest,
            hub,
            effective_base_radius,
            own: 0,
            discrete: 0,
            contact_mass,
            scales,
            masses,
            hub_shapes: Vec::new(),
            conservative: false,
            retardation: 0.0,
        }
    }

    /// Returns true if the gear has internal forces, of own coordinates or of a bearing.
    pub fn is_internal(&self) -> bool {
        self.own > 0 || self.hub.lateral.is_some()
    }

    /// Returns the index of the first own coordinate; the coordinates of the hub come first.
    #[inline]
    pub fn first(&self) -> usize {
        self.hub.coordinates()
    }

    /// Returns the number of all coordinates.
    pub fn len(&self) -> usize {
        self.hub.coordinates() + self.own
    }

    /// Returns true when the gear has no coordinate.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the angle or displacement of the hub.
    #[inline]
    pub fn displacement_at(&self, at: StateView<'_>) -> f64 {
        self.hub.displacement(at.t, at.q)
    }

    /// Returns the speed of the hub coordinate.
    #[inline]
    pub fn speed_at(&self, at: StateView<'_>) -> f64 {
        self.hub.speed(at.t, at.v)
    }

    /// Returns the speed of the hub at which loads act: that of its coordinate plus the contribution of own
    /// coordinates.
    #[inline]
    pub fn load_speed(&self, at: StateView<'_>) -> f64 {
        let speed = self.speed_at(at);
        if self.hub_shapes.is_empty() {
            return speed;
        }
        speed + self.over_shapes(at.v)
    }

    /// Returns the rotation of the hub by the own coordinates.
    pub fn over_shapes(&self, x: &[f64]) -> f64 {
        let own = self.hub_shapes.iter().zip(&x[self.first()..]);
        own.map(|(w, x)| w * x).sum()
    }

    /// Adds a load on a free hub [N m or N].
    #[inline]
    pub fn add_load(&self, load: f64, f: &mut [f64]) {
        if self.is_free() {
            f[0] += load;
            let first = self.first();
            for (f, h) in f[first..].iter_mut().zip(&self.hub_shapes) {
                *f += h * load;
            }
        }
    }

    /// Appends `d(x . n)/dq` of a point that moves with the hub; returns the part of `d(x . n)/dt` [m/s] from a
    /// prescribed motion.
    #[inline]
    pub fn row(&self, at: StateView<'_>, x: &Vec3, n: &Vec3, row: &mut Row) -> f64 {
        self.hub.point_row(at.t, at.q, x, n, row)
    }

    /// Writes typical magnitudes of the coordinates and their rates.
    pub fn magnitudes(&self, m: Magnitudes, q: &mut [f64], v: &mut [f64]) {
        let scales = self.scales.iter().copied();
        let scales = scales.chain(std::iter::repeat(self.effective_base_radius));
        for ((q, v), scale) in q.iter_mut().zip(v).zip(scales) {
            *q = m.deflection / scale;
            *v = m.speed / scale;
        }
    }

    /// Writes the diagonal of the mass matrix.
    pub fn diagonal_mass(&self, out: &mut [f64]) {
        let masses = self.masses.iter().copied();
        let masses = masses.chain(std::iter::repeat(self.hub.inertia));
        out.iter_mut().zip(masses).for_each(|(out, m)| *out = m);
    }

    /// Adds the bearing forces and the gyroscopic terms of the body to the forces on the hub coordinates.
    pub fn add_lateral_forces(&self, at: StateView<'_>, f: &mut [f64]) {
        let Some(lateral) = &self.hub.lateral else {
            return;
        };
        let motion = self.hub.motion(at.t, at.q, at.v);
        let all = lateral.forces(&motion);
        for (f, d) in f.iter_mut().zip(self.hub.free_directions()) {
            *f += all[d];
        }
    }

    /// Returns the energy of the bearing springs [J], and the power of the bearing dampers [W].
    pub fn bearing_energy(&self, at: StateView<'_>) -> [f64; 2] {
        match &self.hub.lateral {
            None => [0.0; 2],
            Some(l) => l.bearing_energy(&self.hub.motion(at.t, at.q, at.v)),
        }
    }

    /// Returns [`Hub::reaction`] plus the bearing forces in the free directions.
    pub fn reaction_at(&self, at: StateView<'_>, contact: &Wrench) -> Wrench {
        let mut reaction = self.hub.reaction(at.t, contact);
        let Some(lateral) = &self.hub.lateral else {
            return reaction;
        };
        let motion = self.hub.motion(at.t, at.q, at.v);
        let exerted = lateral.bearing_forces(&motion);
        for d in (0..3).filter(|d| *d != self.hub.moving()) {
            let axis = &self.hub.axes[d];
            let along = match lateral.directions[d] {
                Freedom::Free => exerted[d],
                _ => lateral.body.mass * motion.prescribed[d] - contact.force.dot(axis),
            };
            reaction.force += (along - reaction.force.dot(axis)) * axis;
        }
        reaction
    }

    /// Returns the kinetic energy of the free directions of a rigid body [J].
    pub fn kinetic(&self, at: StateView<'_>) -> f64 {
        let n = self.first();
        match &self.hub.lateral {
            Some(l) if l.spins => {
                let mut momentum = [0.0; 6];
                self.apply_mass(at, at.v, &mut momentum[..n]);
                0.5 * momentum.iter().zip(at.v).map(|(p, v)| p * v).sum::<f64>()
            }
            _ => {
                let masses = self.masses.iter().copied();
                let masses = masses.chain(std::iter::repeat(self.hub.inertia));
                let of = masses.zip(&at.v[..n]);
                0.5 * of.map(|(m, v)| m * v * v).sum::<f64>()
            }
        }
    }

    /// Multiplies by the mass matrix of a rigid body with spin terms: `y = M x`.
    pub fn apply_mass(&self, at: StateView<'_>, x: &[f64], y: &mut [f64]) {
        let Some(lateral) = &self.hub.lateral else {
            return;
        };
        let mass = lateral.mass_matrix(&self.hub.motion(at.t, at.q, at.v).x);
        for (y, i) in y.iter_mut().zip(self.hub.free_directions()) {
            let row = self.hub.free_directions().zip(x);
            *y = row.map(|(j, x)| mass[i][j] * x).sum();
        }
    }

    /// Solves with the block of the hub in the iteration matrix of [`GearModel::correct`](super::GearModel::correct),
    /// in place.
    pub fn correct(
        &self,
        at: StateView<'_>,
        c: Coeffs,
        hub_damping: f64,
        x: &mut [f64],
    ) -> Result<(), Singular> {
        if let Some(lateral) = &self.hub.lateral {
            let motion = self.hub.motion(at.t, at.q, at.v);
            let own = (self.hub.moving(), self.hub.is_free());
            let of_hub = (self.hub.inertia, c.d * hub_damping);
            return lateral.correct(own, &motion, [c.m, c.d, c.k], of_hub, x);
        }
        let a = c.m * self.hub.inertia + c.d * hub_damping;
        for x in x {
            if a == 0.0 {
                return Err(Singular);
            }
            *x /= a;
        }
        Ok(())
    }

    /// Solves with the block of the out-of-plane directions alone, for gears whose own motion has a separate block.
    pub fn correct_lateral(
        &self,
        at: StateView<'_>,
        c: Coeffs,
        x: &mut [f64],
    ) -> Result<(), Singular> {
        let Some(lateral) = &self.hub.lateral else {
            return Ok(());
        };
        let motion = self.hub.motion(at.t, at.q, at.v);
        let own = (self.hub.moving(), false);
        // The coupling of spin terms with the own motion is left to the iteration.
        lateral.correct(own, &motion, [c.m, c.d, c.k], (self.hub.inertia, 0.0), x)
    }

    /// Adds the change of [`Self::add_lateral_forces`] by central differences.
    pub fn add_lateral_tangent(&self, at: StateView<'_>, [dq, dv]: [&[f64]; 2], df: &mut [f64]) {
        let Some(lateral) = &self.hub.lateral else {
            return;
        };
        let now = self.hub.motion(at.t, at.q, at.v);
        let mut along = Motion::default();
        for (k, d) in self.hub.free_directions().enumerate() {
            (along.x[d], along.v[d]) = (dq[k], dv[k]);
        }
        let change = lateral.force_change(&now, &along);
        for (df, d) in df.iter_mut().zip(self.hub.free_directions()) {
            *df += change[d];
        }
    }

    /// Returns the change of the bearing forces on the hub coordinates, from a change of these and of their rates.
    pub fn bearing_change(&self, at: StateView<'_>, [dq, dv]: [&[f64]; 2]) -> Vec<f64> {
        let mut change = vec![0.0; dq.len()];
        if let Some(lateral) = &self.hub.lateral {
            let now = self.hub.motion(at.t, at.q, at.v);
            let mut along = Motion::default();
            for (k, d) in self.hub.free_directions().enumerate() {
                (along.x[d], along.v[d]) = (dq[k], dv[k]);
            }
            let all = lateral.bearing_change(&now, &along);
            let free = change.iter_mut().zip(self.hub.free_directions());
            free.for_each(|(to, d)| *to = all[d]);
        }
        change
    }

    /// Returns the power [W] that driven directions transfer to the free ones through spin terms.
    pub fn driven_power(&self, at: StateView<'_>) -> f64 {
        let Some(lateral) = self.hub.lateral.as_ref().filter(|l| l.spins) else {
            return 0.0;
        };
        let all = self.hub.motion(at.t, at.q, at.v);
        let mut free = all;
        free.prescribed = [0.0; 6];
        for d in 0..6 {
            if !self.hub.free_directions().any(|f| f == d) {
                free.v[d] = 0.0;
            }
        }
        let (with, without) = (lateral.spin_forces(&all), lateral.spin_forces(&free));
        let of = self.hub.free_directions().zip(at.v);
        of.map(|(d, v)| (with[d] - without[d]) * v).sum()
    }

    /// Returns motion and momentum of a body that moves as its hub does.
    pub fn state(&self, at: StateView<'_>) -> HubState {
        let speed = self.speed_at(at);
        HubState {
            displacement: self.displacement_at(at),
            speed,
            momentum: self.hub.inertia * speed,
        }
    }

    /// Returns displacement, speed and acceleration of a frame that moves as the hub does under a steady `load`.
    pub fn frame(&self, at: StateView<'_>, load: f64) -> [f64; 3] {
        [
            self.displacement_at(at),
            self.speed_at(at),
            self.hub.acceleration(at.t, load),
        ]
    }

    /// Adds the motion of the hub under a steady `load` to a closed-form path, if the hub is free.
    pub fn add_to_path(&self, at: StateView<'_>, load: f64, first: usize, path: &mut FlightPath) {
        if self.is_free() {
            let acceleration = self.hub.acceleration(at.t, load);
            path.oscillator(0.0, 0.0, [at.q[0], at.v[0]], acceleration);
            path.moves(first, 1.0);
        }
    }

    /// Returns true if power may be lost or supplied.
    pub fn has_powers(&self) -> bool {
        !self.conservative || self.hub.is_driven() || self.hub.lateral.is_some()
    }
}

impl std::ops::Deref for HubBody {
    type Target = Hub;

    #[inline]
    fn deref(&self) -> &Hub {
        &self.hub
    }
}

impl std::ops::DerefMut for HubBody {
    fn deref_mut(&mut self) -> &mut Hub {
        &mut self.hub
    }
}
