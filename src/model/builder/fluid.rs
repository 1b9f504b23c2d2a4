//! Pressure of a fluid at a contact: as it is given, measured, or that of pores, with its checks.

use std::path::Path;
use std::sync::Arc;

use nalgebra::Vector2;
use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::error::{Checked, ModelError};
use super::friction::check_in_time;
use super::groups::TIMES;
use crate::contact::pair::{BadPressure, ContactPair, Fluid};
use crate::model::Model;
use crate::model::boundary::{Profile, RandomField};
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
}

const OF_BODIES: &str = "of_bodies";

/// Pressure measured at times and places: linear between them, in both, and constant outside.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
#[must_use]
pub struct Measured {
    /// Table of comma-separated numbers, relative to the case file. The first line has the places behind a word, such as "t"; each
    /// further one has a time of the run, and the pressures at the places. Times and places ascend
    pub file: String,
    /// Coordinate of the places in the reference position of the slave; default "x"
    #[serde(default)]
    pub along: Coordinate,
    /// The table, once it has been read
    #[serde(skip)]
    pub table: Arc<MeasuredTable>,
}

/// Coordinate along which places are measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Coordinate {
    /// x of the reference position
    #[default]
    X,
    /// y of the reference position
    Y,
}

/// Values at times and places.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct MeasuredTable {
    /// ascending [T]
    pub times: Vec<f64>,
    /// ascending [L]
    pub places: Vec<f64>,
    /// row by row, one per time
    pub values: Vec<f64>,
}

impl Measured {
    /// Creates a measured pressure along a coordinate from a table in memory.
    pub fn new(along: Coordinate, table: MeasuredTable) -> Self {
        Self { file: String::new(), along, table: Arc::new(table) }
    }

    /// Reads its file from a path relative to a folder.
    ///
    /// # Errors
    /// Returns [`ModelError`] if there is none, or if it is no table of ascending times and places.
    pub fn read(&mut self, folder: &Path, place: &str) -> Checked<()> {
        let place = format!("{place}.measured.file");
        let text = std::fs::read_to_string(folder.join(&self.file))
            .map_err(|cause| ModelError::new(&place, format!("`{}` cannot be read: {cause}", self.file)))?;
        let table = MeasuredTable::from_text(&text);
        self.table = Arc::new(table.map_err(|message| ModelError::new(&place, format!("`{}`: {message}", self.file)))?);
        Ok(())
    }

    /// The pressure at a reference position and time.
    pub fn value_at(&self, at: Vector2<f64>, time: f64) -> f64 {
        self.table.value(time, if self.along == Coordinate::X { at.x } else { at.y })
    }
}

impl MeasuredTable {
    /// Reads a table: places in the first line, then a time and the values at the places in each line.
    ///
    /// # Errors
    /// Returns a message that names the line.
    pub fn from_text(text: &str) -> Result<Self, String> {
        let lines = text.trim_start_matches('\u{feff}').lines().enumerate();
        let mut lines = lines.filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('#'));
        let numbers = |(k, line): (usize, &str), skip: usize| {
            let cells = line.split([',', ';', '\t']).map(str::trim).enumerate().skip(skip);
            let number = |(column, cell): (usize, &str)| {
                let value = cell.parse::<f64>().ok().filter(|value| value.is_finite());
                value.ok_or_else(|| format!("line {}, column {}: `{cell}` is no number", k + 1, column + 1))
            };
            cells.map(number).collect::<Result<Vec<f64>, String>>()
        };
        let head = lines.next().ok_or("is empty: give places, then a time and the pressures at them in each line")?;
        let mut table = Self { times: Vec::new(), places: numbers(head, 1)?, values: Vec::new() };
        for line in lines {
            let row = numbers(line, 0)?;
            if row.len() != table.places.len() + 1 {
                let (has, needs) = (row.len(), table.places.len() + 1);
                return Err(format!(
                    "line {} has {has} numbers: a time and {} pressures were expected",
                    line.0 + 1,
                    needs - 1
                ));
            }
            table.times.push(row[0]);
            table.values.extend_from_slice(&row[1..]);
        }
        table.check().map(|()| table)
    }

    /// Checks its size, and that times and places ascend.
    fn check(&self) -> Result<(), String> {
        let descends =
            |values: &[f64]| values.windows(2).find(|pair| pair[1] <= pair[0]).map(|pair| [pair[0], pair[1]]);
        if self.times.is_empty() || self.places.is_empty() {
            return Err(
                "has no pressures: give places in the first line, then a time and the pressures at them in each".into(),
            );
        }
        if self.values.len() != self.times.len() * self.places.len() {
            return Err(format!(
                "has {} values for {} times and {} places",
                self.values.len(),
                self.times.len(),
                self.places.len()
            ));
        }
        for (what, values) in [("times", &self.times), ("places", &self.places)] {
            if let Some([before, next]) = descends(values) {
                return Err(format!("the {what} must increase: {} follows {}", number(next), number(before)));
            }
        }
        Ok(())
    }

    /// Value at a time and place.
    pub fn value(&self, time: f64, place: f64) -> f64 {
        let ([row, next_row], up) = between(&self.times, time);
        let ([column, next_column], right) = between(&self.places, place);
        let value = |row: usize, column: usize| self.values[row * self.places.len() + column];
        let along = |row: usize| value(row, column) + right * (value(row, next_column) - value(row, column));
        along(row) + up * (along(next_row) - along(row))
    }
}

