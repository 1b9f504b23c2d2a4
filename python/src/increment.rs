//! An accepted increment, and its arrays.

use std::sync::Arc;

use fecontact::model::state::State;
use numpy::PyArray2;
use numpy::ndarray::ArrayView2;
use pyo3::exceptions::{PyLookupError, PyValueError};
use pyo3::prelude::*;

/// The arrays of a state are read, and neither copied nor written: Python holds the state as long as it holds one of them.
#[pyclass(frozen, module = "fecontact._native")]
struct Held(#[expect(dead_code, reason = "it is only kept")] Arc<State>);

/// An accepted increment, or the explicit ones up to an output.
#[pyclass(frozen, module = "fecontact._native")]
pub struct Increment {
    pub state: Arc<State>,
    #[pyo3(get)]
    pub step: String,
    /// linear solves
    #[pyo3(get)]
    pub iterations: usize,
}

#[pymethods]
impl Increment {
    /// t at its end [T].
    #[getter]
    fn time(&self) -> f64 {
        self.state.time
    }

    /// Its length [T].
    #[getter]
    fn dt(&self) -> f64 {
        self.state.dt
    }

    /// Accepted increments so far.
    #[getter]
    fn number(&self) -> usize {
        self.state.increment
    }

    /// A field of the nodes, (nodes, 2), without a copy.
    fn field<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let State { displacement, velocity, acceleration, reaction, external, .. } = &*self.state;
        let values = match name {
            "displacement" => displacement,
            "velocity" => velocity,
            "acceleration" => acceleration,
            "reaction" => reaction,
            "external" => external,
            _ => return Err(PyLookupError::new_err(format!("nodes have no field `{name}`"))),
        };
        let shaped = ArrayView2::from_shape((values.len() / 2, 2), values);
        let shaped = shaped.map_err(|error| PyValueError::new_err(error.to_string()))?;
        let held = Bound::new(py, Held(self.state.clone()))?;
        // SAFETY: the values live in the state that `held` keeps, nobody changes a state that is shared, and the array is made
        // one that cannot be written before Python sees it.
        let array = unsafe { PyArray2::borrow_from_array(&shaped, held.into_any()) };
        array.call_method1("setflags", (false,))?;
        Ok(array.into_any())
    }
}
