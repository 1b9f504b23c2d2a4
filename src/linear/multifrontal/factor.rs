//! The numeric phase: assemble a front, eliminate its pivots, pass the rest on.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::dense::Panel;
use super::forest::Forest;
use super::front::{Front, Run};
use super::jobs::{Job, Waiting, lock};
use super::symbolic::{Entry, Symbolic};

/// L and U of all fronts.
#[derive(Default)]
pub struct Factors {
    /// Values, front after front (see [`Front::values`])
    pub values: Vec<f64>,
    /// Row exchanges, in the order of elimination, counted from the front's first row
    pub exchanges: Vec<u32>,
    /// Pivots that vanished and were replaced
    pub replaced: usize,
    /// Room for the contributions inside a forest, used again
    rooms: Mutex<Vec<Vec<f64>>>,
}

/// The part of the factors that belongs to consecutive fronts.
struct Part<'a> {
    values: &'a mut [f64],
    exchanges: &'a mut [u32],
}

impl<'a> Part<'a> {
    /// Cut off the part of the first `fronts`.
    fn take(&mut self, fronts: &[Front]) -> Part<'a> {
        let values = fronts.iter().map(|front| front.values.len()).sum();
        let pivots = fronts.iter().map(|front| front.pivots).sum();
        Part {
            values: self.values.split_off_mut(..values).unwrap_or_default(),
            exchanges: self.exchanges.split_off_mut(..pivots).unwrap_or_default(),
        }
    }
}

impl Factors {
    /// Give back the room for contributions: these factors stay as they are.
    pub fn forget_rooms(&mut self) {
        self.rooms = Mutex::default();
    }

    /// Factorize the values `a` (scaled to 1) on the pattern of `symbolic`. The storage is used again.
    pub fn compute(&mut self, symbolic: &Symbolic, a: &[f64]) {
        self.values.resize(symbolic.values(), 0.0);
        self.exchanges.resize(2 * symbolic.nodes.len(), 0);
        let mut rest = Part { values: &mut self.values, exchanges: &mut self.exchanges };
        let job = Job::new(symbolic, |fronts| rest.take(fronts));
        let rooms = std::mem::take(&mut self.rooms);
        let numeric = Numeric { symbolic, a, waiting: Waiting::default(), replaced: AtomicUsize::new(0), rooms };
        job.upwards(&|forest, part| numeric.forest(forest, part), &|front, part| numeric.heavy(front, part));
        self.rooms = numeric.rooms;
        self.replaced = numeric.replaced.into_inner();
    }
}

/// A factorization at work.
struct Numeric<'a> {
    symbolic: &'a Symbolic,
    a: &'a [f64],
    /// Contributions by front
    waiting: Waiting,
    replaced: AtomicUsize,
    rooms: Mutex<Vec<Vec<f64>>>,
}

impl Numeric<'_> {
    /// Eliminate light fronts one after another.
    fn forest(&self, forest: &Forest, mut rest: Part) {
        let fronts = &self.symbolic.fronts;
        let mut room = lock(&self.rooms).pop().unwrap_or_default();
        room.resize(room.len().max(forest.room), 0.0);
        let mut stacks = Stacks { low: 0, high: room.len(), values: room };
        for front in &fronts[forest.fronts.clone()] {
            let part = rest.take(std::slice::from_ref(front));
            let (below, mut passed_on) = stacks.next(front, fronts);
            let in_order = |k: usize| if front.odd { k } else { front.children.len() - 1 - k };
            let children: Vec<(&Front, &[f64])> = (0..front.children.len())
                .map(|k| {
                    let child = &fronts[front.children[in_order(k)] as usize];
                    (child, passed_on.split_off(..child.below() * child.below()).unwrap_or_default())
                })
                .collect();
            self.eliminate(front, part, &children, below);
            stacks.pop(front, fronts);
        }
        let (mut low, mut high) = (0, stacks.values.len());
        for &root in &forest.roots {
            let front = &fronts[root as usize];
            let count = front.below() * front.below();
            let values = if front.odd {
                high -= count;
                &stacks.values[high..][..count]
            } else {
                low += count;
                &stacks.values[low - count..low]
            };
            self.waiting.put(root, values.to_vec());
        }
        lock(&self.rooms).push(stacks.values);
    }

    /// Eliminate one heavy front.
    fn heavy(&self, number: u32, part: Part) {
        let fronts = &self.symbolic.fronts;
        let front = &fronts[number as usize];
        let passed_on: Vec<Vec<f64>> = front.children.iter().map(|&child| self.waiting.take(child)).collect();
        let children: Vec<(&Front, &[f64])> = front
            .children
            .iter()
            .zip(&passed_on)
            .map(|(&child, values)| (&fronts[child as usize], &values[..]))
            .collect();
        let mut below = vec![0.0; front.below() * front.below()];
        self.eliminate(front, part, &children, &mut below);
        self.waiting.put(number, below);
    }

    /// Sum up a front, eliminate its pivots, and write what it passes on over `below`.
    fn eliminate(&self, front: &Front, part: Part, children: &[(&Front, &[f64])], below: &mut [f64]) {
        let (lower, upper) = part.values.split_at_mut(front.size() * front.pivots);
        lower.fill(0.0);
        upper.fill(0.0);
        let mut sums = Sums { front, lower, upper };
        sums.add_matrix(&self.symbolic.entries, self.a);
        children.iter().for_each(|(child, values)| sums.add_contribution(child, values));
        let Sums { lower, upper, .. } = sums;
        if front.open {
            return;
        }
        let mut panel = Panel { lower, upper, pivots: front.pivots, below: front.below(), exchanges: part.exchanges };
        let replaced = panel.factorize();
        if replaced > 0 {
            self.replaced.fetch_add(replaced, Ordering::Relaxed);
        }
        if !below.is_empty() {
            panel.contribution(below);
            children.iter().for_each(|(child, values)| add_below(front, below, child, values));
        }
    }
}

