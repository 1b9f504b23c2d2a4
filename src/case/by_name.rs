//! Laws that a case gives once by name, `"materials"` and `"frictions"`: they take the places at which the name stands,
//! `"material": "clay"`, so that everything else knows of plain cases only.

use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

use super::read::input;
use crate::laws::friction::FrictionParameters;
use crate::mesh::names::not_known;
use crate::model::builder::{BulkLaw, Checked, ModelError};

/// Keys under which laws are given by name, and the key whose text is such a name.
pub const BY_NAME: [(&str, &str); 2] = [("materials", "material"), ("frictions", "friction")];

/// Puts the laws that a case gives by name where it names them.
///
/// # Errors
/// Returns an error with its place if a law is invalid, whether it is used or not, or a name unknown.
pub fn with_laws(case: &mut Value) -> Checked<()> {
    for (key, place) in BY_NAME {
        let given = case.as_object_mut().and_then(|case| case.remove(key));
        let laws = match given {
            None => Map::new(),
            Some(Value::Object(laws)) => laws,
            Some(_) => return Err(ModelError::new(key, "must be an object {…}: laws by names of your choice")),
        };
        for (name, law) in &laws {
            let found = if key == "materials" { checked::<BulkLaw>(law) } else { checked::<FrictionParameters>(law) };
            found.map_err(|error| ModelError { place: below(&format!("{key}.{name}"), &error.place), ..error })?;
        }
        put(case, place, [key, ""], &laws)?;
    }
    Ok(())
}

fn checked<T: DeserializeOwned>(law: &Value) -> Checked<()> {
    input::<T>(law).map(drop)
}

fn below(place: &str, inner: &str) -> String {
    [place, inner].into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(".")
}

/// Replaces the text at a key, anywhere below a value at `at`, by the law of that name.
fn put(value: &mut Value, place: &str, [key, at]: [&str; 2], laws: &Map<String, Value>) -> Checked<()> {
    match value {
        Value::Object(object) => object.iter_mut().try_for_each(|(own, inner)| {
            let at = below(at, own);
            let Some(name) = inner.as_str().filter(|_| own == place) else {
                return put(inner, place, [key, &at], laws);
            };
            match laws.get(name) {
                Some(law) => *inner = law.clone(),
                None => return Err(ModelError::new(at, unknown(name, key, laws))),
            }
            Ok(())
        }),
        Value::Array(list) => {
            list.iter_mut().enumerate().try_for_each(|(k, entry)| put(entry, place, [key, &format!("{at}[{k}]")], laws))
        }
        _ => Ok(()),
    }
}

fn unknown(name: &str, key: &str, laws: &Map<String, Value>) -> String {
    if laws.is_empty() {
        return format!(
            "names the law `{name}`, but the case gives no \"{key}\": write {{\"{key}\": {{\"{name}\": {{…}}}}}}, or the law here"
        );
    }
    let known: Vec<&str> = laws.keys().map(String::as_str).collect();
    format!("{} in \"{key}\"", not_known(name, &known))
}
