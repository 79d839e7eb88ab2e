//! A structured grid of points on a flank of any mesh: each follows the nodes of the face that it lies on.
//!
//! ```text
//! u_p = sum_i N_i(xi_p) u_i,     f_i = N_i(xi_p) f_p
//! ```
//!
//! with the shape functions `N_i` of the face (triangle of 3 or 6 nodes, quadrilateral of 4 or 8): forces go the way that
//! displacements come, so that no work, resultant or moment is lost. Rows stand at equal steps of arc along the profile,
//! columns at equal steps over the width, both about as far apart as the faces of the flank are long on average; rows half as
//! far where the faces have nodes in the middle of their sides. A point stands on the fitted flank, involute or plane, as far
//! off it as the corners of its face do: chords leave no facets in the contact. `xi_p` is the foot of its perpendicular on the
//! face.

use super::{Facet, FlankPoint, Patch, RecognisedGear, Skin};
use crate::gear_mesh::TiedPoint;
use gearbench_models::Vec3;
use gearbench_models::geometry::Side;

/// Fewest rows and columns of a grid.
const FEWEST: usize = 3;

/// Nodes nearer to a column than this part of the width are on it.
const LEVEL: f64 = 1e-4;

/// How far outside its face a point may lie, in natural coordinates, before the face next to it is tried.
const SLACK: f64 = 1e-7;

/// A structured grid of tied points on a flank, in the gear's own frame.
#[derive(Clone, Debug, PartialEq)]
pub struct TiedGrid {
    /// Points along the profile, from the root to the tip.
    pub rows: usize,
    /// Points over the width, from -z to +z.
    pub columns: usize,
    /// Positions [m], row by row.
    pub positions: Vec<Vec3>,
    /// Nodes to which each point is tied.
    pub points: Vec<TiedPoint>,
}

/// A toothing whose flanks unroll to a plane: the interface for a grid of points on them. Positions are in its own
/// frame.
pub trait Unroll {
    /// Place along the profile [m], from the root to the tip; equal steps of it need be no equal steps of arc.
    fn along(&self, x: &Vec3) -> f64;
    /// Arc of the profile between two places [m].
    fn arc(&self, range: [f64; 2]) -> f64;
    /// The place at a part of the arc between two.
    fn between(&self, range: [f64; 2], part: f64) -> f64;
    /// Distance of a position outwards from a flank, along its normal [m].
    fn distance(&self, x: &Vec3, tooth: u32, side: Side) -> f64;
    /// Returns the point of a flank at a position along the profile and one along z, moved outwards along its normal
    /// [m].
    fn point(&self, tooth: u32, side: Side, along: f64, z: f64, away: f64) -> Vec3;
    /// Returns a height that grows from the root to the tip, on the whole tooth [m].
    fn height(&self, x: &Vec3) -> f64;
}

/// Along the profile counts the length of roll `l`, arcs are `l^2 / (2 r_b)`.
impl Unroll for RecognisedGear {
    fn along(&self, x: &Vec3) -> f64 {
        self.fit.roll(x.xy().norm())
    }

    fn arc(&self, [from, to]: [f64; 2]) -> f64 {
        (to * to - from * from) / (2.0 * self.fit.base_radius)
    }

    fn between(&self, range: [f64; 2], part: f64) -> f64 {
        let squares = range.map(|l| l * l);
        (squares[0] + part * (squares[1] - squares[0])).sqrt()
    }

    fn distance(&self, x: &Vec3, tooth: u32, side: Side) -> f64 {
        // In the own frame tooth 0 stands on the x axis.
        self.fit.distance(&FlankPoint {
            radius: x.xy().norm(),
            angle: x.y.atan2(x.x) + self.fit.phase,
            height: x.z,
            tooth,
            side,
        })
    }

