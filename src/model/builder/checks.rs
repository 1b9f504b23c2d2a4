//! What does not go together, and settings out of range.

use super::contact::Contact;
use super::error::{Checked, ModelError};
use crate::model::scheme::Scheme;
use crate::model::{Model, NewtonSettings, Step};

/// Largest number of Newton iterations that makes sense to allow.
const MOST_ITERATIONS: usize = 1000;

/// When Newton's method stops.
pub fn checked_newton(newton: NewtonSettings) -> Checked<NewtonSettings> {
    if !(newton.tolerance > 0.0 && newton.tolerance < 1.0) {
        let message = format!("is {}: must be between 0 and 1 (1e-8 is the default)", newton.tolerance);
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
