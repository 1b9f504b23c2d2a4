//! Block meshes: quadrilaterals with straight sides or arcs, divided into rows and columns of elements, and joined where they
//! share a side.
//!
//! ```text
//!            side 2
//!   corner 3 ──────── corner 2       side k goes from corner k to the next; elements and grading are given along
//!   side 3  │        │  side 1       side 0 and along side 1, from corner 0 on
//!   corner 0 ──────── corner 1
//!            side 0
//! ```
//! The corners may be given in either orientation. Inner nodes lie on the transfinite map of the four sides x₀ … x₃:
//!
//! ```text
//! x(s, t) = (1 − t) x₀(s) + t x₂(s) + (1 − s) x₃(t) + s x₁(t) − bilinear map of the corners
//! ```
//! W. J. Gordon and C. A. Hall (1973), Int. J. Numer. Meth. Engng 7, 461.

mod grid;
mod join;

use std::collections::{BTreeMap, BTreeSet};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::{InlineMesh, MOST_ELEMENTS};
pub use grid::Grading;
use grid::Grid;

/// Element kind of a block.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[non_exhaustive]
pub enum BlockKind {
    /// Bilinear, 4 nodes
    #[default]
    Q4,
    /// Serendipity, 8 nodes: the mid-side nodes lie on the arcs
    Q8,
    /// Two quadratic triangles, 6 nodes, to each quadrilateral; its diagonals alternate
    T6,
}

impl BlockKind {
    /// Number of node spacings along an edge.
    fn order(self) -> usize {
        match self {
            Self::Q4 => 1,
            Self::Q8 | Self::T6 => 2,
        }
    }
}

/// A quadrilateral divided into rows and columns of elements.
#[derive(Clone, Debug)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct Block {
    /// body that its elements belong to
    pub body: String,
    /// corners in order [L]
    pub corners: [[f64; 2]; 4],
    /// for each side, the centre of its circle, of which the shorter arc is taken; `None` for a straight side [L]
    pub arcs: [Option<[f64; 2]>; 4],
    /// elements along side 0 and along side 1
    pub elements: [usize; 2],
    /// variation of their sizes, starting at corner 0
    pub grading: [Grading; 2],
    /// kind
    pub kind: BlockKind,
    /// names of the sides
    pub sides: [Option<String>; 4],
    /// points by name: the node nearest to each forms the node group of that name [L]
    pub points: BTreeMap<String, [f64; 2]>,
}

impl Block {
    /// Creates a block with straight, unnamed sides and Q4 elements of equal size.
    pub fn new(body: &str, corners: [[f64; 2]; 4], elements: [usize; 2]) -> Self {
        Self {
            body: body.into(),
            corners,
            arcs: [None; 4],
            elements,
            grading: [Grading::default(); 2],
            kind: BlockKind::Q4,
            sides: [const { None }; 4],
            points: BTreeMap::new(),
        }
    }

    /// Creates a rectangle from its lower left and upper right corner [L]; one named `b` belongs to the body `b` and has the
    /// sides `b_bottom`, `b_right`, `b_top` and `b_left`.
    pub fn rectangle(name: &str, elements: [usize; 2], [x, y]: [f64; 2], [right, top]: [f64; 2]) -> Self {
        let sides = ["bottom", "right", "top", "left"].map(|side| Some(format!("{name}_{side}")));
        Self { sides, ..Self::new(name, [[x, y], [right, y], [right, top], [x, top]], elements) }
    }
}

setters! { block: Block;
    /// Sets the grading of the element sizes along side 0 and side 1.
    grading(grading: [Grading; 2]) { block.grading = grading; }

    /// Sets the kind of elements.
    kind(kind: BlockKind) { block.kind = kind; }

    /// Makes a side, 0 to 3, the shorter arc of a circle around a centre [L].
    arc(side: usize, centre: [f64; 2]) { block.arcs[side] = Some(centre); }

    /// Sets the name of a side, 0 to 3.
    side(side: usize, name: impl Into<String>) { block.sides[side] = Some(name.into()); }

    /// Names the node nearest to a point [L].
    point(name: impl Into<String>, near: [f64; 2]) { block.points.insert(name.into(), near); }
}

/// A set of blocks, joined where two of one body, or of joined bodies, share a side.
///
/// ```
/// use fecontact::mesh::{Block, Blocks, Grading};
///
/// let ground = Block::rectangle("ground", [8, 4], [0.0, -1.0], [4.0, 0.0]).grading([Grading::Ratio(1.0), Grading::Ratio(0.2)]);
/// let block = Block::rectangle("block", [5, 3], [1.0, 0.0], [3.0, 1.0]);
/// let mesh = Blocks::new([ground, block]).mesh()?.build()?;
/// assert_eq!((mesh.nodes.len(), mesh.elements.len()), (9 * 5 + 6 * 4, 47));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
#[must_use]
pub struct Blocks {
    /// blocks; nodes are numbered in their order, row by row, starting at side 0
    pub blocks: Vec<Block>,
    /// names of sides that are not joined, such as the two faces of a crack
    pub separated: Vec<String>,
    /// lists of bodies joined with each other, such as two materials bonded along a side
    pub joined: Vec<Vec<String>>,
}

