//! Bodies that come and go with the steps.
//!
//! ```text
//! R = F(u₀; bodies of the step) − F(u₀; bodies before)           at the start of the step
//! F(u; bodies of the step) − (1 − s) R = 0                       s: elapsed fraction of the step
//! ```
//!
//! A step that adds or removes bodies begins in the equilibrium of the one before, whatever the bodies exerted on the rest: internal
//! forces, contact, weight and other loads. The difference fades linearly to zero.
//!
//! Nodes that only absent bodies have are constrained where they are.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::Arc;

use nalgebra::Vector2;

use super::Model;
use super::element::{ElementError, SolidElement};
use super::in_force;
use super::pore_flow::WetElement;
use super::state::{Activations, State};
use super::step::Step;
use crate::contact::conduit::Conduit;
use crate::contact::{ContactPair, ContactState};

/// Share of its size in the mesh at a point of an element below which it does not come: other nodes have moved away from its own.
const LEAST_SHARE: f64 = 0.5;

/// Elements that came into a deformed model, by number.
#[derive(Clone, Debug, Default)]
#[doc(hidden)]
pub struct Activated {
    activations: Arc<Activations>,
    solids: BTreeMap<usize, SolidElement>,
    wet: BTreeMap<usize, WetElement>,
}

#[doc(hidden)]
impl Activated {
    /// Whether these are the ones that came at some displacements.
    pub fn are_of(&self, activations: &Arc<Activations>) -> bool {
        Arc::ptr_eq(&self.activations, activations) || self.activations == *activations
    }

    /// Whether an element is among them.
    pub fn contains(&self, element: usize) -> bool {
        self.solids.contains_key(&element)
    }

    /// An element that water flows through, as it came.
    pub fn wet<'b>(&'b self, given: &'b WetElement) -> &'b WetElement {
        self.wet.get(&given.element).unwrap_or(given)
    }
}

#[doc(hidden)]
impl Model {
    /// Whether bodies come or go.
    pub fn changes_bodies(&self) -> bool {
        self.steps.iter().any(|step| !step.absent.is_empty())
    }

    /// Nodes that only absent bodies have, ascending; of tied ones the original.
    pub fn idle_nodes(&self, absent: &[bool]) -> Vec<usize> {
        let mut is_idle = vec![false; self.mesh.nodes.len()];
        for is_absent in [true, false] {
            let bodies = self.bodies.iter().zip(absent).filter(|(_, absent)| **absent == is_absent);
            let nodes = bodies.flat_map(|(body, _)| self.ties.originals(body.nodes.iter().copied()));
            nodes.for_each(|node| is_idle[node] = is_absent);
        }
        (0..is_idle.len()).filter(|node| is_idle[*node]).collect()
    }

    /// The states of a contact at the start of the run.
    pub fn first_states(&self, pair: &ContactPair) -> Vec<ContactState> {
        match self.steps.first().is_none_or(|step| step.joins(pair)) {
            true => pair.initial_states(&self.mesh.undeformed()),
            false => pair.separated_states(),
        }
    }

    /// Next time after a given one at which the rates of a well jump, or, where water flows through bodies, the rate of a support or load;
    /// increments end there.
    pub fn next_corner(&self, step: &Step, after: f64) -> Option<f64> {
        let wells = self.contacts.iter().filter_map(|pair| pair.conduit.as_ref()).flat_map(Conduit::corners);
        let tables = self.flow.iter().flat_map(|_| step.corners());
        wells.chain(tables).filter(|corner| *corner > after + 16.0 * f64::EPSILON * corner.abs()).reduce(f64::min)
    }

