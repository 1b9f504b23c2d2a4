//! A case run into a folder, as the command line runs it.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use fecontact::case::job::{Callbacks, Failed, Job, Outcome, Refused};
use fecontact::equations::ContactCounts;
use fecontact::model::Model;
use fecontact::model::text::readable;
use fecontact::output::report as page;
use fecontact::run::{Attempt, Error, Observer};
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;

use crate::case::Case;
use crate::errors::refused;
use crate::pool::Pool;

/// What a run tells meanwhile.
#[derive(Default)]
struct News {
    warnings: Vec<String>,
    place: Option<Place>,
}

/// How far it is: step, time, end of the run, Δt, increments, linear solves of the last, points open, sticking and slipping.
type Place = (String, f64, f64, f64, usize, usize, [usize; 3]);

/// Notes how far a run is.
struct Progress(Arc<Mutex<News>>);

impl Observer for Progress {
    fn record(&mut self, model: &Model, attempt: &Attempt) -> Result<(), Error> {
        let Some(state) = attempt.accepted else { return Ok(()) };
        let end = model.steps.last().map_or(0.0, |step| step.span.end);
        let ContactCounts { open, stick, slip, .. } = ContactCounts::of(&model.contacts, &state.contacts);
        let name = attempt.step.name.clone();
        let place = (name, state.time, end, attempt.dt, state.increment, attempt.iterations.len(), [open, stick, slip]);
        self.0.lock().unwrap_or_else(PoisonError::into_inner).place = Some(place);
        Ok(())
    }
}

/// Run a case into the folder `out`. `poll(warnings, place)` is called now and then, and once at the end. Returns how it ended
/// ("completed", "stopped", "interrupted", "defect"), why, and what Python raised meanwhile.
#[pyfunction]
pub fn run<'py>(
    py: Python<'py>,
    case: &Bound<'py, Case>,
    out: PathBuf,
    threads: Option<i64>,
    resume: bool,
    report: bool,
    poll: Bound<'py, PyAny>,
) -> PyResult<(&'static str, Option<String>, Option<PyErr>)> {
    let pool = Pool::new(threads)?;
    let news = Arc::new(Mutex::new(News::default()));
    let warn = teller(&news);
    let case = case.get();
    // Whatever computes does so on the threads of the pool: a forked process has no others.
    let opened = pool.short(py, || {
        let job = open(case, &out, resume, report, &*warn)?;
        let fresh = !job.opened.resumes();
        let warnings = if fresh { fecontact::case::warnings(&job.opened.case, &job.model) } else { Vec::new() };
        Ok::<_, Refused>((job, warnings))
    })?;
    let (mut job, warnings) = opened.map_err(|error| refused(py, &error))?;
    warnings.iter().for_each(|warning| warn(warning));
    let page_of = report.then_some(out);
    let report = |py: Python| {
        let News { warnings, place } = std::mem::take(&mut *news.lock().unwrap_or_else(PoisonError::into_inner));
        poll.call1((warnings, place)).map(drop)?;
        py.check_signals()
    };
    let (ends, raised, progress) = (pool.raised.ends(), pool.raised.clone(), Progress(news.clone()));
    let outcome = pool.long(py, report, move || {
        let outcome = job.run(Callbacks { warn, ends, progress: Some(Box::new(progress)) })?;
        let page = page_of.filter(|_| outcome.is_readable());
        let page = page.map(|out| {
            page::write(std::slice::from_ref(&out), &out.join(page::FILE)).map_err(|error| error.to_string())
        });
        Ok::<_, Refused>((outcome, page.transpose().err()))
    })?;
    let (Outcome { ended, written, .. }, page) = outcome.map_err(|error| refused(py, &error))?;
    let mut raised = raised.take();
    if let Err(error) = report(py) {
        raised.get_or_insert(error);
    }
    let written = written.err().map(|error| error.to_string()).or(page);
    Ok(match (ended, written) {
        (Ok(()), None) => ("completed", None, raised),
        (Ok(()), Some(why)) => ("stopped", Some(why), raised),
        (Err(Failed::Stopped(Error::Interrupted)), _) => ("interrupted", Some(Error::Interrupted.to_string()), raised),
        (Err(Failed::Stopped(error)), _) => ("stopped", Some(readable(&error.to_string())), raised),
        (Err(Failed::Internal(what)), _) => {
            ("defect", Some(fecontact::case::job::internal_error::message(&what)), raised)
        }
    })
}

fn teller(news: &Arc<Mutex<News>>) -> Arc<dyn Fn(&str) + Send + Sync> {
    let news = news.clone();
    Arc::new(move |text| news.lock().unwrap_or_else(PoisonError::into_inner).warnings.push(text.into()))
}

fn open(case: &Case, out: &Path, resume: bool, report: bool, warn: &dyn Fn(&str)) -> Result<Job, Refused> {
    let opened = |checkpoint| {
        let mut opened = match checkpoint {
            Some(checkpoint) => case.resumed(checkpoint)?,
            None => case.opened()?,
        };
        opened.case.output.report = report;
        Ok(opened)
    };
    let job = match resume {
        true => Job::resume(out, opened, warn)?,
        false => Job::open(opened(None)?, out)?,
    };
    if job.begins_anew {
        warn(&format!("{}: no checkpoint yet, the run begins anew", out.display()));
    }
    if let Some(damage) = &job.damage {
        warn(&format!("{damage}; the previous checkpoint is used"));
    }
    Ok(job)
}

/// Write one page (HTML) to look at results: `fecontact report`.
#[pyfunction]
pub fn report(py: Python, folders: Vec<PathBuf>, file: PathBuf) -> PyResult<()> {
    let written = Pool::new(None)?.short(py, || page::write(&folders, &file))?;
    written.map(drop).map_err(|error| PyOSError::new_err(error.to_string()))
}
