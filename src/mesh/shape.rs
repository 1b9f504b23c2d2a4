//! Shape functions and quadrature of the reference elements and edges.
//!
//! Nodes are numbered as in gmsh: corners counter-clockwise, then mid-sides in the same order, then the centre.
//! Triangles live on 0 ≤ ξ, η, ξ + η ≤ 1, quadrilaterals on [−1, 1]², edges on [−1, 1] (end, end, middle).

use serde::{Deserialize, Serialize};

use super::few::Few;

/// Kind of a solid element.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[non_exhaustive]
pub enum ElementKind {
    /// Linear triangle, 3 nodes
    T3,
    /// Quadratic triangle, 6 nodes
    T6,
    /// Bilinear quadrilateral, 4 nodes
    Q4,
    /// Serendipity quadrilateral, 8 nodes
    Q8,
    /// Biquadratic quadrilateral, 9 nodes
    Q9,
}

/// A quadrature point: reference coordinates and weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuadraturePoint {
    /// (ξ, η)
    pub at: [f64; 2],
    /// weight; the weights sum to the area of the reference element
    pub weight: f64,
}

impl ElementKind {
    /// Number of nodes.
    pub fn nodes(self) -> usize {
        match self {
            Self::T3 => 3,
            Self::T6 => 6,
            Self::Q4 => 4,
            Self::Q8 => 8,
            Self::Q9 => 9,
        }
    }

    /// Number of corners, which is also the number of edges.
    pub fn corners(self) -> usize {
        match self {
            Self::T3 | Self::T6 => 3,
            _ => 4,
        }
    }

    /// Local nodes of edge `edge`: (start, end), counter-clockwise, and the middle node of a quadratic element.
    pub fn edge(self, edge: usize) -> ([usize; 2], Option<usize>) {
        let n = self.corners();
        ([edge, (edge + 1) % n], (self.nodes() > n).then_some(n + edge))
    }

    /// Reference coordinates of the element's centre.
    pub fn centre(self) -> [f64; 2] {
        match self {
            Self::T3 | Self::T6 => [1.0 / 3.0; 2],
            _ => [0.0; 2],
        }
    }

    /// Shape functions N_a at (ξ, η).
    pub fn values(self, [x, y]: [f64; 2]) -> Vec<f64> {
        match self {
            Self::T3 => vec![1.0 - x - y, x, y],
            Self::T6 => {
                let z = 1.0 - x - y;
                vec![
                    z * (2.0 * z - 1.0),
                    x * (2.0 * x - 1.0),
                    y * (2.0 * y - 1.0),
                    4.0 * z * x,
                    4.0 * x * y,
                    4.0 * y * z,
                ]
            }
            Self::Q4 => CORNERS.iter().map(|[a, b]| 0.25 * (1.0 + a * x) * (1.0 + b * y)).collect(),
            Self::Q8 => {
                let mut n: Vec<f64> =
                    CORNERS.iter().map(|[a, b]| 0.25 * (1.0 + a * x) * (1.0 + b * y) * (a * x + b * y - 1.0)).collect();
                n.extend([
                    0.5 * (1.0 - x * x) * (1.0 - y),
                    0.5 * (1.0 + x) * (1.0 - y * y),
                    0.5 * (1.0 - x * x) * (1.0 + y),
                    0.5 * (1.0 - x) * (1.0 - y * y),
                ]);
                n
            }
            Self::Q9 => Q9_NODES.iter().map(|&[a, b]| lagrange3(a, x).0 * lagrange3(b, y).0).collect(),
        }
    }

    /// Derivatives [∂N_a/∂ξ, ∂N_a/∂η] at (ξ, η).
    pub fn derivatives(self, [x, y]: [f64; 2]) -> Vec<[f64; 2]> {
        match self {
            Self::T3 => vec![[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]],
            Self::T6 => {
                let z = 1.0 - x - y;
                vec![
                    [1.0 - 4.0 * z, 1.0 - 4.0 * z],
                    [4.0 * x - 1.0, 0.0],
                    [0.0, 4.0 * y - 1.0],
                    [4.0 * (z - x), -4.0 * x],
                    [4.0 * y, 4.0 * x],
                    [-4.0 * y, 4.0 * (z - y)],
                ]
            }
            Self::Q4 => CORNERS.iter().map(|[a, b]| [0.25 * a * (1.0 + b * y), 0.25 * b * (1.0 + a * x)]).collect(),
            Self::Q8 => {
                let mut d: Vec<[f64; 2]> = CORNERS
                    .iter()
                    .map(|[a, b]| {
                        [
                            0.25 * a * (1.0 + b * y) * (2.0 * a * x + b * y),
                            0.25 * b * (1.0 + a * x) * (a * x + 2.0 * b * y),
                        ]
                    })
                    .collect();
                d.extend([
                    [-x * (1.0 - y), -0.5 * (1.0 - x * x)],
                    [0.5 * (1.0 - y * y), -(1.0 + x) * y],
                    [-x * (1.0 + y), 0.5 * (1.0 - x * x)],
                    [-0.5 * (1.0 - y * y), -(1.0 - x) * y],
                ]);
                d
            }
            Self::Q9 => Q9_NODES
                .iter()
                .map(|&[a, b]| {
                    let ((nx, dx), (ny, dy)) = (lagrange3(a, x), lagrange3(b, y));
                    [dx * ny, nx * dy]
                })
                .collect(),
        }
    }

