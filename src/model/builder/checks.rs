//! What does not go together, and settings out of range.

use super::contact::Contact;
use super::error::{Checked, ModelError};
use super::increments::MOST_INCREMENTS;
use crate::model::scheme::Scheme;
use crate::model::{Model, NewtonSettings, Step};

/// Largest number of Newton iterations that makes sense to allow.
const MOST_ITERATIONS: usize = 1000;

/// A looser tolerance leaves forces out of balance that a reader of the results would see.
const LOOSEST: f64 = 1e-2;

/// When Newton's method stops.
pub fn checked_newton(newton: NewtonSettings) -> Checked<NewtonSettings> {
    if !(newton.tolerance > 0.0 && newton.tolerance <= LOOSEST) {
        let message = format!(
            "is {}: must be above 0 and at most {LOOSEST}, the share of the forces that may be out of balance (1e-8 is the \
             default)",
            newton.tolerance
        );
        return Err(ModelError::new("newton.tolerance", message));
    }
    if !(1..=MOST_ITERATIONS).contains(&newton.max_iterations) {
        let message = format!("is {}: must be 1 to {MOST_ITERATIONS}", newton.max_iterations);
        return Err(ModelError::new("newton.max_iterations", message));
    }
    Ok(newton)
}

/// Time between the results of explicit steps.
pub fn checked_interval(interval: Option<f64>) -> Checked<Option<f64>> {
    match interval.filter(|interval| !(*interval > 0.0 && interval.is_finite())) {
        Some(interval) => {
            let message =
                format!("is {interval}: must be positive (leave it out for a hundredth of each explicit step)");
            Err(ModelError::new("output.interval", message))
        }
        None => Ok(interval),
    }
}

/// Explicit steps write a row of results an interval.
pub fn check_rows(model: &Model) -> Checked<()> {
    let Some(interval) = model.interval else { return Ok(()) };
    let explicit = |step: &&Step| step.rupture.is_some() || matches!(step.scheme, Scheme::Explicit { .. });
    let time: f64 = model.steps.iter().filter(explicit).map(|step| step.span.end - step.span.start).sum();
    let rows = time / interval;
    match rows <= MOST_INCREMENTS {
        true => Ok(()),
        false => {
            let message =
                format!("is {interval:e}: that makes {rows:.1e} rows of results, and {MOST_INCREMENTS:e} are the most");
            Err(ModelError::new("output.interval", message))
        }
    }
}

/// Times at which fields are asked for: within the steps, in order.
pub fn checked_times(times: Vec<f64>, steps: &[Step]) -> Checked<Vec<f64>> {
    let (start, end) =
        steps.first().zip(steps.last()).map_or((0.0, 0.0), |(first, last)| (first.span.start, last.span.end));
    for (k, time) in times.iter().enumerate() {
        let refused = |message: String| Err(ModelError::new(format!("output.times[{k}]"), message));
        if !(*time > start && *time <= end) {
            return refused(format!("is {time}: must be after {start} and not after {end}, the end of the last step"));
        }
        if k > 0 && *time <= times[k - 1] {
            return refused(format!("is {time}, but {} comes before it: times must ascend", times[k - 1]));
        }
    }
    Ok(times)
}

/// Explicit steps solve no equations, and so cannot raise pressures until penetrations are small, nor find where a node
/// without mass is. Wilson's equilibrium lies beyond the increment, and so do the multipliers found there.
pub fn check_schemes(contacts: &[Contact], model: &Model) -> Checked<()> {
    let explicit = |step: &&Step| step.rupture.is_some() || matches!(step.scheme, Scheme::Explicit { .. });
    let augmented = model.contacts.iter().find(|pair| pair.penetration.is_some());
    let refused =
        |name: &str, key: &str, message: String| Err(ModelError::new(format!("contacts.{name}.{key}"), message));
    if let (Some(pair), Some(step)) = (augmented, model.steps.iter().find(|step| step.scheme.theta() > 1.0)) {
        let message = format!(
            "the step `{}` seeks equilibrium beyond its increments (Wilson-θ), where multipliers mean nothing: leave it out, \
             or take another scheme",
            step.name
        );
        return refused(&pair.name, "normal.penetration", message);
    }
    let Some(Step { name: step, .. }) = model.steps.iter().find(explicit) else { return Ok(()) };
    if let Some(contact) = contacts.iter().find(|contact| contact.massless) {
        let message = format!("the explicit step `{step}` needs the mass of every node: leave it out");
        return refused(&contact.name, "massless", message);
    }
    match augmented {
        Some(pair) => {
            let message =
                format!("the explicit step `{step}` takes the plain penalty: leave it out, and raise alpha_n");
            refused(&pair.name, "normal.penetration", message)
        }
        None => Ok(()),
    }
}
