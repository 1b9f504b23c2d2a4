//! The element of a position, and its coordinates there.

use nalgebra::{Matrix2, Vector2};

use super::Mesh;
use super::boxes::Box2;
use super::shape::ElementKind;

/// Tolerance of element coordinates for points outside of an element by round-off.
const OUTSIDE: f64 = 1e-6;

/// Maximum number of Newton iterations for the coordinates of a point.
const ITERATIONS: usize = 30;

/// Margin of the bounding box of an element's nodes for curved sides, as a fraction of its size.
const BULGE: f64 = 0.3;

#[doc(hidden)]
impl Mesh {
    /// Bounding box of all points of an element.
    pub fn reach(&self, element: usize) -> Box2 {
        let nodes = self.elements[element].nodes.iter().map(|&node| self.nodes[node]);
        let own = Box2::around(nodes).unwrap_or(Box2 { low: Vector2::zeros(), high: Vector2::zeros() });
        own.wider(BULGE * own.size().max())
    }

    /// (ξ, η) of a position in an element, if it lies there.
    ///
    /// ```text
    /// Σ N_a(ξ, η) X_a = X                     Newton's method from the centre; positions relative to the first node
    /// ```
    pub fn coordinates(&self, element: usize, place: Vector2<f64>) -> Option<[f64; 2]> {
        let element = &self.elements[element];
        let (kind, origin) = (element.kind, self.nodes[element.nodes[0]]);
        let nodes: Vec<Vector2<f64>> = element.nodes.iter().map(|&node| self.nodes[node] - origin).collect();
        let place = place - origin;
        let mut at = Vector2::from(kind.centre());
        for _ in 0..ITERATIONS {
            let x: Vector2<f64> = nodes.iter().zip(kind.values(at.into())).map(|(x, n)| x * n).sum();
            let slopes = kind.derivatives(at.into());
            let map: Matrix2<f64> = nodes.iter().zip(slopes).map(|(x, d)| x * Vector2::from(d).transpose()).sum();
            let step = map.try_inverse()? * (place - x);
            at += step;
            if step.norm() < 1e-3 * OUTSIDE {
                return is_inside(kind, at).then_some(at.into());
            }
        }
        None
    }

    /// ∇N_a at coordinates of an element, with its nodes [1/L].
    pub fn gradients(&self, element: usize, at: [f64; 2]) -> Option<Vec<(usize, Vector2<f64>)>> {
        let element = &self.elements[element];
        let origin = self.nodes[element.nodes[0]];
        let slopes = element.kind.derivatives(at);
        let nodes = element.nodes.iter().zip(&slopes);
        let map: Matrix2<f64> =
            nodes.clone().map(|(&node, d)| (self.nodes[node] - origin) * Vector2::from(*d).transpose()).sum();
        let inverse = map.try_inverse()?.transpose();
        Some(nodes.map(|(&node, d)| (node, inverse * Vector2::from(*d))).collect())
    }
}

fn is_inside(kind: ElementKind, at: Vector2<f64>) -> bool {
    match kind.corners() {
        3 => at.x >= -OUTSIDE && at.y >= -OUTSIDE && at.x + at.y <= 1.0 + OUTSIDE,
        _ => at.amax() <= 1.0 + OUTSIDE,
    }
}
