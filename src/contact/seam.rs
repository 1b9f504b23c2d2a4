//! Water of the bodies on both sides of a contact: its pressure acts between the surfaces, and it flows across.
//!
//! ```text
//! t = (p + p_w) n − q s                        p closes and rubs: the effective pressure                        (1)
//! p_w = p₀ − (p_s − p_m)/2                     p_s = Σ w_a p_a over the slave's nodes, p_m alike; p₀ at the point itself; of the sides whose water flows
//! ΔV = g ℓ − (g ℓ)_n                           water that has come between the surfaces                         (2)
//! Q = κ ℓ (p_s − p_m)                          water that flows across, per time                                (3)
//! r_a = −s_a (∂p_w/∂p_a ΔV + Δt/β ∂(p_s − p_m)/∂p_a Q)          in the balance of a pressure                   (4)
//! ```
//! The forces of p_w and (4) are derivatives of −p_w g ℓ: where normals and lengths do not change the coupling is symmetric. A node in the
//! middle of an edge has the mean pressure of its ends. Mortar takes p_s and p_m, as it takes the gap, as means around a point; p₀ is that of the slave
//! at the point, and what is linear along the surface is exactly so in (1), up to its ends. Open surfaces are filled with water, whose volume is that of the gap.
//!
//! Surfaces that part may drain to a place outside, of the pressure p̄, and are filled from there. From each side flows
//!
//! ```text
//! Q = κ_d(g − d) ℓ (p − p̄),   κ_d(w) ∝ min(w, w₀)³                             as a crack drains to its mouth           (4a)
//! ```
//! κ_d grows from 0 with the gap that is solved for, so that a pressure which lifts the surfaces has one opening that lets it out, and p is continuous in
//! time. Its derivative by g makes the tangent unsymmetric.
//!
//! Where water flows along the contact it has a pressure of its own, p_c, linear or quadratic between the nodes of the slave:
//!
//! ```text
//! p_w = p_c;   Q_s = κ ℓ (p_c − p_s),   Q_m = κ ℓ (p_c − p_m)                  into the bodies, in place of (3)                  (5)
//! ```
//!
//! The weights w_a, and ℓ in (3), are those of the start of the increment, as the permeability and the place of what flows through bodies are: κ is
//! so large that the motion of the weights within an increment would govern its convergence. A point that faced nothing then has the water
//! of its own side alone.

use std::collections::BTreeMap;

use super::between::{ACROSS, Between};
use super::kinematics::Kinematics;
use super::point::{SlavePoint, Weights};
use crate::mesh::configuration::Configuration;

/// Water on both sides of a contact.
#[derive(Clone, Debug, PartialEq)]
pub struct Seam {
    /// Side of each node, 0 of the slave, and the pressures that it is made of; nodes of sides without flowing water are left out
    pub nodes: BTreeMap<usize, (usize, Vec<PressurePart>)>,
    /// Pressure of every node of the slave along which water flows
    pub channel: BTreeMap<usize, PressurePart>,
    /// κ between two sides whose water flows, or between what flows along the contact and each of them; 0 beside any other [L³/(F T)]
    pub conductance: f64,
    /// Where surfaces that are apart drain
    pub open: Option<Drained>,
    /// What passes through an element beside the contact, at most [L³/(F T)]
    pub most_by_element: f64,
    /// Rise of p_w per closure at most, were the water trapped: ∂p_w/∂p_a times the area of a corner over what its pores take up, of both sides [F/L³]
    pub trapped: f64,
}

/// The place outside to which surfaces that are apart drain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drained {
    /// p̄ [F/L²]
    pub pressure: f64,
    /// κ_d from the opening w on [L³/(F T)]
    pub conductance: f64,
    /// w, up to which it grows with the third power of the opening [L]
    pub aperture: f64,
    /// Its number among the outlets of the model
    pub outlet: usize,
}

impl Drained {
    /// κ_d of an opening, and its derivative by it [L³/(F T)], [L²/(F T)].
    pub(super) fn at(&self, opening: f64) -> [f64; 2] {
        let share = (opening / self.aperture).max(0.0);
        if share >= 1.0 {
            return [self.conductance, 0.0];
        }
        [self.conductance * share.powi(3), 3.0 * self.conductance * share.powi(2) / self.aperture]
    }
}

