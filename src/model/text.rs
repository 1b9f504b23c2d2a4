//! Numbers and counts in text.

pub use crate::laws::text::{distinct, number};

/// Formats a position or another vector: (x, y).
pub fn vector(of: impl Into<[f64; 2]>) -> String {
    format!("({})", of.into().map(number).join(", "))
}

/// Number of characters up to which a number in a message is left as it is.
const READABLE: usize = 22;

/// Writes the numbers of a message that have more digits than anybody reads with an exponent; names that have as many stay.
///
/// Every message passes here on its way out: a number may be anything, wherever it is printed.
pub fn readable(message: &str) -> String {
    let is_part = |c: char| c.is_ascii_digit() || c == '.';
    let is_of_name = |before: &str| before.ends_with(|c: char| c.is_alphanumeric() || "_/`\"".contains(c));
    let mut text = String::with_capacity(message.len());
    let mut rest = message;
    while let Some(at) = rest.find(|c: char| c.is_ascii_digit()) {
        let length = rest[at..].find(|c| !is_part(c)).unwrap_or(rest.len() - at);
        let (before, digits) = (&rest[..at], &rest[at..at + length]);
        text += before;
        match digits.parse::<f64>() {
            Ok(value) if length > READABLE && !is_of_name(before) => text += &format!("{value:e}"),
            _ => text += digits,
        }
        rest = &rest[at + length..];
    }
    text + rest
}

/// Formats a count with its noun.
pub fn count(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests {
    use super::readable;

    #[test]
    fn numbers_without_end_are_written_with_an_exponent() {
        assert_eq!(readable(&format!("is {} at ({}, 0.25)", -1e300, 1e-40)), "is -1e300 at (1e-40, 0.25)");
        assert_eq!(readable(&format!("at ({:.6}, {:.6})", 3e99, 0.5)), "at (3e99, 0.500000)");
        let names = "out/12345678901234567890123456/case_00000000000000000000000001.json: `9999999999999999999999999`";
        assert_eq!(readable(names), names);
    }
}
