//! Expressions in position and time, and in numbers with names.
//!
//! ```text
//! sum = product {(+|-) product}      product = sign {(*|/) sign}      sign = [+|-] sign | power      power = atom [^ sign]
//! ```
//! Precedence is the usual one: −x^2 is −(x²), x^y^z is x^(y^z), and equal operators are evaluated from left to right.
//!
//! A parser translates the text of an expression to operations.

use std::borrow::Cow;
use std::str::FromStr;
use std::sync::Arc;

use nalgebra::Vector2;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use thiserror::Error;

use crate::mesh::names::{in_line, nearest};

/// Maximum length of an expression [bytes].
const LONGEST_EXPRESSION: usize = 1000;

/// Maximum depth of the stack of values.
const DEPTH: usize = 32;

/// Text that is no expression, or one without a finite value: the reason, and a remedy.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{0}")]
pub struct InvalidExpression(String);

/// A parsed expression in x, y and t: operations on a stack of values.
#[derive(Clone, Debug)]
pub struct Expression {
    text: Arc<str>,
    operations: Arc<[Operation]>,
}

/// Operation on the values on top of the stack.
#[derive(Clone, Copy, Debug)]
enum Operation {
    Number(f64),
    /// Index of the variable
    Variable(usize),
    Negate,
    Unary(fn(f64) -> f64),
    Binary(fn(f64, f64) -> f64),
}

impl Operation {
    /// Change of the stack depth.
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

/// Index of the time among them.
const TIME: usize = 2;

impl Expression {
    /// Parses an expression.
    ///
    /// # Errors
    /// Returns [`InvalidExpression`] with a mark below the position that cannot be read.
    pub fn parse(text: &str) -> Result<Self, InvalidExpression> {
        Self::parse_in(text, &PLACE)
    }

    /// Evaluates an expression in named numbers.
    ///
    /// # Errors
    /// The same as for [`Expression::parse`]; also if it has no finite value.
    pub fn constant(text: &str, names: &[&str], numbers: &[f64]) -> Result<f64, InvalidExpression> {
        let value = Self::parse_in(text, names)?.evaluate(numbers);
        if value.is_finite() {
            Ok(value)
        } else {
            Err(InvalidExpression(format!("\"{text}\" is {value}: must be finite")))
        }
    }

    /// Reason why a variable cannot have this name, if any.
    pub fn refused_name(name: &str) -> Option<&'static str> {
        refused_name(name)
    }

    fn parse_in(text: &str, variables: &[&str]) -> Result<Self, InvalidExpression> {
        if text.len() > LONGEST_EXPRESSION {
            let message = format!("the expression is longer than {LONGEST_EXPRESSION} characters: use a table");
            return Err(InvalidExpression(message));
        }
        let operations = Reader::read(text, variables)?;
        let mut height = 0;
        let heights = operations.iter().map(|operation| {
            height += operation.growth();
            height
        });
        match heights.max() {
            Some(most) if most <= DEPTH as isize => Ok(Self { text: text.into(), operations: operations.into() }),
            _ => Err(InvalidExpression(format!(
                "\"{text}\" cannot be read: it has more than {DEPTH} levels of brackets: use a table"
            ))),
        }
    }

    /// The expression with the opposite sign.
    #[must_use]
    pub fn negated(&self) -> Self {
        let operations = self.operations.iter().copied().chain([Operation::Negate]).collect();
        Self { text: format!("-({})", self.text).into(), operations }
    }

    /// The expression multiplied by a factor.
    #[must_use]
    pub fn times(&self, factor: f64) -> Self {
        let product = [Operation::Number(factor), Operation::Binary(|a, b| a * b)];
        let operations = self.operations.iter().copied().chain(product).collect();
        Self { text: format!("({})*{factor}", self.text).into(), operations }
    }

    /// Whether it contains t.
    pub fn depends_on_time(&self) -> bool {
        self.operations.iter().any(|operation| matches!(operation, Operation::Variable(TIME)))
    }

