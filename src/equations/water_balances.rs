//! Balances of the pressures of water, (4) of `pore_flow.rs`: what bodies, outlets and contacts add to them.

use super::sums::Sums;
use super::trial::Trial;
use crate::model::pore_flow::PoreFlow;

/// Coefficients of (2) and (4): ω²/(1 + 2ω), Δt/β.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Times {
    /// ω²/(1 + 2ω) [-]
    pub memory: f64,
    /// Δt/β [T]
    pub span: f64,
}

impl Times {
    /// Those of an increment.
    pub fn of(trial: Trial) -> Self {
        let ratio = trial.old.ratio(trial.dt).unwrap_or(0.0);
        Self { memory: ratio * ratio / (1.0 + 2.0 * ratio), span: trial.dt * (1.0 + ratio) / (1.0 + 2.0 * ratio) }
    }
}

/// Balances of the pressures, as they are summed up.
pub(super) struct Balances {
    /// Whether each has any water: only absent bodies may have it
    is_wet: Vec<bool>,
    /// Δm [L³]
    change: Vec<f64>,
    /// (4) without s, and the magnitudes of its parts [L³]
    all: Vec<[f64; 2]>,
}

impl Balances {
    /// Without any water.
    pub fn new(flow: &PoreFlow) -> Self {
        let count = flow.count();
        Self { is_wet: vec![false; count], change: vec![0.0; count], all: vec![[0.0; 2]; count] }
    }

    /// Lets a pressure take up a volume, with the magnitude of its parts.
    pub fn take(&mut self, k: usize, volume: f64, size: f64) {
        self.is_wet[k] = true;
        self.change[k] += volume;
        self.let_out(k, volume, size);
    }

    /// Lets a volume out, with the magnitude of its parts.
    pub fn let_out(&mut self, k: usize, volume: f64, size: f64) {
        self.all[k][0] += volume;
        self.all[k][1] += size;
    }

    /// Makes equations of them; returns Δm.
    pub fn end(self, flow: &PoreFlow, u: &[f64], sums: &mut Sums) -> Vec<f64> {
        let hold = |dof: usize, sums: &mut Sums| {
            sums.force[dof] -= flow.spare() * u[dof];
            sums.stiffen(dof, dof, -flow.spare());
        };
        for (k, [sum, size]) in self.all.into_iter().enumerate() {
            let (dof, scale) = (flow.dof(k), flow.scales[k]);
            hold(dof + 1, sums);
            if !self.is_wet[k] {
                hold(dof, sums);
                continue;
            }
            sums.force[dof] -= scale * sum;
            if let Some(magnitudes) = &mut sums.magnitudes {
                magnitudes[dof] += scale * size;
            }
        }
        self.change
    }
}
