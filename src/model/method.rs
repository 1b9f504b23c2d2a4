//! Contact method: as requested, or chosen for the surfaces.
//!
//! Pointwise contact passes the patch test for straight linear edges to about a percent. On quadratic edges with two points the
//! pressure alternates, and between two faceted curves the gap itself alternates by the height of the facets, which the
//! penalty converts into pressures far above the actual ones. In these cases mortar averages are used.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::contact::surface::{CORNER, in_order};
use crate::mesh::{Group, Mesh};

/// Contact method: evaluation points of contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Method {
    /// At the slave's nodes, with tributary lengths
    NodeToSegment,
    /// At Gauss points of the slave's edges
    GaussToSegment,
    /// Averaged around the slave's nodes, integrated exactly over non-matching meshes
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

/// Shape of a surface: straight, curved or quadratic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Looks {
    Straight,
    Curved,
    Quadratic,
}

/// Default number of Gauss points per edge.
const POINTS: usize = 2;

/// Angle by which the direction of a linear-edge surface must vary between two corners for it to count as curved; far above the
/// round-off of a straight line, and below facets that affect the pressure [rad].
const CURVED: f64 = 0.0175;

/// Chooses the method of a contact of two edge groups, the second `None` for a rigid master.
pub fn choose(
    slave: &str,
    master: Option<&str>,
    method: Option<Method>,
    points: Option<usize>,
    smooth: bool,
    mesh: &Mesh,
) -> Chosen {
    let slave = looks(mesh, slave);
    let master = master.map(|group| looks(mesh, group));
    let given = method.or(points.map(|_| Method::GaussToSegment));
    let points = points.unwrap_or(POINTS);
    if let Some(method) = given {
        return Chosen { method, points, because: None, concern: concern(method, points, slave, master) };
    }
    let chosen = |method, because, concern| Chosen { method, points, because: Some(because), concern };
    let all = [Some(slave), master];
    let has = |looks: Looks| all.contains(&Some(looks));
    let because = match (has(Looks::Quadratic), has(Looks::Curved)) {
        (true, _) => "chosen because edges are quadratic",
        (_, true) => "chosen because surfaces are curved",
        _ => return chosen(Method::GaussToSegment, "chosen because surfaces are straight and linear", None),
    };
    if !smooth {
        return chosen(Method::Mortar, because, None);
    }
    let concern = (slave != Looks::Straight).then_some(
        "`smooth` takes pointwise contact, and on a curved or quadratic slave pressures scatter: leave `smooth` out for mortar",
    );
    chosen(Method::GaussToSegment, "chosen because mortar takes no smooth master", concern)
}

/// Known weakness of the requested method for these surfaces, if any.
fn concern(method: Method, points: usize, slave: Looks, master: Option<Looks>) -> Option<&'static str> {
    let straight = slave == Looks::Straight && master.is_none_or(|master| master == Looks::Straight);
    match (method, master) {
        (Method::Mortar, _) => None,
        _ if straight => None,
        (Method::NodeToSegment, None) => None,
        (Method::NodeToSegment, Some(_)) => Some(
            "node_to_segment on curved or quadratic surfaces: pressures scatter, and where nodes meet nodes even a \
             frictionless contact carries shear; leave `method` out for mortar",
        ),
        (Method::GaussToSegment, None) if slave == Looks::Curved || points > POINTS => None,
        (Method::GaussToSegment, _) => Some(
            "gauss_to_segment on curved or quadratic surfaces: pressures scatter and points may open; leave `method` and \
             `points` out for mortar",
        ),
    }
}

/// Shape of the edges of a group; other groups are refused elsewhere.
fn looks(mesh: &Mesh, group: &str) -> Looks {
    let Ok(Group::Edges(edges)) = mesh.group(group) else { return Looks::Straight };
    if edges.iter().any(|edge| edge.nodes.len() > 2) {
        return Looks::Quadratic;
    }
    let edges = in_order(&edges.iter().map(|edge| edge.nodes.clone()).collect::<Vec<_>>());
    // Angles are accumulated from edge to edge between corners.
    let (mut angle, mut range) = (0.0f64, [0.0f64; 2]);
    for pair in edges.windows(2) {
        let [before, after] = [&pair[0], &pair[1]].map(|edge| mesh.nodes[edge[1]] - mesh.nodes[edge[0]]);
        let joined = pair[0][1] == pair[1][0] && before.dot(&after) > CORNER * before.norm() * after.norm();
        if !joined {
            (angle, range) = (0.0, [0.0; 2]);
            continue;
        }
        angle += before.perp(&after).atan2(before.dot(&after));
        range = [range[0].min(angle), range[1].max(angle)];
        if range[1] - range[0] > CURVED {
            return Looks::Curved;
        }
    }
    Looks::Straight
}
