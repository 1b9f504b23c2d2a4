//! Slave nodes counted from what they face, where that never changes: contact then acts on their jumps alone.
//!
//! ```text
//! u_s = J_s + Σ N_a u_a        u = T y: J in place of u_s         N_a: weights of the foot, in small sliding
//! r_a ← r_a + N_a r_s          L r: what contact puts on s, and −N_a of it on a, cancels in a
//! L A T y = L b                                                   only where s and a are free: a support's equation stays
//! ```
//!
//! So the nodes of the master need not be among those on which linear bodies are condensed, and a body that contact alone
//! holds is held by its jumps. A node has none where it takes part in more than its own point, moves with another, or is
//! supported while what it faces is not: what contact puts on that would be left over.

use crate::contact::pair::ContactPair;
use crate::contact::small_sliding::SmallPoint;
use crate::linear::{Pattern, SparseMatrix, Steady};
use crate::model::{Model, Step};

/// A slave node, and what it is counted from.
struct Jump {
    slave: usize,
    /// Nodes of the master and N_a, which sum to one; none on a rigid body
    feet: Vec<(usize, f64)>,
    /// What contact adds to its equation along the normal while it is closed: n and α_n ℓ
    steady: Steady,
}

/// The slave nodes that are counted from what they face.
pub(super) struct Jumps {
    jumps: Vec<Jump>,
    /// Number of each node's jump
    numbers: Vec<Option<u32>>,
}

/// Dofs that have an equation of their own in a step, not one of forces: supported ones, and copies.
pub fn fixed(model: &Model, step: &Step) -> Vec<bool> {
    let mut fixed = vec![false; model.dofs()];
    step.supports.iter().for_each(|support| fixed[support.at.dof] = true);
    model.ties.pairs().iter().for_each(|&(copy, _)| fixed[2 * copy..2 * copy + 2].fill(true));
    model.linkage.followers.iter().flat_map(|follower| follower.dofs()).for_each(|(_, dof)| fixed[dof] = true);
    fixed
}

impl Jumps {
    /// Those of a model in all its steps; `together` are the nodes that contacts couple, each point of small sliding by itself.
    pub fn new(model: &Model, together: &[Vec<usize>]) -> Self {
        let mut uses = vec![0; model.mesh.nodes.len()];
        together.iter().flatten().for_each(|&node| uses[node] += 1);
        let mut tied = vec![false; uses.len()];
        model.ties.pairs().iter().for_each(|&(copy, original)| (tied[copy], tied[original]) = (true, true));
        let fixed: Vec<Vec<bool>> = model.steps.iter().map(|step| fixed(model, step)).collect();
        let left_over = |slave: usize, foot: usize| {
            fixed.iter().any(|fixed| (0..2).any(|i| fixed[2 * slave + i] && !fixed[2 * foot + i]))
        };
        let fits = |Jump { slave, feet, .. }: &Jump| {
            let free = uses[*slave] == 1 && !tied[*slave];
            free && feet.iter().all(|&(foot, _)| !tied[foot] && !left_over(*slave, foot))
        };
        let jumps: Vec<Jump> = model.contacts.iter().flat_map(of_pair).filter(fits).collect();
        let mut numbers = vec![None; uses.len()];
        jumps.iter().enumerate().for_each(|(number, jump)| numbers[jump.slave] = Some(number as u32));
        Self { jumps, numbers }
    }

    /// None at all.
    pub fn none(model: &Model) -> Self {
        Self { jumps: Vec::new(), numbers: vec![None; model.mesh.nodes.len()] }
    }

    /// Whether a node is counted from what it faces.
    pub fn has(&self, node: usize) -> bool {
        self.numbers[node].is_some()
    }

    fn feet(&self, node: usize) -> &[(usize, f64)] {
        self.numbers[node].map_or(&[], |number| &self.jumps[number as usize].feet)
    }

    /// What contact adds to the equation of a node's jump along the normal while it is closed, in the equations that are not
    /// `fixed`.
    pub fn steady(&self, node: usize, fixed: &[bool]) -> Option<Steady> {
        let Steady { direction, stiffness } = self.jumps[self.numbers[node]? as usize].steady;
        let share: f64 = (0..2).filter(|i| !fixed[2 * node + i]).map(|i| direction[i].powi(2)).sum();
        Some(Steady { direction, stiffness: share * stiffness })
    }

