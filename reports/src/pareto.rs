//! The Pareto front of cost and error.
//!
//! A point dominates another when its cost and its error are no larger and one of them is smaller. The points that no
//! other dominates are the Pareto front. Nothing is interpolated: every statement is about points of runs. Points whose
//! cost or error is not finite are ignored; failed runs must not be made points at all.

/// Cost and error of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Cost, in any unit, positive.
    pub cost: f64,
    /// Magnitude of the error.
    pub error: f64,
}

impl Point {
    /// True if cost and error are finite, the cost above zero and the error not below zero.
    pub fn is_sound(&self) -> bool {
        self.cost.is_finite() && self.cost > 0.0 && self.error.is_finite() && self.error >= 0.0
    }
}

/// Returns the indices of the points that no other dominates, ascending in cost and falling in error. Of equal points
/// the first is kept.
pub fn front(points: &[Point]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len())
        .filter(|i| points[*i].is_sound())
        .collect();
    order.sort_by(|&a, &b| {
        let (a_point, b_point) = (points[a], points[b]);
        (a_point.cost.total_cmp(&b_point.cost))
            .then(a_point.error.total_cmp(&b_point.error))
            .then(a.cmp(&b))
    });
    let mut least = f64::INFINITY;
    order.retain(|&i| {
        let better = points[i].error < least;
        least = least.min(points[i].error);
        better
    });
    order
}

/// Returns the cheapest point whose error is within a limit; of equal cost the more accurate one.
pub fn cheapest(points: &[Point], limit: f64) -> Option<usize> {
    let within = |i: &usize| points[*i].is_sound() && points[*i].error <= limit;
    (0..points.len()).filter(within).min_by(|&a, &b| {
        (points[a].cost.total_cmp(&points[b].cost))
            .then(points[a].error.total_cmp(&points[b].error))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(all: &[(f64, f64)]) -> Vec<Point> {
        let point = |&(cost, error): &(f64, f64)| Point { cost, error };
        all.iter().map(point).collect()
    }

    #[test]
    fn the_front_is_what_nothing_beats() {
        let p = points(&[
            (4.0, 1.0),
            (1.0, 8.0),
            (2.0, 4.0),
            (3.0, 5.0),
            (5.0, 1.0),
            (9.0, 0.5),
        ]);
        assert_eq!(front(&p), [1, 2, 0, 5]);
        // By definition: no member is dominated, every other is.
        let dominates = |a: &Point, b: &Point| {
            a.cost <= b.cost && a.error <= b.error && (a.cost < b.cost || a.error < b.error)
        };
        for (i, q) in p.iter().enumerate() {
            let beaten = p.iter().any(|o| dominates(o, q));
            assert_eq!(front(&p).contains(&i), !beaten, "{q:?}");
        }
        assert!(front(&[]).is_empty());
    }

    #[test]
    fn ties() {
        // Equal points stand once, by the first; of equal cost the more accurate, of equal error the cheaper.
        let p = points(&[
            (1.0, 2.0),
            (1.0, 2.0),
            (1.0, 3.0),
            (2.0, 2.0),
            (3.0, 0.0),
            (4.0, 0.0),
        ]);
        assert_eq!(front(&p), [0, 4]);
        assert_eq!(cheapest(&p, 2.0), Some(0));
        assert_eq!(cheapest(&points(&[(1.0, 2.0), (1.0, 1.0)]), 5.0), Some(1));
    }

    #[test]
    fn what_is_no_number_belongs_to_nothing() {
        let p = points(&[
            (f64::NAN, 1e-9),
            (1e-9, f64::NAN),
            (f64::INFINITY, 0.0),
            (0.0, 0.1),
            (-1.0, 0.1),
            (1.0, f64::INFINITY),
            (1.0, -0.1),
            (2.0, 0.3),
        ]);
        assert_eq!(front(&p), [7]);
        assert_eq!(cheapest(&p, f64::INFINITY), Some(7));
        assert_eq!(cheapest(&p, 0.2), None);
    }
}
