//! Why the equations have no value at a trial state.

use thiserror::Error;

use crate::laws::bulk::InvertedElement;
use crate::laws::friction::LawFailure;
use crate::model::Model;
use crate::model::scheme::told;
use crate::model::told::number;

/// Why the equations could not be evaluated at a trial state.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum TrialFailure {
    /// An element has no volume left.
    #[error(
        "element {element} of body `{body}` is turned inside out (J = {jacobian:.3e}) at ({}, {})", number(at[0]), number(at[1])
    )]
    Inverted {
        /// its tag in the mesh file
        element: u64,
        /// its body
        body: String,
        /// its centre in the mesh
        at: [f64; 2],
        /// det F
        jacobian: f64,
    },
    /// An element has hardly any volume left.
    #[error(
        "element {element} of body `{body}` is crushed to {share:.1e} of its size at ({}, {})", number(at[0]), number(at[1])
    )]
    Crushed {
        /// its tag in the mesh file
        element: u64,
        /// its body
        body: String,
        /// its centre in the mesh
        at: [f64; 2],
        /// what is left of its size
        share: f64,
    },
    /// A friction law could not answer.
    #[error("contact `{contact}`, point {point}: {cause}")]
    Friction {
        /// contact pair
        contact: String,
        /// slave point
        point: usize,
        /// what the law said
        cause: LawFailure,
    },
    /// A fluid pulls, or has no finite pressure.
    #[error(
        "contact `{contact}`: its fluid_pressure is {pressure} at ({}, {}) and time {}: it must be a finite number, zero or positive",
        at[0], at[1], told(*time)
    )]
    FluidPressure {
        /// contact pair
        contact: String,
        /// reference position of the slave point
        at: [f64; 2],
        /// p_w
        pressure: f64,
        /// run time
        time: f64,
    },
    /// A support or load expression has no finite value.
    #[error("a support or load at node {node} is not a finite number at time {}: check its expression", told(*time))]
    Undefined {
        /// its tag in the mesh file
        node: u64,
        /// run time
        time: f64,
    },
}

impl TrialFailure {
    /// The failure of an element, with the names of its file.
    pub fn inverted(model: &Model, e: usize, InvertedElement { jacobian }: InvertedElement) -> Self {
        let (element, body, at) = named(model, e);
        Self::Inverted { element, body, at, jacobian }
    }

    /// An element of which only a share of its size is left.
    pub fn crushed(model: &Model, e: usize, share: f64) -> Self {
        let (element, body, at) = named(model, e);
        Self::Crushed { element, body, at, share }
    }
}

/// Tag, body and centre of an element.
fn named(model: &Model, e: usize) -> (u64, String, [f64; 2]) {
    let nodes = &model.mesh.elements[e].nodes;
    let centre = [0, 1].map(|i| nodes.iter().map(|&node| model.mesh.nodes[node][i]).sum::<f64>() / nodes.len() as f64);
    (model.mesh.element_tags[e], model.bodies[model.body_of_element[e]].name.clone(), centre)
}
