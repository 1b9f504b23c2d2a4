//! Meshes of blocks: parameters and expressions become numbers.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};

use crate::case::error::{Checked, Complaint};
use crate::case::file::{Amount, BlockInput, BlocksInput, GradingInput};
use crate::mesh::{Block, BlockError, Blocks, Grading, InlineMesh};
use crate::model::boundary::Expression;

/// The mesh of blocks that stands at a place.
pub fn blocks(input: &BlocksInput, place: &str) -> Checked<InlineMesh> {
    let at = |rest: &str| if place.is_empty() { rest.to_string() } else { format!("{place}.{rest}") };
    let parameters = parameters(&input.parameters, &at("parameters"))?;
    let block = |(b, input): (usize, &BlockInput)| block(input, &parameters, &at(&format!("blocks[{b}]")));
    let blocks = input.blocks.iter().enumerate().map(block).collect::<Checked<_>>()?;
    if let Some(name) = input.parameters.keys().find(|name| !parameters.words.borrow().contains(*name)) {
        let message = "stands in no expression of the mesh, so it changes nothing: use it, or leave it out";
        return Err(Complaint::new(at(&format!("parameters.{name}")), message));
    }
    let complain = |BlockError { place, message }| Complaint::new(at(&place), message);
    Blocks { blocks, apart: input.apart.clone() }.mesh().map_err(complain)
}

/// Numbers by their names.
#[derive(Default)]
struct Parameters<'p> {
    names: Vec<&'p str>,
    numbers: Vec<f64>,
    /// words of the expressions that were read
    words: RefCell<BTreeSet<String>>,
}

/// Those that others depend on come first, whatever their order.
fn parameters<'p>(input: &'p BTreeMap<String, Amount>, place: &str) -> Checked<Parameters<'p>> {
    if let Some((name, why)) = input.keys().find_map(|name| Some((name, Expression::refused_name(name)?))) {
        return Err(Complaint::new(format!("{place}.{name}"), why));
    }
    let mut known = Parameters::default();
    let mut left: Vec<_> = input.iter().collect();
    while !left.is_empty() {
        let values: Vec<_> =
            left.iter().map(|(name, amount)| known.value(amount, &format!("{place}.{name}"))).collect();
        let before = left.len();
        let mut complaint = None;
        let mut waiting = Vec::new();
        for ((name, amount), value) in left.into_iter().zip(values) {
            match value {
                Ok(value) => {
                    known.names.push(name);
                    known.numbers.push(value);
                }
                Err(error) => {
                    complaint.get_or_insert(error);
                    waiting.push((name, amount));
                }
            }
        }
        left = waiting;
        if let Some(complaint) = complaint.filter(|_| left.len() == before) {
            return Err(complaint);
        }
    }
    Ok(known)
}

impl Parameters<'_> {
    fn value(&self, amount: &Amount, place: &str) -> Checked<f64> {
        match amount {
            Amount::Number(value) => Ok(*value),
            Amount::Expression(text) => self.expression(text, place),
        }
    }

    fn expression(&self, text: &str, place: &str) -> Checked<f64> {
        let words = text.split(|c: char| !(c.is_alphanumeric() || c == '_')).map(String::from);
        self.words.borrow_mut().extend(words);
        Expression::constant(text, &self.names, &self.numbers).map_err(|message| Complaint::new(place, message))
    }

    fn point(&self, [x, y]: &[Amount; 2], place: &str) -> Checked<[f64; 2]> {
        Ok([self.value(x, &format!("{place}[0]"))?, self.value(y, &format!("{place}[1]"))?])
    }

    /// A whole number, but for the round-off of its expression.
    fn count(&self, amount: &Amount, place: &str) -> Checked<usize> {
        let value = self.value(amount, place)?;
        if !(value > 0.5 && value < 1e15 && (value - value.round()).abs() <= 1e-9 * value) {
            let message = format!("is {value}: must be a whole number, 1 or more, such as \"round(L/h)\" gives");
            return Err(Complaint::new(place, message));
        }
        Ok(value.round() as usize)
    }

    fn grading(&self, input: &GradingInput, place: &str) -> Checked<Grading> {
        Ok(match input {
            GradingInput::Ratio(ratio) => Grading::Ratio(*ratio),
            GradingInput::Expression(text) => Grading::Ratio(self.expression(text, place)?),
            GradingInput::Middle(input) => Grading::Middle(self.value(&input.middle, &format!("{place}.middle"))?),
        })
    }
}

fn block(input: &BlockInput, parameters: &Parameters, place: &str) -> Checked<Block> {
    let mut block = Block::new(&input.body, [[0.0; 2]; 4], [1, 1]);
    for k in 0..4 {
        block.corners[k] = parameters.point(&input.corners[k], &format!("{place}.corners[{k}]"))?;
        let centre = |centre| parameters.point(centre, &format!("{place}.arcs[{k}]"));
        block.arcs[k] = input.arcs[k].as_ref().map(centre).transpose()?;
    }
    for k in 0..2 {
        block.elements[k] = parameters.count(&input.elements[k], &format!("{place}.elements[{k}]"))?;
        block.grading[k] = parameters.grading(&input.grading[k], &format!("{place}.grading[{k}]"))?;
    }
    Ok(Block { kind: input.kind, sides: input.sides.clone(), ..block })
}
