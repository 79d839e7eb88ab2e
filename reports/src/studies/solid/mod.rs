//! Still picture of gears in space: faces of their teeth, shafts, carriers and bearings from the back to the front, lines of
//! contact and forces over them.
//!
//! The view is that of the script of moving gears at its start: parallel projection, turned about the vertical and then about the
//! horizontal of the picture.

pub mod mechanism;

use crate::drawing::canvas::{Canvas, Ink, Stroke};
use crate::drawing::geometry::{Rect, simplified};
use crate::drawing::heat::colour;
use crate::record::{BodySection, FramePose, GearMotion, ToothedBody};
use mechanism::{Mechanism, PartKind};

/// Rotation of the view about the vertical and the horizontal of the picture [rad].
const TURN: [f64; 2] = [-0.55, -0.5];
/// Depth of detail of the outlines, as part of the radius of the scene.
const DETAIL: f64 = 4e-4;
/// Largest number of layers of teeth over the width.
const LAYERS: usize = 6;
/// Colours of the gears in turn.
const BODIES: [Ink; 3] = [
    Ink(0x9d, 0xb4, 0xcb, 1.0),
    Ink(0xd8, 0xbf, 0x95, 1.0),
    Ink(0xa9, 0xc6, 0xa4, 1.0),
];
/// Colours of shafts, carriers and bearings.
const SHAFT: Ink = Ink(0xb9, 0xbf, 0xc6, 1.0);
const CARRIER: Ink = Ink(0xcf, 0xc6, 0xd6, 1.0);
const BEARING: Ink = Ink(0x7d, 0x87, 0x91, 1.0);
/// Direction to the light in the axes of the view.
const LIGHT: [f64; 3] = [0.35, 0.5, 0.8];

type Point = [f64; 3];

/// Polygon in the axes of the view, with its colour.
struct Face {
    corners: Vec<Point>,
    ink: Ink,
    depth: f64,
}

