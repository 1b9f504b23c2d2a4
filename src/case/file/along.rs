//! Friction that varies along a contact, as it is written.

use std::collections::BTreeMap;
use std::fmt;

use schemars::JsonSchema;
use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer};

use super::profile::ProfileInput;
use crate::laws::friction::FrictionParameters;

/// What of friction varies along the slave, and in time: expressions may have the run time t besides x and y.
#[derive(Clone, Debug, Default, JsonSchema)]
pub struct AlongInput {
    /// Other laws than `friction` on parts of the slave; where several say so, the first holds
    #[schemars(default)]
    pub law: Vec<LawChoiceInput>,
    /// Parameters of `friction`, by name: they replace the numbers given there. A rate enters by its mean over an increment,
    /// any other parameter by its value at the end. Those of the start (structure, theta) and alpha_t do not vary in time
    #[schemars(flatten)]
    pub parameters: BTreeMap<String, ProfileInput>,
}

impl AlongInput {
    /// Whether nothing varies.
    pub fn is_empty(&self) -> bool {
        self.law.is_empty() && self.parameters.is_empty()
    }
}

/// A law on a part of the slave.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LawChoiceInput {
    /// It holds where this is positive
    #[serde(rename = "where")]
    pub place: ProfileInput,
    /// Friction law
    pub friction: FrictionParameters,
    /// Its parameters that vary along the slave, and in time, by name
    #[serde(default)]
    pub along: BTreeMap<String, ProfileInput>,
}

impl<'de> Deserialize<'de> for AlongInput {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(Entries)
    }
}

/// Reads entry by entry, so that a complaint about one names its place.
struct Entries;

impl<'de> Visitor<'de> for Entries {
    type Value = AlongInput;

    fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str("parameters of the friction law by name")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<AlongInput, A::Error> {
        let mut along = AlongInput::default();
        while let Some(name) = entries.next_key::<String>()? {
            match name.as_str() {
                "law" => along.law = entries.next_value()?,
                _ => drop(along.parameters.insert(name, entries.next_value()?)),
            }
        }
        Ok(along)
    }
}
