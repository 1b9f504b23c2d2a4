//! Groups of files without physical groups: every entity is a group, `surface_1`, `curve_5`, `point_3`.

use std::collections::{BTreeMap, HashSet};

use crate::mesh::check::{RawCell, RawMesh};

/// Name of an entity, by its dimension and its tag.
pub fn name(dimension: i32, tag: i64) -> String {
    let kind = match dimension {
        0 => "point",
        1 => "curve",
        _ => "surface",
    };
    format!("{kind}_{tag}")
}

/// Leaves out what nobody has asked for and no mesh can have as a group: curves between or inside bodies that share their
/// nodes, and points that are nodes of no element, such as centres of arcs.
pub fn usable(mut raw: RawMesh) -> RawMesh {
    let cells = || raw.bodies.values().flatten();
    let mut sides: BTreeMap<[u64; 2], usize> = BTreeMap::new();
    for cell in cells() {
        let corners = if matches!(cell.nodes.len(), 3 | 6) { 3 } else { 4 };
        for k in 0..corners.min(cell.nodes.len()) {
            *sides.entry(ends(cell.nodes[k], cell.nodes[(k + 1) % corners])).or_default() += 1;
        }
    }
    let nodes: HashSet<u64> = cells().flat_map(|cell| cell.nodes.iter().copied()).collect();
    let is_inside = |line: &RawCell| line.nodes.len() > 1 && sides.get(&ends(line.nodes[0], line.nodes[1])) == Some(&2);
    raw.edges.retain(|_, lines| !lines.iter().any(is_inside));
    raw.points.retain(|_, points| points.iter().all(|point| point.nodes.iter().all(|node| nodes.contains(node))));
    raw
}

fn ends(a: u64, b: u64) -> [u64; 2] {
    [a.min(b), a.max(b)]
}
