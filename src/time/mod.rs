//! From one accepted state to the next: implicit and explicit increments, and how long they are.

pub mod explicit;
pub mod increment;
pub mod step_size;
