//! What the tractions of a contact put on the nodes, and their resultant on the slave.

use std::collections::BTreeSet;

use nalgebra::Vector2;

use super::closed::nodal_forces;
use super::kinematics::{Kinematics, kinematics};
use super::pair::ContactPair;
use super::point::Weights;
use super::search::Index;
use super::state::ContactState;
use crate::mesh::configuration::Configuration;

/// Force and moment that the master puts on the slave.
///
/// ```text
/// F = Σ_j t_j ℓ_j,   M = Σ_j (x_j − x₀) × t_j ℓ_j,   t = p n − (q + η v) s
/// ```
/// What slip radiates, η v, is a traction of the surfaces like friction, 0 without radiation damping. The pressure p_w of a fluid is
/// a load, and left out.
///
/// Of rings F_x sums up the radial parts of the full turn, and M is that of the section.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Resultant {
    /// F [F]
    pub force: Vector2<f64>,
    /// M about x₀, counter-clockwise [F·L]
    pub moment: f64,
}

/// A closed point: where its traction acts on the slave, and the kinematics that say on which nodes.
struct Acting {
    point: usize,
    place: Weights,
    kinematics: Kinematics,
}

impl ContactPair {
    /// x₀: the middle of the slave surface in the configuration `x`, the undeformed one if moments are to be about a point
    /// that stays.
    pub fn middle(&self, x: &Configuration) -> Vector2<f64> {
        let Some(first) = self.points.first().map(|point| point.at(x)) else { return Vector2::zeros() };
        let shares = self.points.iter().map(|point| (point.current_length(x), point.at(x) - first));
        let (length, sum) =
            shares.fold((0.0, Vector2::zeros()), |(all, sum), (length, at)| (all + length, sum + at * length));
        first + sum / length
    }

    /// What accepted tractions put on the nodes of both sides in the configuration `x` where they were accepted [F].
    pub fn forces_on_nodes(&self, states: &[ContactState], x: &Configuration) -> Vec<(usize, Vector2<f64>)> {
        let acting = self.acting(states, x);
        let forces = acting.iter().flat_map(|acting| {
            let [pressure, traction] = states[acting.point].tractions();
            nodal_forces(&acting.kinematics, pressure, traction)
        });
        forces.collect()
    }

    /// What they put on the slave, the moment about a point.
    pub fn resultant(&self, states: &[ContactState], x: &Configuration, about: Vector2<f64>) -> Resultant {
        let mut sum = Resultant::default();
        for Acting { point, place, kinematics: k } in self.acting(states, x) {
            let [pressure, traction] = states[point].tractions();
            let force = (k.normal * pressure - k.tangent * traction) * k.length;
            let [reference, displacement] = x.apart(&place, about);
            sum.force += force;
            sum.moment += (reference + displacement).perp(&force);
        }
        sum
    }

    /// The closed points.
    fn acting(&self, states: &[ContactState], x: &Configuration) -> Vec<Acting> {
        let closed: Vec<usize> = (0..states.len()).filter(|&k| states[k].friction.pressure > 0.0).collect();
        if closed.is_empty() {
            return Vec::new();
        }
        if self.small.is_some() || self.mortar.is_some() {
            let mut met = self.meetings(x, false);
            let acting = |k: usize| met[k].take().map(|(_, kinematics)| (k, kinematics));
            let found: Vec<(usize, Kinematics)> = closed.into_iter().filter_map(acting).collect();
            let place = |(point, kinematics): (usize, Kinematics)| {
                let place = if self.mortar.is_some() {
                    self.mean_place(&kinematics)
                } else {
                    self.points[point].position.clone()
                };
                Acting { point, place, kinematics }
            };
            return found.into_iter().map(place).collect();
        }
        let index = Index::new(&self.master, x);
        let acting = |point: usize| {
            let slave = &self.points[point];
            let projection = index.project(slave, states[point].foot, x)?;
            let mut k = Kinematics::new(false);
            kinematics(slave, &self.master, &projection, None, x, &mut k);
            Some(Acting { point, place: slave.position.clone(), kinematics: k })
        };
        closed.into_iter().filter_map(acting).collect()
    }

    /// Where the mean of the slave lies that a mortar point stands for: the slave's part of its weights.
    fn mean_place(&self, k: &Kinematics) -> Weights {
        let slaves = self.points.iter().flat_map(|point| &point.length).flat_map(|share| &share.at);
        let slaves: BTreeSet<usize> = slaves.map(|(node, _)| *node).collect();
        let meets_itself = self.meets_itself();
        let own = |(&node, &w): (&usize, &f64)| {
            let is_slave = if meets_itself { w > 0.0 } else { slaves.contains(&node) };
            is_slave.then_some((node, w))
        };
        k.nodes.iter().zip(&k.relative).filter_map(own).collect()
    }

    fn meets_itself(&self) -> bool {
        matches!(&self.master, super::master::Master::Mesh(surface) if surface.own_depth.is_some())
    }
}
