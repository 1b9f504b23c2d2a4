//! Time integration: one accepted state to the next by implicit or explicit increments, and their length.

mod accept;
pub mod beginning;
pub mod explicit;
pub mod increment;
pub mod neighbour;
pub mod quasi_dynamic;
pub mod step_size;
mod tearing;
pub mod touching;