/// Neighbours of an argument among ascending ones, and its way from the first to the second; the same twice outside.
fn between(arguments: &[f64], at: f64) -> ([usize; 2], f64) {
    let (after, last) = (arguments.partition_point(|argument| *argument <= at), arguments.len() - 1);
    match after {
        0 => ([0, 0], 0.0),
        _ if after > last => ([last, last], 0.0),
        _ => {
            let [from, to] = [arguments[after - 1], arguments[after]];
            ([after - 1, after], (at - from) / (to - from))
        }
    }
}

/// Forms of the objects of a pressure.
#[derive(Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum PressureObject {
    X(Vec<[f64; 2]>),
    Y(Vec<[f64; 2]>),
    Random(Box<RandomField>),
    Measured(Measured),
}

/// Forms of a pressure that is given, for the schema.
#[derive(JsonSchema)]
#[serde(untagged)]
#[expect(dead_code, reason = "a schema alone")]
pub(super) enum GivenPressure {
    Profile(Profile),
    Measured {
        /// Table of pressures by time and place
        measured: Measured,
    },
}

impl Written for FluidPressure {
    const EXPECTING: &'static str = "\"of_bodies\", a number, an expression in x, y and t such as \"1 + 0.1*x\", {\"x\": [[x, v], …]}, or \
                                     {\"measured\": {\"file\": …}}";

    fn number(value: f64) -> Option<Self> {
        Profile::number(value).map(Self::Given)
    }

    fn text<E: serde::de::Error>(text: &str) -> Result<Self, E> {
        if text == OF_BODIES { Ok(Self::OfBodies) } else { Profile::text(text).map(Self::Given) }
    }

    fn object<'de, D: Deserializer<'de>>(object: D) -> Result<Self, D::Error> {
        Ok(match PressureObject::deserialize(object)? {
            PressureObject::X(table) => Self::Given(Profile::X(table)),
            PressureObject::Y(table) => Self::Given(Profile::Y(table)),
            PressureObject::Random(field) => Self::Given(Profile::Random(field)),
            PressureObject::Measured(measured) => Self::Measured(measured),
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
            Self::Measured(measured) => Serialize::serialize(&PressureObject::Measured(measured.clone()), serializer),
        }
    }
}

impl From<Measured> for FluidPressure {
    fn from(measured: Measured) -> Self {
        Self::Measured(measured)
    }
}

impl FluidPressure {
    /// Whether it varies in time by itself.
    fn varies(&self) -> bool {
        match self {
            Self::OfBodies => false,
            Self::Given(pressure) => pressure.depends_on_time(),
            Self::Measured(measured) => measured.table.times.len() > 1,
        }
    }
}

/// Returns the fluid of a contact, if it has one.
pub fn fluid(place: &str, given: Option<&FluidPressure>) -> Checked<Option<Fluid>> {
    let place = format!("{place}.fluid_pressure");
    match given.cloned() {
        None | Some(FluidPressure::OfBodies) => Ok(None),
        Some(FluidPressure::Given(pressure)) => {
            check_in_time(&pressure, &place)?;
            Ok(Some(Fluid::new(move |at, time| pressure.value_at(at, time))))
        }
        Some(FluidPressure::Measured(measured)) => {
            measured.table.check().map_err(|message| ModelError::new(&place, message))?;
            let corners = measured.table.times.clone();
            Ok(Some(Fluid::new(move |at, time| measured.value_at(at, time)).with_corners(corners)))
        }
    }
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
