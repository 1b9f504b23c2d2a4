//! The numeric phase: assemble a front, eliminate its pivots, pass the rest on.
//!
//! What can be done at the same time: forests of light fronts, and chains of heavy ones above them.
//!
//! # Reuse
//!
//! Which fronts of an earlier factorization stay: those whose values have not changed, nor those of any front below.
//!
//! Only what passes from a front that stays to one that does not must be at hand again; it is kept from the second
//! factorization on in which it is wanted. A front that is eliminated anew has the same values and children as in a
//! factorization from scratch, and so the same bits.

use std::collections::HashMap;
use std::ops::Range;
use std::sync::{Mutex, MutexGuard, PoisonError};

use rayon::prelude::*;

use super::super::SparseMatrix;
use super::dense::Panel;
use super::front::{Forest, Front, Run, Stacks};
use super::scale::Scaling;
use super::symbolic::{Entry, Symbolic};
use super::symmetric::{Found, SymmetricPanel, mirror};

/// Fronts whose values one thread takes at a time.
const FEW_FRONTS: usize = 256;

/// L and U of all fronts.
#[derive(Default)]
pub struct Factors {
    /// Values, front after front (see [`Front::values`])
    pub values: Vec<f64>,
    /// Row exchanges, in the order of elimination, counted from the front's first row
    pub exchanges: Vec<u32>,
    /// Pivots that vanished and were replaced, and negative ones of symmetric fronts, front by front
    found: Vec<Found>,
    /// Fronts that the last factorization eliminated
    pub eliminated: usize,
    /// The scaled values that were factorized, four an entry
    a: Vec<f64>,
    /// Contributions of fronts that stay to those that do not, by the number of the front
    kept: HashMap<u32, Vec<f64>>,
    /// Room for the contributions inside a forest, used again
    rooms: Mutex<Vec<Vec<f64>>>,
}

/// The part of the factors that belongs to consecutive fronts.
struct FrontBlock<'a> {
    values: &'a mut [f64],
    exchanges: &'a mut [u32],
    found: &'a mut [Found],
}

impl<'a> FrontBlock<'a> {
    /// Cut off the part of the first `fronts`.
    fn take(&mut self, fronts: &[Front]) -> FrontBlock<'a> {
        let values = fronts.iter().map(|front| front.values.len()).sum();
        let pivots = fronts.iter().map(|front| front.pivots).sum();
        FrontBlock {
            values: self.values.split_off_mut(..values).unwrap_or_default(),
            exchanges: self.exchanges.split_off_mut(..pivots).unwrap_or_default(),
            found: self.found.split_off_mut(..fronts.len()).unwrap_or_default(),
        }
    }
}

impl Factors {
    /// Forget all that serves the next factorization: these factors stay as they are, or the next are of another pattern.
    pub fn settle(&mut self) {
        (self.a, self.kept, self.rooms) = (Vec::new(), HashMap::new(), Mutex::default());
    }

    /// Room for the factors.
    pub fn reserve(&mut self, symbolic: &Symbolic) -> Result<(), std::collections::TryReserveError> {
        self.values.try_reserve_exact(symbolic.values().saturating_sub(self.values.len()))
    }

    /// Number of pivots that vanished and were replaced.
    pub fn replaced(&self) -> usize {
        self.found.iter().map(|found| found.replaced).sum()
    }

    /// Number of negative eigenvalues of D.
    pub fn negative(&self) -> usize {
        self.found.iter().map(|found| found.negative).sum()
    }

    /// Whether the determinant of the part that was factorized as L U is negative: that of what symmetric fronts leave.
    pub fn is_odd(&self) -> bool {
        self.found.iter().fold(false, |odd, found| odd != found.odd)
    }

