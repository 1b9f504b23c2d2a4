//! From F to principal trial strains, and from what a law answers there back to P, ∂P/∂F and C_p⁻¹: (1), (3) and (6) of
//! [`Elastoplastic`](super::Elastoplastic).

use nalgebra::{Matrix2, Matrix4, Matrix5, Vector3, Vector4, Vector5};

use super::{Returned, series};
use crate::laws::bulk::components::moduli;
use crate::laws::bulk::{Answer, MaterialFailure};

/// The axes of b = F C_p⁻¹ Fᵀ, two in plane and one across it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Axes {
    deformation: Matrix2<f64>,
    stretch: f64,
    /// F⁻¹
    inverse: Matrix2<f64>,
    /// Q: the axes in plane, in columns
    turn: Matrix2<f64>,
    /// F⁻¹ Q
    pulled_back: Matrix2<f64>,
    /// Rᵀ Q: the axes before the rotation R of F = R U
    unrotated: Matrix2<f64>,
    /// b₁, b₂, b₃, b₁ being the greater
    squares: Vector3<f64>,
    /// ε_i = ½ ln b_i
    pub strains: Vector3<f64>,
}

impl Axes {
    /// The trial state of F, F₃₃ and C_p⁻¹ − 1 (xx, yy, xy, zz). b − 1 is formed from F − 1, so that small strains lose no digits.
    #[inline(always)]
    pub fn of(deformation: &Matrix2<f64>, stretch: f64, state: &[f64; 4]) -> Answer<Self> {
        let f = deformation;
        let (d, c) = (f - Matrix2::identity(), Matrix2::new(state[0], state[2], state[2], state[1]));
        let b = d + d.transpose() + d * d.transpose() + f * c * f.transpose();
        let (mean, half, off) = (0.5 * (b.m11 + b.m22), 0.5 * (b.m11 - b.m22), b.m12);
        let radius = radius(half, off);
        let across = (stretch - 1.0) * (stretch + 1.0) + stretch * stretch * state[3];
        let less_one = Vector3::new(mean + radius, mean - radius, across);
        let squares = less_one.add_scalar(1.0);
        if !(squares.min() > 0.0 && squares.max().is_finite()) {
            return Err(MaterialFailure::Inverted { jacobian: squares.min().min(0.0) });
        }
        let turn = principal_turn(half, off, radius);
        let inverse = Matrix2::new(f.m22, -f.m12, -f.m21, f.m11) * (1.0 / f.determinant());
        let strains = 0.5 * Vector3::from(series::ln_1p(less_one.into()));
        let unrotated = rotation(f).transpose() * turn;
        Ok(Self { deformation: *f, stretch, inverse, turn, pulled_back: inverse * turn, unrotated, squares, strains })
    }

    /// An unrotated tensor (xx, yy, zz, xy) in the axes.
    #[inline(always)]
    pub fn entered(&self, tensor: &Vector4<f64>) -> Vector4<f64> {
        turned(&self.unrotated.transpose(), tensor)
    }

    /// A tensor in the axes, unrotated.
    #[inline(always)]
    pub fn left(&self, tensor: &Vector4<f64>) -> Vector4<f64> {
        turned(&self.unrotated, tensor)
    }

    /// C_p⁻¹ − 1 after a plastic strain; unchanged bits without one.
    ///
    /// ```text
    /// C_p⁻¹ ← C_p⁻¹ + F⁻¹ (exp(2 ε_e) − b) F⁻ᵀ,   ε_e = ε − Δε_p
    /// ```
    #[inline(always)]
    pub fn flow(&self, plastic: &Vector4<f64>, stretch: f64, state: &mut [f64; 4]) {
        if plastic.iter().all(|part| *part == 0.0) {
            return;
        }
        let (e, b) = (&self.strains, &self.squares);
        let shrunk =
            b.component_mul(&Vector3::from(series::exp_m1([-2.0 * plastic[0], -2.0 * plastic[1], -2.0 * plastic[2]])));
        let less = match plastic[3] == 0.0 {
            true => Matrix2::new(shrunk.x, 0.0, 0.0, shrunk.y),
            false => {
                let strain = Vector4::new(e.x, e.y, e.z, 0.0) - plastic;
                let [xx, yy, _, xy] = exponential_less_one(&(2.0 * strain)).into();
                Matrix2::new(xx - (b.x - 1.0), xy, xy, yy - (b.y - 1.0))
            }
        };
        let change = self.pulled_back * less * self.pulled_back.transpose();
        state[0] += change.m11;
        state[1] += change.m22;
        state[2] += 0.5 * (change.m12 + change.m21);
        state[3] += shrunk.z / (stretch * stretch);
    }