    fn point(&self, tooth: u32, side: Side, roll: f64, z: f64, away: f64) -> Vec3 {
        let fit = &self.fit;
        let centre = f64::from(tooth) * fit.pitch_angle() + fit.twist * z;
        let angle = centre + side.sign() * fit.half_angle_at(roll);
        let radius = fit.base_radius.hypot(roll);
        let (sin, cos) = angle.sin_cos();
        // The normal touches the base circle; along its transverse part heights stay.
        let tangent = angle - side.sign() * (roll / fit.base_radius).atan();
        let shift = side.sign() * away / fit.base_helix_angle().cos();
        Vec3::new(
            radius * cos - shift * tangent.sin(),
            radius * sin + shift * tangent.cos(),
            z,
        )
    }

    fn height(&self, x: &Vec3) -> f64 {
        x.xy().norm()
    }
}

/// Shape functions of a face and their slopes by two natural coordinates: triangles from 0 to 1, quadrilaterals from -1
/// to 1. Corners first, then the middle of each side.
pub fn shape(facet: &Facet, [a, b]: [f64; 2]) -> Vec<(f64, [f64; 2])> {
    let quadratic = !facet.mids().is_empty();
    let mut n = Vec::with_capacity(facet.nodes().len());
    if facet.corners().len() == 3 {
        let l = [
            (1.0 - a - b, [-1.0, -1.0]),
            (a, [1.0, 0.0]),
            (b, [0.0, 1.0]),
        ];
        for (v, d) in l {
            n.push(match quadratic {
                false => (v, d),
                true => (v * (2.0 * v - 1.0), d.map(|d| d * (4.0 * v - 1.0))),
            });
        }
        if quadratic {
            for i in 0..3 {
                let ((u, du), (v, dv)) = (l[i], l[(i + 1) % 3]);
                n.push((4.0 * u * v, [0, 1].map(|k| 4.0 * (du[k] * v + u * dv[k]))));
            }
        }
        return n;
    }
    for [p, q] in [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]] {
        let (f, g) = (1.0 + p * a, 1.0 + q * b);
        n.push(match quadratic {
            false => (0.25 * f * g, [0.25 * p * g, 0.25 * q * f]),
            true => {
                let s = p * a + q * b - 1.0;
                let slopes = [0.25 * g * p * (s + f), 0.25 * f * q * (s + g)];
                (0.25 * f * g * s, slopes)
            }
        });
    }
    if quadratic {
        for [p, q] in [[0.0, -1.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]] {
            n.push(if p == 0.0 {
                let (f, g) = (1.0 - a * a, 1.0 + q * b);
                (0.5 * f * g, [-a * g, 0.5 * q * f])
            } else {
                let (f, g) = (1.0 + p * a, 1.0 - b * b);
                (0.5 * f * g, [0.5 * p * g, -b * f])
            });
        }
    }
    n
}

/// How far natural coordinates are outside their face; 0 or less within it.
fn outside(corners: usize, [a, b]: [f64; 2]) -> f64 {
    match corners {
        3 => (-a).max(-b).max(a + b - 1.0),
        _ => a.abs().max(b.abs()) - 1.0,
    }
}

/// A flank unrolled: corners of its faces by length of roll and height.
struct Unrolled<'a> {
    skin: &'a Skin<'a>,
    faces: &'a [u32],
    /// Roll and height of the corners of each face.
    corners: Vec<Vec<[f64; 2]>>,
}

