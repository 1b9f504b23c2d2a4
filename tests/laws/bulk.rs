//! What tests of bulk laws ask of them.

use fecontact::laws::bulk::{
    BodyLaw, CauchyStress, InadmissibleStress, Material, MaterialFailure, MaterialResponse, Straining, Surroundings,
};
use nalgebra::{Matrix2, Vector2};

/// Whether a law can begin under a stress.
pub fn admits(law: &dyn Material, stress: &CauchyStress) -> Result<(), InadmissibleStress> {
    law.begin(Vector2::zeros(), stress, &mut vec![0.0; law.description().variables.len()])
}

/// The answer in plane strain, or of a plate.
pub fn in_plane(law: &dyn Material, now: Straining, new: &mut [f64]) -> Result<MaterialResponse, MaterialFailure> {
    let mut answer = MaterialResponse::default();
    law.in_plane(&[now], new, std::slice::from_mut(&mut answer))?;
    Ok(answer)
}

/// σ at F in plane where the law remembers some variables.
pub fn cauchy(law: &dyn Material, deformation: &Matrix2<f64>, old: &[f64]) -> CauchyStress {
    law.cauchy_stress(&Straining::new(*deformation, old)).expect("an answer")
}

/// The law in a plate.
pub fn in_plate(law: Box<dyn Material>) -> Box<dyn Material> {
    BodyLaw::new(law, Surroundings::default().plate()).expect("it serves in plates").into()
}
