//! What depends on the pattern alone: fronts, their rows, and where every value goes.
//!
//! # Order
//!
//! Fill-reducing order of the nodes. Those between which values are unsymmetric are moved to its end where that costs less than they
//! save: all fronts above one of them are unsymmetric, too. With the nodes of a sliding contact between two blocks last, the operations of 80 000 and
//! 300 000 dofs are 5 and 7 % more than those of symmetric values throughout, of which the longer elimination makes 2 and 4; where
//! the order has put them, 22 and 17 %.
//!
//! Elimination tree, postorder and supernodes of the node graph. Sizes are counted in unknowns, of which a pressure is one and any other node
//! has two.

use std::iter;
use std::ops::Range;
use std::sync::Arc;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::amd;

use super::front::{Forest, Front, Run, forests};
use crate::linear::{BlockPosition, LinearFailure, Pattern};

/// A block of A and the place of its first value in the panel it goes to.
pub struct Entry {
    pub block: BlockPosition,
    /// Row node and column node
    pub row: u32,
    pub column: u32,
    pub target: u32,
    /// Unknowns of the row node and of the column node
    pub unknowns: [u8; 2],
}

/// Fronts in postorder: children before parents, every subtree contiguous.
pub struct Symbolic {
    pub pattern: Arc<Pattern>,
    /// Dof of each unknown in the order of elimination
    pub dofs: Vec<usize>,
    pub fronts: Vec<Front>,
    pub entries: Vec<Entry>,
    /// Whole subtrees, light enough to share out among threads. The fronts between are heavy.
    pub forests: Vec<Forest>,
}

impl Symbolic {
    /// The `kept` nodes, all coupled with each other by the pattern, make up the last front, which stays open.
    pub fn new(pattern: Arc<Pattern>, kept: &[usize]) -> Result<Self, LinearFailure> {
        let mut order = order(&pattern)?;
        let mut stays = vec![false; pattern.nodes()];
        kept.iter().for_each(|&node| stays[node] = true);
        order.retain(|&node| !stays[node]);
        order.extend(kept);
        let eliminated = pattern.nodes() - kept.len();
        let elimination = with_unsymmetric_late(&pattern, Elimination::new(&pattern, order));
        let supernodes = supernodes(&elimination, eliminated);
        let mut fronts = fronts(&pattern, &elimination, &supernodes);
        fronts.iter_mut().for_each(|front| front.open = front.first >= elimination.starts[eliminated]);
        let entries = entries(&pattern, &elimination, &mut fronts);
        let forests = forests(&fronts);
        let dofs = elimination.nodes.iter().flat_map(|&node| (0..pattern.unknowns(node)).map(move |i| 2 * node + i));
        Ok(Self { dofs: dofs.collect(), pattern, fronts, entries, forests })
    }

    /// Dofs that a front eliminates.
    pub fn pivots(&self, front: &Front) -> &[usize] {
        &self.dofs[front.first..front.first + front.pivots]
    }

    /// Number of pressures in symmetric fronts, or in the others.
    pub fn pressures(&self, symmetric: bool) -> usize {
        let fronts = self.fronts.iter().filter(|front| front.symmetric == symmetric);
        fronts.flat_map(|front| self.pivots(front)).filter(|dof| self.pattern.is_pressure(*dof / 2)).count()
    }

    /// Number of values in the factors.
    pub fn values(&self) -> usize {
        self.fronts.last().map_or(0, |front| front.values.end)
    }

    /// The most values that contributions hold at a time on this number of threads: those of all forests while the
    /// last of them are eliminated, or those of the heavy fronts, two of which may be at work.
    pub fn contributions(&self, threads: usize) -> usize {
        let passed_on = |number: usize| self.fronts[number].below.pow(2);
        let rooms = threads * self.forests.iter().map(|forest| forest.room).max().unwrap_or(0);
        let mut stored: usize =
            self.forests.iter().flat_map(|forest| &forest.roots).map(|&root| passed_on(root as usize)).sum();
        let mut peak = stored;
        let mut done = 0;
        let end = self.fronts.len();
        for end in self.forests.iter().map(|forest| forest.fronts.clone()).chain(iter::once(end..end)) {
            for number in done..end.start {
                stored += passed_on(number);
                peak = peak.max(stored);
                stored -= self.fronts[number].children.iter().map(|&child| passed_on(child as usize)).sum::<usize>();
            }
            done = end.end;
        }
        rooms + peak
    }
}

