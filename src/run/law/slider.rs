//! Spring-slider: a mass on a friction law, pulled by the spring of a machine, all per area of the interface.
//!
//! ```text
//! M ü = F − q,   F = q₀ + k (w − w₀ − u)         w: way of the load point, u: slip, q: answer of the law to u, p and t
//! ```
//! Steps are those of Newmark's method with constant average acceleration: the intervals between two rows are halved, and halved again,
//! until (k + ∂q/∂u) h²/12 |Δü|, the error of a step in F and q, is below the tolerance times the largest pressure. A step begins from ü
//! as the last four of them go on, and ends with a correction of Newton's method for which the law is not asked again.
//!
//! ```
//! use fecontact::laws::friction::{Coulomb, CoulombParameters};
//! use fecontact::model::boundary::{Drive, Span};
//! use fecontact::run::law::{LawTest, PathDrive, Phase, Slider};
//!
//! let pull = PathDrive::new(Drive::Rate(0.2), 0.0);
//! let pressure = PathDrive::new(Drive::Constant(1.0), 1.0);
//! let path = vec![Phase::new(Span { start: 0.0, end: 1.0 }, pull, pressure, 0.1)?];
//! let mut test = LawTest::new(Coulomb::new(&CoulombParameters::new(10.0), 20.0)?, path);
//! test.slider = Some(Slider::new(3.0, 0.5));
//! test.by = vec!["mass".into()];
//! let mut last = None;
//! let (_, ended) = test.run(|row| {
//!     last = Some(row.clone());
//!     Ok(())
//! });
//! ended?;
//! // It sticks, and swings on two springs: u = k V/(k + α_t) (t − sin(ω t)/ω).
//! let omega = (23.0_f64 / 0.5).sqrt();
//! let slip = 3.0 * 0.2 / 23.0 * (1.0 - omega.sin() / omega);
//! let last = last.expect("rows");
//! assert!((last.slip - slip).abs() < 1e-5 && last.derivatives.len() == 1);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use schemars::JsonSchema;
use serde::Deserialize;

use super::path::Phase;
use super::report::{LawMachine, LawRow};
use crate::laws::friction::{Confined, Confinement, ContactLaw, FrictionResponse, FrictionState, LawFailure, Sliding};
use crate::laws::parameter::ratio;
use crate::run::error::Error;

/// Machine that pulls a mass with the law, all per area of the interface: M ü = F − q, F = q₀ + k (w − w₀ − u), with the way w of the load
/// point and the slip u, from rest and equilibrium
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Slider {
    /// k: stiffness of the spring, per area [F/L³]
    pub stiffness: f64,
    /// M: mass per area [F T²/L³]
    pub mass: f64,
    /// Error of force and traction in a step, as a fraction of the largest pressure; default: 1e-8 [-]
    #[serde(default = "ratio::<1, 100_000_000>")]
    pub tolerance: f64,
}

impl Slider {
    /// Creates a machine from k [F/L³] and M [F T²/L³].
    pub fn new(stiffness: f64, mass: f64) -> Self {
        Self { stiffness, mass, tolerance: 1e-8 }
    }
}

setters! { slider: Slider;
    /// Sets the error of a step, as a fraction of the largest pressure.
    tolerance(tolerance: f64) { slider.tolerance = tolerance; }
}

/// One step of a law along its path, and the row at its end if it ends at a time of the path.
#[derive(Debug)]
pub(super) struct Step {
    /// t at its start [T]
    pub time: f64,
    pub old: FrictionState,
    pub sliding: Sliding,
    /// of a slider, unless it is the start
    pub moved: Option<Moved>,
    pub row: Option<Box<LawRow>>,
}

/// How a slider moved in a step.
#[derive(Debug)]
pub(super) struct Moved {
    pub from: Motion,
    pub to: Motion,
    /// w − w₀ at the end [L]
    pub pulled: f64,
}

/// Where a slider is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Motion {
    /// u [L]
    pub slip: f64,
    /// u̇ [L/T]
    pub rate: f64,
    /// ü [L/T²]
    pub acceleration: f64,
    /// divided differences of the last ü, over 2, 3 and 4 of them [L/T³] to [L/T⁵]
    differences: [f64; 3],
    /// lengths of the last two steps [T]
    lengths: [f64; 2],
}

impl Motion {
    const REST: Self = Self { slip: 0.0, rate: 0.0, acceleration: 0.0, differences: [0.0; 3], lengths: [0.0; 2] };

