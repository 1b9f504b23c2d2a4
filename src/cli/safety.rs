//! `fecontact safety`: the factor by which strengths may be divided at the end of a run.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::failure::Failure;
use super::interrupt::Interrupt;
use super::place::default_folder;
use super::say::print;
use super::threads::use_threads;
use crate::case::job::{Callbacks, Failed, Job, Outcome};
use crate::case::safety::{Reduced, Search, Trial, table};
use crate::case::{Opened, Written, warnings};
use crate::model::Model;
use crate::output::report;
use crate::run::error::Error;
use crate::run::observer::{Attempt, Observer};

/// Options of `fecontact safety`.
#[derive(Clone, Debug)]
pub struct Stability {
    /// what is reduced
    pub reduced: Reduced,
    /// largest distance between a factor that stands and one that fails
    pub within: f64,
    /// largest factor that is tried
    pub most: f64,
    /// folder of the results
    pub out: Option<PathBuf>,
    /// number of threads
    pub threads: Option<usize>,
}

/// Growth of the displacement over the elastic one above which a trial has failed, whether a new equilibrium follows or not.
const GROWTH: f64 = 10.0;

/// Displacements that count as none, as a fraction of the mesh.
const NO_MOTION: f64 = 1e-9;

/// Implements `fecontact safety`: the case and every trial are run into folders of their own.
///
/// # Errors
/// Returns [`Failure`] if the case is invalid or its own run stopped, or if the strengths never fail.
pub fn safety(path: &Path, stability: Stability) -> Result<(), Failure> {
    let Stability { reduced, within, most, out, threads } = stability;
    use_threads(threads)?;
    let positive = |name: &str, value: f64, least: f64| match value > least && value.is_finite() {
        true => Ok(()),
        false => Err(Failure::BadInput(format!("--{name}: is {value}: must be above {least}"))),
    };
    positive("within", within, 0.0)?;
    positive("most", most, 1.0)?;
    let place = out.unwrap_or_else(|| default_folder(path));
    let (written, interrupt) = (Written::read(path)?, Interrupt::watch());
    reduced.check(&written)?;
    let end = place.join("end");
    let mut job = Job::open(Opened::begin(written.clone())?, &end)?;
    warnings(&job.opened.case, &job.model).iter().for_each(|warning| say!("warning: {warning}"));
    let Outcome { ended, written: summary, .. } = job.run(callbacks(&interrupt, &Arc::default()))?;
    ended?;
    summary?;
    drop(job);
    let (mut search, mut trials) = (Search::new(most), Vec::new());
    while let Some(factor) = search.next(within) {
        let folder = place.join(format!("F_{factor}"));
        let trial = try_factor(reduced.job(&written, &end, factor, &folder)?, factor, &interrupt)?;
        let Trial { stands, reached, growth, .. } = trial;
        let found = match stands {
            true => "stands".into(),
            false if growth > GROWTH => format!("fails at {:.1} % of the step", 100.0 * reached),
            false => format!("fails, without an equilibrium from {:.1} % of the step on", 100.0 * reached),
        };
        print(&format!("F = {factor}: {found}; displacement {growth:.1} times the elastic one\n"))?;
        search.note(&trial);
        trials.push(trial);
        std::fs::write(place.join("safety.csv"), table(&trials))
            .map_err(|cause| Failure::Stopped(format!("{}: {cause}", place.join("safety.csv").display())))?;
    }
    conclude(&search, &place)
}

fn conclude(search: &Search, place: &Path) -> Result<(), Failure> {
    let Some(fails) = search.fails else {
        return Err(Failure::Stopped(format!(
            "the strengths stand even when divided by {}: give a larger --most",
            search.stands
        )));
    };
    let folder = place.join(format!("F_{fails}"));
    print(&format!("factor of safety: {} to {fails}; the mechanism is in {}\n", search.stands, folder.display()))?;
    Ok(())
}

/// Runs a trial; a step without an equilibrium is an answer.
fn try_factor(mut job: Job, factor: f64, interrupt: &Interrupt) -> Result<Trial, Failure> {
    let begun = job.saved.as_ref().map(|saved| saved.simulation().state().displacement.to_vec()).unwrap_or_default();
    let mesh = &job.model.mesh;
    let least = NO_MOTION * mesh.size_of(0..mesh.nodes.len());
    let course = Arc::new(Mutex::new(Course { begun, least, ..Course::default() }));
    let Outcome { ended, written, .. } = job.run(callbacks(interrupt, &course))?;
    written?;
    let page = job.opened.case.output.report;
    let page = page.then(|| report::write(std::slice::from_ref(&job.folder.path), &job.folder.path.join(report::FILE)));
    page.transpose()?;
    let course = locked(&course);
    let stands = match ended {
        _ if course.growth() > GROWTH => false,
        Ok(()) => true,
        Err(Failed::Stopped(Error::IncrementTooSmall { .. } | Error::Unsolvable { .. })) => false,
        Err(failed) => return Err(failed.into()),
    };
    let [reached, displacement] = course.last;
    Ok(Trial { factor, stands, reached, displacement, growth: course.growth() })
}

/// A signal ends a run, and so does a displacement that has grown beyond question.
fn callbacks(interrupt: &Interrupt, course: &Arc<Mutex<Course>>) -> Callbacks<'static> {
    let (interrupt, watched) = (interrupt.clone(), course.clone());
    let ends = move || {
        let fails = (locked(&watched).growth() > GROWTH).then(|| {
            Error::Ended(format!(
                "displacements have grown to more than {GROWTH} times the elastic ones: the strengths fail"
            ))
        });
        interrupt.came().then_some(Error::Interrupted).or(fails)
    };
    Callbacks { warn: Arc::new(|_| ()), ends: Arc::new(ends), progress: Some(Box::new(Watch(course.clone()))) }
}

fn locked(course: &Mutex<Course>) -> MutexGuard<'_, Course> {
    course.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Largest displacement of a trial, and the fraction of the step there, after the first increment and the last.
#[derive(Debug, Default)]
struct Course {
    begun: Vec<f64>,
    /// Displacement that counts as none [L]
    least: f64,
    first: Option<[f64; 2]>,
    last: [f64; 2],
}

impl Course {
    /// The displacement over that of the first increment, carried on to the same fraction of the step.
    fn growth(&self) -> f64 {
        let [reached, displacement] = self.last;
        match self.first {
            Some([share, first]) if displacement > self.least => {
                displacement / (first.max(self.least) * reached / share)
            }
            _ => 1.0,
        }
    }
}

struct Watch(Arc<Mutex<Course>>);

impl Observer for Watch {
    fn record(&mut self, _: &Model, attempt: &Attempt) -> Result<(), Error> {
        let mut course = locked(&self.0);
        let Some(state) = attempt.accepted.filter(|_| !course.begun.is_empty()) else { return Ok(()) };
        let moved = state.displacement.iter().zip(&course.begun).map(|(now, begun)| (now - begun).abs());
        let now = [attempt.step.span.share(state.time), moved.fold(0.0, f64::max)];
        course.first.get_or_insert(now);
        course.last = now;
        Ok(())
    }
}
