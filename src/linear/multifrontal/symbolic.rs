//! What depends on the pattern alone: fronts, their rows, and where every value goes.

use std::iter;
use std::sync::Arc;

use super::super::{BlockPosition, LinearFailure, Pattern};
use super::forest::{Forest, forests};
use super::front::{Front, Run};
use super::order::order;
use super::tree::{Elimination, Supernode, supernodes};

/// A 2×2 block of A and the place of its first value in the panel it goes to.
pub struct Entry {
    pub block: BlockPosition,
    pub target: u32,
}

/// Fronts in postorder: children before parents, every subtree contiguous.
pub struct Symbolic {
    pub pattern: Arc<Pattern>,
    /// Node at each position of the order of elimination
    pub nodes: Vec<usize>,
    pub fronts: Vec<Front>,
    pub entries: Vec<Entry>,
    /// Whole subtrees, light enough to share out among threads. The fronts between are heavy.
    pub forests: Vec<Forest>,
}

impl Symbolic {
    /// The `kept` nodes, ascending and all coupled with each other by the pattern, make up the last front, which stays open.
    pub fn new(pattern: Arc<Pattern>, kept: &[usize]) -> Result<Self, LinearFailure> {
        let mut order = order(&pattern)?;
        order.retain(|node| kept.binary_search(node).is_err());
        order.extend(kept);
        let eliminated = pattern.nodes() - kept.len();
        let elimination = Elimination::new(&pattern, order);
        let supernodes = supernodes(&elimination, eliminated);
        let mut fronts = fronts(&pattern, &elimination, &supernodes);
        fronts.iter_mut().for_each(|front| front.open = front.first >= 2 * eliminated);
        let entries = entries(&pattern, &elimination, &mut fronts);
        let forests = forests(&fronts);
        Ok(Self { pattern, nodes: elimination.nodes, fronts, entries, forests })
    }

    /// Number of values in the factors.
    pub fn values(&self) -> usize {
        self.fronts.last().map_or(0, |front| front.values.end)
    }

    /// The most values that contributions hold at a time on this number of threads: those of all forests while the
    /// last of them are eliminated, or those of the heavy fronts, two of which may be at work.
    pub fn contributions(&self, threads: usize) -> usize {
        let passed_on = |number: usize| self.fronts[number].below().pow(2);
        let rooms = threads * self.forests.iter().map(|forest| forest.room).max().unwrap_or(0);
        let mut held: usize =
            self.forests.iter().flat_map(|forest| &forest.roots).map(|&root| passed_on(root as usize)).sum();
        let mut peak = held;
        let mut done = 0;
        let end = self.fronts.len();
        for end in self.forests.iter().map(|forest| forest.fronts.clone()).chain(iter::once(end..end)) {
            for number in done..end.start {
                held += passed_on(number);
                peak = peak.max(held);
                held -= self.fronts[number].children.iter().map(|&child| passed_on(child as usize)).sum::<usize>();
            }
            done = end.end;
        }
        rooms + peak
    }
}

/// Row structure: what A couples with the pivots, and what the children pass on.
fn fronts(pattern: &Pattern, elimination: &Elimination, supernodes: &[Supernode]) -> Vec<Front> {
    let owner = owners(supernodes, elimination.nodes.len());
    let mut fronts: Vec<Front> = Vec::with_capacity(supernodes.len());
    let mut families: Vec<Vec<u32>> = vec![Vec::new(); supernodes.len()];
    let mut seen = vec![usize::MAX; elimination.nodes.len()];
    let mut start = 0;
    for (s, &Supernode { first, end, below, .. }) in supernodes.iter().enumerate() {
        let mut rows = Vec::with_capacity(below);
        let mut add = |position: usize| {
            if position >= end && seen[position] != s {
                seen[position] = s;
                rows.push(position as u32);
            }
        };
        for &node in &elimination.nodes[first..end] {
            pattern.neighbours(node).iter().for_each(|&neighbour| add(elimination.positions[neighbour]));
        }
        let children = std::mem::take(&mut families[s]);
        for &child in &children {
            fronts[child as usize].rows.iter().for_each(|&row| add(row as usize));
        }
        rows.sort_unstable();
        children.iter().for_each(|&child| place_in_parent(&mut fronts[child as usize], first, end, &rows));
        if let Some(&row) = rows.first() {
            families[owner[row as usize]].push(s as u32);
        }
        let pivots = 2 * (end - first);
        let length = pivots * (pivots + 4 * rows.len());
        let values = start..start + length;
        start += length;
        fronts.push(Front {
            first: 2 * first,
            pivots,
            rows,
            to_parent: Vec::new(),
            runs: Vec::new(),
            inner_runs: 0,
            children,
            odd: false,
            open: false,
            values,
            lower: 0..0,
            upper: 0..0,
        });
    }
    mark_odd(&mut fronts);
    fronts
}

