//! Bodies and point masses.

use super::damping::Damping;
use super::imposed::{InitialStress, Thermal};
use crate::laws::bulk::Material;

/// A body: a material on a group of elements.
#[derive(Debug)]
pub struct Body {
    /// name of its group
    pub name: String,
    /// bulk law
    pub material: Box<dyn Material>,
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
pub struct PointMass {
    /// name of the group
    pub name: String,
    /// m of each node, the same in both directions [M]
    pub mass: f64,
    /// its nodes, ascending
    pub nodes: Vec<usize>,
}