impl Unrolled<'_> {
    /// Mean extent of the faces along a coordinate.
    fn step(&self, coordinate: impl Fn([f64; 2]) -> f64) -> f64 {
        let extent = |corners: &Vec<[f64; 2]>| {
            let [low, high] = super::extent(corners.iter().map(|c| coordinate(*c)));
            high - low
        };
        self.corners.iter().map(extent).sum::<f64>() / self.corners.len() as f64
    }

    /// Range of rolls that the faces cover at a height; nodes nearer to it than `slack` [m] are on it, for end faces are
    /// no planes to the last digit.
    fn covered(&self, height: f64, slack: f64) -> Option<[f64; 2]> {
        let mut range: Option<[f64; 2]> = None;
        for corners in &self.corners {
            let next = corners.iter().cycle().skip(1);
            for (p, q) in corners.iter().zip(next) {
                if p[1].min(q[1]) - slack > height || p[1].max(q[1]) + slack < height {
                    continue;
                }
                let run = q[1] - p[1];
                let ends = match run.abs() > 4.0 * slack {
                    true => [p[0] + (q[0] - p[0]) * ((height - p[1]) / run).clamp(0.0, 1.0); 2],
                    false => [p[0].min(q[0]), p[0].max(q[0])],
                };
                range = Some(match range {
                    None => ends,
                    Some(r) => [r[0].min(ends[0]), r[1].max(ends[1])],
                });
            }
        }
        range
    }

    /// The face that a place lies on, the least outside of all, with its natural coordinates among its corners.
    fn locate(&self, place: [f64; 2]) -> Option<(usize, [f64; 2])> {
        let mut best: Option<(f64, usize, [f64; 2])> = None;
        for (i, corners) in self.corners.iter().enumerate() {
            let Some(xi) = natural(corners, place) else {
                continue;
            };
            let off = outside(corners.len(), xi);
            if best.is_none_or(|b| off < b.0) {
                best = Some((off, i, xi));
            }
            if off <= SLACK {
                break;
            }
        }
        best.map(|(_, i, xi)| (i, xi))
    }

    fn facet(&self, face: usize) -> &Facet {
        &self.skin.facets[self.faces[face] as usize]
    }
}

