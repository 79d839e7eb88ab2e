//! Cubic splines through the nodes of a flank, as bulges over the chords.
//!
//! On a chord `d` from node to node with `t` in [0, 1] the spline is `P_0 + t d + f(t)` with
//!
//! ```text
//! f(t) = t (1 - t)^2 e_0 - t^2 (1 - t) e_1,      e_0 = m_0 - d,  e_1 = m_1 - d
//! ```
//!
//! `m` the tangents at both ends times the chord's length. The tangents are those of the cubic spline with
//! not-a-knot ends over the accumulated chord length (C. de Boor, *A Practical Guide to Splines*, 1978,
//! chapter IV), so the surface is smooth along the profile and exact for cubics.

use crate::Vec3;

/// Computes the end slopes `e_0`, `e_1` of each chord [m]; zeros for two points.
pub(super) fn bulges(points: &[Vec3]) -> Vec<[Vec3; 2]> {
    let n = points.len();
    let d: Vec<Vec3> = points.windows(2).map(|p| p[1] - p[0]).collect();
    let h: Vec<f64> = d.iter().map(|d| d.norm()).collect();
    if n < 3 || h.contains(&0.0) {
        return vec![[Vec3::zeros(); 2]; n - 1];
    }
    let delta: Vec<Vec3> = d.iter().zip(&h).map(|(d, h)| d / *h).collect();
    let tangents = if n == 3 {
        let bend = (delta[1] - delta[0]) / (h[0] + h[1]);
        vec![
            delta[0] - h[0] * bend,
            delta[0] + h[0] * bend,
            delta[1] + h[1] * bend,
        ]
    } else {
        not_a_knot(&h, &delta)
    };
    (0..n - 1)
        .map(|i| [h[i] * tangents[i] - d[i], h[i] * tangents[i + 1] - d[i]])
        .collect()
}

/// Returns, for each chord of a line, the distance of its neighbouring nodes from it, with a margin for deformation
/// [m].
pub(super) fn chord_bound(line: &[Vec3]) -> Vec<f64> {
    (0..line.len() - 1)
        .map(|r| {
            let chord = line[r + 1] - line[r];
            let length = chord.norm();
            let off = |i: usize| (line[i] - line[r]).cross(&chord).norm() / length;
            let below = r.checked_sub(1).map_or(0.0, off);
            let above = if r + 2 < line.len() { off(r + 2) } else { 0.0 };
            1.5 * below.max(above) + 0.01 * length
        })
        .collect()
}

/// Computes the tangents of the not-a-knot spline with at least three chords `h` of slope `delta`.
fn not_a_knot(h: &[f64], delta: &[Vec3]) -> Vec<Vec3> {
    let n = h.len() + 1;
    let (mut low, mut mid, mut up) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    let mut rhs = vec![Vec3::zeros(); n];
    // The third derivative does not jump at the last node but one, at both ends.
    let end = |h0: f64, h1: f64, d0: &Vec3, d1: &Vec3| {
        let sum = h0 + h1;
        ((h0 + 2.0 * sum) * h1 * d0 + h0 * h0 * d1) / sum
    };
    (mid[0], up[0]) = (h[1], h[0] + h[1]);
    rhs[0] = end(h[0], h[1], &delta[0], &delta[1]);
    for i in 1..n - 1 {
        (low[i], mid[i], up[i]) = (h[i], 2.0 * (h[i - 1] + h[i]), h[i - 1]);
        rhs[i] = 3.0 * (h[i] * delta[i - 1] + h[i - 1] * delta[i]);
    }
    let l = n - 2;
    (low[n - 1], mid[n - 1]) = (h[l] + h[l - 1], h[l - 1]);
    rhs[n - 1] = end(h[l], h[l - 1], &delta[l], &delta[l - 1]);
    for i in 1..n {
        let f = low[i] / mid[i - 1];
        mid[i] -= f * up[i - 1];
        let above = rhs[i - 1];
        rhs[i] -= f * above;
    }
    rhs[n - 1] /= mid[n - 1];
    for i in (0..n - 1).rev() {
        let below = rhs[i + 1];
        rhs[i] = (rhs[i] - up[i] * below) / mid[i];
    }
    rhs
}

/// Returns `f`, `f'` and `f''` at `t`.
#[inline]
pub(super) fn bulge(e: &[Vec3; 2], t: f64) -> [Vec3; 3] {
    let r = 1.0 - t;
    [
        (t * r * r) * e[0] - (t * t * r) * e[1],
        (r * (1.0 - 3.0 * t)) * e[0] - (t * (2.0 - 3.0 * t)) * e[1],
        (6.0 * t - 4.0) * e[0] + (6.0 * t - 2.0) * e[1],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// On a circle the error falls with the fourth power of the chord length.
    #[test]
    fn fourth_order_on_a_circle() {
        let error = |n: usize| {
            let at = |x: f64| Vec3::new(x.cos(), x.sin(), 0.1 * x);
            let points: Vec<Vec3> = (0..=n).map(|i| at(i as f64 / n as f64)).collect();
            let e = bulges(&points);
            let mut worst = 0.0_f64;
            for i in 0..n {
                for t in [0.2, 0.5, 0.8] {
                    let x = points[i] + t * (points[i + 1] - points[i]) + bulge(&e[i], t)[0];
                    worst = worst.max((x.x.hypot(x.y) - 1.0).abs());
                }
            }
            worst
        };
        let (coarse, fine) = (error(10), error(20));
        let order = (coarse / fine).log2();
        assert!(order > 3.6, "{coarse:.2e} {fine:.2e}: order {order:.2}");
        assert!(fine < 1e-6);
    }

    #[test]
    fn parabolas_are_exact_from_three_points_on() {
        // Equal steps, so that the chord length is the parameter up to the curvature.
        for n in [3, 4, 7] {
            let points: Vec<Vec3> = (0..n)
                .map(|i| Vec3::new(f64::from(i), 1e-6 * f64::from(i).powi(2), 0.0))
                .collect();
            let e = bulges(&points);
            for (i, e) in e.iter().enumerate() {
                let middle = 0.5 * (points[i] + points[i + 1]) + bulge(e, 0.5)[0];
                let x = i as f64 + 0.5;
                assert!((middle.y - 1e-6 * x * x).abs() < 1e-15, "{n} points");
            }
        }
    }

    #[test]
    fn slopes_by_differences() {
        let e = [Vec3::new(1.0, 2.0, 0.0), Vec3::new(-0.5, 0.3, 1.0)];
        let h = 1e-5;
        for t in [0.0, 0.3, 1.0] {
            let [_, slope, bend] = bulge(&e, t);
            let (above, below) = (bulge(&e, t + h), bulge(&e, t - h));
            assert!(((above[0] - below[0]) / (2.0 * h) - slope).norm() < 1e-9);
            assert!(((above[1] - below[1]) / (2.0 * h) - bend).norm() < 1e-9);
        }
    }
}
