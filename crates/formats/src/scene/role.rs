//! Roles of objects: in the extras of a node, a mesh or a material, and by how a name ends; and whether a document is
//! simplified. Extras may contain anything.

use super::{MIRROR_SUFFIX, Simplified};
use serde::de::{DeserializeSeed, Deserializer, IgnoredAny, MapAccess, SeqAccess, Visitor};
use std::fmt;

/// What an object is for, as extras say it: `{"sightlines": {"role": "see-through"}}`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Role {
    /// Hides what is behind it, whatever its material says.
    Occluder,
    /// Is seen, and hides nothing.
    SeeThrough,
    /// Is seen, and hides nothing, because it is small.
    Detail,
    /// Is seen, and hides nothing, because it opens.
    Door,
    /// Shows where an opening is; is not seen, and hides nothing.
    Portal,
    /// Shows where a viewer can be; is not seen, and hides nothing.
    ViewVolume,
    /// Is not seen, and hides nothing.
    Ignore,
    /// Reflects. What it hides is left to its material.
    Mirror,
}

impl Role {
    /// All roles.
    pub const ALL: [Self; 8] = [
        Self::Occluder,
        Self::SeeThrough,
        Self::Detail,
        Self::Door,
        Self::Portal,
        Self::ViewVolume,
        Self::Ignore,
        Self::Mirror,
    ];

    /// As extras have it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Occluder => "occluder",
            Self::SeeThrough => "see-through",
            Self::Detail => "detail",
            Self::Door => "door",
            Self::Portal => "portal",
            Self::ViewVolume => "view-volume",
            Self::Ignore => "ignore",
            Self::Mirror => "mirror",
        }
    }

    /// Whether such an object is drawn at all.
    pub const fn is_drawn(self) -> bool {
        !matches!(self, Self::Portal | Self::ViewVolume | Self::Ignore)
    }
}

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

/// How a name ends that says what an object is for, as importers of Godot read it: what they do not draw, and what they
/// make a body that moves, hides nothing.
///
/// # Source
/// Godot documentation, "Node type customization using name suffixes". Chosen here: a hint counts after `-`, `_` or `$`, in
/// any case, before numbers that a program added (`Wall-colonly.001`), so that what one version of the importer leaves
/// out hides nothing; `occ` and `occonly`, by which an object hides more, only after `-` and as they are written.
const HINTS: [&str; 7] = ["colonly", "convcolonly", "noimp", "navmesh", "rigid", "vehicle", "wheel"];

/// Those of the hints that make a body that moves.
const BODIES: [&str; 3] = ["rigid", "vehicle", "wheel"];

/// Hints that something hides.
const OCCLUDERS: [&str; 2] = ["-occ", "-occonly"];

/// The role that a name states by how it ends, and the ending.
pub(super) fn role_of_name(name: &str) -> Option<(Role, &'static str)> {
    if name.ends_with(MIRROR_SUFFIX) {
        return Some((Role::Mirror, MIRROR_SUFFIX));
    }
    let name = without_number(name);
    if let Some(ending) = OCCLUDERS.into_iter().find(|ending| name.ends_with(ending)) {
        return Some((Role::Occluder, ending));
    }
    HINTS.into_iter().find(|hint| has_hint(name, hint)).map(|hint| (Role::SeeThrough, hint))
}

/// The hint in the name of a node that physics move it.
pub(super) fn body_of_name(name: &str) -> Option<&'static str> {
    BODIES.into_iter().find(|hint| has_hint(without_number(name), hint))
}

/// Whether the name of a material says that it lets light through: `-alpha`, as importers of Godot read it.
pub(super) fn is_alpha_by_name(name: &str) -> bool {
    has_hint(without_number(name), "alpha")
}

/// A name without the number that programs add to copies.
fn without_number(name: &str) -> &str {
    name.trim_end_matches(|c: char| c.is_ascii_digit() || c.is_ascii_whitespace() || c == '.' || c == '_')
}

/// Whether a name ends in a hint after `-` or `_`, or has it anywhere after `$`.
fn has_hint(name: &str, hint: &str) -> bool {
    let name = name.to_ascii_lowercase();
    let before = name.strip_suffix(hint).unwrap_or_default();
    before.ends_with(['-', '_']) || name.split('$').skip(1).any(|part| part.starts_with(hint))
}

