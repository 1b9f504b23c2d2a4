//! Loading plates as they are given.

/// How the nodes of a loading plate move.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Plate {
    /// all alike: the plate does not turn
    #[default]
    AsOne,
    /// alike in x, each as it will in y
    UxAlike,
    /// alike in y, each as it will in x
    UyAlike,
    /// as a rigid body, which turns
    Rigid,
}
