//! An entry of the registry.

use super::members::{has_member, is_object};
use super::{Input, Source};
use crate::dxf::is_dxf;
use crate::error::ReadErrorKind;
use std::path::Path;

/// A format of files.
#[derive(Debug)]
pub struct Format {
    /// Its name for programs, unique.
    pub name: &'static str,
    /// What people call it: `GLB` and `glTF`.
    pub titles: &'static [&'static str],
    /// What a file of it is, for people, with an article.
    pub noun: &'static str,
    /// How names of such files end: lower case, without the dot.
    pub extensions: &'static [&'static str],
    /// How it is recognised by its content.
    pub sign: Sign,
    /// What it holds.
    pub kind: InputKind,
    /// Reads all of it.
    pub(super) read: fn(&Source<'_>) -> Result<Input, ReadErrorKind>,
}

/// What a file holds, before it is read; the variants are those of [`Input`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum InputKind {
    /// A scene in the plane.
    Plan,
    /// The maps of a Doom game.
    Wad,
    /// A scene in space.
    Scene,
    /// The portals of a Quake map.
    Prt,
    /// A map of Quake or Quake II.
    Bsp,
    /// A visibility table.
    Table,
    /// A packed table.
    Packed,
    /// Proofs of a table.
    Proofs,
    /// Boxes where viewers can be.
    ViewCells,
    /// Simplified variants of a scene.
    Levels,
}

/// How a format is recognised by the content of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Sign {
    /// By its first bytes, which are one of these.
    Magic(&'static [&'static [u8]]),
    /// By its first bytes, which are these; as JSON text only by its name.
    MagicOrNamedJson(&'static [u8]),
    /// JSON that has this member, and no member `type`.
    JsonMember(&'static str),
    /// All other JSON.
    Json,
    /// By its first groups, which open a section; or as binary DXF, which is recognised to be refused.
    Dxf,
    /// Not at all: only the name decides.
    Name,
}

impl Sign {
    pub(super) fn is_in(self, head: &[u8]) -> bool {
        match self {
            Self::Magic(all) => all.iter().any(|magic| head.starts_with(magic)),
            Self::MagicOrNamedJson(magic) => head.starts_with(magic),
            Self::JsonMember(member) => has_member(head, member) && !has_member(head, "type"),
            Self::Json => is_object(head),
            Self::Dxf => is_dxf(head),
            Self::Name => false,
        }
    }

    /// Whether the name of a file decides that it is of the format, though its content is JSON that another one recognises.
    pub(super) const fn is_named_before_json(self) -> bool {
        matches!(self, Self::MagicOrNamedJson(_) | Self::Name)
    }

    /// Whether the content of such a file is JSON wherever it is recognised.
    pub(super) const fn is_json(self) -> bool {
        matches!(self, Self::JsonMember(_) | Self::Json)
    }
}

impl Format {
    /// Whether the name of a file is one of this format.
    pub fn is_name(&self, path: &Path) -> bool {
        path.extension().is_some_and(|e| self.extensions.iter().any(|known| e.eq_ignore_ascii_case(known)))
    }
}
