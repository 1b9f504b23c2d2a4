//! Joins blocks that share a side, which then have the same nodes there; refuses blocks that touch otherwise.

use std::collections::BTreeSet;

use nalgebra::Vector2;

use super::grid::Grid;
use super::{BlockError, Blocks};
use crate::mesh::boxes::{Box2, Tree};
use crate::mesh::joined::Joined;

/// Tolerance for coinciding points, as a fraction of the shortest side.
const SAME: f64 = 1e-6;

/// Margin for the deviation of arcs from the sampled outline, as a fraction of the size of a block.
const MARGIN: f64 = 0.01;

/// A side of a block.
type Side = (usize, usize);

/// Returns the number of the node in each slot.
pub fn joined(blocks: &Blocks, grids: &[Grid]) -> Result<Vec<usize>, BlockError> {
    let slots = grids.iter().map(|grid| grid.nodes.len()).sum();
    let separated: BTreeSet<&String> = blocks.separated.iter().collect();
    let is_separated = |name: &Option<String>| name.as_ref().is_some_and(|name| separated.contains(name));
    let mut join = Join {
        blocks,
        grids,
        separated: blocks
            .blocks
            .iter()
            .map(|block| [0, 1, 2, 3].map(|side| is_separated(&block.sides[side])))
            .collect(),
        same: Joined::new(slots),
        partner: vec![[None; 4]; grids.len()],
    };
    let pairs = neighbours(blocks, grids);
    for &[a, b] in &pairs {
        for side in 0..16 {
            join.sides((a, side / 4), (b, side % 4))?;
        }
    }
    for [a, b] in pairs {
        join.refuse_touching(a, b)?;
        join.refuse_touching(b, a)?;
        join.refuse_overlap(a, b)?;
        join.refuse_overlap(b, a)?;
    }
    join.refuse_strangers()?;
    Ok(join.numbers())
}

/// Pairs of blocks of one body, or of joined bodies, that may touch, ordered by the second block.
fn neighbours(blocks: &Blocks, grids: &[Grid]) -> Vec<[usize; 2]> {
    let boxes: Vec<Box2> = grids.iter().filter_map(reach).collect();
    let tree = Tree::new(boxes.iter().copied());
    let may_join = |[a, b]: &[usize; 2]| {
        let both = [*a, *b].map(|block| &blocks.blocks[block].body);
        both[0] == both[1] || blocks.joined.iter().any(|list| both.iter().all(|body| list.contains(body)))
    };
    let before =
        |(b, own): (usize, &Box2)| tree.meeting(own).into_iter().take_while(move |a| *a < b).map(move |a| [a, b]);
    boxes.iter().enumerate().flat_map(before).filter(may_join).collect()
}

/// Bounding box of a block, extended by a margin for arcs.
fn reach(grid: &Grid) -> Option<Box2> {
    let places = grid.outline().into_iter().chain(grid.inside.iter().copied());
    let own = Box2::around(places)?;
    let farthest = own.low.amax().max(own.high.amax());
    Some(own.wider(MARGIN * own.size().norm() + 8.0 * f64::EPSILON * farthest))
}

struct Join<'b> {
    blocks: &'b Blocks,
    grids: &'b [Grid],
    /// sides excluded from joining
    separated: Vec<[bool; 4]>,
    /// slots of the same node
    same: Joined,
    /// partner of each side
    partner: Vec<[Option<Side>; 4]>,
}

