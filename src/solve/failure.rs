//! Failures of an increment, and whether a smaller one may succeed.
//!
//! Likely causes of a failure to find equilibrium: the location of the largest residual, and disproportionate stiffnesses
//! there.

use nalgebra::Vector2;
use thiserror::Error;

use super::Workspace;
use super::newton::NewtonFailure;
use crate::contact::{ContactPair, SlavePoint};
use crate::equations::sums::TrialFailure;
use crate::equations::supports::free;
use crate::linear::LinearFailure;
use crate::mesh::configuration::Configuration;
use crate::model::builder::thickness::Outline;
use crate::model::element::Formulation;
use crate::model::text::{number, vector};
use crate::model::{Body, Method, Model, State, Step};

/// Reason why an increment failed; a smaller one may succeed.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum IncrementFailure {
    /// Newton's method found no equilibrium.
    #[error(transparent)]
    Newton(#[from] NewtonFailure<TrialFailure>),
    /// The mass matrix of the initial acceleration is singular.
    #[error("initial acceleration: {0}{hint}", hint = density_hint(.0))]
    Mass(LinearFailure),
    /// The state at the start of a dynamic step, or in an explicit increment, cannot be evaluated.
    #[error(transparent)]
    Start(TrialFailure),
    /// The augmented Lagrangian did not reach the allowed penetration.
    #[error(
        "the penetration is still too large after {passes} augmentations: raise alpha_n, or allow more penetration"
    )]
    Penetration {
        /// number of augmentations
        passes: usize,
    },
    /// The augmented Lagrangian did not reach the allowed elastic slip.
    #[error("the elastic slip is still too large after {passes} augmentations: raise alpha_t, or allow more (stick)")]
    ElasticSlip {
        /// number of augmentations
        passes: usize,
    },
    /// The velocities of an explicit run are no longer finite.
    #[error("the motion grows without bound: lower the `safety` of the explicit scheme, or check loads and supports")]
    Unbounded,
    /// An element collapsed in explicit increments of any allowed length.
    #[error(
        "{0}, with shorter increments as well: the mesh collapses there; strike or drive it more slowly, make it finer \
         or stiffer there, give the body viscosity (damping.stiffness), or a law that resists collapse (neo_hookean, \
         hencky)"
    )]
    Collapsed(TrialFailure),
    /// The bodies could not be condensed on an interface.
    #[error("the bodies cannot be condensed on the contacts: {0}; constrain every body by a support or a spring")]
    Interface(LinearFailure),
    /// The differential equations of an interface could not be integrated.
    #[error("contact `{contact}` at {}: {why}", vector([*x, *y]))]
    Slip {
        /// contact pair
        contact: String,
        /// x coordinate of the point
        x: f64,
        /// y coordinate of the point
        y: f64,
        /// description of the defect
        why: String,
    },
    /// A body is not constrained.
    #[error(
        "{0}; give it a support, a spring, or contact that is closed at the start, or `stabilize` the step (if it is \
         already: by more)"
    )]
    Floating(String),
    /// A bond that pulls has torn over much of a contact at once.
    #[error(
        "the bond of contact `{contact}` tears over {percent:.0} % of its length within one increment: the torn state \
         is in equilibrium too, but the run has not reached it step by step. If shorter increments do not help, the \
         bond ruptures at once: take a step with inertia, or `rupture`, or a longer `bond.opening` under a lower \
         `bond.tension`"
    )]
    Torn {
        /// contact pair
        contact: String,
        /// part of its length
        percent: f64,
    },
    /// Water that flows along a contact has no pressure.
    #[error("the water of contact `{contact}`: {why}")]
    Water {
        /// contact pair
        contact: String,
        /// description of the defect
        why: String,
    },
    /// A trial state lost the contact that constrained a body.
    #[error("contact was lost during the iterations: {0}")]
    ContactLost(String),
}

fn density_hint(cause: &LinearFailure) -> &'static str {
    if matches!(cause, LinearFailure::Singular(_)) { " (does every body have a density?)" } else { "" }
}

impl IncrementFailure {
    /// Whether shorter explicit increments may succeed: an element collapsed, or the motion diverged.
    #[doc(hidden)]
    pub fn is_collapse(&self) -> bool {
        use TrialFailure::{Crushed, Inverted, Material};
        matches!(self, Self::Unbounded | Self::Start(Inverted { .. } | Crushed { .. } | Material { .. }))
    }

    /// Returns the failure after shorter increments have not helped.
    #[doc(hidden)]
    pub fn after_all(self) -> Self {
        match self {
            Self::Start(failure) if Self::Start(failure.clone()).is_collapse() => Self::Collapsed(failure),
            other => other,
        }
    }

