//! The laws alone: friction and bulk, against closed forms, differential equations and differences.

// What `with` does, to defaults too.
#![allow(clippy::field_reassign_with_default)]

/// A value with other fields: structures that may grow are not written out from outside the library.
macro_rules! with {
    ($value:expr $(, $field:ident: $new:expr)+ $(,)?) => {{
        let mut value = $value;
        $(value.$field = $new;)+
        value
    }};
}

#[path = "../common/mod.rs"]
mod common;
#[path = "../common/strokes.rs"]
mod strokes;

mod adhesion;
mod approach;
mod bond;
mod bulk;
mod cam_clay;
mod comparison_laws;
mod controlled;
mod depth;
mod direct_effect;
mod friction;
mod imposed;
mod integration;
mod materials;
mod offset;
mod plasticity;
mod pressed;
mod random;
mod sys_cam_clay;
mod undrained;
mod yielding;
