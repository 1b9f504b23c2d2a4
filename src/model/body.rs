//! Bodies and point masses: their damping, and where each element finds what its material remembers.

use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::element::SolidElement;
use super::imposed::{InitialStress, Thermal};
use crate::laws::bulk::Material;

/// A body: a material on a group of elements.
#[derive(Debug)]
#[doc(hidden)]
pub struct Body {
    /// name of its group
    pub name: String,
    /// bulk law
    pub material: Arc<dyn Material>,
    /// damping in dynamic steps that say nothing else
    pub damping: Damping,
    /// stress at the start, if it has one
    pub initial_stress: Option<InitialStress>,
    /// thermal expansion, if it has one
    pub thermal: Option<Thermal>,
    /// its elements
    pub elements: Vec<usize>,
    /// its nodes, ascending
    pub nodes: Vec<usize>,
}

impl Body {
    /// Whether it has an initial stress, or expands when it is heated.
    pub fn is_imposed(&self) -> bool {
        self.initial_stress.is_some() || self.thermal.is_some()
    }
}

/// A mass at every node of a group.
#[derive(Clone, Debug, PartialEq)]
#[doc(hidden)]
pub struct PointMass {
    /// name of the group
    pub name: String,
    /// m of each node, the same in both directions [M]
    pub mass: f64,
    /// its nodes, ascending
    pub nodes: Vec<usize>,
}

/// Rayleigh damping. A vibration of angular frequency w decays with the damping ratio (mass/w + stiffness w)/2.
// C = η M + τ K, K being that of `laws::bulk`'s viscous stress.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
#[must_use]
pub struct Damping {
    /// Force per momentum: damps slow motions most, free flight included [1/T]
    pub mass: f64,
    /// Kelvin-Voigt: viscous stress, this time times the elastic stress of the rate of strain; damps fast vibrations most,
    /// and makes explicit increments shorter [T]
    #[serde(rename = "stiffness")]
    pub retardation: f64,
}

impl Damping {
    /// With a force per momentum [1/T].
    pub fn mass(self, mass: f64) -> Self {
        Self { mass, ..self }
    }

    /// With a viscous stress: this time times the elastic stress of the rate of strain [T].
    pub fn retardation(self, retardation: f64) -> Self {
        Self { retardation, ..self }
    }
}

/// The part of every element in [`State::memory`](super::state::State::memory): one behind the other in the elements' order, as long
/// as its points and variables ask for, and of no length where a material remembers nothing.
#[derive(Clone, Debug)]
#[doc(hidden)]
pub struct Memories {
    /// Start of each part, and end of the last one
    starts: Vec<usize>,
}

impl Memories {
    /// The memory layout of all elements, given the body of each.
    pub fn new(solids: &[SolidElement], bodies: &[Body], body_of_element: &[usize]) -> Self {
        let mut starts = vec![0];
        let mut end = 0;
        for (solid, &body) in solids.iter().zip(body_of_element) {
            end += solid.quadrature_points() * bodies[body].material.variables().len();
            starts.push(end);
        }
        Self { starts }
    }

    /// Number of values of all elements together.
    pub fn total(&self) -> usize {
        self.starts[self.starts.len() - 1]
    }

    /// The part of one element.
    pub fn of<'a>(&self, element: usize, memory: &'a [f64]) -> &'a [f64] {
        &memory[self.starts[element]..self.starts[element + 1]]
    }

    /// The parts of all elements in their order, to be written over. Whoever wants some of them passes over the others: no part can
    /// be handed to the wrong one.
    pub fn each_mut<'a>(&'a self, memory: &'a mut [f64]) -> impl Iterator<Item = &'a mut [f64]> {
        let mut rest = memory;
        self.starts.windows(2).map(move |ends| {
            let (own, after) = std::mem::take(&mut rest).split_at_mut(ends[1] - ends[0]);
            rest = after;
            own
        })
    }
}
