//! What is below and around contact: models from code, meshes, elements, supports and loads, linear solvers, Newton's method,
//! the state.

#[path = "../common/mod.rs"]
mod common;
#[path = "../common/grids.rs"]
mod grids;

mod boundary;
mod builder;
mod condensed;
mod constant;
mod elements;
mod history;
mod invariance;
mod linear;
mod mesh;
mod newton;
mod simulation;
mod terms;
