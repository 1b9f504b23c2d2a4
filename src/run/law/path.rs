//! Path of a law test: slip, pressure and opening as functions of time, and the times at which steps end.

use nalgebra::Vector2;

use crate::model::boundary::{Drive, Span};

/// One phase of the path.
#[derive(Clone, Debug)]
pub struct Phase {
    span: Span,
    slip: PathDrive,
    pressure: PathDrive,
    opening: PathDrive,
    /// longest step [T]
    dt: f64,
    /// time difference below which two times are equal [T]
    resolution: f64,
    /// times at which steps must end, ascending; the end of the phase is the last
    stops: Vec<f64>,
}

/// Slip or pressure during one phase.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct PathDrive {
    /// variation in time
    pub drive: Drive,
    /// value at the start of the phase, to which a constant and a rate refer
    pub start: f64,
}

impl PathDrive {
    /// Creates a variation from a value at the start of the phase.
    pub fn new(drive: Drive, start: f64) -> Self {
        Self { drive, start }
    }
}

/// A quantity of the path has no finite value.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("the {quantity} has no finite value at time {time}")]
#[non_exhaustive]
pub struct Undefined {
    /// "slip", "pressure" or "opening"
    pub quantity: &'static str,
    /// t [T]
    pub time: f64,
}

/// Lower bound of the number of samples among which the turning points of a phase are searched.
const FEWEST_SAMPLES: usize = 1 << 12;

/// Upper bound of the number of samples; in between, there is one per step.
const MOST_SAMPLES: usize = 1 << 20;

/// Fraction of a step below which two times are equal.
const SAME: f64 = 1e-6;

impl Phase {
    /// Creates a phase over a span and finds its turning points.
    ///
    /// # Errors
    /// Returns [`Undefined`] if an expression has no finite value.
    pub fn new(span: Span, slip: PathDrive, pressure: PathDrive, dt: f64) -> Result<Self, Undefined> {
        Self::opened(span, [slip, pressure, PathDrive::new(Drive::Constant(0.0), 0.0)], dt)
    }

    /// Creates a phase of slip, pressure and opening, for a law with a bond in parallel with it.
    ///
    /// # Errors
    /// Returns [`Undefined`] if an expression has no finite value.
    pub fn opened(span: Span, [slip, pressure, opening]: [PathDrive; 3], dt: f64) -> Result<Self, Undefined> {
        let mut phase = Self { span, slip, pressure, opening, dt, resolution: 0.0, stops: Vec::new() };
        let courses = [&phase.slip, &phase.pressure, &phase.opening];
        let mut knots: Vec<f64> = courses.iter().flat_map(|course| course.knots(span)).collect();
        knots.sort_by(f64::total_cmp);
        knots.dedup();
        let separation = knots.windows(2).map(|pair| pair[1] - pair[0]).fold(dt, f64::min);
        phase.resolution = SAME * separation.min(span.end - span.start);
        phase.stops = phase.find_stops(knots)?;
        Ok(phase)
    }

    /// Total slip since the start of the path [L].
    pub fn slip(&self, time: f64) -> f64 {
        self.slip.value(time, self.span)
    }

    /// p_a: applied pressure; without an opening the surfaces are separated where it is not positive [F/L²].
    pub fn pressure(&self, time: f64) -> f64 {
        self.pressure.value(time, self.span)
    }

    /// w: opening of the surfaces, under which a bond acts and friction has no pressure [L].
    pub fn opening(&self, time: f64) -> f64 {
        self.opening.value(time, self.span)
    }

    /// t at the start [T].
    pub fn start(&self) -> f64 {
        self.span.start
    }

    /// t at the end [T].
    pub fn end(&self) -> f64 {
        self.span.end
    }

    /// Ends of the steps: multiples of dt since the start of the phase, and the stops.
    pub fn times(&self) -> impl Iterator<Item = f64> {
        let mut stops = self.stops.iter().copied().peekable();
        let mut step = 1.0;
        std::iter::from_fn(move || {
            let stop = *stops.peek()?;
            let regular = self.span.start + step * self.dt;
            if regular <= stop + self.resolution {
                step += 1.0;
            }
            if regular < stop - self.resolution { Some(regular) } else { stops.next() }
        })
    }

    /// Times at which steps must end: table knots, turning points, closure, separation and the end of the phase. Knots are prescribed to the
    /// last bit, and what is located next to one is that knot; but where surfaces part at a knot, a step ends just before it as well, where
    /// they still slide.
    fn find_stops(&self, knots: Vec<f64>) -> Result<Vec<f64>, Undefined> {
        let samples = self.samples(&knots);
        let mut located = Vec::new();
        for (quantity, course) in [("slip", &self.slip), ("pressure", &self.pressure), ("opening", &self.opening)] {
            let value = |time| course.value(time, self.span);
            let samples = sampled(&samples, value).map_err(|time| Undefined { quantity, time })?;
            if matches!(course.drive, Drive::Expression(_)) {
                located.extend(turning_points(&samples, value));
            }
            if quantity != "slip" {
                located.extend(touches(&samples, value));
            }
        }
        located.sort_by(f64::total_cmp);
        let Span { start, end } = self.span;
        let within = |time: &f64| *time > start + self.resolution && *time < end - self.resolution;
        let prescribed: Vec<f64> =
            std::iter::once(start).chain(knots.into_iter().filter(within)).chain([end]).collect();
        let mut stops = prescribed[1..prescribed.len() - 1].to_vec();
        for time in located {
            let place = match self.near(&prescribed, time) {
                Some(knot) if knot > time && self.pressure(time) > 0.0 && self.pressure(knot) <= 0.0 => Some(time),
                Some(_) => None,
                None => Some(self.regular(time)).filter(|time| self.near(&stops, *time).is_none()),
            };
            if let Some(time) = place {
                stops.insert(stops.partition_point(|stop| *stop < time), time);
            }
        }
        stops.push(end);
        Ok(stops)
    }

