//! Constitutive laws: friction of interfaces, stress of bodies.

#[doc(hidden)]
pub mod approach;
pub mod bulk;
mod dual;
pub mod friction;
pub mod parameter;
pub(crate) mod tableau;
pub(crate) mod text;
