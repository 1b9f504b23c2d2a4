//! What a folder of results holds, as plain numbers: for those who show it.

mod frames;
mod interface;

pub use frames::{Array, Frame, Grid, frames};
pub use interface::InterfaceMap;
