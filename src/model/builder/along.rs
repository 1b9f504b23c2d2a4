//! Friction of a contact in a case: parameters of laws, some of which vary along the slave and in time.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt;

use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::de::{MapAccess, Visitor};
use serde::ser::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::error::{Checked, ModelError};
use super::friction::Friction;
use crate::laws::friction::FrictionParameters;
use crate::laws::parameter::UnknownParameter;
use crate::mesh::names::nearest;
use crate::model::boundary::Profile;

/// Friction parameters that vary along the slave and in time: expressions may depend on x, y and the run time t.
#[derive(Clone, Debug, Default, Serialize, JsonSchema)]
#[non_exhaustive]
#[must_use]
pub struct Along {
    /// Other laws than `friction` on parts of the slave; where several apply, the first one is used
    #[schemars(default)]
    pub law: Vec<LawChoice>,
    /// Parameters of `friction`, by name: they replace the numbers given there. A rate is averaged over an increment,
    /// any other parameter takes its value at the end. Those of the start (structure, theta) and alpha_t do not vary in time
    #[serde(flatten)]
    pub parameters: BTreeMap<String, Profile>,
}

impl Along {
    /// Adds a parameter that varies.
    pub fn parameter(mut self, name: impl Into<String>, profile: impl Into<Profile>) -> Self {
        self.parameters.insert(name.into(), profile.into());
        self
    }

    /// Adds another law on a part of the slave.
    pub fn law(mut self, law: LawChoice) -> Self {
        self.law.push(law);
        self
    }

    /// Whether nothing varies.
    pub fn is_empty(&self) -> bool {
        self.law.is_empty() && self.parameters.is_empty()
    }
}

/// A law on a part of the slave.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
#[must_use]
pub struct LawChoice {
    /// The law applies where this expression is positive
    #[serde(rename = "where")]
    pub place: Profile,
    /// Friction law
    pub friction: FrictionParameters,
    /// Parameters that vary along the slave and in time, by name
    #[serde(default)]
    pub along: BTreeMap<String, Profile>,
}

impl LawChoice {
    /// Creates the choice of a law where a profile is positive.
    pub fn new(place: impl Into<Profile>, friction: impl Into<FrictionParameters>) -> Self {
        Self { place: place.into(), friction: friction.into(), along: BTreeMap::new() }
    }

    /// Adds a parameter that varies.
    pub fn parameter(mut self, name: impl Into<String>, profile: impl Into<Profile>) -> Self {
        self.along.insert(name.into(), profile.into());
        self
    }
}

impl<'de> Deserialize<'de> for Along {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(Entries)
    }
}

/// Reads entry by entry, so that an error is reported with its place.
struct Entries;

impl<'de> Visitor<'de> for Entries {
    type Value = Along;

    fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str("parameters of the friction law by name")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<Along, A::Error> {
        let mut along = Along::default();
        while let Some(name) = entries.next_key::<String>()? {
            match name.as_str() {
                "law" => along.law = entries.next_value()?,
                _ => drop(along.parameters.insert(name, entries.next_value()?)),
            }
        }
        Ok(along)
    }
}

/// Friction is written as the parameters of its law; a law from code cannot be written.
impl Serialize for Friction {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let lacks = || S::Error::custom("a friction law from code cannot be written as a case: give it by parameters");
        self.parameters().ok_or_else(lacks)?.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Friction {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        FrictionParameters::deserialize(deserializer).map(Self::from)
    }
}

impl JsonSchema for Friction {
    fn schema_name() -> Cow<'static, str> {
        FrictionParameters::schema_name()
    }

    fn schema_id() -> Cow<'static, str> {
        FrictionParameters::schema_id()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        FrictionParameters::json_schema(generator)
    }
}

/// Returns the laws with their varying parameters replaced, including an initial structure.
pub fn friction(given: &Friction, along: &Along, structure: Option<&Profile>, place: &str) -> Checked<Friction> {
    let Some(parameters) = given.parameters() else {
        return match along.is_empty() && structure.is_none() {
            true => Ok(given.clone()),
            false => {
                let message =
                    "is a law from code, of which no parameter is known by name: let it vary by Friction::varying";
                Err(ModelError::new(format!("{place}.friction"), message))
            }
        };
    };
    let mut varying = profiles(&along.parameters, "along");
    if let Some(structure) = structure {
        let place = format!("{place}.initial.structure");
        if !parameters.has_structure() {
            return Err(ModelError::new(place, "this friction law has no structure: leave it out"));
        }
        if along.parameters.contains_key("structure") {
            return Err(ModelError::new(place, "is given by `along` already: leave one of them out"));
        }
        varying.push(("structure".into(), "initial.structure".into(), structure.clone()));
    }
    let mut friction = with_varying(parameters.clone(), varying, place, "friction")?;
    for (k, LawChoice { place: positive, friction: law, along }) in along.law.iter().enumerate() {
        let name = format!("along.law[{k}]");
        let varying = profiles(along, &format!("{name}.along"));
        let other = with_varying(law.clone(), varying, place, &format!("{name}.friction"))?;
        friction = friction.in_region(&name, positive.clone(), other);
    }
    Ok(friction)
}

/// Name of a parameter, its place in the contact, and its profile.
type Varying = (String, String, Profile);

fn profiles(along: &BTreeMap<String, Profile>, within: &str) -> Vec<Varying> {
    along.iter().map(|(name, profile)| (name.clone(), format!("{within}.{name}"), profile.clone())).collect()
}

/// Returns a law with varying parameters; its place in the contact is `own`.
fn with_varying(parameters: FrictionParameters, varying: Vec<Varying>, place: &str, own: &str) -> Checked<Friction> {
    if let Some(message) = parameters.unknown() {
        return Err(ModelError::new(format!("{place}.{own}.name"), message));
    }
    if varying.is_empty() {
        return Ok(parameters.into());
    }
    // The replaced numbers must be valid as well; any α_t serves for the check.
    parameters.build(1.0).map_err(|error| ModelError::new(format!("{place}.{own}"), error))?;
    let names: Vec<[String; 2]> =
        varying.iter().map(|(name, within, _)| [name.clone(), format!("{place}.{within}")]).collect();
    let profiles: Vec<(String, Profile)> = varying.into_iter().map(|(_, within, profile)| (within, profile)).collect();
    Ok(Friction::varying(profiles, move |values, alpha_t| {
        let mut parameters = parameters.clone();
        for ([name, place], &value) in names.iter().zip(values) {
            parameters = parameters.with(name, value).map_err(|error| ModelError::new(place, unknown(&error)))?;
        }
        Ok(parameters.build(alpha_t)?)
    }))
}

/// Message for an unknown parameter, with the most similar known one.
fn unknown(UnknownParameter { name, known }: &UnknownParameter) -> String {
    let known: Vec<&str> = known.iter().map(String::as_str).collect();
    let meant =
        nearest(name, known.iter().copied()).map_or(String::from("."), |near| format!("; did you mean `{near}`?"));
    format!("`{name}` is not known here{meant} Known are `{}`", known.join("`, `"))
}
