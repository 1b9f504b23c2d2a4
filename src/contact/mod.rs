//! Contact between a slave surface and a master: search → projection → kinematics → force, one file each.
//!
//! Signs (all files): n is the unit normal out of the master at the foot point, s = n turned by −90°, so (s, n) is
//! right-handed. The gap g = (x_slave − x_foot)·n is positive when open, the pressure p positive in compression, and
//! the traction on the slave is t = p n − q s.

pub mod dual;
pub mod force;
pub mod kinematics;
pub mod mortar;
pub mod pair;
pub mod projection;
pub mod rigid;
pub mod search;
pub mod surface;
