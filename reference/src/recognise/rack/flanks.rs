//! Which faces of a rack are flanks, and where its tips, roots and back are.

use super::RecognisedRack;
use crate::recognise::skin::Skin;
use crate::recognise::tied::Unroll;
use crate::recognise::{ACROSS, FINE, Patch, RELIEF, extent, median};
use crate::vector::snapped;
use gearbench_models::Vec3;
use gearbench_models::geometry::Side;

/// With its flanks, its tips, roots and back, moved to the middle of the width.
pub(super) fn finished(skin: &Skin<'_>, mut rack: RecognisedRack) -> Option<RecognisedRack> {
    let mut own: Vec<Vec3> = skin.nodes.iter().map(|x| rack.own(x)).collect();
    let corners = skin.corner_nodes();
    let out: Vec<f64> = corners.iter().map(|&n| -own[n as usize].x).collect();
    let top = out.iter().copied().fold(f64::MIN, f64::max);
    // Faces that look out of the spaces between teeth: the deepest of them is the root, space by space.
    let mut deepest = vec![f64::MAX; rack.teeth as usize + 1];
    let mut sides: Vec<(u32, Side)> = Vec::new();
    for (f, facet) in skin.facets.iter().enumerate() {
        let n = &skin.normals[f];
        let (along, outwards) = (n.dot(&rack.axes[1]), -n.dot(&rack.axes[0]));
        if along.abs() > ACROSS {
            let side = if along < 0.0 { Side::Left } else { Side::Right };
            sides.push((f as u32, side));
        }
        if outwards < 0.5 {
            continue;
        }
        for &node in facet.corners() {
            let x = &own[node as usize];
            let turns = (x.y + x.z * rack.helix_angle.tan()) / rack.pitch;
            let from = turns + f64::from((rack.teeth - 1) / 2);
            // Half a pitch from the middle of a tooth, and no tip.
            if (from - from.floor() - 0.5).abs() < 0.25
                && (-1.0..f64::from(rack.teeth)).contains(&from)
            {
                let space = &mut deepest[(from.floor() + 1.0) as usize];
                *space = space.min(-x.x);
            }
        }
    }
    let lowest = deepest.into_iter().filter(|h| *h < top);
    rack.root = -median(lowest)?;
    let height = top + rack.root;
    let fine = FINE * height;
    let near = (8.0 * rack.residual[0]).max(fine);
    let upper = top - 0.25 * height;
    let mut patches = Patch::of_teeth(rack.teeth);
    for (f, side) in sides {
        let facet = &skin.facets[f as usize];
        let corners = facet.corners().iter().map(|&n| &own[n as usize]);
        let middle = corners.clone().sum::<Vec3>() / facet.corners().len() as f64;
        let tooth = rack.nearest(&middle, side);
        let member = |x: &Vec3| {
            let off = rack.distance(x, tooth, side);
            // What a relief takes away lies within the tooth.
            off.abs() <= near || -x.x > upper && off < 0.0 && -off < RELIEF * height
        };
        if corners.clone().all(member) {
            let place = 2 * tooth as usize + usize::from(side == Side::Right);
            patches[place].faces.push(f);
        }
    }
    patches.retain(|p| !p.faces.is_empty());
    let all: Vec<u32> = patches
        .iter()
        .flat_map(|p| p.faces.iter().copied())
        .collect();
    if all.is_empty() {
        return None;
    }
    let on = skin.nodes_of(&all, false);
    rack.active = extent(on.iter().map(|&n| -own[n as usize].x));
    let [low, high] = extent(on.iter().map(|&n| own[n as usize].z));
    rack.width = high - low;
    // The middle of the width, along the teeth.
    let middle = 0.5 * (low + high);
    let along = -middle * rack.helix_angle.tan();
    rack.origin += middle * rack.axes[2] + along * rack.axes[1];
    let size = rack.pitch * f64::from(rack.teeth);
    rack.origin = rack.origin.map(|x| snapped(x, size));
    own = skin.nodes.iter().map(|x| rack.own(x)).collect();
    let tips = out.iter().copied().filter(|h| top - h < 1e-3 * height);
    rack.tip = median(tips)?;
    let held = rack.back_nodes.iter().map(|&n| own[n as usize].x);
    rack.back = median(held)?;
    rack.flanks = patches;
    Some(rack)
}