    /// 1 + Σ N_a²: the residual of all equations is that of a jump times the root of this, if the master's is zero in L r.
    pub fn share(&self, node: usize) -> f64 {
        1.0 + self.feet(node).iter().map(|(_, weight)| weight * weight).sum::<f64>()
    }

    /// J of a node, or u of one that has none.
    pub fn of(&self, node: usize, u: &[f64]) -> [f64; 2] {
        let at = |node: usize| [u[2 * node], u[2 * node + 1]];
        let base = self.base(node, u);
        [0, 1].map(|i| at(node)[i] - base[i])
    }

    /// Σ N_a u_a. The motion of the first node is taken out: a common one leaves no round-off.
    fn base(&self, node: usize, u: &[f64]) -> [f64; 2] {
        let Some((&(first, _), others)) = self.feet(node).split_first() else { return [0.0; 2] };
        [0, 1].map(|i| {
            let common = u[2 * first + i];
            common + others.iter().map(|&(foot, weight)| weight * (u[2 * foot + i] - common)).sum::<f64>()
        })
    }

    /// u from y, in place.
    pub fn resolve(&self, y: &mut [f64]) {
        for &Jump { slave, .. } in &self.jumps {
            let base = self.base(slave, y);
            (0..2).for_each(|i| y[2 * slave + i] += base[i]);
        }
    }

    /// L r, in place.
    pub fn balance(&self, fixed: &[bool], r: &mut [f64]) {
        for Jump { slave, feet, .. } in &self.jumps {
            for &(foot, weight) in feet {
                let free = |i: &usize| !fixed[2 * slave + i] && !fixed[2 * foot + i];
                (0..2).filter(free).for_each(|i| r[2 * foot + i] += weight * r[2 * slave + i]);
            }
        }
    }

    /// Which nodes L A T couples if A has the pattern `plain`, all `kept` ones with each other.
    pub fn pattern(&self, plain: &Pattern, kept: &[usize]) -> Pattern {
        let with_feet = |node: usize| std::iter::once(node).chain(self.feet(node).iter().map(|&(foot, _)| foot));
        let groups = (0..plain.nodes()).flat_map(|column| {
            let coupled = plain.neighbours(column).iter().filter(move |row| **row <= column);
            coupled.map(move |&row| with_feet(row).chain(with_feet(column)).collect::<Vec<_>>())
        });
        let groups: Vec<Vec<usize>> = groups.chain([kept.to_vec()]).collect();
        Pattern::new(plain.nodes(), groups.iter().map(|group| &group[..]))
    }

    /// L A T, added to a matrix that has room for it.
    pub fn matrix(&self, plain: &SparseMatrix, fixed: &[bool], sum: &mut SparseMatrix) {
        let nodes = plain.pattern.nodes();
        let pairs =
            (0..nodes).flat_map(|column| plain.pattern.neighbours(column).iter().map(move |&row| (row, column)));
        for (row, column) in pairs {
            let Some(from) = plain.pattern.block(row, column) else { continue };
            let itself = |node: usize| std::iter::once((node, 1.0)).chain(self.feet(node).iter().copied());
            for (to_column, by_column) in itself(column) {
                for (to_row, by_row) in itself(row) {
                    let to = sum.pattern.block(to_row, to_column).expect("coupled with the feet");
                    let balanced = |i: &usize| to_row == row || !fixed[2 * row + i] && !fixed[2 * to_row + i];
                    for i in (0..2).filter(balanced) {
                        for j in 0..2 {
                            sum.values[to.value(i, j)] += by_row * by_column * plain.values[from.value(i, j)];
                        }
                    }
                }
            }
        }
    }
}

/// The points of a pair whose own position is one node that faces the same for good.
fn of_pair(pair: &ContactPair) -> impl Iterator<Item = Jump> {
    let points = pair.small.iter().flat_map(|small| &small.points).zip(&pair.points);
    points.filter_map(|(point, slave)| match slave.position[..] {
        [(node, _)] => jump(node, point.as_ref()?, pair.alpha_n),
        _ => None,
    })
}

fn jump(slave: usize, point: &SmallPoint, alpha_n: f64) -> Option<Jump> {
    let (mut own, mut feet) = (0.0, Vec::new());
    for (&node, &weight) in point.nodes.iter().zip(&point.weights) {
        if node == slave { own += weight } else { feet.push((node, -weight)) }
    }
    let steady = Steady { direction: point.normal, stiffness: alpha_n * point.length };
    (own == 1.0).then_some(Jump { slave, feet, steady })
}
