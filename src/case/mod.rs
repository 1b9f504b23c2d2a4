//! The case: JSON as written → checks → model.

mod build;
mod error;
pub mod file;
mod report;
mod supported;

use std::path::Path;

pub use build::build;
pub use error::CaseError;
pub use report::report;

use error::Complaint;
use file::Case;

/// Read a case file; unknown keys, wrong types and impossible numbers are named with their place.
///
/// # Errors
/// [`CaseError`] when the file cannot be read or is not a case.
pub fn read(path: &Path) -> Result<Case, CaseError> {
    let complain = |message: String| Complaint::new("", message).in_file(path);
    if path.is_dir() {
        return Err(complain("is a directory; give the path of a case file (JSON)".into()));
    }
    let text = std::fs::read_to_string(path).map_err(|cause| match cause.kind() {
        std::io::ErrorKind::InvalidData => complain("is not a text file; a case is JSON".into()),
        _ => complain(format!("cannot be read: {cause}")),
    })?;
    let mut json = serde_json::Deserializer::from_str(&text);
    let case = serde_path_to_error::deserialize(&mut json).map_err(|error| {
        let place = error.path().to_string();
        let place = if place == "." { String::new() } else { place };
        Complaint::new(place, explain(&error.inner().to_string())).in_file(path)
    })?;
    json.end().map_err(|error| complain(format!("text after the end of the case: {error}")))?;
    Ok(case)
}

/// Add the nearest known name to serde's "unknown field" and "unknown variant".
fn explain(message: &str) -> String {
    let mut quoted = message.split('`').skip(1).step_by(2);
    let unknown = message.starts_with("unknown field") || message.starts_with("unknown variant");
    let (true, Some(name)) = (unknown, quoted.next()) else { return message.into() };
    match quoted.max_by(|a, b| strsim::jaro_winkler(a, name).total_cmp(&strsim::jaro_winkler(b, name))) {
        Some(nearest) => format!("{message}; did you mean `{nearest}`?"),
        None => message.into(),
    }
}

/// The JSON Schema of a case file.
pub fn schema() -> serde_json::Value {
    schemars::schema_for!(Case).to_value()
}
