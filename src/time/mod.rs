//! From one accepted state to the next: implicit and explicit increments, and how long they are.

mod accept;
pub mod beginning;
pub mod explicit;
pub mod increment;
pub mod quasi_dynamic;
pub mod step_size;
pub mod touching;
