//! Elements that do not fit their body.

use std::collections::HashMap;

use super::text::{count, number};
use crate::model::Model;
use crate::model::element::Formulation;

/// Warnings about elements.
pub fn concerns(model: &Model) -> Vec<String> {
    alone(model).into_iter().collect()
}

/// An element with reduced integration bends into an hourglass without forces unless an edge holds it: one that it shares with another
/// element.
fn alone(model: &Model) -> Option<String> {
    let elements = &model.mesh.elements;
    if model.solids.iter().all(|solid| solid.formulation() != Formulation::Reduced) {
        return None;
    }
    let edges = |e: usize| {
        let (kind, nodes) = (elements[e].kind, &elements[e].nodes);
        (0..kind.corners()).map(move |edge| {
            let [a, b] = kind.edge(edge).0.map(|corner| nodes[corner]);
            [a.min(b), a.max(b)]
        })
    };
    let mut times: HashMap<[usize; 2], usize> = HashMap::new();
    (0..elements.len()).flat_map(edges).for_each(|edge| *times.entry(edge).or_default() += 1);
    let is_alone =
        |e: &usize| model.solids[*e].formulation() == Formulation::Reduced && edges(*e).all(|edge| times[&edge] == 1);
    let lonely: Vec<usize> = (0..elements.len()).filter(is_alone).collect();
    let &first = lonely.first()?;
    let body = &model.bodies[model.body_of_element[first]].name;
    let [x, y] = [0, 1].map(|k| {
        let nodes = &elements[first].nodes;
        number(nodes.iter().map(|&node| model.mesh.nodes[node][k]).sum::<f64>() / nodes.len() as f64)
    });
    Some(format!(
        "body `{body}`: {} of reduced integration without an edge in common with another, as at ({x}, {y}): it can bend into an hourglass without \
         forces, so divide it, or leave out \"element\": \"reduced\"",
        count(lonely.len(), "element")
    ))
}
