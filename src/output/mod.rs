//! What a run leaves behind: observers of every attempt, and the files they write.

pub mod audit;
pub mod bodies;
pub mod checkpoint;
mod csv;
pub mod events;
pub mod fields;
pub mod files;
pub mod folder;
mod frames;
pub mod friction_history;
pub mod fronts;
pub mod history;
pub mod interface;
pub mod law;
pub mod newton_log;
pub mod probes;
pub mod quantities;
pub mod report;
mod results;
pub mod summary;
pub mod vtu;
pub mod warnings;
