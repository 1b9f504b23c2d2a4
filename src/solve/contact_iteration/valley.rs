//! Valleys: between two segments that form one, a foot may go to and fro for ever, each of the two tangents leading to the
//! other segment. It is presumed to be the node between them. Switch `valley`; `aid_valley` counts the points.
//!
//! Source: in a concave corner the gap is the lesser of two, with a kink where they are the same. From the node the normal goes
//! to the point, which lies between the normals of both sides, and Newton's method ends at the kink instead of crossing it.

use crate::contact::force::ContactState;
use crate::contact::pair::Presumption;

/// Segments of a point's feet at the linear solves of the increment.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Feet {
    /// At the last two solves
    last: [Option<usize>; 2],
    /// The two segments between which the foot went to and fro
    pub(super) astride: Option<[usize; 2]>,
}

impl Feet {
    /// Take note of the segment on which the next linear solve starts.
    pub(super) fn note(&mut self, state: &ContactState) {
        let segment = state.foot.map(|foot| foot.segment);
        let [last, before] = self.last;
        self.astride =
            segment.zip(last).filter(|(segment, last)| segment != last && Some(*segment) == before).map(Into::into);
        self.last = [segment, last];
    }
}

/// Whether the foot of a point is presumed to be the node between two segments, and is.
pub(super) fn acts(presumption: &Presumption, state: &ContactState) -> bool {
    presumption.astride.is_some() && state.foot.is_some_and(|foot| foot.xi == 1.0)
}