    /// q_a ⊗ F⁻¹q_b of two axes, as components 11, 21, 12, 22.
    #[inline(always)]
    fn dyad(&self, a: usize, b: usize) -> Vector4<f64> {
        let (q, g) = (self.turn.column(a), self.pulled_back.column(b));
        Vector4::new(q[0] * g[0], q[1] * g[0], q[0] * g[1], q[1] * g[1])
    }

    /// A: what the stresses 11, 22, 12 in the axes make of P = A τ in plane.
    #[inline(always)]
    fn of_stress(&self) -> [Vector4<f64>; 3] {
        [self.dyad(0, 0), self.dyad(1, 1), self.dyad(0, 1) + self.dyad(1, 0)]
    }

    /// B: what dF makes of the strains 11, 22, 12 in the axes, dε = Bᵀ dF, see (6).
    #[inline(always)]
    fn of_strain(&self) -> [Vector4<f64>; 3] {
        let [by_12, by_21] = self.shear_of_gradient();
        [self.dyad(0, 0), self.dyad(1, 1), by_12 * self.dyad(0, 1) + by_21 * self.dyad(1, 0)]
    }

    /// P of a stress in the axes.
    #[inline(always)]
    pub fn first_piola_kirchhoff(&self, stress: &Vector4<f64>) -> Vector5<f64> {
        let p = combined(&self.of_stress(), [stress[0], stress[1], stress[3]]);
        Vector5::new(p[0], p[1], p[2], p[3], stress[2] / self.stretch)
    }

    /// ∂P/∂F of a stress and tangent in the axes, see (6); with the spin of tensors of the history.
    #[inline(always)]
    pub fn moduli(&self, found: &Returned, spins: bool) -> Matrix5<f64> {
        let d = &found.tangent;
        let inverse = 1.0 / self.stretch;
        let by_across = inverse * combined(&self.of_stress(), [d[(0, 2)], d[(1, 2)], d[(3, 2)]]);
        let mut across = inverse * combined(&self.of_strain(), [d[(2, 0)], d[(2, 1)], d[(2, 3)]]);
        if spins {
            across -= inverse * (self.strains.x - self.strains.y) * d[(2, 3)] * spin(&self.deformation);
        }
        let stiffness = inverse * inverse * (d[(2, 2)] - found.stress[2]);
        moduli(&self.moduli_in_plane(found, spins), &by_across, &across, stiffness)
    }

    /// The part of these moduli in plane:
    ///
    /// ```text
    /// ∂P_iJ/∂F_kL = (A D Bᵀ)_iJkL − P_iL F⁻¹_Jk
    /// ```
    #[inline(always)]
    fn moduli_in_plane(&self, found: &Returned, spins: bool) -> Matrix4<f64> {
        let (d, of_stress, of_strain) = (&found.tangent, self.of_stress(), self.of_strain());
        let by_strain = |column: usize| combined(&of_stress, [d[(0, column)], d[(1, column)], d[(3, column)]]);
        let stiff = [by_strain(0), by_strain(1), by_strain(3)];
        let (p, g) = (self.first_piola_kirchhoff(&found.stress), &self.inverse);
        let column = |k: usize, l: usize| {
            let (along, across) = (p.fixed_rows::<2>(2 * l), g.column(k));
            let geometric =
                Vector4::new(along[0] * across[0], along[1] * across[0], along[0] * across[1], along[1] * across[1]);
            let [a, b, c] = &of_strain;
            combined(&stiff, [a[k + 2 * l], b[k + 2 * l], c[k + 2 * l]]) - geometric
        };
        let mut tangent = Matrix4::from_columns(&[column(0, 0), column(1, 0), column(0, 1), column(1, 1)]);
        if spins {
            let way = self.strains.y - self.strains.x;
            let [along, shear] = [found.stress[0] - found.stress[1], 2.0 * found.stress[3]];
            let follow = [way * d[(0, 3)] - shear, way * d[(1, 3)] + shear, way * d[(3, 3)] + along];
            tangent += combined(&of_stress, follow) * spin(&self.deformation).transpose();
        }
        tangent
    }

