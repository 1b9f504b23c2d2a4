//! Searches of segments other than the tree: in a grid of square cells, and through all segments. The tree answers as they do, and
//! `cargo bench` measures it against them.

use std::ops::RangeInclusive;

use fecontact::contact::segment_search::{SegmentSearch, bounding_box, squared_distance};
use fecontact::contact::surface::{Segment, SlavePoint, Surface};
use fecontact::mesh::boxes::Box2;
use fecontact::mesh::configuration::Configuration;
use nalgebra::Vector2;

/// A grid of square cells over a surface; each cell lists the segments whose bounding boxes touch it.
#[derive(Clone, Debug, Default)]
pub struct SegmentGrid {
    /// Lower left corner of the grid, relative to the surface's origin
    low: Vector2<f64>,
    /// Side of a cell [L]
    side: f64,
    /// Cells in x and y
    counts: [usize; 2],
    /// Cells that the box of each segment touches
    blocks: Vec<Block>,
    /// Segments of each cell, row by row
    cells: Vec<Vec<usize>>,
}

/// A rectangle of cells, in x and y.
#[derive(Clone, Debug)]
struct Block([RangeInclusive<usize>; 2]);

/// Share of a cell by which the cells searched are trusted less, against round-off.
const TRUST: f64 = 1e-6;

impl SegmentGrid {
    /// Cell of a position, or the nearest one from outside the grid.
    fn cell(&self, at: Vector2<f64>) -> [usize; 2] {
        let place = (at - self.low) / self.side;
        [0, 1].map(|axis| (place[axis] as usize).min(self.counts[axis].saturating_sub(1)))
    }

    fn block(&self, bounds: &Box2) -> Block {
        let (low, high) = (self.cell(bounds.low), self.cell(bounds.high));
        Block([0, 1].map(|axis| low[axis]..=high[axis]))
    }

    fn segments(&self, Block([across, up]): Block) -> impl Iterator<Item = usize> {
        let cells = up.flat_map(move |row| across.clone().map(move |column| row * self.counts[0] + column));
        cells.flat_map(|cell| self.cells[cell].iter().copied())
    }

    /// Segments whose nearest cell is in the ring of cells at a distance of so many cells from one, ascending.
    fn ring(&self, around: [usize; 2], distance: usize) -> Vec<usize> {
        let [column, row] = around;
        let clipped = |axis: usize, from: usize, to: usize| from..=to.min(self.counts[axis] - 1);
        let across = clipped(0, column.saturating_sub(distance), column + distance);
        let sides = [row.checked_sub(distance), Some(row + distance)].map(|row| (row, across.clone()));
        let sides = sides.into_iter().filter_map(|(row, across)| Some(Block([across, clipped(1, row?, row?)])));
        let between = clipped(1, (row + 1).saturating_sub(distance), (row + distance).saturating_sub(1));
        let ends = [column.checked_sub(distance), Some(column + distance)].map(|column| (column, between.clone()));
        let ends =
            ends.into_iter().filter_map(|(column, between)| Some(Block([clipped(0, column?, column?), between])));
        let is_nearest = |&segment: &usize| {
            let away = [0, 1].map(|axis| {
                let touched = &self.blocks[segment].0[axis];
                touched.start().saturating_sub(around[axis]).max(around[axis].saturating_sub(*touched.end()))
            });
            away[0].max(away[1]) == distance
        };
        let cells = sides.chain(ends);
        let mut found: Vec<usize> = cells.flat_map(|cells| self.segments(cells)).filter(is_nearest).collect();
        found.sort_unstable();
        found.dedup();
        found
    }
}

impl SegmentSearch for SegmentGrid {
    /// Rebuilds the grid of at most 3 n + 1 cells, each at least as large as a segment on average.
    fn update(&mut self, surface: &Surface, x: &Configuration) {
        let boxes: Vec<Box2> =
            surface.segments.iter().map(|segment| bounding_box(segment, surface.origin(), x)).collect();
        *self = Self::default();
        let Some(all) = boxes.iter().copied().reduce(Box2::with) else { return };
        let (count, size) = (boxes.len() as f64, all.size());
        let mean = boxes.iter().map(|own| own.size().amax()).sum::<f64>() / count;
        self.low = all.low;
        self.side = mean.max((size.x * size.y / count).sqrt()).max(size.amax() / count);
        self.counts = [0, 1].map(|axis| 1 + (size[axis] / self.side) as usize);
        self.cells = vec![Vec::new(); self.counts[0] * self.counts[1]];
        self.blocks = boxes.iter().map(|own| self.block(own)).collect();
        for (segment, Block([across, up])) in self.blocks.iter().enumerate() {
            for row in up.clone() {
                across.clone().for_each(|column| self.cells[row * self.counts[0] + column].push(segment));
            }
        }
    }

    fn meeting(&self, _: &Surface, _: &Configuration, other: &Box2, found: &mut Vec<usize>) {
        if self.cells.is_empty() {
            return;
        }
        found.extend(self.segments(self.block(other)));
        found.sort_unstable();
        found.dedup();
    }

    /// Ring by ring around the point's cell: what is not in rings 0 … r is farther than r sides of a cell.
    fn by_distance(&self, slave: &SlavePoint, surface: &Surface, x: &Configuration) -> impl Iterator<Item = usize> {
        let around = self.cell(slave.offset(surface.origin(), x));
        let rings = if self.cells.is_empty() { 0 } else { self.counts[0].max(self.counts[1]) };
        let mut next = 0;
        let mut known: Vec<(f64, usize)> = Vec::new();
        std::iter::from_fn(move || {
            loop {
                let reach = (next as f64 - 1.0 - TRUST) * self.side;
                let is_sure = |distance: f64| next == rings || distance.sqrt() < reach;
                if let Some((_, segment)) = known.pop_if(|(distance, _)| is_sure(*distance)) {
                    return Some(segment);
                }
                if next == rings {
                    return None;
                }
                let found = self.ring(around, next).into_iter();
                known.extend(found.map(|k| (squared_distance(slave, &surface.segments[k], x), k)));
                known.sort_by(|(a, k), (b, l)| b.total_cmp(a).then(l.cmp(k)));
                next += 1;
            }
        })
    }
}

/// The search through all segments.
#[derive(Clone, Debug, Default)]
pub struct Exhaustive;

impl SegmentSearch for Exhaustive {
    fn update(&mut self, _: &Surface, _: &Configuration) {}

    fn meeting(&self, surface: &Surface, x: &Configuration, other: &Box2, found: &mut Vec<usize>) {
        let meets = |segment: &Segment| bounding_box(segment, surface.origin(), x).meets(other);
        found.extend((0..surface.segments.len()).filter(|&k| meets(&surface.segments[k])));
    }

    fn by_distance(&self, slave: &SlavePoint, surface: &Surface, x: &Configuration) -> impl Iterator<Item = usize> {
        let distances = surface.segments.iter().map(|segment| squared_distance(slave, segment, x));
        let mut all: Vec<(f64, usize)> = distances.zip(0..).collect();
        all.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        all.into_iter().map(|(_, segment)| segment)
    }
}
