//! Friction laws written in Python: a callable over arrays of points.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::Arc;

use fecontact::laws::friction::{
    Answer, Description, FrictionLaw, FrictionResponse, FrictionState, LawFailure, Regime, Sliding, Variables,
    observables, register,
};
use fecontact::run::error::Error;
use numpy::{PyArray1, PyArrayDyn, PyArrayMethods};
use pyo3::exceptions::{PyRuntimeError, PyStopIteration, PyTypeError, PyValueError};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyMapping};

use crate::pool::Raised;

/// A law whose answers Python gives. The interpreter is entered once for every slice of points.
#[derive(Debug)]
struct PythonLaw {
    name: Arc<str>,
    call: Arc<Py<PyAny>>,
    parameters: BTreeMap<String, f64>,
    alpha_t: f64,
    /// names of its variables, and their values at first touch
    variables: &'static [&'static str],
    initial: Variables,
}

/// Let cases use `{"law": "registered", "name": name}`; `variables` with their values at first touch.
#[pyfunction]
pub fn register_law(name: &str, call: Bound<PyAny>, variables: Vec<(String, f64)>) -> PyResult<()> {
    if !call.is_callable() {
        return Err(PyTypeError::new_err(format!("law `{name}`: must be a function")));
    }
    let call = call.unbind();
    let bad = |message: String| Err(PyValueError::new_err(format!("law `{name}`: {message}")));
    if let Some((variable, value)) = variables.iter().find(|(_, value)| !value.is_finite()) {
        return bad(format!("variable `{variable}` is {value} at first touch: must be a finite number"));
    }
    let initial: Variables = variables.iter().map(|(_, value)| *value).collect();
    // A law is registered for as long as the process lives.
    let names: Vec<&'static str> = variables.into_iter().map(|(name, _)| &*String::leak(name)).collect();
    let (variables, call, own): (&'static [_], _, Arc<str>) = (Vec::leak(names), Arc::new(call), name.into());
    let (parameters, alpha_t) = (BTreeMap::new(), 1.0);
    let law =
        PythonLaw { name: own.clone(), call: call.clone(), parameters, alpha_t, variables, initial: initial.clone() };
    if let Err(error) = observables::check_names(&law.description()) {
        return bad(error.to_string());
    }
    register(name, move |parameters, alpha_t| {
        let (name, call, parameters, initial) = (own.clone(), call.clone(), parameters.clone(), initial.clone());
        Ok(Box::new(PythonLaw { name, call, parameters, alpha_t, variables, initial }))
    });
    Ok(())
}

impl FrictionLaw for PythonLaw {
    fn description(&self) -> Description {
        Description { stiffness: self.alpha_t, variables: self.variables, ..Description::default() }
    }

    fn initial_state(&self, pressure: f64, traction: f64) -> FrictionState {
        FrictionState { variables: self.initial.clone(), ..FrictionState::default() }.loaded(pressure, traction)
    }

    fn respond(&self, old: &FrictionState, sliding: Sliding) -> Answer {
        let mut answer = [Err(LawFailure::Registered)];
        self.respond_many(std::slice::from_ref(old), &[sliding], &mut answer);
        let [answer] = answer;
        answer
    }

    fn respond_many(&self, old: &[FrictionState], sliding: &[Sliding], answers: &mut [Answer]) {
        let mut closed = Vec::new();
        for (i, (old, sliding)) in old.iter().zip(sliding).enumerate() {
            match sliding.checked() {
                Err(failure) => answers[i] = Err(failure),
                Ok(Sliding { pressure, .. }) if pressure <= 0.0 => {
                    answers[i] = FrictionResponse::elastic(old.parted(self.alpha_t), 0.0).checked(self.alpha_t);
                }
                Ok(_) => closed.push(i),
            }
        }
        if closed.is_empty() {
            return;
        }
        let answered =
            Python::attach(|py| self.answers(py, &closed, old, sliding).map_err(|error| (error.to_string(), error)));
        match answered {
            Ok(responses) => closed.into_iter().zip(responses).for_each(|(i, answer)| answers[i] = answer),
            Err((text, error)) => {
                let why = format!("the friction law `{}` failed: {text}", self.name);
                let error = Python::attach(|py| not_an_end(py, error, &why));
                Raised::of_this_pool().set(error, Error::Ended(why));
                closed.into_iter().for_each(|i| answers[i] = Err(LawFailure::Registered));
            }
        }
    }
}

impl PythonLaw {
    /// What the callable says of the closed points.
    fn answers(
        &self,
        py: Python,
        closed: &[usize],
        old: &[FrictionState],
        sliding: &[Sliding],
    ) -> PyResult<Vec<Answer>> {
        let array = |value: &dyn Fn(usize) -> f64| PyArray1::from_iter(py, closed.iter().map(|&i| value(i)));
        let before = PyDict::new(py);
        before.set_item(intern!(py, "traction"), array(&|i| old[i].traction))?;
        before.set_item(intern!(py, "pressure"), array(&|i| old[i].pressure))?;
        before.set_item(intern!(py, "plastic_slip"), array(&|i| old[i].plastic_slip))?;
        before.set_item(intern!(py, "dissipation"), array(&|i| old[i].dissipation))?;
        for (k, name) in self.variables.iter().enumerate() {
            before.set_item(name, array(&|i| old[i].variables[k]))?;
        }
        let (slip, pressure) = (array(&|i| sliding[i].slip), array(&|i| sliding[i].pressure));
        let keywords = PyDict::new(py);
        keywords.set_item("alpha_t", self.alpha_t)?;
        self.parameters.iter().try_for_each(|(name, value)| keywords.set_item(name, value))?;
        let arguments = (before, slip, pressure, array(&|i| sliding[i].dt));
        let said = self.call.bind(py).call(arguments, Some(&keywords))?;
        let said =
            said.cast_into::<PyMapping>().map_err(|_| PyTypeError::new_err("it must return a dict of arrays"))?;
        self.check_names(&said)?;
        let column = |name: &str| values(&said, name, closed.len());
        let [traction, by_slip, by_pressure, plastic] =
            ["traction", "dtraction_dslip", "dtraction_dpressure", "plastic_increment"].map(column);
        let (traction, by_slip, by_pressure, plastic) = (traction?, by_slip?, by_pressure?, plastic?);
        let dissipated = if said.contains("dissipation")? { Some(column("dissipation")?) } else { None };
        let variables = self.variables.iter().map(|name| column(name)).collect::<PyResult<Vec<_>>>()?;
        let answer = |(j, &i): (usize, &usize)| {
            let (old, pressure) = (&old[i], sliding[i].pressure);
            // The trapezoidal rule for ∫ |q| dλ, unless the law knows better.
            let trapezoid = 0.5 * (old.traction + traction[j]) * plastic[j];
            let state = FrictionState {
                plastic_slip: old.plastic_slip + plastic[j],
                plastic_increment: plastic[j],
                dissipation: old.dissipation + dissipated.as_ref().map_or(trapezoid, |given| given[j]),
                regime: if plastic[j] == 0.0 { Regime::Stick } else { Regime::Slip },
                ..old.stuck(traction[j], pressure).with_variables(variables.iter().map(|values| values[j]))
            };
            let tangent = (by_slip[j], by_pressure[j]);
            FrictionResponse { state, dtraction_dslip: tangent.0, dtraction_dpressure: tangent.1, ..Default::default() }
                .checked(self.alpha_t)
        };
        Ok(closed.iter().enumerate().map(answer).collect())
    }

    /// A name that means nothing is a slip of the keyboard.
    fn check_names(&self, said: &Bound<PyMapping>) -> PyResult<()> {
        let known = ["traction", "dtraction_dslip", "dtraction_dpressure", "plastic_increment", "dissipation"];
        for name in said.keys()? {
            let name: Cow<str> = name.extract()?;
            if !known.contains(&&*name) && !self.variables.contains(&&*name) {
                let known: Vec<&str> = known.iter().chain(self.variables).copied().collect();
                return Err(PyValueError::new_err(format!("it returned `{name}`; known are {}", known.join(", "))));
            }
        }
        Ok(())
    }
}

/// To whoever iterates over increments the end of an iteration within the law would be that of the run.
fn not_an_end(py: Python, error: PyErr, why: &str) -> PyErr {
    if !error.is_instance_of::<PyStopIteration>(py) {
        return error;
    }
    let error_of_law = PyRuntimeError::new_err(why.to_owned());
    error_of_law.set_cause(py, Some(error));
    error_of_law
}

/// What was returned under a name: an array of finite numbers, one a point, or one number for all.
fn values(said: &Bound<PyMapping>, name: &str, points: usize) -> PyResult<Vec<f64>> {
    let py = said.py();
    let missing = |_| PyValueError::new_err(format!("it did not return `{name}`"));
    let given = said.get_item(name).map_err(missing)?;
    // What laws mostly return is read as it is: conversions take as long as the law.
    if let Some(values) = given.cast::<PyArray1<f64>>().ok().map(|array| array.readonly()) {
        let values: Vec<f64> = values.as_array().to_vec();
        if values.len() == points && values.iter().all(|value| value.is_finite()) {
            return Ok(values);
        }
    }
    let given = py.import("numpy")?.call_method1("asarray", (given,))?;
    let kind: String = given.getattr("dtype")?.getattr("kind")?.extract()?;
    if !"fiub".contains(&kind) {
        let of = given.getattr("dtype")?;
        return Err(PyValueError::new_err(format!("it returned `{name}` of the type {of}: must be real numbers")));
    }
    let given = given.call_method1("astype", ("float64",))?;
    let given = given.cast_into::<PyArrayDyn<f64>>()?.to_owned_array();
    let values: Vec<f64> = match given.shape() {
        [] => given.iter().copied().cycle().take(points).collect(),
        [count] if *count == points => given.into_iter().collect(),
        shape => {
            let shape: Vec<String> = shape.iter().map(ToString::to_string).collect();
            return Err(PyValueError::new_err(format!(
                "it returned `{name}` of the shape ({}): must be ({points},), as slip and pressure have, or a number",
                if shape.len() == 1 { format!("{},", shape[0]) } else { shape.join(", ") }
            )));
        }
    };
    match values.iter().find(|value| !value.is_finite()) {
        Some(value) => Err(PyValueError::new_err(format!("it returned `{name}` = {value}: must be finite numbers"))),
        None => Ok(values),
    }
}
