//! Groups, nodes and bodies by name, and the nodal weights of a load on a group.

use std::collections::BTreeMap;
use std::fmt::{Display, Formatter, Result as Written};

use nalgebra::{Matrix2, Vector2};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::error::{Checked, ModelError, no_body, refuse_if};
use crate::mesh::nearest::{NotOne, nearest as nearest_node};
use crate::mesh::outline::chain;
use crate::mesh::{Edge, Group, Mesh, shape};
use crate::model::boundary::{Absorber, NodalWeight};
use crate::model::text::{number, vector};
use crate::model::written::written;
use crate::model::{Body, Model, PointMass};

/// A group or a single node.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(remote = "Self", rename_all = "snake_case")]
#[schemars(!remote)]
#[non_exhaustive]
pub enum Place {
    /// Single node: its tag in the mesh file (its number from 0 in a mesh given in place)
    Node(u64),
    /// Single node of the undeformed mesh nearest to this point [x, y]. It must be unique, and no farther away than the length
    /// of the elements there [L]
    Near([f64; 2]),
    /// Group of the mesh
    #[serde(skip)]
    #[schemars(!skip, untagged)]
    Group(String),
}

written!(Place, "the name of a group, {\"node\": tag}, or {\"near\": [x, y]}", text: Group);

impl Place {
    /// Replaces a point by the tag of the node nearest to it; by its position where several mesh files use that tag.
    ///
    /// # Errors
    /// Returns [`ModelError`] at a place of the input if the node is not unique or too far away.
    pub fn settled(&self, mesh: &Mesh, place: &str) -> Checked<Self> {
        match self {
            Self::Near(point) => {
                nearest(mesh, *point, place).map(|node| match tagged(mesh, mesh.node_tags[node])[..] {
                    [_] => Self::Node(mesh.node_tags[node]),
                    _ => Self::Near(mesh.nodes[node].into()),
                })
            }
            _ => Ok(self.clone()),
        }
    }

    /// Describes the place in words; a single node by its tag.
    #[doc(hidden)]
    pub fn in_words(&self, mesh: &Mesh) -> String {
        self.settled(mesh, "").map_or_else(|_| self.to_string(), |settled| settled.to_string())
    }

    /// Returns the name of the place in the columns of results.
    pub fn column(&self) -> String {
        match self {
            Self::Group(name) => name.clone(),
            Self::Node(tag) => format!("node_{tag}"),
            Self::Near([x, y]) => format!("near_{x}_{y}"),
        }
    }
}

/// The node nearest to a point, which the adjacent elements must reach.
fn nearest(mesh: &Mesh, point: [f64; 2], place: &str) -> Checked<usize> {
    let at = vector(point);
    let elements = mesh.elements.iter().map(|element| element.nodes.as_slice());
    let message = |not_one| match not_one {
        NotOne::NoPlace => format!("near {at} is not a position: give finite numbers"),
        NotOne::NoNodes => "the mesh has no nodes".into(),
        NotOne::Several(both) => {
            let [tag, other] = both.map(|node| mesh.node_tags[node]);
            format!("nodes {tag} and {other} are equally near to {at}: name one as {{\"node\": {tag}}}")
        }
        NotOne::Far { node, distance } => format!(
            "no node is near {at}: the nearest, {}, lies {} away, farther than the size of the elements there",
            mesh.node_tags[node],
            number(distance)
        ),
    };
    let nearest = nearest_node(&mesh.nodes[..mesh.own_nodes()], elements, point);
    nearest.map_err(|not_one| ModelError::new(place, message(not_one)))
}

/// Nodes with a tag: one, unless meshes are joined.
fn tagged(mesh: &Mesh, tag: u64) -> Vec<usize> {
    (0..mesh.own_nodes()).filter(|node| mesh.node_tags[*node] == tag).collect()
}

conversions! {
    &str => Place: |group| Self::Group(group.into());
    String => Place: |group| Self::Group(group);
}

impl Display for Place {
    fn fmt(&self, f: &mut Formatter) -> Written {
        match self {
            Self::Group(name) => f.write_str(name),
            Self::Node(tag) => write!(f, "node {tag}"),
            Self::Near([x, y]) => write!(f, "the node near ({x}, {y})"),
        }
    }
}

/// Returns a group of nodes or elements of the mesh.
pub fn group<'m>(mesh: &'m Mesh, name: &str, place: &str) -> Checked<&'m Group> {
    match mesh.group(name).map_err(|error| ModelError::new(place, error))? {
        Group::Lines(_) => Err(ModelError::new(
            place,
            format!(
                "`{name}` is a group of lines that are sides of no element; it serves as a rigid master alone: {{\"outline\": {{\"group\": \
                 \"{name}\"}}}}"
            ),
        )),
        group => Ok(group),
    }
}

