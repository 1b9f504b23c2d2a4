//! Contact between a slave surface and a master: search → projection → kinematics → force, one file each.
//!
//! | method | stress error in the contact patch test (level, slope 0.2) | use it for |
//! |---|---|---|
//! | `node_to_segment` | 8e-2 | points and corners; coarse results at the least cost |
//! | `gauss_to_segment`, 2 to 4 points | 1e-2 to 7e-4 | large sliding, rigid masters; with α_n at its default (with higher values the pressures of an edge's points diverge) |
//! | `mortar` | below 1e-10 | non-matching meshes where accurate pressures are needed, stiff penalties, quadratic edges |
//!
//! Signs (all files): n is the unit normal out of the master at the projection x_m, s = n turned by −90°, so (s, n) is
//! right-handed. The gap g = (x_slave − x_m)·n is positive when open, the pressure p positive in compression, and
//! the traction on the slave is t = p n − q s.

mod averages;
mod between;
mod bonded;
pub mod conduit;
pub mod depth;
pub mod dual;
mod entering;
pub mod fluid;
pub mod force;
mod hats;
pub mod kinematics;
pub mod master;
mod meet;
pub mod mortar;
mod mortar_segments;
pub mod nodal_forces;
pub mod pair;
pub mod point;
pub mod pores;
pub mod projection;
pub mod response;
mod ridges;
pub mod scatter;
pub mod seam;
pub mod search;
pub mod segment_search;
pub mod segment_tree;
pub mod sight;
pub mod small_sliding;
pub mod stretch;
pub mod surface;

pub use master::Master;
pub use pair::ContactPair;
pub use point::ContactState;
pub use surface::SlavePoint;
