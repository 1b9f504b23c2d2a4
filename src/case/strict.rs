//! A JSON document whose lists are no objects: serde's derived types would take a list for their keys in order.

use serde::de::value::{MapAccessDeserializer, MapDeserializer, SeqDeserializer};
use serde::de::{Deserializer, Error as _, IntoDeserializer, Unexpected, Visitor};
use serde::forward_to_deserialize_any;
use serde_json::{Error, Map, Value};

use super::explain::SEVERAL_KEYS;

/// A value whose lists are taken for lists only.
#[derive(Clone, Copy)]
pub struct Strict<'de>(pub &'de Value);

/// What a type that is chosen by a tag expects, in serde's words: all else that takes lists says so by its request.
const TAGGED: &str = "internally tagged enum ";

/// The entries of an object.
type Entries<'de> = MapDeserializer<'de, Box<dyn Iterator<Item = (&'de str, Strict<'de>)> + 'de>, Error>;

impl<'de> Strict<'de> {
    fn list<V: Visitor<'de>>(list: &'de [Value], visitor: V) -> Result<V::Value, Error> {
        let mut entries = SeqDeserializer::new(list.iter().map(Strict));
        let value = visitor.visit_seq(&mut entries)?;
        match entries.end() {
            Ok(()) => Ok(value),
            Err(_) => Err(Error::invalid_length(list.len(), &"fewer elements in array")),
        }
    }

    fn entries(object: &'de Map<String, Value>) -> Entries<'de> {
        MapDeserializer::new(Box::new(object.iter().map(|(key, value)| (key.as_str(), Strict(value)))))
    }
}

impl<'de> Deserializer<'de> for Strict<'de> {
    type Error = Error;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        let expected = |visitor: &V| (visitor as &dyn serde::de::Expected).to_string();
        match self.0 {
            Value::Array(_) if expected(&visitor).starts_with(TAGGED) => {
                Err(Error::invalid_type(Unexpected::Seq, &visitor))
            }
            Value::Array(list) => Self::list(list, visitor),
            Value::Object(object) => {
                let mut entries = Self::entries(object);
                let value = visitor.visit_map(&mut entries)?;
                match entries.end() {
                    Ok(()) => Ok(value),
                    Err(_) => Err(Error::invalid_length(object.len(), &"fewer elements in map")),
                }
            }
            scalar => scalar.deserialize_any(visitor),
        }
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        match self.0 {
            Value::Array(_) => Err(Error::invalid_type(Unexpected::Seq, &visitor)),
            _ => self.deserialize_any(visitor),
        }
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Error> {
        self.deserialize_map(visitor)
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        if self.0.is_null() { visitor.visit_none() } else { visitor.visit_some(self) }
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(self, _: &'static str, visitor: V) -> Result<V::Value, Error> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        name: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Error> {
        match self.0 {
            Value::Object(object) if object.len() != 1 => Err(Error::custom(SEVERAL_KEYS)),
            Value::Object(object) => {
                MapAccessDeserializer::new(Self::entries(object)).deserialize_enum(name, variants, visitor)
            }
            other => other.deserialize_enum(name, variants, visitor),
        }
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf unit unit_struct seq tuple
        tuple_struct identifier ignored_any
    }
}

impl<'de> IntoDeserializer<'de, Error> for Strict<'de> {
    type Deserializer = Self;

    fn into_deserializer(self) -> Self {
        self
    }
}
