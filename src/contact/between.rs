//! Water at a contact point, between bodies through which it flows, with its part in the balances of their pressures.

/// Water at a contact point in an increment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Between {
    /// s of two dofs of every node behind the point; 0 of one that it does not depend on [F/L³]
    pub(super) scales: Vec<f64>,
    /// Weights of the sides in p_w
    pub(super) means: [f64; 2],
    /// ∂p_s/∂p and ∂p_m/∂p of these dofs
    pub(super) shares: [Vec<f64>; 2],
    /// p_s and p_m [F/L²]
    pub(super) pressures: [f64; 2],
    /// κ ℓ Δt/β [L⁵/F]
    pub(super) passes: f64,
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
        self.mean(self.pressures)
    }

    fn mean(&self, [slave, master]: [f64; 2]) -> f64 {
        self.means[0] * slave + self.means[1] * master
    }

    /// ∂p_w/∂p and ∂(p_s − p_m)/∂p of a dof behind the point.
    fn of_dof(&self, j: usize) -> [f64; 2] {
        let [slave, master] = [self.shares[0][j], self.shares[1][j]];
        [self.mean([slave, master]), slave - master]
    }

    /// What the balance of each dof behind the point takes up of ΔV [L³].
    pub(super) fn taken(&self) -> impl Iterator<Item = f64> + '_ {
        (0..self.scales.len()).map(|j| self.of_dof(j)[0] * self.taken)
    }

    /// (4) of `seam.rs` of each dof behind the point [F].
    pub(super) fn forces(&self) -> impl Iterator<Item = f64> + '_ {
        let flows = self.passes * (self.pressures[0] - self.pressures[1]);
        (0..self.scales.len()).map(move |j| {
            let [mean, difference] = self.of_dof(j);
            -self.scales[j] * (mean * self.taken + difference * flows)
        })
    }

    /// ∂p_w by the dofs behind the point [F/L³].
    pub(super) fn rates(&self) -> impl Iterator<Item = f64> + '_ {
        (0..self.scales.len()).map(|j| self.of_dof(j)[0] * self.scales[j])
    }

    /// Adds the derivatives of (4) of `seam.rs` to the rows of the dofs behind the point, in a tangent of `all` dofs, column by column.
    pub(super) fn vary(&self, length: f64, [dgap, dlength]: [&[f64]; 2], tangent: &mut [f64], all: usize) {
        let (dofs, count) = (dgap.len(), self.scales.len());
        for j in 0..count {
            let ([mean, difference], scale) = (self.of_dof(j), self.scales[j]);
            for c in (0..dofs).filter(|_| self.counts) {
                tangent[c * all + dofs + j] -= scale * mean * (length * dgap[c] + self.gap * dlength[c]);
            }
            for i in 0..count {
                tangent[(dofs + i) * all + dofs + j] -=
                    scale * self.passes * difference * self.of_dof(i)[1] * self.scales[i];
            }
        }
    }
}
