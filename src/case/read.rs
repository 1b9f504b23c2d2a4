//! From the text of a case file, or a test of a law, to its types.
//!
//! The text becomes a JSON document first, in which no key may stand twice; the document becomes a `Case` or a
//! `LawTestInput`, and what does not fit is named by its place.

use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::Path;

use serde::de::{Deserialize, DeserializeOwned, Deserializer, Error, MapAccess, SeqAccess, Visitor};
use serde_json::error::Category;
use serde_json::{Map, Value};
use serde_path_to_error::{Path as KeyPath, Segment};

use super::error::{CaseError, Complaint};
use super::explain::{SEVERAL_KEYS, clipped, explain};
use super::strict::Strict;

/// No case is larger: large meshes have files of their own [MiB].
const LARGEST: u64 = 16;

/// Keys that choose a law; without one nothing else in its object makes sense.
const TAGS: [&str; 2] = ["model", "law"];

/// Read a file; unknown keys, wrong types and impossible numbers are named with their place.
///
/// # Errors
/// [`CaseError`] when the file cannot be read or is not what it should be.
pub fn read<T: DeserializeOwned>(path: &Path) -> Result<T, CaseError> {
    let input = text(path).and_then(|text| document(&text)).and_then(|document| input(&document));
    input.map_err(|complaint| complaint.in_file(path))
}

/// Read what would be the text of a file; `path` is for complaints.
///
/// # Errors
/// As [`read`].
pub fn read_text<T: DeserializeOwned>(text: &str, path: &Path) -> Result<T, CaseError> {
    document(text).and_then(|document| input(&document)).map_err(|complaint| complaint.in_file(path))
}

/// The document of a file, and what it says.
///
/// # Errors
/// As [`read`].
pub fn read_document<T: DeserializeOwned>(path: &Path) -> Result<(Value, T), CaseError> {
    let text = text(path).map_err(|complaint| complaint.in_file(path))?;
    read_document_text(&text, path)
}

/// The same of what would be the text of a file.
///
/// # Errors
/// As [`read`].
pub fn read_document_text<T: DeserializeOwned>(text: &str, path: &Path) -> Result<(Value, T), CaseError> {
    let read = document(text).and_then(|document| Ok((input(&document)?, document)));
    read.map(|(input, document)| (document, input)).map_err(|complaint| complaint.in_file(path))
}

fn text(path: &Path) -> Result<String, Complaint> {
    let complain = |message: &str| Complaint::new("", message);
    let unreadable = |cause: std::io::Error| match cause.kind() {
        ErrorKind::NotFound => complain("there is no such file; check the path"),
        _ => complain(&format!("cannot be read: {cause}")),
    };
    if path.is_dir() {
        return Err(complain("is a folder; give the path of a case or test (JSON)"));
    }
    let mut bytes = Vec::new();
    let limit = LARGEST << 20;
    File::open(path).and_then(|file| file.take(limit + 1).read_to_end(&mut bytes)).map_err(unreadable)?;
    if bytes.len() as u64 > limit {
        let message = format!("is larger than {LARGEST} MiB, so it is no case; a large mesh belongs in a .msh file");
        return Err(complain(&message));
    }
    let text = String::from_utf8(bytes).map_err(|_| complain("is not a text file; cases are JSON"))?;
    let text = text.trim_start_matches('\u{feff}');
    match text.trim().is_empty() {
        true => Err(complain("is empty; a case is a JSON object, as `fecontact schema` describes")),
        false => Ok(text.into()),
    }
}

fn document(text: &str) -> Result<Value, Complaint> {
    let mut json = serde_json::Deserializer::from_str(text);
    let Document(document) = serde_path_to_error::deserialize(&mut json)
        .map_err(|error| Complaint::new(place(error.path(), None), not_json(error.inner())))?;
    json.end().map_err(|error| Complaint::new("", format!("goes on after the end of its JSON object: {error}")))?;
    Ok(document)
}

