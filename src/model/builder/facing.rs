//! What of its master a slave faces.
//!
//! The master of a contact may go on where the slave never comes, on bodies that are nothing to it: what a contact takes from the bodies
//! of its master is taken from those that own the master's edges nearest to an edge of the slave in the mesh. In contact of a surface with
//! itself every part may meet every other, and all count.

use nalgebra::Vector2;

use super::contact::Contact;
use crate::mesh::Edge;
use crate::model::Model;

/// Difference of two distances, as a fraction of the slave's edge, below which both edges are nearest.
const EQUALLY_NEAR: f64 = 1e-6;

/// Edges of the master on the bodies that the slave faces.
pub fn faced<'a>(contact: &Contact, slave: &[Edge], master: &'a [Edge], model: &Model) -> Vec<&'a Edge> {
    let body = |edge: &Edge| model.body_of_element[edge.element];
    let several = master.windows(2).any(|pair| body(&pair[0]) != body(&pair[1]));
    let mut faced = vec![!several || contact.is_own(); model.bodies.len()];
    if several {
        let ends = |edge: &Edge| [0, 1].map(|end| model.mesh.nodes[edge.nodes[end]]);
        let master: Vec<_> = master.iter().map(|edge| (body(edge), ends(edge))).collect();
        for own in slave.iter().map(ends) {
            let distances: Vec<f64> = master.iter().map(|(_, other)| distance(own, *other)).collect();
            let nearest = distances.iter().copied().fold(f64::INFINITY, f64::min);
            let near = nearest + EQUALLY_NEAR * (own[1] - own[0]).norm();
            let all = master.iter().zip(&distances).filter(|(_, distance)| **distance <= near);
            all.for_each(|((body, _), _)| faced[*body] = true);
        }
    }
    master.iter().filter(|edge| faced[body(edge)]).collect()
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