/// Row structure: what A couples with the pivots, and what the children pass on.
fn fronts(pattern: &Pattern, elimination: &Elimination, supernodes: &[Supernode]) -> Vec<Front> {
    let Elimination { nodes, positions, starts, .. } = elimination;
    let owner = owners(supernodes, nodes.len());
    let mut fronts: Vec<Front> = Vec::with_capacity(supernodes.len());
    let mut families: Vec<Vec<u32>> = vec![Vec::new(); supernodes.len()];
    let mut seen = vec![usize::MAX; nodes.len()];
    let mut start = 0;
    for (s, &Supernode { first, end, .. }) in supernodes.iter().enumerate() {
        let mut rows = Vec::new();
        let mut add = |position: usize| {
            if position >= end && seen[position] != s {
                seen[position] = s;
                rows.push(position as u32);
            }
        };
        for &node in &nodes[first..end] {
            pattern.neighbours(node).iter().for_each(|&neighbour| add(positions[neighbour]));
        }
        let children = std::mem::take(&mut families[s]);
        for &child in &children {
            fronts[child as usize].rows.iter().for_each(|&row| add(row as usize));
        }
        rows.sort_unstable();
        for &child in &children {
            let child = &mut fronts[child as usize];
            (child.runs, child.inner_runs) = runs(&child.rows, first..end, &rows, starts);
        }
        if let Some(&row) = rows.first() {
            families[owner[row as usize]].push(s as u32);
        }
        let unsymmetric = |node: &usize| pattern.unsymmetric()[*node];
        let own = !nodes[first..end].iter().any(unsymmetric);
        let mut front = Front {
            first: starts[first],
            pivots: starts[end] - starts[first],
            below: rows.iter().map(|&row| elimination.unknowns(row as usize)).sum(),
            rows,
            runs: Vec::new(),
            inner_runs: 0,
            symmetric: own && children.iter().all(|&child| fronts[child as usize].symmetric),
            mirrors: false,
            children,
            odd: false,
            open: false,
            values: 0..0,
            lower: 0..0,
            upper: 0..0,
        };
        front.values = start..start + front.length();
        start = front.values.end;
        fronts.push(front);
    }
    mark_below(&mut fronts);
    fronts
}

