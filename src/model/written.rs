//! Input that may be written as a number, a text, a list or an object. The JSON type determines the form, so that an error
//! inside the object is reported with its place.

use std::marker::PhantomData;

use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserializer, Error, MapAccess, SeqAccess, Unexpected, Visitor};

/// Input given as a text or an object, in some cases as a number or a list. [`written!`] generates the implementation.
pub trait Written: Sized {
    /// Description of the possible forms, for messages
    const EXPECTING: &'static str;

    /// Returns the value from a number, if numbers are allowed.
    fn number(_value: f64) -> Option<Self> {
        None
    }

    /// Returns the value from a text.
    ///
    /// # Errors
    /// Returns an error with a message if it cannot be read.
    fn text<E: Error>(text: &str) -> Result<Self, E>;

    /// Returns the value from a list, if lists are allowed.
    ///
    /// # Errors
    /// Returns the error of the deserializer.
    fn list<'de, A: SeqAccess<'de>>(_list: A) -> Result<Self, A::Error> {
        Err(A::Error::invalid_type(Unexpected::Seq, &Forms::<Self>(PhantomData)))
    }

    /// Returns the value from an object.
    ///
    /// # Errors
    /// Returns the error of the deserializer.
    fn object<'de, D: Deserializer<'de>>(object: D) -> Result<Self, D::Error>;

    /// Reads the value in whichever form it has.
    ///
    /// # Errors
    /// Returns the error of the deserializer, with the expected forms for a value of another type.
    fn read<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Forms(PhantomData))
    }
}

struct Forms<T>(PhantomData<T>);

impl<T: Written> Forms<T> {
    fn number<E: Error>(self, value: f64, written: Unexpected) -> Result<T, E> {
        T::number(value).ok_or_else(|| E::invalid_type(written, &self))
    }
}

impl<'de, T: Written> Visitor<'de> for Forms<T> {
    type Value = T;

    fn expecting(&self, formatter: &mut std::fmt::Formatter) -> std::fmt::Result {
        formatter.write_str(T::EXPECTING)
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
        T::text(value)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, entries: A) -> Result<T, A::Error> {
        T::list(entries)
    }

    fn visit_map<A: MapAccess<'de>>(self, entries: A) -> Result<T, A::Error> {
        T::object(MapAccessDeserializer::new(entries))
    }
}

/// Implements reading and writing of an enum with a variant that is a plain text, optionally one that is a plain number, and
/// others that are objects of one key: `written!(Type, "expected forms", number: Variant, text: Variant)`. The type derives the
/// form of the objects with `#[serde(remote = "Self")]`, and skips the plain variants there.
///
/// With `object: Inner => make`, an object is read as another type, which `make` converts to the enum; writing is derived by
/// the enum itself.
macro_rules! written {
    ($type:ident, $expecting:literal, $(number: $number:ident,)? text: $text:ident) => {
        $crate::model::written::written!(@ $type, $expecting, [$($number)?], $text, |object| Self::deserialize(object));

        impl serde::Serialize for $type {
            fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                match self {
                    $(Self::$number(value) => serializer.serialize_f64(*value),)?
                    Self::$text(text) => serializer.serialize_str(text.as_ref()),
                    object => Self::serialize(object, serializer),
                }
            }
        }
    };
    ($type:ident, $expecting:literal, $(number: $number:ident,)? text: $text:ident, object: $inner:ty => $make:expr) => {
        $crate::model::written::written!(
            @ $type, $expecting, [$($number)?], $text, |object| <$inner as serde::Deserialize>::deserialize(object).map($make)
        );
    };
    (@ $type:ident, $expecting:literal, [$($number:ident)?], $text:ident, |$object:ident| $read:expr) => {
        impl $crate::model::written::Written for $type {
            const EXPECTING: &'static str = $expecting;

            $(fn number(value: f64) -> Option<Self> {
                Some(Self::$number(value))
            })?

            fn text<E: serde::de::Error>(text: &str) -> Result<Self, E> {
                text.parse().map(Self::$text).map_err(E::custom)
            }

            fn object<'de, D: serde::Deserializer<'de>>($object: D) -> Result<Self, D::Error> {
                $read
            }
        }

        impl<'de> serde::Deserialize<'de> for $type {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                $crate::model::written::Written::read(deserializer)
            }
        }
    };
}
pub(crate) use written;
