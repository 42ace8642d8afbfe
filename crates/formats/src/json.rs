//! JSON that is read as it comes, with reasons of our own where it is not what it should be.

use crate::error::Malformed;
use serde::de::{DeserializeSeed, Deserializer, Error, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde_json::error::Category;
use std::fmt::{self, Display};

/// Where the reader is, and why reading failed or is about to fail there.
#[derive(Debug, Default)]
pub(crate) struct Context<P> {
    pub(crate) place: P,
    failure: Option<String>,
    /// What is wrong if the next value is of another JSON type than it should be.
    otherwise: &'static str,
}

pub(crate) const NOT_AN_OBJECT: &str = "not a JSON object";

impl<P: Display> Context<P> {
    /// Sets what is wrong if the value that is read next is of another JSON type than expected.
    pub(crate) fn expect(&mut self, otherwise: &'static str) {
        self.otherwise = otherwise;
    }

    /// Keeps the reason and makes the error that carries the position in the text.
    pub(crate) fn fail<E: Error>(&mut self, what: impl Display) -> E {
        self.failure = Some(what.to_string());
        E::custom("refused")
    }

    pub(crate) fn explain(&mut self, error: &serde_json::Error) -> Malformed {
        let found = match error.classify() {
            Category::Eof => "the text ends too early",
            Category::Data => self.otherwise,
            Category::Syntax | Category::Io => "not JSON that can be read",
        };
        let what = self.failure.take().unwrap_or_else(|| found.to_owned());
        let place = self.place.to_string();
        Malformed { place, what }.within(format_args!("line {} column {}", error.line(), error.column()))
    }
}

/// A JSON value that is neither a list nor an object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Scalar<'t> {
    Null,
    Bool(bool),
    Integer(u64),
    Number(f64),
    Text(&'t str),
    /// A list or an object, of which nothing is made.
    Other,
}

/// What is made of a JSON value. Values of a type of which nothing is made are refused, for the reason that is [expected](Context::expect).
pub(crate) trait Shape<'de>: Sized {
    type Value;

    fn scalar<E: Error>(self, _: Scalar<'_>) -> Result<Self::Value, E> {
        Err(E::custom("a scalar"))
    }

    fn list<A: SeqAccess<'de>>(self, _: A) -> Result<Self::Value, A::Error> {
        Err(A::Error::custom("a list"))
    }

    fn object<A: MapAccess<'de>>(self, _: A) -> Result<Self::Value, A::Error> {
        Err(A::Error::custom("an object"))
    }
}

pub(crate) struct Any<F>(pub(crate) F);

impl<'de, T, F: FnOnce(Scalar<'_>) -> T> Shape<'de> for Any<F> {
    type Value = T;

    fn scalar<E: Error>(self, value: Scalar<'_>) -> Result<T, E> {
        Ok((self.0)(value))
    }

    fn list<A: SeqAccess<'de>>(self, mut list: A) -> Result<T, A::Error> {
        while list.next_element::<IgnoredAny>()?.is_some() {}
        Ok((self.0)(Scalar::Other))
    }

    fn object<A: MapAccess<'de>>(self, mut object: A) -> Result<T, A::Error> {
        while object.next_entry::<IgnoredAny, IgnoredAny>()?.is_some() {}
        Ok((self.0)(Scalar::Other))
    }
}

pub(crate) struct Seed<S>(pub(crate) S);

impl<'de, S: Shape<'de>> DeserializeSeed<'de> for Seed<S> {
    type Value = S::Value;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<S::Value, D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de, S: Shape<'de>> Visitor<'de> for Seed<S> {
    type Value = S::Value;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("another JSON value")
    }

    fn visit_unit<E: Error>(self) -> Result<S::Value, E> {
        self.0.scalar(Scalar::Null)
    }

    fn visit_bool<E: Error>(self, value: bool) -> Result<S::Value, E> {
        self.0.scalar(Scalar::Bool(value))
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<S::Value, E> {
        self.0.scalar(Scalar::Integer(value))
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<S::Value, E> {
        self.0.scalar(Scalar::Number(value as f64))
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<S::Value, E> {
        self.0.scalar(Scalar::Number(value))
    }

    fn visit_str<E: Error>(self, value: &str) -> Result<S::Value, E> {
        self.0.scalar(Scalar::Text(value))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<S::Value, A::Error> {
        self.0.list(list)
    }

    fn visit_map<A: MapAccess<'de>>(self, object: A) -> Result<S::Value, A::Error> {
        self.0.object(object)
    }
}

/// An index into a list of a document, wherever serde does not read it.
pub(crate) fn as_index(value: &serde_json::Value) -> Option<usize> {
    value.as_u64().and_then(|index| usize::try_from(index).ok())
}
