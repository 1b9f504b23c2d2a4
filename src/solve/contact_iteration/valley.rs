//! Valleys: between two segments that form one, a foot may go to and fro for ever, each of the two tangents leading to the
//! other segment. It is presumed to lie between them.

use crate::contact::force::ContactState;

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
