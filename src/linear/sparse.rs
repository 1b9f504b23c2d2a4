//! Compressed-column matrix with 2×2 blocks: each node has two unknowns, and the pattern is symmetric. Of a pressure only the first is one: the
//! second has a diagonal value and no others.
//!
//! A pattern knows which nodes' values may be unsymmetric, as those say who add them: A_ij = A_ji wherever one of i and j is not
//! among them. Values are never compared. A constrained dof has an equation of its own, A_dd x_d = b_d; what its column has elsewhere counts
//! as on the right-hand side, and spoils no symmetry.

use std::ops::Range;
use std::sync::Arc;

/// Sparsity pattern by nodes. Row and column nodes are the same set: the pattern is symmetric, the values only where it says so.
#[derive(Clone, Debug, PartialEq)]
pub struct Pattern {
    /// Start of each column node's list in `rows`; length nodes + 1
    starts: Vec<usize>,
    /// Row nodes coupled with each column node, ascending, including the node itself
    rows: Vec<usize>,
    /// Whether values between each node and others of this kind, or its own, may be unsymmetric
    unsymmetric: Vec<bool>,
    /// Nodes that stand for a pressure: each is one unknown, which gives a stable system a negative eigenvalue
    pressures: Range<usize>,
}

/// Position of the 2×2 block of a (row node, column node) pair in the values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockPosition {
    first: u32,
    column_length: u32,
}

impl BlockPosition {
    /// Index of the value at (row dof `i`, column dof `j`) of the block, i, j ∈ {0, 1}.
    pub fn value(self, i: usize, j: usize) -> usize {
        self.first as usize + j * self.column_length as usize + i
    }
}

impl Pattern {
    /// Pattern of a set of node groups: all nodes of a group are coupled with each other. Nothing is known of the symmetry of the
    /// values.
    pub fn new<'a>(nodes: usize, groups: impl Iterator<Item = &'a [usize]> + Clone) -> Self {
        let mut counts = vec![1; nodes];
        for group in groups.clone() {
            for &node in group {
                counts[node] += group.len();
            }
        }
        let mut neighbours: Vec<Vec<usize>> = counts.iter().map(|&n| Vec::with_capacity(n)).collect();
        for (node, list) in neighbours.iter_mut().enumerate() {
            list.push(node);
        }
        for group in groups {
            for &node in group {
                neighbours[node].extend_from_slice(group);
            }
        }
        for list in &mut neighbours {
            list.sort_unstable();
            list.dedup();
        }
        let mut starts = vec![0];
        let mut rows = Vec::with_capacity(neighbours.iter().map(Vec::len).sum());
        for list in &neighbours {
            rows.extend_from_slice(list);
            starts.push(rows.len());
        }
        Self { starts, rows, unsymmetric: vec![true; nodes], pressures: 0..0 }
    }

    /// The same for values that are symmetric but between these nodes.
    pub fn symmetric_but(self, unsymmetric: Vec<bool>) -> Self {
        Self { unsymmetric, ..self }
    }

    /// The same with nodes that stand for a pressure each: one unknown, which gives a stable system a negative eigenvalue.
    pub fn with_pressures(self, pressures: Range<usize>) -> Self {
        Self { pressures, ..self }
    }

    /// Whether a node stands for a pressure.
    pub(super) fn is_pressure(&self, node: usize) -> bool {
        self.pressures.contains(&node)
    }

    /// Number of unknowns of a node.
    pub(super) fn unknowns(&self, node: usize) -> usize {
        if self.is_pressure(node) { 1 } else { 2 }
    }

    /// Flags of the nodes between which values may be unsymmetric.
    pub fn unsymmetric(&self) -> &[bool] {
        &self.unsymmetric
    }

    /// Whether values may be unsymmetric between all nodes.
    pub(super) fn is_all_unsymmetric(&self) -> bool {
        !self.unsymmetric.contains(&false)
    }

    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        self.starts.len() - 1
    }

    /// Nodes coupled with `node`, ascending, including itself.
    pub fn neighbours(&self, node: usize) -> &[usize] {
        &self.rows[self.starts[node]..self.starts[node + 1]]
    }

    /// Number of stored values.
    pub fn values(&self) -> usize {
        4 * self.rows.len()
    }

    /// Starts of the columns and the row nodes in them (compressed columns of the node graph).
    pub(super) fn columns(&self) -> (&[usize], &[usize]) {
        (&self.starts, &self.rows)
    }

    /// Positions of the blocks in the column of `node`, in the order of [`Self::neighbours`].
    pub(super) fn column(&self, node: usize) -> impl Iterator<Item = BlockPosition> {
        let blocks = self.starts[node + 1] - self.starts[node];
        let first = 4 * self.starts[node];
        (0..blocks).map(move |k| BlockPosition { first: (first + 2 * k) as u32, column_length: 2 * blocks as u32 })
    }

    /// Position of the block (row node, column node), if the two are coupled.
    pub fn block(&self, row: usize, column: usize) -> Option<BlockPosition> {
        let neighbours = self.neighbours(column);
        let k = neighbours.binary_search(&row).ok()?;
        let first = 4 * self.starts[column] + 2 * k;
        Some(BlockPosition { first: first as u32, column_length: 2 * neighbours.len() as u32 })
    }

    /// Position of the block of two nodes that are coupled, because the pattern is made so.
    ///
    /// # Panics
    /// If they are not: what is added there would be lost without a word.
    #[track_caller]
    pub fn coupled(&self, row: usize, column: usize) -> BlockPosition {
        self.block(row, column).unwrap_or_else(|| panic!("nodes {row} and {column} are not coupled in the pattern"))
    }

    /// Scalar column starts and row indices (compressed columns, rows ascending).
    pub fn scalar(&self) -> (Vec<usize>, Vec<usize>) {
        let mut columns = vec![0];
        let mut rows = Vec::with_capacity(self.values());
        for node in 0..self.nodes() {
            for _ in 0..2 {
                rows.extend(self.neighbours(node).iter().flat_map(|&row| [2 * row, 2 * row + 1]));
                columns.push(rows.len());
            }
        }
        (columns, rows)
    }
}

