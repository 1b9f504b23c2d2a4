//! Against published numbers: validation problems, spring and mass, faults, slip fronts.
//!
//! The slow ones are ignored; `cargo test --release --test published -- --ignored --show-output` runs them all and prints
//! the tables of the README that they recompute, each under its name.

#[path = "../common/mod.rs"]
mod common;

mod paper;
mod published;
mod rupture;
mod slip_front;
