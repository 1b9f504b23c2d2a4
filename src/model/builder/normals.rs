//! The normals of a side at its nodes, in the undeformed body.
//!
//! ```text
//! n_a = ∫ N_a n dS / |∫ N_a n dS|
//! ```
//!
//! so that u·n_a = 0 at all nodes lets no volume through the side. Where edges meet at a corner, a node has the normals of both.
//!
//! Source: Engelman, Sani & Gresho (1982), Int. J. Numer. Meth. Fluids 2, 225.

use std::collections::BTreeMap;

use nalgebra::Vector2;

use super::error::{Checked, ModelError};
use super::groups::{Place, edges};
use super::inclined::CORNER;
use super::shares::pressure_shares;
use crate::mesh::Edge;
use crate::model::Model;

/// Unit normals out of the body, node by node; the sides of a periodic model share those of their nodes.
pub fn normals(model: &Model, on: &Place, place: &str) -> Checked<impl Iterator<Item = (usize, Vector2<f64>)>> {
    let Place::Group(name) = on else {
        return Err(ModelError::new(
            place,
            format!("{on} has no side and no normal: name a group of edges, or give along and u"),
        ));
    };
    let edges = edges(&model.mesh, name, place)?;
    let mut at_node: BTreeMap<(usize, usize), Vec<Vector2<f64>>> = BTreeMap::new();
    for edge in edges {
        for (node, area) in areas(model, edge) {
            // The nodes of a plate have normals of their own.
            let on_plate = model.plates.iter().any(|plate| plate.binary_search(&node).is_ok());
            let original = model.ties.original(node);
            at_node.entry((original, if on_plate { node } else { original })).or_default().push(area);
        }
    }
    let of_node = |((node, _), areas): (_, Vec<Vector2<f64>>)| merged(&areas).into_iter().map(move |n| (node, n));
    Ok(at_node.into_iter().flat_map(of_node))
}

/// ∫ N_a n dS of an edge, node by node. On the axis, where a ring has no area, it is that beside the axis.
fn areas(model: &Model, edge: &Edge) -> Vec<(usize, Vector2<f64>)> {
    let [x, y] = pressure_shares(&model.mesh, std::slice::from_ref(edge));
    edge.nodes
        .iter()
        .map(|&node| {
            let sum = |shares: &[(usize, f64, Vector2<f64>)]| -> f64 {
                shares.iter().filter(|share| share.0 == node).map(|share| -share.1).sum()
            };
            (node, Vector2::new(sum(&x), sum(&y)))
        })
        .collect()
}

/// Normals of a node from the areas of its edges: one, unless they meet at a corner.
fn merged(areas: &[Vector2<f64>]) -> Vec<Vector2<f64>> {
    let mut sums: Vec<Vector2<f64>> = Vec::new();
    for area in areas.iter().filter(|area| area.norm() > 0.0) {
        let bent = |sum: &Vector2<f64>| sum.angle(area).to_degrees() < CORNER;
        match sums.iter_mut().find(|sum| bent(sum)) {
            Some(sum) => *sum += area,
            None => sums.push(*area),
        }
    }
    sums.into_iter().map(|sum| sum.normalize()).collect()
}
