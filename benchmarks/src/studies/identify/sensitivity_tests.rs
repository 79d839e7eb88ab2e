//! Tests of sensitivities from differences against exact ones, and of the effect of their error on an estimate.
//!
//! Rigid gears with one spring for the mesh are one oscillator while they touch,
//!
//! ```text
//! N = sqrt(K m) v sin(omega tau),   tau = t - g/v,   omega^2 = K/m,   0 <= omega tau <= pi
//! dN/dln K = N/2 + sqrt(K m) v cos(omega tau) omega tau/2,   dN/dg = -K cos(omega tau)
//! ```
//!
//! with the times of touch `g/v` and of release among what moves with the parameters.

use super::estimate::coordinates::{Coordinate, Scale};
use super::estimate::levenberg_marquardt::{Effort, Residuals, minimise};
use super::tests::{impact, made, plan};
use super::*;
use crate::scene_file::calibration::{Constants, GAP, STIFFNESS};
use gearbench_models::spec::effective_radius;
use gearbench_models::stiffness::{PairOrMesh, PairStiffness};
use nalgebra::{DMatrix, DVector};

const K: f64 = 1.5e10;
const G: f64 = 3e-6;

/// Force and its sensitivities by the coordinates of [`coordinates`].
fn exact(spec: &gearbench_models::spec::SceneSpec, t: f64) -> [f64; 3] {
    let [a, b] = [&spec.gears[0], &spec.gears[1]];
    let of = |g: &gearbench_models::spec::GearSpec| {
        let r = effective_radius(&g.body);
        r * r / g.inertia.unwrap()
    };
    let (m, v) = (1.0 / (of(a) + of(b)), effective_radius(&a.body) * a.speed);
    let k = K * 0.01;
    let omega = (k / m).sqrt();
    let phase = omega * (t - G / v);
    if !(0.0..=std::f64::consts::PI).contains(&phase) {
        return [0.0; 3];
    }
    let most = (k * m).sqrt() * v;
    let (sin, cos) = phase.sin_cos();
    let by_k = 0.5 * most * (sin + phase * cos);
    [most * sin, by_k, -k * cos * G]
}

fn coordinates() -> Vec<Coordinate> {
    let gap = Coordinate {
        scale: Scale::Linear(G),
        bounds: [0.0, f64::INFINITY],
    };
    vec![Coordinate::POSITIVE, gap]
}

#[test]
fn differences_are_as_good_as_exact_sensitivities() {
    let (mut plan, spec) = plan("rigid");
    plan.modelling.contacts[0].stiffness = PairStiffness::Constant {
        per_width: K,
        of: PairOrMesh::Mesh,
    };
    let truth = Constants::of([(STIFFNESS, K), (GAP, G)]);
    let set = made(&plan, impact(&spec, 20.0, "impact"), &truth, 0.0);
    let Data::History {
        time,
        values: force,
        ..
    } = &set.data
    else {
        panic!("a history");
    };
    let most = force.iter().copied().fold(0.0, f64::max);
    let sought: Vec<[f64; 3]> = time.iter().map(|t| exact(&spec, *t)).collect();
    for (f, exact) in force.iter().zip(&sought) {
        assert!((f - exact[0]).abs() < 1e-6 * most, "{f} {exact:?}");
    }
    // Noise of a hundredth, a fit by differences, and where exact sensitivities would go from there.
    let noisy = made(&plan, impact(&spec, 20.0, "impact"), &truth, 0.01);
    let all = coordinates();
    let run = |z: &[f64]| {
        let values = super::estimate::coordinates::values(&all, z);
        let constants = Constants::of([(STIFFNESS, values[0]), (GAP, values[1])]);
        modelled(&plan, &noisy, &constants, super::Clock::default()).unwrap()
    };
    let size = noisy.size();
    let mut residuals = |z: &[f64]| {
        let found = run(z);
        Some(
            found
                .iter()
                .zip(noisy.values())
                .map(|(a, b)| (a - b) / size)
                .collect(),
        )
    };
    let residuals: &mut Residuals<'_> = &mut residuals;
    let start = [K.ln(), 1.0];
    let at_truth = minimise(residuals, &all, &[true; 2], &start, Effort::WHOLE).unwrap();
    // The estimate lies within thousandths of the truth: exact sensitivities there are those at the truth.
    let n = time.len();
    let jacobian = DMatrix::from_fn(n, 2, |i, j| sought[i][j + 1] / size);
    let differences = {
        let mut j = DMatrix::zeros(n, 2);
        for c in 0..2 {
            let h = 1e-3;
            let moved = |by: f64| {
                let mut z = start;
                z[c] += by;
                DVector::from_vec(run(&z))
            };
            j.set_column(c, &((moved(h) - moved(-h)) / (2.0 * h * size)));
        }
        j
    };
    for c in 0..2 {
        let (a, b) = (jacobian.column(c), differences.column(c));
        let error = (a - b).norm() / a.norm();
        assert!(error < 2e-5, "{c}: {error}");
    }
    let step = |j: &DMatrix<f64>| {
        let normal = (j.transpose() * j).try_inverse().unwrap();
        (&normal * j.transpose() * &at_truth.residuals, normal)
    };
    let (by_exact, normal) = step(&jacobian);
    let s2 = at_truth.sum / (n - 2) as f64;
    for c in 0..2 {
        let part = by_exact[c].abs() / (s2 * normal[(c, c)]).sqrt();
        assert!(part < 0.02, "{c}: {part}");
    }
}
