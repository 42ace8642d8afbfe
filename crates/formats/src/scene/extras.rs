//! Extras of a document: roles, what moves, and whether the whole is simplified. They may contain anything.

use super::Simplification;
use super::role::Role;
use crate::json::{Scalar, Seed, Shape};
use serde::de::{DeserializeSeed, Deserializer, Error, IgnoredAny, MapAccess, SeqAccess};

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

const ROLE: [&str; 2] = ["sightlines", "role"];
/// What stands beside it of what moves.
const MOVES: &str = "moves";

/// Where a document states whether it may hide what its original did not hide.
const OCCLUDER: [&str; 3] = ["sightlines", "simplified", "occluder"];

/// The role that extras state, and whether they state motion. Extras of any other form are ignored.
pub(super) fn stated<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Stated, D::Error> {
    let found = Seed(Path(&ROLE)).deserialize(deserializer)?;
    let role = match found {
        Found { n_keys: 2, leaf: Leaf::Role(role), .. } => StatedRole::Role(role),
        Found { n_keys: 2, leaf: Leaf::Text, .. } => StatedRole::Unknown,
        _ => StatedRole::Nothing,
    };
    Ok(Stated { role, moves: found.moves })
}

/// Whether extras state that a scene was simplified; if they do not state how, the worst is assumed.
pub(super) fn simplified<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Simplification>, D::Error> {
    let found = Seed(Path(&OCCLUDER)).deserialize(deserializer)?;
    let occluder = matches!(found, Found { n_keys: 3, leaf: Leaf::Truth(true), .. });
    Ok((found.n_keys >= 2).then_some(Simplification { occluder }))
}

/// The value at the end of a path, and how many keys of the path exist.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Found {
    n_keys: usize,
    leaf: Leaf,
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

struct Path(&'static [&'static str]);

impl Path {
    fn found(leaf: Leaf) -> Found {
        Found { n_keys: 0, leaf, moves: StatedMoves::No }
    }
}

impl<'de> Shape<'de> for Path {
    type Value = Found;

    fn scalar<E: Error>(self, value: Scalar<'_>) -> Result<Found, E> {
        Ok(Self::found(match value {
            Scalar::Null => Leaf::Null,
            Scalar::Bool(value) => Leaf::Truth(value),
            Scalar::Integer(value) => Leaf::Number(value != 0),
            Scalar::Number(value) => Leaf::Number(value != 0.0),
            Scalar::Text(text) => Role::ALL.into_iter().find(|role| role.name() == text).map_or(Leaf::Text, Leaf::Role),
            Scalar::Other => Leaf::Other,
        }))
    }

    fn list<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Found, A::Error> {
        while seq.next_element::<IgnoredAny>()?.is_some() {}
        Ok(Self::found(Leaf::Other))
    }

    fn object<A: MapAccess<'de>>(self, mut map: A) -> Result<Found, A::Error> {
        let mut found = Self::found(Leaf::Other);
        while let Some(key) = map.next_key::<String>()? {
            match self.0.split_first() {
                Some((first, rest)) if *first == key => {
                    let inner = map.next_value_seed(Seed(Path(rest)))?;
                    found = Found { n_keys: inner.n_keys + 1, leaf: inner.leaf, moves: found.moves.max(inner.moves) };
                }
                Some((_, [])) if key == MOVES => {
                    found.moves = found.moves.max(map.next_value_seed(Seed(Path(&[])))?.leaf.moves());
                }
                _ => _ = map.next_value::<IgnoredAny>()?,
            }
        }
        Ok(found)
    }
}
