//! A mesh of blocks, as it is written.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize};

use crate::mesh::{BlockKind, InlineMesh};
use crate::model::written::Written;

/// A mesh of blocks: quadrilaterals with straight sides or arcs, each divided into rows and columns of elements. Blocks of one body
/// that share a whole side are joined there, with the same nodes; those of different bodies never are
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
    pub apart: Vec<String>,
}

/// A quadrilateral divided into elements. Side k goes from corner k to the next one, in the order in which the corners are given
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BlockInput {
    /// Name of the body that its elements belong to
    pub body: String,
    /// The four corners [x, y] in order around the block, clockwise or counterclockwise [L]
    pub corners: [[Amount; 2]; 4],
    /// For each side null where it is straight, or the centre [x, y] of the circle through its two corners: it is the shorter arc
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
    /// For each side its name, or null: edges of a name are a group for contacts, supports and loads
    #[serde(default)]
    pub sides: [Option<String>; 4],
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
    /// Size of the last element over that of the first
    Ratio(f64),
    /// Size of the last element over that of the first, as an expression in the parameters
    Expression(String),
    /// Finer or coarser in the middle
    Middle(MiddleInput),
}

impl Default for GradingInput {
    fn default() -> Self {
        Self::Ratio(1.0)
    }
}

impl Written for GradingInput {
    const EXPECTING: &'static str = "the ratio of the last size to the first, or {\"middle\": ratio of the size in the middle to those at the ends}";

    fn number(value: f64) -> Option<Self> {
        Some(Self::Ratio(value))
    }

    fn text(text: &str) -> Result<Self, String> {
        Ok(Self::Expression(text.into()))
    }

    fn object<'de, D: Deserializer<'de>>(object: D) -> Result<Self, D::Error> {
        MiddleInput::deserialize(object).map(Self::Middle)
    }
}

impl<'de> Deserialize<'de> for GradingInput {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Self::read(deserializer)
    }
}

/// Equal sizes at both ends, with another in the middle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MiddleInput {
    /// Size in the middle over that at both ends
    pub middle: Amount,
}

/// A mesh that stands in the case, node by node or as blocks.
#[derive(Clone, Debug, Deserialize)]
#[serde(try_from = "MeshKeys")]
pub enum MeshInPlace {
    /// Node by node
    Inline(InlineMesh),
    /// Blocks
    Blocks(BlocksInput),
}

/// All keys of both forms.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MeshKeys {
    nodes: Option<Vec<[f64; 2]>>,
    elements: Option<BTreeMap<String, Vec<Vec<usize>>>>,
    edges: Option<BTreeMap<String, Vec<Vec<usize>>>>,
    points: Option<BTreeMap<String, Vec<usize>>>,
    blocks: Option<Vec<BlockInput>>,
    parameters: Option<BTreeMap<String, Amount>>,
    apart: Option<Vec<String>>,
}

impl TryFrom<MeshKeys> for MeshInPlace {
    type Error = String;

    fn try_from(keys: MeshKeys) -> Result<Self, String> {
        let MeshKeys { nodes, elements, edges, points, blocks, parameters, apart } = keys;
        let given = |pairs: &[(&'static str, bool)]| pairs.iter().find(|(_, given)| *given).map(|(key, _)| *key);
        let of_nodes = [
            ("nodes", nodes.is_some()),
            ("elements", elements.is_some()),
            ("edges", edges.is_some()),
            ("points", points.is_some()),
        ];
        let of_blocks = [("parameters", parameters.is_some()), ("apart", apart.is_some())];
        match (blocks, given(&of_nodes), given(&of_blocks)) {
            (Some(blocks), None, _) => {
                let (parameters, apart) = (parameters.unwrap_or_default(), apart.unwrap_or_default());
                Ok(Self::Blocks(BlocksInput { parameters, blocks, apart }))
            }
            (Some(_), Some(key), _) => {
                Err(format!("has both `blocks` and `{key}`: give blocks, or nodes with their elements and edges"))
            }
            (None, _, Some(key)) => Err(format!("has `{key}` without `blocks`: it belongs to a mesh of blocks")),
            (None, _, None) => Ok(Self::Inline(InlineMesh {
                nodes: nodes.ok_or("missing field `nodes`")?,
                elements: elements.unwrap_or_default(),
                edges: edges.unwrap_or_default(),
                points: points.unwrap_or_default(),
            })),
        }
    }
}
