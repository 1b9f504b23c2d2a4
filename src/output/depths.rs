//! Warnings about rigid masters inside bodies, between the points at which contact is evaluated.

use nalgebra::Vector2;

use crate::contact::depth::{Depth, Inside};
use crate::contact::master::{Master, Rigid, Shape};
use crate::contact::pair::ContactPair;
use crate::mesh::configuration::Configuration;
use crate::model::text::apart;

/// Smallest reported depth, as a fraction of the slave's edge.
const DEEP: f64 = 0.05;

/// The deepest place of a rigid master and the slave in each other, with a warning, if it is deep.
pub fn rigid_inside(pair: &ContactPair, x: &Configuration) -> Option<(Vector2<f64>, String)> {
    let Master::Rigid(Rigid { shape, .. }) = &pair.master else { return None };
    let Depth { what, at, depth, edge } = pair.deepest(x).filter(|deepest| deepest.depth > DEEP * deepest.edge)?;
    let refined = "take shorter edges there, or round the corner off by an edge";
    let (what, remedy) = match (what, shape) {
        (Inside::SlaveNode, _) => {
            ("a slave node is inside the rigid master", "take shorter edges there, or raise alpha_n".into())
        }
        (Inside::Disk, Shape::Circle(circle)) => {
            let [radius, edge] = apart([circle.radius, edge]);
            let remedy = format!("edges of {edge} do not see a radius of {radius}: take edges of a fifth of it");
            ("the rigid disk is inside the slave, between its points,", remedy)
        }
        _ => ("a corner of the rigid master is inside the slave", refined.into()),
    };
    Some((at, format!("{what} by {depth:.3e}, {:.1} % of its edge; {remedy}", 100.0 * depth / edge)))
}
