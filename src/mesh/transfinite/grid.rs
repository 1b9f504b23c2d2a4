//! Nodes of one block.
//!
//! Grading determines the sizes of elements along a side.

use nalgebra::{Rotation2, Vector2};

use super::{Block, BlockKind};
use crate::laws::text::distinct;
use crate::mesh::nearest::{NotOne, nearest};

/// Relative tolerance for equal radii at the ends of an arc, and for arcs shorter than a half circle.
const ROUND: f64 = 1e-6;

/// Number of points per side in the outline of a block.
const OUTLINE: usize = 32;

/// Nodes of a block, row by row, with slots counted over all blocks.
pub struct Grid {
    /// slot of its first node
    pub first: usize,
    /// positions
    pub nodes: Vec<Vector2<f64>>,
    /// spacings of nodes along side 0 and side 1
    count: [usize; 2],
    kind: BlockKind,
    /// whether its corners run counter-clockwise
    pub upright: bool,
    /// nine interior points
    pub inside: Vec<Vector2<f64>>,
    sides: Sides,
}

impl Grid {
    /// Creates the nodes of a block; an error describes its defect.
    pub fn new(block: &Block, first: usize) -> Result<Self, String> {
        let coordinates = block.corners.iter().chain(block.arcs.iter().flatten()).flatten();
        if let Some(bad) = coordinates.into_iter().find(|x| !x.is_finite()) {
            return Err(format!("has the coordinate {bad}: must be finite"));
        }
        let sides = Sides::new(block)?;
        let order = block.kind.order();
        let along = |k: usize| {
            shares(block.elements[k], block.grading[k], order).map_err(|message| format!("grading[{k}] {message}"))
        };
        let (columns, rows) = (along(0)?, along(1)?);
        let mut nodes = Vec::new();
        for (j, t) in rows.iter().enumerate() {
            let used =
                columns.iter().enumerate().filter(|(i, _)| block.kind != BlockKind::Q8 || i % 2 == 0 || j % 2 == 0);
            nodes.extend(used.map(|(_, s)| sides.place(*s, *t)));
        }
        let quarters = || [1.0, 2.0, 3.0].map(|part| Share::new(part, 4.0));
        let inside = quarters().into_iter().flat_map(|t| quarters().map(|s| sides.place(s, t))).collect();
        let count = block.elements.map(|elements| order * elements);
        let mut grid = Self { first, nodes, count, kind: block.kind, upright: true, inside, sides };
        grid.upright = area(&grid.outline()) > 0.0;
        grid.refuse_folds()?;
        Ok(grid)
    }

    /// Slot of the node in a column and a row of the grid.
    fn slot(&self, [i, j]: [usize; 2]) -> usize {
        let [n, _] = self.count;
        let local = match self.kind {
            BlockKind::Q4 | BlockKind::T6 => j * (n + 1) + i,
            // Rows through corners are full, those in between have every other node.
            BlockKind::Q8 if j % 2 == 0 => j / 2 * (n + 1 + n / 2 + 1) + i,
            BlockKind::Q8 => j / 2 * (n + 1 + n / 2 + 1) + n + 1 + i / 2,
        };
        self.first + local
    }

    /// Position of a slot.
    pub fn at(&self, slot: usize) -> Vector2<f64> {
        self.nodes[slot - self.first]
    }

    /// Position of a corner.
    pub fn corner(&self, corner: usize) -> Vector2<f64> {
        self.sides.corners[corner]
    }

    /// Distance of a point from a side.
    pub fn distance(&self, side: usize, at: Vector2<f64>) -> f64 {
        self.sides.distance(side, at)
    }

    /// Slots of the nodes along a side, from its corner to the next.
    pub fn side(&self, side: usize) -> Vec<usize> {
        let [n, m] = self.count;
        match side {
            0 => (0..=n).map(|i| self.slot([i, 0])).collect(),
            1 => (0..=m).map(|j| self.slot([n, j])).collect(),
            2 => (0..=n).rev().map(|i| self.slot([i, m])).collect(),
            _ => (0..=m).rev().map(|j| self.slot([0, j])).collect(),
        }
    }

