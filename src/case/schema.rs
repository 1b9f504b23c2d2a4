//! JSON Schemas, generated from the types that read the files.

use schemars::JsonSchema;
use serde_json::{Value, json};

use super::by_name::BY_NAME;
use super::file::Case;
use super::read::{NOTE, SCHEMA};

/// Returns the JSON Schema of a kind of file, with an identifier.
pub fn schema_of<T: JsonSchema>(kind: &str) -> Value {
    let mut schema = schemars::schema_for!(T).to_value();
    describe_choices(&mut schema);
    allow_notes(&mut schema);
    schema["$id"] = format!("urn:fecontact:{kind}").into();
    let reference = json!({"type": "string", "description": "Path or address of this schema, for editors; not read"});
    schema["patternProperties"][format!("^\\{SCHEMA}$")] = reference;
    schema
}

/// Returns the JSON Schema of a case: that of its type, and laws by name.
pub fn of_case() -> Value {
    let mut schema = schema_of::<Case>("case");
    for (key, place) in BY_NAME {
        let mut law = Value::Null;
        let given = format!(". Text is the name of a law in `{key}`");
        take_names(&mut schema, place, &given, &mut law);
        let description =
            format!("Laws by names of your choice, which may stand for them wherever the case has a `{place}`");
        schema["properties"][key] =
            json!({"type": "object", "additionalProperties": law, "default": {}, "description": description});
    }
    schema
}

/// Lets a name stand where objects have a law at a key; the law there is stored in `law`.
fn take_names(schema: &mut Value, place: &str, given: &str, law: &mut Value) {
    if let Some(found) = schema.get_mut("properties").and_then(|properties| properties.get_mut(place)) {
        let [reference, description] = ["$ref", "description"].map(|key| found.get(key).cloned().unwrap_or_default());
        *law = json!({"$ref": reference});
        let description = description.as_str().unwrap_or_default();
        *found = json!({"anyOf": [law, {"type": "string"}], "description": format!("{description}{given}")});
    }
    match schema {
        Value::Object(object) => object.values_mut().for_each(|inner| take_names(inner, place, given, law)),
        Value::Array(list) => list.iter_mut().for_each(|inner| take_names(inner, place, given, law)),
        _ => {}
    }
}

/// Allows a note in every object with known keys.
fn allow_notes(schema: &mut Value) {
    match schema {
        Value::Object(object) => {
            object.values_mut().for_each(allow_notes);
            if object.get("additionalProperties") == Some(&json!(false)) {
                let note = json!({"type": "string", "description": "A remark for readers"});
                object.insert("patternProperties".into(), json!({format!("^{NOTE}$"): note}));
            }
        }
        Value::Array(list) => list.iter_mut().for_each(allow_notes),
        _ => {}
    }
}

/// Gives a key that only selects between alternatives the description of its alternative.
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
