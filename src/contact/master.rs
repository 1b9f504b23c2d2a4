//! The master side of a contact.

use super::rigid::Rigid;
use super::surface::Surface;

/// The master side.
#[derive(Clone, Debug, PartialEq)]
pub enum Master {
    /// A surface of the mesh
    Mesh(Surface),
    /// A rigid body at rest
    Rigid(Rigid),
}