/// Error of a block, with its remedy.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{place}: {message}")]
#[non_exhaustive]
pub struct BlockError {
    /// place in the input, such as `blocks[1].elements`
    pub place: String,
    /// error and remedy
    pub message: String,
}

impl BlockError {
    fn new(place: impl Into<String>, message: impl Into<String>) -> Self {
        Self { place: place.into(), message: message.into() }
    }
}

impl Blocks {
    /// Creates a set of blocks, joined where they share a side.
    pub fn new(blocks: impl Into<Vec<Block>>) -> Self {
        Self { blocks: blocks.into(), ..Self::default() }
    }

    /// Joins bodies where their blocks share a side.
    pub fn joined<const N: usize>(mut self, bodies: [&str; N]) -> Self {
        self.joined.push(bodies.map(String::from).into());
        self
    }

    /// Returns the mesh: one body per body name, one edge group per side name, and one node group per point name.
    ///
    /// # Errors
    /// Returns [`BlockError`] if a block is invalid, or blocks touch and cannot be joined.
    pub fn mesh(&self) -> Result<InlineMesh, BlockError> {
        self.check_size()?;
        let mut first = 0;
        let mut grids = Vec::new();
        for (b, block) in self.blocks.iter().enumerate() {
            let grid = Grid::new(block, first).map_err(|message| BlockError::new(format!("blocks[{b}]"), message))?;
            first += grid.nodes.len();
            grids.push(grid);
        }
        let numbers = join::joined(self, &grids)?;
        let mut mesh = InlineMesh::default();
        for (b, (grid, block)) in grids.iter().zip(&self.blocks).enumerate() {
            let own = &numbers[grid.first..grid.first + grid.nodes.len()];
            for (&number, &position) in own.iter().zip(&grid.nodes) {
                if number == mesh.nodes.len() {
                    mesh.nodes.push(position.into());
                }
            }
            let named = |cells: Vec<Vec<usize>>| -> Vec<Vec<usize>> {
                cells.into_iter().map(|cell| cell.into_iter().map(|slot| numbers[slot]).collect()).collect()
            };
            mesh.elements.entry(block.body.clone()).or_default().extend(named(grid.elements()));
            for (k, name) in block.sides.iter().enumerate() {
                if let Some(name) = name {
                    mesh.edges.entry(name.clone()).or_default().extend(named(grid.edges(k)));
                }
            }
            for (name, near) in &block.points {
                let place = || format!("blocks[{b}].points.{name}");
                let slot = grid.nearest(*near).map_err(|message| BlockError::new(place(), message))?;
                mesh.points.entry(name.clone()).or_default().push(numbers[slot]);
            }
        }
        Ok(mesh)
    }

    fn check_size(&self) -> Result<(), BlockError> {
        let mut total = 0.0;
        for (b, Block { elements, .. }) in self.blocks.iter().enumerate() {
            let place = format!("blocks[{b}].elements");
            if elements.contains(&0) {
                return Err(BlockError::new(place, "is 0 along a side: must be at least 1"));
            }
            total += elements[0] as f64 * elements[1] as f64;
            if total > MOST_ELEMENTS {
                let message = format!("makes {total:.0} elements, more than {MOST_ELEMENTS:.0}: take fewer");
                return Err(BlockError::new(place, message));
            }
        }
        let sides: BTreeSet<&str> =
            self.blocks.iter().flat_map(|block| &block.sides).flatten().map(String::as_str).collect();
        if let Some((k, name)) = self.separated.iter().enumerate().find(|(_, name)| !sides.contains(name.as_str())) {
            let message =
                format!("no side is named `{name}`{}: name the sides that are not joined", meant(name, &sides));
            return Err(BlockError::new(format!("separated[{k}]"), message));
        }
        let bodies: BTreeSet<&str> = self.blocks.iter().map(|block| block.body.as_str()).collect();
        for (k, list) in self.joined.iter().enumerate() {
            if list.len() < 2 {
                return Err(BlockError::new(format!("joined[{k}]"), "must name two bodies or more"));
            }
            if let Some((at, name)) = list.iter().enumerate().find(|(_, name)| !bodies.contains(name.as_str())) {
                let message = format!("no block is of the body `{name}`{}", meant(name, &bodies));
                return Err(BlockError::new(format!("joined[{k}][{at}]"), message));
            }
        }
        Ok(())
    }
}

/// Suggests a known name as a question.
fn meant(name: &str, known: &BTreeSet<&str>) -> String {
    super::names::nearest(name, known.iter().copied())
        .map_or_else(String::new, |near| format!(" (did you mean `{near}`?)"))
}
