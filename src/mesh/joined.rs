//! Connected components (union–find).

use std::collections::BTreeMap;

/// Items by number, each pointing at an item of its component; the lowest of a component points at itself.
pub struct Joined(Vec<usize>);

impl Joined {
    /// Creates `count` items, none of which are joined.
    pub fn new(count: usize) -> Self {
        Self((0..count).collect())
    }

    /// Returns the lowest item of a component.
    pub fn lowest(&self, of: usize) -> usize {
        let mut at = of;
        while self.0[at] != at {
            at = self.0[at];
        }
        at
    }

    /// Joins the components of two items.
    pub fn join(&mut self, a: usize, b: usize) {
        let [low, high] = [self.lowest(a).min(self.lowest(b)), self.lowest(a).max(self.lowest(b))];
        // Shortens the paths of both.
        [a, b, high].into_iter().for_each(|of| self.0[of] = low);
    }

    /// Returns the components, each ascending, in the order of their lowest items.
    pub fn groups(self) -> Vec<Vec<usize>> {
        let mut groups: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for of in 0..self.0.len() {
            groups.entry(self.lowest(of)).or_default().push(of);
        }
        groups.into_values().collect()
    }
}
