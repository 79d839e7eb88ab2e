//! Dampers of a scene that act at the velocities at the end of a half-step impulse, identified by the forces that
//! methods evaluate there ([`force_after`](SecondOrderSystem::force_after)).

use gearbench_integrators::{HalfStepImpulse, SecondOrderSystem, State, StateView};
use gearbench_models::scene::Scene;
use nalgebra::DMatrix;

/// Duration of an impulse that changes no velocity, over the characteristic time of a scene.
const INSTANT: f64 = 1e-9;
/// Perturbation of the velocities from which dampers are computed, over a typical velocity.
const SMALL: f64 = 1e-2;

/// Computes the forces at the end of a half-step impulse that changes no velocity, for predicted velocities that differ
/// by `x`.
fn at_end(scene: &mut Scene, s: &State, x: &[f64], f: &mut [f64]) {
    let v: Vec<f64> = s.v.iter().zip(x).map(|(v, x)| v + x).collect();
    let at = StateView { v: &v, ..s.at() };
    let kick = HalfStepImpulse {
        time: INSTANT * scene.characteristic_time(at).min(1.0),
        before: &s.v,
        steady: &[],
        filter: &[],
    };
    scene.force_after(at, &kick, f);
}

/// Computes `-D x` of the dampers that an impulse evaluates at the velocities that it predicts, by central differences
/// of forces.
pub(super) fn predicted(scene: &mut Scene, s: &State, x: &[f64], df: &mut [f64]) {
    let side = |sign: f64| -> Vec<f64> { x.iter().map(|x| sign * SMALL * x).collect() };
    let mut below = vec![0.0; df.len()];
    at_end(scene, s, &side(1.0), df);
    at_end(scene, s, &side(-1.0), &mut below);
    for (f, below) in df.iter_mut().zip(below) {
        *f = (*f - below) / (2.0 * SMALL);
    }
}

/// True if the forces at the end of a half-step impulse differ from those at the velocities that it predicts.
pub(super) fn acts_at_ends(scene: &mut Scene, s: &State, v: &[f64]) -> bool {
    let x: Vec<f64> = v.iter().map(|v| SMALL * v).collect();
    let moved: Vec<f64> = s.v.iter().zip(&x).map(|(v, x)| v + x).collect();
    let [mut plain, mut asked] = [vec![0.0; x.len()], vec![0.0; x.len()]];
    scene.force(
        StateView {
            v: &moved,
            ..s.at()
        },
        &mut plain,
    );
    at_end(scene, s, &x, &mut asked);
    plain != asked
}

/// Returns typical velocities of the coordinates.
pub(super) fn speeds(scene: &Scene) -> Vec<f64> {
    let n = scene.layout().n;
    let (mut q, mut v) = (vec![0.0; n], vec![0.0; n]);
    scene.scales(&mut q, &mut v);
    v
}

/// Returns the part of the damping `d` that acts at the velocities at the end of a half-step impulse.
pub(super) fn known_at_ends(
    scene: &mut Scene,
    s: &State,
    d: &DMatrix<f64>,
) -> Option<DMatrix<f64>> {
    let v = speeds(scene);
    if !acts_at_ends(scene, s, &v) {
        return None;
    }
    let n = v.len();
    let (mut x, mut df) = (vec![0.0; n], vec![0.0; n]);
    let mut known = d.clone();
    for j in 0..n {
        x[j] = v[j];
        predicted(scene, s, &x, &mut df);
        for (i, f) in df.iter().enumerate() {
            known[(i, j)] += f / v[j];
        }
        x[j] = 0.0;
    }
    Some(known)
}
