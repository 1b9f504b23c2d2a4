//! Loading plates as they are written.

use schemars::JsonSchema;
use serde::{Deserialize, Deserializer};

use crate::case::choice::Choice;

/// A loading plate.
#[derive(Clone, Debug, JsonSchema)]
#[schemars(untagged)]
pub enum LoadingPlateInput {
    /// Group that moves as one, without turning
    Group(String),
    /// Group that moves in another way
    Moving(MovingPlateInput),
}

impl<'de> Deserialize<'de> for LoadingPlateInput {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let expecting = "the name of a group, or {\"on\": group, \"moves\": \"ux_alike\", \"uy_alike\" or \"rigid\"}";
        Choice { expecting, number: None, text: Self::Group, object: Self::Moving }.read(deserializer)
    }
}

/// A loading plate that moves in another way than as one.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MovingPlateInput {
    /// Group of its nodes
    pub on: String,
    /// How they move
    pub moves: PlateMotion,
}

/// How the nodes of a loading plate move.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum PlateMotion {
    /// Alike, without turning: what the name of the group alone says
    AsOne,
    /// Alike in x, each as it will in y: a greased plate
    UxAlike,
    /// Alike in y, each as it will in x
    UyAlike,
    /// As a rigid body, which turns under forces, springs and a `moment`; supports hold at most one of its nodes
    Rigid,
}

impl LoadingPlateInput {
    /// Its group, and how it moves.
    pub fn parts(&self) -> (&str, PlateMotion) {
        match self {
            Self::Group(name) => (name, PlateMotion::AsOne),
            Self::Moving(MovingPlateInput { on, moves }) => (on, *moves),
        }
    }
}
