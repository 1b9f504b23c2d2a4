//! Reader of case files and law tests: from text to types.
//!
//! The text first becomes a JSON document, in which no key may occur twice; the document becomes a `Case` or a
//! `LawTestInput`, and errors are reported with their place.
//!
//! A `"note"`, text in any object, and `"$schema"` are for readers and editors: they leave the document first.
//!
//! Lists of the document are not accepted as objects: serde's derived types would take a list as values of their keys in order.
//!
//! serde's errors are translated into the terms of a case file.

use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::Path;

use serde::de::value::{BorrowedStrDeserializer, MapAccessDeserializer, MapDeserializer, SeqDeserializer};
use serde::de::{
    Deserialize, DeserializeOwned, Deserializer, Error, IntoDeserializer, MapAccess, SeqAccess, Unexpected, Visitor,
};
use serde::forward_to_deserialize_any;
use serde_json::error::Category;
use serde_json::{Map, Value};
use serde_path_to_error::{Path as KeyPath, Segment};

use super::error::CaseError;
use crate::mesh::names::{in_line, not_known};
use crate::model::builder::ModelError;

/// Largest size of a case file; large meshes have files of their own [MiB].
const LARGEST: u64 = 16;

/// Keys that select a law; without one the other keys of the object have no meaning.
const TAGS: [&str; 2] = ["model", "law"];

/// Reads a file; unknown keys, wrong types and invalid numbers are reported with their place.
///
/// # Errors
/// Returns [`CaseError`] if the file cannot be read or is invalid.
pub fn read<T: DeserializeOwned>(path: &Path) -> Result<T, CaseError> {
    read_document(path, |_| Ok(())).map(|(_, input)| input)
}

/// Reads the text of a file; `path` is used in messages.
///
/// # Errors
/// The same as for [`read`].
pub fn read_text<T: DeserializeOwned>(text: &str, path: &Path) -> Result<T, CaseError> {
    read_document_text(text, path, |_| Ok(())).map(|(_, input)| input)
}

/// Returns the JSON document of a file without its notes, made plain by `prepare`, and its value.
///
/// # Errors
/// The same as for [`read`], and those of `prepare`.
pub fn read_document<T: DeserializeOwned>(path: &Path, prepare: Prepare) -> Result<(Value, T), CaseError> {
    let text = text(path).map_err(|complaint| complaint.in_file(path))?;
    read_document_text(&text, path, prepare)
}

/// What makes a document plain before it is read.
pub type Prepare = fn(&mut Value) -> Result<(), ModelError>;

/// Returns the same as [`read_document`], from the text instead of the file.
///
/// # Errors
/// The same as for [`read_document`].
pub fn read_document_text<T: DeserializeOwned>(
    text: &str,
    path: &Path,
    prepare: Prepare,
) -> Result<(Value, T), CaseError> {
    let read = document(text).and_then(|mut document| {
        take_notes(&mut document);
        prepare(&mut document)?;
        Ok((input(&document)?, document))
    });
    read.map(|(input, document)| (document, input)).map_err(|complaint| complaint.in_file(path))
}

fn text(path: &Path) -> Result<String, ModelError> {
    let complain = |message: &str| ModelError::new("", message);
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
        let message =
            format!("is larger than {LARGEST} MiB, too large for a case; a large mesh belongs in a .msh file");
        return Err(complain(&message));
    }
    let text = String::from_utf8(bytes).map_err(|_| complain("is not a text file; cases are JSON"))?;
    let text = text.trim_start_matches('\u{feff}');
    match text.trim().is_empty() {
        true => Err(complain("is empty; a case is a JSON object, as `fecontact schema` describes")),
        false => Ok(text.into()),
    }
}

/// The key of a remark, text in any object.
pub const NOTE: &str = "note";

/// The key by which editors find the schema.
pub const SCHEMA: &str = "$schema";

/// Takes what is for readers and editors alone out of a document: notes, and the reference to its schema.
fn take_notes(document: &mut Value) {
    fn take(value: &mut Value) {
        match value {
            Value::Object(object) => {
                if object.get(NOTE).is_some_and(Value::is_string) {
                    object.remove(NOTE);
                }
                object.values_mut().for_each(take);
            }
            Value::Array(list) => list.iter_mut().for_each(take),
            _ => {}
        }
    }
    if let Some(object) = document.as_object_mut().filter(|object| object.get(SCHEMA).is_some_and(Value::is_string)) {
        object.remove(SCHEMA);
    }
    take(document);
}

fn document(text: &str) -> Result<Value, ModelError> {
    let mut json = serde_json::Deserializer::from_str(text);
    let Document(document) = serde_path_to_error::deserialize(&mut json)
        .map_err(|error| ModelError::new(place(error.path(), None), not_json(error.inner())))?;
    json.end().map_err(|error| ModelError::new("", format!("has text after the end of its JSON object: {error}")))?;
    Ok(document)
}