/// Where the rows of a child lie in its parent, a front of the positions `first..end` and then `rows`.
fn place_in_parent(child: &mut Front, first: usize, end: usize, rows: &[u32]) {
    child.to_parent = places(&child.rows, first, end, rows);
    let inner = child.rows.partition_point(|&row| (row as usize) < end);
    (child.runs, child.inner_runs) = runs(&child.to_parent, inner);
}

/// Mark the fronts whose depth in the tree is odd.
fn mark_odd(fronts: &mut [Front]) {
    for parent in (0..fronts.len()).rev() {
        for child in std::mem::take(&mut fronts[parent].children) {
            fronts[child as usize].odd = !fronts[parent].odd;
            fronts[parent].children.push(child);
        }
    }
}

/// The supernode of each position.
fn owners(supernodes: &[Supernode], positions: usize) -> Vec<usize> {
    let mut owners = vec![0; positions];
    for (s, supernode) in supernodes.iter().enumerate() {
        owners[supernode.first..supernode.end].fill(s);
    }
    owners
}

/// Where the nodes `wanted` lie in a front of the positions `first..end` and then `rows`. All lists ascend.
fn places(wanted: &[u32], first: usize, end: usize, rows: &[u32]) -> Vec<u32> {
    let mut k = 0;
    let place = |&position: &u32| {
        let position = position as usize;
        if position < end {
            return 2 * (position - first) as u32;
        }
        while (rows[k] as usize) < position {
            k += 1;
        }
        2 * (end - first + k) as u32
    };
    wanted.iter().map(place).collect()
}

/// Each block of A goes to the front that eliminates the first of its two nodes.
fn entries(pattern: &Pattern, elimination: &Elimination, fronts: &mut [Front]) -> Vec<Entry> {
    let Elimination { nodes, positions, .. } = elimination;
    let mut entries = Vec::with_capacity(pattern.values() / 4);
    let mut place = vec![0; nodes.len()];
    for front in fronts {
        let (first, end) = (front.first / 2, (front.first + front.pivots) / 2);
        let (size, pivots) = (front.size(), front.pivots);
        for (k, position) in (first..end).chain(front.rows.iter().map(|&row| row as usize)).enumerate() {
            place[position] = 2 * k;
        }
        let start = entries.len();
        for column in first..end {
            for (&row, block) in pattern.neighbours(nodes[column]).iter().zip(pattern.column(nodes[column])) {
                if positions[row] >= first {
                    let target = place[positions[row]] + place[column] * size;
                    entries.push(Entry { block, target: target as u32 });
                }
            }
        }
        front.lower = start..entries.len();
        for row in first..end {
            for &column in pattern.neighbours(nodes[row]).iter().filter(|&&column| positions[column] >= end) {
                if let Some(block) = pattern.block(nodes[row], column) {
                    let target = place[positions[column]] - pivots + place[row] * (size - pivots);
                    entries.push(Entry { block, target: target as u32 });
                }
            }
        }
        front.upper = front.lower.end..entries.len();
    }
    entries
}

/// Join the nodes whose places follow each other, and count the runs of the first `inner` nodes.
fn runs(places: &[u32], inner: usize) -> (Vec<Run>, usize) {
    let mut runs: Vec<Run> = Vec::new();
    let mut inner_runs = 0;
    for (k, &to) in places.iter().enumerate() {
        match runs.last_mut() {
            Some(run) if k != inner && run.to + run.length == to => run.length += 2,
            _ => runs.push(Run { from: 2 * k as u32, to, length: 2 }),
        }
        if k < inner {
            inner_runs = runs.len();
        }
    }
    (runs, inner_runs)
}
