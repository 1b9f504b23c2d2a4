//! Points of the bodies that are watched, as they are written.

use schemars::JsonSchema;
use serde::Deserialize;

/// A gauge: a point given by `at`, or a line of points given by `from`, `to` and `number`; places are undeformed ones.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ProbeInput {
    /// The point [x, y]
    pub at: Option<[f64; 2]>,
    /// Where a line begins [x, y]
    pub from: Option<[f64; 2]>,
    /// Where it ends [x, y]
    pub to: Option<[f64; 2]>,
    /// How many points it has, both ends included; the k-th is called NAME.k, from 1
    pub number: Option<usize>,
    /// The body, needed where two bodies touch
    pub body: Option<String>,
}
