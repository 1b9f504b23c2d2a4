//! Residual and tangent of the model at a trial displacement.
//!
//! ```text
//! F(u) = internal + contact − loads
//! r    = (1 − α_f) F₁ + α_f F₀ + M ((1 − α_m) a₁ + α_m a₀)        free dofs
//! r    = w (u − ū)                                                prescribed dofs, w: a stiffness for scale
//! ```
//!
//! Elements and contact points are evaluated in parallel and added in a fixed order: results are bitwise identical for any
//! number of threads.
//!
//! The terms are summed in [`assembler`], each with its forces, its tangent on request, the dependence of the tangent
//! ([`sums::Dependence`]), and its contribution to the energy audit ([`evaluation`]).
//!
//! | term | contribution to F or r | contribution to the audit |
//! |---|---|---|
//! | `solids` | stress of the bodies | strain energy |
//! | `pore_flow` | balances of water that flows, and its pressure on elastic bodies | strain energy, work of the pressure |
//! | [`contacts`] | contact and friction | energy in penalties, friction, shrink fits |
//! | [`bars`] | trusses and beams | strain energy, energy of bond, friction, yielding |
//! | `loads` | −loads, springs, initial stress | work |
//! | [`damping`] | dashpots, absorbing sides | damping, work of drivers |
//! | [`damping`] | stabilizing dashpots | a part of damping |
//! | [`damping`] | viscous bodies | damping |
//! | [`inertia`] | M a | kinetic energy |
//! | [`supports`] | the equations of prescribed dofs and copies | work of reactions |
//! | [`links`] | the equations of follower nodes, and rigid platens in motion | none |

pub mod assembler;
pub mod bars;
mod channels;
pub mod condensed;
pub mod contacts;
mod convergence;
mod coupling;
pub mod damping;
pub mod evaluation;
mod evolving;
pub mod inertia;
pub mod links;
mod loads;
mod pore_flow;
pub mod slip_operator;
pub mod solids;
pub mod sums;
pub mod supports;
pub mod term;
pub mod trial;
mod water_balances;
pub mod wet_elements;

pub use assembler::Assembler;
pub use coupling::Coupling;
pub use evaluation::{ContactCounts, Evaluation, Seconds, regimes};
pub use solids::{LinearizedSolids, SolidForces};
pub use sums::TrialFailure;
pub use trial::Trial;