    /// Edges of a side, opposite sides in the same order: end, end, and the middle of quadratic ones.
    pub fn edges(&self, side: usize) -> Vec<Vec<usize>> {
        let (mut nodes, order) = (self.side(side), self.kind.order());
        if side >= 2 {
            nodes.reverse();
        }
        let edge = |k: usize| [vec![nodes[k], nodes[k + order]], nodes[k + 1..k + order].to_vec()].concat();
        (0..nodes.len() - 1).step_by(order).map(edge).collect()
    }

    /// Column and row of the first corner of each cell, row by row.
    fn cells(&self) -> impl Iterator<Item = [usize; 2]> {
        let (order, [n, m]) = (self.kind.order(), self.count);
        (0..m).step_by(order).flat_map(move |j| (0..n).step_by(order).map(move |i| [i, j]))
    }

    /// Columns and rows of the corners of a cell, in turn.
    fn corners(&self, [i, j]: [usize; 2]) -> [[usize; 2]; 4] {
        let order = self.kind.order();
        [[i, j], [i + order, j], [i + order, j + order], [i, j + order]]
    }

    /// Elements, row by row: corners in order, then the middle nodes of their sides.
    pub fn elements(&self) -> Vec<Vec<usize>> {
        let element = |corners: &[[usize; 2]]| {
            let next = corners.iter().cycle().skip(1);
            let middles = corners.iter().zip(next).map(|(a, b)| [0, 1].map(|k| (a[k] + b[k]) / 2));
            let middles = middles.filter(|_| self.kind.order() == 2);
            corners.iter().copied().chain(middles).map(|at| self.slot(at)).collect()
        };
        let of_cell = |at: [usize; 2]| {
            let [a, b, c, d] = self.corners(at);
            match (self.kind, (at[0] + at[1]) / 2 % 2) {
                (BlockKind::Q4 | BlockKind::Q8, _) => vec![element(&[a, b, c, d])],
                (BlockKind::T6, 0) => vec![element(&[a, b, c]), element(&[a, c, d])],
                (BlockKind::T6, _) => vec![element(&[a, b, d]), element(&[b, c, d])],
            }
        };
        self.cells().flat_map(of_cell).collect()
    }

    /// Slot of the one node nearest to a point.
    pub fn nearest(&self, point: [f64; 2]) -> Result<usize, String> {
        let [x, y] = point;
        let mut elements = self.elements();
        elements.iter_mut().flatten().for_each(|slot| *slot -= self.first);
        let node = nearest(&self.nodes, elements.iter().map(Vec::as_slice), point).map_err(|not_one| match not_one {
            NotOne::NoPlace | NotOne::NoNodes => format!("({x}, {y}) is not a position: give finite numbers"),
            NotOne::Several(both) => {
                let [one, other] = both.map(|node| self.nodes[node]);
                format!(
                    "the nodes at ({}, {}) and ({}, {}) are equally near to ({x}, {y}): give the place of one",
                    one.x, one.y, other.x, other.y
                )
            }
            NotOne::Far { node, distance } => format!(
                "no node of this block is near ({x}, {y}): the nearest, at ({}, {}), lies {distance:.4} away, farther than the size \
                 of the elements there",
                self.nodes[node].x, self.nodes[node].y
            ),
        })?;
        Ok(self.first + node)
    }

    /// Points of the outline, starting at corner 0.
    pub fn outline(&self) -> Vec<Vector2<f64>> {
        let place = |k: usize| {
            let (side, step) = (k / OUTLINE, k % OUTLINE);
            let part = if side < 2 { step } else { OUTLINE - step };
            self.sides.on(side, Share::new(part as f64, OUTLINE as f64))
        };
        (0..4 * OUTLINE).map(place).collect()
    }

