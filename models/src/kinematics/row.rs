//! Sparse rows over the generalised coordinates of a scene, such as `w = dg/dq`.
//!
//! A row is a few spans of consecutive coordinates: one entry for a rigid gear, one or two for movable
//! teeth, all modes for an elastic one. Single entries stand in the row itself, longer spans in buffers that are
//! kept between uses.

/// Number of entries of one coordinate that a row stores without a span: two for each gear of a mesh.
const SINGLES: usize = 4;

/// Sparse row over the coordinates of a scene.
#[derive(Clone, Debug, Default)]
pub struct Row {
    /// Entries of one coordinate, `(coordinate, value)`, sufficient for rigid gears and movable teeth.
    singles: [(u32, f64); SINGLES],
    count: u32,
    /// Longer spans `(coordinate, length)`, and further entries of one coordinate.
    spans: Vec<(u32, u32)>,
    values: Vec<f64>,
    /// Number of single entries and spans that belong to the first gear of the mesh.
    split: (u32, u32),
    offset: u32,
    factor: f64,
}

impl Row {
    /// Removes all entries.
    #[inline]
    pub fn clear(&mut self) {
        self.count = 0;
        if !self.spans.is_empty() {
            self.spans.clear();
            self.values.clear();
        }
        self.split = (0, 0);
        self.offset = 0;
        self.factor = 1.0;
    }

    /// Sets the gear of the following entries, by the `offset` of its coordinates, and a `factor`.
    #[inline]
    pub fn target(&mut self, offset: usize, factor: f64) {
        self.offset = offset as u32;
        self.factor = factor;
    }

    /// Marks the start of the entries of the second gear of the mesh.
    #[inline]
    pub fn mark_split(&mut self) {
        self.split = (self.count, self.spans.len() as u32);
    }

    /// Adds one entry at the gear's coordinate `i`.
    #[inline]
    pub fn push(&mut self, i: usize, value: f64) {
        let entry = (self.offset + i as u32, self.factor * value);
        if let Some(free) = self.singles.get_mut(self.count as usize) {
            *free = entry;
            self.count += 1;
        } else {
            self.spans.push((entry.0, 1));
            self.values.push(entry.1);
        }
    }

    /// Adds consecutive entries from the gear's coordinate `i` on.
    #[inline]
    pub fn push_span(&mut self, i: usize, values: impl IntoIterator<Item = f64>) {
        let before = self.values.len();
        let factor = self.factor;
        self.values.extend(values.into_iter().map(|x| factor * x));
        self.spans
            .push((self.offset + i as u32, (self.values.len() - before) as u32));
    }

    /// Iterates over the longer spans among the first `count`: their first coordinate and values.
    #[inline]
    fn spans(&self, count: u32) -> impl Iterator<Item = (usize, &[f64])> {
        let mut rest = self.values.as_slice();
        self.spans[..count as usize]
            .iter()
            .map(move |&(start, len)| {
                let (values, tail) = rest.split_at(len as usize);
                rest = tail;
                (start as usize, values)
            })
    }

    /// Computes `row . x` over the first single entries and spans.
    #[inline]
    fn dot_of(&self, (singles, spans): (u32, u32), x: &[f64]) -> f64 {
        let mut sum = 0.0;
        for &(i, value) in &self.singles[..singles as usize] {
            sum += value * x[i as usize];
        }
        for (start, values) in self.spans(spans) {
            for (value, xi) in values.iter().zip(&x[start..]) {
                sum += value * xi;
            }
        }
        sum
    }

    /// Computes `y += factor row` over the first single entries and spans.
    #[inline]
    fn add_of(&self, (singles, spans): (u32, u32), factor: f64, y: &mut [f64]) {
        for &(i, value) in &self.singles[..singles as usize] {
            y[i as usize] += factor * value;
        }
        for (start, values) in self.spans(spans) {
            for (value, yi) in values.iter().zip(&mut y[start..]) {
                *yi += factor * value;
            }
        }
    }

    #[inline]
    fn all(&self) -> (u32, u32) {
        (self.count, self.spans.len() as u32)
    }

    /// Computes the scalar product `row . x`.
    #[inline]
    pub fn dot(&self, x: &[f64]) -> f64 {
        self.dot_of(self.all(), x)
    }

