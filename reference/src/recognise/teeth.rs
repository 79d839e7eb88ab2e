//! The toothed shell of a gear and how many teeth it has; the bore.

use super::axis::{Axis, Cylinder};
use super::skin::Skin;
use gearbench_models::Vec3;
use std::f64::consts::{PI, TAU};

/// Faces whose normal runs along the axis by more than this are end faces; base helix angles stay below 53 degrees.
const END: f64 = 0.8;

/// Heights tried when teeth are counted.
const LEVELS: usize = 24;

/// How far the middle of a tooth may be from its even place [pitches]; far more than any pitch error.
const UNEVEN: f64 = 0.15;

/// Smallest number of teeth.
const FEWEST: usize = 3;

/// How far the nodes of a bore may be from their circle, over its radius, where they are looked for.
const ROUND: f64 = 5e-3;

/// Nodes of a body about an axis: distance, angle, place along it.
pub type Polar = Vec<[f64; 3]>;

/// All nodes about an axis.
pub fn polar(axis: &Axis, nodes: &[Vec3]) -> Polar {
    let of = |x: &Vec3| {
        let x = axis.seen(x);
        [x.x.hypot(x.y), x.y.atan2(x.x), x.z]
    };
    nodes.iter().map(of).collect()
}

/// Normal of a face along the radius, along the circle and along the axis, at the middle of its corners.
pub fn turned_normal(skin: &Skin<'_>, axis: &Axis, face: usize) -> [f64; 3] {
    let corners = skin.facets[face].corners();
    let sum = corners
        .iter()
        .map(|&n| skin.nodes[n as usize])
        .sum::<Vec3>();
    let w = sum / corners.len() as f64 - axis.point;
    let out = (w - w.dot(&axis.direction) * axis.direction).normalize();
    let n = &skin.normals[face];
    [
        n.dot(&out),
        n.dot(&axis.direction.cross(&out)),
        n.dot(&axis.direction),
    ]
}

/// Returns pieces of the surface along the axis: first the outermost one, the toothed shell.
pub fn shells(skin: &Skin<'_>, axis: &Axis, polar: &Polar) -> Option<Vec<Vec<u32>>> {
    let mut pieces = skin.pieces(|f| skin.normals[f].dot(&axis.direction).abs() < END);
    let reach = |piece: &Vec<u32>| {
        let corners = piece
            .iter()
            .flat_map(|&f| skin.facets[f as usize].corners());
        corners.fold(0.0, |m: f64, &n| m.max(polar[n as usize][0]))
    };
    let outer =
        (0..pieces.len()).max_by(|&a, &b| reach(&pieces[a]).total_cmp(&reach(&pieces[b])))?;
    pieces.swap(0, outer);
    Some(pieces)
}

/// Returns faces and corner nodes of the innermost piece that is a cylinder about the axis seen from within, or of the
/// one whose radius is nearest to a given one.
pub fn bore(
    skin: &Skin<'_>,
    axis: &Axis,
    polar: &Polar,
    inner: &[Vec<u32>],
    given: Option<f64>,
) -> Option<(Vec<u32>, Cylinder)> {
    let of = |piece: &Vec<u32>| {
        let area = |faces: &[u32]| faces.iter().map(|&f| skin.areas[f as usize]).sum::<f64>();
        let inwards = |f: &u32| turned_normal(skin, axis, *f as usize)[0] < -0.7;
        let faces: Vec<u32> = piece.iter().copied().filter(inwards).collect();
        let nodes = skin.nodes_of(&faces, false);
        let mut radii: Vec<f64> = nodes.iter().map(|&n| polar[n as usize][0]).collect();
        radii.sort_by(f64::total_cmp);
        let radius = *radii.get(radii.len() / 2)?;
        let on = |n: &u32| (polar[*n as usize][0] - radius).abs() < ROUND * radius;
        let round = |f: &u32| skin.facets[*f as usize].corners().iter().all(on);
        let faces: Vec<u32> = faces.into_iter().filter(round).collect();
        let on = skin.nodes_of(&faces, false);
        // All around, and the better part of the piece: no hole of the web.
        let mut sectors = [false; 12];
        for &n in &on {
            let turn = (polar[n as usize][1] / TAU).rem_euclid(1.0);
            sectors[((12.0 * turn) as usize).min(11)] = true;
        }
        let around = sectors.iter().filter(|s| **s).count() >= 6;
        (around && 2.0 * area(&faces) > area(piece)).then(|| {
            let cylinder = axis.cylinder(skin.nodes, on);
            (faces, cylinder)
        })
    };
    let found = inner.iter().filter_map(of);
    let rank = |c: &Cylinder| given.map_or(c.radius, |r| (c.radius - r).abs());
    found.min_by(|a, b| rank(&a.1).total_cmp(&rank(&b.1)))
}

