//! What is below and around contact: models from code, meshes, elements, supports and loads, linear solvers, Newton's method,
//! the state.

#[path = "../common/mod.rs"]
mod common;
#[path = "../common/grids.rs"]
mod grids;

mod bars;
mod bars_in_steps;
mod blocks;
mod boundary;
mod builder;
mod bystander;
mod clay;
mod condensed;
mod consolidation;
mod constant;
mod cuts;
mod elements;
mod groups;
mod history;
mod imposed;
mod invariance;
mod joints;
mod linear;
mod loading;
mod memory;
mod mesh;
mod newton;
mod plates;
mod pore_pressure;
mod recovery;
mod sections;
mod simulation;
mod spinning;
mod stability;
mod staged_water;
mod stages;
mod stressed;
mod symmetry;
mod terms;
mod turning;
mod wet_conduits;
mod wet_contacts;
mod yielding;
