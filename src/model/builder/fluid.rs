//! Pressure of a fluid at a contact: as it is given, measured, or that of pores, with its checks.

use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::conduit_input::Flow;
use super::error::{Checked, ModelError};
use super::friction::check_in_time;
use super::groups::TIMES;
use crate::contact::pair::{BadPressure, ContactPair, Fluid};
use crate::mesh::Mesh;
use crate::model::Model;
use crate::model::boundary::{Profile, RandomField};
use crate::model::measured::Measured;
use crate::model::text::{number, vector};
use crate::model::written::Written;

/// Pressure of a fluid at a contact.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum FluidPressure {
    /// That of the fluid in the pores of the slave's bodies
    OfBodies,
    /// That of a fluid between the surfaces
    Given(Profile),
    /// The same, from a table of time and place
    Measured(Measured),
    /// That of water which flows along the contact
    Flow(Box<Flow>),
}

/// Forms of the object of a fluid pressure.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum FluidObject {
    X(Vec<[f64; 2]>),
    Y(Vec<[f64; 2]>),
    Random(Box<RandomField>),
    Measured(Measured),
    Flow(Box<Flow>),
}

/// Forms of a fluid pressure, for the schema.
#[derive(JsonSchema)]
#[serde(untagged, deny_unknown_fields)]
#[allow(dead_code, reason = "it describes the forms that are read")]
pub enum FluidForms {
    /// By place
    Profile(Profile),
    /// By time and place
    Measured {
        /// Table of pressures by time and place
        measured: Measured,
    },
    /// By flow along the contact
    Flow {
        /// Water that flows along the contact
        flow: Box<Flow>,
    },
}

const OF_BODIES: &str = "of_bodies";

impl Written for FluidPressure {
    const EXPECTING: &'static str = "\"of_bodies\", a number, an expression in x, y and t such as \"1 + 0.1*x\", {\"x\": [[x, v], …]}, \
                                     {\"measured\": {\"file\": …}} or {\"flow\": {…}}";

    fn number(value: f64) -> Option<Self> {
        Profile::number(value).map(Self::Given)
    }

    fn text<E: serde::de::Error>(text: &str) -> Result<Self, E> {
        if text == OF_BODIES { Ok(Self::OfBodies) } else { Profile::text(text).map(Self::Given) }
    }

    fn object<'de, D: Deserializer<'de>>(object: D) -> Result<Self, D::Error> {
        Ok(match FluidObject::deserialize(object)? {
            FluidObject::X(table) => Self::Given(Profile::X(table)),
            FluidObject::Y(table) => Self::Given(Profile::Y(table)),
            FluidObject::Random(field) => Self::Given(Profile::Random(field)),
            FluidObject::Measured(measured) => Self::Measured(measured),
            FluidObject::Flow(flow) => Self::Flow(flow),
        })
    }
}

impl<'de> Deserialize<'de> for FluidPressure {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Self::read(deserializer)
    }
}

impl Serialize for FluidPressure {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::OfBodies => serializer.serialize_str(OF_BODIES),
            Self::Given(pressure) => Serialize::serialize(pressure, serializer),
            Self::Measured(measured) => FluidObject::Measured(measured.clone()).serialize(serializer),
            Self::Flow(flow) => FluidObject::Flow(flow.clone()).serialize(serializer),
        }
    }
}

conversions! {
    Flow => FluidPressure: |flow| Self::Flow(Box::new(flow));
    Measured => FluidPressure: |measured| Self::Measured(measured);
}

impl FluidPressure {
    /// Whether it varies in time by itself.
    fn varies(&self) -> bool {
        match self {
            // What flows is known in the run only.
            Self::OfBodies | Self::Flow(_) => false,
            Self::Given(pressure) => pressure.depends_on_time(),
            Self::Measured(measured) => measured.table.times.len() > 1,
        }
    }
}

/// Returns the fluid of a contact, if it has one.
pub fn fluid(place: &str, given: Option<&FluidPressure>, nodes: &[usize], mesh: &Mesh) -> Checked<Option<Fluid>> {
    let place = format!("{place}.fluid_pressure");
    match given.cloned() {
        // Water that flows has its own conduit.
        None | Some(FluidPressure::OfBodies | FluidPressure::Flow(_)) => Ok(None),
        Some(FluidPressure::Given(pressure)) => {
            check_in_time(&pressure, &place)?;
            Ok(Some(Fluid::new(move |at, time| pressure.value_at(at, time))))
        }
        Some(FluidPressure::Measured(mut measured)) => {
            measured.resolve(nodes, mesh).map_err(|message| ModelError::new(&place, message))?;
            Ok(Some(of_table(measured)))
        }
    }
}

/// The fluid of a table.
pub fn of_table(measured: Measured) -> Fluid {
    let corners = measured.table.times.clone();
    let fluid = match measured.is_nodal() {
        true => Fluid::at_nodes(move |node, time| measured.at_node(node, time)),
        false => Fluid::new(move |at, time| measured.value_at(at, time)),
    };
    fluid.with_corners(corners)
}

/// Checks that a fluid pressure is not negative.
pub fn check_fluid(pair: &ContactPair, place: &str, model: &Model, time: f64) -> Checked<()> {
    let Some(BadPressure { at, pressure }) = pair.bad_fluid_pressure(&model.mesh.undeformed(), time) else {
        return Ok(());
    };
    let message = format!(
        "is {} at {} and t = {}: must be a finite number, zero or positive, which pushes the surfaces apart",
        number(pressure),
        vector(at),
        number(time)
    );
    Err(ModelError::new(format!("{place}.fluid_pressure"), message))
}

/// Maximum number of values of fluid pressures that are checked before the run.
const VALUES: usize = 2_000_000;

/// Checks fluid pressures at evenly spaced times of the steps, as long as their times are certain; times in between are checked
/// during the run.
pub fn check_fluids_in_time<'a>(given: impl Iterator<Item = Option<&'a FluidPressure>>, model: &Model) -> Checked<()> {
    for (given, pair) in given.zip(&model.contacts) {
        if !given.is_some_and(FluidPressure::varies) {
            continue;
        }
        let looks = (VALUES / (pair.points.len().max(1) * model.steps.len().max(1))).clamp(1, TIMES as usize) as u32;
        for step in &model.steps {
            // Such a step may end immediately, and the times of all later steps are unknown.
            if step.until.is_some() {
                break;
            }
            for time in step.span.times(looks).skip(1) {
                check_fluid(pair, &format!("contacts.{}", pair.name), model, time)?;
            }
        }
    }
    Ok(())
}
