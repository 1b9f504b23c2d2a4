//! Periodic sides and loading plates: which node moves with which.

use nalgebra::Vector2;

use super::error::ModelError;
use super::plate::Plate;
use crate::mesh::Mesh;
use crate::mesh::ties::Ties;

/// Partners may be off by this share of the distance between their sides.
const ROUNDED: f64 = 1e-6;

/// The nodes of loading plates that move as one.
pub fn plates(given: &[(String, Plate)], mesh: &Mesh) -> Result<Vec<Vec<usize>>, ModelError> {
    let nodes = |(k, name): (usize, &String)| {
        let group = mesh.group(name).map_err(|error| ModelError::new(format!("plates[{k}]"), error))?;
        Ok(mesh.nodes_of(group))
    };
    let as_one = given.iter().enumerate().filter(|(_, (_, moves))| *moves == Plate::AsOne);
    as_one.map(|(k, (name, _))| nodes((k, name))).collect()
}

/// Ties between the nodes of pairs of sides, and of plates.
pub fn ties(periodic: &[[String; 2]], plates: &[Vec<usize>], mesh: &Mesh) -> Result<Ties, ModelError> {
    let mut joined = Vec::new();
    for (k, names) in periodic.iter().enumerate() {
        joined.extend(partners(names, mesh, &format!("periodic[{k}]"))?);
    }
    joined.extend(plates.iter().flat_map(|nodes| nodes.windows(2).map(|pair| [pair[0], pair[1]])));
    Ok(Ties::new(mesh.nodes.len(), &joined))
}

/// Each node of one side with the node of the other that lies as far from it as the sides' middles are apart.
fn partners(names: &[String; 2], mesh: &Mesh, place: &str) -> Result<Vec<[usize; 2]>, ModelError> {
    let complain = |message: String| ModelError::new(place, message);
    let side = |name: &String| mesh.group(name).map(|group| mesh.nodes_of(group));
    let [first, second] =
        [side(&names[0]).map_err(|e| complain(e.to_string()))?, side(&names[1]).map_err(|e| complain(e.to_string()))?];
    if first.len() != second.len() {
        return Err(complain(format!(
            "`{}` has {} nodes and `{}` has {}: the nodes of periodic sides must lie alike",
            names[0],
            first.len(),
            names[1],
            second.len()
        )));
    }
    let middle =
        |nodes: &[usize]| nodes.iter().map(|&node| mesh.nodes[node]).sum::<Vector2<f64>>() / nodes.len() as f64;
    let period = middle(&second) - middle(&first);
    let near = ROUNDED * period.norm();
    if mesh.section.is_axisymmetric() && period.x.abs() > near {
        return Err(complain("the sides of axisymmetric bodies lie alike along y alone, the axis".into()));
    }
    if let Some(shared) = first.iter().find(|node| second.binary_search(node).is_ok()) {
        let tag = mesh.node_tags[*shared];
        return Err(complain(format!("node {tag} is on both sides: periodic sides must have nodes of their own")));
    }
    // Along the sides, the order of partners is the same but for round-off; sorted by one coordinate, few are looked at.
    let mut by_x: Vec<(f64, usize)> = second.iter().map(|&node| (mesh.nodes[node].x, node)).collect();
    by_x.sort_by(|a, b| a.0.total_cmp(&b.0));
    let partner = |node: usize| {
        let expected = mesh.nodes[node] + period;
        let candidates = by_x[by_x.partition_point(|(x, _)| *x < expected.x - near)..].iter();
        let close = |other: &usize| (mesh.nodes[*other] - expected).norm() <= near;
        candidates.take_while(|(x, _)| *x <= expected.x + near).map(|(_, other)| *other).find(close).ok_or(expected)
    };
    let paired = |&node: &usize| {
        partner(node).map(|other| [node, other]).map_err(|expected| {
            let (tag, at) = (mesh.node_tags[node], mesh.nodes[node]);
            complain(format!(
                "node {tag} of `{}` at ({}, {}) has no partner on `{}`, where one should lie at ({}, {}): the nodes of \
                 periodic sides must lie alike",
                names[0], at.x, at.y, names[1], expected.x, expected.y
            ))
        })
    };
    first.iter().map(paired).collect()
}
