//! Law test: a friction law driven without a mesh along a path of slip, pressure and time.
//!
//! The path prescribes slip and pressure as functions of time; steps end at their turning points. An interface that opens with slip
//! answers with its pressure as its [`Confinement`] makes it: under constant load, constant normal stiffness or constant volume. A bond
//! in parallel with friction follows the opening of the path; where that is positive friction has no pressure.
//!
//! With a [`Slider`] the path is that of a load point, whose spring pulls a mass along.
//!
//! # Report
//!
//! The report collects the responses of the law, its peaks and holds.
//!
//! ```
//! use fecontact::laws::friction::{SuperSubloading, SuperSubloadingParameters};
//! use fecontact::model::boundary::{Drive, Span};
//! use fecontact::run::law::{LawTest, PathDrive, Phase};
//!
//! let parameters = SuperSubloadingParameters::new(0.4, 0.2, 1000.0).kappa(100.0).xi(0.01);
//! let law = SuperSubloading::new(&parameters, 1e5)?;
//! let slip = PathDrive::new(Drive::Rate(0.1), 0.0);
//! let pressure = PathDrive::new(Drive::Constant(10.0), 10.0);
//! let slide = Phase::new(Span { start: 0.0, end: 1.0 }, slip, pressure, 0.01)?;
//! let mut tractions = Vec::new();
//! let (report, ended) = LawTest::new(law, vec![slide]).run(|row| {
//!     tractions.push(row.response.state.traction);
//!     Ok(())
//! });
//! ended?;
//! let peak = report.peaks.peak.expect("it slides");
//! // Steady sliding at the rate V: κ (μ/μ_k − 1) V = ξ (1 − μ/μ_s).
//! let steady = (100.0 * 0.1 + 0.01) / (100.0 * 0.1 / 0.2 + 0.01 / 0.4);
//! assert!((tractions[100] - steady * 10.0).abs() < 1e-6 && steady < peak.coefficient && peak.coefficient < 0.4);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod derivatives;
mod path;
mod report;
mod slider;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use self::derivatives::Derivatives;
use self::slider::{Integrator, Step};
use crate::laws::friction::{
    BondState, Cohesion, Confinement, ContactLaw, FrictionLaw, FrictionResponse, FrictionState, Sliding,
};
use crate::laws::text::distinct;
use crate::run::error::Error;

pub use self::derivatives::OF_MACHINE;
pub use self::path::{PathDrive, Phase, Undefined};
pub use self::report::{Hold, LawBond, LawMachine, LawReport, LawRow, PathPoint, Peaks};
pub use self::slider::Slider;

/// A law test: initial state and prescribed path.
#[derive(Debug)]
#[non_exhaustive]
pub struct LawTest {
    /// the law, with the dilatancy and wear of the interface
    pub law: ContactLaw,
    /// state at the start of the path
    pub start: FrictionState,
    /// part of the traction at the start that a bond in parallel with friction has [F/L²]
    pub of_bond: f64,
    /// how the pressure answers to the opening of the interface; it does not by default
    pub confinement: Confinement,
    /// the path, at least one phase
    pub path: Vec<Phase>,
    /// machine that pulls a mass: the slip of the path is that of its load point; none by default
    pub slider: Option<Slider>,
    /// parameters of the law, and of a slider `stiffness` and `mass`, by which the traction is differentiated, of a slider the force; a
    /// law without [`FrictionLaw::sensitivities`] has no derivatives, and those by other names are NaN
    pub by: Vec<String>,
    /// set from elsewhere, ends the test before its next step
    pub interrupt: Arc<AtomicBool>,
}

impl LawTest {
    /// Creates a test that drives the law along a path from its stationary state under the initial pressure.
    pub fn new(law: impl FrictionLaw + 'static, path: Vec<Phase>) -> Self {
        Self::of(law.into(), path)
    }

    /// The same for the law of an interface.
    #[doc(hidden)]
    pub fn of(law: ContactLaw, path: Vec<Phase>) -> Self {
        let pressure = path.first().map_or(0.0, |phase| phase.pressure(phase.start()));
        let (start, confinement) = (law.law.initial_state(pressure, 0.0), Confinement::default());
        Self { law, start, of_bond: 0.0, confinement, path, slider: None, by: Vec::new(), interrupt: Arc::default() }
    }

    /// Names of the derivatives of a row.
    pub fn derivatives(&self) -> impl Iterator<Item = String> {
        let of = if self.slider.is_some() { "force" } else { "traction" };
        self.by.iter().map(move |name| format!("d{of}_d{name}"))
    }