    /// ∂ε₁₂/∂l₁₂ and ∂ε₁₂/∂l₂₁: (ε₁ − ε₂)/(b₁ − b₂) times b₂ and b₁, ½ where the strains are equal.
    ///
    /// ```text
    /// ½ x/(eˣ − 1)   and   ½ x/(1 − e⁻ˣ) = ½ x/(eˣ − 1) + ½ x,   x = 2 (ε₁ − ε₂) ≥ 0
    /// ```
    #[inline(always)]
    fn shear_of_gradient(&self) -> [f64; 2] {
        let twice = 2.0 * (self.strains.x - self.strains.y);
        let lesser = 0.5 * series::over_exp_m1(twice);
        [lesser, lesser + 0.5 * twice]
    }
}

/// Σ of some vectors times their parts.
#[inline(always)]
fn combined(vectors: &[Vector4<f64>; 3], parts: [f64; 3]) -> Vector4<f64> {
    parts[0] * vectors[0] + parts[1] * vectors[1] + parts[2] * vectors[2]
}

/// √(a² + b²) of numbers whose squares do not overflow
#[inline(always)]
fn radius(a: f64, b: f64) -> f64 {
    (a * a + b * b).sqrt()
}

/// The axes of a symmetric tensor: of half the difference of its diagonal, its shear, and the radius of both.
#[inline(always)]
fn principal_turn(half: f64, off: f64, radius: f64) -> Matrix2<f64> {
    // Squares of smaller numbers lose their digits.
    if radius < 1e-150 {
        return Matrix2::identity();
    }
    // The parts of an axis, first the one that is not small
    let (large, small) = (half.abs() + radius, off);
    let (c, s) = if half >= 0.0 { (large, small) } else { (small, large) };
    Matrix2::new(c, -s, s, c) * (1.0 / (large * large + small * small).sqrt())
}

/// exp(A) − 1 of a symmetric tensor (11, 22, 33, 12).
pub(super) fn exponential_less_one(a: &Vector4<f64>) -> Vector4<f64> {
    let (mean, half, off) = (0.5 * (a[0] + a[1]), 0.5 * (a[0] - a[1]), a[3]);
    let radius = radius(half, off);
    let [high, low] = [(mean + radius).exp_m1(), (mean - radius).exp_m1()];
    let (middle, slope) = (0.5 * (high + low), if radius > 0.0 { 0.5 * (high - low) / radius } else { 0.0 });
    Vector4::new(middle + slope * half, middle - slope * half, a[2].exp_m1(), slope * off)
}

/// M A Mᵀ of a tensor (xx, yy, zz, xy).
#[inline(always)]
fn turned(m: &Matrix2<f64>, tensor: &Vector4<f64>) -> Vector4<f64> {
    let a = m * Matrix2::new(tensor[0], tensor[3], tensor[3], tensor[1]) * m.transpose();
    Vector4::new(a.m11, a.m22, tensor[2], 0.5 * (a.m12 + a.m21))
}

/// R of F = R U.
#[inline(always)]
fn rotation(f: &Matrix2<f64>) -> Matrix2<f64> {
    let (along, around) = (f.m11 + f.m22, f.m21 - f.m12);
    let size = radius(along, around);
    Matrix2::new(along, -around, around, along) * (1.0 / size)
}

/// ∂θ/∂F of the angle of R.
fn spin(f: &Matrix2<f64>) -> Vector4<f64> {
    let (along, around) = (f.m11 + f.m22, f.m21 - f.m12);
    Vector4::new(-around, along, -along, -around) / (along * along + around * around)
}
