//! Recognition of a gear: its axis, its teeth, and the position of tooth 0.

use super::body::{Body, PlacedFlank, Placement};
use super::groups::Groups;
use super::patch::{Grid, grid};
use super::{BodyShape, circle, decline, snapped, wrapped};
use crate::deck::{Deck, DeckError};
use crate::recognise::Axis;
use crate::vector::turned;
use gearbench_models::Vec3;
use gearbench_models::geometry::Side;
use std::f64::consts::TAU;

/// Heights tried when teeth are counted.
const LEVELS: usize = 32;

/// Returns the nodes of each tooth: the pieces that are separate above a height. The count that is constant over the
/// largest range of heights is used, with the teeth at the middle of that range.
pub(super) fn teeth(body: &Body, height: &dyn Fn(u32) -> f64) -> Option<Vec<Vec<u32>>> {
    let elements: Vec<&[u32]> = body.corners().collect();
    let heights: Vec<f64> = (elements.iter())
        .map(|corners| corners.iter().map(|&n| height(n)).sum::<f64>() / corners.len() as f64)
        .collect();
    let low = heights.iter().copied().fold(f64::MAX, f64::min);
    let high = heights.iter().copied().fold(f64::MIN, f64::max);
    let above = |level: usize| -> Vec<Vec<u32>> {
        let limit = low + (high - low) * (level as f64 + 0.5) / LEVELS as f64;
        let mut groups = Groups::new(body.positions.len());
        let mut taken = vec![false; body.positions.len()];
        let all = elements.iter().zip(&heights);
        for (corners, _) in all.filter(|(_, height)| **height > limit) {
            for &n in *corners {
                taken[n as usize] = true;
                groups.join(corners[0], n);
            }
        }
        let mut number = vec![u32::MAX; body.positions.len()];
        let mut teeth: Vec<Vec<u32>> = Vec::new();
        for n in (0..body.positions.len() as u32).filter(|&n| taken[n as usize]) {
            let group = groups.find(n) as usize;
            if number[group] == u32::MAX {
                number[group] = teeth.len() as u32;
                teeth.push(Vec::new());
            }
            teeth[number[group] as usize].push(n);
        }
        teeth
    };
    let counts: Vec<usize> = (0..LEVELS).map(|l| above(l).len()).collect();
    let holds = |count: usize| counts.iter().filter(|&&c| c == count).count();
    let best = counts
        .iter()
        .copied()
        .filter(|&c| c > 1)
        .max_by_key(|&c| (holds(c), c))?;
    let levels: Vec<usize> = (0..LEVELS).filter(|&l| counts[l] == best).collect();
    Some(above(levels[levels.len() / 2]))
}

/// Height and place of a grid's row in the middle of the width.
fn middle(grid: &Grid, row: usize, point: &dyn Fn(u32) -> [f64; 3]) -> [f64; 2] {
    let nodes = &grid.nodes[row * grid.columns..][..grid.columns];
    let mut c = 1;
    while c + 1 < nodes.len() && point(nodes[c])[2] < 0.0 {
        c += 1;
    }
    let (a, b) = (point(nodes[c - 1]), point(nodes[c]));
    let dz = b[2] - a[2];
    let t = if dz > 0.0 {
        (-a[2] / dz).clamp(0.0, 1.0)
    } else {
        0.5
    };
    [0, 1].map(|i| a[i] + t * (b[i] - a[i]))
}

/// Profile of a flank in the middle of the width: `(height, place)` from the root to the tip, where `point`
/// gives height, place along the pitch and z from the middle of a node.
pub(super) fn profile(grid: &Grid, point: &dyn Fn(u32) -> [f64; 3]) -> Vec<[f64; 2]> {
    (0..grid.rows).map(|r| middle(grid, r, point)).collect()
}

