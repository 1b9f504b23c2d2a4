//! Search for the boxes that intersect a given box: a tree of bounding boxes, each divided in halves along its longer side.

use nalgebra::Vector2;

/// An axis-parallel box [L].
#[derive(Clone, Copy, Debug)]
pub struct Box2 {
    /// lower left corner
    pub low: Vector2<f64>,
    /// upper right corner
    pub high: Vector2<f64>,
}

impl Box2 {
    /// Returns the bounding box of positions; `None` if there are none.
    pub fn around(places: impl IntoIterator<Item = Vector2<f64>>) -> Option<Self> {
        places.into_iter().map(|at| Self { low: at, high: at }).reduce(Self::with)
    }

    /// Returns the bounding box of two boxes.
    #[must_use]
    pub fn with(self, other: Self) -> Self {
        Self { low: self.low.inf(&other.low), high: self.high.sup(&other.high) }
    }

    /// Returns the box extended by a margin on every side.
    #[must_use]
    pub fn wider(self, margin: f64) -> Self {
        Self { low: self.low.add_scalar(-margin), high: self.high.add_scalar(margin) }
    }

    /// Lengths of the sides of the box.
    pub fn size(&self) -> Vector2<f64> {
        self.high - self.low
    }

    /// Middle of the box.
    pub fn centre(&self) -> Vector2<f64> {
        0.5 * (self.low + self.high)
    }

    /// Squared distance of a point from the box, 0 inside it.
    pub fn squared_distance(&self, point: Vector2<f64>) -> f64 {
        (self.low - point).sup(&(point - self.high)).sup(&Vector2::zeros()).norm_squared()
    }

    /// Whether two boxes intersect.
    pub fn meets(&self, other: &Self) -> bool {
        (0..2).all(|i| self.low[i] <= other.high[i] && other.low[i] <= self.high[i])
    }
}

/// A tree of boxes; each keeps its number in the given order.
#[derive(Debug)]
pub struct Tree {
    /// boxes in the order of the leaves
    boxes: Vec<(Box2, usize)>,
    /// bounding box of each part of the tree; the halves of part k are 2 k + 1 and 2 k + 2
    around: Vec<Option<Box2>>,
}

impl Tree {
    /// Creates the tree of boxes, O(n log n).
    pub fn new(boxes: impl Iterator<Item = Box2>) -> Self {
        let mut boxes: Vec<(Box2, usize)> = boxes.zip(0..).collect();
        let mut around = vec![None; 2 * boxes.len().next_power_of_two()];
        divide(&mut boxes, 0, &mut around);
        Self { boxes, around }
    }

    /// Returns the numbers of the boxes that intersect a box, ascending.
    pub fn meeting(&self, other: &Box2) -> Vec<usize> {
        let mut found = Vec::new();
        let mut parts = vec![(0, 0..self.boxes.len())];
        while let Some((part, leaves)) = parts.pop() {
            if !self.around[part].is_some_and(|around| around.meets(other)) {
                continue;
            }
            if leaves.len() == 1 {
                found.push(self.boxes[leaves.start].1);
                continue;
            }
            let middle = leaves.start + leaves.len() / 2;
            parts.extend([(2 * part + 1, leaves.start..middle), (2 * part + 2, middle..leaves.end)]);
        }
        found.sort_unstable();
        found
    }
}

/// Divides the boxes of a part into two halves, recursively down to single ones.
fn divide(boxes: &mut [(Box2, usize)], part: usize, around: &mut [Option<Box2>]) {
    let Some(all) = boxes.iter().map(|(own, _)| *own).reduce(Box2::with) else { return };
    around[part] = Some(all);
    if boxes.len() == 1 {
        return;
    }
    let axis = usize::from(all.size().y > all.size().x);
    let middle = boxes.len() / 2;
    let centre = |own: &Box2| own.low[axis] + own.high[axis];
    boxes.select_nth_unstable_by(middle, |(a, _), (b, _)| centre(a).total_cmp(&centre(b)));
    let (first, second) = boxes.split_at_mut(middle);
    divide(first, 2 * part + 1, around);
    divide(second, 2 * part + 2, around);
}
