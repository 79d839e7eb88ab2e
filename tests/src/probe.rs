//! Access to scenes at a state for tests, random numbers and fitted slopes.

use gearbench_integrators::{SecondOrderSystem, State};
use gearbench_models::contact::{Candidate, CandidateSelection, GearState};
use gearbench_models::kinematics::Row;
use gearbench_models::scene::Scene;

/// Returns all candidates of a scene at a state, whatever their gap, with the index of their mesh.
pub fn candidates(scene: &Scene, s: &State) -> Vec<(usize, Candidate)> {
    wanted(scene, s, CandidateSelection::Touching(f64::INFINITY))
}

/// Returns the candidates in the discrete state of a run with event location.
pub fn listed(scene: &Scene, s: &State) -> Vec<(usize, Candidate)> {
    wanted(scene, s, CandidateSelection::Listed)
}

fn wanted(scene: &Scene, s: &State, wanted: CandidateSelection<'_>) -> Vec<(usize, Candidate)> {
    let mut all = Vec::new();
    for (m, mesh) in scene.meshes().iter().enumerate() {
        let gear_state = |i: usize| {
            let g = &scene.gears()[i];
            GearState {
                gear: g.model.as_ref(),
                at: g.at(s.at()),
            }
        };
        let mut found = Vec::new();
        mesh.search.candidates(
            gear_state(mesh.gears[0]),
            gear_state(mesh.gears[1]),
            s.discrete.get(mesh.search_discrete()).unwrap_or(&[]),
            wanted,
            &mut found,
        );
        all.extend(found.into_iter().map(|c| (m, c)));
    }
    all
}

/// Returns the candidate of the same teeth, flank and slice at another state.
pub fn same_candidate(scene: &Scene, s: &State, mesh: usize, c: &Candidate) -> Option<Candidate> {
    let same = |x: &Candidate| x.slot == c.slot && x.points[0].tooth == c.points[0].tooth;
    candidates(scene, s)
        .into_iter()
        .find(|(m, x)| *m == mesh && same(x))
        .map(|(_, x)| x)
}

/// Returns the contact row `dg/dq` of a candidate as a full vector.
pub fn contact_row(scene: &Scene, s: &State, mesh: usize, c: &Candidate) -> Vec<f64> {
    row_and_rate(scene, s, mesh, c).0
}

/// Returns the contact row of a candidate, and the prescribed part of its gap rate [m/s].
pub fn row_and_rate(scene: &Scene, s: &State, mesh: usize, c: &Candidate) -> (Vec<f64>, f64) {
    let (mut row, mut rate) = (Row::default(), 0.0);
    row.clear();
    for (k, sign) in [(0, -1.0), (1, 1.0)] {
        let g = &scene.gears()[scene.meshes()[mesh].gears[k]];
        row.target(g.range().start, sign * c.scale[k]);
        let at = g.at(s.at());
        let along = c.normal + c.aside[k];
        rate += sign * c.scale[k] * g.model.row(at, &c.points[k], &along, &mut row);
    }
    let mut w = vec![0.0; s.q.len()];
    row.add_to(1.0, &mut w);
    (w, rate)
}

/// Fits the slope of `log y` over `log x` by least squares.
pub fn slope(x: &[f64], y: &[f64]) -> f64 {
    let n = x.len() as f64;
    let log = |v: &[f64]| -> Vec<f64> { v.iter().map(|a| a.ln()).collect() };
    let (x, y) = (log(x), log(y));
    let (mx, my) = (x.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
    let above: f64 = x.iter().zip(&y).map(|(a, b)| (a - mx) * (b - my)).sum();
    let below: f64 = x.iter().map(|a| (a - mx).powi(2)).sum();
    above / below
}

/// Generator of repeatable numbers in [-1, 1) for directions and states.
pub struct Numbers(u64);

impl Numbers {
    /// Starts a sequence from a seed.
    pub fn new(seed: u64) -> Self {
        Numbers(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    /// Returns the next number (xorshift64*).
    pub fn draw(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        let bits = self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11;
        bits as f64 / (1u64 << 52) as f64 - 1.0
    }

    /// Returns a vector of numbers, scaled by the entries of `scale`.
    pub fn vector(&mut self, scale: &[f64]) -> Vec<f64> {
        scale.iter().map(|s| s * self.draw()).collect()
    }
}

/// Returns the magnitudes of coordinates and velocities of a scene.
pub fn scales(scene: &Scene) -> (Vec<f64>, Vec<f64>) {
    let n = scene.layout().n;
    let (mut q, mut v) = (vec![0.0; n], vec![0.0; n]);
    SecondOrderSystem::scales(scene, &mut q, &mut v);
    (q, v)
}

/// Returns the central difference of the forces of a scene along a direction of coordinates and velocities, with a step
/// `small` of it.
pub fn force_slope(scene: &mut Scene, s: &State, [dq, dv]: [&[f64]; 2], small: f64) -> Vec<f64> {
    let n = s.q.len();
    let mut moved = |x: f64| {
        let (mut m, mut f) = (s.clone(), vec![0.0; n]);
        for i in 0..n {
            m.q[i] += x * dq[i];
            m.v[i] += x * dv[i];
        }
        scene.force(m.at(), &mut f);
        f
    };
    let (above, below) = (moved(small), moved(-small));
    (above.iter().zip(&below))
        .map(|(a, b)| (a - b) / (2.0 * small))
        .collect()
}
