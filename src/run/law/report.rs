//! What a law test prints: its rows, and in a report peaks of friction and holds.

use serde::Serialize;

use crate::laws::friction::{FrictionResponse, FrictionState};

/// One step along the path.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct LawRow {
    /// t [T]
    pub time: f64,
    /// total slip since the start [L]
    pub slip: f64,
    /// response of the law
    pub response: FrictionResponse,
    /// μ: frictional strength divided by p [-]
    pub mu: f64,
    /// g: opening of the interface since the start, of its law and by its normal stiffness [L]
    pub gap: f64,
    /// friction and a bond in parallel with it together
    pub bond: Option<LawBond>,
    /// the machine of a slider
    pub machine: Option<LawMachine>,
    /// derivatives by [`super::LawTest::by`]
    pub derivatives: Vec<f64>,
}

/// The machine of a slider at a step of the path.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct LawMachine {
    /// w: way of the load point [L]
    pub load_point: f64,
    /// F: force of the spring, per area [F/L²]
    pub force: f64,
    /// u̇ [L/T]
    pub slip_rate: f64,
}

/// Friction and a bond in parallel with it together at a step of the path.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct LawBond {
    /// w [L]
    pub opening: f64,
    /// p − T [F/L²]
    pub pressure: f64,
    /// q [F/L²]
    pub traction: f64,
    /// work of friction and bond so far [F/L]
    pub dissipation: f64,
    /// 1 − κ [-]
    pub intact: f64,
}

/// Point of the path for the evaluation of peaks and holds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct PathPoint {
    /// t [T]
    pub time: f64,
    /// total slip [L]
    pub slip: f64,
    /// |q|/p: apparent friction coefficient [-]
    pub coefficient: f64,
    /// μ: frictional strength divided by p [-]
    pub mu: f64,
}

impl PathPoint {
    /// Creates a point from the numbers of a row; the coefficient is 0 without pressure.
    pub fn new(time: f64, slip: f64, pressure: f64, traction: f64, mu: f64) -> Self {
        let coefficient = if pressure > 0.0 { traction.abs() / pressure } else { 0.0 };
        Self { time, slip, coefficient, mu }
    }
}

/// A hold, and the peak friction in the slip that follows it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Hold {
    /// duration [T]
    pub duration: f64,
    /// highest |q|/p until the next hold
    pub peak: PathPoint,
}

/// Peaks of |q|/p over all steps and after every hold.
#[derive(Clone, Debug, Default, Serialize)]
#[non_exhaustive]
pub struct Peaks {
    /// highest |q|/p at the end of a step; the first of equal ones
    pub peak: Option<PathPoint>,
    /// holds that were followed by slip
    pub holds: Vec<Hold>,
    #[serde(skip)]
    last: Option<PathPoint>,
    /// start of the current hold
    #[serde(skip)]
    rest_since: Option<f64>,
}

impl Peaks {
    /// Records the next row.
    #[doc(hidden)]
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

/// Results of a law test.
#[derive(Clone, Debug, Default, Serialize)]
#[non_exhaustive]
pub struct LawReport {
    /// number of steps
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
    /// Records the next row.
    #[doc(hidden)]
    pub fn note(&mut self, row: &LawRow) {
        let FrictionResponse { state, evaluations, .. } = &row.response;
        let FrictionState { pressure, traction, dissipation, .. } = *state;
        // The first row is the start.
        self.steps += usize::from(self.peaks.last.is_some());
        self.peaks.note(PathPoint::new(row.time, row.slip, pressure, traction, row.mu));
        self.most_evaluations = self.most_evaluations.max(*evaluations);
        self.dissipation = dissipation;
    }
}
