//! Extras of a document: roles, what moves, and whether the whole is simplified. They may contain anything.

use super::Simplified;
use super::role::Role;
use serde::de::{DeserializeSeed, Deserializer, IgnoredAny, MapAccess, SeqAccess, Visitor};
use std::fmt;

/// What extras say of a role.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) enum StatedRole {
    #[default]
    Nothing,
    Role(Role),
    /// A text that is no role.
    Unknown,
}

impl StatedRole {
    pub(super) fn role(self) -> Option<Role> {
        if let Self::Role(role) = self { Some(role) } else { None }
    }
}

/// What extras of a node, a mesh or a material state.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Stated {
    pub(super) role: StatedRole,
    pub(super) moves: StatedMoves,
}

impl Stated {
    /// Whether the node and all below it, or all that has the mesh or the material, moves, and may be anywhere.
    pub(super) fn moves(self) -> bool {
        self.moves != StatedMoves::No
    }
}

/// What extras say of motion: true, false, or a number, as programs write it that have no truth values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub(super) enum StatedMoves {
    #[default]
    No,
    Yes,
    /// Something else, which counts as yes.
    Unclear,
}

/// Where a role stands.
const ROLE: [&str; 2] = ["sightlines", "role"];
/// What stands beside it of what moves.
const MOVES: &str = "moves";

/// Where a document states whether it may hide what its original did not hide.
const OCCLUDER: [&str; 3] = ["sightlines", "simplified", "occluder"];

/// The role that extras state, and whether they state motion. Extras of any other form are ignored.
pub(super) fn stated<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Stated, D::Error> {
    let found = Path(&ROLE).deserialize(deserializer)?;
    let role = match found {
        Found { n_keys: 2, leaf: Leaf::Role(role), .. } => StatedRole::Role(role),
        Found { n_keys: 2, leaf: Leaf::Text, .. } => StatedRole::Unknown,
        _ => StatedRole::Nothing,
    };
    Ok(Stated { role, moves: found.moves })
}

/// Whether extras state that a scene was simplified; if they do not state how, the worst is assumed.
pub(super) fn simplified<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Simplified>, D::Error> {
    let found = Path(&OCCLUDER).deserialize(deserializer)?;
    let occluder = matches!(found, Found { n_keys: 3, leaf: Leaf::Truth(true), .. });
    Ok((found.n_keys >= 2).then_some(Simplified { occluder }))
}

/// The value at the end of a path, and how many keys of the path exist.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Found {
    n_keys: usize,
    leaf: Leaf,
    /// What [`MOVES`] is beside the last key.
    moves: StatedMoves,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Leaf {
    Role(Role),
    Truth(bool),
    /// Whether it is another one than 0.
    Number(bool),
    /// A text that is no role.
    Text,
    Null,
    Other,
}

impl Leaf {
    fn moves(self) -> StatedMoves {
        match self {
            Self::Null | Self::Truth(false) | Self::Number(false) => StatedMoves::No,
            Self::Truth(true) | Self::Number(true) => StatedMoves::Yes,
            Self::Role(_) | Self::Text | Self::Other => StatedMoves::Unclear,
        }
    }
}

/// A value, with the keys that lead from there to what is sought.
struct Path(&'static [&'static str]);

impl Path {
    fn found(leaf: Leaf) -> Found {
        Found { n_keys: 0, leaf, moves: StatedMoves::No }
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
        Ok(Self::found(Leaf::Null))
    }

    fn visit_bool<E>(self, value: bool) -> Result<Found, E> {
        Ok(Self::found(Leaf::Truth(value)))
    }

    fn visit_u64<E>(self, value: u64) -> Result<Found, E> {
        Ok(Self::found(Leaf::Number(value != 0)))
    }

    fn visit_i64<E>(self, value: i64) -> Result<Found, E> {
        Ok(Self::found(Leaf::Number(value != 0)))
    }

    fn visit_f64<E>(self, value: f64) -> Result<Found, E> {
        Ok(Self::found(Leaf::Number(value != 0.0)))
    }

    fn visit_str<E>(self, value: &str) -> Result<Found, E> {
        let role = Role::ALL.into_iter().find(|role| role.name() == value);
        Ok(Self::found(role.map_or(Leaf::Text, Leaf::Role)))
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
                    let inner = map.next_value_seed(Path(rest))?;
                    found = Found { n_keys: inner.n_keys + 1, leaf: inner.leaf, moves: found.moves.max(inner.moves) };
                }
                Some((_, [])) if key == MOVES => {
                    found.moves = found.moves.max(map.next_value_seed(Path(&[]))?.leaf.moves());
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

    fn read_role(text: &str) -> StatedRole {
        stated(&mut serde_json::Deserializer::from_str(text)).unwrap().role
    }

    fn read(text: &str) -> bool {
        read_role(text) == StatedRole::Role(Role::Mirror)
    }

    #[test]
    fn roles_are_read_as_they_are_named() {
        for role in Role::ALL {
            let text = format!(r#"{{"sightlines": {{"role": "{}"}}}}"#, role.name());
            assert_eq!(read_role(&text), StatedRole::Role(role));
        }
        let unknown = r#"{"sightlines": {"role": "seethrough"}}"#;
        assert_eq!(read_role(unknown), StatedRole::Unknown);
        let other = r#"{"sightlines": {"role": 3}}"#;
        assert_eq!(read_role(other), StatedRole::Nothing);
    }

    #[test]
    fn what_moves_is_stated_beside_its_role() {
        let read = |text: &str| stated(&mut serde_json::Deserializer::from_str(text)).unwrap();
        let door = StatedRole::Role(Role::Door);
        for text in
            [r#"{"sightlines": {"role": "door", "moves": true}}"#, r#"{"sightlines": {"moves": true, "role": "door"}}"#]
        {
            assert_eq!(read(text), Stated { role: door, moves: StatedMoves::Yes });
        }
        let moves = |value: &str| read(&format!(r#"{{"sightlines": {{"moves": {value}}}}}"#)).moves;
        for value in ["true", "1", "-1", "0.5"] {
            assert_eq!(moves(value), StatedMoves::Yes, "{value}");
        }
        for value in ["false", "0", "0.0", "null"] {
            assert_eq!(moves(value), StatedMoves::No, "{value}");
        }
        for value in [r#""false""#, r#""door""#, "[]", "{}"] {
            assert_eq!(moves(value), StatedMoves::Unclear, "{value}");
        }
        for text in [r#"{"moves": true}"#, r#"{"sightlines": {"x": {"moves": true}}}"#] {
            assert!(!read(text).moves(), "{text}");
        }
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
