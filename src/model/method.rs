//! Contact method: as requested, or chosen for the surfaces.
//!
//! Pointwise contact of meshes is exact only while nodes face nodes. Elsewhere two points per edge, and on quadratic edges anywhere, leave
//! the pressure to alternate, the more so the stiffer the penalty. Whatever faces what at the start, surfaces slide; so meshes are met by
//! mortar, which averages. It costs about a third more per evaluation of the contact: explicit increments, which do little else, stay with
//! points on straight linear edges, and quasi-dynamic ones need nodes. A corner of the slave is constrained where it has a contact point of its
//! own.
//!
//! A rigid master is met by nodes where it is bent, and there by Gauss points where it has corners or ends: of the points between two nodes
//! each leaves a corner of the master by itself and has the normal of a face, whereas a node at a corner has none, and an average over an
//! edge lets the corner in. Their penalty is soft (`builder/pair.rs`), with which their pressures do not scatter.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::contact::master::Master;
use crate::contact::search::Index;
use crate::contact::surface::{CORNER, MasterPoint, SlavePoint, Surface, in_order, nodal_points};
use crate::mesh::{Configuration, Group, Mesh};
use crate::model::scheme::Regime;

/// Contact method: evaluation points of contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Method {
    /// At the slave's nodes, with tributary lengths
    NodeToSegment,
    /// At Gauss points of the slave's edges
    GaussToSegment,
    /// Averaged around the slave's nodes, or along its quadratic edges, integrated exactly over non-matching meshes
    Mortar,
}

impl Method {
    /// Name in a case.
    pub fn name(self) -> &'static str {
        match self {
            Self::NodeToSegment => "node_to_segment",
            Self::GaussToSegment => "gauss_to_segment",
            Self::Mortar => "mortar",
        }
    }
}

/// The method in force, with the reason for it and a warning.
#[derive(Clone, Debug, PartialEq)]
pub struct Chosen {
    /// method
    pub method: Method,
    /// Gauss points per edge, for gauss_to_segment
    pub points: usize,
    /// Reason, if it was chosen automatically
    pub because: Option<&'static str>,
    /// Known weakness, and the remedy
    pub concern: Option<&'static str>,
}

/// Geometry of a surface that decides on the default method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Looks {
    shape: Shape,
    /// Whether it has a corner, of more than 45°, at which two of its edges meet
    corner: bool,
}

impl Looks {
    const STRAIGHT: Self = Self { shape: Shape::Straight, corner: false };
}

/// Shape of a surface between its corners: straight, curved or quadratic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shape {
    Straight,
    Curved,
    Quadratic,
}

/// Default number of Gauss points per edge.
const POINTS: usize = 2;

/// The same on quadratic edges against a rigid master with corners: of fewer, each is a larger part of the edge that a corner lets go.
const FINE_POINTS: usize = 4;

/// Reason for nodes on a bent rigid master
const BENT: &str = "chosen because the master is bent";

/// Angle by which the direction of a linear-edge surface must vary between two corners for it to count as curved; far above the
/// round-off of a straight line, and below facets that affect the pressure [rad].
const CURVED: f64 = 0.0175;

/// Input of a contact that decides on its method, and the steps of the run.
#[derive(Clone, Copy, Debug)]
pub struct Asked {
    /// The method, if it is given
    pub method: Option<Method>,
    /// Gauss points an edge, if they are
    pub points: Option<usize>,
    /// Whether the master is smoothed
    pub smooth: bool,
    /// The steps of the run
    pub regime: Regime,
    /// Whether the surfaces neither part nor slide
    pub tied: bool,
    /// Whether every point keeps what it faces
    pub small: bool,
    /// Shape of a rigid master
    pub tool: Tool,
}

/// Shape of a rigid master that decides on the default method.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tool {
    /// A plane, or no rigid master
    #[default]
    Flat,
    /// A circle, or lines without sharp corners: two Gauss points would hold each node of an edge twice
    Bent,
    /// With corners or ends, at which a node would have no normal of its own, and of which an average knows nothing
    Sharp,
}

/// Chooses the method of a contact of two edge groups, the second `None` for a rigid master.
pub fn choose(groups: [Option<&str>; 2], asked: Asked, mesh: &Mesh) -> Chosen {
    let [slave, master] = groups.map(|group| group.map(|group| looks(mesh, group)));
    let slave = slave.unwrap_or(Looks::STRAIGHT);
    let given = asked.method.or(asked.points.map(|_| Method::GaussToSegment));
    let points = asked.points.unwrap_or(POINTS);
    if let Some(method) = given {
        // Nodes that face nodes for good carry what they should.
        let meet = || matches!(groups, [Some(slave), Some(master)] if nodes_meet(slave, master, mesh));
        let fits = asked.small && method == Method::NodeToSegment && meet();
        let concern = if fits { None } else { concern(method, points, slave, master) };
        return Chosen { method, points, because: None, concern };
    }
    let chosen = |method, because, concern| Chosen { method, points, because: Some(because), concern };
    if asked.regime == Regime::QuasiDynamic {
        return chosen(Method::NodeToSegment, "chosen because a step is quasi_dynamic", None);
    }
    if groups[1].is_none() && !asked.small {
        match (asked.tool, slave.shape) {
            (Tool::Sharp, shape) => {
                let points = if shape == Shape::Quadratic { FINE_POINTS } else { POINTS };
                let because = "chosen because the master has corners";
                return Chosen { points, ..chosen(Method::GaussToSegment, because, None) };
            }
            (Tool::Bent, Shape::Quadratic) => return chosen(Method::NodeToSegment, BENT, None),
            _ => {}
        }
    }
    if asked.smooth {
        let concern = (slave.shape != Shape::Straight).then_some(
            "`smooth` takes pointwise contact, and on a curved or quadratic slave pressures scatter: leave `smooth` out for mortar",
        );
        return chosen(Method::GaussToSegment, "chosen because mortar takes no smooth master", concern);
    }
    let (method, because) = match (groups, asked.regime) {
        ([_, Some(_)], Regime::Static | Regime::Dynamic) => (Method::Mortar, "chosen because the master is a mesh"),
        _ => by_looks(groups, [Some(slave), master], asked, mesh),
    };
    chosen(method, because, None)
}