/// Mark the fronts whose depth in the tree is odd, and the symmetric ones below others.
fn mark_below(fronts: &mut [Front]) {
    for number in (0..fronts.len()).rev() {
        let (fronts, others) = fronts.split_at_mut(number);
        let parent = &others[0];
        for child in &parent.children {
            let child = &mut fronts[*child as usize];
            child.odd = !parent.odd;
            child.mirrors = child.symmetric && !parent.symmetric;
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

/// Runs of unknowns of the nodes `wanted` in a front of the positions `pivots` and then `rows`, and how many of them it eliminates. All lists
/// ascend.
fn runs(wanted: &[u32], pivots: Range<usize>, rows: &[u32], starts: &[usize]) -> (Vec<Run>, usize) {
    let unknowns = |position: u32| (starts[position as usize + 1] - starts[position as usize]) as u32;
    let mut runs: Vec<Run> = Vec::new();
    let (mut inner, mut from, mut k, mut below) = (0, 0, 0, (starts[pivots.end] - starts[pivots.start]) as u32);
    for &position in wanted {
        let is_inner = (position as usize) < pivots.end;
        let to = if is_inner {
            (starts[position as usize] - starts[pivots.start]) as u32
        } else {
            while rows[k] < position {
                below += unknowns(rows[k]);
                k += 1;
            }
            below
        };
        let (length, may_join) = (unknowns(position), is_inner || runs.len() > inner);
        match runs.last_mut() {
            Some(run) if may_join && run.to + run.length == to => run.length += length,
            _ => runs.push(Run { from, to, length }),
        }
        if is_inner {
            inner = runs.len();
        }
        from += length;
    }
    (runs, inner)
}

/// Each block of A goes to the front that eliminates the first of its two nodes; of a symmetric one those below the diagonal and on it.
fn entries(pattern: &Pattern, elimination: &Elimination, fronts: &mut [Front]) -> Vec<Entry> {
    let Elimination { nodes, positions, starts, .. } = elimination;
    let mut entries = Vec::with_capacity(pattern.values() / 4);
    let mut place = vec![0; nodes.len()];
    let unknowns = |row: usize, column: usize| [row, column].map(|node| pattern.unknowns(node) as u8);
    let mut end = 0;
    for front in fronts {
        let first = end;
        while starts[end] < front.first + front.pivots {
            end += 1;
        }
        let (size, pivots) = (front.size(), front.pivots);
        let mut next = 0;
        for position in (first..end).chain(front.rows.iter().map(|&row| row as usize)) {
            place[position] = next;
            next += elimination.unknowns(position);
        }
        let start = entries.len();
        for column in first..end {
            for (&row, block) in pattern.neighbours(nodes[column]).iter().zip(pattern.column(nodes[column])) {
                if positions[row] >= if front.symmetric { column } else { first } {
                    let target = (place[positions[row]] + place[column] * size) as u32;
                    let unknowns = unknowns(row, nodes[column]);
                    entries.push(Entry { block, row: row as u32, column: nodes[column] as u32, target, unknowns });
                }
            }
        }
        front.lower = start..entries.len();
        for row in (first..end).filter(|_| !front.symmetric) {
            for &column in pattern.neighbours(nodes[row]).iter().filter(|&&column| positions[column] >= end) {
                let block = pattern.coupled(nodes[row], column);
                let target = (place[positions[column]] - pivots + place[row] * (size - pivots)) as u32;
                let unknowns = unknowns(nodes[row], column);
                entries.push(Entry { block, row: nodes[row] as u32, column: column as u32, target, unknowns });
            }
        }
        front.upper = front.lower.end..entries.len();
    }
    entries
}

/// Approximate minimum degree on the node graph: which node to eliminate as the k-th. Nested dissection, tried with `feral-metis` 0.3 on
/// two blocks, costs 31, 16, 2 and −1 % more operations at 20 000, 80 000, 300 000 and a million dofs, and nine times the time to order.
///
/// Source: Amestoy, Davis & Duff (1996), doi:10.1137/S0895479894278952.
pub fn order(pattern: &Pattern) -> Result<Vec<usize>, LinearFailure> {
    let (starts, rows) = pattern.columns();
    let n = pattern.nodes();
    let graph = SymbolicSparseColMatRef::new_checked(n, n, starts, None, rows);
    let (mut order, mut inverse) = (vec![0; n], vec![0; n]);
    let mut buffer = MemBuffer::new(amd::order_scratch::<usize>(n, rows.len()));
    amd::order(&mut order, &mut inverse, graph, amd::Control::default(), MemStack::new(&mut buffer))
        .map_err(|cause| LinearFailure::Singular(format!("no order of elimination: {cause:?}")))?;
    Ok(order)
}

/// The elimination with the nodes between which values are unsymmetric at its end, if it costs less than the one given.
fn with_unsymmetric_late(pattern: &Pattern, elimination: Elimination) -> Elimination {
    let unsymmetric = (0..pattern.nodes()).filter(|node| pattern.unsymmetric()[*node]);
    let count = unsymmetric.map(|node| pattern.unknowns(node)).sum::<usize>() as f64;
    let work = elimination.work(pattern);
    // They are a dense matrix in the end, as a rule.
    if count == 0.0 || pattern.is_all_unsymmetric() || 2.0 / 3.0 * count.powi(3) > work {
        return elimination;
    }
    let (late, mut order): (Vec<usize>, Vec<usize>) =
        elimination.nodes.iter().partition(|node| pattern.unsymmetric()[**node]);
    order.extend(late);
    let other = Elimination::new(pattern, order);
    if other.work(pattern) < work { other } else { elimination }
}

/// A node without a parent in the elimination forest.
pub const ROOT: usize = usize::MAX;

/// The order of elimination and what depends on which, in *positions*: position k is eliminated as the k-th.
pub struct Elimination {
    /// Node at each position
    pub nodes: Vec<usize>,
    /// Position of each node
    pub positions: Vec<usize>,
    /// Number of unknowns before each position, and of all
    pub starts: Vec<usize>,
    /// First position below the diagonal of each column of L, or [`ROOT`]
    pub parents: Vec<usize>,
    /// Unknowns in each column of L, those of the diagonal included
    pub counts: Vec<usize>,
}

impl Elimination {
    /// Elimination forest of the graph in a fill-reducing order, renumbered so that every subtree is contiguous.
    ///
    /// Source: Liu (1990), The role of elimination trees in sparse factorization, doi:10.1137/0611010;
    /// Davis (2006), Direct Methods for Sparse Linear Systems, sections 4.1–4.4.
    pub fn new(pattern: &Pattern, order: Vec<usize>) -> Self {
        let parents = parents(pattern, &order, &inverse(&order));
        let postorder = postorder(&parents);
        let new_position = inverse(&postorder);
        let nodes: Vec<usize> = postorder.iter().map(|&k| order[k]).collect();
        let parents: Vec<usize> =
            postorder.iter().map(|&k| if parents[k] == ROOT { ROOT } else { new_position[parents[k]] }).collect();
        let positions = inverse(&nodes);
        let counts = counts(pattern, &nodes, &positions, &parents);
        let before = nodes.iter().scan(0, |sum, &node| {
            *sum += pattern.unknowns(node);
            Some(*sum)
        });
        let starts = iter::once(0).chain(before).collect();
        Self { nodes, positions, starts, parents, counts }
    }

    /// Number of unknowns at a position.
    fn unknowns(&self, position: usize) -> usize {
        self.starts[position + 1] - self.starts[position]
    }

    /// Operations of the elimination, up to a factor: twice as many where a node is unsymmetric or above one that is.
    fn work(&self, pattern: &Pattern) -> f64 {
        let mut unsymmetric: Vec<bool> = self.nodes.iter().map(|&node| pattern.unsymmetric()[node]).collect();
        let mut work = 0.0;
        for (k, (&parent, &count)) in self.parents.iter().zip(&self.counts).enumerate() {
            work += (self.unknowns(k) * count * count) as f64 * if unsymmetric[k] { 2.0 } else { 1.0 };
            if parent != ROOT {
                unsymmetric[parent] |= unsymmetric[k];
            }
        }
        work
    }
}

fn inverse(permutation: &[usize]) -> Vec<usize> {
    let mut inverse = vec![0; permutation.len()];
    for (k, &value) in permutation.iter().enumerate() {
        inverse[value] = k;
    }
    inverse
}

/// Liu's algorithm: climb from each entry of a row to the root found so far; short cuts keep the climb short.
fn parents(pattern: &Pattern, nodes: &[usize], positions: &[usize]) -> Vec<usize> {
    let mut parents = vec![ROOT; nodes.len()];
    let mut short_cut = vec![ROOT; nodes.len()];
    for (k, &node) in nodes.iter().enumerate() {
        for &neighbour in pattern.neighbours(node) {
            let mut i = positions[neighbour];
            while i < k {
                let next = std::mem::replace(&mut short_cut[i], k);
                if next == ROOT {
                    parents[i] = k;
                    break;
                }
                i = next;
            }
        }
    }
    parents
}

fn postorder(parents: &[usize]) -> Vec<usize> {
    let n = parents.len();
    let (mut first_child, mut sibling) = (vec![ROOT; n], vec![ROOT; n]);
    for k in (0..n).rev().filter(|&k| parents[k] != ROOT) {
        sibling[k] = first_child[parents[k]];
        first_child[parents[k]] = k;
    }
    let mut postorder = Vec::with_capacity(n);
    let mut path = Vec::new();
    for root in (0..n).filter(|&k| parents[k] == ROOT) {
        path.push(root);
        while let Some(&k) = path.last() {
            let child = first_child[k];
            if child == ROOT {
                postorder.push(k);
                path.pop();
            } else {
                first_child[k] = sibling[child];
                path.push(child);
            }
        }
    }
    postorder
}

/// Row k of L is the subtree of the elimination tree that its entries span: count each column it passes.
fn counts(pattern: &Pattern, nodes: &[usize], positions: &[usize], parents: &[usize]) -> Vec<usize> {
    let mut counts: Vec<usize> = nodes.iter().map(|&node| pattern.unknowns(node)).collect();
    let mut last_row = vec![ROOT; nodes.len()];
    for (k, &node) in nodes.iter().enumerate() {
        for &neighbour in pattern.neighbours(node) {
            let mut i = positions[neighbour];
            while i < k && last_row[i] != k {
                last_row[i] = k;
                counts[i] += pattern.unknowns(node);
                i = parents[i];
            }
        }
    }
    counts
}

/// Consecutive positions that are eliminated in one dense front.
#[derive(Clone, Copy)]
pub struct Supernode {
    /// First position
    pub first: usize,
    /// One past the last position
    pub end: usize,
    /// Unknowns of these positions
    width: usize,
    /// Unknowns below: those of the last column, the diagonal excluded
    below: usize,
    /// Values of the trapezoid that are zero
    zeros: usize,
}

impl Supernode {
    /// A child taken into its parent: the child's columns get the parent's rows.
    fn with_child(&self, child: &Self) -> Self {
        let new_zeros = child.width * (self.width + self.below - child.below);
        let (width, zeros) = (child.width + self.width, child.zeros + self.zeros + new_zeros);
        Self { first: child.first, width, zeros, ..*self }
    }

    /// Small fronts may carry zeros: dense kernels lose more on the calls than on the zeros.
    fn worth_it(&self) -> bool {
        let width = self.width;
        let size = width * (width + 2) / 2 + width * self.below;
        let allowed = match width {
            0..=8 => 1.0,
            9..=16 => 0.8,
            17..=64 => 0.1,
            _ => 0.05,
        };
        self.zeros as f64 <= allowed * size as f64
    }
}

/// Fundamental supernodes, relaxed by taking small last children into their parents. None holds positions both below and
/// above `eliminated`.
///
/// Source: Ashcraft & Grimes (1989), doi:10.1145/76909.76910.
pub fn supernodes(elimination: &Elimination, eliminated: usize) -> Vec<Supernode> {
    let Elimination { parents, counts, starts, .. } = elimination;
    let n = parents.len();
    let mut supernodes: Vec<Supernode> = Vec::new();
    let mut first = 0;
    while first < n {
        let mut last = first;
        let alike = |last: usize| counts[last] == counts[last + 1] + elimination.unknowns(last);
        while parents[last] == last + 1 && alike(last) && last + 1 != eliminated {
            last += 1;
        }
        let (end, below) = (last + 1, counts[last] - elimination.unknowns(last));
        let mut current = Supernode { first, end, width: starts[end] - starts[first], below, zeros: 0 };
        while let Some(child) = supernodes.last() {
            // In postorder the one before is a child or belongs to another subtree.
            if parents[child.end - 1] >= current.end || current.first == eliminated {
                break;
            }
            let merged = current.with_child(child);
            if !merged.worth_it() {
                break;
            }
            current = merged;
            supernodes.pop();
        }
        supernodes.push(current);
        first = last + 1;
    }
    supernodes
}