    /// Factorize a matrix, scaled to 1, on the pattern of `symbolic`, which is that of the last one unless it was settled. The
    /// storage is used again, and so are fronts whose values have not changed.
    pub fn compute(&mut self, symbolic: &Symbolic, matrix: &SparseMatrix, scaling: &Scaling) {
        let changed = self.gather(symbolic, matrix, scaling);
        let actions = actions(symbolic, &changed, &self.kept);
        self.values.resize(symbolic.values(), 0.0);
        self.exchanges.resize(symbolic.dofs.len(), 0);
        self.found.resize(symbolic.fronts.len(), Found::default());
        let Self { values, exchanges, found, a, .. } = self;
        let mut rest = FrontBlock { values, exchanges, found };
        let job = Job::new(symbolic, |fronts| rest.take(fronts));
        let rooms = std::mem::take(&mut self.rooms);
        let (waiting, new) = (Waiting::default(), Waiting::default());
        let numeric = Numeric { symbolic, a, actions: &actions, kept: &self.kept, new, waiting, rooms };
        job.upwards(&|forest, part| numeric.forest(forest, part), &|front, part| numeric.heavy(front, part));
        let Numeric { new, rooms, .. } = numeric;
        self.rooms = rooms;
        self.eliminated = actions.iter().filter(|action| action.eliminates()).count();
        self.kept.retain(|&front, _| !actions[front as usize].eliminates());
        self.kept.extend(new.into_inner());
    }

    /// Take the scaled values of a matrix; whether those of each front are others than before.
    fn gather(&mut self, symbolic: &Symbolic, matrix: &SparseMatrix, scaling: &Scaling) -> Vec<bool> {
        let anew = self.a.len() != 4 * symbolic.entries.len();
        self.a.resize(4 * symbolic.entries.len(), 0.0);
        let mut rest = &mut self.a[..];
        let own = |front: &Front| {
            let entries = &symbolic.entries[front.lower.start..front.upper.end];
            (entries, rest.split_off_mut(..4 * entries.len()).unwrap_or_default())
        };
        let fronts: Vec<(&[Entry], &mut [f64])> = symbolic.fronts.iter().map(own).collect();
        let fronts = fronts.into_par_iter().with_min_len(FEW_FRONTS);
        fronts.map(|(entries, values)| take_values(entries, values, matrix, scaling) || anew).collect()
    }
}

/// Write the scaled values of some entries over others; whether they differ.
fn take_values(entries: &[Entry], values: &mut [f64], matrix: &SparseMatrix, scaling: &Scaling) -> bool {
    let mut differ = false;
    for (&Entry { block, row, column, unknowns, .. }, values) in entries.iter().zip(values.as_chunks_mut::<4>().0) {
        let [rows, columns] = [(&scaling.rows, row), (&scaling.columns, column)]
            .map(|(scales, node)| [0, 1].map(|i| scales[2 * node as usize + i]));
        let mut new = [0.0; 4];
        let pairs = new.as_chunks_mut::<2>().0.iter_mut().zip(columns).take(unknowns[1] as usize);
        for (j, (pair, scale)) in pairs.enumerate() {
            let column = &matrix.values[block.value(0, j)..][..2];
            *pair = [column[0] * rows[0] * scale, column[1] * rows[1] * scale];
        }
        if row == column {
            // What is constrained is solved by itself.
            (0..2).filter(|&i| rows[i] == 0.0).for_each(|i| new[3 * i] = 1.0);
        }
        differ |= new.map(f64::to_bits) != values.map(f64::to_bits);
        *values = new;
    }
    differ
}

/// A factorization at work.
struct Numeric<'a> {
    symbolic: &'a Symbolic,
    a: &'a [f64],
    actions: &'a [Action],
    kept: &'a HashMap<u32, Vec<f64>>,
    /// Contributions to keep
    new: Waiting,
    /// Contributions by front
    waiting: Waiting,
    rooms: Mutex<Vec<Vec<f64>>>,
}

