//! A 2D finite-element contact solver whose interfaces obey the time-dependent super/subloading-surface friction law.
//!
//! # The way through the house
//!
//! Reading order: `main` → [`command`] → [`case`] (JSON → checks → model) → [`model`] → [`run`] (steps, increments,
//! cut-back; [`increments`] says how long) → [`step`] (one increment: old state → new state) → [`newton`] → [`assembly`]
//! → {[`element`] → [`material`]} and {[`contact`] → [`friction`]}; then up again: accepted [`state`] → [`output`].
//!
//! A law alone: [`command`] → [`case`] → [`law_driver`] along a [`law_path`] → [`friction`] → [`output`].
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
//! Thickness is 1, units are any consistent set.
//!
//! # Invariants
//!
//! - A law is a pure function of (committed state, increment); it returns the stress or traction and the consistent
//!   tangent of exactly that.
//! - The traction is a scalar in the frame that turns with the interface; that is the co-rotational rate in 2D.
//! - Committed and trial state are two values: accepting a state is the commit, dropping it the roll-back.
//! - Sums run in a fixed order: the same input gives the same bits on any number of threads.
//! - A module imports only from lower layers; `tests/layers.rs` holds the list.

#![allow(rustdoc::broken_intra_doc_links, reason = "units stand in brackets: [L], [F]")]

pub mod assembly;
pub mod boundary;
pub mod case;
#[cfg(feature = "cli")]
pub mod command;
pub mod configuration;
pub mod contact;
pub mod element;
pub mod energy;
pub mod error;
pub mod explicit;
pub mod floating;
pub mod friction;
pub mod increments;
pub mod law_driver;
pub mod law_path;
pub mod linear;
pub mod material;
pub mod mesh;
pub mod model;
pub mod newton;
pub mod output;
pub mod parameter;
pub mod run;
pub mod shape;
pub mod state;
pub mod step;
pub mod system;
pub mod ties;
pub mod time;