/// Part of the pressure of a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PressurePart {
    /// dof of the pressure
    pub dof: usize,
    /// p at the start [F/L²]
    pub initial: f64,
    /// p − p₀ by the dof [F/L³]
    pub scale: f64,
    /// share in the pressure of the node
    pub share: f64,
}

impl Seam {
    /// Nodes that stand for the pressures of some nodes.
    pub fn behind<'a>(&'a self, nodes: impl Iterator<Item = usize> + 'a) -> impl Iterator<Item = usize> + 'a {
        nodes.flat_map(|node| {
            let pores = self.nodes.get(&node).into_iter().flat_map(|(_, parts)| parts);
            pores.chain(self.channel.get(&node)).map(|part| part.dof / 2)
        })
    }

    /// Nodes that stand for all its pressures, possibly repeated.
    pub fn all_behind(&self) -> impl Iterator<Item = usize> + '_ {
        self.behind(self.nodes.keys().chain(self.channel.keys()).copied())
    }

    /// Most that passes into the bodies per length from what flows along the contact [L³/(F T)].
    pub fn most(&self) -> f64 {
        self.conductance.min(self.most_by_element)
    }

    /// The water at a point of the slave with these weights of x_s − x_m, and the nodes of its pressures; `seeps` is ℓ Δt/β.
    pub(super) fn meet(
        &self,
        slave: &SlavePoint,
        weights: &[(usize, f64)],
        x: &Configuration,
        seeps: f64,
    ) -> (Between, Vec<usize>) {
        let own = &slave.position;
        let mut behind: Vec<usize> = self.behind(weights.iter().chain(own).map(|(node, _)| *node)).collect();
        behind.sort_unstable();
        behind.dedup();
        let count = 2 * behind.len();
        let local = |dof: usize| 2 * behind.binary_search(&(dof / 2)).unwrap_or_default() + dof % 2;
        let pores = weights.iter().filter_map(|(node, w)| {
            let (side, parts) = self.nodes.get(node)?;
            Some((*side, &parts[..], if *side == 0 { *w } else { -w }))
        });
        let along = |node: &usize| self.channel.get(node).map(std::slice::from_ref);
        let between = weights.iter().filter_map(|(node, w)| Some((2, along(node)?, *w)));
        let of_slave = |node: &usize| self.nodes.get(node).map(|(_, parts)| &parts[..]);
        let at_point = own.iter().filter_map(|(node, w)| Some((3, along(node).or_else(|| of_slave(node))?, *w)));
        let mut water = Between {
            scales: vec![0.0; count],
            shares: std::array::from_fn(|_| vec![0.0; count]),
            ..Between::default()
        };
        let mut wet = [false; 4];
        for (place, parts, weight) in pores.chain(between).chain(at_point) {
            wet[place] = true;
            water.pressures[place] += weight * pressure(parts, x);
            for part in parts {
                water.scales[local(part.dof)] = part.scale;
                water.shares[place][local(part.dof)] += weight * part.share;
            }
        }
        water.means = match wet {
            [true, true, false, _] => [-0.5, 0.5, 0.0, 1.0],
            [false, true, false, _] => [0.0, 1.0, 0.0, 0.0],
            _ => [0.0, 0.0, 0.0, 1.0],
        };
        water.sides = [wet[0], wet[1]];
        // Where water flows along the contact, it comes from one body to the other through that.
        water.passes = ACROSS.map(|places| {
            let passes = places.iter().all(|place| wet[*place]) && places.contains(&2) == wet[2];
            if passes { seeps * self.conductance } else { 0.0 }
        });
        (water, behind)
    }

    /// p_w at a point of the slave with these kinematics [F/L²].
    pub(super) fn pressure(&self, slave: &SlavePoint, k: &Kinematics, x: &Configuration) -> f64 {
        let weights: Weights = k.nodes.iter().copied().zip(k.relative.iter().copied()).collect();
        self.meet(slave, &weights, x, 0.0).0.pressure()
    }
}

/// Pressure that parts make up [F/L²].
fn pressure(parts: &[PressurePart], x: &Configuration) -> f64 {
    parts.iter().map(|part| part.share * (part.initial + part.scale * x.displacement(part.dof / 2)[part.dof % 2])).sum()
}
