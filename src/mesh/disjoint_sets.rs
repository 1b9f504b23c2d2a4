//! Disjoint sets (union–find): which of a number of things are joined, directly or through others.

use std::collections::BTreeMap;

/// Things by their numbers, each pointing at one that it is joined with; the lowest of a group points at itself.
pub struct DisjointSets(Vec<usize>);

impl DisjointSets {
    /// As many sets of one thing each.
    pub fn new(count: usize) -> Self {
        Self((0..count).collect())
    }

    /// The lowest of the set that one is in.
    pub fn find(&self, of: usize) -> usize {
        let mut at = of;
        while self.0[at] != at {
            at = self.0[at];
        }
        at
    }

    /// Join the sets of two.
    pub fn union(&mut self, a: usize, b: usize) {
        let [low, high] = [self.find(a).min(self.find(b)), self.find(a).max(self.find(b))];
        // The ways from both are short from now on.
        [a, b, high].into_iter().for_each(|of| self.0[of] = low);
    }

    /// The sets, each ascending, in the order of their lowest.
    pub fn sets(self) -> Vec<Vec<usize>> {
        let mut groups: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for of in 0..self.0.len() {
            groups.entry(self.find(of)).or_default().push(of);
        }
        groups.into_values().collect()
    }
}