/// Place on a profile at a height, if the profile has it.
pub(super) fn place_at(profile: &[[f64; 2]], height: f64) -> Option<f64> {
    profile.windows(2).find_map(|w| {
        let (a, b) = (w[0], w[1]);
        let slack = 1e-6 * (b[0] - a[0]);
        if !(b[0] > a[0] && height >= a[0] - slack && height <= b[0] + slack) {
            return None;
        }
        Some(a[1] + (b[1] - a[1]) * (height - a[0]) / (b[0] - a[0]))
    })
}

/// Centreline of a tooth between its flanks: mean place at equal heights.
pub(super) fn centreline(left: &[[f64; 2]], right: &[[f64; 2]]) -> Option<f64> {
    let mids: Vec<f64> = left
        .iter()
        .filter_map(|&[h, l]| place_at(right, h).map(|r| 0.5 * (l + r)))
        .collect();
    (!mids.is_empty()).then(|| mids.iter().sum::<f64>() / mids.len() as f64)
}

/// A flank with its tooth and side, determined by its position.
pub(super) struct PositionedFlank {
    /// Pitches from the base tooth.
    pub(super) steps: i64,
    /// Tooth in the name of its set.
    pub(super) label: i64,
    pub(super) side: Side,
    pub(super) grid: Grid,
    /// As [`profile`] gives it.
    pub(super) profile: Vec<[f64; 2]>,
}

/// Determines teeth and sides of the flanks; `offset` is the distance of a point from the centreline of the base
/// tooth, `left` the sign of that distance on left flanks.
pub(super) fn stands(
    body: &Body,
    deck: &Deck,
    pitch: f64,
    point: &dyn Fn(u32) -> [f64; 3],
    offset: &dyn Fn(f64) -> f64,
    left: f64,
) -> Result<Vec<PositionedFlank>, DeckError> {
    let mut found = Vec::with_capacity(body.flanks.len());
    for flank in &body.flanks {
        let z = |n: u32| point(n)[2];
        let height = |n: u32| point(n)[0];
        let grid = grid(
            deck,
            &flank.set,
            &flank.quads,
            flank.members.as_ref(),
            &height,
            &z,
        )?;
        let profile = profile(&grid, point);
        let mean = profile.iter().map(|p| offset(p[1])).sum::<f64>() / profile.len() as f64;
        let steps = (mean / pitch).round();
        let side = match (mean - steps * pitch) * left > 0.0 {
            true => Side::Left,
            false => Side::Right,
        };
        if side != flank.side || !mean.is_finite() {
            return Err(decline(
                deck,
                &flank.set,
                match flank.side {
                    Side::Left => {
                        "l on the counter-clockwise side of the tooth, seen against +z (for a rack: the side in contact with left flanks)"
                    }
                    Side::Right => {
                        "r on the clockwise side of the tooth, seen against +z (for a rack: the side in contact with right flanks)"
                    }
                },
                "the other side",
                "swap l and r in the names of the sets",
            ));
        }
        found.push(PositionedFlank {
            steps: steps as i64,
            label: flank.label,
            side,
            grid,
            profile,
        });
    }
    Ok(found)
}