    /// Drives the law along its path and passes every step to `tell`, of a slider every one that ends at a time of the path. The report is
    /// returned for a stopped test as well.
    ///
    /// The first row is the start: the response to zero slip in zero time.
    ///
    /// # Errors
    /// Returns [`Error`] if the law fails or a row cannot be written.
    pub fn run(&self, mut record: impl FnMut(&LawRow) -> Result<(), Error>) -> (LawReport, Result<(), Error>) {
        let mut report = LawReport::default();
        let mut tell = |row: LawRow| {
            report.note(&row);
            self.warn(&mut report, &row);
            record(&row)
        };
        let law = self.law.law.sensitivities().filter(|_| !self.by.is_empty());
        let mut derivatives = law.map(|law| Derivatives::new(law, self.slider, &self.by));
        let result = self.follow(|step| {
            if self.interrupt.load(Ordering::Relaxed) {
                return Err(Error::Interrupted);
            }
            match &mut derivatives {
                Some(derivatives) => derivatives.take(step)?.into_iter().try_for_each(&mut tell),
                None => step.row.map_or(Ok(()), |row| tell(*row)),
            }
        });
        let rest = derivatives.map_or(Ok(Vec::new()), |mut derivatives| derivatives.rows());
        let rest = rest.and_then(|rows| rows.into_iter().try_for_each(&mut tell));
        (report, result.and(rest))
    }

    fn follow(&self, take: impl FnMut(Step) -> Result<(), Error>) -> Result<(), Error> {
        match self.slider {
            Some(slider) => {
                Integrator::new(slider, &self.law, &self.start, self.confinement, &self.path).follow(&self.path, take)
            }
            None => self.drive(take),
        }
    }

    fn drive(&self, mut take: impl FnMut(Step) -> Result<(), Error>) -> Result<(), Error> {
        let Some(first) = self.path.first() else { return Ok(()) };
        let mut time = first.start();
        let mut slip = first.slip(time);
        let mut state = self.start.clone();
        let mut bond = self.bond_at_start(first);
        let mut step = |to: f64, phase: &Phase| {
            let opening = phase.opening(to).max(0.0);
            let applied = if opening > 0.0 { 0.0 } else { phase.pressure(to) };
            let confined = self.confinement.confined(applied, self.start.pressure);
            let sliding = Sliding { slip: phase.slip(to) - slip, pressure: confined.pressure, dt: to - time };
            let response = self.law.respond_confined(&state, sliding, confined);
            let mut response = response.map_err(|cause| Error::Law { time, cause })?;
            if let (Some(Cohesion::Parallel(law)), Some((before, lost))) = (&self.law.cohesion, &mut bond) {
                let answer = law.respond(before, opening, sliding.slip, false);
                if opening == 0.0 {
                    self.law.limit(&state, &mut response, answer.state.traction);
                }
                (*before, *lost) = (answer.state, *lost + answer.dissipation);
            }
            let sliding = Sliding { pressure: response.state.pressure, ..sliding };
            let old = std::mem::replace(&mut state, response.state.clone());
            let start = std::mem::replace(&mut time, to);
            slip = phase.slip(to);
            let row = Some(Box::new(self.row(time, slip, response, bond)));
            take(Step { time: start, old, sliding, moved: None, row })
        };
        step(first.start(), first)?;
        self.path.iter().try_for_each(|phase| phase.times().try_for_each(|to| step(to, phase)))
    }

    /// State of a bond in parallel with friction, which has its part of the traction at the start, and what it has dissipated.
    fn bond_at_start(&self, first: &Phase) -> Option<(BondState, f64)> {
        let Some(Cohesion::Parallel(bond)) = &self.law.cohesion else { return None };
        let opening = first.opening(first.start());
        Some((bond.start((opening > 0.0).then_some(opening), self.of_bond), 0.0))
    }

    fn row(&self, time: f64, slip: f64, response: FrictionResponse, bond: Option<(BondState, f64)>) -> LawRow {
        let state = &response.state;
        let (gap, mu) = (self.confinement.gap(state, self.start.pressure), self.law.observe("mu", state));
        let bond = match (&self.law.cohesion, bond) {
            (Some(Cohesion::Parallel(law)), Some((own, lost))) => Some(LawBond {
                opening: own.opening,
                pressure: state.pressure - own.tension,
                traction: state.traction + own.traction,
                dissipation: state.dissipation + lost,
                intact: law.intact(&own),
            }),
            _ => None,
        };
        LawRow { time, slip, response, mu, gap, bond, machine: None, derivatives: Vec::new() }
    }

    /// Warns once of a pressure above which the response may not be unique.
    fn warn(&self, report: &mut LawReport, row: &LawRow) {
        let (time, pressure) = (row.time, row.response.state.pressure);
        if let Some(limit) =
            self.law.description.uniqueness_limit().filter(|limit| report.warnings.is_empty() && pressure > *limit)
        {
            let [pressure, limit] = distinct([pressure, limit]);
            report.warnings.push(format!(
                "the pressure {pressure} at t = {time} exceeds {limit}, above which the response is not unique: the \
                 law may weaken faster than the contact stiffness unloads, and the traction jumps; raise alpha_t"
            ));
        }
    }
}
