//! Runs by which a factor of safety is found: the case itself, then one trial after another ([`Search`]).

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::job::{Callbacks, Ends, Failed, Job, Outcome, Refused};
use super::safety::{Reduced, Search, Trial, table};
use super::{Opened, Written, warnings};
use crate::model::Model;
use crate::output::report::{self, ReportError};
use crate::run::error::{Error, IncrementFailure};
use crate::run::observer::{Attempt, Observer};

/// Growth of the displacement over the elastic one above which a trial has failed, whether a new equilibrium follows or not.
pub const GROWTH: f64 = 10.0;

/// Displacements that count as none, as a fraction of the mesh.
const NO_MOTION: f64 = 1e-9;

/// Reason why no factor was found.
#[derive(Debug)]
pub enum Unfound {
    /// The case is invalid, or a folder cannot be used.
    Refused(Refused),
    /// A run stopped for another reason than that the strengths fail, or results could not be written.
    Failed(Failed),
}

conversions! {
    Refused => Unfound: |refused| Self::Refused(refused);
    Failed => Unfound: |failed| Self::Failed(failed);
    Error => Unfound: |error| Self::Failed(Failed::Stopped(error));
}

/// The trials of a case, each in a folder of its own.
pub struct Trials {
    written: Written,
    reduced: Reduced,
    place: PathBuf,
    within: f64,
    ends: Ends,
    found: Vec<Trial>,
    /// Factors between which failure lies so far
    pub search: Search,
}

impl Trials {
    /// Runs the case into the folder `end` of `place`, from whose end the strengths are divided.
    ///
    /// # Errors
    /// Returns [`Unfound`] if the case is invalid, has no strengths to divide, or its own run stopped.
    pub fn begin(
        written: Written,
        reduced: Reduced,
        [within, most]: [f64; 2],
        place: &Path,
        warn: &dyn Fn(&str),
        ends: Ends,
    ) -> Result<Self, Unfound> {
        reduced.check(&written).map_err(Refused::from)?;
        let mut job = Job::open(Opened::begin(written.clone()).map_err(Refused::from)?, &place.join("end"))?;
        warnings(&job.opened.case, &job.model).iter().for_each(|warning| warn(warning));
        let callbacks = Callbacks { warn: Arc::new(|_| ()), ends: ends.clone(), progress: None };
        let Outcome { ended, written: summary, .. } = job.run(callbacks)?;
        ended?;
        summary?;
        Ok(Self {
            written,
            reduced,
            place: place.to_owned(),
            within,
            ends,
            found: Vec::new(),
            search: Search::new(most),
        })
    }

    /// Runs the next trial, and writes the table of all; `None` once the factor is found, or the largest one stands.
    ///
    /// # Errors
    /// Returns [`Unfound`] if the trial ends for another reason than that its strengths fail.
    pub fn next_trial(&mut self) -> Result<Option<Trial>, Unfound> {
        let Some(factor) = self.search.next(self.within) else { return Ok(None) };
        let end = self.place.join("end");
        let trial = self.run(self.reduced.job(&self.written, &end, factor, &self.folder(factor))?, factor)?;
        self.search.note(&trial);
        self.found.push(trial);
        let path = self.place.join("safety.csv");
        std::fs::write(&path, table(&self.found)).map_err(|cause| Error::Output { path, cause: cause.to_string() })?;
        Ok(Some(trial))
    }

    /// Folder of the trial of a factor.
    pub fn folder(&self, factor: f64) -> PathBuf {
        self.place.join(format!("F_{factor}"))
    }

