//! Writes the mesh of a straight fault: two rectangles of square Q4 elements, with nodes of their own along y = 0.
//!
//! ```text
//! cargo run --release --example fault_mesh -- LENGTH HEIGHT SIZE OUT.msh
//! ```
//!
//! `lower` is [−L/2, L/2] × [−H, 0], `upper` [−L/2, L/2] × [0, H], the elements are of the given size; each has its sides
//! `NAME_bottom`, `NAME_right`, `NAME_top` and `NAME_left`. `cases/rupture/` uses 48000 20000 100.

use std::env;
use std::error::Error;
use std::fs::File;
use std::io::{self, BufWriter, Write};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let [length, height, size, path] = &arguments[..] else {
        return Err("usage: fault_mesh LENGTH HEIGHT SIZE OUT.msh".into());
    };
    let [length, height, size]: [f64; 3] = [length.parse()?, height.parse()?, size.parse()?];
    let [columns, rows] = [length / size, height / size].map(|count| count.round() as i64);
    if !(size > 0.0 && columns > 0 && rows > 0) {
        return Err("LENGTH, HEIGHT and SIZE must be positive, and SIZE the smallest".into());
    }
    let block = |name, low, first_node| Block { name, columns, rows, low: [-0.5 * length, low], size, first_node };
    let blocks = [block("lower", -height, 1), block("upper", 0.0, 1 + (columns + 1) * (rows + 1))];
    let mut out = BufWriter::new(File::create(path)?);
    write(&mut out, &blocks)?;
    out.flush()?;
    println!("{path}: {} elements, {} degrees of freedom", 2 * columns * rows, 4 * (columns + 1) * (rows + 1));
    Ok(())
}

/// A rectangle of square elements.
struct Block {
    name: &'static str,
    columns: i64,
    rows: i64,
    /// lower left corner [L]
    low: [f64; 2],
    /// of an element [L]
    size: f64,
    /// tag of the node at the corner
    first_node: i64,
}

impl Block {
    fn nodes(&self) -> i64 {
        (self.columns + 1) * (self.rows + 1)
    }

    fn node(&self, [column, row]: [i64; 2]) -> i64 {
        self.first_node + row * (self.columns + 1) + column
    }

    /// Name and edges of each side.
    fn sides(&self) -> [(String, Vec<[i64; 2]>); 4] {
        let (n, m) = (self.columns, self.rows);
        let row = |j: i64| (0..n).map(|i| [self.node([i, j]), self.node([i + 1, j])]).collect();
        let column = |i: i64| (0..m).map(|j| [self.node([i, j]), self.node([i, j + 1])]).collect();
        let sides = [("bottom", row(0)), ("right", column(n)), ("top", row(m)), ("left", column(0))];
        sides.map(|(side, edges)| (format!("{}_{side}", self.name), edges))
    }
}

/// Groups and entities have the same tags: curves 1 to 8, surfaces 1 and 2. No bounding entities are given.
fn write(out: &mut impl Write, blocks: &[Block; 2]) -> io::Result<()> {
    let sides: Vec<_> = blocks.iter().flat_map(Block::sides).collect();
    writeln!(out, "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n{}", sides.len() + 2)?;
    for (k, (name, _)) in sides.iter().enumerate() {
        writeln!(out, "1 {} \"{name}\"", k + 1)?;
    }
    for (k, block) in blocks.iter().enumerate() {
        writeln!(out, "2 {} \"{}\"", k + 1, block.name)?;
    }
    writeln!(out, "$EndPhysicalNames\n$Entities\n0 {} 2 0", sides.len())?;
    (1..=sides.len()).try_for_each(|tag| writeln!(out, "{tag} 0 0 0 0 0 0 1 {tag} 0"))?;
    (1..=2).try_for_each(|tag| writeln!(out, "{tag} 0 0 0 0 0 0 1 {tag} 0"))?;
    let total: i64 = blocks.iter().map(Block::nodes).sum();
    writeln!(out, "$EndEntities\n$Nodes\n2 {total} 1 {total}")?;
    for (k, block) in blocks.iter().enumerate() {
        writeln!(out, "2 {} 0 {}", k + 1, block.nodes())?;
        (0..block.nodes()).try_for_each(|node| writeln!(out, "{}", block.first_node + node))?;
        for node in 0..block.nodes() {
            let at = [node % (block.columns + 1), node / (block.columns + 1)];
            let [x, y] = [0, 1].map(|i| block.low[i] + at[i] as f64 * block.size);
            writeln!(out, "{x} {y} 0")?;
        }
    }
    let lines: usize = sides.iter().map(|(_, edges)| edges.len()).sum();
    let total = lines as i64 + blocks.iter().map(|block| block.columns * block.rows).sum::<i64>();
    writeln!(out, "$EndNodes\n$Elements\n{} {total} 1 {total}", sides.len() + 2)?;
    let mut tags = 1..;
    for (k, (_, edges)) in sides.iter().enumerate() {
        writeln!(out, "1 {} 1 {}", k + 1, edges.len())?;
        for ([a, b], tag) in edges.iter().zip(&mut tags) {
            writeln!(out, "{tag} {a} {b}")?;
        }
    }
    for (k, block) in blocks.iter().enumerate() {
        writeln!(out, "2 {} 3 {}", k + 1, block.columns * block.rows)?;
        for (cell, tag) in (0..block.columns * block.rows).zip(&mut tags) {
            let (i, j) = (cell % block.columns, cell / block.columns);
            let [a, b, c, d] = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]].map(|at| block.node(at));
            writeln!(out, "{tag} {a} {b} {c} {d}")?;
        }
    }
    writeln!(out, "$EndElements")
}
