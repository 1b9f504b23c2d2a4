//! Pressure of a fluid in a contact that is given, or that water has which flows along it.

use std::fmt;

use nalgebra::Vector2;

use super::point::{SlavePoint, linear_shares};

/// p_w by reference position and time [F/L²].
pub type PressureAt = dyn Fn(Vector2<f64>, f64) -> f64 + Send + Sync;

/// p_w by node and time [F/L²].
pub type PressureOfNode = dyn Fn(usize, f64) -> f64 + Send + Sync;

/// What gives the pressure of a fluid.
enum Source {
    ByPlace(Box<PressureAt>),
    /// linear between nodes
    ByNode(Box<PressureOfNode>),
    /// by node at the start of the run, from which on it flows
    Flowing(Box<PressureOfNode>),
}

/// Pressure of the fluid in a contact.
pub struct Fluid {
    pressure: Source,
    /// Times of kinks, ascending [T]
    corners: Vec<f64>,
}

impl Fluid {
    /// Creates a fluid with the pressure p_w ≥ 0 as a function of reference position and time.
    pub fn new(pressure: impl Fn(Vector2<f64>, f64) -> f64 + Send + Sync + 'static) -> Self {
        Self { pressure: Source::ByPlace(Box::new(pressure)), corners: Vec::new() }
    }

    /// Creates a fluid with the pressure p_w ≥ 0 as a function of node and time, which the points of edges interpolate.
    pub fn at_nodes(pressure: impl Fn(usize, f64) -> f64 + Send + Sync + 'static) -> Self {
        Self { pressure: Source::ByNode(Box::new(pressure)), corners: Vec::new() }
    }

    /// Creates a fluid that flows, with the pressure p_w ≥ 0 of the nodes at the start.
    pub fn flowing(pressure: impl Fn(usize) -> f64 + Send + Sync + 'static) -> Self {
        Self { pressure: Source::Flowing(Box::new(move |node, _| pressure(node))), corners: Vec::new() }
    }

    /// Sets the times at which its rate jumps everywhere, ascending [T].
    #[must_use]
    pub fn with_corners(self, corners: Vec<f64>) -> Self {
        Self { corners, ..self }
    }

    /// Times at which its rate jumps [T]
    pub fn corners(&self) -> impl Iterator<Item = f64> + '_ {
        self.corners.iter().copied()
    }

    /// p_w at a slave point, whose reference position is `at` [F/L²]
    pub(super) fn pressure(&self, slave: &SlavePoint, at: impl Fn() -> Vector2<f64>, time: f64) -> f64 {
        match &self.pressure {
            Source::Flowing(pressure) => {
                linear_shares(slave).into_iter().map(|(node, share)| share * pressure(node, time)).sum()
            }
            Source::ByPlace(pressure) => pressure(at(), time),
            Source::ByNode(pressure) => slave.position.iter().map(|&(node, w)| w * pressure(node, time)).sum(),
        }
    }
}

impl fmt::Debug for Fluid {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str("a fluid")
    }
}

/// A fluid pressure that is negative or not finite, with its position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BadPressure {
    /// Reference position of the slave point
    pub at: Vector2<f64>,
    /// p_w there, negative or not finite [F/L²]
    pub pressure: f64,
}
