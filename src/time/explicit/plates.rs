//! Plates of which one component is alike, and rigid ones, in explicit increments.
//!
//! ```text
//! Σ m_c a = −Σ f_c                              alike in one component; m_c: lumped masses
//! ```
//!
//! The masses of a plate are no smaller than those of its nodes by themselves: the bound of the increment holds.

use nalgebra::Vector2;

use super::rigid::Rigid;
use crate::equations::damping::NodeDamper;
use crate::model::state::State;
use crate::model::support::Direction;
use crate::model::{Model, Step};

/// All plates of a model but those that move as one.
#[derive(Clone)]
pub(super) struct Plates {
    alike: Vec<Alike>,
    rigid: Vec<Rigid>,
    /// Whether a node is one of them; empty if there are none
    members: Vec<bool>,
}

/// A plate of which one component is alike.
#[derive(Clone)]
struct Alike {
    /// Its nodes, the first of which leads
    nodes: Vec<usize>,
    component: usize,
    /// Σ m [M]
    mass: f64,
    /// v and a of the component
    rates: [f64; 2],
}

impl Plates {
    /// Those of a model in a step, with the lumped mass of every node.
    pub fn new(model: &Model, step: &Step, mass: &[f64]) -> Self {
        let linkage = &model.linkage;
        let alike = linkage.plates.iter().filter(|(_, [x, y])| x != y).map(|(nodes, components)| Alike {
            nodes: nodes.clone(),
            component: usize::from(components[1]),
            mass: nodes.iter().map(|&node| mass[node]).sum(),
            rates: [0.0; 2],
        });
        let rigid = linkage.rigid.iter().map(|&leaders| Rigid::new(model, step, mass, leaders));
        let mut members = vec![false; if linkage.plates.is_empty() { 0 } else { mass.len() }];
        linkage.plates.iter().flat_map(|(nodes, _)| nodes).for_each(|&node| members[node] = true);
        Self { alike: alike.collect(), rigid: rigid.collect(), members }
    }

    /// Whether a node is one of them.
    pub fn has(&self, node: usize) -> bool {
        self.members.get(node).is_some_and(|member| *member)
    }

    /// (7): where rigid plates are turned to in `dt`, R and all other plates being where they go already.
    pub fn turn(&self, model: &Model, dt: f64, state: &State, u: &mut [f64]) {
        self.rigid.iter().for_each(|plate| plate.turn(dt, state, u));
        model.linkage.spread(u);
    }

    /// The first half of (8): take note of v½.
    pub fn begin(&mut self, dt: f64, state: &State) {
        for plate in &mut self.alike {
            let [v, a] = [&state.velocity, &state.acceleration].map(|values| values[plate.leader()]);
            plate.rates = [v + 0.5 * dt * a, a];
        }
        self.rigid.iter_mut().for_each(|plate| plate.begin(dt, state));
    }

    /// The rest of (8) at the displacement `u` under the gathered forces, where supports accelerate as told.
    pub fn accelerate(
        &mut self,
        (model, dt): (&Model, f64),
        (u, force): (&[f64], &[f64]),
        supported: impl Fn(usize) -> f64,
        state: &mut State,
    ) {
        for plate in &mut self.alike {
            let a = -force[plate.leader()] / plate.mass;
            plate.rates = [plate.rates[0] + 0.5 * dt * a, a];
        }
        self.rigid.iter_mut().for_each(|plate| plate.accelerate(dt, (u, force), &supported));
        self.tell(model, u, state);
    }

    /// (8) for the dampers of plates: see [`super::Explicit::damp`].
    pub fn damp(
        &mut self,
        (model, dt): (&Model, f64),
        (dampers, pulls): (&[NodeDamper], &[Vector2<f64>]),
        (u, mass): (&[f64], &[f64]),
        state: &mut State,
    ) {
        if dampers.is_empty() || self.members.is_empty() {
            return;
        }
        let mut own: Vec<(f64, f64)> = self.alike.iter().map(|plate| (plate.mass, 0.0)).collect();
        for (NodeDamper { node, coefficients }, pull) in dampers.iter().zip(pulls).filter(|(at, _)| self.has(at.node)) {
            let plates = [0, 1].map(|i| self.alike.iter().position(|plate| plate.leads(*node, i)));
            // What an absorbing side couples of the two components is with the pull alone.
            for i in (0..2).filter(|_| plates != [None; 2]) {
                let resisting = 0.5 * dt * coefficients[(i, i)];
                match plates[i] {
                    Some(k) => own[k] = (own[k].0 + resisting, own[k].1 + pull[i]),
                    None => {
                        let acceleration = pull[i] / (mass[*node] + resisting);
                        state.acceleration[2 * node + i] += acceleration;
                        state.velocity[2 * node + i] += 0.5 * dt * acceleration;
                    }
                }
            }
        }
        for (plate, (inertia, pull)) in self.alike.iter_mut().zip(own) {
            plate.rates = [plate.rates[0] + 0.5 * dt * pull / inertia, plate.rates[1] + pull / inertia];
        }
        self.rigid.iter_mut().for_each(|plate| plate.damp(dt, (dampers, pulls), u));
        self.tell(model, u, state);
    }

    /// Give leaders and all other nodes of plates the rates found.
    fn tell(&self, model: &Model, u: &[f64], state: &mut State) {
        for plate in &self.alike {
            (state.velocity[plate.leader()], state.acceleration[plate.leader()]) = (plate.rates[0], plate.rates[1]);
        }
        self.rigid.iter().for_each(|plate| plate.tell(u, state));
        self.spread(model, u, state);
    }

    /// Give all nodes of plates the rates of their leaders.
    pub fn spread(&self, model: &Model, u: &[f64], state: &mut State) {
        self.rigid.iter().for_each(|plate| plate.spread(u, state));
        model.linkage.spread(&mut state.velocity);
        model.linkage.spread(&mut state.acceleration);
    }

    /// F + M a of a direction in which a support holds a plate.
    pub fn reaction(&self, at: Direction, force: &[f64], acceleration: &[f64]) -> Option<f64> {
        if let Some(plate) = self.rigid.iter().find(|plate| plate.leaders[0] == at.node()) {
            return Some(plate.reaction(at, force, acceleration));
        }
        // Their other component is the node's own.
        let plate = self.alike.iter().find(|plate| plate.leader() == at.dof)?;
        Some(at.of(force) + plate.mass * at.of(acceleration))
    }

    /// What ½ v₋ᵀ M v₊ counts too little, node by node: the pull to the center of what turns does no work [F·L].
    pub fn turning_energy(&self, state: &State, dt: f64) -> f64 {
        self.rigid.iter().map(|plate| plate.turning_energy(state, dt)).sum()
    }
}

impl Alike {
    fn leader(&self) -> usize {
        2 * self.nodes[0] + self.component
    }

    /// Whether a component of a node is its.
    fn leads(&self, node: usize, component: usize) -> bool {
        component == self.component && self.nodes.binary_search(&node).is_ok()
    }
}
