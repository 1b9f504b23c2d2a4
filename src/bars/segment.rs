//! A segment of a bar: its stretch, force and yielding.
//!
//! ```text
//! N = EA (ε − ε_l),   |N| ≤ N_p                    ε_l: locked strain, of yielding and of the jack
//! ∂|e|/∂e = t,   ∂²|e|/∂e² = (1 − t tᵀ)/|e|
//! ```
//! A jack sets N, and ε_l is what is left at that force; it does the work −∫ N l dε_l.

use nalgebra::{Matrix2, Vector2};
use serde::{Deserialize, Serialize};

use super::Bar;
use super::vectors::{Answer, Measure, Vectors};

/// A segment.
#[derive(Clone, Debug, PartialEq)]
pub struct Segment {
    /// e
    pub vectors: Vectors,
    /// L: length in the mesh [L]
    pub length: f64,
}

/// State of a segment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SegmentState {
    /// What it was longer than in the mesh when it came [L]
    pub natural: f64,
    /// ε_l [-]
    pub locked: f64,
    /// N, positive in tension [F]
    pub force: f64,
    /// whether it yielded in the last increment
    pub yields: bool,
}

/// What a segment has found.
pub struct Stretched {
    /// state
    pub state: SegmentState,
    /// stored [F·L]
    pub stored: f64,
    /// dissipated by yielding [F·L]
    pub plastic: f64,
    /// work of the jack [F·L]
    pub jacked: f64,
}

impl Segment {
    /// |e| − L, accurate for small motions.
    fn elongation(&self, u: &[f64]) -> f64 {
        let ([before, _], [way, _]) = (self.vectors.at, self.vectors.ways(u));
        way.dot(&(2.0 * before + way)) / ((before + way).norm() + self.length)
    }

    /// State of one that comes without force at displacements.
    pub fn activated(&self, u: &[f64]) -> SegmentState {
        SegmentState { natural: self.elongation(u), ..SegmentState::default() }
    }

    /// |e| at displacements.
    pub fn stretch(&self, u: &[f64]) -> Measure {
        let e = self.vectors.at[0] + self.vectors.ways(u)[0];
        let t = e.normalize();
        let across = (Matrix2::identity() - t * t.transpose()) / e.norm();
        ([t, Vector2::zeros()], [across, Matrix2::zeros()])
    }

    /// Evaluates it at displacements.
    pub fn respond(&self, bar: &Bar, old: &SegmentState, u: &[f64], jack: Option<f64>) -> (Answer, Stretched) {
        let length = self.length + old.natural;
        let strain = (self.elongation(u) - old.natural) / length;
        let trial = bar.ea * (strain - old.locked);
        let yields = jack.is_none() && trial.abs() > bar.limit;
        let force = jack.unwrap_or_else(|| trial.clamp(-bar.limit, bar.limit));
        let is_set = yields || jack.is_some();
        let locked = if is_set { strain - force / bar.ea } else { old.locked };
        let e = self.vectors.at[0] + self.vectors.ways(u)[0];
        let size = e.norm();
        let t = e / size;
        let along = if is_set { 0.0 } else { bar.ea / length };
        let across = force / size;
        let rates = t * t.transpose() * (along - across) + Matrix2::identity() * across;
        let change = locked - old.locked;
        let found = Stretched {
            state: SegmentState { natural: old.natural, locked, force, yields },
            stored: 0.5 * force * force / bar.ea * length,
            plastic: if yields { force * change * length } else { 0.0 },
            jacked: if jack.is_some() { -0.5 * (old.force + force) * change * length } else { 0.0 },
        };
        (Answer::of_first(t * force, rates), found)
    }
}
