//! The problem to solve: mesh, bodies, contact pairs, and the steps with their supports, loads and schemes.

pub mod aids;
pub mod boundary;
pub mod builder;
pub mod element;
mod expression;
pub mod method;
pub mod scheme;
pub mod state;
pub mod told;
pub mod warnings;

use std::sync::Arc;

use nalgebra::{DMatrix, DVector, Vector2};

use crate::contact::pair::ContactPair;
use crate::laws::bulk::Material;
use crate::mesh::configuration::Configuration;
use crate::mesh::ties::Ties;
use crate::mesh::{Element, Mesh};
use crate::model::aids::Aids;
use crate::model::boundary::{Loads, Prescribed, Span};
use crate::model::element::{SolidElement, consistent_mass, lumped_mass, redistributed};
use crate::model::method::Chosen;
use crate::model::scheme::Scheme;
use crate::model::state::{Energy, State, StepStart};

/// Rayleigh's damping of a body: C = η M + τ K, K being that of [`crate::laws::bulk`]'s viscous stress. A vibration ω of a
/// body that only this damps has the damping ratio ½ (η/ω + τ ω).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Damping {
    /// η: share of the masses [1/T]
    pub mass: f64,
    /// τ: share of the stiffness, Kelvin–Voigt's time of retardation [T]
    pub retardation: f64,
}

/// A body: a material on a group of elements.
#[derive(Debug)]
pub struct Body {
    /// name of its group
    pub name: String,
    /// bulk law
    pub material: Box<dyn Material>,
    /// damping in dynamic steps
    pub damping: Damping,
    /// its elements
    pub elements: Vec<usize>,
    /// its nodes, ascending
    pub nodes: Vec<usize>,
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

/// How increments are chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Increments {
    /// first Δt [T]
    pub initial: f64,
    /// below this a failed increment stops the run [T]
    pub min: f64,
    /// never above this [T]
    pub max: f64,
    /// local error that an increment may make in a displacement or, in a static step, in the slip of a contact point; `None`
    /// lets the iterations decide [L]
    pub error: Option<f64>,
}

impl Increments {
    /// The same, but none longer than `longest`: a stabilized step has a last increment after its dashpots have faded.
    pub fn at_most(self, longest: f64) -> Self {
        let Self { initial, min, max, error } = self;
        Self { initial: initial.min(longest), min: min.min(longest), max: max.min(longest), error }
    }
}

/// When Newton's method stops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NewtonSettings {
    /// ‖r‖/‖f‖ of every part of a solution [-]
    pub tolerance: f64,
    /// Linear solves before giving up
    pub max_iterations: usize,
}

impl Default for NewtonSettings {
    fn default() -> Self {
        Self { tolerance: 1e-8, max_iterations: 25 }
    }
}

/// A step: a time span with its supports, loads, scheme and increments.
#[derive(Clone, Debug, Default)]
pub struct Step {
    /// name, for messages and output
    pub name: String,
    /// time span
    pub span: Span,
    /// scheme
    pub scheme: Scheme,
    /// increments
    pub increments: Increments,
    /// when and how the step goes on explicitly, if it may
    pub rupture: Option<Box<Rupture>>,
    /// prescribed dofs, ascending
    pub supports: Vec<Prescribed>,
    /// dofs that were prescribed in the step before and are free in this static one: their reaction is ramped off. In a
    /// dynamic step it is gone at once
    pub released: Vec<usize>,
    /// loads, springs and dashpots
    pub loads: Loads,
    /// c₀ of every dof: dashpots c₀ (1 − share of the step that has passed) that keep bodies from floating until contact
    /// holds them; empty if none are asked for [F T/L]
    pub stabilization: Vec<f64>,
}

/// When a static or implicit step turns to explicit increments, and back.
#[derive(Clone, Debug)]
pub struct Rupture {
    /// Slip rate of a contact point above which it does [L/T]
    pub slip_rate: f64,
    /// Time over whose mean no point may slip that fast when it turns back: that of a shear wave across the model [T]
    pub calm: f64,
    /// The step as it goes on explicitly
    pub explicit: Step,
}

/// A set of nodes whose mean displacement and reaction the history reports.
#[derive(Clone, Debug, PartialEq)]
pub struct WatchedSet {
    /// name of the group
    pub name: String,
    /// its nodes
    pub nodes: Vec<usize>,
}

