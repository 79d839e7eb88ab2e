//! Natural modes of a scene about its loaded state: frequency, damping, and distribution of energy.

use super::LoadedState;
use super::damping::{Damped, damped};
use gearbench_integrators::system::{SecondOrderSystem, State};
use gearbench_models::scene::{LinearisedScene, Scene, StrainIn};
use nalgebra::{DMatrix, DVector};
use std::collections::BTreeMap;

/// Share of the highest eigenvalue below which a motion is rigid.
pub const SLACK: f64 = 1e-12;

/// A natural mode, or a rigid-body motion, of a scene.
#[derive(Clone, Debug)]
pub struct Motion {
    /// Angular frequency [rad/s]; zero of rigid motions and of those with a negative stiffness.
    pub omega: f64,
    /// Eigenvalue `omega^2` [rad^2/s^2].
    pub square: f64,
    /// Damping; `None` for rigid-body motions.
    pub damped: Option<Damped>,
    /// Mode shape over the coordinates, at unit modal mass.
    pub x: Vec<f64>,
}

/// Largest displacement at a flank of scaled mode shapes [m].
const LARGEST: f64 = 1e-6;

/// Returns a displacement of the coordinates scaled to a largest displacement at a flank of 1 um, that one positive.
pub fn scaled(scene: &Scene, x: &[f64]) -> Vec<f64> {
    let m = scene.magnitudes();
    let (mut q, mut v) = (vec![0.0; x.len()], vec![0.0; x.len()]);
    scene.scales(&mut q, &mut v);
    let ways = x.iter().zip(&q).map(|(x, s)| x / s * m.deflection);
    let largest = ways.fold(
        0.0_f64,
        |most, x| if x.abs() > most.abs() { x } else { most },
    );
    let scale = if largest == 0.0 {
        0.0
    } else {
        LARGEST / largest
    };
    x.iter().map(|x| scale * x).collect()
}

impl LoadedState {
    /// Largest eigenvalue [rad^2/s^2].
    pub fn highest_square(&self) -> f64 {
        self.modes.squares.last().map_or(0.0, |x| x.abs())
    }

    /// All natural modes: rigid-body motions first, then by ascending frequency.
    pub fn motions(&self) -> Vec<Motion> {
        let squares = &self.modes.squares;
        let highest = self.highest_square();
        let rigid = self.rigid.iter().map(|y| (0.0, y.clone()));
        let swinging = (0..self.space.motions()).map(|i| {
            let u: DVector<f64> = self.modes.vectors.column(i).into_owned();
            (squares[i], self.space.whole(&u))
        });
        let all: Vec<(f64, Vec<f64>)> = (rigid.chain(swinging))
            .map(|(square, y)| (square, self.space.displacement_of(&y)))
            .collect();
        let size = all.first().map_or(0, |(_, x)| x.len());
        let columns = DMatrix::from_fn(size, all.len(), |i, j| all[j].1[i]);
        let d = columns.tr_mul(&(&self.linear.damping * &columns));
        let omega = |square: f64| match square > SLACK * highest {
            true => square.sqrt(),
            false => 0.0,
        };
        let omegas: Vec<f64> = all.iter().map(|(square, _)| omega(*square)).collect();
        let damping = damped(&omegas, &d);
        let motions = all.into_iter().zip(omegas).zip(damping);
        motions
            .map(|(((square, x), omega), damped)| Motion {
                omega,
                square,
                damped,
                x,
            })
            .collect()
    }
}

/// Kinetic and strain energy of a motion.
#[derive(Clone, Debug, Default)]
pub struct Energies {
    /// Kinetic energy at unit modal velocity, by member [J].
    pub kinetic: Vec<f64>,
    /// Part of the kinetic energy in internal coordinates, by member [J].
    pub own: Vec<f64>,
    /// Strain energy by spring [J].
    pub strain: BTreeMap<StrainIn, f64>,
}

/// Computes the energies of a displacement `x` with velocity `x`.
pub fn energies(scene: &mut Scene, s: &State, linear: &LinearisedScene, x: &[f64]) -> Energies {
    let n = x.len();
    let column = nalgebra::DMatrix::from_column_slice(n, 1, x);
    let momentum = &linear.mass * column;
    let over =
        |range: std::ops::Range<usize>| -> f64 { range.map(|i| 0.5 * x[i] * momentum[i]).sum() };
    let gears = scene.gears();
    let of_own = |g: &gearbench_models::scene::SceneGear| {
        let range = g.range();
        over((range.start + g.model.hub().first()).min(range.end)..range.end)
    };
    Energies {
        kinetic: gears.iter().map(|g| over(g.range())).collect(),
        own: gears.iter().map(of_own).collect(),
        strain: scene.strain_in(s, &linear.stiffness, x),
    }
}

impl Energies {
    /// Adds the energies of another motion.
    pub fn add(&mut self, other: Energies) {
        for (to, from) in [
            (&mut self.kinetic, other.kinetic),
            (&mut self.own, other.own),
        ] {
            to.resize(from.len(), 0.0);
            to.iter_mut().zip(from).for_each(|(to, from)| *to += from);
        }
        for (place, energy) in other.strain {
            *self.strain.entry(place).or_insert(0.0) += energy;
        }
    }
}