/// Message of the JSON parser in plain words.
fn not_json(error: &serde_json::Error) -> String {
    let (line, column) = (error.line(), error.column());
    let cause = error.to_string();
    let cause = cause.split(" at line ").next().unwrap_or_default();
    match (error.classify(), cause) {
        (Category::Eof, _) => {
            format!("the file ends too early, at line {line}: a brace, bracket or quotation mark is not closed")
        }
        (_, "number out of range") => {
            format!("the number at line {line}, column {column} is too large for double precision")
        }
        (_, "expected value" | "expected ident") => format!(
            "there is no JSON value at line {line}, column {column}: give a number, \"text\", true, false, null, […] \
             or {{…}} (JSON has no NaN and no infinity)"
        ),
        (Category::Syntax, _) => format!("this is not JSON: {cause} at line {line}, column {column}"),
        _ => format!("{cause} (line {line}, column {column})"),
    }
}

/// A JSON value in which no object contains a key twice.
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
                return Err(A::Error::custom(format!("the key `{key}` appears here twice: keep one, or rename one")));
            }
            object.insert(key, value);
        }
        Ok(object.into())
    }
}

pub(super) fn input<T: DeserializeOwned>(document: &Value) -> Result<T, ModelError> {
    tracked(document).map_err(|error| {
        let message = error.inner().to_string();
        let key = blamed_key::<T>(document, error.path(), &message);
        ModelError::new(place(error.path(), key.as_deref()), explain(&message))
    })
}

/// The types of a case are read in this one way: each other one would be compiled for all of them once more.
fn tracked<T: DeserializeOwned>(document: &Value) -> Result<T, serde_path_to_error::Error<serde_json::Error>> {
    serde_path_to_error::deserialize(Strict(document))
}

/// Place of a key in messages: `steps[0].dt.min`.
fn place(path: &KeyPath, key: Option<&str>) -> String {
    let path = path.to_string();
    let known = if path == "." { "" } else { path.as_str() };
    match key {
        Some(key) if known.is_empty() => clipped(key),
        Some(key) => clipped(&format!("{known}.{key}")),
        None => clipped(known),
    }
}