    /// ü after dt, as its last values go on.
    fn expected(&self, dt: f64) -> f64 {
        let ([first, second, third], [last, before]) = (self.differences, self.lengths);
        self.acceleration + dt * (first + (dt + last) * (second + (dt + last + before) * third))
    }

    /// After a step with the slip Δu and an acceleration at its end.
    fn moved(&self, slip: f64, acceleration: f64, dt: f64) -> Self {
        let [last, before] = self.lengths;
        // Known before the acceleration: no division waits for another.
        let per = [dt, dt + last, dt + last + before].map(f64::recip);
        let first = (acceleration - self.acceleration) * per[0];
        let second = (first - self.differences[0]) * per[1];
        let third = (second - self.differences[1]) * per[2];
        Self {
            slip: self.slip + slip,
            rate: 2.0 * slip * per[0] - self.rate,
            acceleration,
            differences: [first, second, third],
            lengths: [dt, last],
        }
    }
}

/// Integration of a slider's motion.
pub(super) struct Integrator<'a> {
    slider: Slider,
    law: &'a ContactLaw,
    start: &'a FrictionState,
    confinement: Confinement,
    /// error of a step [F/L²]
    allowed: f64,
    /// w₀ [L]
    origin: f64,
    motion: Motion,
    state: FrictionState,
    /// longest step that the last one lets expect [T]
    longest: f64,
    steps: usize,
}

/// What pulls in a step.
#[derive(Clone, Copy)]
struct Pull {
    /// w − w₀ at the end [L]
    pulled: f64,
    confined: Confined,
    dt: f64,
}

/// The interval between two rows is 2⁴⁰ of the shortest steps.
const WHOLE: u64 = 1 << 40;
/// More steps than this are a slip of the keyboard.
const MOST_STEPS: usize = 5_000_000;
/// Newton's method: most iterations of a step, and by how much the last one may change q, as a share of the tolerance.
const MOST_ITERATIONS: usize = 12;
const SOLVED: f64 = 1e-4;
/// A step is doubled where its error is below this share of what is allowed: errors go with the third power.
const DOUBLED: f64 = 1.0 / 16.0;

impl<'a> Integrator<'a> {
    pub fn new(
        slider: Slider,
        law: &'a ContactLaw,
        start: &'a FrictionState,
        confinement: Confinement,
        path: &[Phase],
    ) -> Self {
        let pressures = path.iter().flat_map(|phase| {
            std::iter::once(phase.start()).chain(phase.times()).map(|time| phase.pressure(time).abs())
        });
        let allowed = slider.tolerance * pressures.fold(0.0, f64::max);
        let origin = path.first().map_or(0.0, |first| first.slip(first.start()));
        let (motion, state, longest) = (Motion::REST, start.clone(), f64::INFINITY);
        Self { slider, law, start, confinement, allowed, origin, motion, state, longest, steps: 0 }
    }

    /// Goes along the path.
    pub fn follow(mut self, path: &[Phase], mut take: impl FnMut(Step) -> Result<(), Error>) -> Result<(), Error> {
        let Some(first) = path.first() else { return Ok(()) };
        let time = first.start();
        let still = FrictionResponse::elastic(self.state.clone(), self.law.stiffness);
        let sliding = Sliding { slip: 0.0, pressure: self.state.pressure, dt: 0.0 };
        take(Step {
            time,
            old: self.state.clone(),
            sliding,
            moved: None,
            row: Some(Box::new(self.row(time, first, still))),
        })?;
        for phase in path {
            let mut from = phase.start();
            for to in phase.times() {
                self.between([from, to], phase, &mut take)?;
                from = to;
            }
        }
        Ok(())
    }

