//! Which of a number of things are joined, directly or through others.

use std::collections::BTreeMap;

/// Things by their numbers, each pointing at one that it is joined with; the lowest of a group points at itself.
pub struct Joined(Vec<usize>);

impl Joined {
    /// So many things, of which none are joined.
    pub fn new(count: usize) -> Self {
        Self((0..count).collect())
    }

    /// The lowest of those joined with one.
    pub fn lowest(&self, of: usize) -> usize {
        let mut at = of;
        while self.0[at] != at {
            at = self.0[at];
        }
        at
    }

    /// Join two, and all that are joined with them.
    pub fn join(&mut self, a: usize, b: usize) {
        let [low, high] = [self.lowest(a).min(self.lowest(b)), self.lowest(a).max(self.lowest(b))];
        // The ways from both are short from now on.
        [a, b, high].into_iter().for_each(|of| self.0[of] = low);
    }

    /// Groups of those joined, each ascending, in the order of their lowest.
    pub fn groups(self) -> Vec<Vec<usize>> {
        let mut groups: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for of in 0..self.0.len() {
            groups.entry(self.lowest(of)).or_default().push(of);
        }
        groups.into_values().collect()
    }
}
