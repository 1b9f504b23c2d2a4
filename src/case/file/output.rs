//! Output requested by a case.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::output::fields::{Frames, Selection};
use crate::output::fronts::FrontsInput;

/// Approximate number of frames of a run if the case does not specify them.
const FRAMES: usize = 30;

/// Output of a run.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct OutputInput {
    /// Fields are written with every n-th row of the history, and at the end of each step; default: about 30 times in the
    /// run, equally often in each step at equal parts of its duration, or only at `times` and ends of steps where `times` are
    /// given
    pub every: Option<usize>,
    /// Whether fields are written at all
    pub fields: bool,
    /// Whether fields are written as 64-bit numbers, as they are computed; default: as 32-bit numbers (relative error at
    /// most 6e-8), in half the space. Undeformed coordinates are always 64-bit numbers
    pub exact: bool,
    /// Explicit steps write a row of the history (and fields, every n-th time) at multiples of this since the start of the step
    /// [T]; default: a hundredth of the step. Implicit steps write every increment or, if this is given, rows at least that far
    /// apart in time; the increments before and after a contact point opens, closes, begins to slip or stops are always
    /// written, and so are the ends of steps
    pub interval: Option<f64>,
    /// Times at which fields are written, ascending; increments end at them [T]
    pub times: Vec<f64>,
    /// Whether stresses at the integration points are written with the fields (points.pvd)
    pub points: bool,
    /// Whether the fields also have what follows from stress and logarithmic strain: `principal_stress`, `principal_strain` and
    /// `stretch_zz`, for ParaView. The page and Python compute these themselves
    pub derived: bool,
    /// Whether `gradients.zarr`, at every row of the history, and the fields also have the derivatives of the displacements of all nodes by the
    /// places of `gradients`
    pub displacement_gradients: bool,
    /// Minutes of wall time between checkpoints (checkpoint.bin), from which `run --resume` continues with bitwise
    /// identical results, however the run ended; the last one is written at the end. Default 5; null or 0 for none
    pub checkpoint: Option<f64>,
    /// Slip fronts along contacts with friction (fronts.csv), and their slip events (events.csv)
    pub fronts: Option<FrontsInput>,
    /// Whether a run ends with report.html, one page to look at its results in a browser; `fecontact report` writes it at any
    /// time
    pub report: bool,
}

impl OutputInput {
    /// Frames of a run with this number of steps.
    pub fn frames(&self, steps: usize) -> Frames {
        let some = match self.times.is_empty() {
            true => Selection::Parts((FRAMES / steps.max(1)).max(1)),
            false => Selection::Named,
        };
        let of = self.every.map_or(some, Selection::Rows);
        Frames { of, points: self.points, exact: self.exact, derived: self.derived }
    }
}

impl Default for OutputInput {
    fn default() -> Self {
        Self {
            every: None,
            fields: true,
            exact: false,
            interval: None,
            times: Vec::new(),
            points: false,
            derived: false,
            displacement_gradients: false,
            checkpoint: Some(5.0),
            fronts: None,
            report: true,
        }
    }
}
