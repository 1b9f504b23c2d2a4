//! Numbers packed into text: rounded, their bytes sorted by weight, compressed, in base64.

use std::io::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::DeflateEncoder;
use serde::Serialize;

/// Bits of the fraction that fields keep: their relative error is at most 2⁻¹².
const BITS: u32 = 11;

/// A displacement is kept to this part of the largest one.
const PLACES: f64 = 1.0 / 1_048_576.0;

/// Packed numbers, by themselves.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Packed(String);

impl Packed {
    /// How much room it takes [bytes].
    pub fn size(&self) -> usize {
        self.0.len()
    }

    /// Doubles, as they are.
    pub fn exact(values: &[f64]) -> Self {
        Self::of(values.iter().map(|value| value.to_le_bytes()), values.len())
    }

    /// Single precision.
    pub fn single(values: &[f64]) -> Self {
        Self::of(values.iter().map(|value| (*value as f32).to_le_bytes()), values.len())
    }

    /// Single precision with fewer bits.
    pub fn rounded(values: impl ExactSizeIterator<Item = f64>) -> Self {
        let count = values.len();
        Self::of(values.map(|value| rounded(value as f32).to_le_bytes()), count)
    }

    /// Displacements, of which the largest is `size`.
    pub fn displacements(values: impl ExactSizeIterator<Item = f64>, size: f64) -> Self {
        let count = values.len();
        // A power of two, so that rounding leaves zeros behind in every digit of a computer.
        let step = if size > 0.0 && size.is_finite() { (size * PLACES).log2().ceil().exp2() } else { 1.0 };
        Self::of(values.map(|value| (((value / step).round() * step) as f32).to_le_bytes()), count)
    }

    /// Whole numbers.
    pub fn counts(values: &[u32]) -> Self {
        Self::of(values.iter().map(|value| value.to_le_bytes()), values.len())
    }

    /// Of one byte each.
    pub fn bytes(values: &[u8]) -> Self {
        Self::of(values.iter().map(|value| [*value]), values.len())
    }

    /// All first bytes, then all second ones, and so on: alike bytes beside each other.
    fn of<const N: usize>(values: impl Iterator<Item = [u8; N]>, count: usize) -> Self {
        let mut bytes = vec![0; N * count];
        for (k, value) in values.enumerate() {
            value.iter().enumerate().for_each(|(i, byte)| bytes[i * count + k] = *byte);
        }
        let mut encoder = DeflateEncoder::new(Vec::with_capacity(bytes.len() / 2), Compression::new(4));
        // Writing to a Vec cannot fail.
        let _ = encoder.write_all(&bytes);
        Self(STANDARD.encode(encoder.finish().unwrap_or_default()))
    }
}

/// To [`BITS`] bits behind the leading one, half to even; what is not finite stays.
fn rounded(value: f32) -> f32 {
    const DROPPED: u32 = 23 - BITS;
    let bits = value.to_bits();
    if !value.is_finite() {
        return value;
    }
    let half = (1 << (DROPPED - 1)) - 1 + ((bits >> DROPPED) & 1);
    let rounded = f32::from_bits(bits.wrapping_add(half) & !((1 << DROPPED) - 1));
    if rounded.is_finite() { rounded } else { value }
}

/// Where packed numbers stand among all of them: start, length.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Chunk(usize, usize);

/// All packed numbers of a page.
#[derive(Debug, Default)]
pub struct Pack {
    /// one after the other
    pub text: String,
}

impl Pack {
    /// Add some.
    pub fn add(&mut self, packed: &Packed) -> Chunk {
        let start = self.text.len();
        self.text += &packed.0;
        Chunk(start, packed.size())
    }
}

#[cfg(test)]
mod tests {
    use super::rounded;

    #[test]
    fn rounding_errs_by_half_a_last_bit() {
        for k in 0..10_000u32 {
            let value = (k as f32 * 0.37).exp2() * 1e-20 + k as f32 * 1e-9;
            assert!((rounded(value) - value).abs() <= value.abs() * 2f32.powi(-12), "{value}");
        }
        assert!(rounded(f32::NAN).is_nan());
        assert_eq!((rounded(f32::MAX), rounded(f32::INFINITY)), (f32::MAX, f32::INFINITY));
    }
}
