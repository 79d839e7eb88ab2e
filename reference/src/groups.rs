//! Numbers in groups that grow together.

/// Partition of the numbers below a count into groups, initially of one number each (union and find with path
/// halving).
#[derive(Clone, Debug)]
pub(crate) struct Groups(Vec<u32>);

impl Groups {
    /// Creates `n` groups of one number each.
    pub(crate) fn new(n: usize) -> Self {
        Groups((0..n as u32).collect())
    }

    /// Returns the representative of the group of a number: its smallest member.
    pub(crate) fn find(&mut self, mut i: u32) -> u32 {
        while self.0[i as usize] != i {
            self.0[i as usize] = self.0[self.0[i as usize] as usize];
            i = self.0[i as usize];
        }
        i
    }

    /// Joins two groups; the smaller number leads.
    pub(crate) fn join(&mut self, i: u32, j: u32) {
        let (i, j) = (self.find(i), self.find(j));
        self.0[i.max(j) as usize] = i.min(j);
    }
}
