//! Cauchy stress at the quadrature points and at the nodes.
//!
//! Construction of elements from their reference geometry.

use std::sync::OnceLock;

use nalgebra::{DMatrix, Matrix2, Vector2};

use super::ring::Hoop;
use super::{SolidElement, deformation_gradient};
use crate::laws::bulk::{CauchyStress, Material, MaterialFailure};
use crate::mesh::few::Few;
use crate::mesh::section::Section;
use crate::mesh::shape::ElementKind;
use crate::model::element::{ElementError, gradients};

impl SolidElement {
    /// Cauchy stress at each quadrature point, given its internal variables there (empty for a material without any).
    ///
    /// # Errors
    /// Returns the [`MaterialFailure`] of the law at a quadrature point.
    pub fn stresses(
        &self,
        material: &dyn Material,
        memory: &[f64],
        u: &[Vector2<f64>],
    ) -> Result<Few<CauchyStress, 9>, MaterialFailure> {
        if self.hoop.is_some() {
            return self.ring_stresses(material, memory, u);
        }
        let (centre, count) = (self.centre(u)?, material.variables().len());
        self.points()
            .enumerate()
            .map(|(k, (gradients, _))| {
                let deformation = deformation_gradient(gradients, u);
                let seen = match &centre {
                    Some(centre) => centre.stretch(&deformation)? * deformation,
                    None => deformation,
                };
                material.cauchy_stress(&seen, &memory[k * count..(k + 1) * count])
            })
            .collect()
    }

    /// F at each quadrature point.
    pub fn deformations(&self, u: &[Vector2<f64>]) -> Vec<Matrix2<f64>> {
        self.points().map(|(gradients, _)| deformation_gradient(gradients, u)).collect()
    }

    /// F₃₃ at each quadrature point of an axisymmetric element; `None` in other sections.
    pub fn hoops(&self, u: &[Vector2<f64>]) -> Option<Vec<f64>> {
        self.hoop.is_some().then(|| self.hoop_stretches(u))
    }

    /// The (bi)linear least-squares fit of values at the quadrature points, at the reference coordinates `at`.
    pub fn fitted<const N: usize>(&self, values: &[[f64; N]], at: [f64; 2]) -> [f64; N] {
        let fit = corner_fit(self.kind);
        let corners = linear(self.kind).values(at);
        let weight = |point: usize| corners.iter().enumerate().map(|(a, n)| n * fit[(a, point)]).sum::<f64>();
        let mut sum = [0.0; N];
        for (point, values) in values.iter().enumerate() {
            let weight = weight(point);
            sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * value);
        }
        sum
    }

    /// Cauchy stress at each node: the (bi)linear least-squares fit of the stresses at the quadrature points.
    ///
    /// # Errors
    /// Returns the [`MaterialFailure`] of the law at a quadrature point.
    pub fn nodal_stresses(
        &self,
        material: &dyn Material,
        memory: &[f64],
        u: &[Vector2<f64>],
    ) -> Result<Few<CauchyStress, 9>, MaterialFailure> {
        let stresses = self.stresses(material, memory, u)?;
        let fit = corner_fit(self.kind);
        let mut corners = [[0.0; 4]; 4];
        for (a, corner) in corners.iter_mut().enumerate().take(fit.nrows()) {
            for (point, &CauchyStress { xx, yy, zz, xy }) in stresses.iter().enumerate() {
                let weight = fit[(a, point)];
                corner.iter_mut().zip([xx, yy, zz, xy]).for_each(|(sum, stress)| *sum += weight * stress);
            }
        }
        let at = |values: &[usize]| {
            let mean =
                |component: usize| values.iter().map(|&a| corners[a][component]).sum::<f64>() / values.len() as f64;
            CauchyStress { xx: mean(0), yy: mean(1), zz: mean(2), xy: mean(3) }
        };
        let n = self.kind.corners();
        let node = |a: usize| match a {
            8 => at(&[0, 1, 2, 3]),
            a if a < n => at(&[a]),
            a => at(&self.kind.edge(a - n).0),
        };
        Ok((0..self.kind.nodes()).map(node).collect())
    }
}

/// Corner values of the (bi)linear least-squares fit of values at the quadrature points: corners × points.
fn corner_fit(kind: ElementKind) -> &'static DMatrix<f64> {
    static FITS: [OnceLock<DMatrix<f64>>; 5] = [const { OnceLock::new() }; 5];
    FITS[kind as usize].get_or_init(|| {
        let points = kind.quadrature();
        let values = points.iter().flat_map(|point| linear(kind).values(point.at));
        let interpolation = DMatrix::from_row_iterator(points.len(), kind.corners(), values);
        interpolation.pseudo_inverse(1e-9).expect("1e-9 is not negative")
    })
}

/// The element kind with the same corners, and no other nodes.
fn linear(kind: ElementKind) -> ElementKind {
    if kind.corners() == 3 { ElementKind::T3 } else { ElementKind::Q4 }
}

impl SolidElement {
    /// Creates an element of `kind` on the reference `positions` of its nodes, in a section.
    ///
    /// # Errors
    /// Returns [`ElementError::Degenerate`] if det(∂X/∂ξ) is not positive at a quadrature point,
    /// [`ElementError::FBarNeedsQ4`] if F-bar is requested for another kind.
    pub fn new(
        kind: ElementKind,
        f_bar: bool,
        section: Section,
        positions: &[Vector2<f64>],
    ) -> Result<Self, ElementError> {
        debug_assert_eq!(positions.len(), kind.nodes());
        if f_bar && kind != ElementKind::Q4 {
            return Err(ElementError::FBarNeedsQ4 { kind });
        }
        let mut element = Self {
            kind,
            gradients: Vec::new(),
            volumes: Vec::new(),
            mean_weight: 1.0,
            centre: None,
            hoop: section.is_axisymmetric().then(|| Hoop { values: Vec::new(), centre: Vec::new() }),
        };
        let over_radius = |at: [f64; 2]| {
            let values = kind.values(at);
            let radius: f64 = positions.iter().zip(&values).map(|(x, n)| x.x * n).sum();
            values.into_iter().map(move |n| n / radius).collect::<Vec<_>>()
        };
        let mut area = 0.0;
        for point in kind.quadrature() {
            let (gradients, jacobian) = gradients(kind, point.at, positions)?;
            element.gradients.extend(gradients);
            let place = positions.iter().zip(kind.values(point.at)).map(|(x, n)| x * n).sum();
            element.volumes.push(point.weight * jacobian * section.weight(place));
            area += point.weight * jacobian;
            if let Some(hoop) = &mut element.hoop {
                hoop.values.extend(over_radius(point.at));
            }
        }
        element.mean_weight = element.volume() / area;
        if f_bar {
            element.centre = Some(gradients(kind, kind.centre(), positions)?.0);
            if let Some(hoop) = &mut element.hoop {
                hoop.centre = over_radius(kind.centre());
            }
        }
        Ok(element)
    }

    /// Whether it has the volume change of its centre everywhere (F-bar).
    pub fn is_f_bar(&self) -> bool {
        self.centre.is_some()
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