    /// Whether it contains x or y.
    pub fn depends_on_position(&self) -> bool {
        self.operations.iter().any(|operation| matches!(operation, Operation::Variable(which) if *which != TIME))
    }

    /// Value at a reference position and time; NaN where the expression is not defined.
    pub fn value(&self, position: Vector2<f64>, time: f64) -> f64 {
        self.evaluate(&[position.x, position.y, time])
    }

    fn evaluate(&self, variables: &[f64]) -> f64 {
        let mut stack = [0.0; DEPTH];
        let mut height = 0;
        for operation in &*self.operations {
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

impl FromStr for Expression {
    type Err = InvalidExpression;

    fn from_str(text: &str) -> Result<Self, InvalidExpression> {
        Self::parse(text)
    }
}

/// The text of the expression.
impl AsRef<str> for Expression {
    fn as_ref(&self) -> &str {
        &self.text
    }
}

impl JsonSchema for Expression {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        String::schema_name()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        String::json_schema(generator)
    }
}

type Function = fn(f64) -> f64;
type Pair = fn(f64, f64) -> f64;

/// Functions of one value.
const FUNCTIONS: [(&str, Function); 28] = [
    ("abs", f64::abs),
    ("acos", f64::acos),
    ("acosh", f64::acosh),
    ("asin", f64::asin),
    ("asinh", f64::asinh),
    ("atan", f64::atan),
    ("atanh", f64::atanh),
    ("cbrt", f64::cbrt),
    ("ceil", f64::ceil),
    ("cos", f64::cos),
    ("cosh", f64::cosh),
    ("erf", libm::erf),
    ("erfc", libm::erfc),
    ("exp", f64::exp),
    ("floor", f64::floor),
    ("fract", f64::fract),
    ("ln", f64::ln),
    ("log", f64::ln),
    ("log10", f64::log10),
    ("log2", f64::log2),
    ("round", f64::round),
    ("signum", f64::signum),
    ("sin", f64::sin),
    ("sinh", f64::sinh),
    ("sqrt", f64::sqrt),
    ("tan", f64::tan),
    ("tanh", f64::tanh),
    ("trunc", f64::trunc),
];

/// Functions of two values. The larger or smaller of two is undefined if one of them is.
const PAIRS: [(&str, Pair); 3] = [("atan2", f64::atan2), ("max", largest), ("min", smallest)];

const CONSTANTS: [(&str, f64); 8] = [
    ("PI", std::f64::consts::PI),
    ("pi", std::f64::consts::PI),
    ("π", std::f64::consts::PI),
    ("TAU", std::f64::consts::TAU),
    ("tau", std::f64::consts::TAU),
    ("τ", std::f64::consts::TAU),
    ("E", std::f64::consts::E),
    ("e", std::f64::consts::E),
];

fn largest(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) }
}

fn smallest(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.min(b) }
}

/// Number of characters of a long expression shown on either side of an error.
const AROUND: usize = 30;

/// Parser of an expression, from left to right.
struct Reader<'t> {
    text: &'t str,
    /// names of the variables
    variables: &'t [&'t str],
    /// current position [bytes]
    at: usize,
    operations: Vec<Operation>,
}

/// Result of parsing; an error contains its position and a message.
type Read<T> = Result<T, (usize, String)>;

