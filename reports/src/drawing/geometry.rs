//! Rectangles on the page or in data, and clipping of lines and polygons to them.

/// A rectangle: left, top, right, bottom, on the page or in data (then top > bottom).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rect {
    pub x0: f64,
    pub y0: f64,
    pub x1: f64,
    pub y1: f64,
}

impl Rect {
    pub fn new(x0: f64, y0: f64, x1: f64, y1: f64) -> Self {
        Self { x0, y0, x1, y1 }
    }
    /// Makes the square with a point in its middle.
    pub fn around((x, y): (f64, f64), half: f64) -> Self {
        Self::new(x - half, y - half, x + half, y + half)
    }
    /// Returns the rectangle enlarged by `by` on every side.
    pub fn grown(&self, by: f64) -> Self {
        Self::new(self.x0 - by, self.y0 - by, self.x1 + by, self.y1 + by)
    }
    /// Returns the ordinate of the centre.
    pub fn middle(&self) -> f64 {
        0.5 * (self.y0 + self.y1)
    }
    pub fn width(&self) -> f64 {
        self.x1 - self.x0
    }
    pub fn height(&self) -> f64 {
        self.y1 - self.y0
    }
    pub fn overlaps(&self, other: &Self) -> bool {
        self.x0 < other.x1 && other.x0 < self.x1 && self.y0 < other.y1 && other.y0 < self.y1
    }
    /// True if a point lies inside, edges included.
    pub fn holds(&self, (x, y): (f64, f64)) -> bool {
        (self.x0..=self.x1).contains(&x) && (self.y0..=self.y1).contains(&y)
    }
    /// True if the other rectangle lies inside, edges included.
    pub fn contains(&self, other: &Self) -> bool {
        self.x0 <= other.x0 && other.x1 <= self.x1 && self.y0 <= other.y0 && other.y1 <= self.y1
    }
}

/// Returns the part of a segment inside a rectangle (Liang and Barsky, ACM Trans. Graphics 3, 1984).
pub fn clip_segment(a: (f64, f64), b: (f64, f64), r: &Rect) -> Option<((f64, f64), (f64, f64))> {
    if ![a.0, a.1, b.0, b.1].iter().all(|x| x.is_finite()) {
        return None;
    }
    let (dx, dy) = (b.0 - a.0, b.1 - a.1);
    let (mut t0, mut t1) = (0.0_f64, 1.0_f64);
    for (p, q) in [
        (-dx, a.0 - r.x0),
        (dx, r.x1 - a.0),
        (-dy, a.1 - r.y0),
        (dy, r.y1 - a.1),
    ] {
        if p == 0.0 {
            if q < 0.0 {
                return None;
            }
        } else if p < 0.0 {
            t0 = t0.max(q / p);
        } else {
            t1 = t1.min(q / p);
        }
    }
    let at = |t: f64| (a.0 + t * dx, a.1 + t * dy);
    // Ends that were not cut stay bit for bit, so that pieces join.
    (t0 <= t1).then(|| {
        (
            if t0 > 0.0 { at(t0) } else { a },
            if t1 < 1.0 { at(t1) } else { b },
        )
    })
}

/// Simplifies a polyline (Douglas and Peucker, Cartographica 10, 1973): every point that is left out lies closer than
/// `within` to the result; first and last point stay.
pub fn simplified(points: &[(f64, f64)], within: f64) -> Vec<(f64, f64)> {
    simplified_by(points, within, |p, a, b| {
        let (dx, dy) = (b.0 - a.0, b.1 - a.1);
        let square = dx * dx + dy * dy;
        let (x, y) = (p.0 - a.0, p.1 - a.1);
        let t = if square > 0.0 {
            ((x * dx + y * dy) / square).clamp(0.0, 1.0)
        } else {
            0.0
        };
        (x - t * dx).hypot(y - t * dy)
    })
}

