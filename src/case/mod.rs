//! The case: JSON as written → checks → model.

mod along;
mod build;
mod choice;
mod error;
mod explain;
pub mod file;
mod initial;
pub mod law_test;
mod method;
mod names;
mod periodic;
mod read;
mod report;
mod start;
mod supported;

pub use build::{build, build_on};
pub use error::CaseError;
pub use method::choices;
pub use report::report;
pub use start::warnings;

use std::path::Path;

use schemars::JsonSchema;
use serde_json::Value;

use file::Case;

/// Read a case file.
///
/// # Errors
/// [`CaseError`] when the file cannot be read or is not a case.
pub fn read(path: &Path) -> Result<Case, CaseError> {
    read::read(path)
}

/// The JSON Schema of a case file.
pub fn schema() -> Value {
    schema_of::<Case>()
}

fn schema_of<T: JsonSchema>() -> Value {
    let mut schema = schemars::schema_for!(T).to_value();
    describe_choices(&mut schema);
    schema
}

/// A key that only chooses between alternatives takes the description of its alternative.
fn describe_choices(schema: &mut Value) {
    if let Some(object) = schema.as_object_mut() {
        let description = object.get("description").cloned();
        let properties = object.get_mut("properties").and_then(Value::as_object_mut);
        let mute = properties.into_iter().flatten().filter_map(|(_, property)| property.as_object_mut());
        for property in mute.filter(|property| !property.contains_key("description")) {
            property.extend(description.clone().map(|text| ("description".into(), text)));
        }
        object.values_mut().for_each(describe_choices);
    } else if let Some(list) = schema.as_array_mut() {
        list.iter_mut().for_each(describe_choices);
    }
}
