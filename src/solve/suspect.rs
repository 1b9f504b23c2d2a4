//! Who is to blame where no equilibrium was found: where forces are farthest from balance, and which stiffnesses are out of
//! proportion there.

use super::Workspace;
use super::failure::IncrementFailure;
use super::newton::NewtonFailure;
use crate::contact::master::Master;
use crate::contact::pair::ContactPair;
use crate::model::told::number;
use crate::model::{Body, Model, Step};

/// A penalty is this many times (λ + 2G)/h where it is suspected; 10 is the default.
const STIFF: f64 = 1e4;

/// Poisson's ratio from which elements that are integrated in full lock.
const LOCKS: f64 = 0.49;

/// What to say of a failure besides its cause: nothing where the cause says it all.
pub fn suspicion(model: &Model, step: &Step, work: &Workspace, cause: &IncrementFailure) -> String {
    let unbalanced = match cause {
        IncrementFailure::Newton(NewtonFailure::Evaluation(_)) | IncrementFailure::ContactLost(_) => None,
        IncrementFailure::Newton(NewtonFailure::Diverged { .. } | NewtonFailure::TooManyIterations { .. }) => {
            worst_node(model, step, &work.system.residual)
        }
        _ => return String::new(),
    };
    let contact = unbalanced.and_then(|node| model.contacts.iter().find(|pair| has(pair, node)));
    let place = unbalanced.map(|node| {
        let (tag, at) = (model.mesh.node_tags[node], model.mesh.nodes[node]);
        let owner = contact.map(|pair| format!(" of contact `{}`", pair.name)).or_else(|| {
            let bodies = model.bodies.iter().filter(|body| body.nodes.binary_search(&node).is_ok());
            let names: Vec<String> = bodies.map(|body| format!("`{}`", body.name)).collect();
            match &names[..] {
                [] => None,
                [body] => Some(format!(" of body {body}")),
                _ => Some(format!(" of bodies {}", names.join(" and "))),
            }
        });
        let owner = owner.unwrap_or_default();
        format!("the forces are farthest from balance at node {tag}{owner}, ({}, {})", number(at.x), number(at.y))
    });
    let penalties = model.contacts.iter().filter_map(penalty);
    let told = place.into_iter().chain(penalties).chain(model.bodies.iter().filter_map(|body| locking(model, body)));
    told.map(|told| format!("; {told}")).collect()
}

/// The free node with the largest force out of balance.
fn worst_node(model: &Model, step: &Step, residual: &[f64]) -> Option<usize> {
    let mut free = residual.to_vec();
    step.supports.iter().for_each(|support| free[support.at.dof] = 0.0);
    model.ties.pairs().iter().for_each(|&(copy, _)| free[2 * copy..2 * copy + 2].fill(0.0));
    model.linkage.followers.iter().flat_map(|follower| follower.dofs()).for_each(|(_, dof)| free[dof] = 0.0);
    model.linkage.rigid.iter().for_each(|[_, b]| free[2 * b + 1] = 0.0);
    let size = |node: &usize| free[2 * node].hypot(free[2 * node + 1]);
    let worst = (0..free.len() / 2).filter(|node| size(node).is_finite()).max_by(|a, b| size(a).total_cmp(&size(b)))?;
    (size(&worst) > 0.0).then_some(worst)
}

/// Whether a node is on one of the two sides of a contact.
fn has(pair: &ContactPair, node: usize) -> bool {
    let on_slave = pair.points.iter().any(|point| point.position.iter().any(|&(own, _)| own == node));
    let on_master = match &pair.master {
        Master::Mesh(surface) => surface.segments.iter().any(|segment| segment.nodes().any(|own| own == node)),
        Master::Rigid(_) => false,
    };
    on_slave || on_master
}

/// A penalty far above the stiffness of the bodies: their own forces are round-off beside those of contact.
fn penalty(pair: &ContactPair) -> Option<String> {
    let alpha_t = pair.laws.iter().map(|law| law.start().stiffness()).fold(0.0, f64::max);
    let (name, value) = if alpha_t > pair.alpha_n { ("alpha_t", alpha_t) } else { ("alpha_n", pair.alpha_n) };
    let times = value * pair.compliance;
    (times > STIFF).then(|| {
        format!(
            "{name} = {} of contact `{}` is {} times the stiffness (λ + 2G)/h of the elements behind it, where 10 is common: \
             lower it",
            number(value),
            pair.name,
            number(times.round())
        )
    })
}

fn locking(model: &Model, body: &Body) -> Option<String> {
    let [wave, shear] = [body.material.p_wave_modulus(), body.material.shear_modulus()];
    let poisson = (wave - 2.0 * shear) / (2.0 * (wave - shear));
    let locks = poisson >= LOCKS && body.elements.iter().any(|&element| !model.solids[element].is_f_bar());
    locks.then(|| {
        format!(
            "nu = {} of body `{}` is near 1/2, where its elements lock: give it \"element\": \"f_bar\" (Q4)",
            number(poisson),
            body.name
        )
    })
}
