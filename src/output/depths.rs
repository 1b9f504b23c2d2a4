//! Warnings about surfaces deep in each other: at the points of a contact by its penalty, and rigid masters inside bodies between them.

use nalgebra::Vector2;

use crate::contact::depth::{Depth, Inside};
use crate::contact::master::{Master, Rigid, Shape};
use crate::contact::{ContactPair, ContactState, SlavePoint};
use crate::mesh::configuration::Configuration;
use crate::model::text::distinct;

/// Smallest reported depth of a single place, as a fraction of the slave's edge.
const DEEP: f64 = 0.05;
/// Smallest reported mean of the penetrations of a contact's points, as fractions of their edges.
const DEEP_IN_THE_MEAN: f64 = 0.01;

/// The deepest closed point of a contact with a warning, if it is deep, or all are in the mean Σ F d/h / Σ F of penetrations d over edges h,
/// by the normal forces F of the points. At the corner of a block, where the elastic pressure is singular, no penalty makes d small.
pub fn penetrates(pair: &ContactPair, states: &[ContactState], x: &Configuration) -> Option<(Vector2<f64>, String)> {
    let closed = pair.points.iter().zip(states).filter(|(_, state)| state.is_closed());
    let (mut force, mut sum) = (0.0, 0.0);
    let mut deepest: Option<(f64, &SlavePoint, f64)> = None;
    for (point, state) in closed {
        let Some(edge) = point.edge_length(x) else { continue };
        let share = -state.clearance() / edge;
        let own = state.friction.pressure * state.length;
        (force, sum) = (force + own, sum + own * share);
        if deepest.is_none_or(|(most, ..)| share > most) {
            deepest = Some((share, point, -state.clearance()));
        }
    }
    let (share, point, depth) = deepest?;
    (share > DEEP || sum > DEEP_IN_THE_MEAN * force).then(|| {
        let percent = 100.0 * share;
        (point.at(x), format!("the penetration {depth:.3e} is {percent:.1} % of the slave's edge; raise alpha_n"))
    })
}

/// The deepest place of a rigid master and the slave in each other, with a warning, if it is deep.
pub fn rigid_inside(pair: &ContactPair, x: &Configuration) -> Option<(Vector2<f64>, String)> {
    let Master::Rigid(Rigid { shape, .. }) = &pair.master else { return None };
    let Depth { what, at, depth, edge } = pair.deepest(x).filter(|deepest| deepest.depth > DEEP * deepest.edge)?;
    let rounded = "sliding past it meets too much resistance; round the corner off over one edge, or take shorter \
        edges there";
    let (what, remedy) = match (what, shape) {
        (Inside::SlaveNode, _) => {
            ("a slave node is inside the rigid master", "take shorter edges there, or raise alpha_n".into())
        }
        (Inside::Disk, Shape::Circle(circle)) => {
            let [radius, edge] = distinct([circle.radius, edge]);
            let remedy = format!("edges of {edge} do not resolve a radius of {radius}: take edges of a fifth of it");
            ("the rigid disk is inside the slave, between its points,", remedy)
        }
        _ => ("a corner of the rigid master is inside the slave", rounded.into()),
    };
    Some((at, format!("{what} by {depth:.3e}, {:.1} % of its edge; {remedy}", 100.0 * depth / edge)))
}
