//! Mesh of blocks in a case file, and the evaluation of its parameters and expressions.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};

use schemars::JsonSchema;
use serde::de::Error;
use serde::{Deserialize, Serialize};

use super::MeshSource;
use crate::mesh::{Block, BlockError, BlockKind, Blocks, Grading, InlineMesh};
use crate::model::boundary::Expression;
use crate::model::builder::{Checked, ModelError, refuse_if};
use crate::model::written::written;

/// A mesh of blocks: quadrilaterals with straight sides or arcs, each divided into rows and columns of elements. Blocks of one body
/// that share a whole side are joined there, with the same nodes; those of different bodies only where `joined` says so
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BlocksInput {
    /// Numbers with names of your choice, for the expressions of the blocks; a number, or an expression in other parameters
    #[serde(default)]
    pub parameters: BTreeMap<String, Amount>,
    /// Blocks; nodes are numbered in their order, row by row
    pub blocks: Vec<BlockInput>,
    /// Names of sides that are not joined to others, such as the two sides of a crack in one body
    #[serde(default)]
    pub separated: Vec<String>,
    /// Lists of bodies that are joined with each other, like blocks of one body, where their blocks share a whole side, for
    /// example two materials that are bonded
    #[serde(default)]
    pub joined: Vec<Vec<String>>,
}

/// A quadrilateral divided into elements. Side k runs from corner k to the next one, in the given order of the corners
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BlockInput {
    /// Name of the body that its elements belong to
    pub body: String,
    /// The four corners [x, y] in order around the block, clockwise or counterclockwise [L]
    pub corners: [[Amount; 2]; 4],
    /// For each side null if it is straight, or the centre [x, y] of the circle through its two corners, of which the shorter
    /// arc is used
    #[serde(default)]
    pub arcs: [Option<[Amount; 2]>; 4],
    /// Number of elements along side 0, from corner 0 to corner 1, and along side 1, from corner 1 to corner 2
    pub elements: [Amount; 2],
    /// Grading of their sizes along side 0 and along side 1, as a geometric series; default: uniform
    #[serde(default)]
    pub grading: [GradingInput; 2],
    /// Kind of the elements
    #[serde(default)]
    pub kind: BlockKind,
    /// For each side its name, or null: edges with the same name form a group for contacts, supports and loads
    #[serde(default)]
    pub sides: [Option<String>; 4],
    /// Points [x, y] by a name of your choice: the node of this block nearest to each belongs to the node group of that name,
    /// which points of other blocks may share. The nearest node must be unique, and no farther away than the length of the
    /// elements there [L]
    #[serde(default)]
    pub points: BTreeMap<String, [Amount; 2]>,
}

/// A number that may depend on the parameters of the mesh.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged, expecting = "must be a number, or an expression in the parameters of the mesh, such as \"L/2\"")]
pub enum Amount {
    /// Its value
    Number(f64),
    /// An expression in the parameters, such as "L/2 - H/tan(dip)", with the functions of prescribed quantities
    Expression(String),
}

/// Grading of the element sizes along a side.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum GradingInput {
    /// Size of the last element divided by that of the first
    Ratio(f64),
    /// Size of the last element divided by that of the first, as an expression in the parameters
    Expression(String),
    /// Different size in the middle
    Middle(MiddleInput),
}

impl Default for GradingInput {
    fn default() -> Self {
        Self::Ratio(1.0)
    }
}

written!(
    GradingInput,
    "the ratio of the last size to the first, or {\"middle\": ratio of the size in the middle to those at the ends}",
    number: Ratio,
    text: Expression,
    object: MiddleInput => Self::Middle
);

/// Equal sizes at both ends, with a different one in the middle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MiddleInput {
    /// Size in the middle divided by that at both ends
    pub middle: Amount,
}

/// Keys of a mesh in the case, node by node or as blocks.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MeshKeys {
    nodes: Option<Vec<[f64; 2]>>,
    elements: Option<BTreeMap<String, Vec<Vec<usize>>>>,
    edges: Option<BTreeMap<String, Vec<Vec<usize>>>>,
    points: Option<BTreeMap<String, Vec<usize>>>,
    blocks: Option<Vec<BlockInput>>,
    parameters: Option<BTreeMap<String, Amount>>,
    separated: Option<Vec<String>>,
    joined: Option<Vec<Vec<String>>>,
}

