//! Laws of materials: friction of interfaces, stress of bodies.

pub mod bulk;
pub mod friction;
pub mod parameter;