    /// Short name of the failure, for counting.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Newton(NewtonFailure::Evaluation(failure)) | Self::Start(failure) | Self::Collapsed(failure) => {
                kind_of_trial(failure)
            }
            Self::Newton(NewtonFailure::Linear(_)) | Self::Mass(_) | Self::Interface(_) => "singular equations",
            Self::Newton(NewtonFailure::Overflow) => "forces beyond double precision",
            Self::Newton(NewtonFailure::Diverged { .. }) => "divergence",
            Self::Newton(NewtonFailure::Circles { .. }) => "iterations in a circle",
            Self::Newton(NewtonFailure::Stalled { .. }) => "stalled iterations",
            Self::Newton(NewtonFailure::TooManyIterations { .. }) => "too many iterations",
            Self::Penetration { .. } => "penetration",
            Self::ElasticSlip { .. } => "elastic slip",
            Self::Unbounded => "unbounded motion",
            Self::Slip { .. } => "slip equations",
            Self::Floating(_) => "floating body",
            Self::ContactLost(_) => "contact lost",
            Self::Torn { .. } => "torn bond",
            Self::Water { .. } => "water",
        }
    }

    /// Whether a smaller increment may succeed.
    #[doc(hidden)]
    pub fn is_retryable(&self) -> bool {
        match self {
            Self::Newton(NewtonFailure::Linear(LinearFailure::TooLarge { .. })) => false,
            Self::Newton(_) | Self::Penetration { .. } | Self::ElasticSlip { .. } => true,
            Self::ContactLost(_) | Self::Torn { .. } | Self::Water { .. } => true,
            _ => false,
        }
    }
}

fn kind_of_trial(failure: &TrialFailure) -> &'static str {
    match failure {
        TrialFailure::Inverted { .. } => "element inverted",
        TrialFailure::Crushed { .. } => "element collapsed",
        TrialFailure::Narrow { .. } => "narrow place",
        TrialFailure::Material { .. } => "material law",
        TrialFailure::Friction { .. } => "friction law",
        TrialFailure::FluidPressure { .. } => "fluid pressure",
        TrialFailure::Undefined { .. } => "expression without a value",
    }
}

/// Ratio of a penalty to (λ + 2G)/h above which it is suspected; the default is 10.
const STIFF: f64 = 1e4;

/// Part of the largest residual from which on a corner is named [-]
const AT_CORNER: f64 = 0.05;

/// Edge over the thickness of a body behind it from which on the body bends rather than that it is sheared.
const THIN: f64 = 3.0;

/// Ratio of α_t to the bending stiffness of a thin body above which it is suspected, and the one that is advised: belts on drums run from 70
/// to 350, and above 1600 some stop.
const STIFF_TO_BEND: [f64; 2] = [200.0, 100.0];

/// Poisson's ratio above which fully integrated elements lock.
const LOCKS: f64 = 0.49;

/// Likely causes of a failure in addition to its message; empty if the message is sufficient.
pub fn suspicion(model: &Model, step: &Step, work: &Workspace, state: &State, cause: &IncrementFailure) -> String {
    let unbalanced = match cause {
        IncrementFailure::Newton(NewtonFailure::Evaluation(_)) | IncrementFailure::ContactLost(_) => None,
        IncrementFailure::Newton(failure) if failure.is_without_end() => worst_node(model, step, &work.system.residual),
        _ => return String::new(),
    };
    let contacts = || model.contacts.iter().filter(|pair| step.joins(pair));
    let bodies = || model.bodies.iter().enumerate().filter(|(k, _)| step.has(*k)).map(|(_, body)| body);
    let contact = unbalanced.and_then(|node| contacts().find(|pair| pair.nodes().any(|own| own == node)));
    let place = unbalanced.map(|node| {
        let (tag, at) = (model.mesh.node_tags[node], model.mesh.nodes[node]);
        let owner = contact.map(|pair| format!(" of contact `{}`", pair.name)).or_else(|| {
            let own = bodies().filter(|body| body.nodes.binary_search(&node).is_ok());
            let names: Vec<String> = own.map(|body| format!("`{}`", body.name)).collect();
            match &names[..] {
                [] => None,
                [body] => Some(format!(" of body {body}")),
                _ => Some(format!(" of bodies {}", names.join(" and "))),
            }
        });
        let owner = owner.unwrap_or_default();
        let corner = contact
            .and_then(|pair| corner(pair, node, &work.system.residual, &model.configuration(&state.displacement)));
        let corner = corner.map(|at| {
            format!(", at the corner ({}, {}) of its rigid master{}", number(at.x), number(at.y), met(model, contact))
        });
        format!(
            "largest residual at node {tag}{owner}, ({}, {}){}",
            number(at.x),
            number(at.y),
            corner.unwrap_or_default()
        )
    });
    let thin =
        unbalanced.map(|node| contacts().filter_map(|pair| softer_in_bending(model, pair, node)).collect::<Vec<_>>());
    let causes = place.into_iter().chain(contacts().filter_map(penalty)).chain(thin.into_iter().flatten());
    let causes = causes.chain(bodies().filter_map(|body| locking(model, body)));
    causes.map(|cause| format!("; {cause}")).collect()
}

