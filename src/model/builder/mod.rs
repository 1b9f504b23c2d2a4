//! A model from code, with every default and check that a case file has.
//!
//! ```
//! use fecontact::laws::bulk::{ElasticConstants, NeoHookean};
//! use fecontact::laws::friction::CoulombParameters;
//! use fecontact::mesh::InlineMesh;
//! use fecontact::model::Model;
//! use fecontact::model::boundary::Drive;
//! use fecontact::model::builder::{Contact, LoadStep, Support};
//!
//! let mesh = InlineMesh::default()
//!     .rectangle("ground", [8, 2], [0.0, -1.0], [4.0, 0.0])
//!     .rectangle("block", [5, 3], [1.0, 0.0], [3.0, 1.0])
//!     .build()?;
//! let rubber = NeoHookean::new(&ElasticConstants { young: 1000.0, poisson: 0.3, density: 0.0 })?;
//! let model = Model::builder(mesh)
//!     .body("block", rubber)
//!     .body("ground", rubber)
//!     .contact(Contact::new("base", "block_bottom", "ground_top", CoulombParameters::new(0.3)))
//!     .step(LoadStep::new("press", 1.0).dt(0.1).fix("ground_bottom").support(Support::on("block_top").ux(0.0).uy(-0.01)))
//!     .step(LoadStep::new("drag", 2.0).support(Support::on("block_top").ux(Drive::Rate(0.05))))
//!     .watch("block_top")
//!     .build()?;
//! assert_eq!((model.contacts[0].points.len(), model.warnings().len()), (10, 0));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A load step takes over what the one before gave: scheme, increments, supports and loads. What is wrong is told with its
//! place, in the words of a case file: `steps[1].supports[0].on: the mesh has no group …`.

mod body;
mod change;
mod checks;
mod contact;
mod error;
mod friction;
mod groups;
mod increments;
mod initial;
mod limits;
mod load;
mod load_step;
mod loads;
mod names;
mod pair;
mod penalty;
mod periodic;
mod rigid;
mod schedule;
mod shares;
mod supported;
mod supports;

use std::collections::BTreeSet;

pub use change::Change;
pub use contact::{Contact, InitialTractions, MasterSide};
pub use error::{Checked, ModelError};
pub use friction::Friction;
pub use groups::Place;
pub use load::{Action, Components, Link, Load};
pub use load_step::{IncrementSettings, LoadStep, Rotation, RuptureSettings, Support};

use crate::laws::bulk::Material;
use crate::mesh::Mesh;
use crate::mesh::ties::Ties;
use crate::model::aids::Aids;
use crate::model::{Damping, Model, NewtonSettings, WatchedSet};
use body::{GivenBody, GivenMass};

/// What a model is made of; [`Builder::build`] checks it and makes the model.
pub struct Builder {
    mesh: Mesh,
    title: String,
    bodies: Vec<GivenBody>,
    f_bar: Vec<String>,
    damping: Vec<(String, Damping)>,
    point_masses: Vec<GivenMass>,
    periodic: Vec<[String; 2]>,
    contacts: Vec<Contact>,
    velocities: Vec<(String, [f64; 2])>,
    steps: Vec<LoadStep>,
    watch: Vec<String>,
    newton: NewtonSettings,
    interval: Option<f64>,
}

impl Model {
    /// A model from code: what is on the mesh, and what happens to it.
    pub fn builder(mesh: Mesh) -> Builder {
        Builder {
            mesh,
            title: String::new(),
            bodies: Vec::new(),
            f_bar: Vec::new(),
            damping: Vec::new(),
            point_masses: Vec::new(),
            periodic: Vec::new(),
            contacts: Vec::new(),
            velocities: Vec::new(),
            steps: Vec::new(),
            watch: Vec::new(),
            newton: NewtonSettings::default(),
            interval: None,
        }
    }
}

impl Builder {
    /// What the model shows, in a line.
    pub fn title(self, title: impl Into<String>) -> Self {
        Self { title: title.into(), ..self }
    }

    /// A body: the material of a group of elements.
    pub fn body(mut self, name: impl Into<String>, material: impl Into<Box<dyn Material>>) -> Self {
        let (name, material) = (name.into(), material.into());
        self.bodies.push(GivenBody { name, material, f_bar: false, damping: Damping::default() });
        self
    }

    /// Elements of a body with the mean dilatation of their centre (F-bar), which do not lock for ν → ½: Q4 only.
    pub fn f_bar(mut self, body: impl Into<String>) -> Self {
        self.f_bar.push(body.into());
        self
    }

    /// Damping of a body in dynamic steps.
    pub fn damping(mut self, body: impl Into<String>, damping: Damping) -> Self {
        self.damping.push((body.into(), damping));
        self
    }

    /// A mass at every node of a group, added to what a body has there [M].
    pub fn point_mass(mut self, group: impl Into<String>, mass: f64) -> Self {
        self.point_masses.push(GivenMass { name: group.into(), mass, velocity: None });
        self
    }

    /// A mass at every node of a group that starts with a velocity [M], [L/T].
    pub fn moving_point_mass(mut self, group: impl Into<String>, mass: f64, velocity: [f64; 2]) -> Self {
        self.point_masses.push(GivenMass { name: group.into(), mass, velocity: Some(velocity) });
        self
    }

