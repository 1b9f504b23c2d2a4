//! Cauchy stress at the quadrature points, and at those one order lower.
//!
//! Construction of elements from their reference geometry.

use std::sync::OnceLock;

use nalgebra::{DMatrix, DVector, Matrix2, Vector2, Vector5};

use super::ring::straining;
use super::{SolidElement, deformation_gradient};
use crate::laws::bulk::components::plane;
use crate::laws::bulk::{Answer, CauchyStress, Material, Straining, log_strain};
use crate::mesh::few::Few;
use crate::mesh::section::Section;
use crate::mesh::shape::{ElementKind, QuadraturePoint};
use crate::model::element::{ElementError, Formulation, gradients};

impl SolidElement {
    /// Cauchy stress at each quadrature point, given its internal variables there (empty for a material without any).
    ///
    /// # Errors
    /// Returns the [`MaterialFailure`](crate::laws::bulk::MaterialFailure) of the law at a quadrature point.
    pub fn stresses(
        &self,
        material: &dyn Material,
        memory: &[f64],
        u: &[Vector2<f64>],
    ) -> Answer<Few<CauchyStress, 9>> {
        let count = material.description().variables.len();
        let of = |(k, seen): (usize, &Vector5<f64>)| {
            material.cauchy_stress(&self.straining(seen, &memory[k * count..(k + 1) * count]))
        };
        self.seen(u)?.iter().enumerate().map(of).collect()
    }

    /// Input of a law that is asked what it remembers.
    fn straining<'a>(&self, seen: &Vector5<f64>, old: &'a [f64]) -> Straining<'a> {
        match self.hoop {
            Some(_) => straining(seen, 0.0, old),
            None => Straining::new(plane(seen), old),
        }
    }

    /// F at each quadrature point as the law sees it: F̄ of F-bar.
    pub(super) fn seen(&self, u: &[Vector2<f64>]) -> Answer<Few<Vector5<f64>, 9>> {
        let u = &*self.since_activation(u);
        Ok(match self.mean(u)? {
            Some(mean) => mean.seen().into(),
            None => self.everywhere().map(|(at, _)| at.deformation(u)).collect(),
        })
    }

    /// Logarithmic strain xx, yy, zz, xy at each quadrature point, as the law sees it (F̄ of F-bar); of a linear law sym F − 1.
    ///
    /// # Errors
    /// Returns the [`MaterialFailure`](crate::laws::bulk::MaterialFailure) of the law at a quadrature point.
    pub fn log_strains(&self, material: &dyn Material, memory: &[f64], u: &[Vector2<f64>]) -> Answer<Few<[f64; 4], 9>> {
        let strain = |f: &Matrix2<f64>, across: f64| match material.description().is_linear {
            true => [f.m11 - 1.0, f.m22 - 1.0, across - 1.0, 0.5 * (f.m12 + f.m21)],
            false => log_strain(f, across),
        };
        let count = material.description().variables.len();
        let of = |(k, seen): (usize, &Vector5<f64>)| {
            let across = material.stretch_across(&self.straining(seen, &memory[k * count..(k + 1) * count]))?;
            Ok(strain(&plane(seen), across))
        };
        self.seen(u)?.iter().enumerate().map(of).collect()
    }

    /// F at each quadrature point.
    pub fn deformations(&self, u: &[Vector2<f64>]) -> Vec<Matrix2<f64>> {
        let u = &*self.since_activation(u);
        self.points().map(|(gradients, _)| deformation_gradient(gradients, u)).collect()
    }

    /// F₃₃ at each quadrature point of an axisymmetric element; `None` in other sections.
    pub fn hoops(&self, u: &[Vector2<f64>]) -> Option<Vec<f64>> {
        self.hoop.is_some().then(|| self.hoop_stretches(u))
    }

    /// Shares of its quadrature points in the values at the points of the quadrature one order lower, a row for each of these: the same
    /// values where it is the lower one already, of a full one their projection on the polynomials with as many terms.
    pub fn reduced(&self) -> &'static DMatrix<f64> {
        shares(self.kind, self.formulation)
    }

    /// Returns what a material [shows](crate::laws::bulk::MaterialDescription::shown) at each quadrature point, one behind the other.
    ///
    /// # Errors
    /// Returns the [`MaterialFailure`](crate::laws::bulk::MaterialFailure) of the law at a quadrature point.
    pub fn shown(&self, material: &dyn Material, memory: &[f64], u: &[Vector2<f64>]) -> Answer<Vec<f64>> {
        let (count, own) = (material.description().variables.len(), material.description().shown.len());
        let mut values = vec![0.0; own * self.quadrature_points()];
        for ((k, seen), values) in self.seen(u)?.iter().enumerate().zip(values.chunks_exact_mut(own.max(1))) {
            material.show(&self.straining(seen, &memory[k * count..(k + 1) * count]), values)?;
        }
        Ok(values)
    }
}

