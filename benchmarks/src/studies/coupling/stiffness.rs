//! A scene as the oscillator of [`theory`](super::theory): its hubs on the static stiffness of the gears in contact.
//!
//! About the state of the largest force ([`Linearised`]) with stiffness `K` and damping `D` for unit masses, gears whose frames
//! `r` (orthonormal there) stand at `u` are deformed as in statics:
//!
//! ```text
//! K y + r l = 0,   r^T y = u;    l = -k u
//! ```
//!
//! The largest eigenvalue of `k` is the squared frequency, `y^T D y` along its shape the damping. That is a bound of slow hubs:
//! what in the gears answers with inertia is not in it.

use super::frames::Frame;
use crate::studies::stability::limits::linear::Linear;
use crate::studies::stability::limits::{LimitError, Linearised};
use gearbench_models::gear::table::Model;
use gearbench_models::spec::{Modelling, SceneSpec};
use nalgebra::DMatrix;

/// Computes the angular frequency [rad/s] and damping ratio of the frames on the gears in contact; `None` for a scene
/// without contact, or one too large to be linearised.
pub fn oscillator(
    spec: &SceneSpec,
    modelling: &Modelling,
    models: &[Model],
    frames: &[Frame],
) -> Result<Option<[f64; 2]>, LimitError> {
    let mut linearised = Linearised::new(spec, modelling, models)?;
    if linearised.closed().is_none() {
        return Ok(None);
    }
    let Linear::Dense(all) = linearised.linear()? else {
        return Ok(None);
    };
    let mut r = DMatrix::zeros(all.stiffness.nrows(), frames.len());
    for (j, frame) in frames.iter().enumerate() {
        let part = |m: f64| (m / frame.inertia).sqrt();
        (frame.moves.iter()).for_each(|(i, m)| r[(*i, j)] = part(*m));
    }
    Ok(condensed(&all.stiffness, &all.damping, &r))
}

/// Returns the fastest mode of the frames with all other coordinates condensed statically.
fn condensed(k: &DMatrix<f64>, d: &DMatrix<f64>, r: &DMatrix<f64>) -> Option<[f64; 2]> {
    let (n, frames) = r.shape();
    let mut held = DMatrix::zeros(n + frames, n + frames);
    held.view_mut((0, 0), (n, n)).copy_from(k);
    // Frames and deformations in one size, for the pivots.
    let size = k.amax();
    held.view_mut((0, n), (n, frames)).copy_from(&(r * size));
    held.view_mut((n, 0), (frames, n))
        .copy_from(&(r.transpose() * size));
    let mut given = DMatrix::zeros(n + frames, frames);
    given
        .view_mut((n, 0), (frames, frames))
        .fill_with_identity();
    given *= size;
    let solved = held.lu().solve(&given)?;
    let shapes = solved.rows(0, n);
    let kept = -size * solved.rows(n, frames);
    let eigen = (0.5 * (&kept + kept.transpose())).symmetric_eigen();
    let top = eigen.eigenvalues.imax();
    let square = eigen.eigenvalues[top];
    if !(square > 0.0 && square.is_finite()) {
        return None;
    }
    let shape = shapes * eigen.eigenvectors.column(top);
    let omega = square.sqrt();
    let damping = shape.dot(&(d * &shape));
    Some([omega, (0.5 * damping / omega).max(0.0)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn springs_in_series_are_one() {
        // A frame on a spring of 3 to a coordinate on a spring of 6 to the ground: 2 in series.
        let k = DMatrix::from_row_slice(2, 2, &[3.0, -3.0, -3.0, 9.0]);
        let d = DMatrix::from_row_slice(2, 2, &[0.4, -0.4, -0.4, 0.4]);
        let r = DMatrix::from_row_slice(2, 1, &[1.0, 0.0]);
        let [omega, zeta] = condensed(&k, &d, &r).unwrap();
        assert!((omega * omega - 2.0).abs() < 1e-13);
        // The coordinate follows by a third, so that the damper between has two thirds of the speed.
        assert!((zeta - 0.5 * 0.4 * (2.0_f64 / 3.0).powi(2) / omega).abs() < 1e-13);
        // Turned with all that it carries, nothing resists.
        let (free, both) = (
            DMatrix::from_row_slice(2, 2, &[3.0, -3.0, -3.0, 3.0]),
            DMatrix::from_row_slice(2, 1, &[0.5_f64.sqrt(), 0.5_f64.sqrt()]),
        );
        assert!(condensed(&free, &d, &both).is_none_or(|[omega, _]| omega < 1e-7));
    }
}
