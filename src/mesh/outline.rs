//! Lines of a mesh that are sides of no element: the outline of a rigid body.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Vector2;

/// A line: its nodes in order, two or three, each with its tag and position.
pub type Line = Vec<(u64, Vector2<f64>)>;

/// Returns the positions of the nodes along the one chain that lines form; that of the first again at the end of a closed one.
///
/// # Errors
/// Returns the defect if the lines branch, run against each other, or form several chains.
pub fn chain(lines: &[Line]) -> Result<Vec<Vector2<f64>>, String> {
    const ONE_WAY: &str = "the lines of an outline form one chain without branches and run in one direction, with the solid on their right";
    let mut from: BTreeMap<u64, &[(u64, Vector2<f64>)]> = BTreeMap::new();
    let mut ends = BTreeSet::new();
    for line in lines {
        let [(start, at), .., (end, end_at)] = line[..] else { continue };
        let node = |tag: u64, at: Vector2<f64>| format!("node {tag} at ({}, {})", at.x, at.y);
        if from.insert(start, line).is_some() {
            return Err(format!("two lines begin at {}: {ONE_WAY}", node(start, at)));
        }
        if !ends.insert(end) {
            return Err(format!("two lines end at {}: {ONE_WAY}", node(end, end_at)));
        }
    }
    let starts = || lines.iter().filter_map(|line| line.first());
    let Some(&(first, at)) = starts().find(|(tag, _)| !ends.contains(tag)).or_else(|| starts().next()) else {
        return Err("it has no lines".into());
    };
    let (mut corners, mut tag) = (vec![at], first);
    while let Some(line) = from.remove(&tag) {
        corners.extend(line[1..].iter().map(|(_, at)| at));
        tag = line[line.len() - 1].0;
    }
    match starts().find(|(tag, _)| from.contains_key(tag)) {
        None => Ok(corners),
        Some((other, at)) => Err(format!(
            "it is in pieces, one from node {first} on, another with node {other} at ({}, {}): give each a group and a contact of its own",
            at.x, at.y
        )),
    }
}
