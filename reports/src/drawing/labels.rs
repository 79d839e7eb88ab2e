//! Names beside points, where there is room.

use super::canvas::{Anchor, Canvas, Ink, Stroke, Type, text_width};
use super::geometry::Rect;

/// Font size of the names of points.
const LABEL: f64 = 11.5;

/// The places for a text next to its point, the closest first: above and below it, or to its sides where lines run
/// through the points.
fn places(text: &str, size: f64, (x, y): (f64, f64), aside: bool) -> Vec<Rect> {
    let width = text_width(text, size) + 2.0;
    let half = 0.57 * size;
    let boxed =
        |left: f64, middle: f64| Rect::new(left, middle - half, left + width, middle + half);
    let mut places = vec![boxed(x + 9.0, y), boxed(x - 9.0 - width, y)];
    let mut lefts = [x - 0.5 * width, x + 4.0, x - 4.0 - width];
    if aside {
        lefts.rotate_left(1);
    }
    for level in 1..=6 {
        let d = if aside { 4.0 } else { 2.0 } + 1.13 * size * f64::from(level);
        for left in lefts {
            places.extend([boxed(left, y - d), boxed(left, y + d)]);
        }
    }
    places
}

fn is_free(place: &Rect, area: &Rect, taken: &[Rect]) -> bool {
    area.contains(place) && !taken.iter().any(|t| t.overlaps(place))
}

/// Takes the free place for a text next to its point; the closest one where there is none.
pub fn free_place(
    text: &str,
    size: f64,
    at: (f64, f64),
    area: &Rect,
    taken: &mut Vec<Rect>,
) -> Rect {
    let all = places(text, size, at, true);
    let free = all.iter().find(|r| is_free(r, area, taken));
    let place = *free.unwrap_or(&all[0]);
    taken.push(place);
    place
}

/// A line from a point to its name when that stands further off than `reach`.
pub fn leader(c: &mut Canvas<'_>, (x, y): (f64, f64), name: &Rect, reach: f64, ink: Ink) {
    if (name.middle() - y).abs() > reach {
        let foot = x.clamp(name.x0 + 3.0, name.x1 - 3.0);
        let toward = if name.middle() < y { name.y1 } else { name.y0 };
        c.line(&[(x, y), (foot, toward)], Stroke::new(ink, 0.8));
    }
}

/// Writes a name beside its point where there is room, on a plate if one is asked for; the table has those that find none.
pub fn point_label(
    c: &mut Canvas<'_>,
    text: &str,
    at: (f64, f64),
    area: &Rect,
    taken: &mut Vec<Rect>,
    plate: bool,
) {
    let all = places(text, LABEL, at, false);
    let Some(place) = all.into_iter().find(|r| is_free(r, area, taken)) else {
        return;
    };
    taken.push(place);
    if plate {
        c.fill(&place, Ink::WHITE.opacity(0.78));
    }
    leader(c, at, &place, 20.0, Ink::PALE);
    let kind = Type::new(LABEL, Anchor::Start).ink(Ink::GREY);
    c.text(text, (place.x0, place.middle()), kind);
}
