//! The problem to solve: mesh, bodies, contact pairs, and the steps with their supports, loads and schemes.

pub(crate) mod balance;
mod bars;
mod body;
pub mod boundary;
pub mod builder;
pub(crate) mod coupled;
mod expression;
mod in_force;
pub(crate) mod linkage;
pub(crate) mod pore_flow;
mod pore_flow_concerns;
mod random;
mod requests;
pub(crate) mod resistance;
mod stages;
mod stored_water;
pub(crate) mod support;
mod unfit;
pub(crate) mod warnings;
pub(crate) mod written;

cfg_if::cfg_if! {
    if #[cfg(feature = "internals")] {
        pub mod aids;
        pub mod element;
        pub mod imposed;
        pub mod measured;
        pub mod method;
        pub mod scheme;
        pub mod state;
        pub mod step;
        pub mod text;
    } else {
        pub(crate) mod aids;
        pub(crate) mod element;
        pub(crate) mod imposed;
        pub(crate) mod measured;
        pub(crate) mod method;
        pub(crate) mod scheme;
        pub(crate) mod state;
        pub(crate) mod step;
        pub(crate) mod text;
    }
}

use std::sync::Arc;

use nalgebra::{DMatrix, DVector};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::bars::Bar;
use crate::contact::pair::ContactPair;
use crate::mesh::ties::Ties;
use crate::mesh::{Configuration, Element, Mesh};
use aids::Aids;
#[doc(hidden)]
pub use bars::BarsInStep;
pub use body::{Body, Damping, Memories, PointMass};
use boundary::Loads;
use element::{SolidElement, consistent_mass, lumped_mass, redistributed};
pub use imposed::{InitialStress, Layer, PoreFluid, PorePressure, Thermal};
use linkage::Linkage;
pub use measured::{Coordinate, Measured, MeasuredTable, PoreField};
use method::Chosen;
pub use method::Method;
use pore_flow::PoreFlow;
pub use requests::{Axis, OutputRequests, Probe, Station, WatchedSet};
pub use scheme::Scheme;
#[doc(hidden)]
pub use stages::Activated;
use state::StepStart;
pub use state::{Energy, State};
pub use step::{ForceComponent, Increments, Rupture, Step};

/// Stopping criteria of Newton's method.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
#[schemars(rename = "Newton")]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct NewtonSettings {
    /// Residual force relative to the acting forces
    pub tolerance: f64,
    /// Linear solves per increment before it is rejected
    pub max_iterations: usize,
}

setters! { newton: NewtonSettings;
    /// Sets the tolerance [-].
    tolerance(tolerance: f64) { newton.tolerance = tolerance; }

    /// Sets the maximum number of linear solves.
    max_iterations(max_iterations: usize) { newton.max_iterations = max_iterations; }
}

impl Default for NewtonSettings {
    fn default() -> Self {
        Self { tolerance: 1e-8, max_iterations: 25 }
    }
}

/// The model; constant during a run.
#[derive(Debug)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct Model {
    /// title
    pub title: String,
    /// mesh
    pub mesh: Mesh,
    /// whether the elements' mass has been moved away from each node (see [`crate::model::element::redistributed`])
    #[doc(hidden)]
    pub massless: Vec<bool>,
    /// bodies
    #[doc(hidden)]
    pub bodies: Vec<Body>,
    /// nodes of periodic sides and of loading plates
    #[doc(hidden)]
    pub ties: Ties,
    /// nodes constrained to others: platens that rotate, or with one equal component
    #[doc(hidden)]
    pub linkage: Linkage,
    /// nodes of each loading platen, ascending
    #[doc(hidden)]
    pub plates: Vec<Vec<usize>>,
    /// point masses
    #[doc(hidden)]
    pub point_masses: Vec<PointMass>,
    /// body of each element
    #[doc(hidden)]
    pub body_of_element: Vec<usize>,
    /// integration geometry of each element
    #[doc(hidden)]
    pub solids: Vec<SolidElement>,
    /// layout of the internal variables of all elements in [`State::memory`]
    #[doc(hidden)]
    pub memories: Memories,
    /// water that flows through pores, if any does
    #[doc(hidden)]
    pub flow: Option<PoreFlow>,
    /// trusses and beams
    #[doc(hidden)]
    pub bars: Vec<Bar>,
    /// contact pairs
    #[doc(hidden)]
    pub contacts: Vec<ContactPair>,
    /// method of each contact, and its reason; `None` for a point group as slave
    #[doc(hidden)]
    pub methods: Vec<Option<Chosen>>,
    /// steps, in order
    pub steps: Vec<Step>,
    /// initial velocity of every dof [L/T]
    #[doc(hidden)]
    pub initial_velocity: Vec<f64>,
    /// Forces of an initial stress of the bodies on every dof, balanced by initial tractions of contacts, if any [F]
    #[doc(hidden)]
    pub prestress: Vec<f64>,
    /// what is recorded, and when
    #[doc(hidden)]
    pub requests: OutputRequests,
    /// stopping criteria of Newton's method
    pub newton: NewtonSettings,
    /// convergence aids, all active unless switched off for an experiment
    #[doc(hidden)]
    pub aids: Aids,
}

#[doc(hidden)]
impl Model {
    /// Number of dofs, two per node.
    pub fn dofs(&self) -> usize {
        2 * self.mesh.nodes.len()
    }

    /// Number of unknowns: the second dof of a node that stands for a pressure is none.
    pub fn unknowns(&self) -> usize {
        self.dofs() - self.saddle()
    }

