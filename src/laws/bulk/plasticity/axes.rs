//! From F to principal trial strains, and from what a law answers there back to P, ∂P/∂F and C_p⁻¹: (1), (3) and (6) of
//! [`Elastoplastic`](super::Elastoplastic).

use nalgebra::{Matrix2, Matrix4, Matrix5, RowVector4, Vector3, Vector4, Vector5};

use super::Returned;
use crate::laws::bulk::MaterialFailure;

/// The axes of b = F C_p⁻¹ Fᵀ, two in plane and one across it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Axes {
    deformation: Matrix2<f64>,
    stretch: f64,
    /// Q: the axes in plane, in columns
    turn: Matrix2<f64>,
    /// F⁻¹ Q
    pulled: Matrix2<f64>,
    /// Rᵀ Q: the axes before the rotation R of F = R U
    unrotated: Matrix2<f64>,
    /// b₁, b₂, b₃
    squares: Vector3<f64>,
    /// ε_i = ½ ln b_i
    pub strains: Vector3<f64>,
}

impl Axes {
    /// The trial state of F, F₃₃ and C_p⁻¹ − 1 (xx, yy, xy, zz). b − 1 is formed from F − 1, so that small strains lose no digits.
    #[inline(always)]
    pub fn of(deformation: &Matrix2<f64>, stretch: f64, state: &[f64]) -> Result<Self, MaterialFailure> {
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
        let inverse = Matrix2::new(f.m22, -f.m12, -f.m21, f.m11) / f.determinant();
        let strains = less_one.map(|e| 0.5 * e.ln_1p());
        let unrotated = rotation(f).transpose() * turn;
        Ok(Self { deformation: *f, stretch, turn, pulled: inverse * turn, unrotated, squares, strains })
    }

    /// Turn an unrotated tensor (xx, yy, zz, xy) into the axes.
    pub fn enter(&self, tensor: &mut [f64]) {
        turned(&self.unrotated.transpose(), tensor);
    }

    /// Turn a tensor in the axes back.
    pub fn leave(&self, tensor: &mut [f64]) {
        turned(&self.unrotated, tensor);
    }

    /// C_p⁻¹ − 1 after a plastic strain; unchanged bits without one.
    ///
    /// ```text
    /// C_p⁻¹ ← C_p⁻¹ + F⁻¹ (exp(2 ε_e) − b) F⁻ᵀ,   ε_e = ε − Δε_p
    /// ```
    pub fn flow(&self, plastic: &Vector4<f64>, stretch: f64, state: &mut [f64]) {
        if plastic.iter().all(|part| *part == 0.0) {
            return;
        }
        let (e, b) = (&self.strains, &self.squares);
        let less = match plastic[3] == 0.0 {
            true => Matrix2::from_diagonal(&[0, 1].map(|i| b[i] * (-2.0 * plastic[i]).exp_m1()).into()),
            false => {
                let strain = Vector4::new(e.x, e.y, e.z, 0.0) - plastic;
                let [xx, yy, _, xy] = exponential_less_one(&(2.0 * strain)).into();
                Matrix2::new(xx - (b.x - 1.0), xy, xy, yy - (b.y - 1.0))
            }
        };
        let change = self.pulled * less * self.pulled.transpose();
        state[0] += change.m11;
        state[1] += change.m22;
        state[2] += 0.5 * (change.m12 + change.m21);
        state[3] += b.z * (-2.0 * plastic[2]).exp_m1() / (stretch * stretch);
    }

    /// P of a stress in the axes, and the matrix that takes X (11, 21, 12, 22 in the axes) to Q X Qᵀ F⁻ᵀ.
    #[inline(always)]
    pub fn first_piola_kirchhoff(&self, stress: &Vector4<f64>) -> (Vector5<f64>, Matrix4<f64>) {
        let [t11, t22, t33, t12]: [f64; 4] = (*stress).into();
        let (q, g) = (&self.turn, &self.pulled);
        let pull = Matrix4::from_fn(|row, column| q[(row % 2, column % 2)] * g[(row / 2, column / 2)]);
        let in_plane = pull * Vector4::new(t11, t12, t12, t22);
        (Vector5::new(in_plane[0], in_plane[1], in_plane[2], in_plane[3], t33 / self.stretch), pull)
    }

    /// ∂P/∂F of a stress and tangent in the axes, see (6); with the spin of tensors of the history.
    pub fn moduli(&self, found: &Returned, pull: &Matrix4<f64>, spins: bool) -> Matrix5<f64> {
        let d = &found.tangent;
        let inverse = 1.0 / self.stretch;
        let by_across = Vector4::new(d[(0, 2)], d[(3, 2)], d[(3, 2)], d[(1, 2)]);
        let mut across = inverse * (RowVector4::from(self.by_gradient(found).map(|c| c[2])) * pull.transpose());
        if spins {
            across -= inverse * (self.strains.x - self.strains.y) * d[(2, 3)] * spin(&self.deformation).transpose();
        }
        let mut tangent = Matrix5::zeros();
        tangent.fixed_view_mut::<4, 4>(0, 0).copy_from(&self.moduli_in_plane(found, pull, spins));
        tangent.fixed_view_mut::<4, 1>(0, 4).copy_from(&(inverse * (pull * by_across)));
        tangent.fixed_view_mut::<1, 4>(4, 0).copy_from(&across);
        tangent[(4, 4)] = inverse * inverse * (d[(2, 2)] - found.stress[2]);
        tangent
    }