/// Values on a shared pattern.
#[derive(Clone, Debug)]
pub struct SparseMatrix {
    /// The pattern; two matrices have the same one if the pointers are equal
    pub pattern: Arc<Pattern>,
    /// Values, column by column
    pub values: Vec<f64>,
    /// Whether each dof is constrained: see [`SparseMatrix::constrain`]
    pub constrained: Vec<bool>,
    /// Whether an odd number of nodes have their two equations in reverse order ([`SparseMatrix::turn_rows`])
    pub reversed: bool,
}

impl SparseMatrix {
    /// Creates the zero matrix on a pattern.
    pub fn zero(pattern: Arc<Pattern>) -> Self {
        let values = vec![0.0; pattern.values()];
        let constrained = vec![false; 2 * pattern.nodes()];
        Self { pattern, values, constrained, reversed: false }
    }

    /// Number of rows and columns.
    pub fn size(&self) -> usize {
        2 * self.pattern.nodes()
    }

    /// Set every value to zero; nothing is constrained.
    pub fn clear(&mut self) {
        self.values.fill(0.0);
        self.constrained.fill(false);
        self.reversed = false;
    }

    /// Take the values of a matrix on the same pattern; nothing is constrained.
    pub fn copy_values(&mut self, other: &SparseMatrix) {
        self.values.copy_from_slice(&other.values);
        self.constrained.fill(false);
        self.reversed = false;
    }

    /// Adds `value` to the diagonal entry of one dof: A_ii += value.
    pub fn add_diagonal(&mut self, dof: usize, value: f64) {
        self.add(dof, dof, value);
    }

