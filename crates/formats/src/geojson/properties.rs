//! The properties of a feature that concern sight.

use super::MAX_GROUPS;
use super::context::Context;
use crate::error::{Malformed, malformed};
use crate::json::{Scalar, Seed, Shape};
use serde::de::{Error, IgnoredAny, MapAccess, SeqAccess};

/// A JSON value as far as properties need it.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Value {
    Null,
    Bool(bool),
    Integer(u64),
    Number(f64),
    Text(String),
    /// A list or an object.
    Other,
}

impl Value {
    /// Text or a number, as a name.
    pub(super) fn into_name(self) -> Option<String> {
        match self {
            Self::Text(text) => Some(text),
            Self::Integer(n) => Some(n.to_string()),
            Self::Number(x) => Some(x.to_string()),
            Self::Null | Self::Bool(_) | Self::Other => None,
        }
    }
}

/// Any value, as a [`Value`].
pub(super) struct AnyValue;

impl<'de> Shape<'de> for AnyValue {
    type Value = Value;

    fn scalar<E: Error>(self, value: Scalar<'_>) -> Result<Value, E> {
        Ok(match value {
            Scalar::Null => Value::Null,
            Scalar::Bool(value) => Value::Bool(value),
            Scalar::Integer(n) => Value::Integer(n),
            Scalar::Number(x) => Value::Number(x),
            Scalar::Text(text) => Value::Text(text.to_owned()),
        })
    }

    fn list<A: SeqAccess<'de>>(self, mut list: A) -> Result<Value, A::Error> {
        while list.next_element::<IgnoredAny>()?.is_some() {}
        Ok(Value::Other)
    }

    fn object<A: MapAccess<'de>>(self, mut object: A) -> Result<Value, A::Error> {
        while object.next_entry::<IgnoredAny, IgnoredAny>()?.is_some() {}
        Ok(Value::Other)
    }
}

/// The properties of a feature that concern its geometry.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Properties {
    pub(super) transparent: bool,
    pub(super) left: Option<u32>,
    pub(super) right: Option<u32>,
    pub(super) name: Option<String>,
    pub(super) id: Option<String>,
    pub(super) is_box: bool,
    pub(super) is_mirror: bool,
}

impl Properties {
    /// Takes one property; those that mean nothing here are dropped, and so are values of `null`.
    pub(super) fn take(&mut self, key: &str, value: Value) -> Result<(), Malformed> {
        match (key, value) {
            (_, Value::Null) => {}
            ("sight", value) => self.transparent |= is_transparent(&value)?,
            ("opaque", Value::Bool(opaque)) => self.transparent |= !opaque,
            ("opaque", _) => return Err(wrong("opaque", "true or false")),
            ("mirror", Value::Bool(is_mirror)) => self.is_mirror = is_mirror,
            ("mirror", _) => return Err(wrong("mirror", "true or false")),
            ("left_group", value) => self.left = Some(group("left_group", &value)?),
            ("right_group", value) => self.right = Some(group("right_group", &value)?),
            ("name", value) => self.name = value.into_name(),
            ("id", value) => self.id = value.into_name(),
            ("object", value) => self.is_box = value == Value::Text("box".to_owned()),
            _ => {}
        }
        Ok(())
    }
}

fn is_transparent(value: &Value) -> Result<bool, Malformed> {
    match value {
        Value::Text(text) if text == "transparent" => Ok(true),
        Value::Text(text) if text == "opaque" => Ok(false),
        _ => Err(wrong("sight", "\"opaque\" or \"transparent\"")),
    }
}

fn group(property: &str, value: &Value) -> Result<u32, Malformed> {
    let &Value::Integer(group) = value else { return Err(wrong(property, "a whole number from 0")) };
    let fits = u32::try_from(group).ok().filter(|&g| g < MAX_GROUPS);
    fits.ok_or_else(|| malformed!("property \"{property}\": group {group} is not below {MAX_GROUPS}"))
}

pub(super) fn wrong(property: &str, expected: &str) -> Malformed {
    malformed!("property \"{property}\" is not {expected}")
}

const OTHERWISE: &str = "\"properties\" is not an object";

/// The value of a member `properties`, which may be `null`.
pub(super) struct OfFeature<'r>(pub(super) &'r mut Context);

impl<'de> Shape<'de> for OfFeature<'_> {
    type Value = Properties;

    fn begin(&mut self) {
        self.0.expect(OTHERWISE);
    }

    fn scalar<E: Error>(self, value: Scalar<'_>) -> Result<Properties, E> {
        if value == Scalar::Null { Ok(Properties::default()) } else { Err(self.0.fail(OTHERWISE)) }
    }

    fn object<A: MapAccess<'de>>(self, mut map: A) -> Result<Properties, A::Error> {
        let mut properties = Properties::default();
        while let Some(key) = map.next_key::<String>()? {
            let value = map.next_value_seed(Seed(AnyValue))?;
            properties.take(&key, value).map_err(|what| self.0.fail(what))?;
        }
        Ok(properties)
    }
}
