//! Cauchy stress at the quadrature points and at the nodes.

use std::sync::OnceLock;

use nalgebra::{DMatrix, Vector2};

use super::{SolidElement, deformation_gradient};
use crate::laws::bulk::{CauchyStress, InvertedElement, Material};
use crate::mesh::shape::ElementKind;

impl SolidElement {
    /// Cauchy stress at each quadrature point, with what the material remembers there; nothing if it has no memory.
    ///
    /// # Errors
    /// [`InvertedElement`] when the material is turned inside out at a quadrature point.
    pub fn stresses(
        &self,
        material: &dyn Material,
        memory: &[f64],
        u: &[Vector2<f64>],
    ) -> Result<Vec<CauchyStress>, InvertedElement> {
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

    /// Cauchy stress at each node: the (bi)linear function nearest to the stresses at the quadrature points.
    ///
    /// # Errors
    /// [`InvertedElement`] when the material is turned inside out at a quadrature point.
    pub fn nodal_stresses(
        &self,
        material: &dyn Material,
        memory: &[f64],
        u: &[Vector2<f64>],
    ) -> Result<Vec<CauchyStress>, InvertedElement> {
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
        let mut nodal: Vec<_> = (0..n).map(|a| at(&[a])).collect();
        if self.kind.nodes() > n {
            nodal.extend((0..n).map(|edge| at(&self.kind.edge(edge).0)));
        }
        if self.kind == ElementKind::Q9 {
            nodal.push(at(&[0, 1, 2, 3]));
        }
        Ok(nodal)
    }
}

/// Corner values of the (bi)linear function that fits values at the quadrature points best: corners × points.
fn corner_fit(kind: ElementKind) -> &'static DMatrix<f64> {
    static FITS: [OnceLock<DMatrix<f64>>; 5] = [const { OnceLock::new() }; 5];
    FITS[kind as usize].get_or_init(|| {
        let linear = if kind.corners() == 3 { ElementKind::T3 } else { ElementKind::Q4 };
        let points = kind.quadrature();
        let values = points.iter().flat_map(|point| linear.values(point.at));
        let interpolation = DMatrix::from_row_iterator(points.len(), kind.corners(), values);
        interpolation.pseudo_inverse(1e-9).expect("1e-9 is not negative")
    })
}