/// Returns the invalid key of an object whose law is selected by a tag, where serde does not report the path: the key whose
/// removal changes the message.
fn blamed_key<T: DeserializeOwned>(document: &Value, path: &KeyPath, message: &str) -> Option<String> {
    if message.starts_with("missing field") || message == SEVERAL_KEYS {
        return None;
    }
    let keys = object_at(&mut document.clone(), path)?.keys().cloned().collect::<Vec<_>>();
    let (tags, others): (Vec<_>, Vec<_>) = keys.into_iter().partition(|key| TAGS.contains(&key.as_str()));
    others.into_iter().chain(tags).find(|key| {
        let mut without = document.clone();
        object_at(&mut without, path).map(|object| object.remove(key));
        tracked::<T>(&without).map_or_else(|error| error.inner().to_string() != message, |_| true)
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

/// A value that is none of the expected ones, in serde's words.
fn unexpected(value: &Value) -> Unexpected<'_> {
    match value {
        Value::Null => Unexpected::Unit,
        Value::Bool(value) => Unexpected::Bool(*value),
        Value::Number(number) => match (number.as_u64(), number.as_i64()) {
            (Some(number), _) => Unexpected::Unsigned(number),
            (_, Some(number)) => Unexpected::Signed(number),
            _ => Unexpected::Float(number.as_f64().unwrap_or(f64::NAN)),
        },
        Value::String(text) => Unexpected::Str(text),
        Value::Array(_) => Unexpected::Seq,
        Value::Object(_) => Unexpected::Map,
    }
}

/// A value whose lists are accepted as lists only.
#[derive(Clone, Copy)]
pub struct Strict<'de>(pub &'de Value);

/// Expectation of a tagged enum, in serde's words; all other types that accept lists request them.
const TAGGED: &str = "internally tagged enum ";

/// The entries of an object.
type Entries<'de> = MapDeserializer<'de, Box<dyn Iterator<Item = (&'de str, Strict<'de>)> + 'de>, serde_json::Error>;

impl<'de> Strict<'de> {
    fn list<V: Visitor<'de>>(list: &'de [Value], visitor: V) -> Result<V::Value, serde_json::Error> {
        let mut entries = SeqDeserializer::new(list.iter().map(Strict));
        let value = visitor.visit_seq(&mut entries)?;
        match entries.end() {
            Ok(()) => Ok(value),
            Err(_) => Err(serde_json::Error::invalid_length(list.len(), &"fewer elements in array")),
        }
    }

    fn entries(object: &'de Map<String, Value>) -> Entries<'de> {
        MapDeserializer::new(Box::new(object.iter().map(|(key, value)| (key.as_str(), Strict(value)))))
    }
}

impl<'de> Deserializer<'de> for Strict<'de> {
    type Error = serde_json::Error;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, serde_json::Error> {
        let expected = |visitor: &V| (visitor as &dyn serde::de::Expected).to_string();
        match self.0 {
            Value::Array(_) if expected(&visitor).starts_with(TAGGED) => {
                Err(serde_json::Error::invalid_type(Unexpected::Seq, &visitor))
            }
            Value::Array(list) => Self::list(list, visitor),
            Value::Object(object) => {
                let mut entries = Self::entries(object);
                let value = visitor.visit_map(&mut entries)?;
                match entries.end() {
                    Ok(()) => Ok(value),
                    Err(_) => Err(serde_json::Error::invalid_length(object.len(), &"fewer elements in map")),
                }
            }
            Value::Null => visitor.visit_unit(),
            Value::Bool(value) => visitor.visit_bool(*value),
            Value::Number(number) => number.deserialize_any(visitor),
            Value::String(text) => visitor.visit_borrowed_str(text),
        }
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, serde_json::Error> {
        match self.0 {
            Value::Array(_) => Err(serde_json::Error::invalid_type(Unexpected::Seq, &visitor)),
            _ => self.deserialize_any(visitor),
        }
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, serde_json::Error> {
        self.deserialize_map(visitor)
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, serde_json::Error> {
        if self.0.is_null() { visitor.visit_none() } else { visitor.visit_some(self) }
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        visitor: V,
    ) -> Result<V::Value, serde_json::Error> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        name: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, serde_json::Error> {
        match self.0 {
            Value::Object(object) if object.len() != 1 => Err(serde_json::Error::custom(SEVERAL_KEYS)),
            Value::Object(object) => {
                MapAccessDeserializer::new(Self::entries(object)).deserialize_enum(name, variants, visitor)
            }
            Value::String(variant) => visitor.visit_enum(BorrowedStrDeserializer::new(variant)),
            other => Err(serde_json::Error::invalid_type(unexpected(other), &"string or map")),
        }
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf unit unit_struct seq tuple
        tuple_struct identifier ignored_any
    }
}

impl<'de> IntoDeserializer<'de, serde_json::Error> for Strict<'de> {
    type Deserializer = Self;

    fn into_deserializer(self) -> Self {
        self
    }
}

/// Longest quotation of the user's text in a message.
const LONGEST: usize = 100;

const OBJECT: &str = "an object {…}";

/// serde's message for an object with several keys that should select one variant.
pub const SEVERAL_KEYS: &str = "invalid value: map, expected map with a single key";

/// Converts a message of serde to a sentence; unknown names come with the nearest known one.
pub fn explain(message: &str) -> String {
    if message.starts_with("unknown field") || message.starts_with("unknown variant") {
        return unknown(message);
    }
    if let Some(rest) = message.strip_prefix("missing field ") {
        return format!("the key {rest} is missing here");
    }
    if message == SEVERAL_KEYS {
        return "has several keys, but must be an object {…} with exactly one key".into();
    }
    // Messages of the input types themselves are sentences.
    let Some((found, expected)) = message.split_once(", expected ") else { return message.into() };
    let expected = plain_expected(expected);
    if let Some(found) = found.strip_prefix("invalid type: ").or_else(|| found.strip_prefix("invalid value: ")) {
        return format!("is {}, but must be {expected}", plain_found(found));
    }
    match found.strip_prefix("invalid length ") {
        Some(_) if expected == OBJECT => format!("is a list […], but must be {OBJECT}"),
        Some(length) => format!("has {length} entries, but must have {expected}"),
        None => clipped(message),
    }
}

/// serde quotes the unknown name first, then all known ones.
fn unknown(message: &str) -> String {
    let mut quoted = message.split('`').skip(1).step_by(2);
    let name = quoted.next().unwrap_or_default();
    let known: Vec<&str> = quoted.collect();
    let name = clipped(name);
    if let Some(here) = super::words::here(&name, &known) {
        let others = if known.is_empty() { String::new() } else { format!(". Known are `{}`", known.join("`, `")) };
        return format!("`{name}` is not known here: {here}{others}");
    }
    match known.is_empty() {
        true => format!("`{name}` is not known here: leave it out, this object takes no further keys"),
        false => not_known(&name, &known),
    }
}

fn plain_found(found: &str) -> String {
    let value = found.split_once('`').map(|(_, value)| value.trim_end_matches('`'));
    match (found, value) {
        ("map", _) => "an object {…}".into(),
        ("sequence", _) => "a list […]".into(),
        ("unit variant", _) => "a name alone".into(),
        (_, Some(value)) => clipped(value),
        _ => clipped(found.strip_prefix("string ").unwrap_or(found)),
    }
}

fn plain_expected(expected: &str) -> &str {
    match expected {
        "f64" => "a number",
        "u64" | "usize" => "a whole number, 0 or more",
        "a string" => "text in quotes",
        "a boolean" => "true or false",
        "a map" => OBJECT,
        "a sequence" => "a list […]",
        "an array of length 2" => "2 numbers",
        "an array of length 4" => "4",
        "fewer elements in array" | "fewer elements in map" => "fewer",
        "enum" => "an object {…} with exactly one key",
        "string or map" | "variant identifier" => "a name in quotes, or an object {…} with one key",
        _ if ["struct ", "internally tagged enum "].iter().any(|kind| expected.starts_with(kind)) => OBJECT,
        _ => expected,
    }
}

/// The text in one line, truncated if too long for a message.
pub fn clipped(text: &str) -> String {
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}…", in_line(&text[..end])),
        None => in_line(text).into(),
    }
}