fn dot(a: &Point, b: &Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Returns `a + k b`.
fn sum(a: &Point, b: &Point, k: f64) -> Point {
    [0, 1, 2].map(|n| a[n] + k * b[n])
}

fn cross(a: &Point, b: &Point) -> Point {
    [(1, 2), (2, 0), (0, 1)].map(|(m, n)| a[m] * b[n] - a[n] * b[m])
}

/// Returns the direction of a vector.
fn unit(a: &Point) -> Point {
    let length = dot(a, a).sqrt().max(f64::MIN_POSITIVE);
    a.map(|x| x / length)
}

/// Returns the largest distance of the outline of a body from its axis.
fn reach(body: &ToothedBody) -> f64 {
    let points = body.outline(0).unwrap_or_default();
    points.iter().map(|p| p[0].hypot(p[1])).fold(0.0, f64::max)
}

/// Returns a place or direction in space in the axes of the view: right, up, towards the reader.
fn seen(view: &[Point; 3], x: &Point) -> Point {
    let p = [0, 1, 2].map(|k| dot(&view[k], x));
    let [(sy, cy), (sp, cp)] = TURN.map(f64::sin_cos);
    let (right, towards) = (cy * p[0] + sy * p[2], cy * p[2] - sy * p[0]);
    [right, cp * p[1] - sp * towards, sp * p[1] + cp * towards]
}

/// Returns a vector normal to a polygon, by Newell's sum; its length is twice the area.
fn normal(corners: &[Point]) -> Point {
    let mut sum = [0.0; 3];
    for (i, a) in corners.iter().enumerate() {
        let b = &corners[(i + 1) % corners.len()];
        for k in 0..3 {
            let (m, n) = ((k + 1) % 3, (k + 2) % 3);
            sum[k] += (a[m] - b[m]) * (a[n] + b[n]);
        }
    }
    sum
}

/// Adds a face if it is turned to the reader; the material of an internal gear lies on the other side of its outline.
fn add(faces: &mut Vec<Face>, mut corners: Vec<Point>, (base, is_internal): (Ink, bool)) {
    if is_internal {
        corners.reverse();
    }
    let n = normal(&corners);
    let length = dot(&n, &n).sqrt();
    if n[2] <= 1e-9 * length {
        return;
    }
    let light = dot(&LIGHT, &LIGHT).sqrt();
    let bright = 0.42 + 0.58 * (dot(&n, &LIGHT) / (length * light)).max(0.0);
    let Ink(r, g, b, _) = base;
    let shaded = |x: u8| (f64::from(x) * bright).round() as u8;
    let depth = corners.iter().map(|p| p[2]).sum::<f64>() / corners.len() as f64;
    faces.push(Face {
        corners,
        ink: Ink(shaded(r), shaded(g), shaded(b), 1.0),
        depth,
    });
}

/// Returns the places of the points of a pitch that matter at a detail [m], the same in all sections.
fn thinned(points: &[[f64; 2]], detail: f64) -> Vec<usize> {
    let all: Vec<(f64, f64)> = points.iter().map(|p| (p[0], p[1])).collect();
    let kept = simplified(&all, detail);
    let mut next = kept.iter().peekable();
    let mut places = Vec::new();
    for (i, p) in all.iter().enumerate() {
        if next.peek().is_some_and(|q| *q == p) {
            places.push(i);
            next.next();
        }
    }
    places
}

/// Adds the faces of a body at a pose.
fn body_faces(
    faces: &mut Vec<Face>,
    (body, pose, base): (&ToothedBody, &FramePose, Ink),
    view: &[Point; 3],
    detail: f64,
) -> Result<(), String> {
    let all = body.sections()?;
    let layers = (all.len() - 1).min(LAYERS);
    let sections: Vec<&BodySection> = (0..=layers)
        .map(|i| &all[i * (all.len() - 1) / layers.max(1)])
        .collect();
    let Some(first) = sections.first() else {
        return Ok(());
    };
    let kept = thinned(&first.points_m, detail);
    let base = (base, body.is_internal);
    let back = |[x, y]: [f64; 2]| {
        let r = x.hypot(y).max(f64::MIN_POSITIVE);
        match body.is_rack {
            true => [body.back_m, y],
            false => [x / r * body.back_m, y / r * body.back_m],
        }
    };
    for tooth in 0..i64::from(body.teeth) {
        let number = tooth + body.first_tooth;
        let (sin, cos) = body.direction_of(number);
        let by = if body.is_rack {
            number as f64 * body.pitch
        } else {
            0.0
        };
        let place = |[x, y]: [f64; 2], z: f64| {
            seen(
                view,
                &pose.point([cos * x - sin * y, sin * x + cos * y + by, z]),
            )
        };
        for pair in kept.windows(2) {
            let [i, j] = [pair[0], pair[1]];
            for two in sections.windows(2) {
                let [low, high] = [&two[0].points_m, &two[1].points_m];
                let [z0, z1] = [&two[0].height_m, &two[1].height_m];
                let quad = [
                    place(low[i], *z0),
                    place(low[j], *z0),
                    place(high[j], *z1),
                    place(high[i], *z1),
                ];
                add(faces, quad.to_vec(), base);
                if body.back_m > 0.0 {
                    let [a, b, c, d] = [(low[i], z0), (low[j], z0), (high[j], z1), (high[i], z1)]
                        .map(|(p, z)| place(back(p), *z));
                    add(faces, vec![d, c, b, a], base);
                }
            }
        }
        for (end, section) in [(0, sections[0]), (1, sections[layers])] {
            let (z, points) = (&section.height_m, &section.points_m);
            let outer = kept.iter().map(|i| place(points[*i], *z));
            let ends = [
                points[kept[0]],
                points[kept[kept.len() / 2]],
                points[kept[kept.len() - 1]],
            ];
            let inner = ends.iter().rev().map(|p| place(back(*p), *z));
            let mut corners: Vec<Point> = outer.chain(inner).collect();
            // The order of the outline is counter-clockwise seen from the upper end.
            if end == 0 {
                corners.reverse();
            }
            add(faces, corners, base);
        }
    }
    Ok(())
}

/// Adds the faces of shafts, bodies without teeth, carriers and bearings.
fn mechanism_faces(
    faces: &mut Vec<Face>,
    motion: &GearMotion,
    poses: &[FramePose],
    start: &[FramePose],
) {
    let mechanism = Mechanism::of(motion);
    for part in &mechanism.parts {
        let ink = match part.kind {
            PartKind::Turning => SHAFT,
            PartKind::Carrier => CARRIER,
            PartKind::Bearing => BEARING,
        };
        let place = |p: &Point| seen(&motion.view, p);
        let rings: Vec<Vec<Point>> = (part.rings.iter())
            .map(|ring| {
                mechanism
                    .points(ring, poses, start)
                    .iter()
                    .map(place)
                    .collect()
            })
            .collect();
        let (Some(first), Some(last)) = (rings.first(), rings.last()) else {
            continue;
        };
        let closing = [last.clone(), first.clone()];
        let pairs = rings
            .windows(2)
            .chain(part.is_hollow.then_some(&closing[..]));
        for pair in pairs {
            let [a, b] = [&pair[0], &pair[1]];
            for n in 0..a.len() {
                let next = (n + 1) % a.len();
                add(faces, vec![a[n], a[next], b[next], b[n]], (ink, false));
            }
        }
        if !part.is_hollow {
            add(faces, first.iter().rev().copied().collect(), (ink, false));
            add(faces, last.clone(), (ink, false));
        }
    }
}

/// Returns the corners of a polygon moved outwards by less than a pixel, so that no ground shines through between neighbours.
fn widened(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    const BY: f64 = 0.4;
    let n = points.len() as f64;
    let sum = points
        .iter()
        .fold((0.0, 0.0), |a, p| (a.0 + p.0, a.1 + p.1));
    let middle = (sum.0 / n, sum.1 / n);
    let moved = |p: &(f64, f64)| {
        let (x, y) = (p.0 - middle.0, p.1 - middle.1);
        let part = BY / x.hypot(y).max(BY);
        (p.0 + part * x, p.1 + part * y)
    };
    points.iter().map(moved).collect()
}

/// Paints the gears of a motion at a frame, with `factor` times their motion from the first frame, into an area; arrows have
/// the colour `ink`.
pub fn paint(
    c: &mut Canvas,
    motion: &GearMotion,
    (frame, factor, ink): (usize, f64, Ink),
    area: &Rect,
) {
    let poses = |frame: usize| -> Option<Vec<FramePose>> {
        let paths = motion.paths.iter();
        paths
            .map(|p| p.magnified(factor).ok()?.get(frame).copied())
            .collect()
    };
    let (Some(start), Some(poses)) = (poses(0), poses(frame)) else {
        return;
    };
    let mut faces = Vec::new();
    let extent = motion.bodies.iter().map(reach).fold(0.0, f64::max);
    for (i, (body, pose)) in motion.bodies.iter().zip(&poses).enumerate() {
        let of = (body, pose, BODIES[i % BODIES.len()]);
        if body_faces(&mut faces, of, &motion.view, DETAIL * extent).is_err() {
            return;
        }
    }
    mechanism_faces(&mut faces, motion, &poses, &start);
    let corners = || faces.iter().flat_map(|f| &f.corners);
    let ends = [0, 1].map(|k| {
        let low = corners().map(|p| p[k]).fold(f64::INFINITY, f64::min);
        let high = corners().map(|p| p[k]).fold(f64::NEG_INFINITY, f64::max);
        [low, high]
    });
    let scale =
        (area.width() / (ends[0][1] - ends[0][0])).min(area.height() / (ends[1][1] - ends[1][0]));
    let scale = 0.96 * scale;
    if !(scale.is_finite() && scale > 0.0) {
        return;
    }
    let middle = ends.map(|e| 0.5 * (e[0] + e[1]));
    let at = |p: &Point| {
        (
            0.5 * (area.x0 + area.x1) + (p[0] - middle[0]) * scale,
            0.5 * (area.y0 + area.y1) - (p[1] - middle[1]) * scale,
        )
    };
    faces.sort_by(|a, b| a.depth.total_cmp(&b.depth));
    for face in &faces {
        let points: Vec<(f64, f64)> = face.corners.iter().map(at).collect();
        c.polygon(&widened(&points), face.ink);
    }
    contacts(
        c,
        motion,
        (frame, ink),
        &|x: &Point| at(&seen(&motion.view, x)),
        area,
    );
}

/// Paints lines of contact and the sum of the forces of each tooth pair.
fn contacts(
    c: &mut Canvas,
    motion: &GearMotion,
    (frame, ink): (usize, Ink),
    at: &dyn Fn(&Point) -> (f64, f64),
    area: &Rect,
) {
    let all = &motion.contacts;
    let (Ok(points), Ok(forces), Ok(values)) = (
        all.points_m.values(),
        all.forces_n.values(),
        all.values.values(),
    ) else {
        return;
    };
    let begin: usize = all.counts[..frame].iter().sum();
    let own = begin..begin + all.counts[frame];
    let three = |from: &[f64], n: usize| [from[3 * n], from[3 * n + 1], from[3 * n + 2]];
    let most = values.iter().copied().fold(0.0, f64::max);
    let mut pairs: Vec<Vec<usize>> = Vec::new();
    for n in own {
        let same = |p: &&mut Vec<usize>| {
            let m = p[0];
            (all.meshes[m], all.teeth[m], all.sides[m])
                == (all.meshes[n], all.teeth[n], all.sides[n])
        };
        match pairs.iter_mut().find(same) {
            Some(pair) => pair.push(n),
            None => pairs.push(vec![n]),
        }
    }
    let size = |f: &Point| dot(f, f).sqrt();
    let sums: Vec<(Point, Point)> = (pairs.iter())
        .map(|pair| {
            let (mut force, mut place, mut weight) = ([0.0; 3], [0.0; 3], 0.0);
            for n in pair {
                let (f, p) = (three(&forces, *n), three(&points, *n));
                weight += size(&f);
                for k in 0..3 {
                    force[k] += f[k];
                    place[k] += size(&f) * p[k];
                }
            }
            (place.map(|x| x / weight.max(f64::MIN_POSITIVE)), force)
        })
        .collect();
    let greatest = sums.iter().map(|(_, f)| size(f)).fold(0.0, f64::max);
    for pair in &pairs {
        let line: Vec<(f64, f64)> = pair.iter().map(|n| at(&three(&points, *n))).collect();
        c.line_within(&line, area, Stroke::new(Ink::WHITE, 7.0));
        for (i, n) in pair.iter().enumerate() {
            let own = colour(values[*n] / most.max(f64::MIN_POSITIVE));
            match line.get(i + 1) {
                Some(end) => c.line_within(&[line[i], *end], area, Stroke::new(own, 4.5)),
                None => c.circle(line[i], 3.0, own, None),
            }
        }
    }
    for (place, force) in &sums {
        if !(greatest > 0.0 && size(force) > 0.0) {
            continue;
        }
        let (x, y) = at(place);
        let tip = at(&[0, 1, 2].map(|k| place[k] + force[k] / size(force) * 1e-3));
        let (dx, dy) = (tip.0 - x, tip.1 - y);
        let flat = dx.hypot(dy).max(f64::MIN_POSITIVE);
        let (ux, uy) = (dx / flat, dy / flat);
        let length = (0.16 * area.height() * size(force) / greatest).max(12.0);
        let (end, neck) = (
            (x + ux * length, y + uy * length),
            (x + ux * (length - 9.0), y + uy * (length - 9.0)),
        );
        c.line(&[(x, y), neck], Stroke::new(Ink::WHITE, 5.0));
        c.line(&[(x, y), neck], Stroke::new(ink, 2.6));
        let barbs = [
            (neck.0 - 5.0 * uy, neck.1 + 5.0 * ux),
            (neck.0 + 5.0 * uy, neck.1 - 5.0 * ux),
        ];
        c.polygon(&[end, barbs[0], barbs[1]], ink);
    }
}
