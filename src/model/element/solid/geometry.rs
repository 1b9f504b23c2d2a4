//! What the reference geometry of an element says.

use nalgebra::Vector2;

use super::SolidElement;
use super::ring::Hoop;
use crate::mesh::section::Section;
use crate::mesh::shape::ElementKind;
use crate::model::element::{ElementError, gradients};

impl SolidElement {
    /// The element of `kind` on the reference `positions` of its nodes, in a section.
    ///
    /// # Errors
    /// [`ElementError::Degenerate`] when det(∂X/∂ξ) is not positive at a quadrature point,
    /// [`ElementError::FBarNeedsQ4`] when F-bar is asked of another kind.
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

    /// Whether it has the volume change of its centre everywhere.
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
