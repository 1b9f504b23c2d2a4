//! Time: schemes, increments under error control, damping, impact, waves and the stability of sliding.

#[path = "../common/mod.rs"]
mod common;

mod adaptive;
mod columns;
mod conduit;
mod damping;
mod explicit;
mod fluid_pressure;
mod following;
mod impact;
mod quasi_dynamic;
mod radiation;
mod saturated;
mod saturated_contacts;
mod saturated_explicit;
mod slabs;
mod slip_control;
mod stability;
mod stability_map;
mod stiff;
mod switched_off;
mod switching;
mod time_integration;