    /// Two groups whose nodes lie alike and move alike: what leaves by one side comes in by the other.
    pub fn periodic(mut self, side: impl Into<String>, other: impl Into<String>) -> Self {
        self.periodic.push([side.into(), other.into()]);
        self
    }

    /// A contact.
    pub fn contact(mut self, contact: Contact) -> Self {
        self.contacts.push(contact);
        self
    }

    /// Velocity of a whole body at the start [L/T].
    pub fn initial_velocity(mut self, body: impl Into<String>, velocity: [f64; 2]) -> Self {
        self.velocities.push((body.into(), velocity));
        self
    }

    /// The next load step.
    pub fn step(mut self, step: LoadStep) -> Self {
        self.steps.push(step);
        self
    }

    /// A group whose mean displacement and reaction are reported.
    pub fn watch(mut self, group: impl Into<String>) -> Self {
        self.watch.push(group.into());
        self
    }

    /// When Newton's method stops; a tolerance of 1e-8 and 25 iterations unless given.
    pub fn newton(self, newton: NewtonSettings) -> Self {
        Self { newton, ..self }
    }

    /// Time between the results of explicit steps; a hundredth of each unless given [T].
    pub fn interval(self, interval: f64) -> Self {
        Self { interval: Some(interval), ..self }
    }

    /// The model.
    ///
    /// # Errors
    /// [`ModelError`] names the place, the value and what to do.
    pub fn build(mut self) -> Checked<Model> {
        self.check_names()?;
        let f_bar = self.settled()?;
        let (bodies, body_of_element) = body::bodies(std::mem::take(&mut self.bodies), &self.mesh)?;
        let solids = body::solids(&self.mesh, &bodies, &body_of_element, &f_bar)?;
        let mut model = Model {
            title: self.title,
            initial_velocity: vec![0.0; 2 * self.mesh.nodes.len()],
            massless: vec![false; self.mesh.nodes.len()],
            mesh: self.mesh,
            bodies,
            ties: Ties::default(),
            point_masses: Vec::new(),
            body_of_element,
            solids,
            contacts: Vec::new(),
            methods: Vec::new(),
            steps: Vec::new(),
            watch: Vec::new(),
            aids: Aids::default(),
            newton: checks::checked_newton(self.newton)?,
            prestress: Vec::new(),
            interval: checks::checked_interval(self.interval)?,
        };
        model.point_masses = body::point_masses(&self.point_masses, &model.mesh)?;
        model.ties = periodic::ties(&self.periodic, &model.mesh)?;
        model.contacts = self.contacts.iter().map(|contact| pair::pair(contact, &model)).collect::<Checked<_>>()?;
        model.methods = self.contacts.iter().map(|contact| pair::evaluation(contact, &model.mesh)).collect();
        model.massless = pair::massless(&self.contacts, &model.mesh)?;
        model.prestress = initial::prestress(&self.contacts, &model);
        model.steps = schedule::steps(&self.steps, &model)?;
        model.initial_velocity = initial::velocities(&self.velocities, &self.point_masses, &model)?;
        model.watch =
            self.watch.iter().enumerate().map(|(k, name)| watched(&model, k, name)).collect::<Checked<_>>()?;
        checks::check_schemes(&self.contacts, &model)?;
        supported::check(&self.steps, &model)?;
        Ok(model)
    }

    /// Names must survive in results, and stand once.
    fn check_names(&self) -> Checked<()> {
        for (k, step) in self.steps.iter().enumerate() {
            names::check_name(&format!("steps[{k}].name"), &step.name)?;
        }
        for contact in &self.contacts {
            names::check_name("contacts", &contact.name)?;
        }
        names::check_watched(&self.watch)?;
        names::check_once("contacts", self.contacts.iter().map(|contact| &contact.name))?;
        names::check_once("bodies", self.bodies.iter().map(|body| &body.name))?;
        names::check_once("point_masses", self.point_masses.iter().map(|mass| &mass.name))
    }

    /// Give the bodies what was said about them elsewhere; returns which of them take F-bar.
    fn settled(&mut self) -> Checked<Vec<bool>> {
        let known: Vec<String> = self.bodies.iter().map(|body| body.name.clone()).collect();
        let number = |name: &String| {
            known.iter().position(|known| known == name).ok_or_else(|| {
                let message = format!("there is no body of this name; the bodies are {}", known.join(", "));
                ModelError::new(format!("bodies.{name}"), message)
            })
        };
        for (name, damping) in &self.damping {
            self.bodies[number(name)?].damping = *damping;
        }
        for name in &self.f_bar {
            self.bodies[number(name)?].f_bar = true;
        }
        Ok(self.bodies.iter().map(|body| body.f_bar).collect())
    }
}

/// The reactions of copies are with the nodes they move with.
fn watched(model: &Model, k: usize, name: &str) -> Checked<WatchedSet> {
    let group = groups::group(&model.mesh, name, &format!("watch[{k}]"))?;
    let nodes: BTreeSet<usize> = model.mesh.nodes_of(group).into_iter().map(|node| model.ties.original(node)).collect();
    Ok(WatchedSet { name: name.into(), nodes: nodes.into_iter().collect() })
}
