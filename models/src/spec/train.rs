//! Kinematics of the whole train of a scene: speeds of its members at which all meshes are in step, and the flanks
//! that its loads close.
//!
//! Members are the gears and, behind them, the bodies without teeth. With the signed effective radii `R` of the gears `a`
//! and `b` of a mesh and the speed `W` of the carrier that they stand on (zero on fixed axes) flanks approach each other
//! along the line of action at
//!
//! `c = R_a (w_a - W) + R_b (w_b - W)`
//!
//! (left flanks; right flanks at `-c`). In step all `c` are zero, the members of a shaft have one speed, those of a stage
//! have speeds in its ratio, and held hubs have none. These equations `G w = 0` are linear and do not depend on the
//! position of the teeth. The same rows give the normal forces of rigid gears that stay in mesh: `M a = T - G' N` and
//! `G a = 0`, so that `G M^-1 G' N = G M^-1 T`; a positive `N` presses left flanks, a negative one right flanks.

use super::scene::{MeshSpec, SceneSpec};
use super::signed_effective_radius;
use super::{BodySpec, Load, Mount, StageSpec, effective_radius, initial_speed};
use nalgebra::{DMatrix, DVector};

/// Magnitude below which a coefficient is rounding: ratios of teeth are of order one.
const ROUNDING: f64 = 1e-9;

/// Kinematics of the train of a scene.
#[derive(Clone, Debug)]
pub struct Train<'s> {
    spec: &'s SceneSpec,
    bodies: Vec<&'s BodySpec>,
    /// Carrier of every gear, as a member.
    carriers: Vec<Option<usize>>,
    /// Initial speeds of the members.
    speeds: Vec<f64>,
    /// One equation of every mesh, in the order of the meshes, then one of every pair of neighbours on a shaft and of
    /// every stage.
    rows: Vec<Vec<f64>>,
    /// For every member, the first one of those with dependent motions.
    joined: Vec<usize>,
    /// The `rows` with those of the fixed hubs, solved for as many speeds as they determine.
    equations: Equations,
}

/// Linear equations for the speeds, each solved for one of them.
#[derive(Clone, Debug, Default)]
struct Equations {
    /// Index of the speed that the row is solved for, and the row with its right-hand side.
    solved: Vec<(usize, Vec<f64>)>,
}

impl Equations {
    /// Adds an equation; returns `false` where the others already imply it.
    fn add(&mut self, mut row: Vec<f64>) -> bool {
        for (pivot, solved) in &self.solved {
            subtract(&mut row, *pivot, solved);
        }
        let n = row.len() - 1;
        let Some(pivot) = (0..n).max_by(|a, b| row[*a].abs().total_cmp(&row[*b].abs())) else {
            return false;
        };
        if row[pivot].abs() < ROUNDING {
            return false;
        }
        let scale = row[pivot];
        row.iter_mut().for_each(|x| *x /= scale);
        for (_, solved) in &mut self.solved {
            subtract(solved, pivot, &row);
        }
        self.solved.push((pivot, row));
        true
    }

    /// Returns true if the equations alone determine a speed.
    fn determine(&self, member: usize) -> bool {
        (self.solved.iter()).any(|(pivot, row)| {
            let n = row.len() - 1;
            *pivot == member && (0..n).all(|j| j == member || row[j].abs() < ROUNDING)
        })
    }
}

/// Subtracts the multiple of a row that makes the coefficient of `pivot` zero.
fn subtract(row: &mut [f64], pivot: usize, solved: &[f64]) {
    let factor = row[pivot];
    if factor != 0.0 {
        row.iter_mut()
            .zip(solved)
            .for_each(|(x, y)| *x -= factor * y);
        row[pivot] = 0.0;
    }
}

/// Groups members that equations join: returns for every member the first one of its group.
fn components(members: usize, rows: &[Vec<f64>]) -> Vec<usize> {
    let mut first: Vec<usize> = (0..members).collect();
    for row in rows {
        let of_row = || (0..members).filter(|i| row[*i] != 0.0);
        let Some(least) = of_row().map(|i| first[i]).min() else {
            continue;
        };
        let merged: Vec<usize> = of_row().map(|i| first[i]).collect();
        for place in &mut first {
            if merged.contains(place) {
                *place = least;
            }
        }
    }
    first
}