    /// An element as it is in a state: without strain at the place where it came.
    pub fn solid(&self, state: &State, element: usize) -> Cow<'_, SolidElement> {
        let given = &self.solids[element];
        let activations = state.step_start.activations.get(&element);
        // Elements are checked when they come.
        activations
            .and_then(|activation| self.activated(element, activation).ok())
            .map_or(Cow::Borrowed(given), Cow::Owned)
    }

    /// An element that comes at displacements of its nodes.
    ///
    /// # Errors
    /// [`ElementError::Degenerate`] when it is inverted there.
    pub fn activated(&self, element: usize, activation: &[[f64; 2]]) -> Result<SolidElement, ElementError> {
        let activation = activation.iter().map(|u| Vector2::from(*u)).collect();
        self.solids[element].activated(self.mesh.section, &self.mesh.places(element), activation)
    }

    /// An element, as it came.
    pub fn as_activated<'m>(&'m self, activated: &'m Activated, element: usize) -> &'m SolidElement {
        activated.solids.get(&element).unwrap_or(&self.solids[element])
    }

    /// The elements that came into a deformed model, by number.
    pub fn activated_of(&self, activations: &Arc<Activations>) -> Arc<Activated> {
        let mut all = Activated { activations: activations.clone(), ..Activated::default() };
        for (&e, activation) in activations.iter() {
            let Ok(activated) = self.activated(e, activation) else { continue };
            all.wet.extend(self.activated_wet(e, activation, &activated).map(|wet| (e, wet)));
            all.solids.insert(e, activated);
        }
        Arc::new(all)
    }

    fn activated_wet(&self, element: usize, activation: &[[f64; 2]], activated: &SolidElement) -> Option<WetElement> {
        let activation = activation.iter().map(|u| Vector2::from(*u)).collect();
        self.flow.as_ref()?.wet(element)?.activated(activation, self.body_of(element), activated, &self.mesh)
    }

    /// An element that water flows through as it is in a state: by its shape where it came.
    pub fn wet<'m>(&self, state: &State, given: &'m WetElement) -> Cow<'m, WetElement> {
        let activated = state.step_start.activations.get(&given.element).and_then(|activation| {
            self.activated_wet(given.element, activation, &self.activated(given.element, activation).ok()?)
        });
        activated.map_or(Cow::Borrowed(given), Cow::Owned)
    }

    /// Lets the water of bodies that a step removes leave with them, while they are still what they were: pressures that no body has afterwards that
    /// was there before are those of the start.
    pub fn let_water_go(&self, step: &Step, state: &mut State) {
        let Some(flow) = &self.flow else { return };
        for (k, body) in flow.bodies.iter().enumerate().filter(|(_, body)| step.changed.contains(body)) {
            let stored = self.stored_water(*body, state).filter(|_| !step.has(*body));
            state.water.brought[k] -= stored.map_or(0.0, |[taken, _]| taken);
        }
        let mut stays = vec![false; flow.count()];
        for wet in &flow.elements {
            let body = self.body_of_element[wet.element];
            let there = step.has(body) && !step.changed.contains(&body);
            wet.pressures.iter().filter(|_| there).for_each(|&k| stays[k] = true);
        }
        let lone = (0..flow.count()).filter(|&k| !stays[k]);
        lone.for_each(|k| state.displacement[flow.dof(k)] = 0.0);
    }

    /// Lets bodies that a step adds come with their water.
    pub fn let_water_come(&self, step: &Step, state: &mut State) {
        let bodies = self.flow.iter().flat_map(|flow| flow.bodies.iter().enumerate());
        for (k, &body) in bodies.filter(|(_, body)| step.changed.contains(body) && step.has(**body)) {
            let [taken, excess] = self.stored_water(body, state).unwrap_or_default();
            state.water.brought[k] += taken;
            (state.water.excess[k], state.water.peaks[k]) = (excess, 0.0);
        }
    }

    /// Lets the elements of the bodies that a step adds come where their nodes are.
    ///
    /// # Errors
    /// Returns an element whose shape there is far from that in the mesh, with the least share of a point in its size.
    pub fn bear(&self, step: &Step, state: &mut State) -> Result<(), (usize, f64)> {
        let mut activations = Activations::clone(&state.step_start.activations);
        for &element in step.changed.iter().flat_map(|&body| &self.bodies[body].elements) {
            activations.remove(&element);
            let activation: Vec<[f64; 2]> =
                self.mesh.vectors(element, &state.displacement).into_iter().map(Into::into).collect();
            if !step.has(self.body_of_element[element]) || activation.iter().flatten().all(|u| *u == 0.0) {
                continue;
            }
            let volumes = self.solids[element].point_volumes();
            let least = self.activated(element, &activation).map_or(0.0, |activated| {
                let shares = activated.point_volumes().iter().zip(volumes).map(|(now, mesh)| now / mesh);
                shares.fold(f64::INFINITY, f64::min)
            });
            if least < LEAST_SHARE {
                return Err((element, least));
            }
            activations.insert(element, activation);
        }
        Arc::make_mut(&mut state.step_start).activations = Arc::new(activations);
        Ok(())
    }

    /// Takes the history from the bodies that a step adds or removes, and from their contacts.
    pub fn forget(&self, step: &Step, state: &mut State) {
        let initial = self.initial_memory();
        let memory = self.memories.each_mut(&mut state.memory).zip(self.memories.each(&initial));
        for ((own, initial), body) in memory.zip(&self.body_of_element) {
            if step.changed.contains(body) {
                own.copy_from_slice(initial);
            }
        }
        let comes = |pair: &&ContactPair| pair.comes_stressed && step.joins(pair) && step.changes(pair);
        let stressed = self.contacts.iter().filter(comes);
        let stresses: BTreeMap<String, _> =
            stressed.map(|pair| (pair.name.clone(), in_force::across(self, pair, step, state))).collect();
        let x = self.configuration(&state.displacement);
        for (pair, states) in self.contacts.iter().zip(&mut state.contacts) {
            if step.changes(pair) {
                *states = match step.joins(pair) {
                    true if pair.comes_stressed => {
                        pair.states_under(&stresses[&pair.name], [&self.mesh.undeformed(), &x], state.time)
                    }
                    true => pair.initial_states(&x),
                    false => pair.separated_states(),
                };
            }
        }
    }
}
