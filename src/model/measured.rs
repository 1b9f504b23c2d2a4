//! Pressures measured at times and places, or at nodes, and pressures of bodies that may be so.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use nalgebra::Vector2;
use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::boundary::{Profile, RandomField};
use super::text::number;
use super::written::Written;
use crate::mesh::Mesh;

/// Pressure measured at times and places: linear between them, in both, and constant outside.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct Measured {
    /// Table of comma-separated numbers, relative to the case file. The first line has the places behind a word, such as "t"; each
    /// further one has a time of the run, and the pressures at the places. Times and places ascend
    pub file: String,
    /// What the places are: the coordinate "x" or "y" of the reference position (of the slave, in a contact), or "nodes", tags of nodes in the mesh
    /// (counted from 0 in a mesh given in place); default "x"
    #[serde(default)]
    pub along: Coordinate,
    /// The table, once it has been read
    #[serde(skip)]
    pub table: Arc<MeasuredTable>,
    /// Column of every node in a table of nodes, once its mesh is known
    #[serde(skip)]
    pub columns: Arc<Vec<Option<usize>>>,
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
    /// Tags of nodes
    Nodes,
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
        Self { file: String::new(), along, table: Arc::new(table), columns: Arc::default() }
    }

    /// Reads its file from a path relative to a folder.
    ///
    /// # Errors
    /// Returns a message if there is none, or if it is no table of ascending times and places.
    pub fn read(&mut self, folder: &Path) -> Result<(), String> {
        let text = std::fs::read_to_string(folder.join(&self.file))
            .map_err(|cause| format!("`{}` cannot be read: {cause}", self.file))?;
        self.table =
            Arc::new(MeasuredTable::from_text(&text).map_err(|message| format!("`{}`: {message}", self.file))?);
        Ok(())
    }

    /// Finds the columns of nodes, all of which a table of nodes must have.
    ///
    /// # Errors
    /// Returns a message if the table is none, or a node has no column.
    pub fn resolve(&mut self, nodes: &[usize], mesh: &Mesh) -> Result<(), String> {
        self.table.check()?;
        if self.along != Coordinate::Nodes {
            return Ok(());
        }
        let columns: BTreeMap<u64, usize> =
            self.table.places.iter().enumerate().map(|(column, tag)| (*tag as u64, column)).collect();
        let mut of_nodes = vec![None; mesh.nodes.len()];
        for &node in nodes {
            let tag = mesh.node_tags[node];
            let column = columns
                .get(&tag)
                .ok_or_else(|| format!("has no pressures of node {tag}: every node needs a column"))?;
            of_nodes[node] = Some(*column);
        }
        self.columns = Arc::new(of_nodes);
        Ok(())
    }

    /// The pressure at a node of a table of nodes, and time.
    pub fn at_node(&self, node: usize, time: f64) -> f64 {
        self.columns.get(node).copied().flatten().map_or(f64::NAN, |column| self.table.at(time, [column, column], 0.0))
    }

    /// Whether it is a table of nodes.
    pub fn is_nodal(&self) -> bool {
        self.along == Coordinate::Nodes
    }

    /// The pressure at a reference position and time.
    pub fn value_at(&self, at: Vector2<f64>, time: f64) -> f64 {
        self.table.value(time, if self.along == Coordinate::Y { at.y } else { at.x })
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
                value.ok_or_else(|| format!("line {}, column {}: `{cell}` is not a number", k + 1, column + 1))
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
    ///
    /// # Errors
    /// Returns a message if they do not.
    pub fn check(&self) -> Result<(), String> {
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
        let (columns, right) = between(&self.places, place);
        self.at(time, columns, right)
    }

    /// Value at a time, a share `right` of the way between two columns.
    fn at(&self, time: f64, [column, next_column]: [usize; 2], right: f64) -> f64 {
        let ([row, next_row], up) = between(&self.times, time);
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

/// Pressure of a body by place and time.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum PoreField {
    /// A number, a table of places or an expression
    Given(Profile),
    /// A table of times and places, or of times and nodes
    Measured(Measured),
}

impl<P: Into<Profile>> From<P> for PoreField {
    fn from(profile: P) -> Self {
        Self::Given(profile.into())
    }
}

/// Forms of the objects of a pressure.
#[derive(Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum PressureObject {
    /// By x
    X(Vec<[f64; 2]>),
    /// By y
    Y(Vec<[f64; 2]>),
    /// At random
    Random(Box<RandomField>),
    /// By time and place, or node
    Measured(Measured),
}

impl From<PressureObject> for PoreField {
    fn from(object: PressureObject) -> Self {
        match object {
            PressureObject::X(table) => Self::Given(Profile::X(table)),
            PressureObject::Y(table) => Self::Given(Profile::Y(table)),
            PressureObject::Random(field) => Self::Given(Profile::Random(field)),
            PressureObject::Measured(measured) => Self::Measured(measured),
        }
    }
}

/// Forms of a pressure that is given, for the schema.
#[derive(JsonSchema)]
#[serde(untagged, deny_unknown_fields)]
pub enum GivenPressure {
    /// By place
    Profile(Profile),
    /// By time and place
    Measured {
        /// Table of pressures by time and place
        measured: Measured,
    },
}

impl Written for PoreField {
    const EXPECTING: &'static str = "a number, an expression in x, y and t such as \"1 + 0.1*x\", {\"x\": [[x, v], …]}, or \
                                     {\"measured\": {\"file\": …}}";

    fn number(value: f64) -> Option<Self> {
        Profile::number(value).map(Self::Given)
    }

    fn text<E: serde::de::Error>(text: &str) -> Result<Self, E> {
        Profile::text(text).map(Self::Given)
    }

    fn object<'de, D: Deserializer<'de>>(object: D) -> Result<Self, D::Error> {
        PressureObject::deserialize(object).map(Self::from)
    }
}

impl<'de> Deserialize<'de> for PoreField {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Self::read(deserializer)
    }
}

impl Serialize for PoreField {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Given(pressure) => Serialize::serialize(pressure, serializer),
            Self::Measured(measured) => Serialize::serialize(&PressureObject::Measured(measured.clone()), serializer),
        }
    }
}

impl PoreField {
    /// Whether it varies in time.
    pub fn depends_on_time(&self) -> bool {
        match self {
            Self::Given(profile) => profile.depends_on_time(),
            Self::Measured(measured) => measured.table.times.len() > 1,
        }
    }

    /// The table, if it is one of nodes.
    pub fn nodal(&self) -> Option<&Measured> {
        match self {
            Self::Measured(measured) if measured.is_nodal() => Some(measured),
            _ => None,
        }
    }

    /// Value at a reference position and time; NaN of a table of nodes, which has none between them.
    pub fn value_at(&self, at: Vector2<f64>, time: f64) -> f64 {
        match self {
            Self::Given(profile) => profile.value_at(at, time),
            Self::Measured(measured) if measured.is_nodal() => f64::NAN,
            Self::Measured(measured) => measured.value_at(at, time),
        }
    }

    /// Value at a node and time.
    pub fn at_node(&self, node: usize, mesh: &Mesh, time: f64) -> f64 {
        self.nodal().map_or_else(|| self.value_at(mesh.nodes[node], time), |table| table.at_node(node, time))
    }
}