/// Contributions that wait for the next fronts of a forest: those of fronts at an even depth grow from the low end,
/// those at an odd depth from the high end. So a front finds those of its children on top of one stack, and puts its
/// own on the other.
struct Stacks {
    values: Vec<f64>,
    low: usize,
    high: usize,
}

impl Stacks {
    /// Room for the contribution of a front, and the contributions of its children.
    fn next(&mut self, front: &Front, fronts: &[Front]) -> (&mut [f64], &[f64]) {
        let (own, children) = (front.below() * front.below(), children_values(front, fronts));
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
    fn pop(&mut self, front: &Front, fronts: &[Front]) {
        let (own, children) = (front.below() * front.below(), children_values(front, fronts));
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
    front.children.iter().map(|&child| fronts[child as usize].below().pow(2)).sum()
}

/// The rows and columns of a front's pivots while they are summed up.
struct Sums<'a> {
    front: &'a Front,
    /// F₁₁ over F₂₁
    lower: &'a mut [f64],
    /// F₁₂ transposed
    upper: &'a mut [f64],
}

impl Sums<'_> {
    fn add_matrix(&mut self, entries: &[Entry], a: &[f64]) {
        let size = self.front.size();
        for &Entry { block, target } in &entries[self.front.lower.clone()] {
            for j in 0..2 {
                let column = &mut self.lower[target as usize + j * size..][..2];
                let values = &a[block.value(0, j)..][..2];
                column[0] += values[0];
                column[1] += values[1];
            }
        }
        let below = self.front.below();
        for &Entry { block, target } in &entries[self.front.upper.clone()] {
            for i in 0..2 {
                let row = &mut self.upper[target as usize + i * below..][..2];
                row[0] += a[block.value(i, 0)];
                row[1] += a[block.value(i, 1)];
            }
        }
    }

    /// Add what a child passes on to the pivots (extend-add).
    fn add_contribution(&mut self, child: &Front, contribution: &[f64]) {
        let (size, pivots, below) = (self.front.size(), self.front.pivots, self.front.below());
        let rows = child.below().max(1);
        let (inner, outer) = child.runs.split_at(child.inner_runs);
        let columns =
            |run: &Run| contribution[run.from as usize * rows..][..run.length as usize * rows].chunks_exact(rows);
        for run in inner {
            for (target, column) in self.lower[run.to as usize * size..].chunks_exact_mut(size).zip(columns(run)) {
                add_rows(target, column, &child.runs, 0);
            }
        }
        for run in outer {
            for (k, column) in columns(run).enumerate() {
                let row = run.to as usize - pivots + k;
                for run in inner {
                    let places = self.upper[run.to as usize * below..].chunks_exact_mut(below);
                    for (place, value) in places.zip(&column[run.from as usize..][..run.length as usize]) {
                        place[row] += value;
                    }
                }
            }
        }
    }
}

/// Add what a child passes on past the pivots.
fn add_below(front: &Front, below: &mut [f64], child: &Front, contribution: &[f64]) {
    let (target_rows, rows) = (front.below(), child.below().max(1));
    let outer = &child.runs[child.inner_runs..];
    for run in outer {
        let columns = contribution[run.from as usize * rows..][..run.length as usize * rows].chunks_exact(rows);
        let targets = below[(run.to as usize - front.pivots) * target_rows..].chunks_exact_mut(target_rows);
        for (target, column) in targets.zip(columns) {
            add_rows(target, column, outer, front.pivots);
        }
    }
}

/// Add the runs of a column at their places; `offset` is the place of the first target.
fn add_rows(target: &mut [f64], column: &[f64], runs: &[Run], offset: usize) {
    for run in runs {
        let length = run.length as usize;
        let target = &mut target[run.to as usize - offset..][..length];
        for (target, value) in target.iter_mut().zip(&column[run.from as usize..][..length]) {
            *target += value;
        }
    }
}