/// Places a gear whose bore is a circle, seen along the axis; the nodes keep their positions in the deck.
pub(super) fn place(
    body: &Body,
    (deck, axis): (&Deck, &Axis),
    fitted: Vec3,
    bore_radius: f64,
) -> Result<Placement, DeckError> {
    let mut centre = fitted;
    if let Some(r) = body.rigid_body.map(|r| &deck.rigid_bodies[r]) {
        let reference = axis.seen(&deck.nodes[r.reference as usize]);
        let off = (reference.x - fitted.x).hypot(reference.y - fitted.y);
        if off.is_nan() || off > circle::TOLERANCE * bore_radius {
            return Err(decline(
                deck,
                &body.bore_set,
                "the rigid body's reference node on the axis",
                format!(
                    "node {} at a distance of {off:.3e} m from it",
                    deck.node_name(r.reference)
                ),
                "the hub rotates about its reference node: put this node on the axis of the bore",
            ));
        }
        (centre.x, centre.y) = (reference.x, reference.y);
    }
    centre.x = snapped(centre.x, bore_radius);
    centre.y = snapped(centre.y, bore_radius);
    centre.z = body.mid_width();
    let relative: Vec<Vec3> = body.positions.iter().map(|x| x - centre).collect();
    let radius = |n: u32| relative[n as usize].x.hypot(relative[n as usize].y);
    let angle = |n: u32| relative[n as usize].y.atan2(relative[n as usize].x);

    let no_teeth = || {
        decline(
            deck,
            &body.bore_set,
            "a body with teeth around its bore",
            "no separate teeth near the tip",
            "is this body a gear?",
        )
    };
    let teeth_nodes = teeth(body, &radius).ok_or_else(no_teeth)?;
    let teeth = teeth_nodes.len();
    let pitch = TAU / teeth as f64;
    let centres: Vec<f64> = teeth_nodes
        .iter()
        .map(|nodes| {
            let first = angle(nodes[0]);
            let turn = nodes.iter().map(|&n| wrapped(angle(n) - first));
            wrapped(first + turn.sum::<f64>() / nodes.len() as f64)
        })
        .collect();
    // The teeth have to stand evenly; a tenth of a pitch is far more than any pitch error.
    for &c in &centres {
        let steps = wrapped(c - centres[0]) / pitch;
        let off = (steps - steps.round()).abs();
        if off.is_nan() || off > 0.1 {
            return Err(decline(
                deck,
                &body.bore_set,
                format!("{teeth} teeth with equal pitch around the axis"),
                format!("two teeth {:.2} pitches apart", steps.abs()),
                "are there gaps or further bodies joined to the rim?",
            ));
        }
    }
    let base = centres[0];
    let point = |n: u32| {
        let a = angle(n);
        [radius(n), base + wrapped(a - base), relative[n as usize].z]
    };
    let offset = |a: f64| a - base;
    let mut stands = stands(body, deck, pitch, &point, &offset, 1.0)?;
    // Tooth 0 is the one called 1; without such a name the lowest name counts on, without any name the tooth
    // next to +x.
    let first = stands.iter().min_by_key(|s| ((s.label - 1).abs(), s.label));
    let zero = match first {
        Some(s) => s.steps - (s.label - 1),
        None => {
            let near = centres
                .iter()
                .copied()
                .min_by(|a, b| a.abs().total_cmp(&b.abs()));
            (wrapped(near.unwrap_or(base) - base) / pitch).round() as i64
        }
    };
    let tooth_of = |steps: i64| (steps - zero).rem_euclid(teeth as i64) as u32;
    // Places of one tooth have to lie on one branch of the angle.
    for s in &mut stands {
        let turn = s.steps as f64 * pitch;
        for p in &mut s.profile {
            p[1] = wrapped(p[1] - base - turn);
        }
    }
    let between = |tooth: u32| {
        let of = |side: Side| {
            stands
                .iter()
                .find(|s| tooth_of(s.steps) == tooth && s.side == side)
        };
        let (l, r) = (of(Side::Left)?, of(Side::Right)?);
        Some(base + l.steps as f64 * pitch + centreline(&l.profile, &r.profile)?)
    };
    let by_flanks = (0..teeth as u32).find_map(|tooth| Some((tooth, between(tooth)?)));
    let phase = match by_flanks {
        Some((tooth, angle)) => angle - f64::from(tooth) * pitch,
        None => {
            let at = base + zero as f64 * pitch;
            let near = centres
                .iter()
                .copied()
                .min_by(|a, b| wrapped(a - at).abs().total_cmp(&wrapped(b - at).abs()));
            near.unwrap_or(at)
        }
    };
    let phase = snapped(wrapped(phase), 1.0);
    if !phase.is_finite() {
        return Err(no_teeth());
    }
    let positions = relative.iter().map(|&x| turned(x, -phase)).collect();
    let flanks = stands
        .into_iter()
        .map(|s| PlacedFlank {
            tooth: tooth_of(s.steps),
            side: s.side,
            grid: s.grid,
        })
        .collect();
    Ok(Placement {
        shape: BodyShape::Gear,
        teeth: teeth as u32,
        centre,
        phase,
        flanks,
        positions,
    })
}
