//! The numeric phase: assemble a front, eliminate its pivots, pass the rest on.

use std::ops::Range;

use rayon::prelude::*;

use super::dense::Panel;
use super::symbolic::{Entry, Front, Symbolic};

/// L and U of all fronts.
#[derive(Default)]
pub struct Factors {
    /// Values, front after front (see [`Front::values`])
    pub values: Vec<f64>,
    /// Row exchanges, in the order of elimination, counted from the front's first row
    pub exchanges: Vec<u32>,
    /// Pivots that vanished and were replaced
    pub replaced: usize,
}

/// Contributions that wait for the parents of their fronts, the last child on top, and the pivots replaced on the way.
#[derive(Default)]
struct Stack {
    contributions: Vec<Vec<f64>>,
    replaced: usize,
}

/// The values of the factors that belong to consecutive fronts.
struct Storage<'a> {
    values: &'a mut [f64],
    exchanges: &'a mut [u32],
}

impl<'a> Storage<'a> {
    /// Cut off the part of the first `fronts`.
    fn take(&mut self, fronts: &[Front]) -> Storage<'a> {
        let values = fronts.iter().map(|front| front.values.len()).sum();
        let pivots = fronts.iter().map(|front| front.pivots).sum();
        let (values, rest) = std::mem::take(&mut self.values).split_at_mut(values);
        self.values = rest;
        let (exchanges, rest) = std::mem::take(&mut self.exchanges).split_at_mut(pivots);
        self.exchanges = rest;
        Storage { values, exchanges }
    }
}

impl Factors {
    /// Factorize the values `a` (scaled to 1) on the pattern of `symbolic`. The storage is used again.
    pub fn compute(&mut self, symbolic: &Symbolic, a: &[f64]) {
        self.values.resize(symbolic.values(), 0.0);
        self.exchanges.resize(2 * symbolic.nodes.len(), 0);
        let mut rest = Storage { values: &mut self.values, exchanges: &mut self.exchanges };
        let (mut light, mut heavy) = (Vec::new(), Vec::new());
        let mut done = 0;
        for forest in &symbolic.forests {
            heavy.push((done..forest.start, rest.take(&symbolic.fronts[done..forest.start])));
            light.push((forest.clone(), rest.take(&symbolic.fronts[forest.clone()])));
            done = forest.end;
        }
        let run = |(range, storage): (Range<usize>, Storage)| {
            let mut stack = Stack::default();
            stack.eliminate(symbolic, a, range, storage);
            stack
        };
        let forests: Vec<Stack> = light.into_par_iter().with_max_len(1).map(run).collect();
        let mut stack = Stack::default();
        for ((range, storage), forest) in heavy.into_iter().zip(forests) {
            stack.eliminate(symbolic, a, range, storage);
            stack.contributions.extend(forest.contributions);
            stack.replaced += forest.replaced;
        }
        stack.eliminate(symbolic, a, done..symbolic.fronts.len(), rest);
        self.replaced = stack.replaced;
    }
}

impl Stack {
    /// Eliminate consecutive fronts, one after another.
    fn eliminate(&mut self, symbolic: &Symbolic, a: &[f64], range: Range<usize>, mut storage: Storage<'_>) {
        for front in &symbolic.fronts[range] {
            let part = storage.take(std::slice::from_ref(front));
            let (panel, upper) = part.values.split_at_mut(front.size() * front.pivots);
            let mut sums = Assembly { front, panel, upper, below: vec![0.0; front.below() * front.below()] };
            sums.clear();
            sums.add_matrix(&symbolic.entries, a);
            let own = self.contributions.len() - front.children.len();
            for (&child, contribution) in front.children.iter().zip(self.contributions.drain(own..)) {
                sums.add_contribution(&symbolic.fronts[child as usize], &contribution);
            }
            let Assembly { panel, upper, mut below, .. } = sums;
            let (size, pivots) = (front.size(), front.pivots);
            let mut panel = Panel { values: panel, size, pivots, exchanges: part.exchanges };
            self.replaced += panel.factorize();
            if !front.rows.is_empty() {
                panel.solve_upper(upper);
                panel.subtract_contribution(upper, &mut below);
                self.contributions.push(below);
            }
        }
    }
}

/// A front while it is summed up.
struct Assembly<'a> {
    front: &'a Front,
    /// F₁₁ over F₂₁
    panel: &'a mut [f64],
    /// F₁₂
    upper: &'a mut [f64],
    /// F₂₂
    below: Vec<f64>,
}

impl Assembly<'_> {
    fn clear(&mut self) {
        self.panel.fill(0.0);
        self.upper.fill(0.0);
    }

    fn add_matrix(&mut self, entries: &[Entry], a: &[f64]) {
        let Self { front, panel, upper, .. } = self;
        add_blocks(panel, front.size(), &entries[front.lower.clone()], a);
        add_blocks(upper, front.pivots, &entries[front.upper.clone()], a);
    }

    /// Add what a child passes on (extend-add).
    fn add_contribution(&mut self, child: &Front, contribution: &[f64]) {
        let (size, pivots, below) = (self.front.size(), self.front.pivots, self.front.below());
        let eliminated = child.to_parent.partition_point(|&place| (place as usize) < pivots);
        let (above, under) = child.to_parent.split_at(eliminated);
        let columns = contribution.chunks_exact(child.below().max(1));
        for (k, column) in columns.enumerate() {
            let target = child.to_parent[k / 2] as usize + k % 2;
            if target < pivots {
                add_rows(&mut self.panel[target * size..][..size], column, &child.to_parent, 0);
            } else {
                let (upper, lower) = column.split_at(2 * eliminated);
                add_rows(&mut self.upper[(target - pivots) * pivots..][..pivots], upper, above, 0);
                add_rows(&mut self.below[(target - pivots) * below..][..below], lower, under, pivots);
            }
        }
    }
}

fn add_blocks(panel: &mut [f64], rows: usize, entries: &[Entry], a: &[f64]) {
    for &Entry { block, target } in entries {
        for j in 0..2 {
            let column = &mut panel[target as usize + j * rows..][..2];
            let values = &a[block.value(0, j)..][..2];
            column[0] += values[0];
            column[1] += values[1];
        }
    }
}

/// Add pairs of values at their places; `offset` is the place of the first target.
fn add_rows(target: &mut [f64], values: &[f64], places: &[u32], offset: usize) {
    for (pair, &place) in values.chunks_exact(2).zip(places) {
        let target = &mut target[place as usize - offset..][..2];
        target[0] += pair[0];
        target[1] += pair[1];
    }
}
