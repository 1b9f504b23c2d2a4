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

/// Formats a count with its noun.
pub fn count(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}