    /// The time among ascending ones that coincides with one, if there is any.
    fn near(&self, times: &[f64], time: f64) -> Option<f64> {
        let next = times.partition_point(|other| *other < time);
        let around = &times[next.saturating_sub(1)..times.len().min(next + 1)];
        around.iter().copied().find(|other| (other - time).abs() <= self.resolution)
    }

    /// Regular end of a step that coincides with a time, if there is one.
    fn regular(&self, time: f64) -> f64 {
        let near = self.span.start + ((time - self.span.start) / self.dt).round() * self.dt;
        if (near - time).abs() <= self.resolution { near } else { time }
    }

    fn samples(&self, knots: &[f64]) -> Vec<f64> {
        let Span { start, end } = self.span;
        let count = (((end - start) / self.dt) as usize).clamp(FEWEST_SAMPLES, MOST_SAMPLES);
        let even = (0..=count).map(|k| start + (end - start) * (k as f64 / count as f64));
        let mut samples: Vec<f64> = even.chain(knots.iter().copied()).collect();
        samples.sort_by(f64::total_cmp);
        samples
    }
}

impl PathDrive {
    /// Value at a time of the span.
    pub fn value(&self, time: f64, span: Span) -> f64 {
        self.drive.value(Vector2::zeros(), time, span, self.start)
    }

    fn knots(&self, span: Span) -> Vec<f64> {
        match &self.drive {
            Drive::Table(table) => {
                let times = table.iter().map(|[time, _]| *time);
                times.filter(|time| (span.start..=span.end).contains(time)).collect()
            }
            _ => Vec::new(),
        }
    }
}

/// Pairs (t, f(t)) at the samples, and midway between two samples with equal f; an error holds the time at which f is not
/// finite.
fn sampled(times: &[f64], f: impl Fn(f64) -> f64) -> Result<Vec<[f64; 2]>, f64> {
    let mut samples: Vec<[f64; 2]> = Vec::with_capacity(times.len());
    for &time in times {
        let value = f(time);
        if !value.is_finite() {
            return Err(time);
        }
        if let Some(&[before, earlier]) = samples.last()
            && direction(earlier, value) == 0.0
        {
            let middle = 0.5 * (before + time);
            samples.push([middle, f(middle)]);
        }
        samples.push([time, value]);
    }
    Ok(samples)
}

/// Sign of b − a; 0 if they differ by round-off.
fn direction(a: f64, b: f64) -> f64 {
    if (b - a).abs() <= 4.0 * f64::EPSILON * a.abs().max(b.abs()) { 0.0 } else { (b - a).signum() }
}

/// Times at which the slope of f changes sign, becomes zero or ceases to be zero.
fn turning_points(samples: &[[f64; 2]], f: impl Fn(f64) -> f64) -> Vec<f64> {
    let turn = |window: &[[f64; 2]]| {
        let [[t0, f0], [t1, f1], [t2, f2]] = [window[0], window[1], window[2]];
        let (before, after) = (direction(f0, f1), direction(f1, f2));
        if before == after {
            None
        } else if before == 0.0 {
            Some(last_time(t1, t2, |t| direction(f1, f(t)) == 0.0))
        } else if after == 0.0 {
            Some(last_time(t0, t1, |t| direction(f1, f(t)) != 0.0))
        } else {
            Some(highest(t0, t2, |t| before * f(t)))
        }
    };
    samples.windows(3).filter_map(turn).collect()
}

/// Times at which the pressure becomes positive or ceases to be positive.
fn touches(samples: &[[f64; 2]], pressure: impl Fn(f64) -> f64) -> Vec<f64> {
    let pressed = |p: f64| p > 0.0;
    let change = |window: &[[f64; 2]]| {
        let [[t0, p0], [t1, p1]] = [window[0], window[1]];
        (pressed(p0) != pressed(p1)).then(|| last_time(t0, t1, |t| pressed(pressure(t)) == pressed(p0)))
    };
    samples.windows(2).filter_map(change).collect()
}

/// Last time in [low, high] at which a condition holds that is true at `low` and false at `high`.
fn last_time(mut low: f64, mut high: f64, holds: impl Fn(f64) -> bool) -> f64 {
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return low;
        }
        if holds(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
}

/// Location of the maximum of f in [low, high] by golden-section search; for smooth f its accuracy is limited to the square
/// root of the round-off.
fn highest(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    const SECTION: f64 = 0.618_033_988_749_894_8;
    const SECTIONS: usize = 70;
    let (mut left, mut right) = (high - SECTION * (high - low), low + SECTION * (high - low));
    let (mut at_left, mut at_right) = (f(left), f(right));
    for _ in 0..SECTIONS {
        if at_left < at_right {
            (low, left, at_left) = (left, right, at_right);
            right = low + SECTION * (high - low);
            at_right = f(right);
        } else {
            (high, right, at_right) = (right, left, at_left);
            left = high - SECTION * (high - low);
            at_left = f(left);
        }
    }
    0.5 * (low + high)
}