impl Numeric<'_> {
    /// Eliminate light fronts one after another.
    fn forest(&self, forest: &Forest, mut rest: FrontBlock) {
        let fronts = &self.symbolic.fronts;
        let mut room = lock(&self.rooms).pop().unwrap_or_default();
        if room.len() < forest.room {
            // Pages that nothing is written to take no memory.
            room = vec![0.0; forest.room];
        }
        let (mut stacks, mut weighted) = (Stacks::new(room), Vec::new());
        for (number, front) in forest.fronts.clone().map(|number| (number, &fronts[number])) {
            let part = rest.take(std::slice::from_ref(front));
            match self.actions[number] {
                Action::Rest => continue,
                Action::PassOn => {
                    stacks.push(front).copy_from_slice(&self.kept[&(number as u32)]);
                    continue;
                }
                _ => {}
            }
            let (below, mut passed_on) = stacks.next(front, fronts);
            let in_order = |k: usize| if front.odd { k } else { front.children.len() - 1 - k };
            let children: Vec<(&Front, &[f64])> = (0..front.children.len())
                .map(|k| {
                    let child = &fronts[front.children[in_order(k)] as usize];
                    (child, passed_on.split_off(..child.below * child.below).unwrap_or_default())
                })
                .collect();
            self.eliminate(front, part, &children, below, &mut weighted);
            self.keep(number, below);
            stacks.pop(front, fronts);
        }
        let (mut low, mut high) = (0, stacks.values.len());
        for &root in forest.roots.iter().filter(|&&root| self.actions[root as usize] != Action::Rest) {
            let front = &fronts[root as usize];
            let count = front.below * front.below;
            let values = if front.odd {
                high -= count;
                &stacks.values[high..][..count]
            } else {
                low += count;
                &stacks.values[low - count..low]
            };
            self.waiting.put(root, copied(front, values));
        }
        lock(&self.rooms).push(stacks.values);
    }

    /// Eliminate one heavy front.
    fn heavy(&self, number: u32, part: FrontBlock) {
        let fronts = &self.symbolic.fronts;
        let front = &fronts[number as usize];
        match self.actions[number as usize] {
            Action::Rest => return,
            Action::PassOn => return self.waiting.put(number, self.kept[&number].clone()),
            _ => {}
        }
        let passed_on: Vec<Vec<f64>> = front.children.iter().map(|&child| self.waiting.take(child)).collect();
        let children: Vec<(&Front, &[f64])> = front
            .children
            .iter()
            .zip(&passed_on)
            .map(|(&child, values)| (&fronts[child as usize], &values[..]))
            .collect();
        let mut below = vec![0.0; front.below * front.below];
        self.eliminate(front, part, &children, &mut below, &mut Vec::new());
        self.keep(number as usize, &below);
        self.waiting.put(number, below);
    }

    /// Keep what an eliminated front passes on, if it is to stay.
    fn keep(&self, number: usize, below: &[f64]) {
        if self.actions[number] == Action::EliminateAndKeep {
            self.new.put(number as u32, below.to_vec());
        }
    }

    /// Sum up a front, eliminate its pivots, and write what it passes on over `below`.
    fn eliminate(
        &self,
        front: &Front,
        part: FrontBlock,
        children: &[(&Front, &[f64])],
        below: &mut [f64],
        room: &mut Vec<f64>,
    ) {
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
        let (pivots, exchanges) = (front.pivots, part.exchanges);
        if front.symmetric {
            let mut panel = SymmetricPanel { lower, pivots, below: front.below, exchanges, room };
            part.found[0] = panel.factorize();
            if !below.is_empty() {
                panel.contribution(below);
            }
        } else {
            let mut panel = Panel { lower, upper, pivots, below: front.below, exchanges };
            part.found[0] = Found { replaced: panel.factorize(), negative: 0, odd: panel.is_odd() };
            if !below.is_empty() {
                panel.contribution(below);
            }
        }
        if !below.is_empty() {
            children.iter().for_each(|(child, values)| add_below(front, below, child, values));
        }
        if front.mirrors {
            mirror(below, front.below);
        }
    }
}

/// The rows and columns of a front's pivots while they are summed up.
struct Sums<'a> {
    front: &'a Front,
    /// F₁₁ over F₂₁
    lower: &'a mut [f64],
    /// F₁₂ transposed; nothing in a symmetric front
    upper: &'a mut [f64],
}