    /// The part of these moduli in plane.
    pub fn moduli_in_plane(&self, found: &Returned, pull: &Matrix4<f64>, spins: bool) -> Matrix4<f64> {
        let [t11, t22, _, t12]: [f64; 4] = found.stress.into();
        let columns = self.by_gradient(found).map(|c| Vector4::new(c[0], c[3], c[3], c[1]));
        let mut moduli = Matrix4::from_columns(&columns);
        // τ lᵀ
        let of_stress = [
            [(0, 0, t11), (0, 2, t12), (1, 0, t12), (1, 2, t22)],
            [(2, 1, t11), (2, 3, t12), (3, 1, t12), (3, 3, t22)],
        ];
        for (row, column, part) in of_stress.into_iter().flatten() {
            moduli[(row, column)] -= part;
        }
        let mut tangent = product(&product(pull, &moduli), &pull.transpose());
        if spins {
            let follow = (self.strains.y - self.strains.x) * found.tangent.column(3);
            let [along, shear] = [t11 - t22, 2.0 * t12];
            let follow = Vector4::new(follow[0] - shear, follow[3] + along, follow[3] + along, follow[1] + shear);
            tangent += pull * follow * spin(&self.deformation).transpose();
        }
        tangent
    }

    /// dτ by l₁₁, l₂₁, l₁₂, l₂₂
    #[inline(always)]
    fn by_gradient(&self, found: &Returned) -> [Vector4<f64>; 4] {
        let (d, [by_12, by_21]) = (&found.tangent, self.shear_of_gradient());
        let shear = d.column(3);
        [d.column(0).into(), by_21 * shear, by_12 * shear, d.column(1).into()]
    }

    /// ∂ε₁₂/∂l₁₂ and ∂ε₁₂/∂l₂₁: (ε₁ − ε₂)/(b₁ − b₂) times b₂ and b₁, ½ where the strains are equal.
    ///
    /// ```text
    /// ½ x/(eˣ − 1)   and   ½ x/(1 − e⁻ˣ) = ½ x/(eˣ − 1) + ½ x,   x = 2 (ε₁ − ε₂) ≥ 0
    /// ```
    fn shear_of_gradient(&self) -> [f64; 2] {
        let twice = 2.0 * (self.strains.x - self.strains.y);
        let lesser = if twice == 0.0 { 0.5 } else { 0.5 * twice / twice.exp_m1() };
        [lesser, lesser + 0.5 * twice]
    }
}

/// A B, written out: each column is a sum of the columns of A.
#[inline(always)]
fn product(a: &Matrix4<f64>, b: &Matrix4<f64>) -> Matrix4<f64> {
    let column = |j: usize| {
        a.column(0) * b[(0, j)] + a.column(1) * b[(1, j)] + a.column(2) * b[(2, j)] + a.column(3) * b[(3, j)]
    };
    Matrix4::from_columns(&[0, 1, 2, 3].map(column))
}

/// √(a² + b²) of numbers whose squares do not overflow
fn radius(a: f64, b: f64) -> f64 {
    (a * a + b * b).sqrt()
}

/// The axes of a symmetric tensor: of half the difference of its diagonal, its shear, and the radius of both.
fn principal_turn(half: f64, off: f64, radius: f64) -> Matrix2<f64> {
    if radius == 0.0 {
        return Matrix2::identity();
    }
    // cos and sin of half the angle, by that which is not small
    let (c, s) = match half >= 0.0 {
        true => {
            let c = (0.5 * (1.0 + half / radius)).sqrt();
            (c, 0.5 * off / (radius * c))
        }
        false => {
            let s = (0.5 * (1.0 - half / radius)).sqrt();
            (0.5 * off / (radius * s), s)
        }
    };
    Matrix2::new(c, -s, s, c)
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
fn turned(m: &Matrix2<f64>, tensor: &mut [f64]) {
    let a = m * Matrix2::new(tensor[0], tensor[3], tensor[3], tensor[1]) * m.transpose();
    (tensor[0], tensor[1], tensor[3]) = (a.m11, a.m22, 0.5 * (a.m12 + a.m21));
}

/// R of F = R U.
fn rotation(f: &Matrix2<f64>) -> Matrix2<f64> {
    let (along, around) = (f.m11 + f.m22, f.m21 - f.m12);
    let size = radius(along, around);
    Matrix2::new(along, -around, around, along) / size
}

/// ∂θ/∂F of the angle of R.
fn spin(f: &Matrix2<f64>) -> Vector4<f64> {
    let (along, around) = (f.m11 + f.m22, f.m21 - f.m12);
    Vector4::new(-around, along, -along, -around) / (along * along + around * around)
}