/// Returns the positions of the nodes along the outline of a rigid body, in order.
pub fn outline(mesh: &Mesh, name: &str, place: &str) -> Checked<Vec<Vector2<f64>>> {
    let refused = |message: String| ModelError::new(place, message);
    match mesh.group(name).map_err(|error| ModelError::new(place, error))? {
        Group::Lines(lines) => chain(lines).map_err(|defect| refused(format!("`{name}`: {defect}"))),
        Group::Edges(_) => Err(refused(format!(
            "the lines of `{name}` are sides of elements, which deform: name it as the master itself, or leave its body out of the mesh"
        ))),
        group => Err(refused(format!("`{name}` is a group of {}, not of lines", kind(group)))),
    }
}

/// Kind of the members of a group.
pub fn kind(group: &Group) -> &'static str {
    match group {
        Group::Elements(_) => "solid elements",
        Group::Edges(_) => "edges",
        Group::Nodes(_) => "points",
        Group::Lines(_) => "lines",
    }
}

/// Returns the edges of an edge group.
pub fn edges<'m>(mesh: &'m Mesh, name: &str, place: &str) -> Checked<&'m [Edge]> {
    match group(mesh, name, place)? {
        Group::Edges(edges) => Ok(edges),
        group => Err(ModelError::new(place, format!("`{name}` is a group of {}, not of edges", kind(group)))),
    }
}

/// Node lists of edges.
pub fn node_lists(edges: &[Edge]) -> Vec<Vec<usize>> {
    edges.iter().map(|edge| edge.nodes.clone()).collect()
}

/// Dofs of nodes.
pub fn dofs_of(nodes: &[usize]) -> impl Iterator<Item = usize> {
    nodes.iter().flat_map(|node| [2 * node, 2 * node + 1])
}

/// Nodes at a place.
pub fn nodes_at(mesh: &Mesh, on: &Place, place: &str) -> Checked<Vec<usize>> {
    match on {
        Place::Group(name) => Ok(mesh.nodes_of(group(mesh, name, place)?)),
        Place::Near(point) => Ok(vec![nearest(mesh, *point, place)?]),
        Place::Node(tag) => match tagged(mesh, *tag)[..] {
            [node] => Ok(vec![node]),
            [] => Err(ModelError::new(place, format!("the mesh has no node {tag}"))),
            [..] => {
                let message = "several of the mesh files have a node";
                Err(ModelError::new(place, format!("{message} {tag}: name it by {{\"near\": [x, y]}}, or by a group")))
            }
        },
    }
}

/// Number of evenly spaced times of a step at which a quantity is checked before the run.
pub const TIMES: u32 = 100;

/// Maximum number of places at which it is checked.
pub const PLACES: usize = 50;

/// A limited number of places, from end to end.
pub fn some_of(all: Vec<Vector2<f64>>) -> Vec<Vector2<f64>> {
    let step = all.len().div_ceil(PLACES - 1).max(1);
    all.iter().step_by(step).chain(all.last()).copied().collect()
}

/// Returns the group of a load that acts on groups only.
pub fn group_at<'p>(on: &'p Place, place: &str) -> Checked<&'p str> {
    match on {
        Place::Group(name) => Ok(name),
        Place::Node(_) | Place::Near(_) => {
            Err(ModelError::new(format!("{place}.on"), format!("{on} cannot carry this load: name a group")))
        }
    }
}

/// Returns the number of a body.
pub fn body(model: &Model, name: &str, place: &str) -> Checked<usize> {
    let names = || model.bodies.iter().map(|body| body.name.as_str());
    names().position(|known| known == name).ok_or_else(|| no_body(name, names(), place))
}

/// Returns a body, or point masses, by name: one of the two, or both; `purpose` is part of the message if there is none.
pub fn bodies_and_masses<'m>(
    model: &'m Model,
    name: &str,
    purpose: &str,
    place: &str,
) -> Checked<(Option<&'m Body>, Option<&'m PointMass>)> {
    let body = model.bodies.iter().find(|body| body.name == name);
    let masses = model.point_masses.iter().find(|point| point.name == name);
    if body.is_some() || masses.is_some() {
        return Ok((body, masses));
    }
    let bodies = model.bodies.iter().map(|body| body.name.as_str());
    let known: Vec<&str> = bodies.chain(model.point_masses.iter().map(|point| point.name.as_str())).collect();
    let known = if known.is_empty() { "none at all".into() } else { known.join(", ") };
    Err(ModelError::new(place, format!("there is no body or point mass `{name}`{purpose}; there are {known}")))
}

/// A Gauss point of an edge.
struct EdgePoint<'e> {
    edge: &'e Edge,
    /// weight of the quadrature, w
    weight: f64,
    /// X
    position: Vector2<f64>,
    /// X' = dX/dξ
    along: Vector2<f64>,
    /// nodes with N_a
    values: Vec<(usize, f64)>,
}

