//! What a friction law driven alone answered, and what its answers amount to.

use serde::Serialize;

use crate::laws::friction::{FrictionResponse, FrictionState};

/// One step along the path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LawRow {
    /// t [T]
    pub time: f64,
    /// total slip since the start [L]
    pub slip: f64,
    /// what the law answered
    pub response: FrictionResponse,
    /// μ: what the interface could carry over p [-]
    pub mu: f64,
}

/// A point of the path, as far as peaks and holds are concerned.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PathPoint {
    /// t [T]
    pub time: f64,
    /// total slip [L]
    pub slip: f64,
    /// |q|/p: apparent friction coefficient [-]
    pub coefficient: f64,
    /// μ: what the interface could carry [-]
    pub mu: f64,
}

impl PathPoint {
    /// From the numbers of a row; without pressure there is no coefficient.
    pub fn new([time, slip, pressure, traction, mu]: [f64; 5]) -> Self {
        let coefficient = if pressure > 0.0 { traction.abs() / pressure } else { 0.0 };
        Self { time, slip, coefficient, mu }
    }
}

/// A time without slip, and the peak of friction in the slip that follows.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Hold {
    /// its length [T]
    pub duration: f64,
    /// the highest |q|/p until the next hold
    pub peak: PathPoint,
}

/// Peaks of |q|/p: over all steps, and after every hold.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Peaks {
    /// the highest |q|/p at the end of a step, the first where several are equal
    pub peak: Option<PathPoint>,
    /// holds that slip has followed
    pub holds: Vec<Hold>,
    #[serde(skip)]
    last: Option<PathPoint>,
    /// start of the hold that is going on
    #[serde(skip)]
    rest_since: Option<f64>,
}

impl Peaks {
    /// Take note of the next row.
    pub fn note(&mut self, now: PathPoint) {
        let higher = |than: &PathPoint| now.coefficient > than.coefficient;
        let Some(last) = self.last.replace(now) else { return };
        if self.peak.as_ref().is_none_or(higher) {
            self.peak = Some(now);
        }
        if now.slip == last.slip {
            self.rest_since.get_or_insert(last.time);
        } else if let Some(start) = self.rest_since.take() {
            self.holds.push(Hold { duration: last.time - start, peak: now });
        } else if let Some(hold) = self.holds.last_mut().filter(|hold| higher(&hold.peak)) {
            hold.peak = now;
        }
    }
}

/// What a test of a law amounts to.
#[derive(Clone, Debug, Default, Serialize)]
pub struct LawReport {
    /// steps answered
    pub steps: usize,
    /// most evaluations of the law's scalar equation in one step
    pub most_evaluations: usize,
    /// peak of |q|/p, and holds
    #[serde(flatten)]
    pub peaks: Peaks,
    /// work dissipated by friction [F/L]
    pub dissipation: f64,
    /// warnings
    pub warnings: Vec<String>,
}

impl LawReport {
    /// Take note of the next row.
    pub fn note(&mut self, row: &LawRow) {
        let FrictionResponse { state, evaluations, .. } = row.response;
        let FrictionState { pressure, traction, dissipation, .. } = state;
        // The first row is the start.
        self.steps += usize::from(self.peaks.last.is_some());
        self.peaks.note(PathPoint::new([row.time, row.slip, pressure, traction, row.mu]));
        self.most_evaluations = self.most_evaluations.max(evaluations);
        self.dissipation = dissipation;
    }
}