/// Current place of the sharp corner of a rigid master where the slave is least in balance, if that is more than a part of the largest
/// residual: a point that jumps from one line to the other there sends its neighbours, or the rigid body, out of balance.
fn corner(pair: &ContactPair, node: usize, residual: &[f64], x: &Configuration) -> Option<Vector2<f64>> {
    let size = |node: usize| residual[2 * node].hypot(residual[2 * node + 1]);
    let own = pair.master.rigid_body().is_some_and(|body| body.nodes().contains(&node));
    let largest = if own { pair.slave_nodes().map(size).fold(0.0, f64::max) } else { size(node) };
    let at_corners = pair.slave_nodes().filter_map(|node| Some((size(node), pair.corner_at(node, x)?)));
    let (worst, at) = at_corners.max_by(|a, b| a.0.total_cmp(&b.0))?;
    (worst > AT_CORNER * largest).then_some(at)
}

/// What meets a corner of the rigid master of a contact.
fn met(model: &Model, contact: Option<&ContactPair>) -> &'static str {
    let own =
        model.contacts.iter().zip(&model.methods).find(|(pair, _)| contact.is_some_and(|own| own.name == pair.name));
    let by_points =
        own.and_then(|(_, chosen)| chosen.as_ref()).is_some_and(|chosen| chosen.method == Method::GaussToSegment);
    if by_points {
        ": round it off, by an edge"
    } else {
        ": take \"method\": \"gauss_to_segment\" there, or round it off"
    }
}

/// The free node with the largest residual force.
fn worst_node(model: &Model, step: &Step, residual: &[f64]) -> Option<usize> {
    let free = free(model, step, residual);
    let size = |node: &usize| free[2 * node].hypot(free[2 * node + 1]);
    let worst = (0..free.len() / 2).filter(|node| size(node).is_finite()).max_by(|a, b| size(a).total_cmp(&size(b)))?;
    (size(&worst) > 0.0).then_some(worst)
}

/// A penalty far above the stiffness of the bodies, whose forces then are below the round-off of contact forces.
fn penalty(pair: &ContactPair) -> Option<String> {
    let alpha_t = pair.laws.iter().map(|law| law.description.stiffness).fold(0.0, f64::max);
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
    let [wave, shear] = [body.material.description().p_wave_modulus, body.material.description().shear_modulus];
    let poisson = (wave - 2.0 * shear) / (2.0 * (wave - shear));
    let locks = poisson >= LOCKS
        && body.elements.iter().any(|&element| model.solids[element].formulation() == Formulation::Displacement);
    locks.then(|| {
        format!(
            "nu = {} of body `{}` is near 1/2, where its elements lock: give it \"element\": \"f_bar\" (Q4) or \"reduced\" (Q8)",
            number(poisson),
            body.name
        )
    })
}

/// A penalty along a surface far above the stiffness with which a thin body behind it bends: as an edge ℓ turns, the surface slips by half
/// the thickness t.
///
/// ```text
/// α_t ℓ (t/2)² / (E′ t³/12ℓ) = 3 α_t ℓ²/(E′ t),   E′ = E/(1 − ν²)
/// ```
fn softer_in_bending(model: &Model, pair: &ContactPair, node: usize) -> Option<String> {
    let alpha_t = pair.laws.iter().map(|law| law.description.stiffness).fold(0.0, f64::max);
    let [slave, master] = &pair.bodies;
    let is_of = |bodies: &[usize]| bodies.iter().any(|&body| model.bodies[body].nodes.binary_search(&node).is_ok());
    if pair.tied || !(pair.nodes().any(|own| own == node) || is_of(slave) || is_of(master)) {
        return None;
    }
    let (outline, x) = (Outline::new(&model.mesh), model.mesh.undeformed());
    let both = pair.both.as_ref()?;
    let bends = |(points, bodies): (&Vec<SlavePoint>, &Vec<usize>)| {
        let mut points = points.clone();
        outline.limit(&mut points, None);
        let shape = |point: &SlavePoint| Some((point.edge_length(&x)?, 2.0 * point.depth));
        let thin = points.iter().filter_map(shape).filter(|(edge, thickness)| *edge > THIN * thickness);
        let (edge, thickness) = thin.max_by(|a, b| (a.0 / a.1).total_cmp(&(b.0 / b.1)))?;
        let plate = |&body: &usize| {
            let law = model.bodies[body].material.description();
            4.0 * law.shear_modulus * (law.p_wave_modulus - law.shear_modulus) / law.p_wave_modulus
        };
        let modulus = bodies.iter().map(plate).min_by(f64::total_cmp)?;
        let times = 3.0 * alpha_t * edge * edge / (modulus * thickness);
        (times > STIFF_TO_BEND[0]).then_some((times, edge, thickness))
    };
    let sides = [(&both.own, slave), (&both.nodes, master)];
    let (times, edge, thickness) = sides.into_iter().filter_map(bends).max_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(format!(
        "alpha_t = {} of contact `{}` is {:.0} times the bending stiffness of a body behind it, which is {} thick, \
         with edges of {}: lower it, to {:.1e} say",
        number(alpha_t),
        pair.name,
        times,
        number(thickness),
        number(edge),
        alpha_t * STIFF_TO_BEND[1] / times
    ))
}
