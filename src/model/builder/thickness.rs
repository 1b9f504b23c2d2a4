//! Thickness of bodies behind their surfaces: how far a line along the inward normal goes until it leaves them.
//!
//! The far side of a body faces what the near side faces, from behind: two blocks on each other, each with all its sides in contact, face
//! with the top of the upper one the bottom of the lower one, two thicknesses deep. A point that is deeper behind a surface than half of
//! its own body is not in contact with it.

use nalgebra::Vector2;

use crate::contact::mortar::Mortar;
use crate::contact::projection::normal_of;
use crate::contact::surface::SlavePoint;
use crate::mesh::Mesh;

/// Sides of elements without a neighbour, with the connected part of the mesh to which each belongs.
pub struct Outline<'m> {
    mesh: &'m Mesh,
    /// First node of the part of every node
    part: Vec<usize>,
    /// Start and end first, the body on the left
    sides: Vec<Vec<usize>>,
}

/// Distance of a place from a side, relative to its length, below which it lies on it.
const ON_SIDE: f64 = 1e-9;

impl<'m> Outline<'m> {
    /// Finds the outline of all bodies.
    pub fn new(mesh: &'m Mesh) -> Self {
        let mut part: Vec<usize> = (0..mesh.nodes.len()).collect();
        for element in &mesh.elements {
            for pair in element.nodes.windows(2) {
                let [a, b] = [first(&mut part, pair[0]), first(&mut part, pair[1])];
                part[a.max(b)] = a.min(b);
            }
        }
        let part = (0..part.len()).map(|node| first(&mut part, node)).collect();
        Self { mesh, part, sides: Mesh::free_sides(&mesh.elements) }
    }

    /// Sets the depths of points, and of edges for mortar averages.
    pub fn limit(&self, points: &mut [SlavePoint], mortar: Option<&mut Mortar>) {
        let x = self.mesh.undeformed();
        for point in points {
            if let (Some(outward), Some(&(node, _))) = (point.outward(&x), point.position.first()) {
                point.depth = 0.5 * self.behind(node, point.at(&x), -outward);
            }
        }
        if let Some(Mortar { edges, depths, .. }) = mortar {
            *depths = edges.iter().map(|edge| 0.5 * self.thickness_at(edge)).collect();
        }
    }

    /// Thickness of the body behind the middle of one of its edges (start, end[, middle]); infinite where no side is met.
    fn thickness_at(&self, edge: &[usize]) -> f64 {
        let [a, b] = [edge[0], edge[1]].map(|node| self.mesh.nodes[node]);
        self.behind(edge[0], 0.5 * (a + b), normal_of((b - a).normalize()))
    }

    /// Thickness of the body of a node behind a place of its surface; infinite where no side is met.
    fn behind(&self, node: usize, at: Vector2<f64>, inward: Vector2<f64>) -> f64 {
        let part = self.part[node];
        let leaves = |side: &Vec<usize>| {
            let [start, end] = [side[0], side[1]];
            if self.part[start] != part {
                return None;
            }
            let [a, b] = [start, end].map(|node| self.mesh.nodes[node] - at);
            let along = b - a;
            let across = inward.perp(&along);
            // The body lies on the left of a side: what leaves it crosses to the right.
            if across <= ON_SIDE * along.norm() {
                return None;
            }
            let share = a.perp(&inward) / across;
            let distance = a.perp(&along) / across;
            let meets = (-ON_SIDE..=1.0 + ON_SIDE).contains(&share) && distance > ON_SIDE * along.norm();
            meets.then_some(distance)
        };
        self.sides.iter().filter_map(leaves).fold(f64::INFINITY, f64::min)
    }
}

/// First node of the part to which a node belongs, as far as parts are joined.
fn first(part: &mut [usize], node: usize) -> usize {
    let mut at = node;
    while part[at] != at {
        part[at] = part[part[at]];
        at = part[at];
    }
    at
}
