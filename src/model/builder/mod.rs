//! A model from code, with every default and check that a case file has.
//!
//! ```
//! use fecontact::laws::bulk::{ElasticConstants, NeoHookean};
//! use fecontact::laws::friction::CoulombParameters;
//! use fecontact::mesh::InlineMesh;
//! use fecontact::model::Model;
//! use fecontact::model::boundary::Drive;
//! use fecontact::model::builder::{Contact, LoadStep, Support};
//! use fecontact::run::Simulation;
//!
//! let mesh = InlineMesh::default()
//!     .rectangle("ground", [8, 2], [0.0, -1.0], [4.0, 0.0])
//!     .rectangle("block", [5, 3], [1.0, 0.0], [3.0, 1.0])
//!     .build()?;
//! let rubber = NeoHookean::new(&ElasticConstants::new(1000.0, 0.3))?;
//! let model = Model::builder(mesh)
//!     .body("block", rubber)
//!     .body("ground", rubber)
//!     .contact(Contact::new("base", "block_bottom", "ground_top", CoulombParameters::new(0.3)))
//!     .step(LoadStep::new("press", 1.0).dt(0.1).fix("ground_bottom").support(Support::on("block_top").ux(0.0).uy(-0.01)))
//!     .step(LoadStep::new("drag", 2.0).support(Support::on("block_top").ux(Drive::Rate(0.05))))
//!     .watch("block_top")
//!     .build()?;
//! assert!(model.warnings().is_empty());
//! assert_eq!(Simulation::new(model).contact_positions("base")?.len(), 6);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A load step inherits scheme, increments, supports and loads from the previous one. Errors are reported with their
//! place, in the terms of a case file: `steps[1].supports[0].on: the mesh has no group …`.
//!
//! A file has the name of what it builds. Of water, `pore_pressure` is given in bodies and `pore_flow` flows through them; `fluid` is the
//! pressure at a contact, given or flowing, `conduit` the water that flows along it (its keys: `conduit_input`), and `pores` the effective stress
//! of a contact next to bodies with a fluid.

mod additions;
mod agreement;
mod bar;
mod bars;
mod body;
mod bond;
mod checks;
mod conduit;
mod conduit_input;
mod contact;
mod error;
mod facing;
mod fluid;
mod friction;
mod groups;
mod initial;
mod interface;
mod load;
mod load_step;
mod loads;
mod pair;
mod pore_flow;
mod pore_pressure;
mod pores;
mod reduction;
mod requests;
mod rigid;
pub(crate) mod schedule;
mod seam;
mod sections;
mod stages;
mod supports;
pub(crate) mod thickness;
mod unconstrained;
mod unseen;

pub use bar::{BarBond, BarEnd, BarInput, Embedding};
pub use body::{BodyInput, BulkLaw, PointMassInput};
pub use bond::FADES;
pub use conduit_input::{Flow, FlowLeak, FlowWell, Schedule};
pub use contact::{Contact, InitialTractions, MasterSide, Normal, Radiation, SlidingRange};
pub use error::{Checked, ModelError};
pub(crate) use error::{check_line, check_name, check_positive, refuse_if};
pub use fluid::FluidPressure;
pub use friction::{Along, DefaultAlphaT, Friction, LawChoice};
pub use groups::Place;
pub(crate) use groups::nodes_at;
pub use interface::Interface;
pub use load::{Change, Components, DashpotLoad, Load, SpringLoad};
pub use load_step::{
    IncrementSettings, LoadStep, OF_CRITICAL_SLIP, Rotation, RuptureSettings, Support, UNTIL_TOLERANCE, UntilSettings,
};
pub use loads::LoadsInForce;
pub use pair::{default_alpha_t, default_over, tangential_over};
pub(crate) use pair::{evaluation, hats};
pub use reduction::with_friction;
pub use requests::Gauge;
pub use rigid::{LoadingPlateInput, MovingPlateInput, Plate, RigidBodyInput};
pub use schedule::regime;
pub use sections::SectionsInput;

