//! Water at a contact point, between bodies through which it flows, with its part in the balances of their pressures.

/// Places between which water passes at a contact point: the slave, the master, and what lies between them.
pub(super) const ACROSS: [[usize; 2]; 3] = [[0, 1], [2, 0], [2, 1]];

/// Water at a contact point in an increment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Between {
    /// s of two dofs of every node behind the point; 0 of one that it does not depend on [F/L³]
    pub(super) scales: Vec<f64>,
    /// Weights of the places in p_w
    pub(super) means: [f64; 3],
    /// ∂p/∂p of these dofs, at every place
    pub(super) shares: [Vec<f64>; 3],
    /// p at every place [F/L²]
    pub(super) pressures: [f64; 3],
    /// κ ℓ Δt/β of each of [`ACROSS`] [L⁵/F]
    pub(super) passes: [f64; 3],
    /// g, and ΔV [L], [L³]
    pub(super) gap: f64,
    pub(super) taken: f64,
    /// Whether ΔV changes with the displacements
    pub(super) counts: bool,
}

impl Between {
    /// Counts the water from that between the surfaces before, g ℓ; a point that faced nothing brings what is there.
    pub(super) fn count_from(&mut self, before: Option<f64>, gap: f64, length: f64) {
        (self.gap, self.counts) = (gap, before.is_some());
        self.taken = before.map_or(0.0, |before| gap * length - before);
    }

    /// p_w [F/L²].
    pub(super) fn pressure(&self) -> f64 {
        self.means.iter().zip(self.pressures).map(|(mean, pressure)| mean * pressure).sum()
    }

    /// ∂p_w/∂p of a dof behind the point.
    fn of_dof(&self, j: usize) -> f64 {
        self.means.iter().zip(&self.shares).map(|(mean, shares)| mean * shares[j]).sum()
    }

    /// ∂(p − p)/∂p of what drives each of [`ACROSS`], for a dof behind the point.
    fn apart(&self, j: usize) -> [f64; 3] {
        ACROSS.map(|[from, to]| self.shares[from][j] - self.shares[to][j])
    }

    /// What the balance of each dof behind the point takes up of ΔV [L³].
    pub(super) fn taken(&self) -> impl Iterator<Item = f64> + '_ {
        (0..self.scales.len()).map(|j| self.of_dof(j) * self.taken)
    }

    /// (4) of `seam.rs` of each dof behind the point [F].
    pub(super) fn forces(&self) -> impl Iterator<Item = f64> + '_ {
        let apart = ACROSS.map(|[from, to]| self.pressures[from] - self.pressures[to]);
        let flows: [f64; 3] = std::array::from_fn(|k| self.passes[k] * apart[k]);
        (0..self.scales.len()).map(move |j| {
            let across: f64 = self.apart(j).iter().zip(flows).map(|(apart, flow)| apart * flow).sum();
            -self.scales[j] * (self.of_dof(j) * self.taken + across)
        })
    }

    /// ∂p_w by the dofs behind the point [F/L³].
    pub(super) fn rates(&self) -> impl Iterator<Item = f64> + '_ {
        (0..self.scales.len()).map(|j| self.of_dof(j) * self.scales[j])
    }

    /// Adds the derivatives of (4) of `seam.rs` to the rows of the dofs behind the point, in a tangent of `all` dofs, column by column.
    pub(super) fn vary(&self, length: f64, [dgap, dlength]: [&[f64]; 2], tangent: &mut [f64], all: usize) {
        let (dofs, count) = (dgap.len(), self.scales.len());
        for j in 0..count {
            let (mean, apart, scale) = (self.of_dof(j), self.apart(j), self.scales[j]);
            for c in (0..dofs).filter(|_| self.counts) {
                tangent[c * all + dofs + j] -= scale * mean * (length * dgap[c] + self.gap * dlength[c]);
            }
            for i in 0..count {
                let other = self.apart(i);
                let across: f64 = (0..ACROSS.len()).map(|k| self.passes[k] * apart[k] * other[k]).sum();
                tangent[(dofs + i) * all + dofs + j] -= scale * across * self.scales[i];
            }
        }
    }
}
