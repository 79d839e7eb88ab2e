//! Placement of names on a chart: clear of points, of other names, and of lines.

use super::canvas::{Anchor, Canvas, Ink, Stroke, Type, text_width};
use super::geometry::{Rect, clip_segment};

type Point = (f64, f64);

/// Largest distance of a name from its point.
const REACH: f64 = 190.0;
/// Extra distance of a name that is accepted for each pale marker that it then does not cover.
const COVERED: f64 = 14.0;
/// Between the lines of a leader and a name.
const CLEAR: f64 = 1.5;

/// Occupied rectangles and lines in an area of the page, for the placement of names.
pub struct OccupiedArea {
    area: Rect,
    boxes: Vec<Rect>,
    /// Rectangles that names avoid as long as there is free space elsewhere.
    soft: Vec<Rect>,
    lines: Vec<(Point, Point)>,
}

impl OccupiedArea {
    /// Makes an area in which nothing is taken yet.
    pub fn of(area: Rect) -> Self {
        Self {
            area,
            boxes: Vec::new(),
            soft: Vec::new(),
            lines: Vec::new(),
        }
    }

    /// Marks a rectangle as taken.
    pub fn occupy(&mut self, taken: Rect) {
        self.boxes.push(taken);
    }

    /// Marks the rectangle of a marker as taken.
    pub fn occupy_point(&mut self, at: Point, radius: f64) {
        if at.0.is_finite() && at.1.is_finite() {
            self.occupy(Rect::around(at, radius));
        }
    }

    /// Marks the rectangle of a pale marker, which names cover only where there is no other space.
    pub fn keep_pale(&mut self, at: Point, radius: f64) {
        if at.0.is_finite() && at.1.is_finite() {
            self.soft.push(Rect::around(at, radius));
        }
    }

    /// Marks a line through points as taken.
    pub fn occupy_line(&mut self, points: &[Point]) {
        let inside = points
            .windows(2)
            .filter_map(|p| clip_segment(p[0], p[1], &self.area));
        self.lines.extend(inside);
    }

    /// True if a name fits at `place`: inside the area, clear of all taken rectangles and of all lines.
    pub fn is_free(&self, place: &Rect) -> bool {
        let place = place.grown(CLEAR);
        self.area.contains(&place)
            && !self.boxes.iter().any(|t| t.overlaps(&place))
            && !(self.lines.iter()).any(|(a, b)| clip_segment(*a, *b, &place).is_some())
    }

    /// True if a leader from a point to its name crosses no taken rectangle but that of its own point.
    fn is_open(&self, from: Point, to: Point) -> bool {
        let own = |r: &Rect| r.contains(&Rect::around(from, 0.0));
        let mut boxes = self.boxes.iter().filter(|r| !own(r));
        !boxes.any(|r| clip_segment(from, to, r).is_some())
    }

    /// Reserves the free rectangle for a text that is closest to its point; `None` if there is none within reach.
    pub fn place_text(&mut self, text: &str, size: f64, at: Point) -> Option<Rect> {
        if !(at.0.is_finite() && at.1.is_finite()) {
            return None;
        }
        let width = text_width(text, size) + 2.0;
        let free = (places(width, size, at).into_iter())
            .filter(|(_, r)| self.is_free(r))
            .filter(|(_, r)| end_of_leader(at, r).is_none_or(|end| self.is_open(at, end)));
        // Rather a little further off than on pale markers.
        let cost = |(off, r): &(f64, Rect)| {
            off + COVERED * self.soft.iter().filter(|s| s.overlaps(r)).count() as f64
        };
        let best = free.min_by(|a, b| cost(a).total_cmp(&cost(b)));
        let (_, place) = best?;
        self.occupy(place);
        if let Some(end) = end_of_leader(at, &place) {
            self.occupy_line(&[at, end]);
        }
        Some(place)
    }

    /// Reserves the free rectangle for the name of a horizontal line, from the left, above the line before below it.
    pub fn along(&mut self, text: &str, size: f64, y: f64) -> Option<Rect> {
        if !y.is_finite() {
            return None;
        }
        let width = text_width(text, size) + 2.0;
        let half = 0.57 * size;
        let steps = ((self.area.width() - width - 12.0) / 9.0).max(0.0) as usize;
        let left = self.area.x0 + 6.0;
        let boxed = |middle: f64, k: usize| {
            let left = left + 9.0 * k as f64;
            Rect::new(left, middle - half, left + width, middle + half)
        };
        let above = (0..=steps).map(|k| boxed(y - half - 3.0, k));
        let below = (0..=steps).map(|k| boxed(y + half + 3.0, k));
        let found = above.chain(below).find(|r| self.is_free(r))?;
        self.occupy(found);
        Some(found)
    }

