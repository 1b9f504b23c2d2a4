//! Numbers and counts in text.

/// A number with at most six digits, in powers of ten where it is very large or small.
pub fn number(value: f64) -> String {
    let rounded = format!("{value:.5e}").parse().unwrap_or(value);
    match rounded {
        0.0 => "0".into(),
        value if (1e-3..1e5).contains(&f64::abs(value)) => format!("{value}"),
        value => format!("{value:e}"),
    }
}

/// A count with what is counted.
pub fn count(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}
