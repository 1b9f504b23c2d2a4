//! Nodes in a row along a contact, and the equations of neighbours.

/// Nodes along the surface, chain after chain, with what joins each to the next.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Line {
    /// Nodes of the mesh; of those that a periodic side makes one, the original
    pub nodes: Vec<usize>,
    /// Length of a node along the surface, times the width of the section there [L]
    lengths: Vec<f64>,
    /// Chains
    chains: Vec<Chain>,
    /// Width over length of what joins each node to the next; 0 at the end of an open chain [-]
    joints: Vec<f64>,
}

/// Nodes in a row.
#[derive(Clone, Debug, PartialEq)]
struct Chain {
    first: usize,
    end: usize,
    /// Whether the last one is joined to the first
    is_ring: bool,
}

/// A piece of a surface between two neighbouring nodes of the mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Its nodes, in order along the surface
    pub nodes: [usize; 2],
    /// Its length [L]
    pub length: f64,
    /// Width of the section at its nodes [-] or [L]
    pub widths: [f64; 2],
}

impl Line {
    /// Joins pieces in the order of a surface; `None` if more than two meet in a node.
    pub fn new(pieces: &[Piece]) -> Option<Self> {
        let mut left: Vec<Option<Piece>> = pieces.iter().copied().map(Some).collect();
        let mut line = Self::default();
        // Open chains begin where no piece ends; rings anywhere.
        let is_head = |piece: &Piece| pieces.iter().all(|other| other.nodes[1] != piece.nodes[0]);
        let heads: Vec<usize> = (0..pieces.len()).filter(|&k| is_head(&pieces[k])).chain(0..pieces.len()).collect();
        for head in heads {
            let Some(piece) = left[head].take() else { continue };
            line.lay(piece, &mut left)?;
        }
        let mut own = line.nodes.clone();
        own.sort_unstable();
        own.windows(2).all(|pair| pair[0] != pair[1]).then_some(line)
    }

    /// Lays a chain from its first piece on.
    fn lay(&mut self, piece: Piece, left: &mut [Option<Piece>]) -> Option<()> {
        let first = self.nodes.len();
        let mut next = Some(piece);
        let mut is_ring = false;
        self.add(piece.nodes[0]);
        while let Some(Piece { nodes, length, widths }) = next {
            let at = self.nodes.len() - 1;
            let [a, b] = widths;
            // ∫ N b ds of linear shape functions and width, halves in between
            self.lengths[at] += length * (3.0 * a + b) / 8.0;
            self.joints[at] = 0.5 * (a + b) / length;
            is_ring = nodes[1] == self.nodes[first];
            if is_ring {
                self.lengths[first] += length * (a + 3.0 * b) / 8.0;
                break;
            }
            self.add(nodes[1]);
            self.lengths[at + 1] += length * (a + 3.0 * b) / 8.0;
            let follows = left.iter().position(|other| other.is_some_and(|other| other.nodes[0] == nodes[1]));
            next = follows.and_then(|k| left[k].take());
        }
        self.chains.push(Chain { first, end: self.nodes.len(), is_ring });
        // A ring of two nodes would join them twice.
        (!is_ring || self.nodes.len() - first > 2).then_some(())
    }

    fn add(&mut self, node: usize) {
        self.nodes.push(node);
        self.lengths.push(0.0);
        self.joints.push(0.0);
    }

    /// Number of nodes.
    pub fn count(&self) -> usize {
        self.nodes.len()
    }

    /// Length of every node [L]
    pub fn lengths(&self) -> &[f64] {
        &self.lengths
    }

