//! Parts of a model that move as rigid bodies, and what couples their motions.
//!
//! ```text
//! u(X) = (U, V) + Θ J (X − X_c)/R          R: to the farthest node, so that all three numbers are lengths
//! ```

use std::collections::BTreeMap;

use nalgebra::{Vector2, Vector3};

use crate::contact::master::Master;
use crate::contact::pair::ContactPair;
use crate::contact::surface::Surface;
use crate::mesh::joined::Joined;
use crate::model::Model;

/// An equation between the motions of parts: shares of U, V and Θ of each.
pub type Row = Vec<(usize, Vector3<f64>)>;

/// A part: bodies in contact or that share nodes at two places, or a node outside all bodies.
pub struct Part {
    /// its bodies
    pub bodies: Vec<usize>,
    /// whether it touches a rigid body
    pub on_rigid: bool,
    nodes: Vec<usize>,
    centre: Vector2<f64>,
    radius: f64,
}

/// All parts.
pub struct Parts<'m> {
    /// part by part
    pub parts: Vec<Part>,
    model: &'m Model,
    /// parts of each node: more than one is a hinge
    of_node: Vec<Vec<usize>>,
}

impl<'m> Parts<'m> {
    /// The parts of a model.
    pub fn of(model: &'m Model) -> Self {
        let owners = owners(model);
        let groups = joined(model, &owners);
        let mut part_of = vec![0; groups.iter().map(Vec::len).sum()];
        groups.iter().enumerate().for_each(|(part, group)| group.iter().for_each(|&owner| part_of[owner] = part));
        let mut of_node = owners;
        for parts in &mut of_node {
            parts.iter_mut().for_each(|owner| *owner = part_of[*owner]);
            parts.sort_unstable();
            parts.dedup();
        }
        let mut nodes = vec![Vec::new(); groups.len()];
        of_node.iter().enumerate().for_each(|(node, parts)| parts.iter().for_each(|&part| nodes[part].push(node)));
        let mut parts: Vec<Part> =
            groups.iter().zip(nodes).map(|(group, nodes)| Part::of(group, nodes, model)).collect();
        for pair in model.contacts.iter().filter(|pair| matches!(pair.master, Master::Rigid(_))) {
            slaves(pair).flat_map(|node| &of_node[node]).for_each(|&part| parts[part].on_rigid = true);
        }
        Self { parts, model, of_node }
    }

    /// What is moved, in words: bodies, or a node.
    pub fn names(&self, part: usize) -> Vec<String> {
        let Part { bodies, nodes, .. } = &self.parts[part];
        match bodies.is_empty() {
            true => nodes.iter().map(|&node| format!("node {}", self.model.mesh.node_tags[node])).collect(),
            false => bodies.iter().map(|&body| format!("`{}`", self.model.bodies[body].name)).collect(),
        }
    }

    /// Σ d·u of nodes and vectors d.
    pub fn row(&self, terms: &[(usize, Vector2<f64>)]) -> Row {
        terms.iter().map(|&(node, d)| self.term(self.of_node[node][0], node, d)).collect()
    }

    /// d·u of a node as a part moves it.
    fn term(&self, part: usize, node: usize, d: Vector2<f64>) -> (usize, Vector3<f64>) {
        let Part { centre, radius, .. } = self.parts[part];
        let arm = (self.model.mesh.nodes[node] - centre) / radius;
        (part, Vector3::new(d.x, d.y, d.y * arm.x - d.x * arm.y))
    }

    /// Everything that is zero in every step.
    pub fn couplings(&self) -> Vec<Row> {
        let mut rows = self.of_shape();
        for (node, parts) in self.of_node.iter().enumerate() {
            let hinge = |d: Vector2<f64>, other: usize| vec![self.term(parts[0], node, d), self.term(other, node, -d)];
            rows.extend(parts[1..].iter().flat_map(|&other| AXES.map(|d| hinge(d, other))));
        }
        let ties = self.model.ties.pairs().iter();
        rows.extend(ties.flat_map(|&(copy, original)| AXES.map(|d| self.row(&[(copy, d), (original, -d)]))));
        for follower in &self.model.linkage.followers {
            let leaders = |i: usize| follower.leaders.iter().map(move |(node, g)| (*node, -g.row(i).transpose()));
            let row = |(i, _): (usize, usize)| {
                self.row(&[(follower.node, AXES[i])].into_iter().chain(leaders(i)).collect::<Vec<_>>())
            };
            rows.extend(follower.dofs().map(row));
        }
        // The leaders of a plate that turns keep their distance.
        let apart = |&[a, b]: &[usize; 2]| (self.model.mesh.nodes[b] - self.model.mesh.nodes[a]).normalize();
        rows.extend(
            self.model
                .linkage
                .rigid
                .iter()
                .map(|plate| self.row(&[(plate[1], apart(plate)), (plate[0], -apart(plate))])),
        );
        rows
    }

