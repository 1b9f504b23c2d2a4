//! Numbers and counts in text.

/// Formats a number with at most six digits, with an exponent where it is very large or small.
pub fn number(value: f64) -> String {
    let rounded = format!("{value:.5e}").parse().unwrap_or(value);
    match rounded {
        0.0 => "0".into(),
        value if (1e-3..1e5).contains(&f64::abs(value)) => format!("{value}"),
        value => format!("{value:e}"),
    }
}

/// Formats a position or another vector: (x, y).
pub fn vector(of: impl Into<[f64; 2]>) -> String {
    format!("({})", of.into().map(number).join(", "))
}

/// Number of characters up to which a number in a message is left as it is.
const READABLE: usize = 22;

/// Writes the numbers of a message that have more digits than anybody reads with an exponent.
pub fn readable(message: &str) -> String {
    let is_part = |c: char| c.is_ascii_digit() || c == '.';
    let mut text = String::with_capacity(message.len());
    let mut rest = message;
    while let Some(at) = rest.find(|c: char| c.is_ascii_digit()) {
        let length = rest[at..].find(|c| !is_part(c)).unwrap_or(rest.len() - at);
        let (before, digits) = (&rest[..at], &rest[at..at + length]);
        text += before;
        match digits.parse::<f64>() {
            Ok(value) if length > READABLE => text += &format!("{value:e}"),
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
