//! Points of the two sides of a contact: where it is evaluated on the slave, and where they meet the master.

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

use crate::mesh::configuration::Configuration;
use crate::mesh::few::Few;
use crate::mesh::shape;

/// A linear combination of nodal positions, Σ w_a x_a.
pub type Weights = Vec<(usize, f64)>;

/// One edge's share of the length that a slave point stands for: `factor` × |Σ w_a x_a| × w of the section there.
#[derive(Clone, Debug, PartialEq)]
pub struct LengthShare {
    /// Quadrature weight
    pub factor: f64,
    /// Shape functions of the quadrature point
    pub at: Weights,
    /// Weights of the tangent vector dx/dξ
    pub tangent: Weights,
}

/// A point of the slave surface where contact is evaluated.
#[derive(Clone, Debug, PartialEq)]
pub struct SlavePoint {
    /// Shape functions of the point
    pub position: Weights,
    /// Its current length is the sum of these shares and `area` [L]
    pub length: Vec<LengthShare>,
    /// Area of a point that belongs to no edge, as a point mass has it, given as a whole; it does not change [L]
    pub area: f64,
    /// Gap between the surfaces at which the point touches: 0, but for a contact that starts closed under a given
    /// pressure [L]
    pub touch: f64,
    /// Number of its friction law among those of the pair
    pub law: usize,
    /// How deep the point lies in the master at the start of a shrink fit, which counts bit by bit as the first step goes on
    /// [L]
    pub overlap: f64,
}

impl SlavePoint {
    /// Current position.
    pub fn at(&self, x: &Configuration) -> Vector2<f64> {
        let [reference, displacement] = x.apart(&self.position, Vector2::zeros());
        reference + displacement
    }

    /// g: gap of the surfaces − gap at touch, an overlap counted but for the share that fades.
    pub fn gap(&self, surfaces: f64, fading: f64) -> f64 {
        surfaces - self.touch + fading * self.overlap
    }

    /// x − x_node.
    pub fn offset(&self, node: usize, x: &Configuration) -> Vector2<f64> {
        self.position.iter().map(|&(own, w)| x.between(node, own) * w).sum()
    }

    /// Current length that the point stands for [L].
    pub fn current_length(&self, x: &Configuration) -> f64 {
        let weighted = |share: &LengthShare| share.factor * x.combine(&share.tangent).norm() * x.weight(&share.at);
        self.area + self.length.iter().map(weighted).sum::<f64>()
    }

    /// Current length of the longest edge the point belongs to, if it belongs to any [L].
    pub fn edge_length(&self, x: &Configuration) -> Option<f64> {
        // dx/dξ on an edge from −1 to 1 is half its length.
        self.length.iter().map(|share| 2.0 * x.combine(&share.tangent).norm()).max_by(f64::total_cmp)
    }

    /// Unit normal out of the slave body: the edge direction, body on its left, turned by −90°. A point of no edge has
    /// none.
    pub fn outward(&self, x: &Configuration) -> Option<Vector2<f64>> {
        let along: Vector2<f64> = self.length.iter().map(|share| x.combine(&share.tangent) * share.factor).sum();
        (!self.length.is_empty()).then(|| Vector2::new(along.y, -along.x).normalize())
    }
}

/// The points of a slave surface: Gauss points of each edge, or its nodes.
///
/// `edges` are (start, end[, middle]) with the body on the left, in order along the surface.
pub fn gauss_points(edges: &[Vec<usize>], per_edge: usize) -> Vec<SlavePoint> {
    let rule = shape::gauss(per_edge);
    edges.iter().flat_map(|edge| rule.iter().map(|&(xi, weight)| edge_point(edge, xi, weight))).collect()
}

/// Nodes with their tributary lengths: the end-point rule (linear edges) or Simpson's (quadratic edges).
pub fn nodal_points(edges: &[Vec<usize>]) -> Vec<SlavePoint> {
    at_nodes(edges, |edge, xi, weight| edge_point(edge, xi, weight).length)
}

/// Nodes of rings with their tributary areas ∫ N_a 2π r ds, by Gauss's rule: the rules above know r at the nodes alone, and
/// leave nothing to one on the axis. (Nor has the end of a quadratic edge anything there in truth.)
pub fn nodal_points_of_rings(edges: &[Vec<usize>]) -> Vec<SlavePoint> {
    let shares = |edge: &[usize], node: f64| -> Vec<LengthShare> {
        let share = |(xi, weight): (f64, f64)| edge_point(edge, xi, 0.5 * (1.0 + node * xi) * weight).length;
        shape::gauss(2).into_iter().flat_map(share).collect()
    };
    at_nodes(edges, |edge, xi, weight| match edge.len() {
        2 => shares(edge, xi),
        _ => edge_point(edge, xi, weight).length,
    })
}

/// The nodes with what each edge gives them, by their ξ and the weight of the rule.
fn at_nodes(edges: &[Vec<usize>], shares: impl Fn(&[usize], f64, f64) -> Vec<LengthShare>) -> Vec<SlavePoint> {
    let mut points: Vec<(usize, SlavePoint)> = Vec::new();
    for edge in edges {
        let ends = [(edge[0], -1.0), (edge[1], 1.0)];
        let stations: Vec<(usize, f64, f64)> = match edge.get(2) {
            None => ends.map(|(node, xi)| (node, xi, 1.0)).to_vec(),
            Some(&middle) => vec![(ends[0].0, -1.0, 1.0 / 3.0), (middle, 0.0, 4.0 / 3.0), (ends[1].0, 1.0, 1.0 / 3.0)],
        };
        for (node, xi, weight) in stations {
            let share = shares(edge, xi, weight);
            match points.iter_mut().rev().find(|(other, _)| *other == node) {
                Some((_, point)) => point.length.extend(share),
                None => points.push((node, SlavePoint { length: share, ..lone_point(node, 0.0) })),
            }
        }
    }
    points.into_iter().map(|(_, point)| point).collect()
}

/// A node that belongs to no edge, with an area of its own [L].
pub fn lone_point(node: usize, area: f64) -> SlavePoint {
    SlavePoint { position: vec![(node, 1.0)], length: Vec::new(), area, touch: 0.0, law: 0, overlap: 0.0 }
}

/// The point of an edge at ξ, that stands for a share of the edge's length.
pub fn edge_point(edge: &[usize], xi: f64, weight: f64) -> SlavePoint {
    let with = |values: Few<f64, 3>| -> Weights { edge.iter().copied().zip(values).collect() };
    let position = with(shape::edge_values(edge.len(), xi));
    let tangent = with(shape::edge_derivatives(edge.len(), xi));
    SlavePoint {
        length: vec![LengthShare { factor: weight, at: position.clone(), tangent }],
        position,
        area: 0.0,
        touch: 0.0,
        law: 0,
        overlap: 0.0,
    }
}

/// A material point of the master: segment and coordinate along it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct MasterPoint {
    /// Segment number; of a rigid body the number of its line
    pub segment: usize,
    /// 0 … 1 along the segment; on a rigid body the way along s (of line number `segment`) from where the point's
    /// reference position has its foot [-] or [L]
    pub xi: f64,
}
