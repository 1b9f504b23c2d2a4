//! Water of the bodies on both sides of a contact: its pressure acts between the surfaces, and it flows across.
//!
//! ```text
//! t = (p + p_w) n − q s                        p closes and rubs: the effective pressure                        (1)
//! p_w: mean of p_s and p_m                     of the sides whose water flows;   p_s = Σ w_a p_a over the slave's nodes, p_m alike
//! ΔV = g ℓ − (g ℓ)_n                           water that has come between the surfaces                         (2)
//! Q = κ ℓ (p_s − p_m)                          water that flows across, per time                                (3)
//! r_a = −s_a (∂p_w/∂p_a ΔV + Δt/β ∂(p_s − p_m)/∂p_a Q)          in the balance of a pressure                   (4)
//! ```
//! The forces of p_w and (4) are derivatives of −p_w g ℓ: where normals and lengths do not change the coupling is symmetric. A node in the
//! middle of an edge has the mean pressure of its ends. Open surfaces are filled with water, whose volume is that of the gap.
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
use super::point::Weights;
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
    /// What passes through an element beside the contact, at most [L³/(F T)]
    pub beside: f64,
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
        self.conductance.min(self.beside)
    }

    /// The water at a point with these weights of x_s − x_m, and the nodes of its pressures; `seeps` is ℓ Δt/β.
    pub(super) fn meet(&self, weights: &[(usize, f64)], x: &Configuration, seeps: f64) -> (Between, Vec<usize>) {
        let mut behind: Vec<usize> = self.behind(weights.iter().map(|(node, _)| *node)).collect();
        behind.sort_unstable();
        behind.dedup();
        let count = 2 * behind.len();
        let local = |dof: usize| 2 * behind.binary_search(&(dof / 2)).unwrap_or_default() + dof % 2;
        let pores = weights.iter().filter_map(|(node, w)| {
            let (side, parts) = self.nodes.get(node)?;
            Some((*side, &parts[..], if *side == 0 { *w } else { -w }))
        });
        let along = weights.iter().filter_map(|(node, w)| Some((2, std::slice::from_ref(self.channel.get(node)?), *w)));
        let mut water = Between {
            scales: vec![0.0; count],
            shares: std::array::from_fn(|_| vec![0.0; count]),
            ..Between::default()
        };
        let mut wet = [false; 3];
        for (place, parts, weight) in pores.chain(along) {
            wet[place] = true;
            water.pressures[place] += weight * pressure(parts, x);
            for part in parts {
                water.scales[local(part.dof)] = part.scale;
                water.shares[place][local(part.dof)] += weight * part.share;
            }
        }
        let sides = f64::from(u8::from(wet[0]) + u8::from(wet[1])).max(1.0);
        water.means = if wet[2] { [0.0, 0.0, 1.0] } else { wet.map(|wet| f64::from(u8::from(wet)) / sides) };
        // Where water flows along the contact, it comes from one body to the other through that.
        water.passes = ACROSS.map(|places| {
            let passes = places.iter().all(|place| wet[*place]) && places.contains(&2) == wet[2];
            if passes { seeps * self.conductance } else { 0.0 }
        });
        (water, behind)
    }

    /// p_w at a point with these kinematics [F/L²].
    pub(super) fn pressure(&self, k: &Kinematics, x: &Configuration) -> f64 {
        let weights: Weights = k.nodes.iter().copied().zip(k.relative.iter().copied()).collect();
        self.meet(&weights, x, 0.0).0.pressure()
    }
}

/// Pressure that parts make up [F/L²].
fn pressure(parts: &[PressurePart], x: &Configuration) -> f64 {
    parts.iter().map(|part| part.share * (part.initial + part.scale * x.displacement(part.dof / 2)[part.dof % 2])).sum()
}