fn gauss_points<'e>(mesh: &Mesh, edges: &'e [Edge]) -> impl Iterator<Item = EdgePoint<'e>> {
    edges.iter().flat_map(move |edge| {
        let nodes = &edge.nodes;
        shape::gauss(nodes.len()).into_iter().map(move |(xi, weight)| {
            let values = nodes.iter().copied().zip(shape::edge_values(nodes.len(), xi)).collect::<Vec<_>>();
            let slopes = nodes.iter().copied().zip(shape::edge_derivatives(nodes.len(), xi));
            let position = values.iter().map(|&(node, n)| mesh.nodes[node] * n).sum();
            let along = slopes.map(|(node, n)| mesh.nodes[node] * n).sum();
            EdgePoint { edge, weight, position, along, values }
        })
    })
}

/// Consistent nodal weights of a traction: ∫ N_a w |X'| dξ at the Gauss points.
pub fn edge_weights(mesh: &Mesh, edges: &[Edge]) -> Vec<NodalWeight> {
    along_edges(mesh, edges, |along| along.norm())
}

/// Weights of a pressure along x and y: −∫ N_a w n̂ |X'| dξ with n̂ |X'| = (X'_y, −X'_x) out of the body, on the left of its
/// edges.
pub fn pressure_weights(mesh: &Mesh, edges: &[Edge]) -> [Vec<NodalWeight>; 2] {
    [along_edges(mesh, edges, |along| -along.y), along_edges(mesh, edges, |along| along.x)]
}

/// Weights of a total force on edges as a uniform traction: those of a traction divided by ∫ w |X'| dξ.
pub fn uniform_weights(mesh: &Mesh, edges: &[Edge]) -> Vec<NodalWeight> {
    let weights = edge_weights(mesh, edges);
    let total: f64 = weights.iter().map(|share| share.weight).sum();
    weights.into_iter().map(|share| NodalWeight { weight: share.weight / total, ..share }).collect()
}

/// ∫ N_a w f(X') dξ at the Gauss points.
fn along_edges(mesh: &Mesh, edges: &[Edge], f: impl Fn(Vector2<f64>) -> f64) -> Vec<NodalWeight> {
    let mut weights = Vec::new();
    for EdgePoint { weight, position, along, values, .. } in gauss_points(mesh, edges) {
        let stretch = f(along) * mesh.section.weight(position);
        weights.extend(values.iter().map(|&(node, n)| NodalWeight { node, weight: weight * n * stretch, position }));
    }
    weights
}

/// Nodal weights of a force per mass on a bar, on a body, ∫ ρ N_a dV, and on point masses.
pub fn mass_weights(model: &Model, name: &str, place: &str) -> Checked<Vec<NodalWeight>> {
    if let Some(bar) = model.bars.iter().find(|bar| bar.name == name) {
        refuse_if(bar.mass == 0.0, place, format!("gravity needs a mass: give bars.{name}.mass, which is per length"))?;
        let share = |(node, weight, position)| NodalWeight { node, weight, position };
        return Ok(bar.weights().map(share).collect());
    }
    let (body, masses) = bodies_and_masses(model, name, ", on which gravity acts", place)?;
    let message = format!("gravity needs a mass: give bodies.{name}.material.density");
    refuse_if(masses.is_none() && body.is_some_and(|body| body.material.description().density == 0.0), place, message)?;
    let share = |node: usize, weight: f64| NodalWeight { node, weight, position: model.mesh.nodes[node] };
    let mut weights = Vec::new();
    for &e in body.iter().flat_map(|body| &body.elements) {
        // Row sum: ∫ ρ N_a dV.
        let rows = model.element_mass(e);
        let nodes = model.mesh.elements[e].nodes.iter().enumerate();
        weights.extend(nodes.map(|(a, &node)| share(node, rows.row(a).sum())));
    }
    if let Some(point) = masses {
        weights.extend(point.nodes.iter().map(|&node| share(node, point.mass)));
    }
    Ok(weights)
}

/// Nodal parts of an absorbing side.
pub fn absorbers(model: &Model, edges: &[Edge]) -> Vec<Absorber> {
    let mut total: BTreeMap<usize, Matrix2<f64>> = BTreeMap::new();
    for EdgePoint { edge, weight, position, along, values } in gauss_points(&model.mesh, edges) {
        let body = model.body_of(edge.element);
        let impedance = |modulus: f64| (modulus * body.material.description().density).sqrt();
        let s = along.normalize();
        let n = Vector2::new(s.y, -s.x);
        let resistance = n * n.transpose() * impedance(body.wave_modulus())
            + s * s.transpose() * impedance(body.material.description().shear_modulus);
        for (node, value) in values {
            let share = weight * value * along.norm() * model.mesh.section.weight(position);
            *total.entry(node).or_default() += resistance * share;
        }
    }
    total.into_iter().map(|(node, coefficients)| Absorber { node, coefficients }).collect()
}
