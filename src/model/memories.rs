//! Where each element finds what its material remembers.

use super::body::Body;
use super::element::SolidElement;

/// The part of every element in [`State::memory`](super::state::State::memory): one behind the other in the elements' order, as long
/// as its points and variables ask for, and of no length where a material remembers nothing.
#[derive(Clone, Debug)]
pub struct Memories {
    /// Where each part starts, and where the last one ends
    starts: Vec<usize>,
}

impl Memories {
    /// Of all elements, with the body of each.
    pub fn new(solids: &[SolidElement], bodies: &[Body], body_of_element: &[usize]) -> Self {
        let mut starts = vec![0];
        let mut end = 0;
        for (solid, &body) in solids.iter().zip(body_of_element) {
            end += solid.quadrature_points() * bodies[body].material.variables().len();
            starts.push(end);
        }
        Self { starts }
    }

    /// Number of values of all elements together.
    pub fn total(&self) -> usize {
        self.starts[self.starts.len() - 1]
    }

    /// The part of one element.
    pub fn of<'a>(&self, element: usize, memory: &'a [f64]) -> &'a [f64] {
        &memory[self.starts[element]..self.starts[element + 1]]
    }

    /// The parts of all elements in their order, to be written over. Whoever wants some of them passes over the others: no part can
    /// be handed to the wrong one.
    pub fn each_mut<'a>(&'a self, memory: &'a mut [f64]) -> impl Iterator<Item = &'a mut [f64]> {
        let mut rest = memory;
        self.starts.windows(2).map(move |ends| {
            let (own, after) = std::mem::take(&mut rest).split_at_mut(ends[1] - ends[0]);
            rest = after;
            own
        })
    }
}