impl<'t> Reader<'t> {
    /// Returns the operations in their order.
    pub fn read(text: &'t str, variables: &'t [&'t str]) -> Result<Vec<Operation>, InvalidExpression> {
        let mut reader = Self { text, variables, at: 0, operations: Vec::new() };
        let read = reader.sum().and_then(|()| match reader.next() {
            None => Ok(()),
            Some(c) => Err((reader.at, reader.unexpected(c))),
        });
        read.map_err(|(at, what)| InvalidExpression(marked(text, at, &what)))?;
        Ok(reader.operations)
    }

    fn sum(&mut self) -> Read<()> {
        self.product()?;
        while let Some(sign @ ('+' | '-')) = self.next() {
            self.at += 1;
            self.product()?;
            self.operations.push(Operation::Binary(if sign == '+' { |a, b| a + b } else { |a, b| a - b }));
        }
        Ok(())
    }

    fn product(&mut self) -> Read<()> {
        self.sign()?;
        while let Some(sign @ ('*' | '/')) = self.next() {
            self.at += 1;
            if self.text[self.at..].starts_with('*') {
                return Err((self.at, "a power is written with ^".into()));
            }
            self.sign()?;
            self.operations.push(Operation::Binary(if sign == '*' { |a, b| a * b } else { |a, b| a / b }));
        }
        Ok(())
    }

    fn sign(&mut self) -> Read<()> {
        let mut negative = false;
        while let Some(sign @ ('+' | '-')) = self.next() {
            self.at += 1;
            negative ^= sign == '-';
        }
        self.atom()?;
        if self.next() == Some('^') {
            self.at += 1;
            self.sign()?;
            self.operations.push(Operation::Binary(f64::powf));
        }
        if negative {
            self.operations.push(Operation::Negate);
        }
        Ok(())
    }

    fn atom(&mut self) -> Read<()> {
        let start = self.at;
        match self.next() {
            None => Err((self.at, "a number, a name or a bracket is missing here".into())),
            Some('(') => {
                self.at += 1;
                self.sum()?;
                self.close(start)
            }
            Some(c) if c.is_ascii_digit() || c == '.' => self.number(),
            Some(c) if c.is_alphabetic() || c == '_' => self.name(),
            Some(c @ (')' | '*' | '/' | '^' | ',')) => {
                Err((self.at, format!("a number or a name is missing before `{c}`")))
            }
            Some(c) => Err((self.at, self.unexpected(c))),
        }
    }

    /// Parses a number in the format of Rust and JSON, with an exponent such as 2.5e-3.
    fn number(&mut self) -> Read<()> {
        let rest = &self.text[self.at..];
        let mantissa = rest.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(rest.len());
        let exponent = rest[mantissa..].strip_prefix(['e', 'E']).map_or(0, |power| {
            let unsigned = power.strip_prefix(['+', '-']).unwrap_or(power);
            let digits = unsigned.bytes().take_while(u8::is_ascii_digit).count();
            if digits == 0 { 0 } else { 1 + power.len() - unsigned.len() + digits }
        });
        let number = &rest[..mantissa + exponent];
        let value = number.parse().map_err(|_| (self.at, format!("`{number}` is not a number")))?;
        self.at += number.len();
        self.operations.push(Operation::Number(value));
        match self.text[self.at..].chars().next() {
            Some(c) if c.is_alphanumeric() || c == '_' => {
                Err((self.at, format!("an operator is missing here: a product is written {number}*{c}")))
            }
            _ => Ok(()),
        }
    }

    fn name(&mut self) -> Read<()> {
        let start = self.at;
        let rest = &self.text[start..];
        let name = &rest[..rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len())];
        self.at += name.len();
        if let Some(which) = self.variables.iter().position(|variable| *variable == name) {
            self.operations.push(Operation::Variable(which));
        } else if let Some((_, value)) = CONSTANTS.iter().find(|(constant, _)| *constant == name) {
            self.operations.push(Operation::Number(*value));
        } else if let Some((_, function)) = FUNCTIONS.iter().find(|(function, _)| *function == name) {
            self.values(name, 1)?;
            self.operations.push(Operation::Unary(*function));
        } else if let Some((_, function)) = PAIRS.iter().find(|(function, _)| *function == name) {
            self.values(name, 2)?;
            self.operations.push(Operation::Binary(*function));
        } else {
            return Err((start, unknown(name, self.variables)));
        }
        Ok(())
    }

