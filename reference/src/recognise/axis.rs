//! The axis of rotation: from the end faces or the principal axes, made sharp on the tip and bore cylinders.
//!
//! Directions that are tried: the normals that most of the surface has (end faces, hub faces), then the principal
//! axes of the surface. Seen along the axis the corners of the convex hull of a gear lie on its tip circle. The tip
//! and the bore cylinder together then give direction and place by least squares,
//!
//! ```text
//! sum (|w - (w . d) d| - r_k)^2 = min,   w = x - c
//! ```
//!
//! over `d` (two tilts), `c` (two shifts) and both radii, by Gauss and Newton.

use super::skin::Skin;
use gearbench_models::Vec3;
use nalgebra::{Matrix3, Matrix6, Vector6};
use std::f64::consts::TAU;

/// Directions in which the hull is looked at.
const HULL: usize = 1440;

/// How far the nodes of the hull may be from their circle, over its radius, where the axis is first guessed.
const ROUND: f64 = 2e-3;

/// Deviation of a direction from a coordinate axis that counts as rounding of coordinates.
const ALONG: f64 = 1e-9;

/// An axis of rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis {
    /// Unit vector; its largest component is positive.
    pub direction: Vec3,
    /// A point on the axis [m].
    pub point: Vec3,
}

/// A cylinder about the axis with the corner nodes that lie on it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cylinder {
    /// Radius of the cylinder [m].
    pub radius: f64,
    /// Root mean square and largest distance of its nodes [m].
    pub residual: [f64; 2],
    /// Corner nodes on it.
    pub nodes: Vec<u32>,
}

/// Returns two unit vectors that form a right-handed system with a direction: coordinate axes where the direction is
/// one.
pub(crate) fn across(d: Vec3) -> [Vec3; 2] {
    if d == Vec3::z() {
        return [Vec3::x(), Vec3::y()];
    }
    // The x axis turned with the shortest turn from z to the direction, where there is one.
    let start = if d.z > -0.9 {
        let axis = Vec3::new(-d.y, d.x, 0.0);
        let k = 1.0 / (1.0 + d.z);
        Vec3::x() + axis.cross(&Vec3::x()) + k * axis.cross(&axis.cross(&Vec3::x()))
    } else {
        Vec3::x()
    };
    let x = (start - start.dot(&d) * d).normalize();
    [x, d.cross(&x)]
}

impl Axis {
    /// Two unit vectors across it.
    pub fn across(&self) -> [Vec3; 2] {
        across(self.direction)
    }

    /// Returns the position in the frame of the axis: two coordinates across it and one along it.
    pub fn seen(&self, x: &Vec3) -> Vec3 {
        let [e, f] = self.across();
        let w = x - self.point;
        Vec3::new(w.dot(&e), w.dot(&f), w.dot(&self.direction))
    }

    /// A vector of the frame of the axis in that of the nodes.
    pub fn turned_back(&self, x: &Vec3) -> Vec3 {
        if self.direction == Vec3::z() {
            return *x;
        }
        let [e, f] = self.across();
        x.x * e + x.y * f + x.z * self.direction
    }

    /// Distance from the axis.
    fn distance(&self, x: &Vec3) -> f64 {
        let w = x - self.point;
        (w - w.dot(&self.direction) * self.direction).norm()
    }

    /// A cylinder about the axis through the mean distance of nodes.
    pub fn cylinder(&self, nodes: &[Vec3], on: Vec<u32>) -> Cylinder {
        let n = on.len().max(1) as f64;
        let distances = || on.iter().map(|&i| self.distance(&nodes[i as usize]));
        let radius = distances().sum::<f64>() / n;
        let square = distances().map(|r| (r - radius).powi(2)).sum::<f64>();
        let most = distances().fold(0.0, |m: f64, r| m.max((r - radius).abs()));
        Cylinder {
            radius,
            residual: [(square / n).sqrt(), most],
            nodes: on,
        }
    }

    /// Returns the direction in its positive sense; a direction that differs from a coordinate axis by rounding of
    /// coordinates is replaced by it.
    fn settled(mut self) -> Self {
        let d = self.direction;
        let most = d.iamax();
        if d[most] < 0.0 {
            self.direction = -d;
        }
        let unit = Vec3::from_fn(|i, _| if i == most { 1.0 } else { 0.0 });
        if (self.direction - unit).norm() < ALONG {
            self.direction = unit;
        }
        // The point next to the origin.
        self.point -= self.point.dot(&self.direction) * self.direction;
        self
    }

    /// The axis that two cylinders of nodes share, from a first guess; the point is kept at the height of the nodes.
    pub fn sharpened(self, nodes: &[Vec3], cylinders: [&[u32]; 2]) -> Self {
        let mut axis = self;
        let all = || cylinders.iter().copied().flatten();
        let count = all().count().max(1) as f64;
        let middle = all().map(|&n| nodes[n as usize]).sum::<Vec3>() / count;
        axis.point += (middle - axis.point).dot(&axis.direction) * axis.direction;
        let size = axis.distance(&nodes[all().next().copied().unwrap_or(0) as usize]);
        for _ in 0..6 {
            let [e, f] = axis.across();
            let mut normal = Matrix6::zeros();
            let mut right = Vector6::zeros();
            for (k, cylinder) in cylinders.iter().enumerate() {
                let radius = axis.cylinder(nodes, cylinder.to_vec()).radius;
                for &n in *cylinder {
                    let w = nodes[n as usize] - axis.point;
                    let along = w.dot(&axis.direction);
                    let across = w - along * axis.direction;
                    let r = across.norm();
                    let out = across / r;
                    let (a, b) = (out.dot(&e), out.dot(&f));
                    let tilt = along / size;
                    let mut row = Vector6::new(-a, -b, -tilt * a, -tilt * b, 0.0, 0.0);
                    row[4 + k] = -1.0;
                    normal += row * row.transpose();
                    right -= row * (r - radius);
                }
            }
            // Where a cylinder is empty its radius is free.
            for k in 0..6 {
                if normal[(k, k)] == 0.0 {
                    normal[(k, k)] = 1.0;
                }
            }
            let Some(step) = normal.cholesky().map(|c| c.solve(&right)) else {
                return self.settled();
            };
            axis.point += step[0] * e + step[1] * f;
            let tilt = (step[2] * e + step[3] * f) / size;
            axis.direction = (axis.direction + tilt).normalize();
            if step.norm() < 1e-15 * size {
                break;
            }
        }
        axis.settled()
    }
}

