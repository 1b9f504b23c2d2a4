//! Where contributions wait while a forest is eliminated.

use super::front::Front;

/// Contributions that wait for the next fronts of a forest: those of fronts at an even depth grow from the low end,
/// those at an odd depth from the high end. So a front finds those of its children on top of one stack, and puts its
/// own on the other.
pub struct Stacks {
    pub values: Vec<f64>,
    low: usize,
    high: usize,
}

impl Stacks {
    /// Both empty, at the ends of this room.
    pub fn new(values: Vec<f64>) -> Self {
        Self { low: 0, high: values.len(), values }
    }

    /// Room for a contribution that is at hand, on the stack of the front.
    pub fn push(&mut self, front: &Front) -> &mut [f64] {
        let own = front.below() * front.below();
        if front.odd {
            self.high -= own;
            &mut self.values[self.high..][..own]
        } else {
            self.low += own;
            &mut self.values[self.low - own..self.low]
        }
    }

    /// Room for the contribution of a front, and the contributions of its children.
    pub fn next(&mut self, front: &Front, fronts: &[Front]) -> (&mut [f64], &[f64]) {
        let (own, children) = (front.below() * front.below(), children_values(front, fronts));
        if front.odd {
            let (low, high) = self.values[..self.high].split_at_mut(self.low);
            let room = high.len() - own;
            (&mut high[room..], &low[low.len() - children..])
        } else {
            let (low, high) = self.values.split_at_mut(self.high);
            (&mut low[self.low..][..own], &high[..children])
        }
    }

    /// The front is done: drop the contributions of its children and keep its own.
    pub fn pop(&mut self, front: &Front, fronts: &[Front]) {
        let (own, children) = (front.below() * front.below(), children_values(front, fronts));
        if front.odd {
            self.high -= own;
            self.low -= children;
        } else {
            self.low += own;
            self.high += children;
        }
    }
}

/// Number of values that the children of a front pass on.
fn children_values(front: &Front, fronts: &[Front]) -> usize {
    front.children.iter().map(|&child| fronts[child as usize].below().pow(2)).sum()
}
