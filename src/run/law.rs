//! A friction law alone, driven along a path of slip, pressure and time.

use crate::laws::friction::{FrictionLaw, FrictionResponse, FrictionState, Sliding, observables};
use crate::run::error::Error;
use crate::run::law_path::Phase;
use crate::run::law_report::{LawReport, LawRow};

/// A test of a law: where it starts and where it is led.
#[derive(Debug)]
pub struct LawTest {
    /// the law
    pub law: Box<dyn FrictionLaw>,
    /// state at the start of the path
    pub start: FrictionState,
    /// the path, at least one phase
    pub path: Vec<Phase>,
}

impl LawTest {
    /// Lead the law along its path, telling every step. The report comes back from a stopped test as well.
    ///
    /// The first row is the start: what the law answers to no slip in no time.
    ///
    /// # Errors
    /// [`Error`] when the law cannot answer, or a row cannot be written.
    pub fn run(&self, mut tell: impl FnMut(&LawRow) -> Result<(), Error>) -> (LawReport, Result<(), Error>) {
        let mut report = LawReport::default();
        let result = self.follow(|row| {
            report.note(row);
            self.warn(&mut report, row);
            tell(row)
        });
        (report, result)
    }

    fn follow(&self, mut tell: impl FnMut(&LawRow) -> Result<(), Error>) -> Result<(), Error> {
        let Some(first) = self.path.first() else { return Ok(()) };
        let mut time = first.start();
        let mut slip = first.slip(time);
        let mut state = self.start;
        let mut step = |to: f64, phase: &Phase| {
            let sliding = Sliding { slip: phase.slip(to) - slip, pressure: phase.pressure(to), dt: to - time };
            let response = self.law.respond(&state, sliding).map_err(|cause| Error::Law { time, cause })?;
            (time, slip, state) = (to, phase.slip(to), response.state);
            tell(&self.row(time, slip, response))
        };
        step(first.start(), first)?;
        self.path.iter().try_for_each(|phase| phase.times().try_for_each(|to| step(to, phase)))
    }

    fn row(&self, time: f64, slip: f64, response: FrictionResponse) -> LawRow {
        LawRow { time, slip, response, mu: observables::value(&*self.law, "mu", &response.state) }
    }

    /// Warn once of a pressure beyond which the law may have several answers.
    fn warn(&self, report: &mut LawReport, row: &LawRow) {
        let (time, pressure) = (row.time, row.response.state.pressure);
        if let Some(limit) = self.law.uniqueness_limit().filter(|limit| report.warnings.is_empty() && pressure > *limit)
        {
            report.warnings.push(format!(
                "the pressure {pressure:.6e} at t = {time} passes {limit:.6e}, above which weakening may outrun the \
                 contact stiffness and the answer snaps; raise alpha_t"
            ));
        }
    }
}
