//! Compression of chunks of numbers: rounded, shuffled, deflated.
//!
//! ```text
//! x̃ = round(x, b bits of mantissa),   |x̃ − x| ≤ 2^(−b−1) |x|          bit rounding, half to even
//! bytes of one significance side by side (numcodecs `shuffle`), then zlib (RFC 1950)
//! ```
//!
//! The error is relative, so that slip rates over many decades keep their digits. Zeros and non-finite values stay unchanged.
//!
//! Source: Klöwer, Razinger, Dominguez, Düben & Palmer (2021), Nat. Comput. Sci. 1, 713, doi:10.1038/s43588-021-00156-2.

use miniz_oxide::deflate::compress_to_vec_zlib;
use miniz_oxide::inflate::decompress_to_vec_zlib_with_limit;

/// b: stored mantissa bits.
pub const BITS: u32 = 15;

/// Largest relative error of a rounded value, 2^(−b−1).
pub const RELATIVE_ERROR: f64 = 1.0 / (1u64 << (BITS + 1)) as f64;

/// zlib level of complete chunks.
pub const THOROUGH: u8 = 6;
/// zlib level of chunks that will be rewritten.
pub const QUICK: u8 = 1;

/// Type of the numbers of an array.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Number {
    /// Rounded, in 4 bytes
    Single,
    /// Unchanged, in 8 bytes
    Double,
    /// Integer, in 4 bytes
    Whole,
}

impl Number {
    /// Name in numpy and zarr.
    pub fn name(self) -> &'static str {
        match self {
            Self::Single => "<f4",
            Self::Double => "<f8",
            Self::Whole => "<i4",
        }
    }

    /// Returns the type of this name.
    pub fn named(name: &str) -> Option<Self> {
        [Self::Single, Self::Double, Self::Whole].into_iter().find(|number| number.name() == name)
    }

    /// Size of a number in bytes.
    pub fn size(self) -> usize {
        if self == Self::Double { 8 } else { 4 }
    }

    /// Appends a number.
    pub fn write(self, value: f64, bytes: &mut Vec<u8>) {
        match self {
            Self::Single => bytes.extend_from_slice(&rounded(value, BITS).to_le_bytes()),
            Self::Double => bytes.extend_from_slice(&value.to_le_bytes()),
            Self::Whole => bytes.extend_from_slice(&(value as i32).to_le_bytes()),
        }
    }

    /// Decodes the numbers of some bytes.
    pub fn read(self, bytes: &[u8]) -> impl Iterator<Item = f64> {
        bytes.chunks_exact(self.size()).map(move |bytes| match (self, bytes) {
            (Self::Double, &[a, b, c, d, e, f, g, h]) => f64::from_le_bytes([a, b, c, d, e, f, g, h]),
            (Self::Single, &[a, b, c, d]) => f64::from(f32::from_le_bytes([a, b, c, d])),
            (_, &[a, b, c, d]) => f64::from(i32::from_le_bytes([a, b, c, d])),
            _ => f64::NAN,
        })
    }
}

/// Rounds a number to `bits` mantissa bits, half to even.
pub fn rounded(value: f64, bits: u32) -> f32 {
    let lost = 52 - bits;
    let digits = value.to_bits();
    // Half of the last bit, minus one unit where the last bit is even.
    let up = (1 << (lost - 1)) - 1 + ((digits >> lost) & 1);
    let rounded = f64::from_bits(digits.wrapping_add(up) & !((1 << lost) - 1)) as f32;
    if value.is_finite() && rounded.is_finite() { rounded } else { value as f32 }
}

/// Compresses a chunk for its file.
pub fn packed(bytes: &[u8], size: usize, level: u8) -> Vec<u8> {
    compress_to_vec_zlib(&shuffled(bytes, size), level)
}

/// Returns the bytes of a packed chunk, `length` of them unless it is damaged.
pub fn unpacked(packed: &[u8], size: usize, length: usize) -> Result<Vec<u8>, String> {
    let shuffled = decompress_to_vec_zlib_with_limit(packed, length).map_err(|cause| cause.to_string())?;
    match shuffled.len() == length {
        true => Ok(unshuffled(&shuffled, size)),
        false => Err(format!("it holds {} bytes instead of {length}", shuffled.len())),
    }
}

/// Groups the first bytes of all numbers, then the second ones, ...
pub fn shuffled(bytes: &[u8], size: usize) -> Vec<u8> {
    (0..size).flat_map(|k| bytes.iter().skip(k).step_by(size).copied()).collect()
}

/// Inverse of [`shuffled`].
pub fn unshuffled(bytes: &[u8], size: usize) -> Vec<u8> {
    let count = bytes.len() / size;
    (0..count).flat_map(|number| (0..size).map(move |k| bytes[k * count + number])).collect()
}
