//! What a run leaves behind: observers of every attempt, and the files they write.

pub mod audit;
pub mod checkpoint;
mod csv;
pub mod fields;
pub mod files;
pub mod folder;
pub mod fronts;
pub mod history;
pub mod law;
pub mod lock;
mod memory;
pub mod newton_log;
mod passages;
pub mod plot;
pub mod summary;
pub mod vtu;
pub mod warnings;
pub mod wave_speeds;
