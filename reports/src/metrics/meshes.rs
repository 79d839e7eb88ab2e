//! The contact force of each mesh of a scene: peak, root mean square, first contact, ripple.
//!
//! The ripple is the part of the force above a frequency f, over the time T of the run at N even times:
//!
//! ```text
//! ripple = sqrt( sum F_j^2 / N - |X_0|^2 - 2 sum_(k <= f T) |X_k|^2 ),   X_k = sum F_j exp(-2 pi i k j / N) / N
//! ```

use super::history::{Force, force_of};
use crate::record::{MeshForce, finite};
use crate::series::TimeSeries;
use std::f64::consts::TAU;

/// Largest number of times at which the ripple is sampled.
const MOST_TIMES: usize = 1 << 14;

/// Returns the forces of all meshes of a run that reached its end, by the names of their gears; empty for a scene with
/// one mesh. Forces are piecewise polynomial where the series has pieces, else linear between samples.
pub fn mesh_forces(
    series: &TimeSeries,
    meshes: &[[String; 2]],
    ripple_above_hz: Option<f64>,
) -> Vec<MeshForce> {
    let ends = series.time_s.first().zip(series.time_s.last());
    let Some((&start, &end)) = ends.filter(|_| meshes.len() > 1) else {
        return Vec::new();
    };
    let of_mesh = |gears: &[String; 2]| {
        let history = force_of(series, &gears.join("_"));
        let force = Force::until(&history, end);
        let spell = history.first_spell().filter(|[_, last]| *last < end);
        let ripple = ripple_above_hz.and_then(|f| ripple(&force, [start, end], series.len(), f));
        MeshForce {
            gears: gears.clone(),
            peak_force_n: finite(force.peak().0),
            rms_force_n: finite((force.square() / (end - start)).sqrt()),
            first_contact_s: spell.map(|[a, b]| b - a),
            ripple_rms_n: ripple,
            ripple_above_hz: ripple_above_hz.filter(|_| ripple.is_some()),
        }
    };
    meshes.iter().map(of_mesh).collect()
}

/// Computes the root mean square of the force above a frequency (see the head of the module); `None` where the samples
/// do not resolve the frequency.
fn ripple(force: &Force<'_>, [start, end]: [f64; 2], samples: usize, above: f64) -> Option<f64> {
    let n = samples.min(MOST_TIMES);
    let span = end - start;
    let cycles = (above * span).floor();
    if !(cycles >= 0.0 && 2.0 * cycles + 1.0 < n as f64) {
        return None;
    }
    let times = (0..n).map(|j| start + span * j as f64 / n as f64);
    let values: Vec<f64> = force.at_times(times, 0.0).collect();
    let scale = (n as f64).recip();
    let mut square: f64 = scale * values.iter().map(|f| f * f).sum::<f64>();
    for k in 0..=cycles as usize {
        let (sin, cos) = (TAU * k as f64 * scale).sin_cos();
        let (mut re, mut im, mut at) = (0.0, 0.0, (1.0, 0.0));
        for f in &values {
            re += f * at.0;
            im += f * at.1;
            at = (at.0 * cos - at.1 * sin, at.0 * sin + at.1 * cos);
        }
        let weight = if k == 0 { 1.0 } else { 2.0 };
        square -= weight * scale * scale * (re * re + im * im);
    }
    finite(square.max(0.0).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::series::{CONTACT_FORCE, Column};

    /// The second mesh bears 100 N for a quarter of a second, then a ripple of 20 N at 40 Hz about 50 N to the end; the third
    /// never touches.
    #[test]
    fn each_mesh_has_its_own_numbers() {
        let names = ["a", "b", "c", "d"].map(str::to_owned);
        let pair = |i: usize, j: usize| [names[i].clone(), names[j].clone()];
        let meshes = [pair(0, 1), pair(1, 2), pair(2, 3)];
        let n = 4000;
        let times: Vec<f64> = (0..=n).map(|i| f64::from(i) / f64::from(n)).collect();
        let second = |t: &f64| match *t {
            t if t < 0.25 => 100.0 * (TAU * 2.0 * t).sin(),
            t if t < 0.5 => 0.0,
            t => 50.0 + 20.0 * (TAU * 40.0 * t).sin(),
        };
        let column =
            |i: usize, values: Vec<f64>| Column::new(CONTACT_FORCE.of_mesh(&meshes[i]), values);
        let columns = vec![
            column(0, vec![30.0; times.len()]),
            column(1, times.iter().map(second).collect()),
            column(2, vec![0.0; times.len()]),
        ];
        let series = TimeSeries::new(times, columns).unwrap();
        let [first, second, third] = &mesh_forces(&series, &meshes, Some(30.0))[..] else {
            panic!("three meshes")
        };
        assert_eq!(
            (first.peak_force_n, first.first_contact_s),
            (Some(30.0), None)
        );
        let near = |x: Option<f64>, wanted: f64, within: f64| {
            assert!((x.unwrap() - wanted).abs() < within, "{x:?} {wanted}");
        };
        near(first.rms_force_n, 30.0, 1e-9);
        near(first.ripple_rms_n, 0.0, 1e-6);
        near(second.peak_force_n, 100.0, 1e-2);
        near(second.first_contact_s, 0.25, 1e-3);
        let square: f64 = 0.25 * 5000.0 + 0.5 * (2500.0 + 200.0);
        near(second.rms_force_n, square.sqrt(), 0.1);
        // The ripple lasts for half of the run; its begin and end leak a little.
        near(second.ripple_rms_n, 10.0, 1.0);
        assert_eq!(
            (third.peak_force_n, third.first_contact_s),
            (Some(0.0), None)
        );
        // Beyond half the rate of samples nothing is known, and a single mesh has its metrics in the run.
        assert_eq!(
            mesh_forces(&series, &meshes, Some(2001.0))[1].ripple_rms_n,
            None
        );
        assert!(mesh_forces(&series, &meshes[..1], None).is_empty());
    }
}
