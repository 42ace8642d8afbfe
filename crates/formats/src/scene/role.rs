//! What the extras of a node say that it is. Extras are whatever a program likes to put there.

use serde::de::{DeserializeSeed, Deserializer, IgnoredAny, MapAccess, SeqAccess, Visitor};
use std::fmt;

/// Where the role stands, and which one is known.
const PATH: [&str; 2] = ["sightlines", "role"];
const MIRROR: &str = "mirror";

/// Whether extras have the role of a mirror. Extras of any other form say nothing, and none of them is an error.
pub(super) fn is_mirror<'de, D: Deserializer<'de>>(deserializer: D) -> Result<bool, D::Error> {
    Role(&PATH).deserialize(deserializer)
}

/// A value in which the role is to be found, with the keys that lead there.
struct Role(&'static [&'static str]);

impl<'de> DeserializeSeed<'de> for Role {
    type Value = bool;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<bool, D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Role {
    type Value = bool;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a JSON value")
    }

    fn visit_unit<E>(self) -> Result<bool, E> {
        Ok(false)
    }

    fn visit_bool<E>(self, _: bool) -> Result<bool, E> {
        Ok(false)
    }

    fn visit_u64<E>(self, _: u64) -> Result<bool, E> {
        Ok(false)
    }

    fn visit_i64<E>(self, _: i64) -> Result<bool, E> {
        Ok(false)
    }

    fn visit_f64<E>(self, _: f64) -> Result<bool, E> {
        Ok(false)
    }

    fn visit_str<E>(self, value: &str) -> Result<bool, E> {
        Ok(self.0.is_empty() && value == MIRROR)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<bool, A::Error> {
        while seq.next_element::<IgnoredAny>()?.is_some() {}
        Ok(false)
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<bool, A::Error> {
        let mut found = false;
        while let Some(key) = map.next_key::<String>()? {
            match self.0.split_first() {
                Some((first, rest)) if *first == key => found = map.next_value_seed(Role(rest))?,
                _ => _ = map.next_value::<IgnoredAny>()?,
            }
        }
        Ok(found)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> bool {
        is_mirror(&mut serde_json::Deserializer::from_str(text)).unwrap()
    }

    #[test]
    fn extras_of_any_form_are_read() {
        assert!(read(r#"{"a": [1], "sightlines": {"x": null, "role": "mirror"}, "b": {"sightlines": 3}}"#));
        for other in [
            "null",
            "true",
            "-1",
            "1.5",
            "7",
            "\"mirror\"",
            "[\"mirror\", {}]",
            "{}",
            r#"{"role": "mirror"}"#,
            r#"{"sightlines": "mirror"}"#,
            r#"{"sightlines": {"role": "Mirror"}}"#,
            r#"{"sightlines": {"role": ["mirror"]}}"#,
            r#"{"sightlines": {"role": {"mirror": "mirror"}}}"#,
            r#"{"x": {"sightlines": {"role": "mirror"}}}"#,
        ] {
            assert!(!read(other), "{other}");
        }
        // As deep as nobody reads it.
        let deep = format!("{{\"x\": {}{}}}", "[".repeat(5000), "]".repeat(5000));
        assert!(!read(&deep));
    }
}
