//! Values that may be written as a number, a text or an object, told apart by their JSON type, so that a complaint about
//! the inside of the object names its place.

use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserialize, Deserializer, Error, MapAccess, Unexpected, Visitor};

/// How a `T` is written; `O` is its object.
pub struct Choice<T, O> {
    /// the forms there are, for messages
    pub expecting: &'static str,
    /// from a number, if it may be one
    pub number: Option<fn(f64) -> T>,
    /// from a text
    pub text: fn(String) -> T,
    /// from an object
    pub object: fn(O) -> T,
}

impl<T, O> Choice<T, O> {
    /// Read whichever form is there.
    ///
    /// # Errors
    /// The deserializer's, with `expecting` for a value of another type.
    pub fn read<'de, D: Deserializer<'de>>(self, deserializer: D) -> Result<T, D::Error>
    where
        O: Deserialize<'de>,
    {
        deserializer.deserialize_any(self)
    }

    fn number<'de, E: Error>(self, value: f64, written: Unexpected) -> Result<T, E>
    where
        O: Deserialize<'de>,
    {
        self.number.map(|number| number(value)).ok_or_else(|| E::invalid_type(written, &self))
    }
}

impl<'de, T, O: Deserialize<'de>> Visitor<'de> for Choice<T, O> {
    type Value = T;

    fn expecting(&self, formatter: &mut std::fmt::Formatter) -> std::fmt::Result {
        formatter.write_str(self.expecting)
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<T, E> {
        self.number(value, Unexpected::Float(value))
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<T, E> {
        self.number(value as f64, Unexpected::Signed(value))
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<T, E> {
        self.number(value as f64, Unexpected::Unsigned(value))
    }

    fn visit_str<E: Error>(self, value: &str) -> Result<T, E> {
        Ok((self.text)(value.into()))
    }

    fn visit_map<A: MapAccess<'de>>(self, entries: A) -> Result<T, A::Error> {
        O::deserialize(MapAccessDeserializer::new(entries)).map(self.object)
    }
}
