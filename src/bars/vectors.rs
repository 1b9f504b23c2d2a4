//! Vectors that are linear in the displacements of some nodes, and forces that depend on one or two of them.
//!
//! ```text
//! e_i = E_i + Σ_a c_ia u_a
//! f_a = Σ_i c_ia ∂E/∂e_i,    K_ab = Σ_ij c_ia c_jb ∂²E/∂e_i∂e_j
//! ```

use nalgebra::{Matrix2, Vector2};

use crate::mesh::configuration::vector;

/// A point that moves with nodes: one node, or those of an element of a body. Weights sum to one.
#[derive(Clone, Debug, PartialEq)]
pub struct Vertex {
    /// X [L]
    pub at: Vector2<f64>,
    /// nodes
    pub nodes: Vec<usize>,
    /// their weights [-]
    pub weights: Vec<f64>,
}

impl Vertex {
    /// A node.
    pub fn node(node: usize, at: Vector2<f64>) -> Self {
        Self { at, nodes: vec![node], weights: vec![1.0] }
    }

    /// Nodes with their weights.
    pub fn terms(&self) -> impl Iterator<Item = (usize, f64)> {
        self.nodes.iter().copied().zip(self.weights.iter().copied())
    }

    /// Displacement [L].
    pub fn displacement(&self, u: &[f64]) -> Vector2<f64> {
        self.terms().map(|(node, weight)| vector(u, node) * weight).sum()
    }
}

/// One vector: its value without displacements, and the coefficients of nodes.
#[derive(Clone, Debug, PartialEq)]
pub struct Linear {
    /// E [L]
    pub at: Vector2<f64>,
    /// c of nodes [-]
    pub terms: Vec<(usize, f64)>,
}

impl Linear {
    /// From one vertex to another.
    pub fn between(from: &Vertex, to: &Vertex) -> Self {
        let terms = to.terms().chain(from.terms().map(|(node, weight)| (node, -weight)));
        Self { at: to.at - from.at, terms: terms.collect() }
    }

    /// From a point of a body to a vertex at the same place.
    pub fn bonded(from: &Vertex, to: &Vertex) -> Self {
        Self { at: Vector2::zeros(), ..Self::between(from, to) }
    }

    /// A direction in space.
    pub fn fixed(at: Vector2<f64>) -> Self {
        Self { at, terms: Vec::new() }
    }
}

/// Two vectors on common nodes.
#[derive(Clone, Debug, PartialEq)]
pub struct Vectors {
    nodes: Vec<usize>,
    shares: Vec<[f64; 2]>,
    /// E of both [L]
    pub at: [Vector2<f64>; 2],
}

/// First derivatives of a measure by two vectors, and the second ones by each.
pub type Measure = ([Vector2<f64>; 2], [Matrix2<f64>; 2]);

/// Derivatives of an energy by two vectors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answer {
    /// ∂E/∂e_i [F]
    pub forces: [Vector2<f64>; 2],
    /// ∂²E/∂e_i∂e_j [F/L]
    pub rates: [[Matrix2<f64>; 2]; 2],
}

impl Vectors {
    /// Joins the nodes of two vectors.
    pub fn new(both: [&Linear; 2]) -> Self {
        let mut nodes: Vec<usize> = both.iter().flat_map(|of| of.terms.iter().map(|(node, _)| *node)).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let share = |node: usize, of: &Linear| of.terms.iter().filter(|(own, _)| *own == node).map(|(_, c)| c).sum();
        let shares = nodes.iter().map(|&node| both.map(|of| share(node, of))).collect();
        Self { nodes, shares, at: both.map(|of| of.at) }
    }

    /// One vector alone.
    pub fn one(of: &Linear) -> Self {
        Self::new([of, &Linear::fixed(Vector2::zeros())])
    }

    /// Nodes, ascending.
    pub fn nodes(&self) -> &[usize] {
        &self.nodes
    }

    /// Nodes with their coefficients in both.
    pub fn terms(&self) -> impl Iterator<Item = (usize, [f64; 2])> {
        self.nodes.iter().copied().zip(self.shares.iter().copied())
    }

    /// e − E of both [L].
    pub fn ways(&self, u: &[f64]) -> [Vector2<f64>; 2] {
        let mut ways = [Vector2::zeros(); 2];
        for (node, shares) in self.terms() {
            let u = vector(u, node);
            ways.iter_mut().zip(shares).for_each(|(way, share)| *way += u * share);
        }
        ways
    }

    /// Forces on the nodes, two numbers each.
    pub fn forces(&self, answer: &Answer, forces: &mut Vec<f64>) {
        forces.clear();
        for [first, second] in &self.shares {
            let force = answer.forces[0] * *first + answer.forces[1] * *second;
            forces.extend([force.x, force.y]);
        }
    }

    /// Tangent of the nodes, column by column.
    pub fn tangent(&self, answer: &Answer, tangent: &mut Vec<f64>) {
        tangent.clear();
        for column in &self.shares {
            for j in 0..2 {
                for row in &self.shares {
                    for i in 0..2 {
                        let part = |a: usize, b: usize| row[a] * column[b] * answer.rates[a][b][(i, j)];
                        tangent.push(part(0, 0) + part(0, 1) + part(1, 0) + part(1, 1));
                    }
                }
            }
        }
    }
}

impl Answer {
    /// Forces of a dashpot of a coefficient c along a measure of both vectors, at their rates ė: with the derivatives by the vectors, and with
    /// those by ė. Of the measure come the first derivatives, and the second ones by each vector.
    ///
    /// ```text
    /// f_i = c s_i ṡ,   ṡ = Σ_k s_k·ė_k          ∂f_i/∂e_j = c (δ_ij S_i ṡ + s_i ⊗ S_j ė_j),   ∂f_i/∂ė_j = c s_i ⊗ s_j
    /// ```
    pub fn viscous(c: f64, (slopes, curvatures): Measure, rates: [Vector2<f64>; 2]) -> [Self; 2] {
        let rate = slopes[0].dot(&rates[0]) + slopes[1].dot(&rates[1]);
        let forces = slopes.map(|slope| slope * (c * rate));
        let turns = [0, 1].map(|j| curvatures[j] * rates[j]);
        let all = |of: &dyn Fn(usize, usize) -> Matrix2<f64>| [[of(0, 0), of(0, 1)], [of(1, 0), of(1, 1)]];
        let by_place = |i: usize, j: usize| {
            let across = slopes[i] * turns[j].transpose() * c;
            if i == j { across + curvatures[i] * (c * rate) } else { across }
        };
        let by_rate = |i: usize, j: usize| slopes[i] * slopes[j].transpose() * c;
        [Self { forces, rates: all(&by_place) }, Self { forces, rates: all(&by_rate) }]
    }

    /// An energy of the first vector alone.
    pub fn of_first(force: Vector2<f64>, rates: Matrix2<f64>) -> Self {
        let none = Matrix2::zeros();
        Self { forces: [force, Vector2::zeros()], rates: [[rates, none], [none, none]] }
    }
}

/// The vector turned by +90°.
pub fn turned(e: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-e.y, e.x)
}

/// Second derivatives of the angle of a vector, whose first ones are J e/|e|² [1/L²].
pub fn bending_of_angle(e: Vector2<f64>) -> Matrix2<f64> {
    let square = e.norm_squared();
    let (twice, across) = (2.0 * e.x * e.y, e.y * e.y - e.x * e.x);
    Matrix2::new(twice, across, across, -twice) / (square * square)
}
