//! A front, and how it passes on its contribution.

use std::ops::Range;

/// A dense front: `pivots` unknowns are eliminated, `below` unknowns get the contribution.
///
/// ```text
/// [F₁₁ F₁₂]   pivots        F₁₁ = P L₁₁ U₁₁
/// [F₂₁ F₂₂]   below         F₂₂ − L₂₁ U₁₂ goes to the parent
/// ```
pub struct Front {
    /// First unknown eliminated here, in the order of elimination
    pub first: usize,
    /// Number of unknowns eliminated here
    pub pivots: usize,
    /// Nodes below the pivots, as positions in the order of elimination, ascending
    pub rows: Vec<u32>,
    /// Row in the parent's front of the first unknown of each node in `rows`
    pub to_parent: Vec<u32>,
    /// The rows below that stay together in the parent; the first `inner_runs` of them are eliminated there
    pub runs: Vec<Run>,
    /// How many of `runs` are eliminated in the parent
    pub inner_runs: usize,
    /// The fronts whose contributions are added to this one
    pub children: Vec<u32>,
    /// Whether the depth in the tree is odd
    pub odd: bool,
    /// Whether its unknowns are only summed up: those that are kept when all others are eliminated
    pub open: bool,
    /// Where the factors lie: L₁₁ over L₂₁ (all rows × pivots), then U₁₂ transposed (below × pivots), by columns
    pub values: Range<usize>,
    /// The blocks of A that go to the columns of the pivots
    pub lower: Range<usize>,
    /// The blocks of A that go to U₁₂
    pub upper: Range<usize>,
}

impl Front {
    /// Unknowns below the pivots.
    pub fn below(&self) -> usize {
        2 * self.rows.len()
    }

    /// Rows of the front.
    pub fn size(&self) -> usize {
        self.pivots + self.below()
    }

    /// Floating-point operations: LU of the pivots, both panels, the contribution.
    pub fn work(&self) -> f64 {
        if self.open {
            return 0.0;
        }
        let (k, r) = (self.pivots as f64, self.below() as f64);
        2.0 / 3.0 * k * k * k + 2.0 * k * k * r + 2.0 * k * r * r
    }
}

/// Consecutive rows below the pivots of a front that are consecutive in its parent, too.
pub struct Run {
    /// The first of them, counted from the first row below
    pub from: u32,
    /// Its row in the parent
    pub to: u32,
    /// How many they are
    pub length: u32,
}
