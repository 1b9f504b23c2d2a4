//! The laws alone: friction and bulk, against closed forms, differential equations and differences.

#[path = "../common/mod.rs"]
mod common;
#[path = "../common/strokes.rs"]
mod strokes;

mod comparison_laws;
mod controlled;
mod friction;
mod imposed;
mod integration;
mod materials;
mod offset;
mod random;
mod yielding;