impl Join<'_> {
    /// Joins two sides if they coincide.
    fn sides(&mut self, one: Side, other: Side) -> Result<(), BlockError> {
        if self.separated[one.0][one.1] || self.separated[other.0][other.1] {
            return Ok(());
        }
        let [a, mut b] = [one, other].map(|(block, side)| self.grids[block].side(side));
        let near = self.near(one.0, other.0);
        let at = |(block, _): Side, slot: usize| self.grids[block].at(slot);
        let together = |a: usize, b: usize| (at(one, a) - at(other, b)).norm() <= near;
        let (ends, last) = ([a[0], a[a.len() - 1]], b.len() - 1);
        let opposite = together(ends[0], b[last]) && together(ends[1], b[0]);
        let alike = together(ends[0], b[0]) && together(ends[1], b[last]);
        if !(opposite || alike) {
            return Ok(());
        }
        if opposite {
            b.reverse();
        }
        if a.len() != b.len() {
            let message = format!(
                "and has {} nodes there to {}: give both the same number and kind of elements, or list a name of one of the \
                 sides in `separated`",
                b.len(),
                a.len()
            );
            return Err(self.complain(one, other, &message));
        }
        if !a.iter().zip(&b).all(|(a, b)| together(*a, *b)) {
            let message = "but its nodes are at other positions between the ends: give both the same grading, seen \
                           from the same end, and the same arc";
            return Err(self.complain(one, other, message));
        }
        // Along a shared side, blocks of equal orientation run in opposite directions.
        if opposite != (self.grids[one.0].upright == self.grids[other.0].upright) {
            return Err(self.complain(one, other, "on the same side of it: the two overlap; remove one"));
        }
        self.partners(one, other)?;
        a.into_iter().zip(b).for_each(|(a, b)| self.same.join(a, b));
        Ok(())
    }

    /// Checks that two sides are joined to each other and to no third one, and have no names inside a body.
    fn partners(&mut self, one: Side, other: Side) -> Result<(), BlockError> {
        for (side, partner) in [(one, other), (other, one)] {
            if let Some(third) = self.partner[side.0][side.1].replace(partner) {
                let message = format!("which is joined to blocks[{}] already: the blocks overlap; remove one", third.0);
                return Err(self.complain(one, other, &message));
            }
            if let Some(name) = &self.blocks.blocks[side.0].sides[side.1] {
                let bodies = [side, partner].map(|(block, _)| &self.blocks.blocks[block].body);
                if bodies[0] != bodies[1] {
                    // A side of that which stays when the other goes, as far as the steps tell.
                    continue;
                }
                let message = format!(
                    "is joined to side {} of blocks[{}], so `{name}` lies inside the body: leave the name out, or list it in `separated` if \
                     the two sides can part",
                    partner.1, partner.0
                );
                return Err(BlockError::new(format!("blocks[{}].sides[{}]", side.0, side.1), message));
            }
        }
        Ok(())
    }

    fn complain(&self, one: Side, other: Side, message: &str) -> BlockError {
        let what = format!("its side {} is side {} of blocks[{}], {message}", other.1, one.1, one.0);
        BlockError::new(format!("blocks[{}]", other.0), what)
    }

    /// Distance below which places of two blocks coincide.
    fn near(&self, a: usize, b: usize) -> f64 {
        let corners = [a, b].map(|block| [0, 1, 2, 3].map(|corner| self.grids[block].corner(corner)));
        let sides = corners.iter().flat_map(|c| (0..4).map(|k| (c[(k + 1) % 4] - c[k]).norm()));
        let farthest = corners.iter().flatten().fold(0.0f64, |most, corner| most.max(corner.amax()));
        (SAME * sides.fold(f64::INFINITY, f64::min)).max(8.0 * f64::EPSILON * farthest)
    }

    /// Refuses a corner of `a` on a side of `b` that is none of its nodes; sides in `separated` may meet there.
    fn refuse_touching(&self, a: usize, b: usize) -> Result<(), BlockError> {
        let near = self.near(a, b);
        for corner in 0..4 {
            let (slot, at) = (self.same.lowest(self.grids[a].side(corner)[0]), self.grids[a].corner(corner));
            let touched: Vec<usize> = (0..4).filter(|side| self.grids[b].distance(*side, at) <= near).collect();
            let separated = |block: usize, sides: &[usize]| sides.iter().any(|side| self.separated[block][*side]);
            let Some(side) = touched.first() else { continue };
            let joined =
                touched.iter().any(|side| self.grids[b].side(*side).iter().any(|&node| self.same.lowest(node) == slot));
            if !(joined || separated(a, &[corner, (corner + 3) % 4]) || separated(b, &touched)) {
                let message = format!(
                    "its corner {corner} lies on side {side} of blocks[{b}] and is not joined to it: blocks of a body are joined \
                     along whole sides, and so are those of bodies that are joined. Divide blocks[{b}] there, or list a name \
                     of one of the sides in `separated`"
                );
                return Err(BlockError::new(format!("blocks[{a}]"), message));
            }
        }
        Ok(())
    }

    /// Refuses points of `a` inside `b`.
    fn refuse_overlap(&self, a: usize, b: usize) -> Result<(), BlockError> {
        let outline = self.grids[b].outline();
        match self.grids[a].inside.iter().find(|at| is_inside(**at, &outline)) {
            Some(at) => {
                let message = format!(
                    "overlaps blocks[{b}], for example at ({}, {}): move it, or give it another body",
                    at.x, at.y
                );
                Err(BlockError::new(format!("blocks[{a}]"), message))
            }
            None => Ok(()),
        }
    }

    /// Refuses a body that is listed as joined but shares no side with another one of its list.
    fn refuse_strangers(&self) -> Result<(), BlockError> {
        let body = |block: usize| &self.blocks.blocks[block].body;
        let partners = |block: usize| self.partner[block].iter().flatten().map(|(other, _)| body(*other));
        for (k, list) in self.blocks.joined.iter().enumerate() {
            let meets = |name: &String| {
                let own = (0..self.grids.len()).filter(|block| body(*block) == name);
                own.flat_map(partners).any(|other| other != name && list.contains(other))
            };
            if let Some(name) = list.iter().find(|name| !meets(name)) {
                let message = format!(
                    "no block of `{name}` shares a whole side with one of the others: move it there, or leave it out"
                );
                return Err(BlockError::new(format!("joined[{k}]"), message));
            }
        }
        Ok(())
    }

    /// Node numbers in the order of first occurrence.
    fn numbers(self) -> Vec<usize> {
        let nodes = self.same.groups().into_iter().enumerate();
        let mut slots: Vec<(usize, usize)> =
            nodes.flat_map(|(number, slots)| slots.into_iter().map(move |slot| (slot, number))).collect();
        slots.sort_unstable();
        slots.into_iter().map(|(_, number)| number).collect()
    }
}

/// Whether a point is inside a polygon: a ray to the right crosses an odd number of edges.
fn is_inside(at: Vector2<f64>, polygon: &[Vector2<f64>]) -> bool {
    let next = polygon.iter().cycle().skip(1);
    let crosses = |(a, b): &(&Vector2<f64>, &Vector2<f64>)| {
        (a.y > at.y) != (b.y > at.y) && at.x < a.x + (b.x - a.x) * (at.y - a.y) / (b.y - a.y)
    };
    polygon.iter().zip(next).filter(crosses).count() % 2 == 1
}
