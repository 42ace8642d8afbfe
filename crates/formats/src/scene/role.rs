//! Roles in the extras of nodes and documents. Extras may contain anything.

use super::Simplified;
use serde::de::{DeserializeSeed, Deserializer, IgnoredAny, MapAccess, SeqAccess, Visitor};
use std::fmt;

/// Where the role of a node stands, and which one is known.
const ROLE: [&str; 2] = ["sightlines", "role"];
const MIRROR: &str = "mirror";

/// Where a document states whether it may hide what its original did not hide.
const OCCLUDER: [&str; 3] = ["sightlines", "simplified", "occluder"];

/// Whether extras have the role of a mirror. Extras of any other form are ignored.
pub(super) fn is_mirror<'de, D: Deserializer<'de>>(deserializer: D) -> Result<bool, D::Error> {
    Ok(Path(&ROLE).deserialize(deserializer)? == Found { n_keys: 2, leaf: Leaf::Mirror })
}

/// Whether extras state that a scene was simplified; if they do not state how, the worst is assumed.
pub(super) fn simplified<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Simplified>, D::Error> {
    let found = Path(&OCCLUDER).deserialize(deserializer)?;
    let occluder = found == Found { n_keys: 3, leaf: Leaf::True };
    Ok((found.n_keys >= 2).then_some(Simplified { occluder }))
}

/// The value at the end of a path, and how many keys of the path exist.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Found {
    n_keys: usize,
    leaf: Leaf,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Leaf {
    Mirror,
    True,
    Other,
}

/// A value, with the keys that lead from there to what is sought.
struct Path(&'static [&'static str]);

impl Path {
    fn found(leaf: Leaf) -> Found {
        Found { n_keys: 0, leaf }
    }
}

impl<'de> DeserializeSeed<'de> for Path {
    type Value = Found;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Found, D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Path {
    type Value = Found;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a JSON value")
    }

    fn visit_unit<E>(self) -> Result<Found, E> {
        Ok(Self::found(Leaf::Other))
    }

    fn visit_bool<E>(self, value: bool) -> Result<Found, E> {
        Ok(Self::found(if value { Leaf::True } else { Leaf::Other }))
    }

    fn visit_u64<E>(self, _: u64) -> Result<Found, E> {
        Ok(Self::found(Leaf::Other))
    }

    fn visit_i64<E>(self, _: i64) -> Result<Found, E> {
        Ok(Self::found(Leaf::Other))
    }

    fn visit_f64<E>(self, _: f64) -> Result<Found, E> {
        Ok(Self::found(Leaf::Other))
    }

    fn visit_str<E>(self, value: &str) -> Result<Found, E> {
        Ok(Self::found(if value == MIRROR { Leaf::Mirror } else { Leaf::Other }))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Found, A::Error> {
        while seq.next_element::<IgnoredAny>()?.is_some() {}
        Ok(Self::found(Leaf::Other))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Found, A::Error> {
        let mut found = Self::found(Leaf::Other);
        while let Some(key) = map.next_key::<String>()? {
            match self.0.split_first() {
                Some((first, rest)) if *first == key => {
                    let Found { n_keys, leaf } = map.next_value_seed(Path(rest))?;
                    found = Found { n_keys: n_keys + 1, leaf };
                }
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
    fn what_is_simplified_is_no_occluder_unless_it_says_so() {
        let read = |text: &str| {
            simplified(&mut serde_json::Deserializer::from_str(text)).unwrap().map(|simplified| simplified.occluder)
        };
        assert_eq!(read(r#"{"sightlines": {"simplified": {"occluder": true, "x": 1}}, "y": null}"#), Some(true));
        assert_eq!(read(r#"{"sightlines": {"simplified": {"occluder": false}}}"#), Some(false));
        for unclear in ["{}", "null", "true", "[]", r#"{"occluder": "true"}"#, r#"{"occluder": 1}"#, r#"{"x": true}"#] {
            let text = format!(r#"{{"sightlines": {{"simplified": {unclear}}}}}"#);
            assert_eq!(read(&text), Some(false), "{text}");
        }
        for other in ["null", "3", "[]", "{}", r#"{"sightlines": true}"#, r#"{"simplified": {"occluder": false}}"#] {
            assert_eq!(read(other), None, "{other}");
        }
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
        // Nested more deeply than is read.
        let deep = format!("{{\"x\": {}{}}}", "[".repeat(5000), "]".repeat(5000));
        assert!(!read(&deep));
    }
}
