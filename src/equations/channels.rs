//! Water that flows along contacts between bodies in which it flows, too: its pressures are solved with theirs.
//!
//! ```text
//! Δm_a = ℓ_a S (p − p_n)_a, and what the surfaces open by (`contact/seam.rs`)                                                (1)
//! Σ_b T/η b/ℓ (p_a − p_b) − ℓ_a Q + ℓ_a c (p_a − p̄) − wells                what flows out of a node, except into the bodies     (2)
//! ```
//! in the balance (4) of `pore_flow.rs`. T is that of the surfaces at the start of the increment, as the permeability of the bodies is. A well that
//! holds a pressure does so to a millionth.

use super::sums::{Sums, TrialFailure};
use super::trial::Trial;
use super::water_balances::{Balances, Times};
use crate::contact::conduit::{Conduit, ConduitState, Gives, Well};
use crate::contact::seam::Seam;
use crate::model::Model;
use crate::model::pore_flow::{PRESCRIBED, PoreFlow};
use crate::model::state::{Outflow, Water};

/// A contact along which water flows, in an increment.
struct Channel<'a> {
    model: &'a Model,
    flow: &'a PoreFlow,
    conduit: &'a Conduit,
    seam: &'a Seam,
    old: &'a ConduitState,
    trial: Trial<'a>,
    u: &'a [f64],
    span: f64,
}

/// Adds the balances of their pressures, and what these change by with them to the tangent.
pub(super) fn add(
    model: &Model,
    trial: Trial,
    u: &[f64],
    times: Times,
    water: &mut Water,
    balances: &mut Balances,
    sums: &mut Sums,
) -> Result<(), TrialFailure> {
    water.channels.clone_from(&trial.old.water.channels);
    water.channels.as_flattened_mut().iter_mut().for_each(|outlet| outlet.go_on(times.memory));
    for (number, channel) in channels(model, trial, u, times) {
        water.between += channel.store(balances, sums);
        channel.let_out(&mut water.channels[number], balances, sums)?;
        channel.join(balances, sums);
    }
    Ok(())
}

/// What would flow out of the nodes at which wells prescribe a pressure, were that 0: number of the pressure, and L³/(F T).
pub(super) fn prescribed(model: &Model, trial: Trial, u: &[f64]) -> Vec<(usize, f64)> {
    let mut all = Vec::new();
    for (_, channel) in channels(model, trial, u, Times::of(trial)) {
        let (passes, numbers) = (channel.passes(), &channel.conduit.pressures);
        let nodes = channel.wells().filter(|well| matches!(well.gives, Gives::Pressure(_))).flat_map(|well| &well.at);
        all.extend(nodes.map(|(node, _)| (numbers[*node], PRESCRIBED * passes[*node])));
    }
    all
}

/// Contacts along which water flows between bodies in which it does, with their numbers among these.
fn channels<'a>(
    model: &'a Model,
    trial: Trial<'a>,
    u: &'a [f64],
    times: Times,
) -> impl Iterator<Item = (usize, Channel<'a>)> {
    let pairs = model.contacts.iter().zip(&trial.old.conduits).filter(move |(pair, _)| trial.step.joins(pair));
    pairs.filter_map(move |(pair, old)| {
        let (flow, seam) = (model.flow.as_ref()?, pair.seam.as_ref()?);
        let conduit = pair.conduit.as_ref().filter(|conduit| conduit.is_wet())?;
        let number = flow.channels.keys().position(|name| *name == pair.name).unwrap_or_default();
        Some((number, Channel { model, flow, conduit, seam, old, trial, u, span: times.span }))
    })
}