/// What the JSON parser says, in plain words.
fn not_json(error: &serde_json::Error) -> String {
    let (line, column) = (error.line(), error.column());
    let cause = error.to_string();
    let cause = cause.split(" at line ").next().unwrap_or_default();
    match (error.classify(), cause) {
        (Category::Eof, _) => {
            format!("the file ends too early, at line {line}: a brace, bracket or quotation mark is not closed")
        }
        (_, "number out of range") => {
            format!("the number at line {line}, column {column} is too large for a computer to hold")
        }
        (_, "expected value" | "expected ident") => format!(
            "no JSON value stands at line {line}, column {column}: give a number, \"text\", true, false, null, […] or \
             {{…}} (JSON has no NaN and no infinity)"
        ),
        (Category::Syntax, _) => format!("this is not JSON: {cause} at line {line}, column {column}"),
        _ => format!("{cause} (line {line}, column {column})"),
    }
}

/// A JSON value whose objects name each key once.
struct Document(Value);

impl<'de> Deserialize<'de> for Document {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(DocumentVisitor).map(Document)
    }
}

struct DocumentVisitor;

impl<'de> Visitor<'de> for DocumentVisitor {
    type Value = Value;

    fn expecting(&self, formatter: &mut std::fmt::Formatter) -> std::fmt::Result {
        formatter.write_str("a JSON value")
    }

    fn visit_unit<E: Error>(self) -> Result<Value, E> {
        Ok(Value::Null)
    }

    fn visit_bool<E: Error>(self, value: bool) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_str<E: Error>(self, value: &str) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut entries: A) -> Result<Value, A::Error> {
        let mut list = Vec::new();
        while let Some(Document(entry)) = entries.next_element()? {
            list.push(entry);
        }
        Ok(list.into())
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<Value, A::Error> {
        let mut object = Map::new();
        while let Some((key, Document(value))) = entries.next_entry::<String, Document>()? {
            if object.contains_key(&key) {
                return Err(A::Error::custom(format!("the key `{key}` stands here twice: keep one, or rename one")));
            }
            object.insert(key, value);
        }
        Ok(object.into())
    }
}

pub(super) fn input<T: DeserializeOwned>(document: &Value) -> Result<T, Complaint> {
    serde_path_to_error::deserialize(Strict(document)).map_err(|error| {
        let message = error.inner().to_string();
        let key = blamed_key::<T>(document, error.path(), &message);
        Complaint::new(place(error.path(), key.as_deref()), explain(&message))
    })
}

/// The place of a key as messages show it: `steps[0].dt.min`.
fn place(path: &KeyPath, key: Option<&str>) -> String {
    let path = path.to_string();
    let known = if path == "." { "" } else { path.as_str() };
    match key {
        Some(key) if known.is_empty() => clipped(key),
        Some(key) => clipped(&format!("{known}.{key}")),
        None => clipped(known),
    }
}

/// The key to blame inside an object whose law is chosen by a tag, where serde loses the way: the one without which the
/// complaint changes.
fn blamed_key<T: DeserializeOwned>(document: &Value, path: &KeyPath, message: &str) -> Option<String> {
    if message.starts_with("missing field") || message == SEVERAL_KEYS {
        return None;
    }
    let keys = object_at(&mut document.clone(), path)?.keys().cloned().collect::<Vec<_>>();
    let (tags, others): (Vec<_>, Vec<_>) = keys.into_iter().partition(|key| TAGS.contains(&key.as_str()));
    others.into_iter().chain(tags).find(|key| {
        let mut without = document.clone();
        object_at(&mut without, path).map(|object| object.remove(key));
        T::deserialize(Strict(&without)).map_or_else(|error| error.to_string() != message, |_| true)
    })
}

fn object_at<'v>(document: &'v mut Value, path: &KeyPath) -> Option<&'v mut Map<String, Value>> {
    let step = |value: &'v mut Value, segment: &Segment| match segment {
        Segment::Seq { index } => value.get_mut(index),
        Segment::Map { key } => value.get_mut(key),
        Segment::Enum { variant } => value.get_mut(variant),
        Segment::Unknown => None,
    };
    path.iter().try_fold(document, step)?.as_object_mut()
}