    /// Runs a trial; a step without an equilibrium is an answer.
    fn run(&self, mut job: Job, factor: f64) -> Result<Trial, Unfound> {
        let saved = job.saved.as_ref();
        let begun = saved.map(|saved| saved.simulation().state().displacement.to_vec()).unwrap_or_default();
        let mesh = &job.model.mesh;
        let least = NO_MOTION * mesh.size_of(0..mesh.nodes.len());
        let progress = Arc::new(Mutex::new(Progress { begun, least, ..Progress::default() }));
        let Outcome { ended, written, .. } = job.run(self.callbacks(&progress))?;
        written?;
        if job.opened.case.output.report {
            let folders = std::slice::from_ref(&job.folder.path);
            report::write(folders, &job.folder.path.join(report::FILE)).map_err(|error| match error {
                ReportError::Output(error) => error,
                ReportError::Unreadable { .. } => Error::Ended(error.to_string()),
            })?;
        }
        let progress = locked(&progress);
        let ([reached, displacement], growth) = (progress.last, progress.growth(progress.last));
        let stands = match ended {
            _ if growth > GROWTH => false,
            Ok(()) => true,
            Err(Failed::Stopped(error)) if error.cause().is_some() => {
                if !progress.is_unbounded(&error) {
                    return Err(Error::Ended(format!(
                        "F = {factor}: {error}. That is not a failure of the strengths, since no displacement had grown \
                         to more than {GROWTH} times the elastic one; make the case easier to solve (finer increments \
                         or elements, softer penalties), and try again"
                    ))
                    .into());
                }
                false
            }
            Err(failed) => return Err(failed.into()),
        };
        Ok(Trial { factor, stands, reached, displacement, growth })
    }

    /// The caller ends a run, and so does a displacement that has grown beyond question.
    fn callbacks(&self, progress: &Arc<Mutex<Progress>>) -> Callbacks<'static> {
        let (asked, watched) = (self.ends.clone(), progress.clone());
        let ends = move || {
            let progress = locked(&watched);
            let fails = (progress.growth(progress.last) > GROWTH).then(|| {
                Error::Ended(format!(
                    "displacements have grown to more than {GROWTH} times the elastic ones: the strengths fail"
                ))
            });
            asked().or(fails)
        };
        Callbacks { warn: Arc::new(|_| ()), ends: Arc::new(ends), progress: Some(Box::new(Watch(progress.clone()))) }
    }
}

fn locked(progress: &Mutex<Progress>) -> MutexGuard<'_, Progress> {
    progress.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Largest displacement of a trial, and the fraction of the step there: after the first increment, after the last, and in the iterates
/// of the attempt after it that was rejected.
#[derive(Debug, Default)]
struct Progress {
    begun: Vec<f64>,
    /// Displacement that counts as none [L]
    least: f64,
    first: Option<[f64; 2]>,
    last: [f64; 2],
    rejected: [f64; 2],
}

impl Progress {
    /// A displacement over that of the first increment, carried on to the same fraction of the step.
    fn growth(&self, [reached, displacement]: [f64; 2]) -> f64 {
        let [share, first] = self.first.unwrap_or([reached, 0.0]);
        match displacement > self.least {
            true => displacement / (first.max(self.least) * reached / share),
            false => 1.0,
        }
    }

    /// Whether the strengths fail: there is no equilibrium, and either nothing resists the motion or displacements have grown, if only in
    /// the iterates, as those of a block that slides as a whole.
    fn is_unbounded(&self, error: &Error) -> bool {
        let is_free = matches!(error.cause(), Some(IncrementFailure::Floating(_) | IncrementFailure::ContactLost(_)));
        is_free || self.growth(self.rejected) > GROWTH
    }
}

struct Watch(Arc<Mutex<Progress>>);

impl Observer for Watch {
    fn record(&mut self, _: &Model, attempt: &Attempt) -> Result<(), Error> {
        let mut progress = locked(&self.0);
        let share = |time: f64| attempt.step.span.share(time);
        let Some(state) = attempt.accepted.filter(|_| !progress.begun.is_empty()) else {
            let corrections = attempt.iterations.iter().map(|iteration| iteration.newton.correction);
            let farthest = corrections.fold(0.0, f64::max);
            progress.rejected = [share(attempt.old.time + attempt.dt), progress.last[1] + farthest];
            return Ok(());
        };
        let moved = state.displacement.iter().zip(&progress.begun).map(|(now, begun)| (now - begun).abs());
        let now = [share(state.time), moved.fold(0.0, f64::max)];
        progress.first.get_or_insert(now);
        progress.last = now;
        progress.rejected = [0.0; 2];
        Ok(())
    }
}