impl<'s> Train<'s> {
    /// Builds the train of a scene.
    pub fn new(spec: &'s SceneSpec) -> Self {
        let bodies: Vec<&BodySpec> = spec.bodies().collect();
        let gears = spec.gears.len();
        let carries = |gear: usize| bodies.iter().position(|b| b.planets.contains(&gear));
        let carriers = (0..gears).map(|g| carries(g).map(|b| gears + b)).collect();
        let speeds = (spec.gears.iter())
            .map(|g| initial_speed(&g.mount, g.speed))
            .chain(bodies.iter().map(|b| initial_speed(&b.mount, b.speed)))
            .collect();
        let mut train = Train {
            spec,
            bodies,
            carriers,
            speeds,
            rows: Vec::new(),
            joined: Vec::new(),
            equations: Equations::default(),
        };
        let meshes = spec.meshes.iter().map(|m| train.mesh_row(m));
        let others = train.shaft_rows().into_iter().chain(train.stage_rows());
        train.rows = meshes.chain(others).collect();
        let n = train.members();
        train.joined = components(n, &train.rows);
        let held = (0..n).filter(|i| matches!(train.mount(*i), Mount::Fixed));
        let held = held.map(|i| train.row([(i, 1.0)]));
        let all: Vec<Vec<f64>> = train.rows.iter().cloned().chain(held).collect();
        for mut row in all {
            row.push(0.0);
            train.equations.add(row);
        }
        train
    }

    /// Returns the number of gears and bodies.
    pub fn members(&self) -> usize {
        self.speeds.len()
    }

    /// Returns the initial speed of a member [rad/s or m/s].
    pub fn speed(&self, member: usize) -> f64 {
        self.speeds[member]
    }

