//! Friction whose parameters vary in time: patches that weaken and recover, creep that sets in.

use std::sync::Arc;

use nalgebra::Vector2;

use super::error::Checked;
use crate::laws::friction::{FrictionLaw, LawFailure, Offset, Offsets};
use crate::mesh::shape::gauss;
use crate::model::boundary::Profile;

/// Points of time over which the mean of a rate is taken: exact for polynomials of the fifth order.
const MEAN: usize = 3;

/// The law of a point: from what varies along the slave there, and the α_t that serves where none is given.
pub(super) type LawAt = dyn Fn(&[f64], f64) -> Checked<Box<dyn FrictionLaw>> + Send + Sync;

/// The law of a point whose parameters vary in time.
pub(super) struct InTime {
    pub profiles: Vec<Profile>,
    pub at: Vector2<f64>,
    pub law: Arc<LawAt>,
    /// α_t of a law that has none of its own [F/L³]
    pub alpha_t: f64,
    /// How its surfaces move apart with slip
    pub offsets: Offsets,
    /// Whether parameters enter by their mean over an increment
    pub takes_means: bool,
}

impl InTime {
    /// The law that holds from one time to another.
    pub fn during(&self, [from, to]: [f64; 2]) -> Result<Box<dyn FrictionLaw>, LawFailure> {
        if !(self.takes_means && to > from) {
            return self.of(&[(to, 1.0)], to);
        }
        let times = gauss(MEAN).into_iter().map(|(xi, w)| (from + 0.5 * (1.0 + xi) * (to - from), 0.5 * w));
        self.of(&times.collect::<Vec<_>>(), to)
    }

    /// The law with the parameters that are the mean of those at some times, up to the last.
    fn of(&self, times: &[(f64, f64)], time: f64) -> Result<Box<dyn FrictionLaw>, LawFailure> {
        let mean = |profile: &Profile| times.iter().map(|&(time, w)| w * profile.value_at(self.at, time)).sum();
        let values: Vec<f64> = self.profiles.iter().map(mean).collect();
        let law = if values.iter().all(|value: &f64| value.is_finite()) {
            (self.law)(&values, self.alpha_t).ok()
        } else {
            None
        };
        let law = law.ok_or(LawFailure::Undefined { time })?;
        if let Some([rate, least]) = self.offsets.beyond(&*law) {
            return Err(LawFailure::Dilates { time, rate, least });
        }
        Offset::over(law, self.offsets).map_err(|_| LawFailure::Undefined { time })
    }
}