/// The model; it does not change while it is solved.
#[derive(Debug)]
pub struct Model {
    /// title
    pub title: String,
    /// mesh
    pub mesh: Mesh,
    /// whether the elements' mass has been moved away from each node (see [`crate::model::element::redistributed`])
    pub massless: Vec<bool>,
    /// bodies
    pub bodies: Vec<Body>,
    /// nodes of periodic sides
    pub ties: Ties,
    /// point masses
    pub point_masses: Vec<PointMass>,
    /// body of each element
    pub body_of_element: Vec<usize>,
    /// integration geometry of each element
    pub solids: Vec<SolidElement>,
    /// contact pairs
    pub contacts: Vec<ContactPair>,
    /// where each contact is evaluated, and why; none for a slave group of points
    pub methods: Vec<Option<Chosen>>,
    /// steps, in order
    pub steps: Vec<Step>,
    /// watched sets
    pub watch: Vec<WatchedSet>,
    /// initial velocity of every dof [L/T]
    pub initial_velocity: Vec<f64>,
    /// Forces of an initial stress of the bodies on every dof, which balance the initial tractions of contacts; empty if
    /// there is none [F]
    pub prestress: Vec<f64>,
    /// Time between the results of explicit steps; a hundredth of each step if it is not given [T]
    pub interval: Option<f64>,
    /// when Newton's method stops
    pub newton: NewtonSettings,
    /// what makes iterations converge, all of it unless switched off for an experiment
    pub aids: Aids,
}

impl Model {
    /// Number of dofs, two a node.
    pub fn dofs(&self) -> usize {
        2 * self.mesh.nodes.len()
    }

    /// The configuration x = X + u.
    pub fn configuration<'a>(&'a self, displacement: &'a [f64]) -> Configuration<'a> {
        self.mesh.displaced(displacement)
    }

    /// Whether some body has the viscous stress of Kelvin and Voigt.
    pub fn is_viscous(&self) -> bool {
        self.bodies.iter().any(|body| body.damping.retardation > 0.0)
    }

    /// Where each element finds what its material remembers, in [`State::memory`].
    pub fn memories(&self) -> Vec<std::ops::Range<usize>> {
        let mut end = 0;
        let own = |(solid, &body): (&SolidElement, &usize)| {
            let start = end;
            end += solid.quadrature_points() * self.bodies[body].material.variables().len();
            start..end
        };
        self.solids.iter().zip(&self.body_of_element).map(own).collect()
    }

    /// Whether dashpots, absorbing sides or viscous bodies act in a step.
    pub fn is_damped(&self, step: &Step) -> bool {
        let Loads { dashpots, absorbers, .. } = &step.loads;
        !(dashpots.is_empty() && absorbers.is_empty() && step.stabilization.is_empty())
            || self.bodies.iter().any(|body| body.damping != Damping::default())
    }

    /// Consistent mass matrix of an element, the same for both directions [M].
    pub fn element_mass(&self, element: usize) -> DMatrix<f64> {
        let Element { kind, nodes } = &self.mesh.elements[element];
        let positions: Vec<Vector2<f64>> = nodes.iter().map(|&node| self.mesh.nodes[node]).collect();
        let density = self.bodies[self.body_of_element[element]].material.density();
        let mass = consistent_mass(*kind, self.mesh.section, &positions, density)
            .expect("elements are checked when the model is built");
        redistributed(mass, |local| self.massless[nodes[local]])
    }

    /// Lumped mass of each node of an element [M].
    pub fn element_lumped_mass(&self, element: usize) -> DVector<f64> {
        let Element { kind, nodes } = &self.mesh.elements[element];
        let positions: Vec<Vector2<f64>> = nodes.iter().map(|&node| self.mesh.nodes[node]).collect();
        let density = self.bodies[self.body_of_element[element]].material.density();
        lumped_mass(*kind, self.mesh.section, &positions, density)
            .expect("elements are checked when the model is built")
    }

    /// The state at rest before the first increment.
    pub fn initial_state(&self) -> State {
        let zero = vec![0.0; self.dofs()];
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
            contacts: self.contacts.iter().map(|pair| pair.initial_states(&self.mesh.undeformed())).collect(),
            memory: vec![0.0; self.memories().last().map_or(0, |last| last.end)],
            last_increment: None,
            step_start: Arc::new(StepStart { displacement: zero.clone(), reaction: zero }),
            energy: Energy::default(),
        }
    }
}