/// Directions along which the axis may run, likeliest first.
pub fn directions(skin: &Skin<'_>) -> Vec<Vec3> {
    // Normals that large parts of the surface share, either sense.
    let mut shared: Vec<(Vec3, f64)> = Vec::new();
    let mut order: Vec<usize> = (0..skin.facets.len()).collect();
    order.sort_by(|&a, &b| skin.areas[b].total_cmp(&skin.areas[a]));
    for f in order {
        let (n, area) = (skin.normals[f], skin.areas[f]);
        let near = shared
            .iter()
            .position(|(sum, _)| n.cross(sum).norm() < 1e-2 * sum.norm());
        match near {
            Some(i) => {
                let (sum, total) = &mut shared[i];
                *sum += area * n * n.dot(sum).signum();
                *total += area;
            }
            None if shared.len() < 400 => shared.push((area * n, area)),
            None => {}
        }
    }
    shared.sort_by(|a, b| b.1.total_cmp(&a.1));
    let mut found: Vec<Vec3> = shared.iter().take(3).map(|(n, _)| n.normalize()).collect();
    // Principal axes of the surface.
    let centre = |f: usize| {
        let corners = skin.facets[f].corners();
        let sum = corners
            .iter()
            .map(|&n| skin.nodes[n as usize])
            .sum::<Vec3>();
        sum / corners.len() as f64
    };
    let total: f64 = skin.areas.iter().sum();
    let all = 0..skin.facets.len();
    let middle = all.clone().map(|f| skin.areas[f] * centre(f)).sum::<Vec3>() / total;
    let spread = all.fold(Matrix3::zeros(), |sum, f| {
        let w = centre(f) - middle;
        sum + skin.areas[f] * w * w.transpose()
    });
    if spread.iter().all(|x| x.is_finite()) {
        let axes = spread.symmetric_eigen().eigenvectors;
        found.extend((0..3).map(|i| axes.column(i).into_owned()));
    }
    found
}

/// The axis along a direction through the middle of the hull's circle; `None` where the hull is no circle.
pub fn along(skin: &Skin<'_>, corners: &[u32], direction: Vec3) -> Option<(Axis, Cylinder)> {
    let mut axis = Axis {
        direction,
        point: Vec3::zeros(),
    };
    let seen: Vec<[f64; 2]> = corners
        .iter()
        .map(|&n| {
            let x = axis.seen(&skin.nodes[n as usize]);
            [x.x, x.y]
        })
        .collect();
    let mut hull: Vec<usize> = (0..HULL)
        .filter_map(|i| {
            let (s, c) = (TAU * i as f64 / HULL as f64).sin_cos();
            let reach = |p: &[f64; 2]| c * p[0] + s * p[1];
            (0..seen.len()).max_by(|&a, &b| reach(&seen[a]).total_cmp(&reach(&seen[b])))
        })
        .collect();
    hull.sort_unstable();
    hull.dedup();
    // Circle by Kasa's method, repeated without outliers.
    let mut circle = kasa(hull.iter().map(|&i| seen[i]))?;
    for _ in 0..3 {
        let off = |i: &usize| {
            let [x, y] = seen[*i];
            ((x - circle[0]).hypot(y - circle[1]) - circle[2]).abs()
        };
        let on = hull.iter().copied().filter(|i| off(i) < ROUND * circle[2]);
        let on: Vec<usize> = on.collect();
        if on.len() < 3 || 3 * on.len() < 2 * hull.len() {
            return None;
        }
        circle = kasa(on.iter().map(|&i| seen[i]))?;
        hull = on;
    }
    let [e, f] = axis.across();
    axis.point = circle[0] * e + circle[1] * f;
    let on = hull.iter().map(|&i| corners[i]).collect();
    Some((axis, axis.cylinder(skin.nodes, on)))
}

/// Centre and radius of the circle through points in Kasa's least squares.
fn kasa(points: impl Iterator<Item = [f64; 2]> + Clone) -> Option<[f64; 3]> {
    let n = points.clone().count() as f64;
    let [mx, my] = points
        .clone()
        .fold([0.0; 2], |m, p| [m[0] + p[0] / n, m[1] + p[1] / n]);
    let mut s = [0.0; 5];
    for [x, y] in points {
        let (u, v) = (x - mx, y - my);
        let w = 0.5 * (u * u + v * v);
        for (s, t) in s.iter_mut().zip([u * u, u * v, v * v, u * w, v * w]) {
            *s += t;
        }
    }
    let det = s[0] * s[2] - s[1] * s[1];
    if det.is_nan() || det <= 1e-9 * (s[0] + s[2]).powi(2) {
        return None;
    }
    let (u, v) = (
        (s[3] * s[2] - s[4] * s[1]) / det,
        (s[4] * s[0] - s[3] * s[1]) / det,
    );
    let radius = (u * u + v * v + (s[0] + s[2]) / n).sqrt();
    radius.is_finite().then_some([mx + u, my + v, radius])
}
