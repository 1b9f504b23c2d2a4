//! A run as an iterator over its increments.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use fecontact::case::job::{Ends, internal_error};
use fecontact::case::loading::{self, LoadChanges};
use fecontact::case::{CaseError, Opened};
use fecontact::model::builder::ModelError;
use fecontact::model::state::State;
use fecontact::output::checkpoint::{self, Checkpoint, MeshPrint};
use fecontact::run::{Axis, Error, SavedRun, Simulation as Run};
use numpy::ndarray::Array2;
use numpy::{IntoPyArray, PyArray1, PyArray2};
use pyo3::exceptions::{PyLookupError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use serde_json::Value;

use crate::case::Case;
use crate::errors::{case_error, complaint, stopped};
use crate::increment::Increment;
use crate::pool::Pool;

/// A run as it was, with what its caller had changed.
#[pyclass(frozen, module = "fecontact._native")]
pub struct Saved {
    run: fecontact::run::Saved,
    loading: Option<LoadChanges>,
    of: Arc<Origin>,
}

/// The case of a run (JSON) and its mesh, by which it is known whether another case can go on with it.
struct Origin {
    document: Value,
    mesh: MeshPrint,
}

#[pymethods]
impl Saved {
    #[getter]
    fn time(&self) -> f64 {
        self.run.state().time
    }
}

/// A run under way.
#[pyclass(frozen, module = "fecontact._native")]
pub struct Simulation {
    pool: Pool,
    under_way: Mutex<Option<UnderWay>>,
}

struct UnderWay {
    opened: Opened,
    run: Run,
    loading: Option<LoadChanges>,
    last: Option<Arc<State>>,
    of: Arc<Origin>,
}

#[pymethods]
impl Simulation {
    #[new]
    fn new(py: Python, case: &Bound<Case>, threads: Option<i64>) -> PyResult<Self> {
        let (pool, case) = (Pool::new(threads)?, case.get());
        let made = pool.short(py, || {
            let mut opened = case.opened()?;
            let (model, saved) = opened.build()?;
            let run = match saved {
                Some(saved) => Run::resume(model, saved.simulation().clone()),
                None => Run::new(model),
            };
            let of = Origin { document: opened.document.clone(), mesh: MeshPrint::of(&run.model().mesh) };
            Ok::<_, CaseError>(UnderWay { opened, run, loading: None, last: None, of: of.into() })
        })?;
        let made = made.map_err(|error| case_error(py, &error))?;
        Ok(Self { pool, under_way: Mutex::new(Some(made)) })
    }

    /// The next accepted increment, or none after the last.
    fn next_increment(&self, py: Python) -> PyResult<Option<Increment>> {
        let mut under_way = self.lock().take().ok_or_else(lost)?;
        let ends = self.pool.raised.ends();
        let made = self.pool.long(
            py,
            |_| Ok(()),
            move || {
                let asked = ends.clone();
                under_way.run.pause_when(Arc::new(move || asked().is_some()));
                let made = internal_error::catch(|| next(&mut under_way.run, &ends));
                (under_way, made)
            },
        )?;
        let (mut under_way, made) = made;
        if let Ok(Ok(Some(Increment { state, .. }))) = &made {
            under_way.last = Some(state.clone());
        }
        *self.lock() = Some(under_way);
        if let Some(raised) = self.pool.raised.take() {
            return Err(raised);
        }
        let made = made.map_err(|what| crate::errors::internal_error(py, &what))?;
        made.map_err(|error| stopped(py, &error.to_string()))
    }

    /// The accepted state.
    #[getter]
    fn state(&self) -> PyResult<Increment> {
        self.with(|under_way| {
            let UnderWay { run, last, .. } = under_way;
            let state = last.get_or_insert_with(|| Arc::new(run.state().clone())).clone();
            Ok(Increment { state, step: run.step().name.clone(), iterations: 0 })
        })
    }

    #[getter]
    fn is_complete(&self) -> PyResult<bool> {
        self.with(|under_way| Ok(under_way.run.is_complete()))
    }

    /// Start and end of the step under way [T].
    #[getter]
    fn span(&self) -> PyResult<(f64, f64)> {
        self.with(|under_way| Ok((under_way.run.step().span.start, under_way.run.step().span.end)))
    }

    /// Counts and times so far, as in `summary.json`.
    fn report(&self) -> PyResult<String> {
        let report = self.with(|under_way| Ok(under_way.run.report()))?;
        serde_json::to_string(&report).map_err(|error| PyValueError::new_err(error.to_string()))
    }

    /// Names of the contacts.
    #[getter]
    fn contacts(&self) -> PyResult<Vec<String>> {
        self.with(|under_way| Ok(under_way.run.model().contacts.iter().map(|pair| pair.name.clone()).collect()))
    }

    /// Names of the bars.
    #[getter]
    fn bars(&self) -> PyResult<Vec<String>> {
        self.with(|under_way| Ok(under_way.run.model().bars.iter().map(|bar| bar.name.clone()).collect()))
    }

    fn nodes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.with(|under_way| {
            let nodes = &under_way.run.model().mesh.nodes;
            Ok(Array2::from_shape_fn((nodes.len(), 2), |(node, i)| nodes[node][i]).into_pyarray(py))
        })
    }

    /// Numbers of the nodes of a group.
    fn nodes_of(&self, group: &str) -> PyResult<Vec<usize>> {
        self.with(|under_way| {
            let mesh = &under_way.run.model().mesh;
            Ok(mesh.nodes_of(mesh.group(group).map_err(unknown)?))
        })
    }

    fn reaction(&self, group: &str) -> PyResult<[f64; 2]> {
        self.with(|under_way| Ok(under_way.run.reaction(group).map_err(unknown)?.into()))
    }

    fn displacement(&self, group: &str) -> PyResult<[f64; 2]> {
        self.with(|under_way| Ok(under_way.run.displacement(group).map_err(unknown)?.into()))
    }

    fn contact_force(&self, contact: &str) -> PyResult<[f64; 2]> {
        self.with(|under_way| Ok(under_way.run.contact_force(contact).map_err(unknown)?.into()))
    }

    fn contact_field<'py>(&self, py: Python<'py>, contact: &str, field: &str) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let values = self.with(|under_way| under_way.run.contact_field(contact, field).map_err(unknown))?;
        Ok(values.into_pyarray(py))
    }

    fn contact_positions<'py>(&self, py: Python<'py>, contact: &str) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let at = self.with(|under_way| under_way.run.contact_positions(contact).map_err(unknown))?;
        Ok(Array2::from_shape_fn((at.len(), 2), |(point, i)| at[point][i]).into_pyarray(py))
    }

    fn pore_pressures<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let values = self.with(|under_way| Ok(under_way.run.pore_pressures()))?;
        Ok(values.into_pyarray(py))
    }

    fn bar_field<'py>(&self, py: Python<'py>, bar: &str, field: &str) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let values = self.with(|under_way| under_way.run.bar_field(bar, field).map_err(unknown))?;
        Ok(values.into_pyarray(py))
    }

    fn bar_positions<'py>(&self, py: Python<'py>, bar: &str) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let at = self.with(|under_way| under_way.run.bar_positions(bar).map_err(unknown))?;
        Ok(Array2::from_shape_fn((at.len(), 2), |(point, i)| at[point][i]).into_pyarray(py))
    }

    /// Lead the supports of a group along an axis (0, 1) to a displacement by a time.
    fn prescribe(&self, py: Python, group: &str, axis: usize, to: f64, by: f64) -> PyResult<()> {
        self.with(|under_way| {
            let now = under_way.run.state().time;
            if !(by > now && by.is_finite()) {
                return Err(complaint(
                    py,
                    "prescribe",
                    "by",
                    format!("is {by}: must be after the current time, {now}"),
                ));
            }
            if !to.is_finite() {
                let place = ["ux", "uy"][axis.min(1)];
                return Err(complaint(py, "prescribe", place, format!("is {to}: must be a finite number")));
            }
            let axis = if axis == 0 { Axis::X } else { Axis::Y };
            under_way.run.prescribe(group, axis, to, by).map_err(unknown)
        })
    }

    /// Give a load (JSON, as in a step) anew, reached by a time.
    fn load(&self, py: Python, load: &str, by: Option<f64>) -> PyResult<()> {
        let document = serde_json::from_str(load).map_err(|error| PyValueError::new_err(error.to_string()))?;
        self.with(|under_way| {
            let UnderWay { opened, run, loading, .. } = under_way;
            let by = by.unwrap_or_else(|| run.state().time);
            loading::load(&opened.case, "load".as_ref(), run, loading, &document, by)
                .map_err(|error| case_error(py, &error))
        })
    }

    /// Bounds of the increments of the step under way [T].
    fn increments(&self, py: Python, max: Option<f64>, min: Option<f64>) -> PyResult<()> {
        let bounded = self.with(|under_way| Ok(under_way.run.bound_increments(max, min)))?;
        bounded.map_err(|ModelError { place, message, .. }| {
            complaint(py, "increments", place.trim_start_matches("increments").trim_start_matches('.'), message)
        })
    }

    /// No increment follows.
    fn stop(&self) -> PyResult<()> {
        self.with(|under_way| {
            under_way.run.stop();
            Ok(())
        })
    }

    fn save(&self) -> PyResult<Saved> {
        self.with(|UnderWay { run, loading, of, .. }| {
            Ok(Saved { run: run.save(), loading: loading.clone(), of: of.clone() })
        })
    }

    /// Go on from what was saved in this process.
    fn restore(&self, py: Python, saved: &Bound<Saved>) -> PyResult<()> {
        let Saved { run, loading, of } = saved.get();
        self.with(|under_way| {
            let model = under_way.run.model().clone();
            let taken_up = under_way.opened.take_up(run.clone(), &of.document, &of.mesh, &model);
            under_way.run = Run::resume(model, taken_up.map_err(|error| case_error(py, &error))?);
            (under_way.loading, under_way.last) = (loading.clone(), None);
            Ok(())
        })
    }

    /// Write a checkpoint into a folder.
    fn write(&self, py: Python, folder: PathBuf) -> PyResult<()> {
        self.with(|under_way| {
            let UnderWay { opened, run, .. } = under_way;
            let written = SavedRun::new(run, &mut []).and_then(|saved| {
                let (begun, complete) = (saved.simulation().begun(), saved.simulation().is_complete());
                let mesh = MeshPrint::of(&run.model().mesh);
                let (case, program) = (opened.document.to_string(), env!("CARGO_PKG_VERSION").into());
                let taken_over = opened.taken_over;
                let run = saved.bytes()?;
                checkpoint::write(&folder, &Checkpoint { program, case, taken_over, begun, complete, mesh, run })
            });
            written.map_err(|error| stopped(py, &error.to_string()))
        })
    }
}

impl Simulation {
    fn lock(&self) -> MutexGuard<'_, Option<UnderWay>> {
        self.under_way.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn with<T>(&self, work: impl FnOnce(&mut UnderWay) -> PyResult<T>) -> PyResult<T> {
        work(self.lock().as_mut().ok_or_else(lost)?)
    }
}

/// Attempts until one is accepted; none after the last, nor where the end was asked for.
fn next(run: &mut Run, ends: &Ends) -> Result<Option<Increment>, Error> {
    while ends().is_none()
        && let Some(candidate) = run.try_increment()?
    {
        let (step, state) = (run.step().name.clone(), candidate.shared_state());
        let iterations = candidate.iterations().len();
        run.apply(candidate)?;
        if let Some(state) = state {
            return Ok(Some(Increment { state, step, iterations }));
        }
    }
    Ok(None)
}

fn lost() -> PyErr {
    PyRuntimeError::new_err("an increment of this simulation is under way, or was left by a second interrupt")
}

fn unknown(error: impl ToString) -> PyErr {
    PyLookupError::new_err(error.to_string())
}