/// An angle in (-pi, pi].
pub fn wrapped(angle: f64) -> f64 {
    PI - (PI - angle).rem_euclid(TAU)
}

/// The teeth of a shell.
#[derive(Clone, Debug)]
pub struct Teeth {
    /// Angle of the first [rad]; the others follow evenly, counter-clockwise.
    pub first: f64,
    /// Number of teeth.
    pub count: u32,
    /// Tooth of each face of the body, for faces that belong to one.
    pub of_face: Vec<Option<u32>>,
}

/// Counts the teeth: pieces of the shell that are separate above a height, with the count that is constant over most
/// heights and evenly spaced; a `wished` count has priority.
pub fn count(
    skin: &Skin<'_>,
    polar: &Polar,
    shell: &[u32],
    wished: Option<u32>,
) -> Result<Teeth, String> {
    let lowest = |f: u32| {
        let corners = skin.facets[f as usize].corners().iter();
        corners.fold(f64::MAX, |m, &n| m.min(polar[n as usize][0]))
    };
    let heights: Vec<f64> = shell.iter().map(|&f| lowest(f)).collect();
    let mut height_of = vec![f64::MIN; skin.facets.len()];
    for (&f, h) in shell.iter().zip(&heights) {
        height_of[f as usize] = *h;
    }
    let low = heights.iter().copied().fold(f64::MAX, f64::min);
    let high = shell
        .iter()
        .flat_map(|&f| skin.facets[f as usize].corners());
    let high = high.fold(0.0, |m: f64, &n| m.max(polar[n as usize][0]));
    let limit = |level: usize| low + (high - low) * (level as f64 + 0.5) / LEVELS as f64;
    let above = |level: usize| skin.pieces(|f| height_of[f] >= limit(level));
    let counts: Vec<usize> = (0..LEVELS).map(|l| above(l).len()).collect();
    let mut tried: Vec<usize> = counts.iter().copied().filter(|c| *c >= FEWEST).collect();
    tried.sort_unstable();
    tried.dedup();
    let holds = |count: usize| counts.iter().filter(|&&c| c == count).count();
    tried.sort_by_key(|&c| {
        let wish = wished.is_some_and(|w| w as usize == c);
        std::cmp::Reverse((wish, holds(c), c))
    });
    let mut why = "no separate teeth near its outer circle".to_owned();
    for count in tried {
        let levels: Vec<usize> = (0..LEVELS).filter(|&l| counts[l] == count).collect();
        // Low on the teeth, where most of their faces are; what is uneven there may be even further up.
        for &level in &levels[..=levels.len() / 2] {
            match evenly(skin, polar, &above(level)) {
                Ok(teeth) => return Ok(teeth),
                Err(e) => why = e,
            }
        }
    }
    Err(why)
}

/// Returns pieces as teeth, if they are evenly spaced.
fn evenly(skin: &Skin<'_>, polar: &Polar, pieces: &[Vec<u32>]) -> Result<Teeth, String> {
    let count = pieces.len();
    let centre = |piece: &Vec<u32>| {
        let nodes = skin.nodes_of(piece, false);
        let sum = nodes.iter().fold([0.0; 2], |s, &n| {
            let [r, a, _] = polar[n as usize];
            [s[0] + r * a.cos(), s[1] + r * a.sin()]
        });
        sum[1].atan2(sum[0])
    };
    let centres: Vec<f64> = pieces.iter().map(centre).collect();
    let pitch = TAU / count as f64;
    let mut places: Vec<u32> = Vec::with_capacity(count);
    let mut worst = 0.0_f64;
    for &c in &centres {
        let steps = (c - centres[0]).rem_euclid(TAU) / pitch;
        worst = worst.max((steps - steps.round()).abs());
        places.push(steps.round() as u32 % count as u32);
    }
    let mut sorted = places.clone();
    sorted.sort_unstable();
    if worst > UNEVEN || sorted.windows(2).any(|w| w[0] == w[1]) {
        return Err(format!(
            "{count} teeth, one of them {worst:.2} pitches from equal spacing"
        ));
    }
    let mut of_face = vec![None; skin.facets.len()];
    for (piece, place) in pieces.iter().zip(&places) {
        for &f in piece {
            of_face[f as usize] = Some(*place);
        }
    }
    Ok(Teeth {
        first: centres[0],
        count: count as u32,
        of_face,
    })
}
