//! Linear theory of the coupling: one oscillator in two parts, a mass in the host on a spring and a damper in the sub-system.
//!
//! With the communication step `h`, `w = omega h`, `F_n = -w^2 x_n - 2 zeta w y_n` (`y = h v`, forces over mass times `h^2`) and
//! the basis polynomials `l_j` of Lagrange on the nodes `0, -1, .., -p`
//!
//! ```text
//! x_{n+1} = x_n + y_n + sum_j a_j F_{n-j},   y_{n+1} = y_n + sum_j b_j F_{n-j}
//! a_j = int_0^1 (1 - s) l_j(s) ds,           b_j = int_0^1 l_j(s) ds
//! ```
//!
//! is exact for a host that integrates the extrapolated force exactly, whatever the motion between communication points, for a
//! spring and a damper have no memory. Its spectral radius `r(w, zeta)` says how the amplitude grows in a step. Without damping
//! constant and linear extrapolation grow at every step, if slowly: so the limit is where the energy that a time in contact `T`
//! makes up, `r^(2 T/h) - 1`, exceeds what is allowed. As `T` grows that goes to `r = 1`.

use super::step_polynomial::Extrapolation;
use nalgebra::DMatrix;

/// Smallest and largest `omega h` of the search for the limit, their ratio from trial to trial, and the relative width
/// of a limit.
const FROM: f64 = 1e-4;
const TO: f64 = 20.0;
const LOOK: f64 = 1.05;
const WIDTH: f64 = 1e-6;

/// Integrals of the basis polynomials, with the weights `1 - s` and 1, of the newest value first.
fn weights(extrapolation: Extrapolation) -> &'static [[f64; 2]] {
    match extrapolation {
        Extrapolation::Constant => &[[0.5, 1.0]],
        Extrapolation::Linear => &[[2.0 / 3.0, 1.5], [-1.0 / 6.0, -0.5]],
        Extrapolation::Quadratic => &[
            [19.0 / 24.0, 23.0 / 12.0],
            [-5.0 / 12.0, -4.0 / 3.0],
            [1.0 / 8.0, 5.0 / 12.0],
        ],
    }
}

/// Computes the largest amplitude growth of an oscillator in a communication step (spectral radius).
pub fn radius(extrapolation: Extrapolation, omega_h: f64, zeta: f64) -> f64 {
    let weights = weights(extrapolation);
    let n = 1 + weights.len();
    // The state is (x, y, F_{n-1}, ..); F_n is a linear function of it.
    let force = |row: &mut [f64], by: f64| {
        row[0] -= by * omega_h * omega_h;
        row[1] -= by * 2.0 * zeta * omega_h;
    };
    let mut rows = vec![vec![0.0; n]; n];
    (rows[0][0], rows[0][1], rows[1][1]) = (1.0, 1.0, 1.0);
    for (j, [a, b]) in weights.iter().enumerate() {
        for (row, by) in [(0, *a), (1, *b)] {
            match j {
                0 => force(&mut rows[row], by),
                _ => rows[row][1 + j] += by,
            }
        }
    }
    if n > 2 {
        force(&mut rows[2], 1.0);
    }
    for k in 3..n {
        rows[k][k - 1] = 1.0;
    }
    let matrix = DMatrix::from_fn(n, n, |i, j| rows[i][j]);
    let values = matrix.complex_eigenvalues();
    values.iter().map(|z| z.norm()).fold(0.0, f64::max)
}

/// Returns the communication step [s] from which on the energy error of an oscillator of angular frequency `omega`
/// [rad/s] and damping ratio `zeta` exceeds the part `allowed` of its energy over a `time` [s]; `None` if no step in
/// the search range exceeds it.
pub fn limit(
    extrapolation: Extrapolation,
    [omega, zeta]: [f64; 2],
    time: f64,
    allowed: f64,
) -> Option<f64> {
    let grows = |w: f64| {
        let steps = (time * omega / w).max(1.0);
        2.0 * steps * radius(extrapolation, w, zeta).ln() > allowed.ln_1p()
    };
    let (mut low, mut high) = (FROM, FROM);
    while !grows(high) {
        (low, high) = (high, LOOK * high);
        if high > TO {
            return None;
        }
    }
    while high - low > WIDTH * high {
        let middle = 0.5 * (low + high);
        match grows(middle) {
            true => high = middle,
            false => low = middle,
        }
    }
    Some(high / omega)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_held_force_grows_as_its_determinant_says() {
        // Without damping both eigenvalues are a pair of the product 1 + w^2/2.
        for w in [1e-3, 0.1, 0.7] {
            let r = radius(Extrapolation::Constant, w, 0.0);
            assert!((r * r - (1.0 + 0.5 * w * w)).abs() < 1e-12);
        }
    }

    #[test]
    fn small_steps_come_to_the_oscillator_with_the_order_of_extrapolation() {
        // A damped oscillator decays as exp(-zeta w); what extrapolation adds to the exponent is of order p + 2.
        let zeta = 0.1;
        for (extrapolation, order) in [
            (Extrapolation::Constant, 2.0),
            (Extrapolation::Linear, 3.0),
            (Extrapolation::Quadratic, 4.0),
        ] {
            let off = |w: f64| radius(extrapolation, w, zeta).ln() + zeta * w;
            let found = (off(0.02) / off(0.01)).abs().log2();
            assert!((found - order).abs() < 0.1, "{extrapolation}: {found}");
        }
    }

    #[test]
    fn limits_close_in_on_growth() {
        for extrapolation in Extrapolation::ALL {
            let (omega, zeta) = (2e4, 0.05);
            let long = limit(extrapolation, [omega, zeta], 1.0, 0.5).unwrap();
            let r = |h: f64| radius(extrapolation, omega * h, zeta);
            assert!(
                r(1.001 * long) > 1.0 && r(0.99 * long) < 1.0,
                "{extrapolation}"
            );
            // A short contact bears more.
            let short = limit(extrapolation, [omega, zeta], 1e-4, 0.5).unwrap();
            assert!(short > long);
        }
    }
}