    /// Writes a name next to its point, with a leader where it is further away; returns false if there was no space.
    pub fn write(&mut self, c: &mut Canvas, text: &str, at: Point, kind: Type) -> bool {
        let Some(place) = self.place_text(text, kind.size, at) else {
            return false;
        };
        if let Some(end) = end_of_leader(at, &place) {
            c.line(&[at, end], Stroke::new(Ink::PALE, 0.9));
        }
        if self.soft.iter().any(|s| s.overlaps(&place)) {
            c.fill(&place, Ink::WHITE.opacity(0.8));
        }
        // The viewer's font may be wider than the estimate: a text grows away from its point.
        let (anchor, x) = match at.0 {
            x if x <= place.x0 => (Anchor::Start, place.x0 + 1.0),
            x if x >= place.x1 => (Anchor::End, place.x1 - 1.0),
            _ => (Anchor::Middle, 0.5 * (place.x0 + place.x1)),
        };
        c.text(text, (x, place.middle()), Type { anchor, ..kind });
        true
    }

    /// Writes the name of a horizontal line next to it.
    pub fn write_along(&mut self, c: &mut Canvas, text: &str, y: f64, kind: Type) -> bool {
        let Some(place) = self.along(text, kind.size, y) else {
            return false;
        };
        let left = (place.x0 + 1.0, place.middle());
        c.text(
            text,
            left,
            Type {
                anchor: Anchor::Start,
                ..kind
            },
        );
        true
    }
}

/// Returns the end of the leader of a name; `None` if the name is next to its point.
fn end_of_leader((x, y): Point, name: &Rect) -> Option<Point> {
    let foot = x.clamp(name.x0 + 1.0, name.x1 - 1.0);
    let near = y.clamp(name.y0, name.y1);
    ((foot - x).hypot(near - y) > 11.0).then_some((foot, near))
}

/// Returns candidate rectangles for a text around its point with their distances: at its sides, above and below, then
/// in a wider grid.
fn places(width: f64, size: f64, (x, y): Point) -> Vec<(f64, Rect)> {
    let half = 0.57 * size;
    let boxed =
        |left: f64, middle: f64| Rect::new(left, middle - half, left + width, middle + half);
    let close = [
        boxed(x + 8.0, y),
        boxed(x - 8.0 - width, y),
        boxed(x - 0.5 * width, y - half - 8.0),
        boxed(x - 0.5 * width, y + half + 8.0),
        boxed(x + 5.0, y - half - 5.0),
        boxed(x + 5.0, y + half + 5.0),
        boxed(x - 5.0 - width, y - half - 5.0),
        boxed(x - 5.0 - width, y + half + 5.0),
    ];
    let close = close.into_iter().enumerate();
    let mut places: Vec<(f64, Rect)> = close.map(|(i, r)| (i as f64, r)).collect();
    let pitch = 0.6 * size;
    let reach = (REACH / pitch) as i32;
    for i in -reach..=reach {
        for k in -reach..=reach {
            let (dx, dy) = (1.4 * pitch * f64::from(i), pitch * f64::from(k));
            let r = boxed(x + dx - 0.5 * width, y + dy);
            let near = (x.clamp(r.x0, r.x1) - x).hypot(y.clamp(r.y0, r.y1) - y);
            if near > 9.0 && near < REACH {
                places.push((near + 0.15 * dx.abs(), r));
            }
        }
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Names of points on two levels under a limit and a staircase: none on a line, a point or another name.
    #[test]
    fn names_keep_clear_of_lines_points_and_each_other() {
        let area = Rect::new(0.0, 0.0, 700.0, 330.0);
        let mut room = OccupiedArea::of(area);
        let mut lines: Vec<Vec<Point>> = vec![vec![(0.0, 100.0), (700.0, 100.0)]];
        lines.push(vec![
            (40.0, 0.0),
            (40.0, 104.0),
            (300.0, 104.0),
            (300.0, 250.0),
            (700.0, 250.0),
        ]);
        for line in &lines {
            room.occupy_line(line);
        }
        let points: Vec<Point> = (0..22)
            .map(|i| {
                (
                    30.0 + 13.0 * f64::from(i % 11),
                    if i < 11 { 104.0 } else { 150.0 },
                )
            })
            .collect();
        for p in &points {
            room.occupy_point(*p, 6.0);
        }
        let mut names = Vec::new();
        for (i, p) in points.iter().enumerate() {
            names.push(
                room.place_text(&(i + 1).to_string(), 11.5, *p)
                    .expect("room"),
            );
        }
        names.push(room.along("tolerance 5 %", 12.0, 100.0).expect("room"));
        for (i, a) in names.iter().enumerate() {
            assert!(area.contains(a));
            assert!(names[i + 1..].iter().all(|b| !a.overlaps(b)), "{a:?}");
            let on = |p: &&Point| Rect::around(**p, 6.0).overlaps(a);
            assert_eq!(points.iter().find(on), None, "{a:?}");
            for pair in lines.iter().flat_map(|l| l.windows(2)) {
                assert_eq!(clip_segment(pair[0], pair[1], a), None, "{a:?}");
            }
        }
    }

    #[test]
    fn without_room_there_is_no_name() {
        let mut room = OccupiedArea::of(Rect::new(0.0, 0.0, 60.0, 20.0));
        assert_eq!(
            room.place_text("a name that is too long", 12.0, (30.0, 10.0)),
            None
        );
        room.occupy(Rect::new(0.0, 0.0, 60.0, 20.0));
        assert_eq!(room.place_text("1", 12.0, (30.0, 10.0)), None);
        assert_eq!(room.along("1", 12.0, 10.0), None);
    }
}
