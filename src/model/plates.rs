//! Loading plates: whose their reactions are.

use super::Model;

impl Model {
    /// Those of some nodes, ascending, whose reactions along x (0) or y (1) are theirs: that of a plate is with one of its nodes, and
    /// is theirs if the whole plate is.
    pub fn held(&self, nodes: &[usize], component: usize) -> Vec<usize> {
        let linked = self.linkage.plates.iter().filter(|(_, components)| components[component]).map(|(plate, _)| plate);
        let plates: Vec<&Vec<usize>> = self.plates.iter().chain(linked).collect();
        let all = |plate: &Vec<usize>| plate.iter().all(|node| nodes.binary_search(node).is_ok());
        let partly = |node: &usize| plates.iter().any(|plate| plate.binary_search(node).is_ok() && !all(plate));
        nodes.iter().copied().filter(|node| !partly(node)).collect()
    }
}
