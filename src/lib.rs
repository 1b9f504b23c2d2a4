//! A 2D finite-element contact solver whose interfaces obey the time-dependent super/subloading-surface friction law.
//!
//! The following example compresses a block on another one and drags it. The run is an iterator over increments:
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
//! let press = LoadStep::new("press", 1.0).dt(0.5).fix("ground_bottom").support(Support::on("block_top").ux(0.0).uy(-0.01));
//! let drag = LoadStep::new("drag", 2.0).dt(0.5).support(Support::on("block_top").ux(Drive::Rate(0.05)));
//! let model = Model::builder(mesh)
//!     .body("block", rubber)
//!     .body("ground", rubber)
//!     .contact(Contact::new("base", "block_bottom", "ground_top", CoulombParameters::new(0.3)))
//!     .step(press)
//!     .step(drag)
//!     .build()?;
//! let mut run = Simulation::new(model);
//! while let Some(increment) = run.next_increment()? {
//!     let force = run.reaction("block_top")?;
//!     println!("t = {}: F_x/F_y = {}", increment.state.time, force.x / -force.y);
//! }
//! let force = run.reaction("block_top")?;
//! assert!((force.x / -force.y - 0.3).abs() < 0.01); // it slides as a whole
//! assert!(run.contact_field("base", "state")?.iter().all(|state| *state == 2.0));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Between two increments the caller can prescribe the motion of supports ([`run::Simulation::prescribe`]), change loads
//! ([`model::builder::LoadsInForce`]), drop a candidate ([`run::Simulation::try_increment`]), and save the run to resume it
//! with bitwise identical results ([`run::Saved`], in memory or as bytes).
//!
//! # Public modules
//!
//! A program that uses the library depends on it with `default-features = false`, and sees these modules:
//!
//! | module | content |
//! |---|---|
//! | [`model`] | [`model::Model::builder`] and its input: bodies, [`model::builder::Contact`], [`model::builder::LoadStep`], supports and loads |
//! | [`run`] | [`run::Simulation`], increment by increment; [`run::observer`]s of a whole run; [`run::law`], a friction law along a path, or behind the spring of a slider |
//! | [`laws`] | friction and bulk laws, and the traits for user-defined ones: [`laws::friction::FrictionLaw`], [`laws::bulk::BulkLaw`] |
//! | [`mesh`] | meshes from gmsh ([`mesh::gmsh`]), from blocks ([`mesh::Blocks`]), from code ([`mesh::InlineMesh`]) |
//! | [`output::results`] | frames of a results folder, as plain numbers |
//!
//! Inputs are created by `new` and setters, and results may be extended: nearly all structures and enums are `non_exhaustive`.
//! The feature `internals`, enabled by the program (`cli`), makes all modules public; those that only it exposes change without
//! notice.
//!
//! # Architecture
//!
//! A module (a "room") imports only from the modules below it:
//!
//! | module | content |
//! |---|---|
//! | [`cli`] | commands, arguments, progress |
//! | [`case`] | the JSON of a case: read, passed to the builder of a model, and run into a folder ([`case::job`]) |
//! | [`output`] | observers of a run and the files they write; the page of results |
//! | [`run`] | steps, acceptance and cut-back of increments, observers |
//! | [`time`] | one increment, implicit or explicit: old state → new state; step-size control |
//! | [`solve`] | Newton's method; detection of unconstrained rigid-body modes |
//! | [`equations`] | residual and tangent of a model at a trial displacement; energies |
//! | [`model`] | bodies, contacts, steps, supports and loads; the state; [`model::builder`]: a model from code |
//! | [`bars`] | trusses and beams, alone or bonded to the body they lie in |
//! | [`contact`] | surfaces, search, projection, mortar, forces of contact pairs |
//! | [`linear`] | sparse matrices and their factors |
//! | [`mesh`] | nodes, elements, groups, shape functions |
//! | [`laws`] | friction of interfaces, stress of bodies |
//!
//! Reading order: `main` → [`cli`] → [`case`] (JSON, [`case::job`]) → [`model::builder`] (defaults, checks) → [`model`] → [`run`] (steps,
//! increments, cut-back; [`time::step_size`] for their length) → [`time::increment`] (one increment: old state → new state) →
//! [`solve::newton`] → [`equations`] → {[`model::element`] → [`laws::bulk`]} and {[`contact`] → [`laws::friction`]}; then
//! back up: accepted [`model::state`] → [`output`].
//!
//! A law test: [`cli`] → [`case`] → [`run::law`] along a path of slip, pressure and time → [`laws::friction`] → [`output`].
//!
//! # Example: path of the slip increment
//!
//! The slip increment Δu_t of a contact point, from the case file to the law and back to `history.csv`:
//!
//! 1. The motion of the block, `"ux": {"rate": 0.05}`, is read as a [`model::builder::Support`], from which the builder makes a
//!    `Prescribed` dof of the [`model::Step`].
//! 2. [`run`] requests an increment, [`time::increment`] creates a [`equations::Trial`] for it, and [`solve::equilibrium`]
//!    finds the displacement u at its end by iteration.
//! 3. At every iterate `equations/contacts.rs` evaluates each [`contact::pair`]. `contact/search.rs` and
//!    `contact/projection.rs` find the projection, and [`contact::kinematics`] the arc on the master from the committed
//!    projection to this one: Δu_t. [`contact::force`] passes it to the law as [`laws::friction::Sliding::slip`], with p and
//!    Δt.
//! 4. The law returns q, its tangents and a new [`laws::friction::FrictionState`], whose `plastic_increment` is the plastic
//!    part of Δu_t; [`contact::force`] converts q to nodal forces, which are summed with the other terms of [`equations`].
//! 5. The accepted [`model::state::State`] stores it (`time/accept.rs`), and `output/history.rs` writes the mean over the
//!    contact, `base.mean_slip`.
//!
//! # Signs
//!
//! | symbol | in code | meaning |
//! |---|---|---|
//! | n, s | `normal`, `tangent` | unit normal out of the master; s = n turned by −90°, so (s, n) is right-handed |
//! | g | `gap` | (x_slave − x_m)·n with the projection x_m, positive when open |
//! | p | `pressure` | positive in compression |
//! | Δu_t | `slip` | motion of the slave relative to the master along s |
//! | q | `traction` | resists positive slip; the traction on the slave is p n − q s |
//!
//! Surfaces in the mesh have their body on the left; the segments of a master run along s, so its body is on the right.
//! The plane is a slice of depth 1 unless a section specifies otherwise ([`mesh::section`]); units are any consistent set.
//!
//! # Invariants
//!
//! - A law is a pure function of (committed state, increment); it returns the stress or traction and the consistent
//!   tangent of exactly that.
//! - The traction is a scalar in the frame that rotates with the interface; this is the co-rotational rate in 2D.
//! - Committed and trial state are separate values: commit is to accept a state, roll-back to drop it.
//! - Sums run in a fixed order: results are bitwise identical for any number of threads.
//! - A module imports only from lower ones, and no files import each other in a circle; `tests/layers.rs` checks this.

#![cfg_attr(
    not(feature = "internals"),
    allow(dead_code, unused_imports, reason = "what the program and its tests use beyond what is published")
)]
#![cfg_attr(
    not(feature = "internals"),
    allow(rustdoc::private_intra_doc_links, reason = "the map of the house names rooms that are not published")
)]
#![allow(rustdoc::broken_intra_doc_links, reason = "units stand in brackets: [L], [F]")]

#[macro_use]
pub mod laws;

#[cfg(feature = "cli")]
pub mod cli;
pub mod mesh;
pub mod model;
pub mod output;
pub mod run;

// The rooms behind the published ones: open to the program, its tests and benches alone.
cfg_if::cfg_if! {
    if #[cfg(feature = "internals")] {
        pub mod bars;
        pub mod case;
        pub mod contact;
        pub mod equations;
        pub mod linear;
        pub mod solve;
        pub mod time;
    } else {
        mod bars;
        mod case;
        mod contact;
        mod equations;
        mod linear;
        mod solve;
        mod time;
    }
}
