//! The program from the command line: what it reads and refuses, prints, writes and draws.

#[path = "../common/mod.rs"]
mod common;
#[path = "../common/delayed.rs"]
mod delayed;

mod by_name;
mod committed;
mod converge;
mod convergence;
mod gradients;
mod gradients_of_water;
mod init;
mod input;
mod law;
mod law_bond;
mod layout;
mod many;
mod mutations;
mod outputs;
mod progress;
mod readme;
mod report;
mod resolved;
mod results;
mod run_log;
mod schema;
mod slider;
mod surface;
mod survive;
mod units;
mod warnings;
