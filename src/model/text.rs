//! Numbers and counts in text.

pub use crate::laws::text::{at_least, distinct, number};

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
