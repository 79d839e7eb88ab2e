//! Names beside points, where there is room.

use super::canvas::{Anchor, Canvas, Ink, Rect, Stroke, Type, text_width};

/// Font size of the names of points.
const LABEL: f64 = 11.5;

/// Takes the free place for a label next to its point; false where there is none.
pub fn label_place(text: &str, (x, y): (f64, f64), area: &Rect, taken: &mut Vec<Rect>) -> bool {
    let width = text_width(text, LABEL) + 2.0;
    let boxed = |left: f64, middle: f64| Rect::new(left, middle - 6.5, left + width, middle + 6.5);
    let mut places = vec![boxed(x + 9.0, y), boxed(x - 9.0 - width, y)];
    for level in 1..=5 {
        let d = 2.0 + 13.0 * f64::from(level);
        for left in [x - 0.5 * width, x + 4.0, x - 4.0 - width] {
            places.extend([boxed(left, y - d), boxed(left, y + d)]);
        }
    }
    let free = places
        .into_iter()
        .find(|r| area.contains(r) && !taken.iter().any(|t| t.overlaps(r)));
    taken.extend(free);
    free.is_some()
}

/// Writes a label beside its point where there is room; the table has those that find none.
pub fn point_label(
    c: &mut Canvas<'_>,
    text: &str,
    (x, y): (f64, f64),
    area: &Rect,
    taken: &mut Vec<Rect>,
) {
    if label_place(text, (x, y), area, taken)
        && let Some(r) = taken.last()
    {
        let middle = 0.5 * (r.y0 + r.y1);
        if (middle - y).abs() > 20.0 {
            let toward = if middle < y { r.y1 } else { r.y0 };
            let foot = x.clamp(r.x0 + 3.0, r.x1 - 3.0);
            c.line(&[(x, y), (foot, toward)], Stroke::new(Ink::PALE, 0.8));
        }
        let kind = Type::new(LABEL, Anchor::Start).ink(Ink::GREY);
        c.text(text, (r.x0, middle), kind);
    }
}
