//! Friction laws alone, driven along paths: many parameter sets at once.

use std::path::Path;

use fecontact::case::{CaseError, law_test};
use fecontact::laws::friction::{Cohesion, observables};
use fecontact::output::quantities::{BONDED, MACHINE, OPENED, names};
use fecontact::run::error::Error;
use fecontact::run::law::{LawMachine, LawRow, LawTest};
use numpy::ndarray::{Array2, Axis};
use numpy::{IntoPyArray, PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rayon::prelude::*;
use serde_json::{Value, json};

use crate::errors::{case_error, stopped};
use crate::pool::{Pool, Raised, attached};

/// What every law answers, a column each of `law.csv`.
const COLUMNS: [&str; 11] = [
    "slip",
    "traction",
    "R",
    "mu",
    "structure",
    "plastic_slip",
    "dissipation",
    "dtraction_dslip",
    "dtraction_dpressure",
    "evaluations",
    "pressure",
];

/// A path as arrays; slips and pressures have a row for every set of parameters, or one for all.
struct LawPath<'a> {
    time: &'a [f64],
    slip: &'a Array2<f64>,
    pressure: &'a Array2<f64>,
    /// under which a bond acts
    opening: Option<&'a Array2<f64>>,
}

impl LawPath<'_> {
    /// Time, slip and pressure of one set of parameters.
    fn rows(&self, k: usize) -> Vec<[f64; 3]> {
        let row = |array: &Array2<f64>, i: usize| value(array, k, i);
        self.time.iter().enumerate().map(|(i, time)| [*time, row(self.slip, i), row(self.pressure, i)]).collect()
    }

    /// The test of one set of parameters; `interface` is what else a test has: initial, dilatancy, wear, normal, by.
    fn test(&self, k: usize, parameters: &Value, interface: &Value) -> Result<LawTest, CaseError> {
        let path = Path::new("law");
        let mut document = json!({"friction": parameters, "path": null, "table": null});
        for (key, value) in interface.as_object().into_iter().flatten() {
            document[key] = value.clone();
        }
        // Bond and slider of a set of parameters stand among them.
        for key in ["bond", "slider"] {
            if let Some(own) = document["friction"].as_object_mut().and_then(|law| law.remove(key)) {
                document[key] = own;
            }
        }
        let mut input = law_test::from_text(&document.to_string(), path)?;
        input.table = Some(self.rows(k));
        input.opening = self.opening.map(|opening| (0..self.time.len()).map(|i| value(opening, k, i)).collect());
        law_test::build(&input, path)
    }
}

/// Value of an array at a sample, for every set of parameters or for one of them.
fn value(array: &Array2<f64>, k: usize, i: usize) -> f64 {
    array[[k.min(array.nrows() - 1), i]]
}

/// Answers of one law along the whole path: a row a column, and names and rows of what else it shows.
struct Answers {
    rows: Vec<[f64; COLUMNS.len()]>,
    further: Vec<Vec<f64>>,
    names: Vec<String>,
}

/// Parameters by which the answers of a law can be differentiated.
#[pyfunction]
pub fn sensitivities(py: Python, parameters: &str) -> PyResult<Vec<&'static str>> {
    let parameters = document(parameters)?;
    let still = Array2::zeros((1, 2));
    let course = LawPath { time: &[0.0, 1.0], slip: &still, pressure: &still, opening: None };
    let test = course.test(0, &parameters, &json!({})).map_err(|error| case_error(py, &error))?;
    Ok(law_test::sensitivities(&test.law, false))
}

/// Drive laws along a path: `time` (n), `slip`, `pressure` and `opening` (sets or 1, n), `parameters` a JSON text a set. Returns arrays
/// (sets, n) by name, NaN where a law does not know it. `interface` is a JSON text.
#[pyfunction]
#[allow(clippy::too_many_arguments)] // those of Python
pub fn drive<'py>(
    py: Python<'py>,
    parameters: Vec<String>,
    time: PyReadonlyArray1<f64>,
    slip: PyReadonlyArray2<f64>,
    pressure: PyReadonlyArray2<f64>,
    opening: Option<PyReadonlyArray2<f64>>,
    interface: &str,
    threads: Option<i64>,
) -> PyResult<Vec<(String, Bound<'py, PyArray2<f64>>)>> {
    let parameters = documents(&parameters)?;
    let interface = document(interface)?;
    let (time, slip, pressure) = (time.as_array().to_vec(), slip.as_array().to_owned(), pressure.as_array().to_owned());
    let opening = opening.map(|opening| opening.as_array().to_owned());
    let course = LawPath { time: &time, slip: &slip, pressure: &pressure, opening: opening.as_ref() };
    let pool = Pool::new(threads)?;
    let answered: Vec<Result<Answers, Refusal>> = pool.watched(py, || {
        let sets = parameters.par_iter().enumerate();
        sets.map(|(k, parameters)| attached(|| answers(&course, k, parameters, &interface, &pool.raised))).collect()
    })?;
    if let Some(raised) = pool.raised.take() {
        return Err(raised);
    }
    let answered = answered.into_iter().collect::<Result<Vec<_>, _>>().map_err(|refusal| refusal.raised(py))?;
    let mut columns: Vec<(String, Array2<f64>)> = Vec::new();
    let shape = (answered.len(), time.len());
    for (column, name) in COLUMNS.iter().enumerate() {
        columns.push(((*name).into(), Array2::from_shape_fn(shape, |(k, i)| answered[k].rows[i][column])));
    }
    for (k, Answers { further, names, .. }) in answered.iter().enumerate() {
        for (name, values) in names.iter().zip(further) {
            let at = columns.iter().position(|(known, _)| known == name).unwrap_or_else(|| {
                columns.push((name.clone(), Array2::from_elem(shape, f64::NAN)));
                columns.len() - 1
            });
            columns[at].1.index_axis_mut(Axis(0), k).iter_mut().zip(values).for_each(|(to, from)| *to = *from);
        }
    }
    Ok(columns.into_iter().map(|(name, values)| (name, values.into_pyarray(py))).collect())
}

