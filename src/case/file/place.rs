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
    Spot(SpotInput),
}

impl<'de> Deserialize<'de> for Place {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let expecting = "the name of a group, {\"node\": tag}, or {\"near\": [x, y]}";
        Choice { expecting, number: None, text: Self::Group, object: Self::Spot }.read(deserializer)
    }
}

/// A single node.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SpotInput {
    /// Its tag in the mesh file (its number from 0 in a mesh given in place)
    Node(u64),
    /// The node of the undeformed mesh that is nearest to this point [x, y]. It must be the only one, and no farther away than
    /// the elements there are long [L]
    Near([f64; 2]),
}

/// Tell a key that is `null` (Some(None)) from one that is absent (None, by default).
pub fn present<'de, T: Deserialize<'de>, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Option<T>>, D::Error> {
    Option::deserialize(deserializer).map(Some)
}