    /// Neighbours, with width over length between them.
    pub fn joints(&self) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        self.chains.iter().flat_map(move |chain| {
            let after = move |k: usize| if k + 1 < chain.end { k + 1 } else { chain.first };
            let joined = (chain.first..chain.end).filter(move |&k| k + 1 < chain.end || chain.is_ring);
            joined.map(move |k| (k, after(k), self.joints[k]))
        })
    }

    /// Neighbours, in order along the surface.
    pub fn pieces(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.joints().map(|(a, b, _)| (a, b))
    }

    /// Mean flow at every node from its joints, −T/η ∂p/∂s [L³/T].
    pub(super) fn flows(&self, pressure: &[f64], transmissivity: &[f64], viscosity: f64) -> Vec<f64> {
        let mut flows = vec![[0.0; 2]; self.count()];
        for (a, b, joint) in self.joints() {
            let flow = joint * 0.5 * (transmissivity[a] + transmissivity[b]) / viscosity * (pressure[a] - pressure[b]);
            for node in [a, b] {
                flows[node] = [flows[node][0] + flow, flows[node][1] + 1.0];
            }
        }
        flows.into_iter().map(|[sum, count]| if count > 0.0 { sum / count } else { 0.0 }).collect()
    }

    /// Solves (diagonal, −joint between neighbours) x = right, where `prescribed` nodes have their value; in place of the right side.
    ///
    /// ```text
    /// ring: (A + u uᵀ) x = b   by two solutions of the open chain (Sherman & Morrison)
    /// ```
    pub(super) fn solve(
        &self,
        diagonal: &[f64],
        joints: &[f64],
        prescribed: &[Option<f64>],
        right: &mut [f64],
        room: &mut Room,
    ) {
        let Room { diagonal: d, rest, .. } = room;
        d.clear();
        d.extend_from_slice(diagonal);
        for (node, prescribed) in prescribed.iter().enumerate() {
            if let Some(value) = prescribed {
                (d[node], right[node]) = (1.0, *value);
            }
        }
        // What a prescribed neighbour gives stands on the right; `free` is the joint of two free nodes.
        rest.clear();
        rest.resize(self.count(), 0.0);
        for (a, b, _) in self.joints() {
            match (prescribed[a], prescribed[b]) {
                (None, None) => rest[a] = joints[a],
                (Some(value), None) => right[b] += joints[a] * value,
                (None, Some(value)) => right[a] += joints[a] * value,
                (Some(_), Some(_)) => {}
            }
        }
        for chain in &self.chains {
            let (first, last) = (chain.first, chain.end - 1);
            let closing = if chain.is_ring { rest[last] } else { 0.0 };
            let part = |values: &[f64]| values[first..=last].to_vec();
            let (mut own, joints) = (part(d), part(rest));
            if closing == 0.0 {
                eliminate(&own, &joints, &mut right[first..=last]);
                continue;
            }
            // −c (e₁ eₙᵀ + eₙ e₁ᵀ) = c (e₁ e₁ᵀ + eₙ eₙᵀ) − c (e₁ + eₙ)(e₁ + eₙ)ᵀ
            let n = own.len();
            own[0] += closing;
            own[n - 1] += closing;
            let mut other = vec![0.0; n];
            (other[0], other[n - 1]) = (1.0, 1.0);
            eliminate(&own, &joints, &mut other);
            let x = &mut right[first..=last];
            eliminate(&own, &joints, x);
            let factor = closing * (x[0] + x[n - 1]) / (1.0 - closing * (other[0] + other[n - 1]));
            x.iter_mut().zip(other).for_each(|(x, other)| *x += factor * other);
        }
    }
}

/// Memory of [`Line::solve`].
#[derive(Clone, Debug, Default)]
pub(super) struct Room {
    diagonal: Vec<f64>,
    rest: Vec<f64>,
}

/// Gaussian elimination of a symmetric tridiagonal matrix with −`joints` beside its diagonal.
fn eliminate(diagonal: &[f64], joints: &[f64], right: &mut [f64]) {
    let n = diagonal.len();
    let mut pivots = diagonal.to_vec();
    for k in 1..n {
        let factor = joints[k - 1] / pivots[k - 1];
        pivots[k] -= factor * joints[k - 1];
        right[k] += factor * right[k - 1];
    }
    for k in (0..n).rev() {
        let after = if k + 1 < n { joints[k] * right[k + 1] } else { 0.0 };
        right[k] = (right[k] + after) / pivots[k];
    }
}
