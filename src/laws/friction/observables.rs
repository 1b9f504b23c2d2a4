//! What outputs show of friction beside what all laws have in common: the names come from the laws.

use super::{FrictionLaw, FrictionState};

/// Observables that every table has a column for, and their value where the law does not know them: without friction
/// there is no strength to approach, and without structure its degree is 1.
pub const ALWAYS: [(&str, f64); 3] = [("R", 0.0), ("mu", 0.0), ("structure", 1.0)];

/// Names of the further observables of some laws, each once, in order of appearance.
pub fn further<'a>(laws: impl IntoIterator<Item = &'a dyn FrictionLaw>) -> Vec<&'static str> {
    let mut names = Vec::new();
    for name in laws.into_iter().flat_map(|law| law.observables().iter().chain(law.offsets())) {
        if ALWAYS.iter().all(|(always, _)| always != name) && !names.contains(name) {
            names.push(*name);
        }
    }
    names
}

/// The value of an observable, or what stands for it where the law does not know it: NaN if it is a further one.
pub fn value(law: &dyn FrictionLaw, name: &str, state: &FrictionState) -> f64 {
    let absent = || ALWAYS.iter().find(|(always, _)| *always == name).map_or(f64::NAN, |(_, absent)| *absent);
    law.observe(name, state).unwrap_or_else(absent)
}