/// Natural coordinates of a place among corners in a plane: linear or bilinear.
fn natural(corners: &[[f64; 2]], place: [f64; 2]) -> Option<[f64; 2]> {
    let at = |i: usize, k: usize| corners[i][k];
    if let 3 = corners.len() {
        let (u, v) = (
            [at(1, 0) - at(0, 0), at(1, 1) - at(0, 1)],
            [at(2, 0) - at(0, 0), at(2, 1) - at(0, 1)],
        );
        let w = [place[0] - at(0, 0), place[1] - at(0, 1)];
        let det = u[0] * v[1] - u[1] * v[0];
        let xi = [
            (w[0] * v[1] - w[1] * v[0]) / det,
            (u[0] * w[1] - u[1] * w[0]) / det,
        ];
        return xi.iter().all(|x| x.is_finite()).then_some(xi);
    }
    let mut xi = [0.0; 2];
    for _ in 0..20 {
        let (mut f, mut j) = ([-place[0], -place[1]], [[0.0; 2]; 2]);
        for (i, [p, q]) in [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
            .into_iter()
            .enumerate()
        {
            let (g, h) = (1.0 + p * xi[0], 1.0 + q * xi[1]);
            for k in 0..2 {
                f[k] += 0.25 * g * h * at(i, k);
                j[k][0] += 0.25 * p * h * at(i, k);
                j[k][1] += 0.25 * q * g * at(i, k);
            }
        }
        let det = j[0][0] * j[1][1] - j[0][1] * j[1][0];
        let step = [
            (f[0] * j[1][1] - f[1] * j[0][1]) / det,
            (j[0][0] * f[1] - j[1][0] * f[0]) / det,
        ];
        xi = [xi[0] - step[0], xi[1] - step[1]];
        // Far outside there need be no solution.
        if !(xi[0].abs() < 8.0 && xi[1].abs() < 8.0) {
            return None;
        }
        if step[0].abs().max(step[1].abs()) < 1e-13 {
            break;
        }
    }
    Some(xi)
}

/// Lays a grid on a flank; `own` are the positions of all nodes in the own frame.
///
/// # Errors
/// Why there is none: faces that leave no range of the profile that all columns have.
pub fn lay(
    skin: &Skin<'_>,
    toothing: &dyn Unroll,
    patch: &Patch,
    own: &[Vec3],
) -> Result<TiedGrid, String> {
    let unrolled = Unrolled {
        skin,
        faces: &patch.faces,
        corners: (patch.faces.iter())
            .map(|&f| {
                let corners = skin.facets[f as usize].corners().iter();
                let place = |&n: &u32| {
                    let x = &own[n as usize];
                    [toothing.along(x), x.z]
                };
                corners.map(place).collect()
            })
            .collect(),
    };
    let heights = unrolled.corners.iter().flatten().map(|c| c[1]);
    let [back, front] = super::extent(heights);
    let columns = count(front - back, unrolled.step(|c| c[1]));
    let at = |c: usize| back + (front - back) * c as f64 / (columns - 1) as f64;
    let mut range = [0.0_f64; 2];
    for c in 0..columns {
        let Some([low, high]) = unrolled.covered(at(c), LEVEL * (front - back)) else {
            return Err(format!(
                "none of its {} faces reaches {:.4} mm along the width",
                patch.faces.len(),
                1e3 * at(c)
            ));
        };
        range = match c {
            0 => [low, high],
            _ => [range[0].max(low), range[1].min(high)],
        };
    }
    let arc = toothing.arc(range);
    if arc.is_nan() || arc <= 0.0 {
        return Err(format!(
            "its {} faces have no part of the profile in common over the width",
            patch.faces.len()
        ));
    }
    let quadratic = (patch.faces.iter()).all(|&f| !skin.facets[f as usize].mids().is_empty());
    let per_face = if quadratic { 2.0 } else { 1.0 };
    let rows = count(arc, unrolled.step(|c| toothing.arc([0.0, c[0]])) / per_face);
    let mut grid = TiedGrid {
        rows,
        columns,
        positions: Vec::with_capacity(rows * columns),
        points: Vec::with_capacity(rows * columns),
    };
    for r in 0..rows {
        let along = toothing.between(range, r as f64 / (rows - 1) as f64);
        for c in 0..columns {
            let found = unrolled.locate([along, at(c)]);
            let (face, start) = found.ok_or("its faces have no extent")?;
            let facet = unrolled.facet(face);
            let corners = Facet::new(facet.face, facet.corners(), &[]);
            let corners = corners.ok_or("a face of neither 3 nor 4 corners")?;
            let off = |n: u32| toothing.distance(&own[n as usize], patch.tooth, patch.side);
            let weights = shape(&corners, start);
            let away = (weights.iter().zip(corners.corners()))
                .map(|((n, _), &node)| n * off(node))
                .sum::<f64>();
            let x = toothing.point(patch.tooth, patch.side, along, at(c), away);
            let xi = foot(facet, own, start, &x);
            let follows = (shape(facet, xi).into_iter().zip(facet.nodes()))
                .map(|((n, _), &node)| (node, n))
                .collect();
            grid.positions.push(x);
            grid.points.push(TiedPoint(follows));
        }
    }
    Ok(grid)
}

fn count(length: f64, edge: f64) -> usize {
    ((length / edge).round() as usize)
        .saturating_add(1)
        .clamp(FEWEST, 2000)
}

/// Natural coordinates of the foot of the perpendicular from a point on a face, from a first guess.
fn foot(facet: &Facet, nodes: &[Vec3], start: [f64; 2], x: &Vec3) -> [f64; 2] {
    let mut xi = start;
    for _ in 0..12 {
        let (mut off, mut along) = (-x, [Vec3::zeros(); 2]);
        for ((n, d), &node) in shape(facet, xi).into_iter().zip(facet.nodes()) {
            let at = &nodes[node as usize];
            off += n * at;
            along[0] += d[0] * at;
            along[1] += d[1] * at;
        }
        let [u, v] = along;
        let (uu, uv, vv) = (u.dot(&u), u.dot(&v), v.dot(&v));
        let det = uu * vv - uv * uv;
        let (p, q) = (u.dot(&off), v.dot(&off));
        let step = [(p * vv - q * uv) / det, (q * uu - p * uv) / det];
        if !(step[0].abs() < 1.0 && step[1].abs() < 1.0) {
            return start;
        }
        xi = [xi[0] - step[0], xi[1] - step[1]];
        if step[0].abs().max(step[1].abs()) < 1e-14 {
            break;
        }
    }
    xi
}