    /// Parses the arguments of a function, in brackets.
    fn values(&mut self, function: &str, count: usize) -> Read<()> {
        let of = if count == 1 { "(…)" } else { "(…, …)" };
        let open = self.at;
        if self.next() != Some('(') {
            return Err((self.at, format!("`{function}` needs its value in brackets: {function}{of}")));
        }
        self.at += 1;
        for left in (0..count).rev() {
            self.sum()?;
            if left > 0 {
                match self.next() {
                    Some(',') => self.at += 1,
                    _ => return Err((self.at, format!("a comma and another value are missing: {function}{of}"))),
                }
            }
        }
        if self.next() == Some(',') {
            return Err((self.at, format!("`{function}` has too many values: {function}{of} (decimals have a point)")));
        }
        self.close(open)
    }

    fn close(&mut self, open: usize) -> Read<()> {
        match self.next() {
            Some(')') => {
                self.at += 1;
                Ok(())
            }
            None => Err((open, "this bracket is not closed".into())),
            Some(c) => Err((self.at, self.unexpected(c))),
        }
    }

    /// Advances to the next character that is not a space, and returns it.
    fn next(&mut self) -> Option<char> {
        let rest = &self.text[self.at..];
        self.at += rest.len() - rest.trim_start().len();
        self.text[self.at..].chars().next()
    }

    fn unexpected(&self, c: char) -> String {
        match c {
            ')' => "this bracket was not opened".into(),
            ',' => "a comma stands between the values of a function only; decimals have a point".into(),
            '(' => "an operator is missing before the bracket".into(),
            c if c.is_alphanumeric() || c == '_' || c == '.' => "an operator is missing here".into(),
            c => format!("`{c}` is not an operator: there are + - * / ^ and brackets"),
        }
    }
}

/// Whether a name is reserved or invalid as the name of a variable.
fn refused_name(name: &str) -> Option<&'static str> {
    let mut letters = name.chars();
    let first = letters.next().is_some_and(|c| c.is_alphabetic() || c == '_');
    if !first || !letters.all(|c| c.is_alphanumeric() || c == '_') {
        return Some("is not a name: a name has letters, digits and _, and begins with a letter");
    }
    if CONSTANTS.iter().any(|(known, _)| *known == name) {
        return Some("is a constant: choose another name");
    }
    let function = FUNCTIONS.iter().any(|(known, _)| *known == name) || PAIRS.iter().any(|(known, _)| *known == name);
    function.then_some("is a function: choose another name")
}

fn unknown(name: &str, variables: &[&str]) -> String {
    fn names<'l, T>(list: &'l [(&'static str, T)]) -> impl DoubleEndedIterator<Item = &'l str> + 'l {
        list.iter().map(|(name, _)| *name)
    }
    let known = variables.iter().copied().chain(names(&CONSTANTS)).chain(names(&FUNCTIONS)).chain(names(&PAIRS));
    let meant = nearest(name, known).map_or_else(String::new, |near| format!(" (did you mean `{near}`?)"));
    let what = match variables {
        [] => "no variable".into(),
        _ => format!("not one of the variables {}", variables.join(", ")),
    };
    format!(
        "`{name}` is {what}{meant}, nor a constant: pi, tau, e, nor a function: {}, {}",
        names(&FUNCTIONS).collect::<Vec<_>>().join(", "),
        names(&PAIRS).map(|pair| format!("{pair}(a, b)")).collect::<Vec<_>>().join(", "),
    )
}

/// Error message with the surrounding text and a mark below the position.
fn marked(text: &str, at: usize, what: &str) -> String {
    let before: Vec<char> = text[..at].chars().rev().take(AROUND + 1).collect();
    let after: Vec<char> = text[at..].chars().take(AROUND + 1).collect();
    let cut = |near: &[char]| if near.len() > AROUND { "…" } else { "" };
    let left: String = before.iter().take(AROUND).rev().collect();
    let right: String = after.iter().take(AROUND).collect();
    let (left, right) = (format!("{}{}", cut(&before), in_line(&left)), format!("{}{}", in_line(&right), cut(&after)));
    let mark = " ".repeat(left.chars().count());
    format!("\"{left}{right}\" cannot be read: {what}\n    {left}{right}\n    {mark}^")
}
