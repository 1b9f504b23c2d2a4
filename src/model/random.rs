//! Random fields: quantities that vary along a surface at random, with a given mean, deviation and correlation.

use std::f64::consts::{PI, TAU};
use std::sync::OnceLock;

use nalgebra::Vector2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// A homogeneous, isotropic random field of the reference position. It does not depend on the mesh: the same seed gives the same value
/// at the same place, bitwise identical on every machine.
///
/// ```text
/// g(x) = Σ_j √(−2 ln u_j / N) cos(k_j·x + 2π v_j)       normal, mean 0, deviation 1; u, v uniform in (0, 1)            (1)
/// value = m + s g                                     normal, mean m, deviation s                                   (2)
/// value = exp(ln m − σ²/2 + σ g),  σ² = ln(1 + s²/m²)   lognormal, mean m, deviation s                                (3)
/// C(d) = exp(−d²/a²)                                  gaussian: correlation of g at the distance d                  (4)
/// C(d) = 2^(1−H)/Γ(H) (d/a)^H K_H(d/a)                von_karman; exp(−d/a) for H = ½                               (5)
/// P(|k| > κ) = exp(−κ²a²/4)   or   (1 + κ²a²)^(−H)      share of their plane spectra beyond the wavenumber κ          (6)
/// ```
/// An amplitude √(−2 ln u) and its phase make a normal number (Box and Muller), so (1) is normal for any N. The |k_j| solve (6), one from
/// each N-th part of the spectrum; the directions of k_j are evenly spread by the golden ratio.
///
/// Two fields with the same seed, correlation and spectrum have the same g. With another seed they are independent.
///
/// Sources: M. Shinozuka, G. Deodatis, Appl. Mech. Rev. 44 (1991) 191; (5) P. M. Mai, G. C. Beroza, J. Geophys. Res. 107 (2002) 2308.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Random")]
#[non_exhaustive]
pub struct RandomField {
    /// Number of the field, 0 to 2^53: another seed gives another field
    pub seed: u64,
    /// m: mean
    pub mean: f64,
    /// s: standard deviation, s ≥ 0
    pub deviation: f64,
    /// a: correlation length, a > 0. At this distance the correlation of a gaussian spectrum is 1/e [L]
    pub correlation: f64,
    /// Distribution of the values at a point
    #[serde(default)]
    pub marginal: Marginal,
    /// Spectrum of the field
    #[serde(default)]
    pub spectrum: Spectrum,
    /// Of (1), once they are needed
    #[serde(skip)]
    waves: OnceLock<Vec<Wave>>,
}

/// Distribution of the values of a random field at a point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Marginal {
    /// Normal
    #[default]
    Normal,
    /// Lognormal: positive values, whose mean is positive; the logarithm has the spectrum
    Lognormal,
}

/// Spectrum of a random field.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
#[non_exhaustive]
pub enum Spectrum {
    /// Gaussian: smooth, without wavelengths much below the correlation length
    #[default]
    Gaussian,
    /// Von Kármán: rough at all wavelengths below the correlation length
    VonKarman {
        /// H: Hurst exponent, 0 < H ≤ 1; ½ is a correlation of exp(−d/a), smaller ones are rougher [-]
        hurst: f64,
    },
}

/// One term of (1).
#[derive(Clone, Copy, Debug)]
struct Wave {
    amplitude: f64,
    /// k [1/L]
    number: Vector2<f64>,
    phase: f64,
}

/// A number of a random field that is out of range.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("is {value}: {allowed}")]
pub struct InvalidField {
    /// its key
    pub key: &'static str,
    value: f64,
    allowed: &'static str,
}

/// N: number of waves. The correlation that the wavenumbers of one seed make differs from (4) by 0.002, from (5) with H = ½ by 0.01 (root
/// mean squares over 40 seeds, d up to 2.5 a).
const WAVES: u64 = 512;

/// Fraction of a turn between the directions of two waves: 1 over the golden ratio.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// Largest seed: a number of JSON holds it exactly.
const LARGEST_SEED: u64 = 1 << 53;

