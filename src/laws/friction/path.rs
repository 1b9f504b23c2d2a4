//! One increment along linear paths of slip, pressure and time, in sub-steps where the tolerance asks for them.

use super::LawFailure;
use super::sub_step::{Derivative, LoadPath, Station};

/// Sub-steps are halved at most so often: until slip, pressure and time no longer change in floating point.
const MAX_HALVINGS: u32 = 48;

/// Evaluations of the slip equation after which the increment is given up: it is far too long.
const MAX_EVALUATIONS: usize = 20_000;

/// A sub-step in which q and μ p change by this share of the tolerance, but for a snap, is short enough to hold a snap.
const SNAP: f64 = 1e-3;

/// Errors below this, relative to the tractions they come from, are round-off.
const NOISE: f64 = 2e-13;

/// The difference of two stations over the error of the value extrapolated from them, where it converges slowly.
const CAUTION: f64 = 4.0;

/// In q, in μ p and in the work done
type Differences = [f64; 3];

/// A sub-step, and the same in two halves.
#[derive(Clone, Copy)]
struct Halves<'a> {
    from: &'a Station,
    coarse: &'a Station,
    middle: &'a Station,
    fine: &'a Station,
}

impl Halves<'_> {
    /// Whether there is plastic slip in the whole and in both halves.
    fn slide(&self) -> bool {
        let slips = |from: &Station, to: &Station| to.plastic_slip > from.plastic_slip;
        slips(self.from, self.coarse) && slips(self.from, self.middle) && slips(self.middle, self.fine)
    }
}

