//! Cases: read, checked, opened.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use fecontact::case::convergence::{self, Convergence, Measure};
use fecontact::case::job::Failed;
use fecontact::case::safety::{Reduced, Trial};
use fecontact::case::safety_trials::{Trials, Unfound};
use fecontact::case::{self, CaseError, Halvings, Opened, Written, law_test};
use fecontact::output::checkpoint::Checkpoint;
use fecontact::output::named;
use fecontact::run::error::Error;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::errors::{case_error, refused, stopped};
use crate::mesh::Mesh;
use crate::pool::Pool;

/// A case as it is written, with its mesh if that is at hand.
#[pyclass(frozen, module = "fecontact._native")]
pub struct Case {
    pub written: Written,
    pub mesh: Option<fecontact::mesh::Mesh>,
}

impl Case {
    /// Ready to be run from its beginning.
    pub fn opened(&self) -> Result<Opened, CaseError> {
        Ok(self.on_mesh(Opened::begin(self.written.clone())?))
    }

    /// Ready to go on from a checkpoint.
    pub fn resumed(&self, checkpoint: Checkpoint) -> Result<Opened, CaseError> {
        Ok(self.on_mesh(Opened::resume(self.written.clone(), checkpoint)?))
    }

    fn on_mesh(&self, opened: Opened) -> Opened {
        match &self.mesh {
            Some(mesh) => opened.on(mesh.clone()),
            None => opened,
        }
    }
}

#[pymethods]
impl Case {
    /// From the text of a case that would stand at `path`.
    #[new]
    fn new(py: Python, text: &str, path: PathBuf, mesh: Option<&Bound<Mesh>>) -> PyResult<Self> {
        let written = py.detach(|| Written::from_text(text, &path)).map_err(|error| case_error(py, &error))?;
        Ok(Self { written, mesh: mesh.map(|mesh| mesh.get().mesh.clone()) })
    }

    /// From a file.
    #[staticmethod]
    fn read(py: Python, path: PathBuf) -> PyResult<Self> {
        let written = py.detach(|| Written::read(&path)).map_err(|error| case_error(py, &error))?;
        Ok(Self { written, mesh: None })
    }

    /// The case as JSON.
    fn document(&self) -> String {
        self.written.document.to_string()
    }

    /// What `fecontact check` prints.
    fn check(&self, py: Python) -> PyResult<String> {
        let checked = Pool::new(None)?.short(py, || {
            let mut opened = self.opened()?;
            let (model, _) = opened.build()?;
            Ok::<_, CaseError>(case::report(&opened.case, &model))
        })?;
        checked.map_err(|error| case_error(py, &error))
    }

    /// The case as JSON with every default filled in.
    fn resolved(&self, py: Python) -> PyResult<String> {
        let resolved = Pool::new(None)?.short(py, || {
            let (model, _) = self.opened()?.build()?;
            Ok::<_, CaseError>(case::resolved(&self.written.case, &model))
        })?;
        resolved.map_err(|error| case_error(py, &error))
    }

    /// The case as JSON with elements and increments that are halved so many times, each.
    fn refined(&self, py: Python, mesh: u32, increments: u32) -> PyResult<String> {
        let halvings = Halvings { mesh, increments };
        let refined = Pool::new(None)?.short(py, || match &self.mesh {
            Some(mesh) => case::refined_on(&self.written, mesh, halvings),
            None => case::refined(&self.written, halvings),
        })?;
        refined.map(|written| written.document.to_string()).map_err(|error| case_error(py, &error))
    }
}

/// The number of a measure, COLUMN:max, from the results in a folder.
#[pyfunction]
pub fn measured(folder: PathBuf, measure: &str) -> PyResult<f64> {
    measure.parse().and_then(|measure: Measure| measure.of(&folder)).map_err(PyValueError::new_err)
}

/// Order, extrapolated value and error bar, where there are any, whether the numbers are settled without, and the verdict in words.
type Judged = (Option<f64>, Option<f64>, Option<f64>, bool, String);

/// Order, extrapolated value, error bar, whether they are settled without one, and verdict of numbers of runs that are refined alike.
#[pyfunction]
pub fn judge(values: Vec<f64>, within: f64) -> PyResult<Judged> {
    let Convergence { order, extrapolated, bar, settled, verdict, .. } =
        convergence::judge(&values, within).map_err(PyValueError::new_err)?;
    Ok((order, extrapolated, bar, settled, verdict))
}

/// The fraction of the last difference that is due to the increments, if there is any: `longer` is the number of the finest mesh with the
/// increments of the level before.
#[pyfunction]
pub fn fraction_of_increments(values: Vec<f64>, longer: f64) -> Option<f64> {
    convergence::fraction_of_increments(&values, longer)
}

/// The factors between which strengths fail: the largest that stands, and the least that fails, if any does.
type Between = (f64, Option<f64>);

/// A trial of a factor of safety: F, whether it stands, the fraction of the step at which the run ended, the largest displacement, and the
/// same over the elastic one.
type Tried = (f64, bool, f64, f64, f64);

/// Runs a case and the trials of its factor of safety into folders in `out`. `poll(warnings, trials)` is called now and then, and once at
/// the end.
#[pyfunction]
pub fn safety(
    py: Python,
    case: &Bound<Case>,
    out: PathBuf,
    reduced: [Vec<String>; 2],
    range: [f64; 2],
    threads: Option<i64>,
    poll: Bound<PyAny>,
) -> PyResult<Between> {
    let pool = Pool::new(threads)?;
    let [bodies, contacts] = reduced;
    let (written, reduced) = (case.get().written.clone(), Reduced { bodies, contacts });
    let news = Arc::new(Mutex::new((Vec::<String>::new(), Vec::<Tried>::new())));
    let report = |py: Python| {
        let news = std::mem::take(&mut *news.lock().unwrap_or_else(PoisonError::into_inner));
        poll.call1(news).map(drop)?;
        py.check_signals()
    };
    let (ends, shared) = (pool.raised.ends(), news.clone());
    let found = pool.long(py, report, move || {
        let noted = shared.clone();
        let warn = move |text: &str| noted.lock().unwrap_or_else(PoisonError::into_inner).0.push(text.into());
        let mut trials = Trials::begin(written, reduced, range, &out, &warn, ends)?;
        while let Some(Trial { factor, stands, reached, displacement, growth }) = trials.next_trial()? {
            let tried = (factor, stands, reached, displacement, growth);
            shared.lock().unwrap_or_else(PoisonError::into_inner).1.push(tried);
        }
        Ok((trials.search.stands, trials.search.fails))
    })?;
    if let Some(raised) = pool.raised.take() {
        return Err(raised);
    }
    report(py)?;
    found.map_err(|unfound| match unfound {
        Unfound::Refused(why) => refused(py, &why),
        Unfound::Failed(Failed::Stopped(Error::Interrupted)) => stopped(py, "interrupted"),
        Unfound::Failed(Failed::Stopped(error)) => stopped(py, &error.to_string()),
        Unfound::Failed(Failed::Internal(what)) => crate::errors::internal_error(py, &what),
    })
}

/// The JSON Schema of a `"case"`, or of the test of a `"law"`; the quantities of `"results"` by their files.
#[pyfunction]
pub fn schema(of: &str) -> PyResult<String> {
    match of {
        "case" => Ok(case::schema().to_string()),
        "law" => Ok(law_test::schema().to_string()),
        "results" => Ok(named::schema().to_string()),
        _ => Err(PyValueError::new_err(format!("there is no schema of `{of}`: give \"case\", \"law\" or \"results\""))),
    }
}
