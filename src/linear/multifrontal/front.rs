//! A front, and how it passes on its contribution.
//!
//! ```text
//!         root                 the front that is eliminated last
//!        /    \
//!     front   forest           a forest: neighbouring subtrees, which one thread eliminates from the leaves up
//!     /   \                    every front adds its contribution to the equations of its parent
//! forest  forest
//! ```
//!
//! Subtrees of fronts that are shared out among threads.
//!
//! Where contributions wait while a forest is eliminated.

use std::ops::Range;

/// A dense front: `pivots` unknowns are eliminated, `below` unknowns get the contribution.
///
/// ```text
/// [F₁₁ F₁₂]   pivots        F₁₁ = P L₁₁ U₁₁                        symmetric: P L₁₁ D L₁₁ᵀ Pᵀ
/// [F₂₁ F₂₂]   below         F₂₂ − L₂₁ U₁₂ goes to the parent       F₂₂ − L₂₁ D L₂₁ᵀ, of which the lower half
/// ```
pub struct Front {
    /// First unknown eliminated here, in the order of elimination
    pub first: usize,
    /// Number of unknowns eliminated here
    pub pivots: usize,
    /// Nodes below the pivots, as positions in the order of elimination, ascending
    pub rows: Vec<u32>,
    /// Number of their unknowns
    pub below: usize,
    /// The rows below that stay together in the parent; the first `inner_runs` of them are eliminated there
    pub runs: Vec<Run>,
    /// Number of `runs` that are eliminated in the parent
    pub inner_runs: usize,
    /// The fronts whose contributions are added to this one
    pub children: Vec<u32>,
    /// Whether its values and those that its children pass on are symmetric
    pub symmetric: bool,
    /// Whether it is symmetric and passes on both halves of a symmetric contribution, because its parent is not
    pub mirrors: bool,
    /// Whether the depth in the tree is odd
    pub odd: bool,
    /// Whether its unknowns are only summed up: those that are kept when all others are eliminated
    pub open: bool,
    /// Where the factors lie: L₁₁ over L₂₁ (all rows × pivots), then U₁₂ transposed (below × pivots) unless it is symmetric, by
    /// columns
    pub values: Range<usize>,
    /// The blocks of A that go to the columns of the pivots
    pub lower: Range<usize>,
    /// The blocks of A that go to U₁₂
    pub upper: Range<usize>,
}

impl Front {
    /// Rows of the front.
    pub fn size(&self) -> usize {
        self.pivots + self.below
    }

    /// Number of values of its factors.
    pub fn length(&self) -> usize {
        self.pivots * if self.symmetric { self.size() } else { self.size() + self.below }
    }

    /// Floating-point operations: LU of the pivots, both panels, the contribution; half of them where it is symmetric.
    pub fn work(&self) -> f64 {
        if self.open {
            return 0.0;
        }
        let (k, r) = (self.pivots as f64, self.below as f64);
        let half = if self.symmetric { 0.5 } else { 1.0 };
        half * (2.0 / 3.0 * k * k * k + 2.0 * k * k * r + 2.0 * k * r * r)
    }
}

/// Consecutive rows below the pivots of a front that are consecutive in its parent, too.
pub struct Run {
    /// The first of them, counted from the first row below
    pub from: u32,
    /// Its row in the parent
    pub to: u32,
    /// Number of positions in the run
    pub length: u32,
}

/// Neighbouring subtrees.
pub struct Forest {
    pub fronts: Range<usize>,
    /// The roots of the subtrees, ascending
    pub roots: Vec<u32>,
    /// The most values that contributions inside hold at a time
    pub room: usize,
}

/// Share of the whole work below which subtrees are lumped together. Fixed, so that the sums do not depend on threads.
const FOREST_SHARE: f64 = 1.0 / 32.0;