impl LoadPath<'_> {
    /// The end of the path: one step where that is right by itself.
    ///
    /// # Errors
    /// [`LawFailure::NotConverged`] when sub-steps do not come to agree.
    pub(super) fn end(&mut self, start: &Station) -> Result<Station, LawFailure> {
        let end = self.advance(start, 1.0)?;
        if self.is_right_alone(start, &end) {
            return Ok(end);
        }
        self.refine(start, end, [0.0; 3], MAX_HALVINGS)
    }

    /// The station at the x of `coarse`, which one sub-step from `from` has reached, to within the tolerance.
    ///
    /// Two halves of the sub-step are compared with the whole and, where they differ too much, refined in their turn.
    /// As errors are proportional to the third power of the sub-step, the difference should then be an eighth: what it
    /// is `expected` to be. What it differs from that is an error that extrapolation cannot remove.
    ///
    /// Where the traction snaps the halves never agree: a sub-step that is so short that nothing else can happen in it is
    /// a snap, whose place is known as well as the tolerance asks.
    fn refine(
        &mut self,
        from: &Station,
        coarse: Station,
        expected: Differences,
        halvings: u32,
    ) -> Result<Station, LawFailure> {
        let middle = self.advance(from, 0.5 * (from.x + coarse.x))?;
        let fine = self.advance(&middle, coarse.x)?;
        let halves = Halves { from, coarse: &coarse, middle: &middle, fine: &fine };
        let (differences, allowed) = (self.differences(&halves), self.allowed(&halves));
        let overlooked = coarse.overlooked.max(middle.overlooked).max(fine.overlooked);
        let agree = overlooked <= allowed[0]
            && (0..3).all(|i| {
                let left = differences[i].abs() / CAUTION;
                let left = if halves.slide() { left.min((differences[i] - expected[i]).abs()) } else { left };
                left <= allowed[i]
            });
        if agree {
            return Ok(if halves.slide() { self.extrapolated(&halves) } else { fine });
        }
        if self.drive(from, &fine) <= SNAP * self.tolerance * self.evolution.mu_s * self.pressure(fine.x) {
            return Ok(fine);
        }
        if halvings == 0 || self.evaluations > MAX_EVALUATIONS {
            let trial = from.traction + self.alpha_t * self.slip * (fine.x - from.x);
            let rest = differences[0].abs().max(overlooked);
            return Err(LawFailure::NotConverged { evaluations: self.evaluations, rest, trial });
        }
        let expected = differences.map(|difference| difference / 8.0);
        let middle = self.refine(from, middle, expected, halvings - 1)?;
        let coarse = self.advance(&middle, coarse.x)?;
        self.refine(&middle, coarse, expected, halvings - 1)
    }

    /// Most that slip, pressure and time change the traction or the strength by over a sub-step without a snap.
    fn drive(&self, from: &Station, to: &Station) -> f64 {
        let share = to.x - from.x;
        let recovery =
            self.evolution.recovery(from.mu.min(to.mu)) * self.time * self.pressure(from.x).max(self.pressure(to.x));
        share
            * (self.alpha_t * self.slip.abs()
                + self.evolution.mu_s * (self.pressures[1] - self.pressures[0]).abs()
                + recovery)
    }

    /// Differences between a sub-step and its halves.
    fn differences(&self, halves: &Halves) -> Differences {
        let Halves { coarse, fine, .. } = *halves;
        [
            fine.traction - coarse.traction,
            (fine.mu - coarse.mu) * self.pressure(fine.x),
            self.energy(fine) - self.energy(coarse),
        ]
    }

    /// Differences that are allowed to a sub-step: more than its share of the tolerance in q and μ p, as R and μ forget
    /// errors in the course of slip; its share in the work, for the mean of q is to be right to the tolerance.
    fn allowed(&self, halves: &Halves) -> Differences {
        let Halves { from, fine, .. } = *halves;
        let share = fine.x - from.x;
        let (start_pressure, pressure) = (self.pressure(from.x), self.pressure(fine.x));
        let slip = self.slip.abs() * share;
        let noise = NOISE * (fine.traction + from.traction + self.alpha_t * slip);
        let tolerance = self.tolerance * self.evolution.mu_s;
        let strength = tolerance * pressure * (share * share.sqrt()).sqrt() + noise;
        let work = (tolerance * pressure.max(start_pressure) + noise) * (slip + fine.plastic_slip - from.plastic_slip);
        [strength, strength, work + NOISE * self.energy(fine)]
    }

    /// The finer of two stations after plastic slip, extrapolated to vanishing sub-steps.
    fn extrapolated(&self, halves: &Halves) -> Station {
        let Halves { from, coarse, fine, .. } = *halves;
        let beyond = |fine: f64, coarse: f64| fine + (fine - coarse) / 3.0;
        let beyond_each = |fine: Derivative, coarse: Derivative| [0, 1].map(|i| beyond(fine[i], coarse[i]));
        let pressure = self.pressure(fine.x);
        let (mut mu, mut dmu) = (beyond(fine.mu, coarse.mu), beyond_each(fine.dmu, coarse.dmu));
        if mu != self.evolution.clamp(mu) {
            dmu = [0, 1]
                .map(|i| self.parameters.map_or(0.0, |shifts| self.evolution.clamped_by(mu, 0.0, &shifts[i].peak)));
            mu = self.evolution.clamp(mu);
        }
        let mut traction = beyond(fine.traction, coarse.traction).max(0.0);
        let mut dtraction = beyond_each(fine.dtraction, coarse.dtraction);
        if traction > mu * pressure {
            let dpressure = self.dpressure(fine.x);
            (traction, dtraction) = (mu * pressure, [0, 1].map(|i| pressure * dmu[i] + mu * dpressure[i]));
        }
        let energy = beyond(self.energy(fine), self.energy(coarse));
        Station {
            x: fine.x,
            traction,
            dtraction,
            mu,
            dmu,
            reach: self.curve.start(traction / (mu * pressure)),
            plastic_slip: beyond(fine.plastic_slip, coarse.plastic_slip).max(from.plastic_slip),
            work: (energy - 0.5 * traction * traction / self.alpha_t).max(from.work),
            overlooked: 0.0,
        }
    }

    /// Work done by the traction: dissipated, and stored in the contact spring.
    fn energy(&self, station: &Station) -> f64 {
        station.work + 0.5 * station.traction * station.traction / self.alpha_t
    }
}