/// The method against rigid masters, and in explicit runs.
fn by_looks(groups: [Option<&str>; 2], looks: [Option<Looks>; 2], asked: Asked, mesh: &Mesh) -> (Method, &'static str) {
    let are = |shape: Shape| looks.iter().flatten().any(|looks| looks.shape == shape);
    if are(Shape::Quadratic) {
        return (Method::Mortar, "chosen because edges are quadratic");
    }
    if are(Shape::Curved) {
        return (Method::Mortar, "chosen because surfaces are curved");
    }
    match groups {
        [_, None] if asked.tool != Tool::Flat => (Method::NodeToSegment, BENT),
        [_, None] if looks[0].is_some_and(|slave| slave.corner) => {
            (Method::NodeToSegment, "chosen because the slave has a corner")
        }
        [Some(slave), Some(master)] if asked.tied && !nodes_meet(slave, master, mesh) => {
            (Method::Mortar, "chosen because nodes do not face nodes")
        }
        _ => (Method::GaussToSegment, "chosen because surfaces are straight and linear"),
    }
}

/// Nodes that face each other within this share of an edge do so but for round-off.
const FACE: f64 = 1e-6;

/// Whether, in the positions of the mesh, nodes of both surfaces face nodes, or nothing.
pub fn nodes_meet(slave: &str, master: &str, mesh: &Mesh) -> bool {
    let edges = |group: &str| match mesh.group(group) {
        Ok(Group::Edges(edges)) => edges.iter().map(|edge| edge.nodes.clone()).collect(),
        _ => Vec::new(),
    };
    let [slave, master] = [slave, master].map(|group| in_order(&edges(group)));
    let x = mesh.undeformed();
    [(&slave, &master), (&master, &slave)].into_iter().all(|(points, faced)| {
        faced.is_empty() || between_nodes(&nodal_points(points), &Master::Mesh(Surface::new(faced)), &x).is_none()
    })
}

/// Returns the first node that faces an edge elsewhere than at a node.
pub fn between_nodes<'a>(nodes: &'a [SlavePoint], faced: &Master, x: &Configuration) -> Option<&'a SlavePoint> {
    let index = Index::new(faced, x);
    let is_between = |MasterPoint { segment, xi }: MasterPoint| {
        let middle = faced.segments()[segment].middle.map(|_| 0.5);
        [0.0, 1.0].into_iter().chain(middle).all(|node| (xi - node).abs() > FACE)
    };
    nodes.iter().find(|node| index.project(node, None, x).is_some_and(|projection| is_between(projection.master_point)))
}

/// Known weakness of the requested method for these surfaces, if any.
fn concern(method: Method, points: usize, slave: Looks, master: Option<Looks>) -> Option<&'static str> {
    let is_straight = |looks: Looks| looks.shape == Shape::Straight;
    let straight = is_straight(slave) && master.is_none_or(is_straight);
    match (method, master) {
        (Method::Mortar, _) => None,
        _ if straight => None,
        (Method::NodeToSegment, None) => None,
        (Method::NodeToSegment, Some(_)) => Some(
            "node_to_segment on curved or quadratic surfaces: pressures scatter, and where nodes meet nodes even a \
             frictionless contact carries shear; leave `method` out for mortar",
        ),
        (Method::GaussToSegment, None) if slave.shape == Shape::Curved || points > POINTS => None,
        (Method::GaussToSegment, _) => Some(
            "gauss_to_segment on curved or quadratic surfaces: pressures scatter and points may open; leave `method` and \
             `points` out for mortar",
        ),
    }
}

/// Shape of the edges of a group; other groups are refused elsewhere.
fn looks(mesh: &Mesh, group: &str) -> Looks {
    let Ok(Group::Edges(edges)) = mesh.group(group) else { return Looks::STRAIGHT };
    let mut looks = Looks::STRAIGHT;
    if edges.iter().any(|edge| edge.nodes.len() > 2) {
        looks.shape = Shape::Quadratic;
    }
    let edges = in_order(&edges.iter().map(|edge| edge.nodes.clone()).collect::<Vec<_>>());
    // Angles are accumulated from edge to edge between corners.
    let (mut angle, mut range) = (0.0f64, [0.0f64; 2]);
    for pair in edges.windows(2) {
        let [before, after] = [&pair[0], &pair[1]].map(|edge| mesh.nodes[edge[1]] - mesh.nodes[edge[0]]);
        let joined = pair[0][1] == pair[1][0];
        if !joined || before.dot(&after) <= CORNER * before.norm() * after.norm() {
            looks.corner |= joined;
            (angle, range) = (0.0, [0.0; 2]);
            continue;
        }
        angle += before.perp(&after).atan2(before.dot(&after));
        range = [range[0].min(angle), range[1].max(angle)];
        if range[1] - range[0] > CURVED && looks.shape == Shape::Straight {
            looks.shape = Shape::Curved;
        }
    }
    looks
}
