//! Output requests: what of a run is recorded, and when. Observers read them, and increments end at their times; no equation
//! knows them.

use nalgebra::Vector2;

use crate::mesh::Edge;

/// Results to be recorded, and when.
#[derive(Clone, Debug, Default, PartialEq)]
#[doc(hidden)]
pub struct OutputRequests {
    /// sets of nodes in the history
    pub watch: Vec<WatchedSet>,
    /// points of the bodies
    pub probes: Vec<Probe>,
    /// axes of bodies along which sections are cut
    pub sections: Vec<Axis>,
    /// Least time between two rows of the history of implicit steps, and between the results of explicit ones [T]
    pub interval: Option<f64>,
    /// Times that increments end at, ascending, because fields are written then [T]
    pub times: Vec<f64>,
}

/// A set of nodes whose mean displacement and reaction the history reports.
#[derive(Clone, Debug, PartialEq)]
#[doc(hidden)]
pub struct WatchedSet {
    /// name in results: that of the group, or what says which node it is
    pub name: String,
    /// its nodes, of which the displacement is the mean
    pub nodes: Vec<usize>,
    /// its edges, where it is a group of edges
    pub edges: Vec<Edge>,
    /// nodes whose reactions along x and y are its own
    pub constrained: [Vec<usize>; 2],
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

/// An axis of a body with stations at which it is cut.
#[derive(Clone, Debug, PartialEq)]
#[doc(hidden)]
pub struct Axis {
    /// name in results
    pub name: String,
    /// number of the body
    pub body: usize,
    /// from one end to the other
    pub stations: Vec<Station>,
}

/// A place of an axis, and the nodes between the two parts into which it divides the body.
#[derive(Clone, Debug, PartialEq)]
#[doc(hidden)]
pub struct Station {
    /// in the mesh [L]
    pub place: Vector2<f64>,
    /// the element it lies in
    pub element: usize,
    /// its coordinates (ξ, η) in it
    pub at: [f64; 2],
    /// nodes of both parts, ascending; at an end of the body those of the end
    pub cut: Vec<usize>,
    /// elements at these nodes: of the part before, and of that beyond
    pub parts: [Vec<usize>; 2],
}

impl OutputRequests {
    /// Whether fields are requested at a time; round-off of the sum of increments does not matter.
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