impl Sums<'_> {
    /// Add the values of A, which stand there in the order of the entries.
    fn add_matrix(&mut self, entries: &[Entry], a: &[f64]) {
        let size = self.front.size();
        let own = |range: &Range<usize>| entries[range.clone()].iter().zip(a.as_chunks::<4>().0[range.clone()].iter());
        for (entry, values) in own(&self.front.lower) {
            let [rows, columns] = entry.unknowns.map(usize::from);
            for (j, values) in values.as_chunks::<2>().0[..columns].iter().enumerate() {
                let column = &mut self.lower[entry.target as usize + j * size..][..rows];
                column.iter_mut().zip(values).for_each(|(own, value)| *own += value);
            }
        }
        let below = self.front.below;
        for (entry, values) in own(&self.front.upper) {
            let [rows, columns] = entry.unknowns.map(usize::from);
            for i in 0..rows {
                let row = &mut self.upper[entry.target as usize + i * below..][..columns];
                row.iter_mut().zip(values.as_chunks::<2>().0).for_each(|(own, column)| *own += column[i]);
            }
        }
    }

    /// Add what a child passes on to the pivots (extend-add).
    fn add_contribution(&mut self, child: &Front, contribution: &[f64]) {
        let (size, pivots, below) = (self.front.size(), self.front.pivots, self.front.below);
        let rows = child.below.max(1);
        let (inner, outer) = child.runs.split_at(child.inner_runs);
        let columns =
            |run: &Run| contribution[run.from as usize * rows..][..run.length as usize * rows].chunks_exact(rows);
        for (number, run) in inner.iter().enumerate() {
            let targets = self.lower[run.to as usize * size..].chunks_exact_mut(size);
            for (k, (target, column)) in targets.zip(columns(run)).enumerate() {
                if self.front.symmetric {
                    add_lower(target, column, &child.runs[number..], k, 0);
                } else {
                    add_rows(target, column, &child.runs, 0);
                }
            }
        }
        for run in outer.iter().filter(|_| !self.front.symmetric) {
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

/// A copy of what a front passes on: the lower half of it where that is all. Pages of the other half take no memory.
fn copied(front: &Front, values: &[f64]) -> Vec<f64> {
    if front.mirrors || !front.symmetric {
        return values.to_vec();
    }
    let rows = front.below.max(1);
    let mut lower = vec![0.0; values.len()];
    for (k, (column, from)) in lower.chunks_exact_mut(rows).zip(values.chunks_exact(rows)).enumerate() {
        column[k..].copy_from_slice(&from[k..]);
    }
    lower
}

/// Add what a child passes on past the pivots.
fn add_below(front: &Front, below: &mut [f64], child: &Front, contribution: &[f64]) {
    let (target_rows, rows) = (front.below, child.below.max(1));
    let outer = &child.runs[child.inner_runs..];
    for (number, run) in outer.iter().enumerate() {
        let columns = contribution[run.from as usize * rows..][..run.length as usize * rows].chunks_exact(rows);
        let targets = below[(run.to as usize - front.pivots) * target_rows..].chunks_exact_mut(target_rows);
        for (k, (target, column)) in targets.zip(columns).enumerate() {
            if front.symmetric {
                add_lower(target, column, &outer[number..], k, front.pivots);
            } else {
                add_rows(target, column, outer, front.pivots);
            }
        }
    }
}

/// Add column `k` of the first run from the diagonal on.
fn add_lower(target: &mut [f64], column: &[f64], runs: &[Run], k: usize, offset: usize) {
    let Some((first, others)) = runs.split_first() else { return };
    let (from, to, length) = (first.from as usize, first.to as usize - offset, first.length as usize);
    let rows = target[to + k..to + length].iter_mut().zip(&column[from + k..from + length]);
    rows.for_each(|(target, value)| *target += value);
    add_rows(target, column, others, offset);
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

/// A chain of heavy fronts and all that lies below it; `P` is what each forest or heavy front owns of the data.
pub struct Job<'a, P> {
    /// Independent of each other
    below: Vec<Job<'a, P>>,
    forests: Vec<(&'a Forest, P)>,
    /// Each front the only heavy child of the next
    chain: Vec<(u32, P)>,
}

impl<'a, P: Send> Job<'a, P> {
    /// The whole tree. `part` is called with the forests and heavy fronts in the order of elimination.
    pub fn new(symbolic: &'a Symbolic, mut part: impl FnMut(&[Front]) -> P) -> Self {
        let mut jobs: HashMap<u32, Self> = HashMap::new();
        let mut forests = Vec::new();
        let mut next = 0;
        let ends = symbolic.forests.iter().map(Some).chain([None]);
        for forest in ends {
            let end = forest.map_or(symbolic.fronts.len(), |forest| forest.fronts.start);
            for number in next..end {
                let front = &symbolic.fronts[number];
                let mut below: Vec<Self> = front.children.iter().filter_map(|child| jobs.remove(child)).collect();
                let mut job = match below.len() {
                    1 => below.remove(0),
                    _ => Self { below, forests: Vec::new(), chain: Vec::new() },
                };
                job.forests.append(&mut forests);
                job.chain.push((number as u32, part(std::slice::from_ref(front))));
                jobs.insert(number as u32, job);
            }
            if let Some(forest) = forest {
                forests.push((forest, part(&symbolic.fronts[forest.fronts.clone()])));
                next = forest.fronts.end;
            }
        }
        Self { below: jobs.into_values().collect(), forests, chain: Vec::new() }
    }

    /// Visit the tree with children before parents.
    pub fn upwards(self, light: &(impl Fn(&Forest, P) + Sync), heavy: &(impl Fn(u32, P) + Sync)) {
        let Self { below, forests, chain } = self;
        Self::at_once(below, forests, &|job| job.upwards(light, heavy), light);
        chain.into_iter().for_each(|(front, part)| heavy(front, part));
    }

    /// Visit the tree with parents before children.
    pub fn downwards(self, light: &(impl Fn(&Forest, P) + Sync), heavy: &(impl Fn(u32, P) + Sync)) {
        let Self { below, forests, chain } = self;
        chain.into_iter().rev().for_each(|(front, part)| heavy(front, part));
        Self::at_once(below, forests, &|job| job.downwards(light, heavy), light);
    }

    /// All that does not depend on each other. What is alone is done without the wait for another thread to wake up.
    fn at_once(
        below: Vec<Self>,
        forests: Vec<(&'a Forest, P)>,
        go: &(impl Fn(Self) + Sync),
        light: &(impl Fn(&Forest, P) + Sync),
    ) {
        if below.len() + forests.len() <= 1 {
            below.into_iter().for_each(go);
            return forests.into_iter().for_each(|(forest, part)| light(forest, part));
        }
        rayon::join(
            || below.into_par_iter().with_max_len(1).for_each(go),
            || forests.into_par_iter().with_max_len(1).for_each(|(forest, part)| light(forest, part)),
        );
    }
}

/// Contributions of fronts to their parents, by the number of the child front.
#[derive(Default)]
pub struct Waiting(Mutex<HashMap<u32, Vec<f64>>>);

impl Waiting {
    pub fn put(&self, front: u32, values: Vec<f64>) {
        lock(&self.0).insert(front, values);
    }

    pub fn into_inner(self) -> HashMap<u32, Vec<f64>> {
        self.0.into_inner().unwrap_or_else(PoisonError::into_inner)
    }

    pub fn take(&self, front: u32) -> Vec<f64> {
        lock(&self.0).remove(&front).unwrap_or_default()
    }
}

/// The lock itself: what it guards is whole even if another thread has panicked.
pub fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Treatment of a front.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// It is eliminated
    Eliminate,
    /// It is eliminated, and what it passes on is kept for the next time
    EliminateAndKeep,
    /// It stays, and what it passes on is at hand
    PassOn,
    /// It stays, and so does the front above
    Rest,
}

impl Action {
    /// Whether the front is eliminated.
    pub fn eliminates(self) -> bool {
        matches!(self, Self::Eliminate | Self::EliminateAndKeep)
    }
}

/// Treatment of every front when the values of some have `changed`, and this is `kept`.
pub fn actions(symbolic: &Symbolic, changed: &[bool], kept: &HashMap<u32, Vec<f64>>) -> Vec<Action> {
    let fronts = &symbolic.fronts;
    let mut eliminated: Vec<bool> = Vec::with_capacity(fronts.len());
    for (front, changed) in fronts.iter().zip(changed) {
        eliminated.push(*changed || front.children.iter().any(|&child| eliminated[child as usize]));
    }
    // Nothing wants what a root passes on.
    let mut wanted = vec![false; fronts.len()];
    let mut actions = vec![Action::Rest; fronts.len()];
    for (number, front) in fronts.iter().enumerate().rev() {
        actions[number] = match (eliminated[number], wanted[number]) {
            (true, _) => Action::Eliminate,
            (false, false) => Action::Rest,
            (false, true) if kept.contains_key(&(number as u32)) => Action::PassOn,
            (false, true) => Action::EliminateAndKeep,
        };
        front.children.iter().for_each(|&child| wanted[child as usize] = actions[number].eliminates());
    }
    actions
}
