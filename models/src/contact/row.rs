//! Sparse rows over the generalised coordinates of a scene: `w = dg/dq` and its kin.
//!
//! A row is a few spans of consecutive coordinates: one entry for a rigid gear, one or two for movable
//! teeth, all modes for an elastic one. Buffers are kept between uses.

/// A sparse row.
#[derive(Clone, Debug, Default)]
pub struct Row {
    spans: Vec<(u32, u32)>,
    values: Vec<f64>,
    /// Number of spans and values that belong to the first gear of the mesh.
    split: (u32, u32),
    offset: u32,
    factor: f64,
}

impl Row {
    /// Empties the row.
    #[inline]
    pub fn clear(&mut self) {
        self.spans.clear();
        self.values.clear();
        self.split = (0, 0);
        self.offset = 0;
        self.factor = 1.0;
    }

    /// What follows belongs to a gear whose coordinates start at `offset`, and is scaled by `factor`.
    #[inline]
    pub fn target(&mut self, offset: usize, factor: f64) {
        self.offset = offset as u32;
        self.factor = factor;
    }

    /// What follows belongs to the second gear of the mesh.
    #[inline]
    pub fn mark_split(&mut self) {
        self.split = (self.spans.len() as u32, self.values.len() as u32);
    }

    /// One entry at the gear's coordinate `i`.
    #[inline]
    pub fn push(&mut self, i: usize, value: f64) {
        self.spans.push((self.offset + i as u32, 1));
        self.values.push(self.factor * value);
    }

    /// Consecutive entries from the gear's coordinate `i`.
    #[inline]
    pub fn push_span(&mut self, i: usize, values: impl IntoIterator<Item = f64>) {
        let before = self.values.len();
        let factor = self.factor;
        self.values.extend(values.into_iter().map(|x| factor * x));
        self.spans.push((self.offset + i as u32, (self.values.len() - before) as u32));
    }

    /// `row . x`.
    #[inline]
    pub fn dot(&self, x: &[f64]) -> f64 {
        let (mut sum, mut k) = (0.0, 0usize);
        for &(start, len) in &self.spans {
            for (i, &xi) in x[start as usize..][..len as usize].iter().enumerate() {
                sum += self.values[k + i] * xi;
            }
            k += len as usize;
        }
        sum
    }

    /// The part of `row . x` that belongs to the first gear.
    #[inline]
    pub fn dot_first(&self, x: &[f64]) -> f64 {
        let (mut sum, mut k) = (0.0, 0usize);
        for &(start, len) in &self.spans[..self.split.0 as usize] {
            for (i, &xi) in x[start as usize..][..len as usize].iter().enumerate() {
                sum += self.values[k + i] * xi;
            }
            k += len as usize;
        }
        sum
    }

    /// `y += factor row`.
    #[inline]
    pub fn add_to(&self, factor: f64, y: &mut [f64]) {
        let mut k = 0usize;
        for &(start, len) in &self.spans {
            for (i, yi) in y[start as usize..][..len as usize].iter_mut().enumerate() {
                *yi += factor * self.values[k + i];
            }
            k += len as usize;
        }
    }

    /// `y += factor` times the part of the row that belongs to the first gear.
    #[inline]
    pub fn add_first_to(&self, factor: f64, y: &mut [f64]) {
        let mut k = 0usize;
        for &(start, len) in &self.spans[..self.split.0 as usize] {
            for (i, yi) in y[start as usize..][..len as usize].iter_mut().enumerate() {
                *yi += factor * self.values[k + i];
            }
            k += len as usize;
        }
    }

    /// True when no coordinate takes part.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
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
        assert_eq!(row.dot_first(&x), -20.0);
        let mut y = [0.0; 6];
        row.add_to(0.5, &mut y);
        row.add_first_to(1.0, &mut y);
        assert_eq!(y, [0.0, -3.0, 0.0, 0.0, 1.5, 2.0]);
    }
}
