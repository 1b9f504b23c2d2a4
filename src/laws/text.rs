//! Numbers in text.

/// Formats a number with at most six digits, with an exponent where it is very large or small.
pub fn number(value: f64) -> String {
    to_digits(value, FEW)
}

/// Digits of a number in a text.
const FEW: usize = 6;

/// Digits of a number in double precision.
const ALL: usize = 17;

/// Formats two numbers that are compared, with as many digits as it takes to distinguish them.
pub fn distinct(numbers: [f64; 2]) -> [String; 2] {
    let with = |digits| numbers.map(|value| to_digits(value, digits));
    (FEW..ALL).map(with).find(|[one, other]| one != other).unwrap_or_else(|| with(ALL))
}

/// Formats a number that a value must reach, rounded up to six digits: whoever takes what is printed reaches it.
pub fn at_least(value: f64) -> String {
    let text = format!("{value:.*e}", FEW - 1);
    let (rounded, exponent) =
        (text.parse().unwrap_or(value), text.split('e').nth(1).and_then(|e| e.parse::<i32>().ok()));
    match exponent {
        Some(exponent) if rounded < value => number(rounded + 10.0f64.powi(exponent + 1 - FEW as i32)),
        _ => number(rounded),
    }
}

fn to_digits(value: f64, digits: usize) -> String {
    let rounded = format!("{value:.*e}", digits - 1).parse().unwrap_or(value);
    match rounded {
        0.0 => "0".into(),
        value if (1e-3..1e5).contains(&f64::abs(value)) => format!("{value}"),
        value => format!("{value:e}"),
    }
}
