//! Elements that do not fit their body.

use std::collections::HashMap;

use super::text::{count, number};
use crate::laws::bulk::Flow;
use crate::mesh::shape::ElementKind;
use crate::model::element::Formulation;
use crate::model::{Body, Model};

/// Warnings about elements.
pub fn concerns(model: &Model) -> Vec<String> {
    let lock = model.bodies.iter().filter_map(|body| Some((body, locks(model, body)?)));
    // f_bar is not for bodies whose water flows.
    let remedy = |(body, message): (&Body, String)| match body.flowing() {
        Some(_) => message.replace("Q4 with \"element\": \"f_bar\", ", ""),
        None => message,
    };
    lock.map(remedy).chain(alone(model)).collect()
}

/// Elements that lock where their body yields: plastic flow says how the volume changes at every integration point, which is more than
/// the nodes of these elements can follow. In a plate the thickness is free to.
///
/// Source: Nagtegaal, Parks & Rice (1974), Comput. Methods Appl. Mech. Eng. 4, 153, doi:10.1016/0045-7825(74)90032-2.
fn locks(model: &Model, body: &Body) -> Option<String> {
    let undrained = body.trapped().is_some();
    let flow = if undrained { Some(Flow::Isochoric) } else { body.material.description().flow };
    // An element alone has a few ways to strain, which its nodes can follow.
    let flow = flow.filter(|_| !model.mesh.section.is_plate() && body.elements.len() > 1)?;
    let flow = match flow {
        Flow::DilatingBelow(pressure) if least_pressure(model, body) >= pressure => Flow::Contracting,
        Flow::DilatingBelow(_) => Flow::Dilating,
        flow => flow,
    };
    let is_unfit = |e: &&usize| match (model.mesh.elements[**e].kind, model.solids[**e].formulation(), flow) {
        (ElementKind::T6, ..) | (_, Formulation::Reduced, _) => false,
        (_, Formulation::FBar, flow) => flow == Flow::Dilating,
        _ => true,
    };
    let unfit: Vec<usize> = body.elements.iter().filter(is_unfit).copied().collect();
    let first = *unfit.first()?;
    let mut kinds: Vec<String> = unfit.iter().map(|&e| format!("{:?}", model.mesh.elements[e].kind)).collect();
    kinds.sort_unstable();
    kinds.dedup();
    let (kinds, name) = (kinds.join(", "), &body.name);
    if undrained {
        return Some(format!(
            "body `{name}`: its elements ({kinds}) lock, as the fluid in its pores keeps its volume from the start: take Q4 with \"element\": \
             \"f_bar\", Q8 with \"element\": \"reduced\", or T6"
        ));
    }
    Some(match (model.solids[first].formulation(), flow) {
        (Formulation::FBar, _) => format!(
            "body `{name}`: it dilates where it yields, which f_bar cures in part only: limit loads come out some 10 % too high; take Q8 with \
             \"element\": \"reduced\", or T6"
        ),
        (_, Flow::Isochoric | Flow::Contracting) => format!(
            "body `{name}`: its elements ({kinds}) lock where it yields, and limit loads come out up to a third too high: take Q4 with \
             \"element\": \"f_bar\", Q8 with \"element\": \"reduced\", or T6"
        ),
        _ => format!(
            "body `{name}`: its elements ({kinds}) lock where it yields and dilates, and limit loads come out up to two thirds too high: take \
             Q8 with \"element\": \"reduced\", or T6"
        ),
    })
}

/// Least pressure of the initial effective stress of a body [F/L²].
fn least_pressure(model: &Model, body: &Body) -> f64 {
    let Some(stress) = &body.initial_stress else { return f64::NEG_INFINITY };
    let pressure = |at| {
        let [xx, yy, _, zz] = stress.at(at, model.mesh.section.is_plate());
        -(xx + yy + zz) / 3.0
    };
    let places = body.elements.iter().flat_map(|&element| model.quadrature_positions(element));
    places.map(pressure).fold(f64::INFINITY, f64::min)
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
    let body = &model.body_of(first).name;
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
