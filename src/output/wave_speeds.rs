//! Speeds of elastic waves, with which fronts are compared.

use serde::{Deserialize, Serialize};

use crate::contact::pair::ContactPair;
use crate::laws::bulk::Material;
use crate::model::Model;

/// c_R, c_s and c_p of an elastic body [L/T].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct WaveSpeeds {
    /// c_R: Rayleigh waves along a free surface
    pub rayleigh: f64,
    /// c_s = √(G/ρ): shear waves
    pub shear: f64,
    /// c_p = √((λ + 2G)/ρ): pressure waves
    pub pressure: f64,
}

impl WaveSpeeds {
    /// Of the body behind the slave of a contact, if there is one.
    pub fn behind(model: &Model, pair: &ContactPair) -> Option<Self> {
        Some(Self::of(&*model.bodies[pair.body?].material))
    }

    /// Of a material; infinite without density.
    ///
    /// ```text
    /// (2 − ξ²)² = 4 √(1 − ξ²) √(1 − ξ² c_s²/c_p²),   ξ = c_R/c_s
    /// ```
    pub fn of(material: &dyn Material) -> Self {
        let speed = |modulus: f64| (modulus / material.density()).sqrt();
        let (shear, pressure) = (speed(material.shear_modulus()), speed(material.p_wave_modulus()));
        let ratio = material.shear_modulus() / material.p_wave_modulus();
        // Negative below the root but for the trivial one at 0, positive above.
        let excess = |square: f64| (2.0 - square).powi(2) - 4.0 * ((1.0 - square) * (1.0 - square * ratio)).sqrt();
        let (mut low, mut high) = (0.1, 1.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if excess(middle) < 0.0 { low = middle } else { high = middle }
        }
        Self { rayleigh: shear * low.sqrt(), shear, pressure }
    }
}

/// c_R, c_s and c_p of the body behind the first contact's slave; 0 if there is none, or it has no density [L/T].
pub fn wave_speeds(model: &Model) -> [f64; 3] {
    let speeds = model.contacts.first().and_then(|pair| WaveSpeeds::behind(model, pair));
    let finite = speeds.filter(|speeds| speeds.pressure.is_finite());
    finite.map_or([0.0; 3], |speeds| [speeds.rayleigh, speeds.shear, speeds.pressure])
}