    /// Every corner of every cell must be one less than a half turn.
    fn refuse_folds(&self) -> Result<(), String> {
        let turn = if self.upright { 1.0 } else { -1.0 };
        for cell in self.cells() {
            let corners = self.corners(cell).map(|at| self.at(self.slot(at)));
            if wrong_turns(&corners, turn) == 0 {
                continue;
            }
            let [x, y]: [f64; 2] = (0.25 * corners.iter().sum::<Vector2<f64>>()).into();
            let cause = match wrong_turns(&self.sides.corners, turn) {
                0 => "its arcs distort it too much: divide it",
                1 => "it has an interior angle of 180° or more: divide it there",
                _ => "two of its sides cross or coincide: give its corners in order around the block",
            };
            return Err(format!("has elements that are folded or flat, near ({x}, {y}); {cause}"));
        }
        Ok(())
    }
}

/// Number of corners of a polygon with the wrong or no turn.
fn wrong_turns(corners: &[Vector2<f64>], turn: f64) -> usize {
    let n = corners.len();
    let at = |k: usize| (corners[(k + 1) % n] - corners[k]).perp(&(corners[(k + 2) % n] - corners[(k + 1) % n]));
    (0..n).filter(|k| turn * at(*k) <= 0.0).count()
}

/// Area of a polygon, positive if it runs counter-clockwise.
fn area(polygon: &[Vector2<f64>]) -> f64 {
    let arms = polygon.iter().map(|x| x - polygon[0]).collect::<Vec<_>>();
    arms.windows(2).map(|pair| 0.5 * pair[0].perp(&pair[1])).sum()
}

/// Corners of each side, in the direction of growing s or t of the map.
const ENDS: [[usize; 2]; 4] = [[0, 1], [1, 2], [3, 2], [0, 3]];

/// The four sides of a block.
struct Sides {
    corners: [Vector2<f64>; 4],
    /// for each arc, the centre of its circle and its signed angle
    arcs: [Option<(Vector2<f64>, f64)>; 4],
}

impl Sides {
    fn new(block: &Block) -> Result<Self, String> {
        let corners = block.corners.map(Vector2::from);
        let mut arcs = [None; 4];
        for (k, centre) in block.arcs.iter().enumerate() {
            let Some(centre) = centre.map(Vector2::from) else { continue };
            let [a, b] = ENDS[k].map(|corner| corners[corner] - centre);
            let angle = a.perp(&b).atan2(a.dot(&b));
            let (one, other) = (a.norm(), b.norm());
            if (one - other).abs() > ROUND * one.max(other) {
                let [first, second] = ENDS[k];
                let [one, other] = distinct([one, other]);
                return Err(format!(
                    "arcs[{k}]: corner {first} is {one} from the centre, and corner {second} {other}: give the centre of a \
                     circle through both"
                ));
            }
            if !(angle != 0.0 && angle.abs() < (1.0 - ROUND) * std::f64::consts::PI) {
                let message = "spans a half circle, or no angle: an arc follows the shorter direction, so divide the \
                               block";
                return Err(format!("arcs[{k}] {message}"));
            }
            arcs[k] = Some((centre, angle));
        }
        Ok(Self { corners, arcs })
    }

    fn ends(&self, side: usize) -> [Vector2<f64>; 2] {
        ENDS[side].map(|corner| self.corners[corner])
    }

    fn chord(&self, side: usize, s: Share) -> Vector2<f64> {
        let [a, b] = self.ends(side);
        Vector2::new(s.between(a.x, b.x), s.between(a.y, b.y))
    }

    /// Point on a side.
    fn on(&self, side: usize, s: Share) -> Vector2<f64> {
        let ([a, b], share) = (self.ends(side), s.between(0.0, 1.0));
        match self.arcs[side] {
            Some((centre, angle)) if share > 0.0 && share < 1.0 => {
                let [from, to] = [a - centre, b - centre];
                let radius = s.between(from.norm(), to.norm());
                centre + Rotation2::new(share * angle) * from * (radius / from.norm())
            }
            _ => self.chord(side, s),
        }
    }