/// Returns whole subtrees, neighbours lumped up to a share of the work, from the first front to the last.
pub fn forests(fronts: &[Front]) -> Vec<Forest> {
    let (first, work) = subtrees(fronts);
    let limit = FOREST_SHARE * fronts.iter().map(Front::work).sum::<f64>();
    let mut forests: Vec<Forest> = Vec::new();
    let mut lumped = 0.0;
    let mut end = fronts.len();
    while end > 0 {
        let root = end - 1;
        if work[root] > limit {
            end = root;
            continue;
        }
        match forests.last_mut() {
            Some(forest) if forest.fronts.start == end && lumped + work[root] <= limit => {
                forest.fronts.start = first[root];
                forest.roots.push(root as u32);
                lumped += work[root];
            }
            _ => {
                forests.push(Forest { fronts: first[root]..end, roots: vec![root as u32], room: 0 });
                lumped = work[root];
            }
        }
        end = first[root];
    }
    forests.reverse();
    for forest in &mut forests {
        forest.roots.reverse();
        forest.room = room(&fronts[forest.fronts.clone()], fronts);
    }
    forests
}

/// The most values that the contributions of consecutive fronts hold at a time.
fn room(forest: &[Front], fronts: &[Front]) -> usize {
    let (mut held, mut peak) = (0, 0);
    for front in forest {
        held += front.below.pow(2);
        peak = peak.max(held);
        held -= front.children.iter().map(|&child| fronts[child as usize].below.pow(2)).sum::<usize>();
    }
    peak
}

/// First front of each subtree and the work of it all.
fn subtrees(fronts: &[Front]) -> (Vec<usize>, Vec<f64>) {
    let mut first: Vec<usize> = Vec::with_capacity(fronts.len());
    let mut work: Vec<f64> = Vec::with_capacity(fronts.len());
    for (f, front) in fronts.iter().enumerate() {
        first.push(front.children.first().map_or(f, |&child| first[child as usize]));
        work.push(front.work() + front.children.iter().map(|&child| work[child as usize]).sum::<f64>());
    }
    (first, work)
}

/// Contributions that wait for the next fronts of a forest: those of fronts at an even depth grow from the low end,
/// those at an odd depth from the high end. So a front finds those of its children on top of one stack, and puts its
/// own on the other.
pub struct Stacks {
    pub values: Vec<f64>,
    low: usize,
    high: usize,
}

impl Stacks {
    /// Both empty, at the ends of this room.
    pub fn new(values: Vec<f64>) -> Self {
        Self { low: 0, high: values.len(), values }
    }

    /// Room for a contribution that is at hand, on the stack of the front.
    pub fn push(&mut self, front: &Front) -> &mut [f64] {
        let own = front.below * front.below;
        if front.odd {
            self.high -= own;
            &mut self.values[self.high..][..own]
        } else {
            self.low += own;
            &mut self.values[self.low - own..self.low]
        }
    }

    /// Room for the contribution of a front, and the contributions of its children.
    pub fn next(&mut self, front: &Front, fronts: &[Front]) -> (&mut [f64], &[f64]) {
        let (own, children) = (front.below * front.below, children_values(front, fronts));
        if front.odd {
            let (low, high) = self.values[..self.high].split_at_mut(self.low);
            let room = high.len() - own;
            (&mut high[room..], &low[low.len() - children..])
        } else {
            let (low, high) = self.values.split_at_mut(self.high);
            (&mut low[self.low..][..own], &high[..children])
        }
    }

    /// The front is done: drop the contributions of its children and keep its own.
    pub fn pop(&mut self, front: &Front, fronts: &[Front]) {
        let (own, children) = (front.below * front.below, children_values(front, fronts));
        if front.odd {
            self.high -= own;
            self.low -= children;
        } else {
            self.low += own;
            self.high += children;
        }
    }
}

/// Number of values that the children of a front pass on.
fn children_values(front: &Front, fronts: &[Front]) -> usize {
    front.children.iter().map(|&child| fronts[child as usize].below.pow(2)).sum()
}
