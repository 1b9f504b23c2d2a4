//! Against published numbers: validation problems, spring and mass, faults, slip fronts.
//!
//! The slow ones are ignored and say by it which table of the documentation they recompute. They print it, one after the
//! other, by `cargo test --release --test published -- --ignored --nocapture --test-threads 1`.

#[path = "../common/mod.rs"]
mod common;

mod aids;
mod consolidation;
mod cycles;
mod faults;
mod fracture;
mod ground_and_metal;
mod ground_and_water;
mod healing;
mod law_cycles;
mod limit_loads;
mod paper;
mod published;
mod rupture;
mod safety;
mod slip_front;
mod strength;
mod water;
