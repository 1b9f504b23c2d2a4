//! What is written by a run, as a case asks for it.

use schemars::JsonSchema;
use serde::Deserialize;

/// What is written.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct OutputInput {
    /// Fields are written with every n-th row of the history, and at the end of each step
    pub every: usize,
    /// Whether fields are written at all
    pub fields: bool,
    /// Explicit steps write a row of the history (and fields, every n-th time) at multiples of this since the start of the
    /// step [T]; a hundredth of the step unless given. Implicit steps do so at every increment
    pub interval: Option<f64>,
    /// Minutes of wall time between checkpoints (checkpoint.bin), from which `run --resume` goes on to the same bits after
    /// whatever has ended the run; the last one is written at the end. 5 unless given; null or 0 for none
    pub checkpoint: Option<f64>,
    /// Slip over time and place (slip_map.csv), and the fronts that run along contacts with friction (fronts.csv)
    pub fronts: Option<FrontsInput>,
}

/// What counts as a front.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FrontsInput {
    /// Slip rate whose passage from below is the arrival of a front [L/T]
    pub slip_rate: f64,
}

impl Default for OutputInput {
    fn default() -> Self {
        Self { every: 1, fields: true, interval: None, checkpoint: Some(5.0), fronts: None }
    }
}
