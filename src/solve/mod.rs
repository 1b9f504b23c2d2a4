//! Solving the equations of one increment: Newton's method, and what holds bodies that float.

pub mod floating;
pub mod newton;
