//! The path that an increment of super/subloading friction follows.

use super::sub_step::{Derivative, Directions, LoadPath, Station};
use super::super_subloading::{SuperSubloading, mu_of};
use super::{FrictionState, Sliding};

impl SuperSubloading {
    /// The path of an increment in which slip may be plastic: from the start, or from where the traction passes 0; its first
    /// station, and the sign of the traction, by which both are mirrored.
    pub(super) fn lead(
        &self,
        old: &FrictionState,
        trial: f64,
        Sliding { slip, pressure, dt }: Sliding,
        by: &Directions,
    ) -> (LoadPath<'_>, Station, f64) {
        let reversed = old.traction != 0.0 && trial * old.traction.signum() < 0.0;
        let sign = if reversed || old.traction == 0.0 { trial.signum() } else { old.traction.signum() };
        let mirrored = |derivative: Derivative| derivative.map(|d| sign * d);
        let by = &Directions { slip: mirrored(by.slip), traction: mirrored(by.traction), ..*by };
        let mut path = LoadPath {
            curve: &self.curve,
            evolution: &self.evolution,
            alpha_t: self.alpha_t,
            tolerance: self.tolerance,
            slip: sign * slip,
            dslip: by.slip,
            pressures: [old.pressure, pressure],
            dpressures: [[0.0; 2], by.pressure],
            time: dt,
            dtime: [0.0; 2],
            parameters: by.parameters,
            evaluations: 0,
        };
        let start = if reversed {
            let share = old.traction / (old.traction - trial);
            self.pass_zero(&mut path, (mu_of(old), trial), share, by)
        } else {
            path.start((old.traction.abs(), by.traction), (mu_of(old), by.mu), old.ratio(mu_of(old)).min(1.0))
        };
        (path, start, sign)
    }

    /// Leave to the path what comes after the share of the increment at which the traction passes 0; its first station.
    fn pass_zero(&self, path: &mut LoadPath, (old_mu, trial): (f64, f64), share: f64, by: &Directions) -> Station {
        let (alpha_t, slip, dt) = (self.alpha_t, path.slip, path.time);
        let dstiffness = [0, 1].map(|i| by.parameters.map_or(0.0, |shifts| shifts[i].alpha_t));
        let dshare = [0, 1]
            .map(|i| -share / slip * by.slip[i] - by.traction[i] / (alpha_t * slip) - share * dstiffness[i] / alpha_t);
        let (mu, mu_rate) = self.evolution.rested(old_mu, dt * share);
        let dmu = [0, 1].map(|i| match &by.parameters {
            None => mu_rate * dt * dshare[i],
            Some(shifts) => self.evolution.rested_by(old_mu, dt * share, [by.mu[i], dt * dshare[i]], &shifts[i].peak),
        });
        let gain = path.pressures[1] - path.pressures[0];
        path.slip = trial.abs() / alpha_t;
        path.dslip = [0, 1].map(|i| {
            let dtrial = by.traction[i] + alpha_t * by.slip[i] + slip * dstiffness[i];
            dtrial / alpha_t - path.slip * dstiffness[i] / alpha_t
        });
        path.dpressures[0] = [0, 1].map(|i| gain * dshare[i] + share * by.pressure[i]);
        path.pressures[0] = path.pressure(share);
        path.time = dt * (1.0 - share);
        path.dtime = dshare.map(|dshare| -dt * dshare);
        path.start((0.0, [0.0; 2]), (mu, dmu), 0.0)
    }
}
