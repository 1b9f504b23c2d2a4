//! How the answers of super/subloading friction vary with its parameters, by the controlled integration.

use super::increment::Directions;
use super::peak::{PeakShift, Shift};
use super::{EXCESS, SuperSubloading, falls, mu_of};
use crate::laws::friction::sensitivity::{Direction, SensitiveLaw, Variation};
use crate::laws::friction::{FrictionState, LawFailure, Sliding};

/// As [`SuperSubloadingParameters`](crate::laws::friction::SuperSubloadingParameters) names them.
const PARAMETERS: [&str; 10] = ["mu_s", "mu_k", "alpha_t", "r", "kappa", "xi", "m", "n", "elastic_core", "structure"];

fn shift(direction: &Direction) -> Shift {
    let [mu_s, mu_k, alpha_t, r, kappa, xi, m, n, elastic_core] = std::array::from_fn(|place| direction.of(place));
    Shift { alpha_t, r, elastic_core, peak: PeakShift { mu_s, mu_k, kappa, xi, m, n } }
}

impl SensitiveLaw for SuperSubloading {
    fn parameters(&self) -> &'static [&'static str] {
        &PARAMETERS
    }

    fn start(&self, parameter: usize) -> Variation {
        let dmu = match (PARAMETERS[parameter], self.structure) {
            ("mu_s", None) => 1.0,
            ("mu_k", Some(structure)) => structure,
            ("structure", Some(_)) => self.evolution.mu_k,
            _ => 0.0,
        };
        Variation::new(0.0, dmu)
    }

    fn vary(
        &self,
        old: &FrictionState,
        sliding: Sliding,
        directions: [Direction; 2],
    ) -> Result<[Variation; 2], LawFailure> {
        let Sliding { slip, pressure, dt } = sliding.checked()?;
        let shifts = directions.map(|direction| shift(&direction));
        let mut by = Directions {
            slip: directions.map(|direction| direction.slip),
            pressure: [0.0; 2],
            traction: directions.map(|direction| direction.state.traction),
            mu: [0, 1].map(|i| self.evolution.clamped_by(mu_of(old), directions[i].variable(), &shifts[i].peak)),
            parameters: Some(shifts),
        };
        let rested = |mu: f64, by: &Directions| {
            [0, 1].map(|i| self.evolution.rested_by(mu, dt, [by.mu[i], 0.0], &shifts[i].peak))
        };
        if pressure <= 0.0 {
            return Ok(rested(self.evolution.clamp(mu_of(old)), &by).map(|dmu| Variation::new(0.0, dmu)));
        }
        let within = self.within_strength(old);
        if old.traction.abs() > mu_of(&within) * old.pressure.max(0.0) * (1.0 + EXCESS) {
            by.traction = by.mu.map(|dmu| old.traction.signum() * old.pressure.max(0.0) * dmu);
        }
        let trial = within.traction + self.alpha_t * slip;
        if falls(&within, trial, pressure) {
            let dmu = rested(mu_of(&within), &by);
            let dtraction = [0, 1].map(|i| by.traction[i] + self.alpha_t * by.slip[i] + slip * shifts[i].alpha_t);
            return Ok([0, 1].map(|i| Variation::new(dtraction[i], dmu[i])));
        }
        let (mut path, start, sign) = self.lead(&within, trial, sliding, &by);
        let end = path.end(&start)?;
        Ok([0, 1].map(|i| Variation::new(sign * end.dtraction[i], end.dmu[i])))
    }
}