impl MeshKeys {
    /// Returns the mesh, given in one of the two ways.
    pub fn source<E: Error>(self) -> Result<MeshSource, E> {
        let Self { nodes, elements, edges, points, blocks, parameters, separated, joined } = self;
        let given = |pairs: &[(&'static str, bool)]| pairs.iter().find(|(_, given)| *given).map(|(key, _)| *key);
        let of_nodes = [
            ("nodes", nodes.is_some()),
            ("elements", elements.is_some()),
            ("edges", edges.is_some()),
            ("points", points.is_some()),
        ];
        let of_blocks =
            [("parameters", parameters.is_some()), ("separated", separated.is_some()), ("joined", joined.is_some())];
        match (blocks, given(&of_nodes), given(&of_blocks)) {
            (Some(blocks), None, _) => {
                let (parameters, joined) = (parameters.unwrap_or_default(), joined.unwrap_or_default());
                Ok(MeshSource::Blocks(BlocksInput {
                    parameters,
                    blocks,
                    separated: separated.unwrap_or_default(),
                    joined,
                }))
            }
            (Some(_), Some(key), _) => Err(E::custom(format_args!(
                "has both `blocks` and `{key}`: give blocks, or nodes with their elements and edges"
            ))),
            (None, _, Some(key)) => {
                Err(E::custom(format_args!("has `{key}` without `blocks`: it belongs to a mesh of blocks")))
            }
            (None, _, None) => Ok(MeshSource::Inline(InlineMesh {
                nodes: nodes.ok_or_else(|| E::missing_field("nodes"))?,
                elements: elements.unwrap_or_default(),
                edges: edges.unwrap_or_default(),
                points: points.unwrap_or_default(),
            })),
        }
    }
}

/// A place within the mesh at a place.
fn within(place: &str, rest: &str) -> String {
    if place.is_empty() { rest.to_string() } else { format!("{place}.{rest}") }
}

/// Returns the mesh of blocks at a place.
pub fn blocks(input: &BlocksInput, place: &str) -> Checked<InlineMesh> {
    let complain = |error: BlockError| ModelError::new(within(place, &error.place), error.message);
    evaluated(input, place)?.mesh().map_err(complain)
}

/// Returns the blocks at a place, with the numbers of their expressions.
pub fn evaluated(input: &BlocksInput, place: &str) -> Checked<Blocks> {
    let at = |rest: &str| within(place, rest);
    let parameters = parameters(&input.parameters, &at("parameters"))?;
    let block = |(b, input): (usize, &BlockInput)| block(input, &parameters, &at(&format!("blocks[{b}]")));
    let blocks = input.blocks.iter().enumerate().map(block).collect::<Checked<_>>()?;
    if let Some(name) = input.parameters.keys().find(|name| !parameters.words.borrow().contains(*name)) {
        let message = "is not used in any expression of the mesh: use it, or leave it out";
        return Err(ModelError::new(at(&format!("parameters.{name}")), message));
    }
    Ok(Blocks { blocks, separated: input.separated.clone(), joined: input.joined.clone() })
}

/// Values of parameters by name.
#[derive(Default)]
struct Parameters<'p> {
    numbers: BTreeMap<&'p str, f64>,
    /// words used in the expressions so far
    words: RefCell<BTreeSet<String>>,
}

/// Words of an expression, including names.
fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !(c.is_alphanumeric() || c == '_'))
}

/// Evaluates the parameters in order of dependence, whatever their order in the file.
fn parameters<'p>(input: &'p BTreeMap<String, Amount>, place: &str) -> Checked<Parameters<'p>> {
    if let Some((name, why)) = input.keys().find_map(|name| Some((name, Expression::refused_name(name)?))) {
        return Err(ModelError::new(format!("{place}.{name}"), why));
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
    // The remaining parameters depend on a refused one or on themselves. They are reported after everything that can be
    // evaluated.
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
        value.or_else(|_| constant(&self.numbers)).map_err(|message| ModelError::new(place, message))
    }

    fn point(&self, [x, y]: &[Amount; 2], place: &str) -> Checked<[f64; 2]> {
        Ok([self.value(x, &format!("{place}[0]"))?, self.value(y, &format!("{place}[1]"))?])
    }

    /// An integer, within the round-off of its expression.
    fn count(&self, amount: &Amount, place: &str) -> Checked<usize> {
        let value = self.value(amount, place)?;
        let message = format!("is {value}: must be a whole number, 1 or more, such as \"round(L/h)\" gives");
        refuse_if(!(value > 0.5 && value < 1e15 && (value - value.round()).abs() <= 1e-9 * value), place, message)?;
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
    for (name, near) in &input.points {
        let near = parameters.point(near, &format!("{place}.points.{name}"))?;
        block.points.insert(name.clone(), near);
    }
    Ok(Block { kind: input.kind, sides: input.sides.clone(), ..block })
}
