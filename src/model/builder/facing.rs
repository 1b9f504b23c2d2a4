//! Bodies of a contact that face each other.
//!
//! Either side of a contact may go on where the other never comes, on bodies that are nothing to it: what a contact takes from the bodies
//! of its slave is taken from those that own the slave's edges nearest to an edge of the master in the mesh, and what it takes from the
//! bodies of the master from those whose edges are nearest to an edge of these. In contact of a surface with itself every part may meet
//! every other, and all count, and so do all bodies of a slave before a rigid master.

use nalgebra::Vector2;

use super::contact::Contact;
use super::error::Checked;
use super::groups::edges;
use crate::mesh::Edge;
use crate::model::Model;

/// Difference of two distances, as a fraction of the edge that they start from, below which both edges are nearest.
const EQUALLY_NEAR: f64 = 1e-6;

/// Edges of a contact on the bodies that face each other.
pub struct Facing<'a> {
    pub slave: Vec<&'a Edge>,
    /// None of a rigid master
    pub master: Vec<&'a Edge>,
}

impl<'a> Facing<'a> {
    /// Those of the edges of both groups of a contact.
    pub fn of(contact: &Contact, slave: &'a [Edge], master: &'a [Edge], model: &Model) -> Self {
        let [slave, master] = [slave, master].map(|side| side.iter().collect::<Vec<_>>());
        if contact.is_own() || master.is_empty() {
            return Self { slave, master };
        }
        let slave = nearest(&master, slave, model);
        let master = nearest(&slave, master, model);
        Self { slave, master }
    }
}

/// The other edges, of the bodies that own those nearest to the edges of one side.
fn nearest<'a>(side: &[&Edge], other: Vec<&'a Edge>, model: &Model) -> Vec<&'a Edge> {
    let body = |edge: &Edge| model.body_of_element[edge.element];
    if other.windows(2).all(|pair| body(pair[0]) == body(pair[1])) {
        return other;
    }
    let ends = |edge: &Edge| [0, 1].map(|end| model.mesh.nodes[edge.nodes[end]]);
    let placed: Vec<_> = other.iter().map(|edge| (body(edge), ends(edge))).collect();
    let mut faced = vec![false; model.bodies.len()];
    for own in side.iter().map(|edge| ends(edge)) {
        let distances: Vec<f64> = placed.iter().map(|(_, other)| distance(own, *other)).collect();
        let least = distances.iter().copied().fold(f64::INFINITY, f64::min);
        let near = least + EQUALLY_NEAR * (own[1] - own[0]).norm();
        let all = placed.iter().zip(&distances).filter(|(_, distance)| **distance <= near);
        all.for_each(|((body, _), _)| faced[*body] = true);
    }
    other.into_iter().filter(|edge| faced[body(edge)]).collect()
}

/// Distance of two straight edges [L].
fn distance(one: [Vector2<f64>; 2], other: [Vector2<f64>; 2]) -> f64 {
    let side = |[a, b]: [Vector2<f64>; 2], point: Vector2<f64>| (b - a).perp(&(point - a));
    let parted = |edge, [a, b]: [Vector2<f64>; 2]| side(edge, a) * side(edge, b) >= 0.0;
    if !parted(one, other) && !parted(other, one) {
        return 0.0;
    }
    let from = |[a, b]: [Vector2<f64>; 2], point: Vector2<f64>| {
        let way = b - a;
        let share = (way.dot(&(point - a)) / way.norm_squared()).clamp(0.0, 1.0);
        (point - a - share * way).norm()
    };
    let ends = other.map(|point| from(one, point)).into_iter().chain(one.map(|point| from(other, point)));
    ends.fold(f64::INFINITY, f64::min)
}

/// Edges of a contact on the bodies that face each other.
pub fn facing<'a>(place: &str, contact: &Contact, model: &'a Model) -> Checked<Facing<'a>> {
    let slave = edges(&model.mesh, &contact.slave, &format!("{place}.slave"))?;
    let master = contact.master_group().map(|group| edges(&model.mesh, group, &format!("{place}.master")));
    Ok(Facing::of(contact, slave, master.transpose()?.unwrap_or_default(), model))
}
