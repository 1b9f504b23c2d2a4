//! `summary.json`: outcome and cost of a run or law test.

use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::csv::failed;
use super::files;
use super::friction_history::FrictionHistory;
use super::gradients::Account;
use crate::laws::friction::FrictionParameters;
use crate::model::Model;
use crate::model::text::readable;
use crate::run::law::LawReport;
use crate::run::{Error, RunReport};

/// File that every folder of results has.
pub const SUMMARY: &str = "summary.json";

/// Origin of the results and information for their readers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct About {
    /// case file
    pub case: String,
    /// title
    pub title: String,
    /// labels of the units
    pub units: BTreeMap<String, String>,
    /// section of the model, and the reference length of forces and energies; `None` for a law test
    #[serde(skip_serializing_if = "Option::is_none")]
    pub section: Option<String>,
    /// friction law of each contact
    pub friction: BTreeMap<String, FrictionParameters>,
    /// Rayleigh, shear and pressure wave speeds of the first contact's slave body [L/T]
    pub wave_speeds: [f64; 3],
    /// slip rate that defines a front, if the case requests fronts [L/T]
    pub front_slip_rate: Option<f64>,
    /// case as printed by `check`: headings with their lines
    pub understood: Vec<(String, Vec<String>)>,
    /// case as written, except for a mesh given node by node; null for a law test
    #[serde(skip_serializing_if = "Value::is_null")]
    pub given: Value,
}

/// Status of the run: the first lines of every `summary.json`.
#[derive(Clone, Debug, Serialize)]
pub struct Ending {
    /// "running", "completed", "stopped" or "interrupted"
    pub status: &'static str,
    /// reason for stopping
    pub reason: Option<String>,
    /// version of the program
    pub version: &'static str,
    /// files that it writes or may write in addition to this one; a name that ends in / is a folder of frames
    pub files: Vec<String>,
}

impl Ending {
    /// Status of a run or test in progress.
    pub fn running(files: &[String]) -> Self {
        Self { status: "running", reason: None, version: env!("CARGO_PKG_VERSION"), files: files.to_vec() }
    }

    /// Status of a run or test that stopped for a reason, or completed.
    pub fn new(stopped: Option<&Error>, files: &[String]) -> Self {
        let status = match stopped {
            None => "completed",
            Some(Error::Interrupted) => "interrupted",
            Some(_) => "stopped",
        };
        Self { status, reason: stopped.map(|error| readable(&error.to_string())), ..Self::running(files) }
    }

    /// Status of a run or test that ended in an internal error.
    pub fn internal_error(what: &str, files: &[String]) -> Self {
        Self { status: "stopped", reason: Some(format!("internal error: {what}")), ..Self::running(files) }
    }
}

/// Content of `summary.json` of a law test.
#[derive(Clone, Debug, Serialize)]
pub struct LawSummary {
    /// status
    #[serde(flatten)]
    pub ending: Ending,
    /// test
    #[serde(flatten)]
    pub about: About,
    /// results
    #[serde(flatten)]
    pub report: LawReport,
}

/// Content of `summary.json` of a run.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// status
    #[serde(flatten)]
    pub ending: Ending,
    /// case
    #[serde(flatten)]
    pub about: About,
    /// number of dofs
    pub dofs: usize,
    /// number of nodes
    pub nodes: usize,
    /// number of elements
    pub elements: usize,
    /// number of point masses
    pub point_masses: usize,
    /// number of contact points
    pub contact_points: usize,
    /// counts and times
    #[serde(flatten)]
    pub report: RunReport,
    /// number of repeated onsets of slip within an event, per point and time, by contact, if the case requests fronts [1/T]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub chatter: Option<BTreeMap<String, f64>>,
    /// friction history of each contact with friction
    pub friction_course: BTreeMap<String, FrictionHistory>,
    /// derivatives of the history by the places of their parameters, if the case requests them
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gradients: Option<BTreeMap<String, Account>>,
    /// fraction of the elastic energy of bodies and contacts stored in contact penalties when it was largest; `None` without
    /// contacts [-]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub energy_in_penalties: Option<f64>,
    /// largest resident memory of the process, where the system reports it [MiB]
    pub peak_memory_mib: Option<f64>,
    /// warnings
    pub warnings: Vec<String>,
}

impl Summary {
    /// Summarizes a run.
    pub fn new(ending: Ending, about: About, model: &Model, report: RunReport, warnings: Vec<String>) -> Self {
        Self {
            ending,
            about,
            dofs: model.unknowns(),
            nodes: model.mesh.nodes.len() - model.mesh.water_nodes,
            elements: model.mesh.elements.len(),
            point_masses: model.point_masses.iter().map(|point| point.nodes.len()).sum(),
            contact_points: model.contacts.iter().map(|pair| pair.points.len()).sum(),
            report,
            chatter: None,
            friction_course: BTreeMap::new(),
            gradients: None,
            energy_in_penalties: None,
            peak_memory_mib: peak_memory_mib(),
            warnings,
        }
    }
}

/// Writes a [`Summary`] or [`LawSummary`] as `summary.json` into `folder`; the old or the new file exists at any moment.
///
/// # Errors
/// Returns [`Error::Output`] if it cannot be written.
pub fn write(summary: &impl Serialize, folder: &Path) -> Result<(), Error> {
    let path = folder.join(SUMMARY);
    let text = serde_json::to_string_pretty(summary).map_err(|cause| failed(&path, &cause))?;
    files::replace_for_good(&path, (text + "\n").as_bytes()).map_err(|cause| failed(&path, &cause))
}

/// Returns the unfinished run of a folder; `None` if the folder is empty.
///
/// # Errors
/// Returns a description of other contents.
pub fn unfinished(folder: &Path) -> Result<Option<About>, String> {
    #[derive(Deserialize)]
    struct Begun {
        status: String,
        #[serde(flatten)]
        about: About,
    }
    // A run killed right after its start leaves its lock, its log and an incomplete summary.
    let passing = [files::LOCK.into(), files::LOG.into(), files::aside(Path::new(SUMMARY)).into_os_string()];
    let is_empty = match folder.read_dir() {
        Ok(mut entries) => entries.all(|entry| entry.is_ok_and(|entry| passing.contains(&entry.file_name()))),
        Err(cause) if cause.kind() == ErrorKind::NotFound => true,
        Err(cause) => return Err(format!("the folder cannot be read ({cause})")),
    };
    if is_empty {
        return Ok(None);
    }
    let text = std::fs::read_to_string(folder.join(SUMMARY)).unwrap_or_default();
    match serde_json::from_str::<Begun>(&text) {
        Err(_) => Err(format!("the folder holds files, but no readable {SUMMARY} of a run")),
        Ok(Begun { status, .. }) if status == "completed" => Err("the run in the folder has completed".into()),
        Ok(Begun { about, .. }) => Ok(Some(about)),
    }
}

/// Largest resident set so far, from the Linux process status.
fn peak_memory_mib() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(line.trim().trim_end_matches("kB").trim().parse::<f64>().ok()? / 1024.0)
}