    fn distance(&self, side: usize, at: Vector2<f64>) -> f64 {
        let [a, b] = self.ends(side);
        let (share, master_point) = match self.arcs[side] {
            Some((centre, angle)) => {
                let (from, arm) = (a - centre, at - centre);
                (from.perp(&arm).atan2(from.dot(&arm)) / angle, centre + arm * (from.norm() / arm.norm()))
            }
            None => {
                let share = (at - a).dot(&(b - a)) / (b - a).norm_squared();
                (share, a + share * (b - a))
            }
        };
        let master_point = if share <= 0.0 {
            a
        } else if share >= 1.0 {
            b
        } else {
            master_point
        };
        let beyond = (at - a).norm().min((at - b).norm());
        (at - master_point).norm().min(beyond)
    }

    /// Offset of a curved side from its chord; zero where it is straight.
    fn bulge(&self, side: usize, s: Share) -> Vector2<f64> {
        self.on(side, s) - self.chord(side, s)
    }

    /// Position by the transfinite map.
    fn place(&self, s: Share, t: Share) -> Vector2<f64> {
        let (below, above) = (self.on(0, s), self.on(2, s));
        let (left, right) = (self.bulge(3, t), self.bulge(1, t));
        let at = |i: usize| t.between(below[i], above[i]) + s.between(left[i], right[i]);
        Vector2::new(at(0), at(1))
    }
}

/// Geometric grading of the element sizes along a side.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Grading {
    /// size of the last element divided by that of the first
    Ratio(f64),
    /// size in the middle divided by that at both ends
    Middle(f64),
}

impl Default for Grading {
    fn default() -> Self {
        Self::Ratio(1.0)
    }
}

/// Fraction of a whole, stored so that even parts of an exactly representable length are exact.
#[derive(Clone, Copy, Debug)]
pub struct Share {
    part: f64,
    whole: f64,
}

impl Share {
    /// Creates the fraction part/whole.
    pub fn new(part: f64, whole: f64) -> Self {
        Self { part, whole }
    }

    /// Returns the point between a and b.
    pub fn between(self, a: f64, b: f64) -> f64 {
        if self.part == self.whole { b } else { a + (b - a) * self.part / self.whole }
    }
}

/// Fractions at the nodes of `count` elements of the given `order`.
pub fn shares(count: usize, grading: Grading, order: usize) -> Result<Vec<Share>, String> {
    let (ratio, what) = match grading {
        Grading::Ratio(ratio) => (ratio, "the last element over the first"),
        Grading::Middle(ratio) => (ratio, "the elements in the middle over those at both ends"),
    };
    if !(ratio > 0.0 && ratio.is_finite()) {
        return Err(format!("is {ratio}: must be positive, the size of {what}"));
    }
    let last = match grading {
        Grading::Ratio(_) => count - 1,
        Grading::Middle(_) => (count - 1) / 2,
    };
    if last == 0 && ratio != 1.0 {
        return Err(format!("is {ratio}, and {count} elements have one size: take more elements, or 1"));
    }
    let size = |k: usize| {
        let step = match grading {
            Grading::Ratio(_) => k,
            Grading::Middle(_) => k.min(count - 1 - k),
        };
        ratio.powf(step as f64 / last.max(1) as f64)
    };
    let mut ends = vec![0.0];
    (0..count).for_each(|k| ends.push(ends[k] + size(k)));
    let whole = ends[count];
    let part = |i: usize| match i % order {
        0 => ends[i / order],
        _ => 0.5 * (ends[i / order] + ends[i / order + 1]),
    };
    Ok((0..=count * order).map(|i| Share::new(part(i), whole)).collect())
}
