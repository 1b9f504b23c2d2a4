//! Expressions in position and time, and in numbers with names.
//!
//! ```text
//! sum = product {(+|-) product}      product = sign {(*|/) sign}      sign = [+|-] sign | power      power = atom [^ sign]
//! ```
//! As on paper: −x^2 is −(x²), x^y^z is x^(y^z), and all else goes from left to right.

mod read;

use nalgebra::Vector2;

use read::Reader;

/// Longest expression that is read [bytes].
const LONGEST_EXPRESSION: usize = 1000;

/// Most values that wait for their operation.
const DEPTH: usize = 32;

/// A parsed expression in x, y and t: operations on a stack of values.
#[derive(Clone, Debug)]
pub struct Expression(Vec<Operation>);

/// What is done with the values on top of the stack.
#[derive(Clone, Copy, Debug)]
enum Operation {
    Number(f64),
    /// Its place among the variables
    Variable(usize),
    Negate,
    Unary(fn(f64) -> f64),
    Binary(fn(f64, f64) -> f64),
}

impl Operation {
    /// Values that the stack has more after it.
    fn growth(self) -> isize {
        match self {
            Self::Number(_) | Self::Variable(_) => 1,
            Self::Negate | Self::Unary(_) => 0,
            Self::Binary(_) => -1,
        }
    }
}

/// Variables of an expression in position and time.
const PLACE: [&str; 3] = ["x", "y", "t"];

/// Position of the time among them.
const TIME: usize = 2;

impl Expression {
    /// Parse an expression.
    ///
    /// # Errors
    /// What cannot be read, with a mark below the place.
    pub fn parse(text: &str) -> Result<Self, String> {
        Self::parse_in(text, &PLACE)
    }

    /// The value of an expression in numbers that have names.
    ///
    /// # Errors
    /// As [`Expression::parse`]; also where it has no finite value.
    pub fn constant(text: &str, names: &[&str], numbers: &[f64]) -> Result<f64, String> {
        let value = Self::parse_in(text, names)?.evaluate(numbers);
        if value.is_finite() { Ok(value) } else { Err(format!("\"{text}\" is {value}: must be finite")) }
    }

    /// What prevents a variable from having this name.
    pub fn refused_name(name: &str) -> Option<&'static str> {
        read::refused_name(name)
    }

    fn parse_in(text: &str, variables: &[&str]) -> Result<Self, String> {
        if text.len() > LONGEST_EXPRESSION {
            return Err(format!("the expression is longer than {LONGEST_EXPRESSION} characters: use a table"));
        }
        let operations = Reader::read(text, variables)?;
        let mut height = 0;
        let heights = operations.iter().map(|operation| {
            height += operation.growth();
            height
        });
        match heights.max() {
            Some(most) if most <= DEPTH as isize => Ok(Self(operations)),
            _ => Err(format!("\"{text}\" cannot be read: it has more than {DEPTH} levels of brackets: use a table")),
        }
    }

    /// The same with the other sign.
    #[must_use]
    pub fn negated(&self) -> Self {
        Self(self.0.iter().copied().chain([Operation::Negate]).collect())
    }

    /// Whether t stands in it.
    pub fn depends_on_time(&self) -> bool {
        self.0.iter().any(|operation| matches!(operation, Operation::Variable(TIME)))
    }

    /// Whether x or y stands in it.
    pub fn depends_on_position(&self) -> bool {
        self.0.iter().any(|operation| matches!(operation, Operation::Variable(which) if *which != TIME))
    }

    /// Value at a reference position and time; NaN where the expression is not defined.
    pub fn value(&self, position: Vector2<f64>, time: f64) -> f64 {
        self.evaluate(&[position.x, position.y, time])
    }

    fn evaluate(&self, variables: &[f64]) -> f64 {
        let mut stack = [0.0; DEPTH];
        let mut height = 0;
        for operation in &self.0 {
            match operation {
                Operation::Number(number) => stack[height] = *number,
                Operation::Variable(which) => stack[height] = variables[*which],
                Operation::Negate => stack[height - 1] = -stack[height - 1],
                Operation::Unary(function) => stack[height - 1] = function(stack[height - 1]),
                Operation::Binary(function) => stack[height - 2] = function(stack[height - 2], stack[height - 1]),
            }
            height = height.wrapping_add_signed(operation.growth());
        }
        stack[0]
    }
}
