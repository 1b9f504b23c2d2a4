//! What the aids did in one iteration.

/// Number of contact points on which each aid acted in the tangent of an iteration; 0 or 1 for those that know no points. All
/// are 0 where there was no new tangent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Acted {
    /// the increment starts as the last one went on
    pub start: usize,
    /// the geometric part of the tangent has promised tractions
    pub promise: usize,
    /// these were limited at the start of the increment
    pub limit: usize,
    /// closed for the promise alone
    pub keep: usize,
    /// closed because the committed state is
    pub pull: usize,
    /// friction answers to a carried pressure
    pub carried: usize,
    /// closed, and sticks, because it touches
    pub touch: usize,
    /// sticks because it slipped to and fro
    pub stick: usize,
    /// sticks once more
    pub stick_again: usize,
    /// its foot is the node between two segments
    pub valley: usize,
    /// it is one on the nodes at contacts alone
    pub condense: usize,
    /// the correction was searched for how far it leads downhill
    pub downhill: usize,
    /// the augmented Lagrangian is stiffened
    pub stiffening: usize,
}

impl Acted {
    /// Columns of `newton.csv`.
    pub const COLUMNS: [&str; 13] = [
        "aid_start",
        "aid_promise",
        "aid_limit",
        "aid_keep",
        "aid_pull",
        "aid_carried",
        "aid_touch",
        "aid_stick",
        "aid_stick_again",
        "aid_valley",
        "aid_condense",
        "aid_downhill",
        "aid_stiffening",
    ];

    /// The counts, in the order of the columns.
    pub fn counts(self) -> [usize; Self::COLUMNS.len()] {
        let Self { start, promise, limit, keep, pull, carried, touch, .. } = self;
        let Self { stick, stick_again, valley, condense, downhill, stiffening, .. } = self;
        [start, promise, limit, keep, pull, carried, touch, stick, stick_again, valley, condense, downhill, stiffening]
    }
}
