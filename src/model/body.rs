//! Bodies and point masses: their damping, and the layout of the internal variables of their elements.

use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::element::SolidElement;
use super::imposed::{InitialStress, PoreFluid, PorePressure, Thermal};
use crate::laws::bulk::Material;

/// A body: a material on a group of elements.
#[derive(Debug)]
#[doc(hidden)]
pub struct Body {
    /// name of its group
    pub name: String,
    /// bulk law
    pub material: Arc<dyn Material>,
    /// the law of the skeleton, if it remembers nothing but the pressure of water that flows, which then acts with its balances
    pub skeleton: Option<Arc<dyn Material>>,
    /// damping in dynamic steps that do not specify another
    pub damping: Damping,
    /// initial stress, if any
    pub initial_stress: Option<InitialStress>,
    /// fluid in its pores, if any
    pub pore_fluid: Option<PoreFluid>,
    /// pressure given in its pores, if any
    pub pore_pressure: Option<PorePressure>,
    /// whether that acts at the start
    pub starts_pressed: bool,
    /// thermal expansion, if any
    pub thermal: Option<Thermal>,
    /// elements
    pub elements: Vec<usize>,
    /// nodes, ascending
    pub nodes: Vec<usize>,
}

impl Body {
    /// The law by which its elements answer to their deformation alone.
    pub fn law_of_elements(&self) -> &dyn Material {
        self.skeleton.as_deref().unwrap_or(&*self.material)
    }

    /// The fluid in its pores, if it flows.
    pub fn flowing(&self) -> Option<&PoreFluid> {
        self.pore_fluid.as_ref().filter(|fluid| fluid.flows())
    }

    /// The fluid in its pores, if it cannot flow.
    pub fn trapped(&self) -> Option<&PoreFluid> {
        self.pore_fluid.as_ref().filter(|fluid| !fluid.flows())
    }

    /// Whether it has an initial stress, a pore fluid or pressure, or thermal expansion.
    pub fn is_imposed(&self) -> bool {
        self.is_stressed() || self.thermal.is_some() || self.pore_pressure.is_some() || self.pore_fluid.is_some()
    }

    /// Whether it has an initial stress, or a pore fluid or a pressure at the start, which is one.
    pub fn is_stressed(&self) -> bool {
        self.initial_stress.is_some() || self.trapped().is_some() || self.starts_pressed
    }
}

/// A point mass at every node of a group.
#[derive(Clone, Debug, PartialEq)]
#[doc(hidden)]
pub struct PointMass {
    /// name of the group
    pub name: String,
    /// m of each node, the same in both directions [M]
    pub mass: f64,
    /// nodes, ascending
    pub nodes: Vec<usize>,
}

/// Rayleigh damping. A vibration of angular frequency w decays with the damping ratio (mass/w + stiffness w)/2.
// C = η M + τ K, K being that of `laws::bulk`'s viscous stress.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct Damping {
    /// Force per momentum: damps slow motions most, free flight included [1/T]
    pub mass: f64,
    /// Kelvin-Voigt damping: retardation time by which the elastic stress of the strain rate is multiplied to give the viscous
    /// stress; damps high frequencies most, and shortens explicit increments [T]
    #[serde(rename = "stiffness")]
    pub retardation: f64,
}

setters! { damping: Damping;
    /// Sets the mass-proportional damping [1/T].
    mass(mass: f64) { damping.mass = mass; }

    /// Sets the retardation time of the viscous stress [T].
    retardation(retardation: f64) { damping.retardation = retardation; }
}

/// Layout of [`State::memory`](super::state::State::memory): the internal variables of all elements in sequence, of zero length
/// for materials without any.
#[derive(Clone, Debug)]
#[doc(hidden)]
pub struct Memories {
    /// Start of each part, and end of the last one
    starts: Vec<usize>,
}

impl Memories {
    /// Creates the layout for all elements, given the body of each.
    pub fn new(solids: &[SolidElement], bodies: &[Body], body_of_element: &[usize]) -> Self {
        let mut starts = vec![0];
        let mut end = 0;
        for (solid, &body) in solids.iter().zip(body_of_element) {
            end += solid.quadrature_points() * bodies[body].material.description().variables.len();
            starts.push(end);
        }
        Self { starts }
    }

    /// Total number of values.
    pub fn total(&self) -> usize {
        self.starts[self.starts.len() - 1]
    }

    /// Part of one element.
    pub fn of<'a>(&self, element: usize, memory: &'a [f64]) -> &'a [f64] {
        &memory[self.starts[element]..self.starts[element + 1]]
    }

    /// Part of one element, to be changed.
    pub fn of_mut<'a>(&self, element: usize, memory: &'a mut [f64]) -> &'a mut [f64] {
        &mut memory[self.starts[element]..self.starts[element + 1]]
    }

    /// Iterates over the parts of all elements in order.
    pub fn each<'a>(&'a self, memory: &'a [f64]) -> impl Iterator<Item = &'a [f64]> {
        self.starts.windows(2).map(|ends| &memory[ends[0]..ends[1]])
    }

    /// Iterates over the mutable parts of all elements in order; the caller skips those not needed, so that no part can be
    /// assigned to another element.
    pub fn each_mut<'a>(&'a self, memory: &'a mut [f64]) -> impl Iterator<Item = &'a mut [f64]> {
        let mut rest = memory;
        self.starts.windows(2).map(move |ends| {
            let (own, after) = std::mem::take(&mut rest).split_at_mut(ends[1] - ends[0]);
            rest = after;
            own
        })
    }
}