/// Simplifies the graph of a function: the ordinate of every point that is left out differs by less than `within` from
/// the result.
pub fn simplified_upright(points: &[(f64, f64)], within: f64) -> Vec<(f64, f64)> {
    simplified_by(points, within, |p, a, b| {
        let t = (p.0 - a.0) / (b.0 - a.0);
        match (0.0..=1.0).contains(&t) {
            true => (p.1 - a.1 - t * (b.1 - a.1)).abs(),
            // A line that turns back is no graph there: the point stays.
            false => f64::INFINITY,
        }
    })
}

/// Simplifies a polyline with the distance of a point from a segment.
fn simplified_by(
    points: &[(f64, f64)],
    within: f64,
    distance: impl Fn((f64, f64), (f64, f64), (f64, f64)) -> f64,
) -> Vec<(f64, f64)> {
    if points.len() < 3 {
        return points.to_vec();
    }
    let mut kept = vec![false; points.len()];
    let mut parts = vec![(0, points.len() - 1)];
    while let Some((first, last)) = parts.pop() {
        (kept[first], kept[last]) = (true, true);
        let far = (first + 1..last)
            .map(|i| (distance(points[i], points[first], points[last]), i))
            .max_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((d, i)) = far
            && d > within
        {
            parts.extend([(first, i), (i, last)]);
        }
    }
    let all = points.iter().zip(kept);
    all.filter(|(_, kept)| *kept).map(|(p, _)| *p).collect()
}

/// Returns a polygon cut to a rectangle (Sutherland and Hodgman, Comm. ACM 17, 1974).
pub fn clip_polygon(points: &[(f64, f64)], r: &Rect) -> Vec<(f64, f64)> {
    type Point = (f64, f64);
    let mut polygon: Vec<Point> = points.to_vec();
    let edges: [&dyn Fn(&Point) -> f64; 4] =
        [&|p| p.0 - r.x0, &|p| r.x1 - p.0, &|p| p.1 - r.y0, &|p| {
            r.y1 - p.1
        }];
    for inside in edges {
        let mut cut = Vec::with_capacity(polygon.len());
        for i in 0..polygon.len() {
            let (a, b) = (polygon[i], polygon[(i + 1) % polygon.len()]);
            let (da, db) = (inside(&a), inside(&b));
            if da >= 0.0 {
                cut.push(a);
            }
            if (da < 0.0) != (db < 0.0) {
                let t = da / (da - db);
                cut.push((a.0 + t * (b.0 - a.0), a.1 + t * (b.1 - a.1)));
            }
        }
        polygon = cut;
    }
    polygon
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn simplified_lines_stay_where_they_are() {
        let wave: Vec<(f64, f64)> = (0..2000)
            .map(|i| (0.3 * f64::from(i), 50.0 * (0.01 * f64::from(i)).sin()))
            .collect();
        let few = simplified(&wave, 0.1);
        assert!(few.len() < 200 && few[0] == wave[0] && few.last() == wave.last());
        let top = |p: &[(f64, f64)]| p.iter().map(|p| p.1).fold(0.0, f64::max);
        assert!((top(&few) - top(&wave)).abs() < 0.1);
        // There and back again.
        let spike = [(0.0, 0.0), (5.0, 9.0), (0.0, 0.0)];
        assert_eq!(simplified(&spike, 0.1), spike);
    }

    #[test]
    fn clipping() {
        let r = Rect::new(0.0, 0.0, 1.0, 1.0);
        let cut = clip_segment((-1.0, 0.5), (2.0, 0.5), &r).unwrap();
        assert_eq!(cut, ((0.0, 0.5), (1.0, 0.5)));
        assert!(clip_segment((-1.0, 2.0), (2.0, 2.0), &r).is_none());
        let square = [(-1.0, -1.0), (0.5, -1.0), (0.5, 0.5), (-1.0, 0.5)];
        let p = clip_polygon(&square, &r);
        let area: f64 = (0..p.len())
            .map(|i| {
                let (a, b) = (p[i], p[(i + 1) % p.len()]);
                0.5 * (a.0 * b.1 - b.0 * a.1)
            })
            .sum();
        assert!((area.abs() - 0.25).abs() < 1e-12);
    }
}
