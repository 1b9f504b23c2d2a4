//! Output requests: what is recorded of a run, and when. Observers read them, and increments end at their times; no equation
//! depends on them.

use crate::mesh::Edge;

/// Output requests of a run.
#[derive(Clone, Debug, Default, PartialEq)]
#[doc(hidden)]
pub struct OutputRequests {
    /// sets of nodes in the history
    pub watch: Vec<WatchedSet>,
    /// points of the bodies
    pub probes: Vec<Probe>,
    /// Minimum time between two rows of the history of implicit steps, and interval of the results of explicit ones [T]
    pub interval: Option<f64>,
    /// Output times of fields, ascending, at which increments end [T]
    pub times: Vec<f64>,
}

/// A set of nodes whose mean displacement and reaction the history reports.
#[derive(Clone, Debug, PartialEq)]
#[doc(hidden)]
pub struct WatchedSet {
    /// name in results: that of the group, or one that identifies the node
    pub name: String,
    /// nodes, whose mean displacement is reported
    pub nodes: Vec<usize>,
    /// edges, if it is an edge group
    pub edges: Vec<Edge>,
    /// nodes whose reactions along x and y belong to it
    pub held: [Vec<usize>; 2],
}

/// A point that moves with a body, at which motion, strain and stress are recorded, as a gauge there would read them.
#[derive(Clone, Debug, PartialEq)]
#[doc(hidden)]
pub struct Probe {
    /// its name in results
    pub name: String,
    /// the element it lies in
    pub element: usize,
    /// its coordinates (ξ, η) in it
    pub at: [f64; 2],
}

impl OutputRequests {
    /// Whether a time is an output time of fields, within round-off.
    pub fn is_time(&self, time: f64) -> bool {
        self.times.iter().any(|at| (at - time).abs() <= near(*at))
    }

    /// The next time after another at which fields are requested.
    pub fn next_time(&self, after: f64) -> Option<f64> {
        self.times.iter().copied().find(|at| *at > after + near(*at))
    }
}

/// Difference below which two times are the same [T].
fn near(time: f64) -> f64 {
    16.0 * f64::EPSILON * time
}
