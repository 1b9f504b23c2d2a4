//! From the errors of the library to the exceptions of the package, with the same texts.

use std::path::Path;

use fecontact::case::CaseError;
use fecontact::case::job::Refused;
use fecontact::model::text::readable;
use pyo3::prelude::*;

/// An exception of `fecontact.errors`.
fn exception<'py>(py: Python<'py>, class: &str, arguments: impl pyo3::call::PyCallArgs<'py>) -> PyErr {
    let made = py.import("fecontact.errors").and_then(|errors| errors.getattr(class)?.call1(arguments));
    made.map_or_else(|error| error, PyErr::from_value)
}

/// `CaseError`, with its parts.
pub fn case_error(py: Python, error: &CaseError) -> PyErr {
    let CaseError { file, place, message } = error;
    exception(py, "CaseError", (error.to_string(), file.display().to_string(), place.as_str(), message.as_str()))
}

/// `CaseError` about a place of something given in Python.
pub fn complaint(py: Python, file: &str, place: &str, message: impl ToString) -> PyErr {
    let (file, place) = (Path::new(file).to_owned(), place.to_string());
    case_error(py, &CaseError { file, place, message: readable(&message.to_string()) })
}

/// What a job is refused for.
pub fn refused(py: Python, refused: &Refused) -> PyErr {
    match refused {
        Refused::Case(error) => case_error(py, error),
        Refused::Folder(..) | Refused::Checkpoint(..) | Refused::Anew(..) | Refused::Run(_) => {
            exception(py, "CaseError", (refused.to_string(), "", "", refused.to_string()))
        }
    }
}

/// `Stopped`, of what leaves no folder behind.
pub fn stopped(py: Python, message: &str) -> PyErr {
    exception(py, "Stopped", (readable(message),))
}

/// `Defect`: the program itself is wrong.
pub fn internal_error(py: Python, message: &str) -> PyErr {
    exception(py, "Defect", (fecontact::case::job::internal_error::message(message),))
}