    /// Returns the mount of a member.
    pub fn mount(&self, member: usize) -> &'s Mount {
        match self.spec.gears.get(member) {
            Some(gear) => &gear.mount,
            None => &self.bodies[member - self.spec.gears.len()].mount,
        }
    }

    /// Returns the loads of a member.
    pub fn loads(&self, member: usize) -> &'s [Load] {
        match self.spec.gears.get(member) {
            Some(gear) => &gear.loads,
            None => &self.bodies[member - self.spec.gears.len()].loads,
        }
    }

    /// Returns the carrier of the gears of a mesh, as a member.
    pub fn carrier_of(&self, mesh: &MeshSpec) -> Option<usize> {
        mesh.gears.iter().find_map(|g| self.carriers[*g])
    }

    /// Returns the members whose motions depend on that of `member`, including itself, in ascending order.
    pub fn joined(&self, member: usize) -> Vec<usize> {
        let same = |i: &usize| self.joined[*i] == self.joined[member];
        (0..self.members()).filter(same).collect()
    }

    /// Returns true if fixed hubs leave a member no motion at which the meshes are in step.
    pub fn is_held(&self, member: usize) -> bool {
        self.equations.determine(member)
    }

    /// Returns speeds in step with as many of the initial speeds as are consistent; of two that are not, the first one
    /// in `order` counts.
    pub fn in_step(&self, order: &[usize]) -> Vec<f64> {
        let mut equations = self.equations.clone();
        let all = order.iter().copied().chain(0..self.members());
        for member in all {
            let mut row = self.row([(member, 1.0)]);
            row.push(self.speeds[member]);
            equations.add(row);
        }
        let mut speeds = vec![0.0; self.members()];
        for (pivot, row) in &equations.solved {
            speeds[*pivot] = row[row.len() - 1];
        }
        speeds
    }

    /// Returns the speed at which the left flanks of a mesh approach each other (right flanks separate) at speeds of
    /// the members, and the larger of the speeds of both flanks along the line of action [m/s].
    pub fn approach(&self, mesh: usize, speeds: &[f64]) -> (f64, f64) {
        let of = &self.spec.meshes[mesh];
        let carrier = self.carrier_of(of).map_or(0.0, |c| speeds[c]);
        let [a, b] = of
            .gears
            .map(|g| signed_effective_radius(&self.spec.gears[g].body) * (speeds[g] - carrier));
        (a + b, a.abs().max(b.abs()))
    }

    /// Returns the normal forces of the meshes [N] under constant loads of the members [N m or N]: positive on left
    /// flanks, negative on right ones. Meshes that share a load in a statically indeterminate way, as those of several
    /// planets do, have the least-squares solution.
    pub fn forces(&self, loads: &[f64]) -> Vec<f64> {
        let mobility: Vec<f64> = self.mobility();
        let (rows, n) = (self.rows.len(), self.members());
        let g = DMatrix::from_fn(rows, n, |i, j| self.rows[i][j]);
        let moved = DMatrix::from_fn(n, rows, |i, j| mobility[i] * self.rows[j][i]);
        let right = DVector::from_fn(rows, |i, _| {
            (0..n)
                .map(|j| self.rows[i][j] * mobility[j] * loads[j])
                .sum()
        });
        // Rows to the scale of one: radii are lengths, a coupling of a shaft is a number.
        let matrix = g * moved;
        let scale = DVector::from_fn(rows, |i, _| match matrix[(i, i)] {
            x if x > 0.0 => 1.0 / x.sqrt(),
            _ => 0.0,
        });
        let scaled = DMatrix::from_fn(rows, rows, |i, j| scale[i] * matrix[(i, j)] * scale[j]);
        let solved = match scaled.pseudo_inverse(ROUNDING) {
            Ok(inverse) => inverse * right.component_mul(&scale),
            Err(_) => DVector::zeros(rows),
        };
        let meshes = self.spec.meshes.len();
        (0..meshes).map(|i| solved[i] * scale[i]).collect()
    }

    /// Returns the effective mass along the line of action of the gears of a mesh in an impact [kg]; infinite where
    /// neither can move.
    pub fn striking_mass(&self, mesh: usize) -> f64 {
        let mobility = self.mobility();
        let give = self.spec.meshes[mesh]
            .gears
            .map(|g| effective_radius(&self.spec.gears[g].body).powi(2) * mobility[g]);
        1.0 / (give[0] + give[1])
    }

    /// Returns the inverse inertia of every member; zero for members with prescribed motion.
    fn mobility(&self) -> Vec<f64> {
        let gears = self.spec.gears.len();
        let of_gears = self.spec.gears.iter();
        let of_gears = of_gears.map(|g| g.own_inertia() + g.added_inertia);
        let mut inertia: Vec<f64> = of_gears
            .chain(self.bodies.iter().map(|b| b.inertia))
            .collect();
        for (planet, carrier) in self.carriers.iter().enumerate() {
            let Some(carrier) = *carrier else { continue };
            let gear = &self.spec.gears[planet];
            let centre = self.spec.centre_of(self.bodies[carrier - gears]);
            let centre = centre.map_or([0.0; 3], |c| c.position);
            let [x, y] = [0, 1].map(|k| gear.position[k] - centre[k]);
            inertia[carrier] += gear.body.mass(gear.material.density) * (x * x + y * y);
        }
        // Bodies may be without inertia; they then follow their shaft.
        let least = ROUNDING * inertia.iter().fold(0.0, |m: f64, x| m.max(*x));
        (inertia.iter().enumerate())
            .map(|(i, x)| match self.mount(i) {
                Mount::Fixed | Mount::Driven(_) => 0.0,
                Mount::Revolute | Mount::Prismatic => 1.0 / x.max(least),
            })
            .collect()
    }

    fn row<const N: usize>(&self, entries: [(usize, f64); N]) -> Vec<f64> {
        let mut row = vec![0.0; self.speeds.len()];
        entries.into_iter().for_each(|(i, x)| row[i] += x);
        row
    }

    fn mesh_row(&self, mesh: &MeshSpec) -> Vec<f64> {
        let [a, b] = mesh.gears;
        let [ra, rb] = mesh
            .gears
            .map(|g| signed_effective_radius(&self.spec.gears[g].body));
        let mut row = self.row([(a, ra), (b, rb)]);
        if let Some(carrier) = self.carrier_of(mesh) {
            row[carrier] -= ra + rb;
        }
        row
    }

    fn shaft_rows(&self) -> Vec<Vec<f64>> {
        let shafts = self.spec.members_of_shafts();
        let pairs = shafts.iter().flat_map(|members| members.windows(2));
        pairs
            .map(|pair| self.row([(pair[0], 1.0), (pair[1], -1.0)]))
            .collect()
    }

    fn stage_rows(&self) -> Vec<Vec<f64>> {
        let row = |stage: &StageSpec| {
            let [first, second] = stage.members;
            self.row([(first, 1.0), (second, -stage.ratio)])
        };
        self.spec.stages.iter().map(row).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::components;

    /// Equations join members whatever their order, and a carrier joins both gears of its mesh.
    #[test]
    fn equations_join_members_whatever_their_order() {
        let row = |members: &[usize]| {
            let mut row = vec![0.0; 7];
            members.iter().for_each(|&i| row[i] = -2.0);
            row
        };
        let rows = [row(&[4, 6]), row(&[1, 3, 4]), row(&[]), row(&[2, 5])];
        let expected = [0, 1, 2, 1, 1, 2, 1];
        assert_eq!(components(7, &rows), expected);
        let turned: Vec<_> = rows.iter().rev().cloned().collect();
        assert_eq!(components(7, &turned), expected);
    }
}
