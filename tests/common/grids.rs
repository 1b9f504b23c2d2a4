//! Model matrices: two elastic grids, one on the other, joined by stiff contact springs with friction.

use std::sync::Arc;

use fecontact::linear::{Pattern, SparseMatrix};

/// Add the 2×2 matrix `k` at a pair of nodes.
pub fn add(matrix: &mut SparseMatrix, row: usize, column: usize, k: [[f64; 2]; 2]) {
    let block = matrix.pattern.block(row, column).expect("the nodes are coupled");
    for (i, values) in k.into_iter().enumerate() {
        for (j, value) in values.into_iter().enumerate() {
            matrix.values[block.value(i, j)] += value;
        }
    }
}

/// A spring between two nodes: force along `d` from relative motion along `n`.
fn add_spring(matrix: &mut SparseMatrix, [a, b]: [usize; 2], d: [f64; 2], n: [f64; 2]) {
    for (row, row_sign) in [(a, 1.0), (b, -1.0)] {
        for (column, sign) in [(a, row_sign), (b, -row_sign)] {
            add(matrix, row, column, d.map(|d| n.map(|n| sign * d * n)));
        }
    }
}

/// Two grids of `nx` × `ny` cells and their contact.
pub struct Grids {
    pub nx: usize,
    pub ny: usize,
    /// Stiffness of the contact springs; that of the grids is 1
    pub penalty: f64,
    pub friction: f64,
    /// Name of each node: the numbering of the grids, or any other
    pub names: Vec<usize>,
}

impl Grids {
    pub fn new(nx: usize, ny: usize, penalty: f64) -> Self {
        Self { nx, ny, penalty, friction: 0.3, names: (0..2 * (nx + 1) * (ny + 1)).collect() }
    }

    /// Node at column i, row j of the lower (0) or upper (1) grid.
    pub fn node(&self, grid: usize, i: usize, j: usize) -> usize {
        self.names[(grid * (self.ny + 1) + j) * (self.nx + 1) + i]
    }

    fn cells(&self) -> Vec<[usize; 4]> {
        let corners =
            |g, i, j| [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(a, b): (usize, usize)| self.node(g, i + a, j + b));
        let rows = (0..2).flat_map(|g| (0..self.ny).map(move |j| (g, j)));
        rows.flat_map(|(g, j)| (0..self.nx).map(move |i| corners(g, i, j))).collect()
    }

    /// Pairs of nodes in contact: the first of the upper grid, the second of the lower.
    fn contacts(&self) -> Vec<[usize; 2]> {
        (0..=self.nx).map(|i| [self.node(1, i, 0), self.node(0, i, self.ny)]).collect()
    }

    /// The tangent with the bottom held by rows `support` on the diagonal.
    pub fn matrix(&self, support: f64) -> SparseMatrix {
        let mut matrix = self.floating();
        for i in 0..=self.nx {
            for d in 0..2 {
                matrix.replace_row(2 * self.node(0, i, 0) + d, support);
            }
        }
        matrix
    }

    /// The tangent without supports.
    pub fn floating(&self) -> SparseMatrix {
        let (cells, contacts) = (self.cells(), self.contacts());
        let groups = cells.iter().map(|c| &c[..]).chain(contacts.iter().map(|c| &c[..]));
        let mut matrix = SparseMatrix::zero(Arc::new(Pattern::new(self.names.len(), groups)));
        let h = std::f64::consts::FRAC_1_SQRT_2;
        for [a, b, c, d] in cells {
            for (pair, n) in [
                ([a, b], [1.0, 0.0]),
                ([c, d], [1.0, 0.0]),
                ([a, c], [0.0, 1.0]),
                ([b, d], [0.0, 1.0]),
                ([a, d], [h, h]),
                ([b, c], [-h, h]),
            ] {
                add_spring(&mut matrix, pair, n, n);
            }
        }
        for (k, pair) in contacts.into_iter().enumerate() {
            let k_n = self.penalty;
            // Two of three points slip: friction follows the pressure, and the matrix is not symmetric.
            if k % 3 == 0 {
                add_spring(&mut matrix, pair, [k_n / 2.0, 0.0], [1.0, 0.0]);
                add_spring(&mut matrix, pair, [0.0, k_n], [0.0, 1.0]);
            } else {
                add_spring(&mut matrix, pair, [self.friction * k_n, k_n], [0.0, 1.0]);
            }
        }
        matrix
    }
}

/// Numbers in [−1, 1] that look random (a linear congruential generator).
pub fn noise(n: usize) -> Vec<f64> {
    let mut seed = 1u64;
    let mut next = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    (0..n).map(|_| next()).collect()
}