/// Why a law was not driven to the end.
enum Refusal {
    Case(CaseError),
    Stopped(String),
}

impl Refusal {
    fn raised(&self, py: Python) -> PyErr {
        match self {
            Self::Case(error) => case_error(py, error),
            Self::Stopped(message) => stopped(py, message),
        }
    }
}

fn document(text: &str) -> PyResult<Value> {
    serde_json::from_str(text).map_err(|error| PyValueError::new_err(error.to_string()))
}

/// Parameters of laws from their texts.
fn documents(texts: &[String]) -> PyResult<Vec<Value>> {
    texts.iter().map(|text| document(text)).collect()
}

fn answers(
    course: &LawPath,
    k: usize,
    parameters: &Value,
    interface: &Value,
    raised: &Raised,
) -> Result<Answers, Refusal> {
    if raised.is_set() {
        return Err(Refusal::Stopped(Error::Interrupted.to_string()));
    }
    let mut test = course.test(k, parameters, interface).map_err(Refusal::Case)?;
    test.interrupt = raised.flag();
    let law = &test.law;
    let further = observables::further([&law.description]);
    let gap = (!law.description.opening.is_empty()).then_some(OPENED.name);
    let bonded = law.cohesion.is_some_and(|cohesion| matches!(cohesion, Cohesion::Parallel(_)));
    let of_bond = names(&BONDED).filter(|_| bonded);
    let of_machine = names(&MACHINE).filter(|_| test.slider.is_some());
    let own = further.iter().copied().chain(gap).map(String::from);
    let names: Vec<String> = own.chain(of_bond).chain(of_machine).chain(test.derivatives()).collect();
    let mut answers =
        Answers { rows: Vec::with_capacity(course.time.len()), further: vec![Vec::new(); names.len()], names };
    // Between two samples there are stops where the surfaces touch or part.
    let mut samples = course.time.iter().peekable();
    let (_, ended) = test.run(|row| {
        let LawRow { time, slip, response, gap, bond, machine, derivatives, .. } = row;
        if samples.next_if(|sample| *sample == time).is_none() {
            return Ok(());
        }
        let state = &response.state;
        let [r, mu, structure] = observables::ALWAYS.map(|(name, _)| law.observe(name, state));
        let tangent = [response.dtraction_dslip, response.dtraction_dpressure];
        let of_friction = [state.traction, state.dissipation, state.pressure];
        let [traction, dissipation, pressure] =
            bond.map_or(of_friction, |bond| [bond.traction, bond.dissipation, bond.pressure]);
        answers.rows.push([
            *slip,
            traction,
            r,
            mu,
            structure,
            state.plastic_slip,
            dissipation,
            tangent[0],
            tangent[1],
            response.evaluations as f64,
            pressure,
        ]);
        let observed = further.iter().map(|name| law.observe(name, state));
        let shown = observed.chain((!law.description.opening.is_empty()).then_some(*gap));
        let shown = shown.chain(bond.iter().flat_map(|bond| [bond.opening, bond.intact]));
        let of_machine = |own: &LawMachine| [own.load_point, own.force, own.slip_rate];
        let shown = shown.chain(machine.iter().flat_map(of_machine)).chain(derivatives.iter().copied());
        answers.further.iter_mut().zip(shown).for_each(|(values, value)| values.push(value));
        Ok(())
    });
    let set = if k > 0 { format!("parameter set {k}: ") } else { String::new() };
    let stopped = |error: Error| Refusal::Stopped(format!("{set}{error}"));
    ended.map_err(stopped)?;
    if answers.rows.len() != course.time.len() {
        return Err(Refusal::Stopped(format!("{set}the law was not evaluated at all times")));
    }
    Ok(answers)
}