    /// Returns the parts of `row . x` that belong to the first and to the second gear.
    #[inline]
    pub fn dot_parts(&self, x: &[f64]) -> [f64; 2] {
        let first = self.dot_of(self.split, x);
        if self.spans.is_empty() {
            let rest = &self.singles[self.split.0 as usize..self.count as usize];
            let second = rest.iter().map(|&(i, value)| value * x[i as usize]).sum();
            return [first, second];
        }
        [first, self.dot(x) - first]
    }

    /// Adds a multiple of the row: `y += factor row`.
    #[inline]
    pub fn add_to(&self, factor: f64, y: &mut [f64]) {
        self.add_of(self.all(), factor, y);
    }

    /// Adds the parts of the row that belong to the first and to the second gear, each with its own factor, to `y`.
    #[inline]
    pub fn add_parts_to(&self, factors: [f64; 2], y: &mut [f64]) {
        self.add_of(self.all(), factors[1], y);
        if factors[0] != factors[1] {
            self.add_of(self.split, factors[0] - factors[1], y);
        }
    }

    /// Calls `f` with each coordinate of the scene and its value; a coordinate may occur more than once.
    #[inline]
    pub fn for_each(&self, mut f: impl FnMut(usize, f64)) {
        for &(i, value) in &self.singles[..self.count as usize] {
            f(i as usize, value);
        }
        for (start, values) in self.spans(self.spans.len() as u32) {
            for (i, value) in (start..).zip(values) {
                f(i, *value);
            }
        }
    }

    /// Calls `f` with each coordinate and value of the part of the row that belongs to the first gear (0) or to the
    /// second (1).
    pub fn for_each_of(&self, gear: usize, mut f: impl FnMut(usize, f64)) {
        let (singles, spans) = (self.split.0 as usize, self.split.1 as usize);
        let of_gear = if gear == 0 {
            &self.singles[..singles]
        } else {
            &self.singles[singles..self.count as usize]
        };
        for &(i, value) in of_gear {
            f(i as usize, value);
        }
        let own = |span: usize| (span < spans) == (gear == 0);
        let all = self.spans(self.spans.len() as u32).enumerate();
        for (_, (start, values)) in all.filter(|(span, _)| own(*span)) {
            for (i, value) in (start..).zip(values) {
                f(i, *value);
            }
        }
    }

    /// Returns true when the row has no entries.
    pub fn is_empty(&self) -> bool {
        self.count == 0 && self.values.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::Row;

    #[test]
    fn spans_dot_and_add() {
        let mut row = Row::default();
        row.clear();
        row.target(1, -1.0);
        row.push(0, 2.0);
        row.mark_split();
        row.target(3, 1.0);
        row.push_span(1, [3.0, 4.0]);
        let x = [1.0, 10.0, 100.0, 1e3, 1e4, 1e5];
        assert_eq!(row.dot(&x), -20.0 + 3e4 + 4e5);
        assert_eq!(row.dot_parts(&x), [-20.0, 3e4 + 4e5]);
        let mut y = [0.0; 6];
        row.add_to(0.5, &mut y);
        row.add_parts_to([1.0, 0.0], &mut y);
        assert_eq!(y, [0.0, -3.0, 0.0, 0.0, 1.5, 2.0]);
        let mut each = vec![];
        row.for_each(|i, value| each.push((i, value)));
        assert_eq!(each, [(1, -2.0), (4, 3.0), (5, 4.0)]);
        for (gear, want) in [(0, vec![(1, -2.0)]), (1, vec![(4, 3.0), (5, 4.0)])] {
            let mut part = vec![];
            row.for_each_of(gear, |i, value| part.push((i, value)));
            assert_eq!(part, want);
        }
    }

    #[test]
    fn more_single_entries_than_fit_inline() {
        let mut row = Row::default();
        for _ in 0..2 {
            row.clear();
            for i in 0..6 {
                if i == 5 {
                    row.mark_split();
                }
                row.target(i, 2.0);
                row.push(0, (i + 1) as f64);
            }
        }
        let x = [1.0, 10.0, 100.0, 1e3, 1e4, 1e5];
        assert_eq!(row.dot(&x), 2.0 * 654321.0);
        assert_eq!(row.dot_parts(&x)[0], 2.0 * 54321.0);
        let mut y = [0.0; 6];
        row.add_to(1.0, &mut y);
        assert_eq!(y, [2.0, 4.0, 6.0, 8.0, 10.0, 12.0]);
    }
}
