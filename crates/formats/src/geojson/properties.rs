//! The properties of a feature that concern sight.

use super::MAX_GROUPS;
use super::context::Context;
use super::error::GeoJsonErrorKind;
use serde::de::{DeserializeSeed, Deserializer, IgnoredAny, MapAccess, SeqAccess, Visitor};
use std::fmt;

/// A JSON value as far as properties need it.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Scalar {
    Null,
    Bool(bool),
    Integer(u64),
    Number(f64),
    Text(String),
    /// A list or an object.
    Other,
}

impl Scalar {
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

/// Reads any value into a [`Scalar`].
pub(super) struct ScalarSeed;

impl<'de> DeserializeSeed<'de> for ScalarSeed {
    type Value = Scalar;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Scalar, D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for ScalarSeed {
    type Value = Scalar;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a JSON value")
    }

    fn visit_unit<E>(self) -> Result<Scalar, E> {
        Ok(Scalar::Null)
    }

    fn visit_bool<E>(self, value: bool) -> Result<Scalar, E> {
        Ok(Scalar::Bool(value))
    }

    fn visit_u64<E>(self, value: u64) -> Result<Scalar, E> {
        Ok(Scalar::Integer(value))
    }

    fn visit_i64<E>(self, value: i64) -> Result<Scalar, E> {
        Ok(Scalar::Number(value as f64))
    }

    fn visit_f64<E>(self, value: f64) -> Result<Scalar, E> {
        Ok(Scalar::Number(value))
    }

    fn visit_str<E>(self, value: &str) -> Result<Scalar, E> {
        Ok(Scalar::Text(value.to_owned()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Scalar, A::Error> {
        while seq.next_element::<IgnoredAny>()?.is_some() {}
        Ok(Scalar::Other)
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Scalar, A::Error> {
        while map.next_entry::<IgnoredAny, IgnoredAny>()?.is_some() {}
        Ok(Scalar::Other)
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
    pub(super) fn take(&mut self, key: &str, value: Scalar) -> Result<(), GeoJsonErrorKind> {
        match (key, value) {
            (_, Scalar::Null) => {}
            ("sight", value) => self.transparent |= is_transparent(&value)?,
            ("opaque", Scalar::Bool(opaque)) => self.transparent |= !opaque,
            ("opaque", _) => return Err(wrong("opaque", "true or false")),
            ("mirror", Scalar::Bool(is_mirror)) => self.is_mirror = is_mirror,
            ("mirror", _) => return Err(wrong("mirror", "true or false")),
            ("left_group", value) => self.left = Some(group("left_group", &value)?),
            ("right_group", value) => self.right = Some(group("right_group", &value)?),
            ("name", value) => self.name = value.into_name(),
            ("id", value) => self.id = value.into_name(),
            ("object", value) => self.is_box = value == Scalar::Text("box".to_owned()),
            _ => {}
        }
        Ok(())
    }
}

fn is_transparent(value: &Scalar) -> Result<bool, GeoJsonErrorKind> {
    match value {
        Scalar::Text(text) if text == "transparent" => Ok(true),
        Scalar::Text(text) if text == "opaque" => Ok(false),
        _ => Err(wrong("sight", "\"opaque\" or \"transparent\"")),
    }
}

fn group(property: &'static str, value: &Scalar) -> Result<u32, GeoJsonErrorKind> {
    let &Scalar::Integer(group) = value else { return Err(wrong(property, "a whole number from 0")) };
    let fits = u32::try_from(group).ok().filter(|&g| g < MAX_GROUPS);
    fits.ok_or(GeoJsonErrorKind::Group { property, group })
}

pub(super) fn wrong(property: &'static str, expected: &'static str) -> GeoJsonErrorKind {
    GeoJsonErrorKind::Property { property, expected }
}

/// Reads the value of a member `properties`, which may be `null`.
pub(super) struct PropertiesSeed<'r>(pub(super) &'r mut Context);

impl<'de> DeserializeSeed<'de> for PropertiesSeed<'_> {
    type Value = Properties;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Properties, D::Error> {
        self.0.expect(GeoJsonErrorKind::Member { member: "properties", expected: "an object" });
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for PropertiesSeed<'_> {
    type Value = Properties;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object of properties")
    }

    fn visit_unit<E>(self) -> Result<Properties, E> {
        Ok(Properties::default())
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Properties, A::Error> {
        let mut properties = Properties::default();
        while let Some(key) = map.next_key::<String>()? {
            let value = map.next_value_seed(ScalarSeed)?;
            properties.take(&key, value).map_err(|kind| self.0.fail(kind))?;
        }
        Ok(properties)
    }
}
