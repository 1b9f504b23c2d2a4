//! Water at a contact point, between bodies through which it flows, with its part in the balances of their pressures.

/// Places between which water passes at a contact point: 0 the slave around it, 1 the master, 2 what lies between them; 3 is the point itself.
pub(super) const ACROSS: [[usize; 2]; 3] = [[0, 1], [2, 0], [2, 1]];

/// Water at a contact point in an increment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Between {
    /// s of two dofs of every node behind the point; 0 of one that it does not depend on [F/L³]
    pub(super) scales: Vec<f64>,
    /// Weights of the places in p_w
    pub(super) means: [f64; 4],
    /// ∂p/∂p of these dofs, at every place
    pub(super) shares: [Vec<f64>; 4],
    /// p at every place [F/L²]
    pub(super) pressures: [f64; 4],
    /// κ ℓ Δt/β of each of [`ACROSS`] [L⁵/F]
    pub(super) passes: [f64; 3],
    /// g, and ΔV [L], [L³]
    pub(super) gap: f64,
    pub(super) taken: f64,
    /// Whether ΔV changes with the displacements
    pub(super) counts: bool,
    /// Whether the slave and the master have water
    pub(super) sides: [bool; 2],
    /// p̄ outside, and κ_d ℓ Δt/β with its derivative by g, by which surfaces that are apart drain there [F/L²], [L⁵/F], [L⁴/F]
    pub(super) outside: f64,
    pub(super) drains: [f64; 2],
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
    fn difference(&self, j: usize) -> [f64; 3] {
        ACROSS.map(|[from, to]| self.shares[from][j] - self.shares[to][j])
    }

    /// What drains from the slave and the master [L³].
    pub(super) fn drained(&self) -> f64 {
        self.excess().iter().sum::<f64>() * self.drains[0]
    }

    /// p_s − p̄ and p_m − p̄; 0 of a side without water [F/L²].
    fn excess(&self) -> [f64; 2] {
        [0, 1].map(|side| if self.sides[side] { self.pressures[side] - self.outside } else { 0.0 })
    }

    /// Σ (p − p̄) ∂p/∂p of a dof behind the point, over both sides.
    fn excess_by(&self, j: usize) -> f64 {
        self.excess().iter().zip(&self.shares).map(|(excess, shares)| excess * shares[j]).sum()
    }

    /// What the balance of each dof behind the point takes up of ΔV [L³].
    pub(super) fn taken(&self) -> impl Iterator<Item = f64> + '_ {
        (0..self.scales.len()).map(|j| self.of_dof(j) * self.taken)
    }

    /// (4) of `seam.rs` of each dof behind the point [F].
    pub(super) fn forces(&self) -> impl Iterator<Item = f64> + '_ {
        let differences = ACROSS.map(|[from, to]| self.pressures[from] - self.pressures[to]);
        let flows: [f64; 3] = std::array::from_fn(|k| self.passes[k] * differences[k]);
        (0..self.scales.len()).map(move |j| {
            let across: f64 = self.difference(j).iter().zip(flows).map(|(difference, flow)| difference * flow).sum();
            -self.scales[j] * (self.of_dof(j) * self.taken + across + self.drains[0] * self.excess_by(j))
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
            let (mean, own, scale) = (self.of_dof(j), self.difference(j), self.scales[j]);
            for c in (0..dofs).filter(|_| self.counts) {
                tangent[c * all + dofs + j] -= scale * mean * (length * dgap[c] + self.gap * dlength[c]);
            }
            for c in (0..dofs).filter(|_| self.drains[1] != 0.0) {
                tangent[c * all + dofs + j] -= scale * self.drains[1] * self.excess_by(j) * dgap[c];
            }
            for i in 0..count {
                let other = self.difference(i);
                let across: f64 = (0..ACROSS.len()).map(|k| self.passes[k] * own[k] * other[k]).sum();
                let out: f64 = self.shares[..2].iter().map(|shares| shares[i] * shares[j]).sum();
                tangent[(dofs + i) * all + dofs + j] -= scale * (across + self.drains[0] * out) * self.scales[i];
            }
        }
    }
}
