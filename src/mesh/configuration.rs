//! The current configuration x = X + u.

use nalgebra::Vector2;

use super::section::Section;

/// Current nodal positions, kept as X and u.
///
/// Differences and combinations are taken of X and of u separately before they are added. The round-off of x itself, ε|X|,
/// would appear in the residual as noise amplified by a stiff contact penalty; that of u is smaller by |u|/|X|.
#[derive(Clone, Copy, Debug)]
pub struct Configuration<'a> {
    reference: &'a [Vector2<f64>],
    /// Two dofs per node; `None` for u = 0
    displacement: Option<&'a [f64]>,
    section: Section,
}

impl<'a> Configuration<'a> {
    /// Creates the configuration of positions X displaced by u, two dofs per node, in plane strain.
    pub fn new(reference: &'a [Vector2<f64>], displacement: &'a [f64]) -> Self {
        Self { reference, displacement: Some(displacement), section: Section::PlaneStrain }
    }

    /// Creates the reference configuration, u = 0, in plane strain.
    pub fn undeformed(reference: &'a [Vector2<f64>]) -> Self {
        Self { reference, displacement: None, section: Section::PlaneStrain }
    }

    /// Returns the configuration in another section.
    pub fn within(self, section: Section) -> Self {
        Self { section, ..self }
    }

    /// Returns the section.
    pub fn section(&self) -> Section {
        self.section
    }

    /// w at a point whose weights sum to one.
    pub fn weight(&self, point: &[(usize, f64)]) -> f64 {
        match self.section {
            Section::PlaneStrain => 1.0,
            section => section.weight(self.place(point)),
        }
    }

    /// ∂w/∂x at a point; `None` where w is constant [1/L].
    pub fn weight_slope(&self, point: &[(usize, f64)]) -> Option<Vector2<f64>> {
        match self.section {
            Section::PlaneStrain => None,
            section => section.slope(self.place(point)),
        }
    }

    /// x of a point whose weights sum to one.
    fn place(&self, point: &[(usize, f64)]) -> Vector2<f64> {
        point.iter().map(|&(node, w)| self.at(node) * w).sum()
    }

    /// x of a node.
    pub fn at(&self, node: usize) -> Vector2<f64> {
        self.reference[node] + self.displacement(node)
    }

    /// X of a node.
    pub fn reference(&self, node: usize) -> Vector2<f64> {
        self.reference[node]
    }

    /// u of a node.
    pub fn displacement(&self, node: usize) -> Vector2<f64> {
        self.displacement.map_or_else(Vector2::zeros, |u| vector(u, node))
    }

    /// x_to − x_from.
    pub fn between(&self, from: usize, to: usize) -> Vector2<f64> {
        (self.reference[to] - self.reference[from]) + (self.displacement(to) - self.displacement(from))
    }

    /// Angle of rotation of the line between two nodes since the reference configuration [rad].
    pub fn turn(&self, from: usize, to: usize) -> f64 {
        let (was, is) = (self.reference[to] - self.reference[from], self.between(from, to));
        was.perp(&is).atan2(was.dot(&is))
    }

    /// Relative elongation of the line between two nodes [-].
    pub fn stretch(&self, from: usize, to: usize) -> f64 {
        self.between(from, to).norm() / (self.reference[to] - self.reference[from]).norm() - 1.0
    }

    /// Displacement of a node since another configuration.
    pub fn since(&self, before: &Self, node: usize) -> Vector2<f64> {
        self.displacement(node) - before.displacement(node)
    }

    /// Σ w_a x_a for weights that sum to zero, such as those of a direction; independent of the origin.
    pub fn combine(&self, weights: &[(usize, f64)]) -> Vector2<f64> {
        let Some(&(first, _)) = weights.first() else { return Vector2::zeros() };
        weights.iter().map(|&(node, w)| self.between(first, node) * w).sum()
    }

    /// X − origin and u of a point whose weights sum to one.
    pub fn split(&self, weights: &[(usize, f64)], origin: Vector2<f64>) -> [Vector2<f64>; 2] {
        let sum = |of: &dyn Fn(usize) -> Vector2<f64>| weights.iter().map(|&(node, w)| of(node) * w).sum();
        [sum(&|node| self.reference[node] - origin), sum(&|node| self.displacement(node))]
    }
}

/// Vector of a node in a nodal array with two numbers per node.
#[inline(always)]
pub fn vector(values: &[f64], node: usize) -> Vector2<f64> {
    Vector2::new(values[2 * node], values[2 * node + 1])
}