/// Shares of the quadrature points in the values at the points one order lower: lower points × quadrature points.
///
/// ```text
/// Σ_q w_q (Σ_k c_k p_k(ξ_q) − s_q)² → min,   p = 1 for one point, 1, ξ, η, ξη for four
/// ```
fn shares(kind: ElementKind, formulation: Formulation) -> &'static DMatrix<f64> {
    static SHARES: [[OnceLock<DMatrix<f64>>; 5]; 3] = [const { [const { OnceLock::new() }; 5] }; 3];
    SHARES[formulation as usize][kind as usize].get_or_init(|| {
        let (full, lower) = (formulation.quadrature(kind), kind.reduced_quadrature());
        if full.len() == lower.len() {
            return DMatrix::identity(full.len(), full.len());
        }
        let terms = |[x, y]: [f64; 2]| [1.0, x, y, x * y].into_iter().take(lower.len()).collect::<Vec<_>>();
        let of = |points: &[QuadraturePoint]| {
            let all = points.iter().flat_map(|point| terms(point.at));
            DMatrix::from_row_iterator(points.len(), lower.len(), all)
        };
        let weights =
            DMatrix::from_diagonal(&DVector::from_iterator(full.len(), full.iter().map(|point| point.weight)));
        let weighted = of(&full).transpose() * weights;
        let normal =
            (&weighted * of(&full)).try_inverse().expect("the points of a Gauss rule determine its polynomials");
        of(&lower) * normal * weighted
    })
}

impl SolidElement {
    /// Creates an element of `kind` on the reference `positions` of its nodes, in a section.
    ///
    /// # Errors
    /// [`ElementError::Degenerate`] when det(∂X/∂ξ) is not positive at a quadrature point,
    /// [`ElementError::FBarNeedsQ4`] or [`ElementError::ReducedNeedsQ8`] when a formulation is asked of a kind that it is not made for.
    pub fn new(
        kind: ElementKind,
        formulation: Formulation,
        section: Section,
        positions: &[Vector2<f64>],
    ) -> Result<Self, ElementError> {
        debug_assert_eq!(positions.len(), kind.nodes());
        formulation.check(kind)?;
        let mut element = Self {
            kind,
            formulation,
            gradients: Vec::new(),
            volumes: Vec::new(),
            mean_weight: 1.0,
            hoop: section.is_axisymmetric().then(Vec::new),
            initial: Vec::new(),
            activation: Vec::new(),
        };
        let over_radius = |at: [f64; 2]| {
            let values = kind.values(at);
            let radius: f64 = positions.iter().zip(&values).map(|(x, n)| x.x * n).sum();
            values.into_iter().map(move |n| n / radius).collect::<Vec<_>>()
        };
        let mut area = 0.0;
        for point in formulation.quadrature(kind) {
            let (gradients, jacobian) = gradients(kind, point.at, positions)?;
            element.gradients.extend(gradients);
            let place = positions.iter().zip(kind.values(point.at)).map(|(x, n)| x * n).sum();
            element.volumes.push(point.weight * jacobian * section.weight(place));
            area += point.weight * jacobian;
            if let Some(hoop) = &mut element.hoop {
                hoop.extend(over_radius(point.at));
            }
        }
        element.mean_weight = element.volume() / area;
        Ok(element)
    }

    /// Returns how the element is integrated.
    pub fn formulation(&self) -> Formulation {
        self.formulation
    }

    /// Whether it has its mean volume change everywhere (F-bar).
    pub fn is_f_bar(&self) -> bool {
        self.formulation == Formulation::FBar
    }

    /// Returns the quadrature points of the element.
    pub fn quadrature(&self) -> Vec<QuadraturePoint> {
        self.formulation.quadrature(self.kind)
    }

    /// Kind of the element.
    pub fn kind(&self) -> ElementKind {
        self.kind
    }

    /// Mean depth of the section over the element [-]
    pub fn mean_weight(&self) -> f64 {
        self.mean_weight
    }

    /// Reference area in the plane [L²]
    pub fn area(&self) -> f64 {
        self.volume() / self.mean_weight
    }

    /// Reference volume: area times the mean depth of the section [L²]
    pub fn volume(&self) -> f64 {
        self.volumes.iter().sum()
    }

    /// Reference volume of each quadrature point [L²]
    pub fn point_volumes(&self) -> &[f64] {
        &self.volumes
    }

    /// Number of quadrature points.
    pub fn quadrature_points(&self) -> usize {
        self.volumes.len()
    }
}
