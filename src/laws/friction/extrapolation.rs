//! Integration of an increment whose law is known by steps of first order: extrapolated sub-steps with error control.

use super::LawFailure;
use crate::laws::dual::{Dual, Number};

/// Number of the shortest sub-steps in an increment.
pub(super) const WHOLE: u64 = 1 << 52;

/// Length of sub-steps that may contain a jump, if slip and pressure have almost no effect in them ...
const SHORT: u64 = 1 << 22;

/// ... defined by this fraction of the tolerance in the tractions.
const SNAP: f64 = 1e-3;

/// Maximum number of sub-steps tried before an increment is rejected as far too long.
const MOST_ATTEMPTS: usize = 20_000;

/// Maximum number of extrapolation rows: a sub-step is integrated by 1, 2, ... increments of first order.
const MOST_ROWS: usize = 4;

/// Errors of 2, 3 and 4 rows, in tolerances, above which further rows are not sufficient.
const HOPELESS: [f64; MOST_ROWS] = [f64::INFINITY, 1e4, 1e2, 1.0];

/// Error, in tolerances, below which the next sub-step may be twice as long.
const DOUBLED: f64 = 0.1;

/// An increment with slip and pressure linear in time, which is integrated by steps of first order; `N` quantities of its state
/// are extrapolated.
pub(super) trait FirstOrder<const N: usize> {
    /// State at an integration point
    type State: Clone;

    /// A sub-step from the place `at` by `count` equal steps of first order.
    ///
    /// # Errors
    /// Those of the law.
    fn increments(&mut self, from: &Self::State, at: u64, step: u64, count: usize) -> Result<Self::State, LawFailure>;

    /// The quantities that are extrapolated.
    fn entry(&self, state: &Self::State) -> [Dual; N];

    /// State at the end of a sub-step represented by an entry; `fine` is located there too.
    fn state(&self, entry: &[Dual; N], fine: Self::State) -> Self::State;

    /// Change of an entry by the next extrapolation, in tolerances; `factor` multiplies the difference to the entry above.
    fn error(&self, entries: [&[Dual; N]; 2], factor: f64, ends: [&Self::State; 2], step: u64) -> f64;

    /// Maximum change of tractions by slip and pressure over a sub-step without a jump, in tolerances.
    fn drive(&self, from: &Self::State, step: u64) -> f64;

    /// Reason why no sub-step is short enough.
    fn failure(&self, from: &Self::State, step: u64) -> LawFailure;

    /// State at the end: sub-steps are halved until their error is below the tolerance, and doubled where possible.
    ///
    /// # Errors
    /// Returns [`LawFailure`] if sub-steps do not converge.
    fn end(&mut self, start: &Self::State) -> Result<Self::State, LawFailure> {
        let (mut state, mut at, mut step) = (start.clone(), 0, WHOLE);
        for _ in 0..MOST_ATTEMPTS {
            let (next, error, few) = match self.extrapolated(&state, at, step) {
                Ok(found) => found,
                Err(_) if step > 1 => {
                    step /= 2;
                    continue;
                }
                Err(failure) => return Err(failure),
            };
            let snaps = step <= SHORT && self.drive(&state, step) <= SNAP;
            if error > 1.0 && !snaps || error.is_nan() {
                if step == 1 {
                    break;
                }
                step /= 2;
                continue;
            }
            (state, at) = (next, at + step);
            if at == WHOLE {
                return Ok(state);
            }
            if (error <= DOUBLED || few || snaps) && at % (2 * step) == 0 {
                step *= 2;
            }
        }
        Err(self.failure(&state, step))
    }

    /// State at the end of a sub-step, its error in tolerances, and whether it has taken few rows, so that twice the length may do.
    ///
    /// ```text
    /// T_j1: the sub-step by j increments of first order,   T_j,k+1 = T_jk + (T_jk − T_j−1,k)/(j/(j − k) − 1)
    /// ```
    /// T_jj is of order j, and its difference from T_j,j−1 bounds its error. Across a jump no extrapolation is made: the result
    /// of the finest row is used.
    ///
    /// Source: Deuflhard (1985), SIAM Review 27, 505; Hairer & Wanner, Solving Ordinary Differential Equations II, IV.9.
    fn extrapolated(&mut self, from: &Self::State, at: u64, step: u64) -> Result<(Self::State, f64, bool), LawFailure> {
        let (mut rows, mut error): (Vec<[Dual; N]>, f64) = (Vec::with_capacity(MOST_ROWS), f64::INFINITY);
        let mut fine = from.clone();
        for j in 1..=MOST_ROWS {
            fine = self.increments(from, at, step, j)?;
            let mut entry = self.entry(&fine);
            let mut row = vec![entry];
            for (k, above) in rows.iter().enumerate() {
                let factor = 1.0 / (j as f64 / (j - k - 1) as f64 - 1.0);
                error = self.error([&entry, above], factor, [from, &fine], step);
                entry = std::array::from_fn(|i| entry[i] + (entry[i] - above[i]) * factor);
                row.push(entry);
            }
            rows = row;
            if j > 1 && error <= 1.0 {
                return Ok((self.state(&entry, fine), error, j < MOST_ROWS));
            }
            if error > HOPELESS[j - 1] && step > SHORT {
                break;
            }
        }
        Ok((fine, error, false))
    }
}

/// Changes of the values of entries by the next extrapolation.
pub(super) fn changes<const N: usize>([entry, above]: [&[Dual; N]; 2], factor: f64) -> [f64; N] {
    std::array::from_fn(|i| factor * (entry[i].value() - above[i].value()).abs())
}

/// Largest of errors as fractions of what is allowed; an exact 0 has none, whatever is allowed.
pub(super) fn largest_share<const N: usize>(parts: [[f64; 2]; N]) -> f64 {
    let shares = parts.map(|[part, allowed]| if part == 0.0 { 0.0 } else { part / allowed });
    if shares.iter().any(|share| share.is_nan()) { f64::NAN } else { shares.into_iter().fold(0.0, f64::max) }
}

/// Fraction of the increment that a number of the shortest sub-steps is.
pub(super) fn share(of: u64) -> f64 {
    of as f64 / WHOLE as f64
}