    /// What a part cannot do by itself: hoops resist all but the motion along the axis, and a node does not turn.
    fn of_shape(&self) -> Vec<Row> {
        let axisymmetric = self.model.mesh.section.is_axisymmetric();
        let of = |(part, Part { bodies, nodes, .. }): (usize, &Part)| {
            let hoops = axisymmetric && !bodies.is_empty();
            let [u, turn] = [hoops, hoops || nodes.len() == 1];
            [(u, 0), (turn, 2)]
                .into_iter()
                .filter(|(resisted, _)| *resisted)
                .map(move |(_, i)| vec![(part, Vector3::ith(i, 1.0))])
        };
        self.parts.iter().enumerate().flat_map(of).collect()
    }
}

const AXES: [Vector2<f64>; 2] = [Vector2::new(1.0, 0.0), Vector2::new(0.0, 1.0)];

impl Part {
    fn of(owners: &[usize], nodes: Vec<usize>, model: &Model) -> Self {
        let place = |node: &usize| model.mesh.nodes[*node];
        let centre = nodes.iter().map(place).sum::<Vector2<f64>>() / nodes.len() as f64;
        let radius = nodes.iter().fold(f64::MIN_POSITIVE, |r, node| r.max((place(node) - centre).norm()));
        let bodies = owners.iter().copied().filter(|owner| *owner < model.bodies.len()).collect();
        Self { bodies, on_rigid: false, nodes, centre, radius }
    }
}

/// The bodies of each node; one outside all bodies has a number of its own after theirs.
fn owners(model: &Model) -> Vec<Vec<usize>> {
    let mut owners = vec![Vec::new(); model.mesh.nodes.len()];
    for (body, of) in model.bodies.iter().enumerate() {
        of.nodes.iter().for_each(|&node| owners[node].push(body));
    }
    let lone = owners.iter_mut().filter(|bodies| bodies.is_empty());
    lone.zip(model.bodies.len()..).for_each(|(own, number)| own.push(number));
    owners
}

/// Groups of owners that move as one.
fn joined(model: &Model, owners: &[Vec<usize>]) -> Vec<Vec<usize>> {
    let mut joined = Joined::new(1 + owners.iter().flatten().max().copied().unwrap_or(0));
    bonded(model, owners).into_iter().for_each(|(a, b)| joined.join(a, b));
    for pair in &model.contacts {
        let Master::Mesh(Surface { segments, .. }) = &pair.master else { continue };
        // A group of edges may run along several bodies.
        let nodes = slaves(pair).chain(segments.iter().flat_map(|segment| segment.ends));
        let met: Vec<usize> = nodes.flat_map(|node| owners[node].iter().copied()).collect();
        met.windows(2).for_each(|two| joined.join(two[0], two[1]));
    }
    joined.groups()
}

/// Bodies that share nodes at two places.
fn bonded(model: &Model, owners: &[Vec<usize>]) -> Vec<(usize, usize)> {
    let mut first: BTreeMap<(usize, usize), usize> = BTreeMap::new();
    let mut bonded = Vec::new();
    for (node, bodies) in owners.iter().enumerate() {
        for (k, &a) in bodies.iter().enumerate() {
            for &b in &bodies[k + 1..] {
                let hinge = *first.entry((a, b)).or_insert(node);
                if model.mesh.nodes[hinge] != model.mesh.nodes[node] {
                    bonded.push((a, b));
                }
            }
        }
    }
    bonded
}

/// Nodes of the slave side.
fn slaves(pair: &ContactPair) -> impl Iterator<Item = usize> {
    pair.points.iter().flat_map(|point| point.position.iter().map(|&(node, _)| node))
}
