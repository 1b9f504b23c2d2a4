//! Writes the mesh of the Coulomb drag problem: an elastic block on elastic ground, both of square Q4 elements.
//!
//! ```text
//! cargo run --release --example coulomb_drag_mesh -- N B OUT.msh
//! ```
//!
//! The ground, [−2, 2] × [−1, 0], has 4N × N elements; the block, [−1/2, 1/2] × [0, 1/2], has B × B/2. The two have
//! their own nodes, which do not match, and the gap between them is exactly zero. Sizes in use (N, B): 22, 28 for 5 000
//! degrees of freedom, 45, 58 for 20 000, 91, 118 for 80 000, 176, 228 for 300 000 and 321, 416 for a million.

use std::env;
use std::error::Error;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let [n, b, path] = &arguments[..] else { return Err("usage: coulomb_drag_mesh N B OUT.msh".into()) };
    let (n, b): (i64, i64) = (n.parse()?, b.parse()?);
    if n < 1 || b < 2 || b % 2 == 1 {
        return Err("N must be at least 1, B even and at least 2".into());
    }
    println!("{path}: {} degrees of freedom", write(n, b, Path::new(path))?);
    Ok(())
}

/// Write the mesh; returns the number of degrees of freedom.
pub fn write(n: i64, b: i64, path: &Path) -> io::Result<i64> {
    let ground = Grid { name: "ground", columns: 4 * n, rows: n, corner: [-4 * n, -2 * n], per_unit: n, first_node: 1 };
    let first_node = 1 + ground.nodes();
    let block = Grid { name: "block", columns: b, rows: b / 2, corner: [-b, 0], per_unit: b, first_node };
    let bodies = [ground, block];

    let mut out = BufWriter::new(File::create(path)?);
    write_names(&mut out, &bodies)?;
    write_entities(&mut out, &bodies)?;
    write_nodes(&mut out, &bodies)?;
    write_elements(&mut out, &bodies)?;
    out.flush()?;
    Ok(2 * bodies.iter().map(Grid::nodes).sum::<i64>())
}

/// A rectangle of square elements.
struct Grid {
    name: &'static str,
    columns: i64,
    rows: i64,
    /// lower left corner, in half elements: whole numbers, so that the interface comes out as exactly 0
    corner: [i64; 2],
    /// elements per unit of length
    per_unit: i64,
    /// tag of the node at the corner
    first_node: i64,
}

impl Grid {
    fn nodes(&self) -> i64 {
        (self.columns + 1) * (self.rows + 1)
    }

    fn elements(&self) -> i64 {
        self.columns * self.rows
    }

    fn node(&self, column: i64, row: i64) -> i64 {
        self.first_node + row * (self.columns + 1) + column
    }

    fn position(&self, column: i64, row: i64) -> [f64; 2] {
        [self.corner[0] + 2 * column, self.corner[1] + 2 * row].map(|half| half as f64 / (2 * self.per_unit) as f64)
    }

    /// x and y of two opposite corners, with z = 0, as gmsh writes a bounding box.
    fn extent(&self, [first, last]: [i64; 2]) -> String {
        let ([left, low], [right, high]) = (self.position(0, first), self.position(self.columns, last));
        format!("{left} {low} 0 {right} {high} 0")
    }

    /// Named curves: the lowest and the highest row of nodes.
    fn curves(&self) -> [(String, i64); 2] {
        [(format!("{}_bottom", self.name), 0), (format!("{}_top", self.name), self.rows)]
    }
}

/// All curves with their body, in the order of their tags 1, 2, …
fn curves(bodies: &[Grid]) -> impl Iterator<Item = (usize, &Grid, String, i64)> {
    let curves = bodies.iter().flat_map(|body| body.curves().map(|(name, row)| (body, name, row)));
    curves.enumerate().map(|(i, (body, name, row))| (i + 1, body, name, row))
}

/// All bodies in the order of their tags 1, 2, …
fn surfaces(bodies: &[Grid]) -> impl Iterator<Item = (usize, &Grid)> {
    bodies.iter().enumerate().map(|(i, body)| (i + 1, body))
}

fn write_names(out: &mut impl Write, bodies: &[Grid]) -> io::Result<()> {
    writeln!(out, "$MeshFormat\n4.1 0 8\n$EndMeshFormat")?;
    writeln!(out, "$PhysicalNames\n{}", 3 * bodies.len())?;
    for (tag, _, name, _) in curves(bodies) {
        writeln!(out, "1 {tag} \"{name}\"")?;
    }
    for (tag, body) in surfaces(bodies) {
        writeln!(out, "2 {tag} \"{}\"", body.name)?;
    }
    writeln!(out, "$EndPhysicalNames")
}

/// Each curve and surface is in the physical group with its own tag; no bounding entities are given.
fn write_entities(out: &mut impl Write, bodies: &[Grid]) -> io::Result<()> {
    writeln!(out, "$Entities\n0 {} {} 0", 2 * bodies.len(), bodies.len())?;
    for (tag, body, _, row) in curves(bodies) {
        writeln!(out, "{tag} {} 1 {tag} 0", body.extent([row, row]))?;
    }
    for (tag, body) in surfaces(bodies) {
        writeln!(out, "{tag} {} 1 {tag} 0", body.extent([0, body.rows]))?;
    }
    writeln!(out, "$EndEntities")
}

fn write_nodes(out: &mut impl Write, bodies: &[Grid]) -> io::Result<()> {
    let total: i64 = bodies.iter().map(Grid::nodes).sum();
    writeln!(out, "$Nodes\n{} {total} 1 {total}", bodies.len())?;
    for (tag, body) in surfaces(bodies) {
        writeln!(out, "2 {tag} 0 {}", body.nodes())?;
        for node in body.first_node..body.first_node + body.nodes() {
            writeln!(out, "{node}")?;
        }
        for row in 0..=body.rows {
            for column in 0..=body.columns {
                let [x, y] = body.position(column, row);
                writeln!(out, "{x} {y} 0")?;
            }
        }
    }
    writeln!(out, "$EndNodes")
}

/// Lines (gmsh type 1), then quadrilaterals (type 3).
fn write_elements(out: &mut impl Write, bodies: &[Grid]) -> io::Result<()> {
    let total: i64 = bodies.iter().map(|body| 2 * body.columns + body.elements()).sum();
    writeln!(out, "$Elements\n{} {total} 1 {total}", 3 * bodies.len())?;
    let mut tags = 1..;
    for (tag, body, _, row) in curves(bodies) {
        writeln!(out, "1 {tag} 1 {}", body.columns)?;
        for (i, element) in (0..body.columns).zip(&mut tags) {
            writeln!(out, "{element} {} {}", body.node(i, row), body.node(i + 1, row))?;
        }
    }
    for (tag, body) in surfaces(bodies) {
        writeln!(out, "2 {tag} 3 {}", body.elements())?;
        for (cell, element) in (0..body.elements()).zip(&mut tags) {
            let (i, j) = (cell % body.columns, cell / body.columns);
            let corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| body.node(i, j).to_string());
            writeln!(out, "{element} {}", corners.join(" "))?;
        }
    }
    writeln!(out, "$EndElements")
}
