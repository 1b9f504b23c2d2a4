//! A 2D finite-element contact solver whose interfaces obey the time-dependent super/subloading-surface friction law.
//!
//! # The way through the house
//!
//! A room imports only from the rooms below it:
//!
//! | room | what is in it |
//! |---|---|
//! | [`cli`] | commands, arguments, progress |
//! | [`case`] | the JSON of a case: read, and translated to the builder of a model |
//! | [`output`] | observers of a run and the files they write; figures |
//! | [`run`] | steps, increments accepted and cut, observers |
//! | [`time`] | one increment, implicit or explicit: old state → new state; how long the next one is |
//! | [`solve`] | Newton's method; bodies that float |
//! | [`equations`] | residual and tangent of a model at a trial displacement; energies |
//! | [`model`] | bodies, contacts, steps, supports and loads; the state; [`model::builder`]: a model from code |
//! | [`contact`] | surfaces, search, projection, mortar, forces of contact pairs |
//! | [`linear`] | sparse matrices and their factors |
//! | [`mesh`] | nodes, elements, groups, shapes |
//! | [`laws`] | friction of interfaces, stress of bodies |
//!
//! Reading order: `main` → [`cli`] → [`case`] (JSON) → [`model::builder`] (defaults, checks) → [`model`] → [`run`] (steps,
//! increments, cut-back; [`time::step_size`] says how long) → [`time::increment`] (one increment: old state → new state) →
//! [`solve::newton`] → [`equations`] → {[`model::element`] → [`laws::bulk`]} and {[`contact`] → [`laws::friction`]}; then up
//! again: accepted [`model::state`] → [`output`].
//!
//! A law alone: [`cli`] → [`case`] → [`run::law`] along a [`run::law_path`] → [`laws::friction`] → [`output`].
//!
//! # Signs
//!
//! | symbol | in code | meaning |
//! |---|---|---|
//! | n, s | `normal`, `tangent` | unit normal out of the master; s = n turned by −90°, so (s, n) is right-handed |
//! | g | `gap` | (x_slave − x_foot)·n, positive when open |
//! | p | `pressure` | positive in compression |
//! | Δu_t | `slip` | motion of the slave relative to the master along s |
//! | q | `traction` | resists positive slip; the traction on the slave is p n − q s |
//!
//! Surfaces in the mesh have their body on the left; the segments of a master run along s, so its body is on the right.
//! The plane is a slice of depth 1 ([`mesh::section`]), units are any consistent set.
//!
//! # Invariants
//!
//! - A law is a pure function of (committed state, increment); it returns the stress or traction and the consistent
//!   tangent of exactly that.
//! - The traction is a scalar in the frame that turns with the interface; that is the co-rotational rate in 2D.
//! - Committed and trial state are two values: accepting a state is the commit, dropping it the roll-back.
//! - Sums run in a fixed order: the same input gives the same bits on any number of threads.
//! - A room imports only from lower ones, and no files import each other in a circle; `tests/layers.rs` holds the list.

#![allow(rustdoc::broken_intra_doc_links, reason = "units stand in brackets: [L], [F]")]

pub mod case;
#[cfg(feature = "cli")]
pub mod cli;
pub mod contact;
pub mod equations;
pub mod laws;
pub mod linear;
pub mod mesh;
pub mod model;
pub mod output;
pub mod run;
pub mod solve;
pub mod time;
