//! Constitutive laws: friction of interfaces, stress of bodies.

pub mod bulk;
pub mod friction;
pub mod parameter;
