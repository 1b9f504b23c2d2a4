//! Constitutive laws: friction of interfaces, stress of bodies.

mod approach;
pub mod bulk;
mod dual;
pub mod friction;
pub mod parameter;
pub(crate) mod tableau;
pub(crate) mod text;