    /// Steps from one row to the next.
    fn between(
        &mut self,
        [from, to]: [f64; 2],
        phase: &Phase,
        take: &mut impl FnMut(Step) -> Result<(), Error>,
    ) -> Result<(), Error> {
        // Straight lines between rows, as of a given slip
        let ends = [phase.slip(from) - self.origin, phase.slip(to) - self.origin];
        let pressures = [phase.pressure(from), phase.pressure(to)];
        let between = |[from, to]: [f64; 2], at: u64| from + share(at) * (to - from);
        let (mut at, mut step) = (0, WHOLE);
        while (to - from) * share(step) > self.longest && step > 1 {
            step /= 2;
        }
        while at < WHOLE {
            let dt = (to - from) * share(step);
            let time = between([from, to], at);
            let confined = self.confinement.confined(between(pressures, at + step), self.start.pressure);
            let pull = Pull { pulled: between(ends, at + step), confined, dt };
            let next = self.step(pull);
            let error = next.as_ref().map_or(f64::INFINITY, |(answer, end)| {
                let stiffness = self.slider.stiffness + tangent(answer, confined).max(0.0);
                stiffness * dt * dt / 12.0 * (end.acceleration - self.motion.acceleration).abs()
            });
            let (answer, motion) = match next {
                Ok(next) if error <= self.allowed => next,
                _ if step > 1 && self.steps < MOST_STEPS => {
                    step /= 2;
                    continue;
                }
                Err(Some(cause)) => return Err(Error::Law { time, cause }),
                _ => return Err(Error::TooManySteps { time }),
            };
            at += step;
            self.steps += 1;
            let before = std::mem::replace(&mut self.motion, motion);
            let sliding = Sliding { slip: motion.slip - before.slip, pressure: answer.state.pressure, dt };
            let moved = Some(Moved { from: before, to: motion, pulled: pull.pulled });
            let row = (at == WHOLE).then(|| Box::new(self.row(to, phase, answer.clone())));
            let old = std::mem::replace(&mut self.state, answer.state);
            take(Step { time, old, sliding, moved, row })?;
            let doubles = error < DOUBLED * self.allowed;
            self.longest = if doubles { 2.0 * dt } else { dt };
            if doubles && at % (2 * step) == 0 && 2 * step <= WHOLE {
                step *= 2;
            }
        }
        Ok(())
    }

    /// The answer of the law and the motion at the end of a step; no failure of the law where it is not solved.
    fn step(&self, pull: Pull) -> Result<(FrictionResponse, Motion), Option<LawFailure>> {
        let (Pull { pulled, confined, dt }, from, Slider { stiffness, mass, .. }) = (pull, self.motion, self.slider);
        let per = 4.0 * mass / (dt * dt);
        let driven = self.start.traction + stiffness * (pulled - from.slip);
        let mut slip = 0.5 * dt * (2.0 * from.rate + 0.5 * dt * (from.acceleration + from.expected(dt)));
        for _ in 0..MOST_ITERATIONS {
            let sliding = Sliding { slip, pressure: confined.pressure, dt };
            let mut answer = self.law.respond_confined(&self.state, sliding, confined).map_err(Some)?;
            let inertia = per * (slip - dt * from.rate) - mass * from.acceleration;
            let residual = driven - stiffness * slip - answer.state.traction - inertia;
            let round_off = 4.0 * f64::EPSILON * (per * slip.abs() + inertia.abs());
            let tangent = tangent(&answer, confined);
            let correction = residual / (per + stiffness + tangent);
            let dtraction = tangent * correction;
            slip += correction;
            if residual.abs() <= self.allowed + round_off && dtraction.abs() <= SOLVED * self.allowed + round_off {
                answer.state.traction += dtraction;
                let acceleration = per * (slip - dt * from.rate) / mass - from.acceleration;
                return Ok((answer, from.moved(slip, acceleration, dt)));
            }
        }
        Err(None)
    }

    fn row(&self, time: f64, phase: &Phase, response: FrictionResponse) -> LawRow {
        let Motion { slip, rate: slip_rate, .. } = self.motion;
        let load_point = phase.slip(time);
        let force = self.start.traction + self.slider.stiffness * (load_point - self.origin - slip);
        let (gap, mu) =
            (self.confinement.gap(&response.state, self.start.pressure), self.law.observe("mu", &response.state));
        let machine = Some(LawMachine { load_point, force, slip_rate });
        LawRow { time, slip, response, mu, gap, bond: None, machine, derivatives: Vec::new() }
    }
}

/// ∂q/∂Δu_t along with the pressure that follows the opening, p = p_f + K d.
fn tangent(answer: &FrictionResponse, Confined { stiffness, .. }: Confined) -> f64 {
    if stiffness == 0.0 {
        return answer.dtraction_dslip;
    }
    let follows = stiffness * answer.dopening_dslip / (1.0 - stiffness * answer.dopening_dpressure);
    answer.dtraction_dslip + answer.dtraction_dpressure * follows
}

fn share(of: u64) -> f64 {
    of as f64 / WHOLE as f64
}
