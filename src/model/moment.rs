//! Moments, and the spans of steps.

/// A moment at which it is asked how a quantity varies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// t [T]
    pub time: f64,
    /// Start and end of the increment beyond whose end the moment lies, where a scheme looks ahead
    pub beyond: Option<[f64; 2]>,
}

impl From<f64> for Moment {
    fn from(time: f64) -> Self {
        Self { time, beyond: None }
    }
}

/// The time span of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Span {
    /// start [T]
    pub start: f64,
    /// end [T]
    pub end: f64,
}

impl Span {
    /// Share of the span that has passed, 0 to 1.
    pub fn share(&self, time: f64) -> f64 {
        if self.end > self.start { ((time - self.start) / (self.end - self.start)).clamp(0.0, 1.0) } else { 1.0 }
    }
}