impl RandomField {
    /// Creates a normal field with a Gaussian spectrum.
    pub fn new(seed: u64, mean: f64, deviation: f64, correlation: f64) -> Self {
        let (marginal, spectrum) = (Marginal::default(), Spectrum::default());
        Self { seed, mean, deviation, correlation, marginal, spectrum, waves: OnceLock::new() }
    }

    /// Checks that its numbers are in range.
    ///
    /// # Errors
    /// Returns [`InvalidField`] for one that is not.
    pub fn check(&self) -> Result<(), InvalidField> {
        let require = |key, value: f64, fits: bool, allowed| match fits && value.is_finite() {
            true => Ok(()),
            false => Err(InvalidField { key, value, allowed }),
        };
        require("seed", self.seed as f64, self.seed <= LARGEST_SEED, "must be at most 2^53 = 9007199254740992")?;
        let is_lognormal = self.marginal == Marginal::Lognormal;
        let allowed =
            if is_lognormal { "a lognormal field is positive, and so is its mean" } else { "must be a finite number" };
        require("mean", self.mean, !is_lognormal || self.mean > 0.0, allowed)?;
        require("deviation", self.deviation, self.deviation >= 0.0, "must be zero or positive")?;
        require("correlation", self.correlation, self.correlation > 0.0, "must be positive")?;
        match self.spectrum {
            Spectrum::Gaussian => Ok(()),
            Spectrum::VonKarman { hurst } => require(
                "spectrum.von_karman.hurst",
                hurst,
                hurst > 0.0 && hurst <= 1.0,
                "must be above 0, and at most 1",
            ),
        }
    }

    /// Value at a reference position.
    pub fn value(&self, position: Vector2<f64>) -> f64 {
        let wave = |wave: &Wave| wave.amplitude * libm::cos(wave.number.dot(&position) + wave.phase);
        let normal: f64 = self.waves.get_or_init(|| self.draw()).iter().map(wave).sum();
        match self.marginal {
            Marginal::Normal => self.mean + self.deviation * normal,
            Marginal::Lognormal => {
                let variance = libm::log1p((self.deviation / self.mean).powi(2));
                self.mean * libm::exp(variance.sqrt() * normal - 0.5 * variance)
            }
        }
    }

    /// Draws the waves.
    fn draw(&self) -> Vec<Wave> {
        let mut random = SplitMix(self.seed);
        let first = random.uniform();
        let one = |j: u64| {
            let turn = PI * (first + j as f64 * GOLDEN).fract();
            let number = self.wavenumber((j as f64 + random.uniform()) / WAVES as f64);
            Wave {
                amplitude: (-2.0 * libm::log(random.uniform()) / WAVES as f64).sqrt(),
                number: Vector2::new(libm::cos(turn), libm::sin(turn)) * number,
                phase: TAU * random.uniform(),
            }
        };
        (0..WAVES).map(one).collect()
    }

    /// The wavenumber beyond which the spectrum has a given share, (6) [1/L].
    fn wavenumber(&self, share: f64) -> f64 {
        match self.spectrum {
            Spectrum::Gaussian => 2.0 * (-libm::log(share)).sqrt() / self.correlation,
            Spectrum::VonKarman { hurst } => libm::expm1(-libm::log(share) / hurst).sqrt() / self.correlation,
        }
    }
}

setters! { random: RandomField;
    /// Sets the distribution of the values at a point.
    marginal(marginal: Marginal) { random.marginal = marginal; }

    /// Sets the spectrum.
    spectrum(spectrum: Spectrum) { random.spectrum = spectrum; random.waves = OnceLock::new(); }
}

/// Random bits: the generator `SplitMix64`.
///
/// Source: G. L. Steele, D. Lea, C. H. Flood, OOPSLA 2014, doi:10.1145/2660193.2660195.
struct SplitMix(u64);

impl SplitMix {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// A number in (0, 1).
    fn uniform(&mut self) -> f64 {
        ((self.next() >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    }
}
