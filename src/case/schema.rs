//! JSON Schemas, generated from the types that read the files.

use schemars::JsonSchema;
use serde_json::Value;

/// Returns the JSON Schema of a file.
pub fn schema_of<T: JsonSchema>() -> Value {
    let mut schema = schemars::schema_for!(T).to_value();
    describe_choices(&mut schema);
    schema
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
