//! The program from the command line: what it reads and refuses, prints, writes and draws.

#[path = "../common/mod.rs"]
mod common;

mod convergence;
mod input;
mod law;
mod plot;
mod results;
mod schema;
