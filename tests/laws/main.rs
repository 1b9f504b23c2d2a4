//! The laws alone: friction and bulk, against closed forms, differential equations and differences.

#[path = "../common/strokes.rs"]
mod strokes;

mod comparison_laws;
mod friction;
mod integration;
mod materials;