use crate::laws::bulk::Material;
use crate::mesh::ties::Ties;
use crate::mesh::{Mesh, Section};
pub use crate::model::element::Formulation;
use crate::model::imposed::{InitialStress, PoreFluid, PorePressure, Thermal};
use crate::model::linkage::Linkage;
use crate::model::{Damping, Memories, Model, NewtonSettings, OutputRequests};

/// Input of a model; [`Builder::build`] checks it and creates the model.
#[derive(Default)]
pub struct Builder {
    pub(crate) mesh: Mesh,
    pub(crate) title: String,
    pub(crate) bodies: Vec<(String, BodyInput)>,
    /// A body that is referred to before it is given, if there is one
    pub(crate) unknown: Option<String>,
    pub(crate) point_masses: Vec<(String, PointMassInput)>,
    pub(crate) periodic: Vec<[String; 2]>,
    pub(crate) plates: Vec<LoadingPlateInput>,
    pub(crate) rigid_bodies: Vec<(String, RigidBodyInput)>,
    pub(crate) bars: Vec<(String, BarInput)>,
    pub(crate) contacts: Vec<Contact>,
    pub(crate) velocities: Vec<(String, [f64; 2])>,
    pub(crate) steps: Vec<LoadStep>,
    pub(crate) watch: Vec<Place>,
    pub(crate) newton: NewtonSettings,
    pub(crate) interval: Option<f64>,
    pub(crate) times: Vec<f64>,
    pub(crate) gauges: Vec<Gauge>,
    pub(crate) sections: Vec<SectionsInput>,
}

impl Model {
    /// Creates the builder of a model on a mesh.
    pub fn builder(mesh: Mesh) -> Builder {
        Builder { mesh, ..Builder::default() }
    }
}

setters! { builder: Builder;
    /// Sets the title, in one line.
    title(title: impl Into<String>) { builder.title = title.into(); }

    /// Sets the kind of plane section; default: that of the mesh, plane strain.
    section(section: Section) { builder.mesh.section = section; }

    /// Adds a body: the material of a group of elements.
    body(name: impl Into<String>, material: impl Into<Box<dyn Material>>) {
        let material = BulkLaw::FromCode(material.into().into());
        let body = BodyInput {
            material,
            element: Formulation::Displacement,
            damping: Damping::default(),
            initial_stress: None,
            pore_fluid: None,
            pore_pressure: None,
            thermal: None,
        };
        builder.bodies.push((name.into(), body));
    }

    /// Adds a point mass at every node of a group, in addition to the mass of a body there [M].
    point_mass(group: impl Into<String>, mass: f64) {
        builder.point_masses.push((group.into(), PointMassInput { mass, velocity: None }));
    }

    /// Adds a point mass with an initial velocity at every node of a group [M], [L/T].
    moving_point_mass(group: impl Into<String>, mass: f64, velocity: [f64; 2]) {
        builder.point_masses.push((group.into(), PointMassInput { mass, velocity: Some(velocity) }));
    }

    /// Adds periodic sides: two groups with matching nodes and equal displacements.
    periodic(side: impl Into<String>, other: impl Into<String>) {
        builder.periodic.push([side.into(), other.into()]);
    }

    /// Adds a loading platen: all nodes of a group have the same displacement, as if glued to a rigid platen that does not
    /// rotate. Loads on one of them act on the platen.
    plate(group: impl Into<String>) { builder.plates.push(LoadingPlateInput::Group(group.into())); }

    /// Adds a loading platen with another kind of motion.
    plate_moving(group: impl Into<String>, moves: Plate) {
        builder.plates.push(LoadingPlateInput::Moving(MovingPlateInput { on: group.into(), moves }));
    }

    /// Adds a rigid body with its reference point, for contacts with a moving rigid master ([`Contact::rigid_body`]) and
    /// supports `on` its name [L].
    rigid_body(name: impl Into<String>, reference: [f64; 2]) {
        builder.rigid_bodies.push((name.into(), RigidBodyInput { reference, inertia: None }));
    }

    /// Adds a rigid body that may rotate freely, with its centre of mass [L] and its moment of inertia about it [M L²]; its
    /// mass is a [point mass](Self::point_mass) with its name.
    free_rigid_body(name: impl Into<String>, reference: [f64; 2], inertia: f64) {
        builder.rigid_bodies.push((name.into(), RigidBodyInput { reference, inertia: Some(inertia) }));
    }

    /// Adds a bar: a truss or a beam.
    bar(name: impl Into<String>, bar: BarInput) { builder.bars.push((name.into(), bar)); }

    /// Adds a contact.
    contact(contact: Contact) { builder.contacts.push(contact); }

    /// Sets the initial velocity of a body [L/T].
    initial_velocity(body: impl Into<String>, velocity: [f64; 2]) {
        builder.velocities.push((body.into(), velocity));
    }

    /// Adds the next load step.
    step(step: LoadStep) { builder.steps.push(step); }

    /// Watches a group or single node: its mean displacement and reaction are reported.
    watch(on: impl Into<Place>) { builder.watch.push(on.into()); }

    /// Sets the stopping criteria of Newton's method; default: tolerance 1e-8 and 25 iterations.
    newton(newton: NewtonSettings) { builder.newton = newton; }

    /// Adds a gauge: a point, or points along a line, at which motion, strain and stress are evaluated.
    probe(gauge: Gauge) { builder.gauges.push(gauge); }

    /// Adds sections across a body along an axis, at which its normal force, shear force and bending moment are recorded.
    sections(sections: SectionsInput) { builder.sections.push(sections); }

    /// Sets output times of fields, at which increments end [T].
    times(times: impl Into<Vec<f64>>) { builder.times = times.into(); }

    /// Sets the minimum time between two rows of the history of implicit steps, and the interval of the results of explicit
    /// ones; default: all increments, and a hundredth of each explicit step [T].
    interval(interval: f64) { builder.interval = Some(interval); }
}

