//! Rigid-body motion of bodies: momentum, center of mass, rotation.
//!
//! ```text
//! P = ∫ ρ v dV                                    momentum
//! c = C + ∫ ρ u dV/m                              centre of mass; C where it was
//! L = ∫ ρ (x − c) × v dV                          angular momentum about the centre of mass
//! tan θ = ∫ ρ (X − C) × (x − c) dV / ∫ ρ (X − C)·(x − c) dV      mean rotation: that of the rigid body nearest to it
//! ```
//! Integrals use the consistent mass of the body's elements, with the mass moved away from massless nodes; P and L after
//! explicit increments use the lumped masses, which conserve them. Point masses do not belong to the body. A body without
//! density has the centre of its volume. In axisymmetry the integrals cover the full turn: x components are sums of radial
//! parts, c_x is the mean radius, and L and θ refer to the section only.

use nalgebra::Vector2;

use crate::mesh::configuration::vector;
use crate::model::{Body, Model, State};

/// Constants of a body for its mean values.
#[derive(Clone, Debug)]
pub struct BodyMeans {
    density: f64,
    /// ∫ N_a N_b dV of its nodes, a ≤ b; none without density, where nothing asks for them
    pairs: Vec<(usize, usize, f64)>,
    shares: Vec<Share>,
    centre: Vector2<f64>,
    /// ∫ |X − C|² dV
    inertia: f64,
}

/// Contribution of one node to the means of a body.
#[derive(Clone, Debug)]
struct Share {
    node: usize,
    /// ∫ N_a dV, and its share of the body's volume
    volume: f64,
    share: f64,
    /// ∫ N_a (X − C) dV
    moment: Vector2<f64>,
    /// Volume of the lumped mass, and its share
    lumped: f64,
    lumped_share: f64,
}

/// Momentum, centre of mass and rotation of a body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// P [M L/T]
    pub momentum: Vector2<f64>,
    /// L [M L²/T]
    pub angular_momentum: f64,
    /// c [L]
    pub centre: Vector2<f64>,
    /// θ between −π and π [rad]
    pub rotation: f64,
}

impl BodyMeans {
    /// Weights for the means over a body of a model.
    pub fn new(model: &Model, body: &Body) -> Self {
        let place = |node: usize| model.mesh.nodes[node];
        let origin = body.nodes.first().map_or_else(Vector2::zeros, |&node| place(node));
        let mut lengths = vec![(0.0, Vector2::zeros(), 0.0); body.nodes.len()];
        let local = |node: &usize| body.nodes.binary_search(node).unwrap_or(0);
        let density = body.material.description().density;
        let mut pairs = Vec::new();
        for &element in &body.elements {
            let (nodes, matrix) = (&model.mesh.elements[element].nodes, model.element_volumes(element));
            if density > 0.0 {
                let both = |a: usize| (0..nodes.len()).map(move |b| (a, b));
                let ordered = (0..nodes.len()).flat_map(both).filter(|&(a, b)| nodes[a] <= nodes[b]);
                pairs.extend(ordered.map(|(a, b)| (nodes[a], nodes[b], matrix[(a, b)])));
            }
            let lumped = model.element_lumped_volumes(element);
            for (a, node) in nodes.iter().enumerate() {
                let (volume, moment, concentrated) = &mut lengths[local(node)];
                *concentrated += lumped[a];
                for (b, other) in nodes.iter().enumerate() {
                    *volume += matrix[(a, b)];
                    *moment += (place(*other) - origin) * matrix[(a, b)];
                }
            }
        }
        let all: f64 = lengths.iter().map(|(volume, ..)| volume).sum();
        let moment: Vector2<f64> = lengths.iter().map(|(_, moment, _)| moment).sum();
        let from_origin = moment / all;
        let share = |(&node, (volume, moment, lumped)): (&usize, (f64, Vector2<f64>, f64))| {
            let moment = moment - from_origin * volume;
            Share { node, volume, share: volume / all, moment, lumped, lumped_share: lumped / all }
        };
        let shares: Vec<Share> = body.nodes.iter().zip(lengths).map(share).collect();
        let pairs = summed(pairs);
        let inertia = shares.iter().map(|share| share.moment.dot(&(place(share.node) - origin - from_origin))).sum();
        Self { density, pairs, shares, centre: origin + from_origin, inertia }
    }

    /// Motion of the body in a state.
    pub fn motion(&self, model: &Model, state: &State) -> Motion {
        let is_lumped = state.is_of_explicit();
        let (mut shift, mut momentum, mut lumped_centre) = (Vector2::zeros(), Vector2::zeros(), Vector2::zeros());
        let (mut turned, mut stayed) = (0.0, self.inertia);
        for &Share { node, volume, share, moment, lumped, lumped_share } in &self.shares {
            let u = vector(&state.displacement, node);
            shift += u * share;
            lumped_centre += ((model.mesh.nodes[node] - self.centre) + u) * lumped_share;
            momentum += vector(&state.velocity, node) * (self.density * if is_lumped { lumped } else { volume });
            turned += moment.perp(&u);
            stayed += moment.dot(&u);
        }
        let mut angular_momentum = 0.0;
        if self.density > 0.0 && state.velocity.iter().any(|v| *v != 0.0) {
            let place =
                |node: usize| (model.mesh.nodes[node] - self.centre) + (vector(&state.displacement, node) - shift);
            // The centre of lumped masses follows from their positions.
            let centre = if is_lumped { lumped_centre - shift } else { Vector2::zeros() };
            let spin = |a: usize, b: usize| (place(a) - centre).perp(&vector(&state.velocity, b));
            let volumes: f64 = if is_lumped {
                self.shares.iter().map(|share| share.lumped * spin(share.node, share.node)).sum()
            } else {
                let of = |a, b| if a == b { spin(a, a) } else { spin(a, b) + spin(b, a) };
                self.pairs.iter().map(|&(a, b, shared)| shared * of(a, b)).sum()
            };
            angular_momentum = self.density * volumes;
        }
        Motion { momentum, angular_momentum, centre: self.centre + shift, rotation: f64::atan2(turned, stayed) }
    }
}

/// Sums entries of equal pairs, so that each pair has one.
fn summed(mut pairs: Vec<(usize, usize, f64)>) -> Vec<(usize, usize, f64)> {
    pairs.sort_by_key(|&(a, b, _)| (a, b));
    let entry = |entries: &[(usize, usize, f64)]| {
        (entries[0].0, entries[0].1, entries.iter().map(|(_, _, shared)| shared).sum())
    };
    pairs.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)).map(entry).collect()
}