    /// Adds to the entry of two dofs, whose nodes are coupled.
    pub fn add(&mut self, row: usize, column: usize, value: f64) {
        let block = self.pattern.coupled(row / 2, column / 2);
        self.values[block.value(row % 2, column % 2)] += value;
    }

    /// Adds to the two columns of a block.
    pub fn add_block(&mut self, block: BlockPosition, columns: [[f64; 2]; 2]) {
        columns.into_iter().enumerate().for_each(|(j, column)| self.add_column(block, j, column));
    }

    /// Adds to one column of a block.
    pub fn add_column(&mut self, block: BlockPosition, j: usize, column: [f64; 2]) {
        let own = &mut self.values[block.value(0, j)..][..2];
        own.iter_mut().zip(column).for_each(|(own, value)| *own += value);
    }

    /// Adds another matrix on the same pattern, each column multiplied by its factor.
    pub fn add_columns(&mut self, other: &SparseMatrix, factors: &[f64]) {
        let mut k = 0;
        for (column, factor) in factors.iter().enumerate() {
            for _ in 0..2 * other.pattern.neighbours(column / 2).len() {
                self.values[k] += factor * other.values[k];
                k += 1;
            }
        }
    }

    /// The diagonal of the matrix.
    pub fn diagonal(&self) -> Vec<f64> {
        (0..self.size())
            .map(|dof| {
                let (node, d) = (dof / 2, dof % 2);
                self.values[self.pattern.coupled(node, node).value(d, d)]
            })
            .collect()
    }

    /// Extends the marks to all nodes that nonzero values couple with marked ones, directly or through others.
    pub fn reach(&self, marked: &mut [bool]) {
        let couples = |row: usize, column: usize| {
            [(row, column), (column, row)].into_iter().any(|(row, column)| {
                let block = self.pattern.coupled(row, column);
                (0..4).any(|k| self.values[block.value(k / 2, k % 2)] != 0.0)
            })
        };
        let mut next: Vec<usize> = (0..marked.len()).filter(|&node| marked[node]).collect();
        while let Some(node) = next.pop() {
            for &other in self.pattern.neighbours(node) {
                if !marked[other] && couples(other, node) {
                    marked[other] = true;
                    next.push(other);
                }
            }
        }
    }

    /// Hold a dof: its equation becomes `diagonal` x = b, and stays so.
    pub fn constrain(&mut self, dof: usize, diagonal: f64) {
        self.replace_row(dof, diagonal);
        self.constrained[dof] = true;
    }

    /// Replace the row of `dof` by `diagonal` on the diagonal and zeros elsewhere, to which others may be added: what its column
    /// has is unsymmetric then.
    pub fn replace_row(&mut self, dof: usize, diagonal: f64) {
        let (node, d) = (dof / 2, dof % 2);
        self.constrained[dof] = false;
        // The pattern is symmetric: the columns with an entry in this row are the neighbours of its node.
        for k in self.pattern.starts[node]..self.pattern.starts[node + 1] {
            let column = self.pattern.rows[k];
            let block = self.pattern.coupled(node, column);
            for j in 0..2 {
                self.values[block.value(d, j)] = if column == node && j == d { diagonal } else { 0.0 };
            }
        }
    }

    /// Adds a multiple of the equation of one dof to that of another, whose node must be coupled with all that this equation has values of:
    /// columns of zeros, as those of copies on periodic sides, may be missing.
    pub fn add_row(&mut self, from_dof: usize, to_dof: usize, share: f64) {
        let [from, to] = [from_dof / 2, to_dof / 2];
        for k in self.pattern.starts[from]..self.pattern.starts[from + 1] {
            let column = self.pattern.rows[k];
            let source = self.pattern.coupled(from, column);
            let added = [0, 1].map(|c| share * self.values[source.value(from_dof % 2, c)]);
            if added == [0.0; 2] {
                continue;
            }
            let target = self.pattern.coupled(to, column);
            (0..2).for_each(|c| self.values[target.value(to_dof % 2, c)] += added[c]);
        }
    }