    /// Quadrature of the stiffness (full integration: T3 1, T6 3, Q4 4, Q8 and Q9 9 points). A Q8 may have 2 × 2 of them instead
    /// ([`reduced`](Self::reduced_quadrature)).
    #[doc(hidden)]
    pub fn quadrature(self) -> Vec<QuadraturePoint> {
        match self {
            Self::T3 => vec![QuadraturePoint { at: [1.0 / 3.0; 2], weight: 0.5 }],
            Self::T6 => triangle_rule([1.0 / 6.0], [1.0 / 6.0]),
            Self::Q4 => square_rule(2),
            Self::Q8 | Self::Q9 => square_rule(3),
        }
    }

    /// Quadrature of quadrilaterals one order lower: 2 × 2 points of a Q8, 1 of a Q4.
    #[doc(hidden)]
    pub fn reduced_quadrature(self) -> Vec<QuadraturePoint> {
        match self {
            Self::T3 | Self::T6 => self.quadrature(),
            Self::Q4 => square_rule(1),
            Self::Q8 | Self::Q9 => square_rule(2),
        }
    }

    /// Quadrature of the consistent mass, exact for N_a N_b on an undistorted element.
    #[doc(hidden)]
    pub fn mass_quadrature(self) -> Vec<QuadraturePoint> {
        match self {
            Self::T3 => triangle_rule([1.0 / 6.0], [1.0 / 6.0]),
            // Degree 4, six points: D. A. Dunavant (1985), Int. J. Numer. Meth. Engng 21, 1129.
            Self::T6 => triangle_rule(
                [0.445_948_490_915_965, 0.091_576_213_509_771],
                [0.223_381_589_678_011 / 2.0, 0.109_951_743_655_322 / 2.0],
            ),
            Self::Q4 => square_rule(2),
            Self::Q8 | Self::Q9 => square_rule(3),
        }
    }
}

const CORNERS: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
const Q9_NODES: [[f64; 2]; 9] =
    [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [0.0, -1.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, 0.0]];

/// Quadratic Lagrange polynomial of the node at −1, 0 or 1, and its derivative, at x.
fn lagrange3(node: f64, x: f64) -> (f64, f64) {
    if node == 0.0 { (1.0 - x * x, -2.0 * x) } else { (0.5 * x * (x + node), x + 0.5 * node) }
}

/// Symmetric triangle rule: each (a, weight) represents the three points with barycentric coordinates (a, a, 1 − 2a).
fn triangle_rule<const N: usize>(places: [f64; N], weights: [f64; N]) -> Vec<QuadraturePoint> {
    places
        .into_iter()
        .zip(weights)
        .flat_map(|(a, weight)| {
            let b = 1.0 - 2.0 * a;
            [[a, a], [b, a], [a, b]].map(|at| QuadraturePoint { at, weight })
        })
        .collect()
}

fn square_rule(n: usize) -> Vec<QuadraturePoint> {
    let line = gauss(n);
    line.iter()
        .flat_map(|&(y, wy)| line.iter().map(move |&(x, wx)| QuadraturePoint { at: [x, y], weight: wx * wy }))
        .collect()
}

/// Gauss–Legendre rule with 1 to 4 points on [−1, 1]: (ξ, weight); the weights sum to 2.
///
/// # Panics
/// When `n` is not 1, 2, 3 or 4: the case file is checked before.
pub fn gauss(n: usize) -> Few<(f64, f64), 4> {
    match n {
        1 => [(0.0, 2.0)].into(),
        2 => {
            let x = 1.0 / 3.0f64.sqrt();
            [(-x, 1.0), (x, 1.0)].into()
        }
        3 => {
            let x = 0.6f64.sqrt();
            [(-x, 5.0 / 9.0), (0.0, 8.0 / 9.0), (x, 5.0 / 9.0)].into()
        }
        4 => {
            let (near, far) = ((6.0f64 / 5.0).sqrt(), 30.0f64.sqrt());
            let (a, b) = ((3.0 / 7.0 - 2.0 / 7.0 * near).sqrt(), (3.0 / 7.0 + 2.0 / 7.0 * near).sqrt());
            let (wa, wb) = ((18.0 + far) / 36.0, (18.0 - far) / 36.0);
            [(-b, wb), (-a, wa), (a, wa), (b, wb)].into()
        }
        _ => panic!("a Gauss rule has 1 to 4 points, not {n}"),
    }
}

/// Shape functions of an edge with 2 or 3 nodes (end, end, middle) at ξ.
pub fn edge_values(nodes: usize, x: f64) -> Few<f64, 3> {
    match nodes {
        2 => [0.5 * (1.0 - x), 0.5 * (1.0 + x)].into(),
        _ => [0.5 * x * (x - 1.0), 0.5 * x * (x + 1.0), 1.0 - x * x].into(),
    }
}

/// Derivatives dN_a/dξ of an edge with 2 or 3 nodes (end, end, middle) at ξ.
pub fn edge_derivatives(nodes: usize, x: f64) -> Few<f64, 3> {
    match nodes {
        2 => [-0.5, 0.5].into(),
        _ => [x - 0.5, x + 0.5, -2.0 * x].into(),
    }
}
