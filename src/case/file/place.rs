//! Where supports and loads act, and whether they end.

use schemars::JsonSchema;
use serde::{Deserialize, Deserializer};

use crate::case::choice::Choice;

/// A group or a single node.
#[derive(Clone, Debug, PartialEq, JsonSchema)]
#[schemars(untagged)]
pub enum Place {
    /// Group of the mesh
    Group(String),
    /// Single node
    Node(NodeInput),
}

impl<'de> Deserialize<'de> for Place {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let expecting = "the name of a group, or {\"node\": tag}";
        Choice { expecting, number: None, text: Self::Group, object: Self::Node }.read(deserializer)
    }
}

/// A single node.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NodeInput {
    /// Its tag in the mesh file (its number from 0 in a mesh given in place)
    pub node: u64,
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        match self {
            Self::Group(name) => f.write_str(name),
            Self::Node(NodeInput { node }) => write!(f, "node {node}"),
        }
    }
}

/// Tell a key that is `null` (Some(None)) from one that is absent (None, by default).
pub fn present<'de, T: Deserialize<'de>, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Option<T>>, D::Error> {
    Option::deserialize(deserializer).map(Some)
}
