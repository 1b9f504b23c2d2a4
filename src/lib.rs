//! A 2D finite-element contact solver whose interfaces obey the time-dependent
//! super/subloading-surface friction law.

pub mod element;
pub mod friction;
pub mod material;
pub mod mesh;
pub mod shape;
