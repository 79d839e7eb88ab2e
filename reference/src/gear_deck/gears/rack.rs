//! Recognition of a rack: its direction, its teeth, its reference line, and the position of tooth 0.

use super::body::{Body, PlacedFlank, Placement};
use super::spur::{centreline, stands, teeth};
use super::{BodyShape, decline, snapped};
use crate::deck::{Deck, DeckError};
use crate::vector::turned;
use gearbench_models::Vec3;
use gearbench_models::geometry::Side;

/// Places a rack whose back is a plane with this normal, of either sense.
pub(super) fn place(body: &Body, deck: &Deck, normal: Vec3) -> Result<Placement, DeckError> {
    // The own x axis points from the teeth to the back.
    let back = body.positions[body.bore[0] as usize];
    let middle = body.positions.iter().sum::<Vec3>() / body.positions.len() as f64;
    let x = if (back - middle).dot(&normal) > 0.0 {
        normal
    } else {
        -normal
    };
    let direction = snapped(x.y.atan2(x.x), 1.0);
    let z = body.mid_width();
    let upright: Vec<Vec3> = body
        .positions
        .iter()
        .map(|p| turned(p - Vec3::new(0.0, 0.0, z), -direction))
        .collect();
    let height = |n: u32| -upright[n as usize].x;
    let point = |n: u32| [height(n), upright[n as usize].y, upright[n as usize].z];

    let uneven = |found: String| {
        decline(
            deck,
            &body.bore_set,
            "a body with two or more even teeth above its back",
            found,
            "is this body a rack?",
        )
    };
    let teeth_nodes =
        teeth(body, &height).ok_or_else(|| uneven("no separate teeth near the tip".into()))?;
    let teeth = teeth_nodes.len();
    let mut centres: Vec<f64> = teeth_nodes
        .iter()
        .map(|t| t.iter().map(|&n| point(n)[1]).sum::<f64>() / t.len() as f64)
        .collect();
    centres.sort_by(f64::total_cmp);
    let pitch = (centres[teeth - 1] - centres[0]) / (teeth - 1) as f64;
    if !centres
        .windows(2)
        .all(|w| ((w[1] - w[0]) - pitch).abs() < 0.1 * pitch)
    {
        return Err(uneven("uneven ones".into()));
    }
    // Teeth run from -(n - 1) / 2 to n / 2, as in the geometry.
    let base = centres[(teeth - 1) / 2];
    let offset = |y: f64| y - base;
    // Left flanks of a rack face -y: they meet left flanks of gears.
    let stands = stands(body, deck, pitch, &point, &offset, -1.0)?;
    let of = |side: Side| stands.iter().find(|s| s.steps == 0 && s.side == side);
    let between = match (of(Side::Left), of(Side::Right)) {
        (Some(l), Some(r)) => centreline(&l.profile, &r.profile),
        _ => None,
    };
    let centre_y = between.unwrap_or(base);
    // Half a tooth is a quarter of the pitch thick on the reference line.
    let reference = stands.iter().find_map(|s| {
        let mid = centre_y + s.steps as f64 * pitch;
        let thickness = |p: [f64; 2]| (p[1] - mid).abs() - 0.25 * pitch;
        s.profile.windows(2).find_map(|w| {
            let (a, b) = (thickness(w[0]), thickness(w[1]));
            (a >= 0.0 && b < 0.0).then(|| w[0][0] + (w[1][0] - w[0][0]) * a / (a - b))
        })
    });
    let Some(reference) = reference else {
        return Err(decline(
            deck,
            &body.bore_set,
            "a flank across the reference line, where the tooth is half a pitch thick",
            "none",
            "give the rack at least one set such as `flank_1l`",
        ));
    };
    let shift = Vec3::new(-reference, centre_y, 0.0);
    if !(shift.norm().is_finite() && pitch > 0.0) {
        return Err(uneven("positions out of range".into()));
    }
    // Rounding of the deck's positions is not a shift.
    let shift = Vec3::new(snapped(shift.x, pitch), snapped(shift.y, pitch), 0.0);
    Ok(Placement {
        shape: BodyShape::Rack { direction },
        teeth: teeth as u32,
        centre: turned(Vec3::new(shift.x, 0.0, z), direction),
        phase: shift.y,
        flanks: stands
            .into_iter()
            .map(|s| PlacedFlank {
                tooth: s.steps.rem_euclid(teeth as i64) as u32,
                side: s.side,
                grid: s.grid,
            })
            .collect(),
        positions: upright.iter().map(|p| p - shift).collect(),
    })
}
