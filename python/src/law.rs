//! Friction laws alone, driven along paths: many parameter sets at once.

use std::path::Path;

use fecontact::case::{CaseError, law_test};
use fecontact::laws::friction::sensitivity::{Direction, Variation};
use fecontact::laws::friction::{Cohesion, FrictionState, LawFailure, SensitiveLaw, Sliding, observables};
use fecontact::output::quantities::{BONDED, OPENED, names};
use fecontact::run::error::Error;
use fecontact::run::law::{LawRow, LawTest};
use numpy::ndarray::{Array2, Axis};
use numpy::{IntoPyArray, PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rayon::prelude::*;
use serde_json::{Value, json};

use crate::errors::{case_error, stopped};
use crate::pool::{Pool, Raised};

/// What every law answers, a column each of `law.csv`.
const COLUMNS: [&str; 10] = [
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
pub struct LawPath<'a> {
    pub time: &'a [f64],
    pub slip: &'a Array2<f64>,
    pub pressure: &'a Array2<f64>,
    /// under which a bond acts
    pub opening: Option<&'a Array2<f64>>,
}

impl LawPath<'_> {
    /// Time, slip and pressure of one set of parameters.
    pub fn rows(&self, k: usize) -> Vec<[f64; 3]> {
        let row = |array: &Array2<f64>, i: usize| value(array, k, i);
        self.time.iter().enumerate().map(|(i, time)| [*time, row(self.slip, i), row(self.pressure, i)]).collect()
    }

    /// The test of one set of parameters; `interface` is what else a test has: initial, dilatancy, wear, normal.
    pub fn test(&self, k: usize, parameters: &Value, interface: &Value) -> Result<LawTest, CaseError> {
        let path = Path::new("law");
        let mut document = json!({"friction": parameters, "path": null, "table": null});
        for (key, value) in interface.as_object().into_iter().flatten() {
            document[key] = value.clone();
        }
        // The bond of a set of parameters stands among them.
        if let Some(bond) = document["friction"].as_object_mut().and_then(|law| law.remove("bond")) {
            document["bond"] = bond;
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

/// One step of a law: its state before, where it was led, and whether it ends at a sample.
struct Step {
    old: FrictionState,
    sliding: Sliding,
    sampled: bool,
}

/// Parameters by which the answers of a law can be differentiated.
#[pyfunction]
pub fn sensitivities(py: Python, parameters: &str) -> PyResult<Vec<&'static str>> {
    let parameters = document(parameters)?;
    let still = Array2::zeros((1, 2));
    let course = LawPath { time: &[0.0, 1.0], slip: &still, pressure: &still, opening: None };
    let test = course.test(0, &parameters, &json!({})).map_err(|error| case_error(py, &error))?;
    if test.law.cohesion.is_some_and(|cohesion| matches!(cohesion, Cohesion::Parallel(_))) {
        return Ok(Vec::new());
    }
    Ok(test.law.law.sensitivities().map_or(Vec::new(), |law| law.parameters().to_vec()))
}

/// Drive laws along a path: `time` (n), `slip`, `pressure` and `opening` (sets or 1, n), `parameters` a JSON text a set. Returns arrays
/// (sets, n) by name, NaN where a law does not know it, and of ∂q/∂parameter for the parameters of `by`. `interface` is a JSON text.
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
    by: Vec<String>,
    threads: Option<i64>,
) -> PyResult<Vec<(String, Bound<'py, PyArray2<f64>>)>> {
    let parameters = documents(&parameters)?;
    let interface = document(interface)?;
    let (time, slip, pressure) = (time.as_array().to_vec(), slip.as_array().to_owned(), pressure.as_array().to_owned());
    let opening = opening.map(|opening| opening.as_array().to_owned());
    let course = LawPath { time: &time, slip: &slip, pressure: &pressure, opening: opening.as_ref() };
    let pool = Pool::new(threads)?;
    let ask = Ask { interface: &interface, by: &by, raised: &pool.raised };
    let answered: Vec<Result<Answers, Refusal>> = pool.watched(py, || {
        let sets = parameters.par_iter().enumerate();
        sets.map(|(k, parameters)| answers(&course, k, parameters, ask)).collect()
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

/// Whether what was asked for is still wanted.
fn goes_on(raised: &Raised) -> Result<(), Error> {
    if raised.is_set() { Err(Error::Interrupted) } else { Ok(()) }
}

/// Why a law was not driven to the end.
pub enum Refusal {
    Case(CaseError),
    Stopped(String),
}

impl Refusal {
    pub fn raised(&self, py: Python) -> PyErr {
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
pub fn documents(texts: &[String]) -> PyResult<Vec<Value>> {
    texts.iter().map(|text| document(text)).collect()
}

/// What is asked of every law.
#[derive(Clone, Copy)]
struct Ask<'a> {
    interface: &'a Value,
    /// parameters by which to differentiate
    by: &'a [String],
    raised: &'a Raised,
}

fn answers(course: &LawPath, k: usize, parameters: &Value, ask: Ask) -> Result<Answers, Refusal> {
    let Ask { interface, by, raised } = ask;
    goes_on(raised).map_err(|error| Refusal::Stopped(error.to_string()))?;
    let test = course.test(k, parameters, interface).map_err(Refusal::Case)?;
    let law = &test.law;
    let further = observables::further([&law.description]);
    let gap = (!law.description.opening.is_empty()).then_some(OPENED.name);
    let bonded = law.cohesion.is_some_and(|cohesion| matches!(cohesion, Cohesion::Parallel(_)));
    let of_bond = names(&BONDED).filter(|_| bonded);
    let names: Vec<String> = further.iter().copied().chain(gap).map(String::from).chain(of_bond).collect();
    let mut answers =
        Answers { rows: Vec::with_capacity(course.time.len()), further: vec![Vec::new(); names.len()], names };
    // Between two samples there are stops where the surfaces touch or part.
    let mut samples = course.time.iter().peekable();
    let mut steps = Vec::new();
    let (mut old, mut before) =
        (test.start.clone(), test.path.first().map_or([0.0; 2], |first| [first.start(), first.slip(first.start())]));
    let (_, ended) = test.run(|LawRow { time, slip, response, gap, bond, .. }| {
        goes_on(raised)?;
        let state = &response.state;
        let sampled = samples.next_if(|sample| *sample == time).is_some();
        if !by.is_empty() {
            let sliding = Sliding { slip: slip - before[1], pressure: state.pressure, dt: time - before[0] };
            let old = std::mem::replace(&mut old, state.clone());
            steps.push(Step { old, sliding, sampled });
            before = [*time, *slip];
        }
        if !sampled {
            return Ok(());
        }
        let [r, mu, structure] = observables::ALWAYS.map(|(name, _)| law.observe(name, state));
        let tangent = [response.dtraction_dslip, response.dtraction_dpressure];
        let of_friction = [state.traction, state.dissipation, state.pressure];
        let [traction, dissipation, pressure] =
            bond.map_or(of_friction, |bond| [bond.traction, bond.dissipation, bond.pressure]);
        answers.rows.push([
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
        answers.further.iter_mut().zip(shown).for_each(|(values, value)| values.push(value));
        Ok(())
    });
    let set = if k > 0 { format!("parameter set {k}: ") } else { String::new() };
    let stopped = |error: Error| Refusal::Stopped(format!("{set}{error}"));
    ended.map_err(stopped)?;
    if answers.rows.len() != course.time.len() {
        return Err(Refusal::Stopped(format!("{set}the law was not evaluated at all times")));
    }
    if let Some(law) = law.law.sensitivities().filter(|_| !by.is_empty()) {
        answers
            .further
            .extend(varied(law, &steps, ask).map_err(|cause| stopped(Error::Law { time: course.time[0], cause }))?);
        answers.names.extend(by.iter().map(|name| format!("dtraction_d{name}")));
    }
    Ok(answers)
}

/// ∂q/∂parameter at the samples of a path, a row a parameter, NaN for those that the law does not know.
fn varied(law: &dyn SensitiveLaw, steps: &[Step], ask: Ask) -> Result<Vec<Vec<f64>>, LawFailure> {
    let Ask { by, raised, .. } = ask;
    let known = |name: &String| law.parameters().iter().copied().find(|known| known == name);
    let parameters: Vec<Option<&'static str>> = by.iter().map(known).collect();
    let pairs =
        parameters.par_chunks(2).map(|pair| varied_by(law, steps, [pair[0], *pair.last().unwrap_or(&None)], raised));
    let rows: Vec<[Vec<f64>; 2]> = pairs.collect::<Result<_, _>>()?;
    Ok(rows.into_iter().flatten().take(by.len()).collect())
}

fn varied_by(
    law: &dyn SensitiveLaw,
    steps: &[Step],
    parameters: [Option<&'static str>; 2],
    raised: &Raised,
) -> Result<[Vec<f64>; 2], LawFailure> {
    let mut states = parameters.map(|name| name.map_or(Variation::default(), |name| law.start(name)));
    let mut rows = [Vec::new(), Vec::new()];
    for Step { old, sliding, sampled } in steps.iter().take_while(|_| !raised.is_set()) {
        let along = |k: usize| Direction { state: states[k].clone(), parameter: parameters[k], ..Direction::default() };
        states = law.vary(old, *sliding, [along(0), along(1)])?;
        if *sampled {
            (0..2).for_each(|k| rows[k].push(parameters[k].map_or(f64::NAN, |_| states[k].traction)));
        }
    }
    Ok(rows)
}
