//! Nodal weights of a load on a side or a body.

use std::collections::BTreeMap;

use nalgebra::{Matrix2, Vector2};

use super::error::{Checked, ModelError};
use crate::mesh::{Edge, Mesh, shape};
use crate::model::Model;
use crate::model::boundary::Absorber;

/// A node, its weight, and the reference position at which the load is evaluated.
pub type Share = (usize, f64, Vector2<f64>);

/// Consistent nodal weights of a traction: ∫ N_a w |X'| dξ at the Gauss points.
pub fn edge_shares(mesh: &Mesh, edges: &[Edge]) -> Vec<Share> {
    along_edges(mesh, edges, |along| along.norm())
}

/// Weights of a pressure along x and y: −∫ N_a w n̂ |X'| dξ with n̂ |X'| = (X'_y, −X'_x) out of the body, on the left of its
/// edges.
pub fn pressure_shares(mesh: &Mesh, edges: &[Edge]) -> [Vec<Share>; 2] {
    [along_edges(mesh, edges, |along| -along.y), along_edges(mesh, edges, |along| along.x)]
}

/// Weights of a total force on edges as a uniform traction: those of a traction divided by ∫ w |X'| dξ.
pub fn even_shares(mesh: &Mesh, edges: &[Edge]) -> Vec<Share> {
    let shares = edge_shares(mesh, edges);
    let total: f64 = shares.iter().map(|(_, share, _)| share).sum();
    shares.into_iter().map(|(node, share, position)| (node, share / total, position)).collect()
}

/// ∫ N_a w f(X') dξ at the Gauss points.
fn along_edges(mesh: &Mesh, edges: &[Edge], f: impl Fn(Vector2<f64>) -> f64) -> Vec<Share> {
    let mut shares = Vec::new();
    for Edge { nodes, .. } in edges {
        for (xi, weight) in shape::gauss(nodes.len()) {
            let values = shape::edge_values(nodes.len(), xi);
            let slopes = shape::edge_derivatives(nodes.len(), xi);
            let sum = |weights: &[f64]| {
                nodes.iter().zip(weights).map(|(&node, w)| mesh.nodes[node] * *w).sum::<Vector2<f64>>()
            };
            let position = sum(&values);
            let stretch = f(sum(&slopes)) * mesh.section.weight(position);
            shares.extend(nodes.iter().zip(&values).map(|(&node, n)| (node, weight * n * stretch, position)));
        }
    }
    shares
}

/// Nodal weights of a force per mass on a body, ∫ ρ N_a dV, and on point masses.
pub fn mass_shares(model: &Model, name: &str, place: &str) -> Checked<Vec<Share>> {
    let body = model.bodies.iter().find(|body| body.name == name);
    let points = model.point_masses.iter().find(|point| point.name == name);
    match (body, points) {
        (Some(body), None) if body.material.description().density == 0.0 => {
            let message = format!("gravity needs a mass: give bodies.{name}.material.density");
            return Err(ModelError::new(place, message));
        }
        (None, None) => {
            let bodies = model.bodies.iter().map(|body| body.name.as_str());
            let known: Vec<&str> = bodies.chain(model.point_masses.iter().map(|point| point.name.as_str())).collect();
            let known = if known.is_empty() { "none at all".into() } else { known.join(", ") };
            let message = format!("there is no body or point mass `{name}`, on which gravity acts; there are {known}");
            return Err(ModelError::new(place, message));
        }
        _ => {}
    }
    let mut shares = Vec::new();
    for &e in body.iter().flat_map(|body| &body.elements) {
        let masses = model.element_mass(e);
        // Row sum: ∫ ρ N_a dV.
        let share = |(a, &node): (usize, &usize)| (node, masses.row(a).sum(), model.mesh.nodes[node]);
        shares.extend(model.mesh.elements[e].nodes.iter().enumerate().map(share));
    }
    if let Some(point) = points {
        shares.extend(point.nodes.iter().map(|&node| (node, point.mass, model.mesh.nodes[node])));
    }
    Ok(shares)
}

/// Nodal parts of an absorbing side.
pub fn absorbers(model: &Model, edges: &[Edge]) -> Vec<Absorber> {
    let mut total: BTreeMap<usize, Matrix2<f64>> = BTreeMap::new();
    for Edge { nodes, element } in edges {
        let material = &*model.bodies[model.body_of_element[*element]].material;
        let density = material.description().density;
        let impedance = |modulus: f64| (modulus * density).sqrt();
        for (xi, weight) in shape::gauss(nodes.len()) {
            let values = shape::edge_values(nodes.len(), xi);
            let slopes = shape::edge_derivatives(nodes.len(), xi);
            let along: Vector2<f64> = nodes.iter().zip(&slopes).map(|(&node, w)| model.mesh.nodes[node] * *w).sum();
            let place = nodes.iter().zip(&values).map(|(&node, n)| model.mesh.nodes[node] * *n).sum();
            let depth = model.mesh.section.weight(place);
            let s = along.normalize();
            let n = Vector2::new(s.y, -s.x);
            let resistance = n * n.transpose() * impedance(material.description().p_wave_modulus)
                + s * s.transpose() * impedance(material.description().shear_modulus);
            for (&node, value) in nodes.iter().zip(values) {
                *total.entry(node).or_default() += resistance * (weight * value * along.norm() * depth);
            }
        }
    }
    total.into_iter().map(|(node, coefficients)| Absorber { node, coefficients }).collect()
}