/// What extras of a node state.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Stated {
    pub(super) role: StatedRole,
    /// Whether the node, and all below it, moves, and may be anywhere.
    pub(super) moves: bool,
}

/// Where the role of a node stands.
const ROLE: [&str; 2] = ["sightlines", "role"];
/// What stands beside it if the node moves.
const MOVES: &str = "moves";

/// Where a document states whether it may hide what its original did not hide.
const OCCLUDER: [&str; 3] = ["sightlines", "simplified", "occluder"];

/// The role that extras state. Extras of any other form are ignored.
pub(super) fn said<'de, D: Deserializer<'de>>(deserializer: D) -> Result<StatedRole, D::Error> {
    stated(deserializer).map(|stated| stated.role)
}

/// The role that extras state, and whether they state that the node moves.
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
    let occluder = matches!(found, Found { n_keys: 3, leaf: Leaf::True, .. });
    Ok((found.n_keys >= 2).then_some(Simplified { occluder }))
}

/// The value at the end of a path, and how many keys of the path exist.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Found {
    n_keys: usize,
    leaf: Leaf,
    /// Whether [`MOVES`] is true beside the last key.
    moves: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Leaf {
    Role(Role),
    True,
    /// A text that is no role.
    Text,
    Other,
}

/// A value, with the keys that lead from there to what is sought.
struct Path(&'static [&'static str]);

impl Path {
    fn found(leaf: Leaf) -> Found {
        Found { n_keys: 0, leaf, moves: false }
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
                    found = Found { n_keys: inner.n_keys + 1, leaf: inner.leaf, moves: found.moves | inner.moves };
                }
                Some((_, [])) if key == MOVES => found.moves |= map.next_value_seed(Path(&[]))?.leaf == Leaf::True,
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
        said(&mut serde_json::Deserializer::from_str(text)).unwrap() == StatedRole::Role(Role::Mirror)
    }

    #[test]
    fn roles_are_read_as_they_are_named() {
        for role in Role::ALL {
            let text = format!(r#"{{"sightlines": {{"role": "{}"}}}}"#, role.name());
            assert_eq!(said(&mut serde_json::Deserializer::from_str(&text)).unwrap(), StatedRole::Role(role));
        }
        let unknown = r#"{"sightlines": {"role": "seethrough"}}"#;
        assert_eq!(said(&mut serde_json::Deserializer::from_str(unknown)).unwrap(), StatedRole::Unknown);
        let other = r#"{"sightlines": {"role": 3}}"#;
        assert_eq!(said(&mut serde_json::Deserializer::from_str(other)).unwrap(), StatedRole::Nothing);
    }

    #[test]
    fn what_moves_is_stated_beside_its_role() {
        let read = |text: &str| stated(&mut serde_json::Deserializer::from_str(text)).unwrap();
        let door = StatedRole::Role(Role::Door);
        for text in
            [r#"{"sightlines": {"role": "door", "moves": true}}"#, r#"{"sightlines": {"moves": true, "role": "door"}}"#]
        {
            assert_eq!(read(text), Stated { role: door, moves: true });
        }
        assert!(read(r#"{"sightlines": {"moves": true}}"#).moves);
        for text in
            [r#"{"moves": true}"#, r#"{"sightlines": {"moves": 1}}"#, r#"{"sightlines": {"x": {"moves": true}}}"#]
        {
            assert!(!read(text).moves, "{text}");
        }
    }

    #[test]
    fn names_say_what_importers_make_of_them() {
        let role = |name: &str| role_of_name(name).map(|found| found.0);
        for name in ["Wall-colonly", "wall-CONVCOLONLY.001", "a_noimp", "x$navmesh y", "Car-vehicle", "car-wheel2"] {
            assert_eq!(role(name), Some(Role::SeeThrough), "{name}");
        }
        assert_eq!((role("House-occ"), role("House-occonly.002")), (Some(Role::Occluder), Some(Role::Occluder)));
        assert_eq!(role("hall-mirror"), Some(Role::Mirror));
        for name in ["wheel", "Wall-col", "Wall-convcol", "house_occ", "House-OCC", "colonly-wall", "rigidity", ""] {
            assert_eq!(role(name), None, "{name}");
        }
        assert!(
            is_alpha_by_name("Leaves-alpha") && is_alpha_by_name("leaves_Alpha.003") && !is_alpha_by_name("alphabet")
        );
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
