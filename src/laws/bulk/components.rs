//! Tensors of bodies that are not sheared out of plane: F and P have five components each, (11, 21, 12, 22, 33).

use nalgebra::{Matrix2, Matrix4, Matrix5, Vector4, Vector5};

use super::{Answer, MaterialFailure, Straining};

/// The five components of a tensor, from its part in plane and 33.
#[inline(always)]
pub(crate) fn components(plane: &Matrix2<f64>, across: f64) -> Vector5<f64> {
    Vector5::new(plane.m11, plane.m21, plane.m12, plane.m22, across)
}

/// The part in plane.
#[inline(always)]
pub(crate) fn plane(tensor: &Vector5<f64>) -> Matrix2<f64> {
    Matrix2::new(tensor[0], tensor[2], tensor[1], tensor[3])
}

/// The moduli of five components, from those in plane, ∂P/∂F₃₃, ∂P₃₃/∂F and ∂P₃₃/∂F₃₃. Written out: what is not asked for is not formed.
#[inline(always)]
#[rustfmt::skip]
pub(super) fn moduli(plane: &Matrix4<f64>, by_across: &Vector4<f64>, across: &Vector4<f64>, stiffness: f64) -> Matrix5<f64> {
    let (p, b, a) = (plane, by_across, across);
    Matrix5::new(
        p.m11, p.m12, p.m13, p.m14, b.x,
        p.m21, p.m22, p.m23, p.m24, b.y,
        p.m31, p.m32, p.m33, p.m34, b.z,
        p.m41, p.m42, p.m43, p.m44, b.w,
        a.x, a.y, a.z, a.w, stiffness,
    )
}

/// The moduli in plane.
#[inline(always)]
#[rustfmt::skip]
pub(super) fn plane_moduli(moduli: &Matrix5<f64>) -> Matrix4<f64> {
    let m = moduli;
    Matrix4::new(
        m.m11, m.m12, m.m13, m.m14,
        m.m21, m.m22, m.m23, m.m24,
        m.m31, m.m32, m.m33, m.m34,
        m.m41, m.m42, m.m43, m.m44,
    )
}

/// ln h, without losing digits near 1.
#[inline(always)]
pub(super) fn ln_stretch(h: f64) -> f64 {
    match h {
        // Known where the law is compiled for plane strain
        1.0 => 0.0,
        h if (h - 1.0).abs() < 0.5 => (h - 1.0).ln_1p(),
        h => h.ln(),
    }
}

/// F₃₃, known to be positive and finite.
#[inline(always)]
pub(super) fn positive_stretch(straining: &Straining) -> Answer<f64> {
    let h = straining.stretch;
    let jacobian = h * straining.deformation.determinant();
    if h > 0.0 && h.is_finite() { Ok(h) } else { Err(MaterialFailure::Inverted { jacobian }) }
}
