//! Water that bodies have taken up, what has left them, and how it seeps.

use nalgebra::Vector2;

use super::Model;
use super::pore_flow::WetElement;
use super::state::{Outflow, State, Water};

#[doc(hidden)]
impl Model {
    /// The water at the start of a run.
    pub fn first_water(&self) -> Water {
        self.flow.as_ref().map_or_else(Water::default, |flow| Water {
            change: vec![0.0; flow.count()],
            outlets: vec![Outflow::default(); flow.outlets.len()],
            channels: vec![[Outflow::default(); 2]; flow.channels.len()],
            peaks: vec![0.0; flow.bodies.len()],
            excess: vec![0.0; flow.bodies.len()],
            taken: vec![0.0; flow.bodies.len()],
            brought: vec![0.0; flow.bodies.len()],
            between: 0.0,
        })
    }

    /// Water that all bodies have taken up, that is between their surfaces and that has left through outlets, which is none but for errors, and how much has come and gone;
    /// `None` where none flows [L³].
    pub fn balance_of_water(&self, state: &State) -> Option<[f64; 2]> {
        self.flow.as_ref()?;
        let Water { taken, outlets, channels, between, .. } = &state.water;
        let left = outlets.iter().chain(channels.as_flattened()).map(|outlet| outlet.volume);
        let all = taken.iter().copied().chain(left).chain([*between]);
        Some(all.fold([0.0; 2], |[sum, size], volume| [sum + volume, size + volume.abs()]))
    }

    /// Mean seepage through an element, −k/γ_w (∇p − γ_w g) in the place where it is now [L/T].
    pub fn seepage(&self, wet: &WetElement, state: &State) -> Vector2<f64> {
        let Some(flow) = &self.flow else { return Vector2::zeros() };
        let wet = &*self.wet(state, wet);
        let pressures: Vec<f64> = wet.pressures.iter().map(|&k| flow.pressure(k, Some(&state.displacement))).collect();
        let (mut sum, mut volume) = (Vector2::zeros(), 0.0);
        for (k, point) in wet.points.iter().enumerate() {
            let slopes = wet.slopes(k);
            let along = |i: usize| slopes[i].iter().zip(&pressures).map(|(slope, p)| slope * p).sum();
            let mut slope = Vector2::new(along(0), along(1));
            let (f, hoop) = wet.deformed(k, &wet.moved(&state.displacement));
            let mut jacobian = f.trace() - 1.0 + (hoop - 1.0);
            if !wet.is_linear {
                slope = f.transpose().try_inverse().unwrap_or_default() * slope;
                jacobian = f.determinant() * hoop;
            }
            let driven = slope + Vector2::new(0.0, wet.weight);
            let pressure: f64 = wet.shape[k].values.iter().zip(&pressures).map(|(n, p)| n * p).sum();
            let share = point.volume * wet.permeability(jacobian, pressure);
            sum -= share * Vector2::new(wet.mobility[0] * driven.x, wet.mobility[1] * driven.y);
            volume += point.volume;
        }
        sum / volume
    }

    /// Notes what each body that is there has taken up, and its mean pressure in excess of that at the start, with the largest so far.
    pub fn note_water(&self, state: &mut State) {
        for (k, &body) in self.flow.iter().flat_map(|flow| flow.bodies.iter().enumerate()) {
            if let Some([stored, excess]) = self.stored_water(body, state).filter(|_| state.has(body)) {
                let Water { peaks, excess: now, taken, brought, .. } = &mut state.water;
                peaks[k] = if excess.abs() > peaks[k].abs() { excess } else { peaks[k] };
                (now[k], taken[k]) = (excess, stored - brought[k]);
            }
        }
    }

    /// What a body in which water flows has taken up of it while it was there, and its mean pressure in
    /// excess of that at the start, if it is there; `None` of any other [L³], [F/L²].
    pub fn water_of(&self, body: usize, state: &State) -> Option<[f64; 2]> {
        let number = self.flow.as_ref()?.bodies.iter().position(|other| *other == body)?;
        let excess = if state.has(body) { state.water.excess[number] } else { f64::NAN };
        Some([state.water.taken[number], excess])
    }

    /// What a body holds of water beyond that at the start, ∫ (b (J − 1) + (p − p₀)/Q) dV, what it brought included, and its mean pressure in excess of that
    /// at the start; `None` of one in which none flows [L³], [F/L²].
    pub(super) fn stored_water(&self, body: usize, state: &State) -> Option<[f64; 2]> {
        let flow = self.flow.as_ref().filter(|flow| flow.bodies.contains(&body))?;
        let [mut taken, mut excess, mut volume] = [0.0; 3];
        for wet in self.bodies[body].elements.iter().filter_map(|&e| flow.wet(e)) {
            let wet = self.wet(state, wet);
            let (slot, count) = wet.variables?;
            let memory = self.memories.of(wet.element, &state.memory);
            for (point, own) in wet.points.iter().zip(memory.chunks_exact(count)) {
                taken += point.volume * slot.of(own)[1];
            }
            for (&k, own) in wet.pressures.iter().zip(&wet.volumes) {
                let rise = own * (flow.pressure(k, Some(&state.displacement)) - flow.initial[k]);
                taken += wet.capacity * rise;
                excess += rise;
                volume += own;
            }
        }
        Some([taken, excess / volume])
    }
}