impl Builder {
    /// Selects F-bar elements (mean dilatation of the centre) for a body, which do not lock for ν → ½: Q4 only.
    pub fn f_bar(self, body: impl Into<String>) -> Self {
        self.change(body, |body| body.element = Formulation::FBar)
    }

    /// Elements of a body with 2 × 2 integration points, which lock neither for ν → ½ nor where the body yields: Q8 only.
    pub fn reduced(self, body: impl Into<String>) -> Self {
        self.change(body, |body| body.element = Formulation::Reduced)
    }

    /// Sets the damping of a body in dynamic steps.
    pub fn damping(self, body: impl Into<String>, damping: Damping) -> Self {
        self.change(body, |body| body.damping = damping)
    }

    /// Sets the initial stress of a body; displacements are measured from this state.
    pub fn initial_stress(self, body: impl Into<String>, stress: InitialStress) -> Self {
        self.change(body, |body| body.initial_stress = Some(stress))
    }

    /// Fills the pores of a body with a fluid that has no time to flow.
    pub fn pore_fluid(self, body: impl Into<String>, fluid: PoreFluid) -> Self {
        self.change(body, |body| body.pore_fluid = Some(fluid))
    }

    /// Gives the pressure in the pores of a body by place and time.
    pub fn pore_pressure(self, body: impl Into<String>, pressure: PorePressure) -> Self {
        self.change(body, |body| body.pore_pressure = Some(pressure))
    }

    /// Sets the thermal expansion of a body, whose temperature is given by the steps ([`LoadStep::temperature`]).
    pub fn thermal(self, body: impl Into<String>, thermal: Thermal) -> Self {
        self.change(body, |body| body.thermal = Some(thermal))
    }

    /// Changes a body that was given before.
    fn change(mut self, body: impl Into<String>, change: impl FnOnce(&mut BodyInput)) -> Self {
        let name = body.into();
        match self.bodies.iter_mut().find(|(known, _)| *known == name) {
            Some((_, body)) => change(body),
            None => self.unknown = self.unknown.or(Some(name)),
        }
        self
    }

