//! Unstable equilibria that a run has accepted.
//!
//! A static equilibrium is stable if its tangent has no negative eigenvalue. They are counted, unless a pivot vanishes: all of them
//! where the tangent is symmetric, else those of its symmetric parts, and one more if the determinant of the rest is negative. Nothing
//! is known where linear bodies are condensed on contacts.

use serde::{Deserialize, Serialize};

use crate::model::scheme::time_text;
use crate::model::text::count;
use crate::run::observer::Attempt;

/// Accepted equilibria whose tangent has negative eigenvalues.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Instability {
    /// Times of the first and the last of them [T]
    times: Option<[f64; 2]>,
    /// Largest number of negative eigenvalues
    most: usize,
    /// Whether the last equilibrium is one of them
    remains: bool,
}

impl Instability {
    /// Records an accepted increment that ends at a time.
    pub fn record(&mut self, attempt: &Attempt, time: f64) {
        if attempt.step.scheme.is_dynamic() {
            return;
        }
        let last = attempt.iterations.last();
        let Some(negative) = last.and_then(|iteration| iteration.newton.least_negative) else { return };
        self.remains = negative > 0;
        self.most = self.most.max(negative);
        if self.remains {
            self.times = Some([self.times.map_or(time, |[since, _]| since), time]);
        }
    }

    /// Warning at the end of a run, if there were any.
    pub fn message(&self) -> Option<String> {
        let [since, until] = self.times?;
        let until = if self.remains { String::new() } else { format!(" to t = {}", time_text(until)) };
        Some(format!(
            "from t = {}{until} equilibria are unstable: the tangent has up to {}, and the bodies would leave them for others at the \
             slightest disturbance; take shorter increments before that time (`dt.initial`, `dt.max`), an imperfection that \
             leads to the stable branch, or a step with inertia",
            time_text(since),
            count(self.most, "negative eigenvalue")
        ))
    }
}
