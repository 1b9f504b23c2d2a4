//! Constitutive laws: friction of interfaces, stress of bodies.

#[macro_use]
pub mod parameter;

#[doc(hidden)]
pub mod approach;
pub mod bulk;
pub(crate) mod dual;
pub mod friction;
pub(crate) mod tableau;
pub(crate) mod text;
