//! Features crossed with each other: small models drawn at random over all of them, written in many ways that mean the same.
//!
//! `CROSSINGS=20000 cargo test --release --test crossings -- --nocapture` tries as many seeds (60 unless given, from `FIRST` on),
//! and prints for everything that breaks the seed, the relation, the worst quantity and a case with as few features as still break it;
//! (`CASES=1` prints it as JSON, `DUMP=FOLDER` leaves every case that is run there, `RELATION=moved` holds all models to one relation);
//! at the end how many models were solved, what was refused, and how often every pair of features was solved, closed and slipping.

mod features;
mod frame;
mod hunt;
mod law;
mod mesh;
mod model;
mod pairs;
mod record;
mod relations;
mod schema;
