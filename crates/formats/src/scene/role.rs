//! Roles of objects, and which of them a name states by how it begins or ends.

use super::MIRROR_SUFFIX;
use std::collections::BTreeSet;

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
    /// Hides nothing, because it opens, and is seen wherever it may open to: if nothing in the file moves it, in the box around it, wider by
    /// its diagonal on all sides.
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
        NAMES[self as usize]
    }

    /// Whether such an object is drawn at all.
    pub const fn is_drawn(self) -> bool {
        !matches!(self, Self::Portal | Self::ViewVolume | Self::Ignore)
    }
}

/// Of the roles, in their order.
const NAMES: [&str; Role::ALL.len()] =
    ["occluder", "see-through", "detail", "door", "portal", "view-volume", "ignore", "mirror"];

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

/// How a name begins of a hull for collisions, as importers of Unreal read it: a box, a capsule, a sphere, a convex body.
///
/// # Source
/// Unreal Engine documentation, "FBX Static Mesh Pipeline". Chosen here: such a hull belongs to the mesh with the name behind the prefix,
/// to which `_` or `.` and more may be added; what is called so without belonging to a mesh is seen, and hides nothing.
const HULLS: [&str; 4] = ["UBX_", "UCP_", "USP_", "UCX_"];

/// The names of all meshes of a file that are no hulls.
#[derive(Debug, Default)]
pub(super) struct MeshNames<'a>(BTreeSet<&'a str>);

impl<'a> FromIterator<&'a str> for MeshNames<'a> {
    fn from_iter<T: IntoIterator<Item = &'a str>>(names: T) -> Self {
        Self(names.into_iter().filter(|name| hull_of(name).is_none()).collect())
    }
}

impl MeshNames<'_> {
    /// The role that a name states by how it begins or ends, and the beginning or ending.
    pub(super) fn role_of(&self, name: &str) -> Option<(Role, &'static str)> {
        self.hull(name).or_else(|| role_of_name(name))
    }

    /// The role of a hull for collisions, and how its name begins; `None` for what is none.
    pub(super) fn hull(&self, name: &str) -> Option<(Role, &'static str)> {
        let (prefix, of) = hull_of(name)?;
        let ends = of.match_indices(['_', '.']).map(|(end, _)| end).chain([of.len()]);
        let is_of_mesh = ends.into_iter().any(|end| self.0.contains(&of[..end]));
        Some((if is_of_mesh { Role::Ignore } else { Role::SeeThrough }, prefix))
    }
}

/// The prefix of a hull, and the name behind it.
pub(super) fn hull_of(name: &str) -> Option<(&'static str, &str)> {
    HULLS.into_iter().find_map(|prefix| Some((prefix, name.strip_prefix(prefix)?)))
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