    /// Rotates the equations of a node: that of `dof` becomes Σ own_j x_j over its two unknowns, the other Σ across_i times
    /// both original ones.
    pub fn turn_rows(&mut self, dof: usize, own: [f64; 2], across: [f64; 2]) {
        let (node, d) = (dof / 2, dof % 2);
        self.constrained[2 * node..2 * node + 2].fill(false);
        let unit =
            if d == 0 { own[0] * across[1] - own[1] * across[0] } else { across[0] * own[1] - across[1] * own[0] };
        self.reversed ^= unit < 0.0;
        for k in self.pattern.starts[node]..self.pattern.starts[node + 1] {
            let column = self.pattern.rows[k];
            let block = self.pattern.coupled(node, column);
            for (j, own) in own.into_iter().enumerate() {
                let rows = [0, 1].map(|i| self.values[block.value(i, j)]);
                self.values[block.value(1 - d, j)] = across[0] * rows[0] + across[1] * rows[1];
                self.values[block.value(d, j)] = if column == node { own } else { 0.0 };
            }
        }
    }

    /// The product A x.
    pub fn multiply(&self, x: &[f64]) -> Vec<f64> {
        let mut product = vec![0.0; x.len()];
        if self.pattern.rows.len() == self.pattern.nodes().pow(2) {
            // All nodes are coupled: a dense matrix.
            for (column, x) in self.values.chunks_exact(self.size().max(1)).zip(x) {
                product.iter_mut().zip(column).for_each(|(y, a)| *y += a * x);
            }
            return product;
        }
        let mut values = self.values.chunks_exact(2);
        for node in 0..self.pattern.nodes() {
            for x in &x[2 * node..2 * node + 2] {
                for (&row, pair) in self.pattern.neighbours(node).iter().zip(&mut values) {
                    product[2 * row] += pair[0] * x;
                    product[2 * row + 1] += pair[1] * x;
                }
            }
        }
        product
    }

    /// A x of a symmetric matrix for several vectors: sums of columns instead of rows, which wait less for memory.
    pub fn multiply_symmetric<const N: usize>(&self, all: [&[f64]; N]) -> [Vec<f64>; N] {
        let mut products = all.map(|x| Vec::with_capacity(x.len()));
        let mut rest = &self.values[..];
        for node in 0..self.pattern.nodes() {
            let rows = self.pattern.neighbours(node);
            let [one, other] = [0, 1].map(|_| rest.split_off(..2 * rows.len()).unwrap_or_default());
            let mut sums = [[0.0; 2]; N];
            for (&row, (one, other)) in rows.iter().zip(one.chunks_exact(2).zip(other.chunks_exact(2))) {
                for (sums, x) in sums.iter_mut().zip(all) {
                    let x = &x[2 * row..2 * row + 2];
                    sums[0] += one[0] * x[0] + one[1] * x[1];
                    sums[1] += other[0] * x[0] + other[1] * x[1];
                }
            }
            products.iter_mut().zip(sums).for_each(|(product, sums)| product.extend(sums));
        }
        products
    }

    /// b − A x.
    pub fn residual(&self, x: &[f64], b: &[f64]) -> Vec<f64> {
        self.multiply(x).iter().zip(b).map(|(ax, b)| b - ax).collect()
    }

    /// b − A x and |A| |x| + |b|: the residual, and the sum of the magnitudes of its terms.
    pub fn residual_and_size(&self, x: &[f64], b: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let mut residual = b.to_vec();
        let mut size: Vec<f64> = b.iter().map(|b| b.abs()).collect();
        let mut values = self.values.chunks_exact(2);
        for node in 0..self.pattern.nodes() {
            for x in &x[2 * node..2 * node + 2] {
                for (&row, pair) in self.pattern.neighbours(node).iter().zip(&mut values) {
                    for (i, a) in pair.iter().enumerate() {
                        residual[2 * row + i] -= a * x;
                        size[2 * row + i] += (a * x).abs();
                    }
                }
            }
        }
        (residual, size)
    }
}