    /// Number of negative eigenvalues of a tangent at a stable equilibrium: the pressures of water that flows.
    pub fn saddle(&self) -> usize {
        self.flow.as_ref().map_or(0, PoreFlow::count)
    }

    /// The configuration x = X + u.
    pub fn configuration<'a>(&'a self, displacement: &'a [f64]) -> Configuration<'a> {
        self.mesh.displaced(displacement)
    }

    /// Body of an element.
    pub fn body_of(&self, element: usize) -> &Body {
        &self.bodies[self.body_of_element[element]]
    }

    /// Damping of a body in a step: none while it is absent.
    pub fn damping(&self, step: &Step, body: usize) -> Damping {
        if !step.has(body) {
            return Damping::default();
        }
        step.damping.get(body).copied().unwrap_or(self.bodies[body].damping)
    }

    /// Damping of all bodies in a step.
    pub fn dampings(&self, step: &Step) -> Vec<Damping> {
        (0..self.bodies.len()).map(|body| self.damping(step, body)).collect()
    }

    /// τ of all bodies in a step [T].
    pub fn retardations(&self, step: &Step) -> Vec<f64> {
        self.dampings(step).iter().map(|damping| damping.retardation).collect()
    }

    /// Whether some body has a Kelvin–Voigt viscous stress in a step.
    pub fn is_viscous(&self, step: &Step) -> bool {
        (0..self.bodies.len()).any(|body| self.damping(step, body).retardation > 0.0)
    }

    /// Whether forces act in the initial state: bodies with initial stress, or closed contacts.
    pub fn starts_loaded(&self) -> bool {
        self.contacts.iter().any(|pair| pair.initial.is_some()) || self.bodies.iter().any(Body::is_stressed)
    }

    /// Whether dashpots, absorbing sides, viscous bodies or bars act in a step.
    pub fn is_damped(&self, step: &Step) -> bool {
        let Loads { dashpots, absorbers, .. } = &step.loads;
        !(dashpots.is_empty() && absorbers.is_empty() && step.stabilization.is_empty())
            || (0..self.bodies.len()).any(|body| self.damping(step, body) != Damping::default())
            || self.bars_in(step).any(|(_, bar)| bar.drag > 0.0 || bar.retardation > 0.0)
    }

    /// Consistent mass matrix of an element, the same for both directions [M].
    pub fn element_mass(&self, element: usize) -> DMatrix<f64> {
        self.consistent(element, self.body_of(element).material.description().density)
    }

    /// ∫ N_a N_b dV of an element, in accordance with its mass [L³].
    pub fn element_volumes(&self, element: usize) -> DMatrix<f64> {
        self.consistent(element, 1.0)
    }

    fn consistent(&self, element: usize, density: f64) -> DMatrix<f64> {
        let Element { kind, nodes } = &self.mesh.elements[element];
        let mass = consistent_mass(*kind, self.mesh.section, &self.mesh.places(element), density)
            .expect("elements are checked when the model is built");
        redistributed(mass, |local| self.massless[nodes[local]])
    }

    /// Lumped mass of each node of an element [M].
    pub fn element_lumped_mass(&self, element: usize) -> DVector<f64> {
        self.lumped(element, self.body_of(element).material.description().density)
    }

    /// Volume of the lumped mass of each node of an element [L³].
    pub fn element_lumped_volumes(&self, element: usize) -> DVector<f64> {
        self.lumped(element, 1.0)
    }

    fn lumped(&self, element: usize, density: f64) -> DVector<f64> {
        let mesh = &self.mesh;
        lumped_mass(mesh.elements[element].kind, mesh.section, &mesh.places(element), density)
            .expect("elements are checked when the model is built")
    }

    /// (λ + 2G) w of an element, the ratio of force to displacement [F/L].
    pub fn element_stiffness(&self, element: usize) -> f64 {
        self.body_of(element).material.description().p_wave_modulus * self.solids[element].mean_weight()
    }

    /// That of the stiffest element; 0 without elements [F/L].
    pub fn stiffness(&self) -> f64 {
        (0..self.solids.len()).map(|element| self.element_stiffness(element)).fold(0.0, f64::max)
    }

    /// The initial state before the first increment.
    pub fn initial_state(&self) -> State {
        let zero = vec![0.0; self.dofs()];
        let contacts: Vec<_> = self.contacts.iter().map(|pair| self.first_states(pair)).collect();
        let conduits = self.contacts.iter().zip(&contacts);
        let conduits = conduits.map(|(pair, states)| pair.conduit.as_ref().map(|conduit| conduit.begin(states)));
        State {
            time: 0.0,
            increment: 0,
            dt: 0.0,
            displacement: zero.clone(),
            velocity: self.initial_velocity.clone(),
            acceleration: zero.clone(),
            force: zero.clone(),
            external: zero.clone(),
            damping: zero.clone(),
            reaction: zero.clone(),
            conduits: conduits.map(Option::unwrap_or_default).collect(),
            contacts,
            memory: self.initial_memory(),
            bars: self.first_bars(),
            water: self.first_water(),
            last_increment: None,
            step_start: Arc::new(StepStart {
                displacement: zero.clone(),
                reaction: zero,
                fading: Vec::new(),
                absent: self.steps.first().map(|step| step.absent.clone()).unwrap_or_default(),
                activations: Arc::default(),
                last_dt: 0.0,
            }),
            energy: Energy::default(),
        }
    }
}
