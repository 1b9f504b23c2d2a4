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
        let message = "is not used in any expression of the mesh: use it, or leave it out";
        return Err(Complaint::new(at(&format!("parameters.{name}")), message));
    }
    let complain = |BlockError { place, message }| Complaint::new(at(&place), message);
    Blocks { blocks, apart: input.apart.clone() }.mesh().map_err(complain)
}

/// Numbers by their names.
#[derive(Default)]
struct Parameters<'p> {
    numbers: BTreeMap<&'p str, f64>,
    /// words of the expressions that were read
    words: RefCell<BTreeSet<String>>,
}

/// Words of an expression: names, among others.
fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !(c.is_alphanumeric() || c == '_'))
}

/// Evaluates the parameters in order of dependence, whatever their order in the file.
fn parameters<'p>(input: &'p BTreeMap<String, Amount>, place: &str) -> Checked<Parameters<'p>> {
    if let Some((name, why)) = input.keys().find_map(|name| Some((name, Expression::refused_name(name)?))) {
        return Err(Complaint::new(format!("{place}.{name}"), why));
    }
    let needs = |amount: &'p Amount| -> BTreeSet<&'p str> {
        match amount {
            Amount::Number(_) => BTreeSet::new(),
            Amount::Expression(text) => words(text).filter(|word| input.contains_key(*word)).collect(),
        }
    };
    let mut missing: BTreeMap<&str, usize> = BTreeMap::new();
    let mut needed_by: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for (name, amount) in input {
        let needs = needs(amount);
        missing.insert(name, needs.len());
        needs.into_iter().for_each(|other| needed_by.entry(other).or_default().push(name));
    }
    let mut known = Parameters::default();
    let mut refused = BTreeSet::new();
    let mut ready: Vec<&str> = missing.iter().filter(|(_, missing)| **missing == 0).map(|(name, _)| *name).collect();
    while let Some(name) = ready.pop() {
        let Ok(value) = known.value(&input[name], "") else {
            refused.insert(name);
            continue;
        };
        known.numbers.insert(name, value);
        for other in needed_by.remove(name).unwrap_or_default() {
            let left = missing.entry(other).and_modify(|missing| *missing -= 1).or_default();
            ready.extend((*left == 0).then_some(other));
        }
    }
    // What is left depends on what was refused, or on itself. It is reported once everything that can be evaluated has
    // been.
    let left = || input.keys().map(String::as_str).find(|name| !known.numbers.contains_key(name));
    match refused.pop_first().or_else(left) {
        Some(name) => known.value(&input[name], &format!("{place}.{name}")).map(|_| known),
        None => Ok(known),
    }
}

impl Parameters<'_> {
    fn value(&self, amount: &Amount, place: &str) -> Checked<f64> {
        match amount {
            Amount::Number(value) => Ok(*value),
            Amount::Expression(text) => self.expression(text, place),
        }
    }

    fn expression(&self, text: &str, place: &str) -> Checked<f64> {
        self.words.borrow_mut().extend(words(text).map(String::from));
        let constant = |numbers: &BTreeMap<&str, f64>| {
            let (names, numbers): (Vec<&str>, Vec<f64>) = numbers.iter().map(|(name, number)| (*name, *number)).unzip();
            Expression::constant(text, &names, &numbers)
        };
        let own = words(text).filter_map(|word| self.numbers.get_key_value(word));
        let value = constant(&own.map(|(name, number)| (*name, *number)).collect());
        // The message lists all known names.
        value.or_else(|_| constant(&self.numbers)).map_err(|message| Complaint::new(place, message))
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
