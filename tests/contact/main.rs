//! Contact: tangents and search of a pair, then whole models of bodies, points and surfaces that touch.

#[path = "../common/mod.rs"]
mod common;

mod along;
mod asperities;
mod bonds;
mod bonds_in_motion;
mod conduit;
mod contact;
mod corners;
mod faces;
mod few_edges;
mod fields;
mod hard;
mod interfaces;
mod moving;
mod outlines;
mod periodic;
mod points;
mod profiles;
mod random;
mod remedies;
mod ridges;
mod rigid_bodies;
mod rings;
mod scattered;
mod search;
mod segment_searches;
mod self_contact;
mod small_sliding;
mod stabilization;
mod stable;
mod tied;
mod validation;
mod warned;