impl Channel<'_> {
    /// What passes a node along the contact and into the bodies [L⁵/(F T)].
    fn passes(&self) -> Vec<f64> {
        let mut passes: Vec<f64> = self.conduit.line.lengths().iter().map(|length| length * self.seam.most()).collect();
        self.joints().for_each(|(a, b, joint)| [a, b].iter().for_each(|&node| passes[node] += joint));
        passes
    }

    /// Wells that are open.
    fn wells(&self) -> impl Iterator<Item = &Well> {
        let middle = 0.5 * (self.trial.old.time + self.trial.time);
        self.conduit.wells.iter().filter(move |well| well.is_open(middle))
    }

    fn pressure(&self, node: usize) -> f64 {
        self.flow.pressure(self.conduit.pressures[node], Some(self.u))
    }

    /// T/η b/ℓ of what joins two nodes [L⁵/(F T)].
    fn joints(&self) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        let Conduit { line, transmissivity, viscosity, .. } = self.conduit;
        let at = |node: usize| transmissivity.at(node, self.old.walls[node]);
        line.joints().map(move |(a, b, joint)| (a, b, joint * 0.5 * (at(a) + at(b)) / viscosity))
    }

    /// Adds (1) without what the surfaces open by; returns it.
    fn store(&self, balances: &mut Balances, sums: &mut Sums) -> f64 {
        let mut all = 0.0;
        for (node, length) in self.conduit.line.lengths().iter().enumerate() {
            let k = self.conduit.pressures[node];
            let takes = length * self.conduit.storage;
            let part = takes * (self.pressure(node) - self.flow.pressure(k, Some(&self.trial.old.displacement)));
            balances.take(k, part, part.abs());
            self.stiffen(k, takes, sums);
            all += part;
        }
        all
    }

    /// Lets water out by wells and sources, and by a leak.
    fn let_out(
        &self,
        [wells, leaked]: &mut [Outflow; 2],
        balances: &mut Balances,
        sums: &mut Sums,
    ) -> Result<(), TrialFailure> {
        let Self { conduit, trial, span, .. } = self;
        let passes = self.passes();
        let mut out = |node: usize, [flow, slope]: [f64; 2], outlet: &mut Outflow| {
            let k = conduit.pressures[node];
            if !flow.is_finite() {
                let node = self.model.mesh.node_tags[conduit.line.nodes[node]];
                return Err(TrialFailure::Undefined { node, time: trial.time });
            }
            outlet.let_out(flow, *span);
            balances.let_out(k, span * flow, (span * flow).abs());
            self.stiffen(k, span * slope, sums);
            Ok(())
        };
        for (node, length) in conduit.line.lengths().iter().enumerate() {
            if let Some(source) = &conduit.source {
                out(node, [-length * source(conduit.line.nodes[node], trial.time), 0.0], wells)?;
            }
            if let Some(leak) = &conduit.leak {
                let slope = length * leak.coefficient;
                out(node, [slope * (self.pressure(node) - leak.pressure[node]), slope], leaked)?;
            }
        }
        for well in self.wells() {
            for &(node, share) in &well.at {
                let slope = PRESCRIBED * passes[node];
                let flow = match &well.gives {
                    Gives::Pressure(given) => [slope * (self.pressure(node) - given(trial.time)), slope],
                    Gives::Rate(rate) => [-share * rate(trial.time), 0.0],
                };
                out(node, flow, wells)?;
            }
        }
        Ok(())
    }

    /// Adds what flows between nodes.
    fn join(&self, balances: &mut Balances, sums: &mut Sums) {
        let (flow, pressures) = (self.flow, &self.conduit.pressures);
        for (a, b, joint) in self.joints() {
            let passes = self.span * joint;
            let volume = passes * (self.pressure(a) - self.pressure(b));
            let size = passes * (self.pressure(a).abs() + self.pressure(b).abs());
            let [a, b] = [pressures[a], pressures[b]];
            balances.let_out(a, volume, size);
            balances.let_out(b, -volume, size);
            // Of each node the first dof.
            let mut tangent = [0.0; 16];
            for (place, row, column, sign) in [(0, a, a, 1.0), (10, b, b, 1.0), (8, a, b, -1.0), (2, b, a, -1.0)] {
                tangent[place] = -sign * flow.scales[row] * flow.scales[column] * passes;
            }
            sums.couple(&[a, b].map(|k| flow.node(k)), &tangent);
        }
    }

    /// Subtracts what a balance takes up by its own pressure from the tangent.
    fn stiffen(&self, k: usize, takes: f64, sums: &mut Sums) {
        let (scale, dof) = (self.flow.scales[k], self.flow.dof(k));
        sums.stiffen(dof, dof, -scale * scale * takes);
    }
}
