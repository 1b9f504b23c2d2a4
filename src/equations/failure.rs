//! Why the equations have no value at a trial state.

use thiserror::Error;

use crate::laws::bulk::InvertedElement;
use crate::laws::friction::LawFailure;
use crate::model::Model;
use crate::model::scheme::told;

/// Why the equations could not be evaluated at a trial state.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum TrialFailure {
    /// An element has no volume left.
    #[error("element {element} of body `{body}` is turned inside out (J = {jacobian:.3e})")]
    Inverted {
        /// its tag in the mesh file
        element: u64,
        /// its body
        body: String,
        /// det F
        jacobian: f64,
    },
    /// An element has hardly any volume left.
    #[error("element {element} of body `{body}` is crushed to {share:.1e} of its size")]
    Crushed {
        /// its tag in the mesh file
        element: u64,
        /// its body
        body: String,
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
    pub fn inverted(model: &Model, element: usize, InvertedElement { jacobian }: InvertedElement) -> Self {
        let body = model.bodies[model.body_of_element[element]].name.clone();
        Self::Inverted { element: model.mesh.element_tags[element], body, jacobian }
    }
}
