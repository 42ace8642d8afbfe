//! The properties of a feature that concern sight.

use super::Context;
use super::MAX_GROUPS;
use crate::error::{Malformed, malformed};
use crate::json::{Any, Scalar, Seed, Shape};
use serde::de::{Error, MapAccess};

pub(super) fn text_of(value: Scalar<'_>) -> Option<String> {
    if let Scalar::Text(text) = value { Some(text.to_owned()) } else { None }
}

/// Text or a number, as a name.
pub(super) fn name_of(value: Scalar<'_>) -> Option<String> {
    match value {
        Scalar::Integer(n) => Some(n.to_string()),
        Scalar::Number(x) => Some(x.to_string()),
        other => text_of(other),
    }
}

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
    pub(super) fn take(&mut self, key: &str, value: Scalar<'_>) -> Result<(), Malformed> {
        match (key, value) {
            (_, Scalar::Null) => {}
            ("sight", value) => self.transparent |= is_transparent(value)?,
            ("opaque", Scalar::Bool(opaque)) => self.transparent |= !opaque,
            ("opaque", _) => return Err(wrong("opaque", "true or false")),
            ("mirror", Scalar::Bool(is_mirror)) => self.is_mirror = is_mirror,
            ("mirror", _) => return Err(wrong("mirror", "true or false")),
            ("left_group", value) => self.left = Some(group("left_group", value)?),
            ("right_group", value) => self.right = Some(group("right_group", value)?),
            ("name", value) => self.name = name_of(value),
            ("id", value) => self.id = name_of(value),
            ("object", value) => self.is_box = value == Scalar::Text("box"),
            _ => {}
        }
        Ok(())
    }
}

fn is_transparent(value: Scalar<'_>) -> Result<bool, Malformed> {
    match value {
        Scalar::Text("transparent") => Ok(true),
        Scalar::Text("opaque") => Ok(false),
        _ => Err(wrong("sight", "\"opaque\" or \"transparent\"")),
    }
}

fn group(property: &str, value: Scalar<'_>) -> Result<u32, Malformed> {
    let Scalar::Integer(group) = value else { return Err(wrong(property, "a whole number from 0")) };
    let fits = u32::try_from(group).ok().filter(|&g| g < MAX_GROUPS);
    fits.ok_or_else(|| malformed!("property \"{property}\": group {group} is not below {MAX_GROUPS}"))
}

pub(super) fn wrong(property: &str, expected: &str) -> Malformed {
    malformed!("property \"{property}\" is not {expected}")
}

pub(super) const NO_PROPERTIES: &str = "\"properties\" is not an object";

/// The value of a member `properties`, which may be `null`.
pub(super) struct OfFeature<'r>(pub(super) &'r mut Context);

impl<'de> Shape<'de> for OfFeature<'_> {
    type Value = Properties;

    fn scalar<E: Error>(self, value: Scalar<'_>) -> Result<Properties, E> {
        if value == Scalar::Null { Ok(Properties::default()) } else { Err(self.0.fail(NO_PROPERTIES)) }
    }

    fn object<A: MapAccess<'de>>(self, mut map: A) -> Result<Properties, A::Error> {
        let mut properties = Properties::default();
        while let Some(key) = map.next_key::<String>()? {
            let taken = map.next_value_seed(Seed(Any(|value: Scalar<'_>| properties.take(&key, value))))?;
            taken.map_err(|what| self.0.fail(what))?;
        }
        Ok(properties)
    }
}