    /// Builds the model.
    ///
    /// # Errors
    /// Returns [`ModelError`] with place, value and remedy if the input is invalid.
    pub fn build(mut self) -> Checked<Model> {
        self.check_names()?;
        checks::check_section(&self.mesh)?;
        stages::give_sides_owners(&mut self.mesh, &self.steps)?;
        rigid::add_bodies(&self.rigid_bodies, &self.contacts, &mut self.mesh)?;
        let laid = bars::lay(&self.bars, &mut self.mesh)?;
        let (bodies, body_of_element) = body::bodies(&self.bodies, &self.mesh)?;
        let solids = body::solids(&self.mesh, &self.bodies, &body_of_element)?;
        let channels = conduit::channels(&self.contacts, &bodies, &self.mesh);
        let mut flow = pore_flow::flow(&bodies, &solids, &channels, &mut self.mesh)?;
        flow.iter_mut().for_each(|flow| {
            let drained = self.contacts.iter().filter(|contact| contact.open_pressure.is_some());
            flow.outlets = drained.map(|contact| contact.name.clone()).collect();
            flow.outlets.extend(pore_flow::outlets(self.steps.iter().flat_map(|step| &step.drainage), &self.mesh));
        });
        let mut model = Model {
            memories: Memories::new(&solids, &bodies, &body_of_element),
            title: self.title,
            initial_velocity: vec![0.0; 2 * self.mesh.nodes.len()],
            massless: vec![false; self.mesh.nodes.len()],
            mesh: self.mesh,
            bodies,
            ties: Ties::default(),
            linkage: Linkage::default(),
            plates: Vec::new(),
            point_masses: Vec::new(),
            body_of_element,
            solids,
            flow,
            bars: Vec::new(),
            contacts: Vec::new(),
            methods: Vec::new(),
            steps: Vec::new(),
            aids: Default::default(),
            newton: checks::checked_newton(self.newton)?,
            prestress: Vec::new(),
            requests: OutputRequests { interval: requests::checked_interval(self.interval)?, ..Default::default() },
        };
        initial::start_under_stresses(&mut model)?;
        model.bars = bars::bars(&self.bars, laid, &model)?;
        model.point_masses = body::point_masses(&self.point_masses, &model.mesh)?;
        model.plates = rigid::plates(&self.plates, &model.mesh)?;
        model.ties = rigid::ties(&self.periodic, &model.plates, &model.mesh)?;
        let contacts = self.contacts.iter().map(|contact| reduction::with_friction(contact, &model));
        self.contacts = contacts.collect::<Checked<_>>()?;
        model.massless = pair::massless(&self.contacts, &model.mesh)?;
        // Nodes that stand for pressures have no mass.
        model.flow.iter().for_each(|flow| model.massless[flow.first..].fill(true));
        model.linkage = rigid::linkage(&self.plates, &self.steps, &model)?;
        let regime = schedule::regime(&self.steps);
        let absent = stages::absent_at_start(&self.steps, &model);
        model.contacts = pair::pairs(&self.contacts, &model, regime, &absent)?;
        model.methods = self.contacts.iter().map(|contact| pair::evaluation(contact, &model.mesh, regime)).collect();
        model.prestress = initial::prestress(&self.contacts, &model);
        model.steps = schedule::steps(&self.steps, &model)?;
        model.initial_velocity = initial::velocities(&self.velocities, &self.point_masses, &model)?;
        model.requests.watch = requests::watched(&self.watch, &model)?;
        model.requests.times = requests::checked_times(self.times, &model.steps)?;
        model.requests.probes = requests::probes(&self.gauges, &model)?;
        pore_flow::check(&self.contacts, &model)?;
        model.requests.sections = sections::sections(&self.sections, &model)?;
        checks::check_schemes(&self.contacts, &model)?;
        requests::check_rows(&model)?;
        checks::check_quasi_dynamic(&model)?;
        initial::check_excess(&model)?;
        let fluids = self.contacts.iter().map(|contact| contact.fluid_pressure.as_ref());
        fluid::check_fluids_in_time(fluids, &model)?;
        pore_pressure::check_in_time(&model)?;
        unconstrained::check(&self.steps, &model)?;
        Ok(model)
    }
}
