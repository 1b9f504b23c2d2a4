//! Damping of the Kelvin–Voigt kind: a stress proportional to the rate of strain, τ being a time.
//!
//! ```text
//! P_v = τ F (C:Ė),   Ė = sym(Fᵀ Ḟ),   C:Ė = λ tr(Ė) 1 + 2 G Ė                                  (1)
//! ```
//! It turns with the body and does not resist a rotation. In small strains it is τ times the elastic stress of the rate of strain, the
//! stiffness-proportional part of Rayleigh's damping; of a linear law it is that at any strain, P_v = τ C:Ḟ.

use nalgebra::{Matrix2, Vector5};

use super::MaterialDescription;
use super::components::{components, plane};

/// A tensor in plane, and its 33 component.
type Parts = (Matrix2<f64>, f64);

impl MaterialDescription<'_> {
    /// P_v/τ of (1) at F and Ḟ [F/(L² T)]
    pub fn viscous_stress(&self, motion: [&Vector5<f64>; 2]) -> Vector5<f64> {
        let [f, rate] = motion.map(parts);
        let (stress, across) = match self.is_linear {
            true => self.hooke(&rate),
            false => product(&f, &self.hooke(&strain(&f, &rate))),
        };
        components(&stress, across)
    }

    /// Variation of P_v/τ with δF and δḞ.
    pub fn viscous_variation(&self, motion: [&Vector5<f64>; 2], varied: [&Vector5<f64>; 2]) -> Vector5<f64> {
        let ([f, rate], [df, drate]) = (motion.map(parts), varied.map(parts));
        let (stress, across) = match self.is_linear {
            true => self.hooke(&drate),
            false => {
                let change = sum(&strain(&df, &rate), &strain(&f, &drate));
                sum(&product(&df, &self.hooke(&strain(&f, &rate))), &product(&f, &self.hooke(&change)))
            }
        };
        components(&stress, across)
    }

    /// C:sym(e) = λ tr(e) 1 + G (e + eᵀ)
    fn hooke(&self, (plane, across): &Parts) -> Parts {
        let modulus = self.viscous_modulus.unwrap_or(self.p_wave_modulus);
        let mean = (modulus - 2.0 * self.shear_modulus) * (plane.trace() + across);
        let own = self.shear_modulus * (plane + plane.transpose());
        (Matrix2::from_diagonal_element(mean) + own, mean + self.shear_modulus * (across + across))
    }
}

fn parts(tensor: &Vector5<f64>) -> Parts {
    (plane(tensor), tensor[4])
}

fn product((a, a_33): &Parts, (b, b_33): &Parts) -> Parts {
    (a * b, a_33 * b_33)
}

fn sum((a, a_33): &Parts, (b, b_33): &Parts) -> Parts {
    (a + b, a_33 + b_33)
}

/// Fᵀ Ḟ
fn strain((f, f_33): &Parts, (rate, rate_33): &Parts) -> Parts {
    (f.transpose() * rate, f_33 * rate_33)
}
