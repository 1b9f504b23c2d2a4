//! Nodes whose displacements follow from others (master–slave constraints): platens with one equal component, and platens
//! that move as a rigid body.
//!
//! ```text
//! u_c = Σ G_k u_k                                           c follows the leaders k
//! one component i equal     (u_c)_i = (u_1)_i
//! rigid                     x_c = x_A + α e + β J e,   e = x_B − x_A,   |e| = L            J: turned by 90°
//! ```
//!
//! α and β follow from the initial positions, so that a rigid platen is linear in the displacements of two of its nodes, except
//! for the constraint of their distance. Forces on c are transferred to its leaders by Gᵀ, which preserves work.
//!
//! The assignment of reactions to platens is also defined here.

use nalgebra::{Matrix2, Vector2};

use super::Model;

/// A node that follows others.
#[derive(Clone, Debug, PartialEq)]
pub struct Follower {
    /// the node c
    pub node: usize,
    /// which of its components follow
    pub components: [bool; 2],
    /// the leaders and their G
    pub leaders: Vec<(usize, Matrix2<f64>)>,
}

/// All constraints between nodes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Linkage {
    /// ascending by node; a node whose components follow different nodes occurs twice
    pub followers: Vec<Follower>,
    /// A and B of each rigid plate
    pub rigid: Vec<[usize; 2]>,
    /// G of the center of mass of each, x_C = x_A + G e; that of A for a platen without mass
    pub centers: Vec<Matrix2<f64>>,
    /// nodes of each platen, ascending, and the components that move with it
    pub plates: Vec<(Vec<usize>, [bool; 2])>,
}

impl Follower {
    /// Value of component i from its leaders.
    pub fn value(&self, i: usize, values: &[f64]) -> f64 {
        self.value_by(i, |dof| values[dof])
    }

    /// Value of a following dof from those of its leaders.
    pub fn value_by(&self, i: usize, value: impl Fn(usize) -> f64) -> f64 {
        self.leaders.iter().map(|(node, g)| g[(i, 0)] * value(2 * node) + g[(i, 1)] * value(2 * node + 1)).sum()
    }

    /// Returns the dofs of the node that are linked, with their component.
    pub fn dofs(&self) -> impl Iterator<Item = (usize, usize)> + use<'_> {
        (0..2).filter(|&i| self.components[i]).map(|i| (i, 2 * self.node + i))
    }
}

impl Linkage {
    /// Whether there are no followers.
    pub fn is_empty(&self) -> bool {
        self.followers.is_empty()
    }

    /// Adds the forces of followers to their leaders, by Gᵀ, and sets them to zero.
    pub fn gather(&self, values: &mut [f64]) {
        self.move_by(values, |g| g);
    }

    /// [`Linkage::gather`] for magnitudes, which do not cancel.
    pub fn gather_magnitudes(&self, values: &mut [f64]) {
        self.move_by(values, f64::abs);
    }

    fn move_by(&self, values: &mut [f64], share: impl Fn(f64) -> f64) {
        for follower in &self.followers {
            for (i, dof) in follower.dofs() {
                let own = std::mem::take(&mut values[dof]);
                for (leader, g) in &follower.leaders {
                    (0..2).for_each(|j| values[2 * leader + j] += share(g[(i, j)]) * own);
                }
            }
        }
    }

    /// Followers of rigid platens.
    pub fn turning(&self) -> impl Iterator<Item = &Follower> {
        self.followers.iter().filter(|follower| follower.leaders.len() == 2)
    }

    /// Sets the values of followers from their leaders.
    pub fn spread(&self, values: &mut [f64]) {
        for follower in &self.followers {
            for (i, dof) in follower.dofs() {
                values[dof] = follower.value(i, values);
            }
        }
    }

    /// The dof that a dof follows alone: itself unless it is a follower.
    pub fn leading(&self, dof: usize) -> usize {
        let first = self.followers.partition_point(|follower| follower.node < dof / 2);
        let own = self.followers[first..].iter().take_while(|follower| follower.node == dof / 2);
        match own.into_iter().find(|follower| follower.components[dof % 2]) {
            Some(Follower { leaders, .. }) if leaders.len() == 1 => 2 * leaders[0].0 + dof % 2,
            _ => dof,
        }
    }

    /// All followers and leaders, ascending.
    pub fn nodes(&self) -> Vec<usize> {
        let followers = self.followers.iter();
        let mut nodes: Vec<usize> =
            followers.flat_map(|f| f.leaders.iter().map(|(leader, _)| *leader).chain([f.node])).collect();
        nodes.extend(self.rigid.iter().flatten());
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }
}

/// Followers of a platen with one equal component; its first node is the leader.
pub fn alike(nodes: &[usize], component: usize) -> Vec<Follower> {
    let Some((&first, others)) = nodes.split_first() else { return Vec::new() };
    let components = [component == 0, component == 1];
    let mut g = Matrix2::zeros();
    g[(component, component)] = 1.0;
    others.iter().map(|&node| Follower { node, components, leaders: vec![(first, g)] }).collect()
}

/// Followers of a rigid platen with the leaders A and B.
pub fn rigid(nodes: &[usize], [a, b]: [usize; 2], place: impl Fn(usize) -> Vector2<f64>) -> Vec<Follower> {
    let e = place(b) - place(a);
    let follower = |&node: &usize| {
        let arm = place(node) - place(a);
        let (along, across) = (arm.dot(&e) / e.norm_squared(), e.perp(&arm) / e.norm_squared());
        let of_b = Matrix2::new(along, -across, across, along);
        Follower { node, components: [true; 2], leaders: vec![(a, Matrix2::identity() - of_b), (b, of_b)] }
    };
    nodes.iter().filter(|node| **node != a && **node != b).map(follower).collect()
}

#[doc(hidden)]
impl Model {
    /// The given nodes (sorted) whose reactions along x (0) or y (1) belong to them; the reaction of a platen is included
    /// only if all of its nodes are given.
    pub fn constrained(&self, nodes: &[usize], component: usize) -> Vec<usize> {
        let linked = self.linkage.plates.iter().filter(|(_, components)| components[component]).map(|(plate, _)| plate);
        let plates: Vec<&Vec<usize>> = self.plates.iter().chain(linked).collect();
        let all = |plate: &Vec<usize>| plate.iter().all(|node| nodes.binary_search(node).is_ok());
        let partly = |node: &usize| plates.iter().any(|plate| plate.binary_search(node).is_ok() && !all(plate));
        nodes.iter().copied().filter(|node| !partly(node)).collect()
    }
}
