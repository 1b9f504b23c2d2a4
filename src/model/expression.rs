//! Expressions in position and time.

use exmex::{Express, FlatEx, FloatOpsFactory, MatchLiteral, NumberMatcher};
use nalgebra::Vector2;

/// Longest expression that is read; the parser recurses into its brackets [bytes].
const LONGEST_EXPRESSION: usize = 1000;

/// A parsed expression in x, y and t.
#[derive(Clone, Debug)]
pub struct Expression(Box<FlatEx<f64, FloatOpsFactory<f64>, Decimal>>);

/// A number as Rust and JSON write it, with an exponent such as 2.5e-3, which the parser's own literals lack.
#[derive(Clone, Debug)]
struct Decimal;

impl MatchLiteral for Decimal {
    fn is_literal(text: &str) -> Option<&str> {
        let mantissa = NumberMatcher::is_literal(text)?;
        let exponent = text[mantissa.len()..].strip_prefix(['e', 'E']);
        let unsigned = exponent.map_or("", |power| power.strip_prefix(['+', '-']).unwrap_or(power));
        let digits = unsigned.bytes().take_while(u8::is_ascii_digit).count();
        Some(if digits == 0 { mantissa } else { &text[..text.len() - unsigned.len() + digits] })
    }
}

impl Expression {
    /// Parse an expression.
    ///
    /// # Errors
    /// What the parser could not read, or the first variable that is none of x, y, t.
    pub fn parse(text: &str) -> Result<Self, String> {
        if text.len() > LONGEST_EXPRESSION {
            return Err(format!("the expression is longer than {LONGEST_EXPRESSION} characters: use a table"));
        }
        let complain = |error: String| format!("\"{text}\" cannot be read: {error}");
        let parsed = FlatEx::parse(text).map_err(|error| complain(error.to_string()))?;
        match parsed.var_names().iter().find(|name| !["t", "x", "y"].contains(&name.as_str())) {
            Some(name) => Err(complain(format!("`{name}` is not one of the variables x, y, t"))),
            None => Ok(Self(Box::new(parsed))),
        }
    }

    /// Whether t stands in it.
    pub fn depends_on_time(&self) -> bool {
        self.0.var_names().iter().any(|name| name == "t")
    }

    /// Whether x or y stands in it.
    pub fn depends_on_position(&self) -> bool {
        self.0.var_names().iter().any(|name| name != "t")
    }

    /// Value at a reference position and time; NaN where the expression is not defined.
    pub fn value(&self, position: Vector2<f64>, time: f64) -> f64 {
        let of = |name: &String| match name.as_str() {
            "t" => time,
            "x" => position.x,
            _ => position.y,
        };
        let names = self.0.var_names();
        let mut values = [0.0; 3];
        values.iter_mut().zip(names).for_each(|(value, name)| *value = of(name));
        self.0.eval(&values[..names.len()]).unwrap_or(f64::NAN)
    }
}
