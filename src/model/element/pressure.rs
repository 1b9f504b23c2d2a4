//! Pressure on an edge that follows the surface.
//!
//! ```text
//! f_a = p ∫ N_a w n̂ |x'| dξ,   n̂ |x'| = (x'_y, −x'_x) out of the body (on the left of the edge)
//! ```
//!
//! as internal force: the load −p n̂ w da moved to the left-hand side, w being the weight of the section at x.

use crate::linear::system::Contribution;
use crate::mesh::configuration::Configuration;
use crate::mesh::shape;

/// Internal force and tangent of pressure `p` (positive toward the body) on one edge at the nodal positions `x`.
pub fn follower_pressure(edge: &[usize], p: f64, x: &Configuration) -> Contribution {
    let mut result = Contribution::zero(edge.to_vec());
    for (xi, weight) in shape::gauss(edge.len()) {
        let values = shape::edge_values(edge.len(), xi);
        let slopes = shape::edge_derivatives(edge.len(), xi);
        let along = x.combine(&edge.iter().copied().zip(slopes.iter().copied()).collect::<Vec<_>>());
        let place: Vec<(usize, f64)> = edge.iter().copied().zip(values.iter().copied()).collect();
        let (depth, slope) = (x.weight(&place), x.weight_slope(&place));
        for (a, n) in values.iter().enumerate() {
            let factor = p * n * weight * depth;
            result.force[2 * a] += factor * along.y;
            result.force[2 * a + 1] -= factor * along.x;
            for (b, d) in slopes.iter().enumerate() {
                result.tangent[(2 * a, 2 * b + 1)] += factor * d;
                result.tangent[(2 * a + 1, 2 * b)] -= factor * d;
            }
            for (b, (m, slope)) in values.iter().zip(slope.iter().cycle()).enumerate() {
                for (j, rate) in slope.iter().enumerate() {
                    let varied = p * n * weight * m * rate;
                    result.tangent[(2 * a, 2 * b + j)] += varied * along.y;
                    result.tangent[(2 * a + 1, 2 * b + j)] -= varied * along.x;
                }
            }
        }
    }
    result
}
