//! What was looked at, and what was found.

use crate::counts::{Confirmed, Remarks, Sampled};
use crate::options::VerifyOptions;
use sightlines_geometry::Point3;
use sightlines_pvs::{CellId, DoorId, PortalId};
use std::collections::BTreeMap;
use std::fmt;

/// Something that is not as the table says.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Violation {
    /// Two cells that see each other, hidden from each other in the table: the segment is free, and goes from inside of the first to inside of the second. In the table
    /// of a portal file, which has no places, it is part of a line that passes portals from the one to the other.
    HiddenCell {
        /// The two cells.
        cells: [CellId; 2],
        /// From the first to the second, in scene units; z is 0 in a plane.
        segment: [Point3; 2],
    },
    /// An object that a cell sees, hidden from it in the table: the segment goes from inside of the cell to the object, and nothing is before it.
    HiddenObject {
        /// The cell.
        cell: CellId,
        /// The object.
        object: u32,
        /// From the cell to the object, in space to just behind it.
        segment: [Point3; 2],
    },
    /// A part of an object that a cell sees, hidden from it in the table: as for an object.
    HiddenPart {
        /// The cell.
        cell: CellId,
        /// The part, by its place among [`Table::object_parts`](sightlines_pvs::Table::object_parts).
        part: u32,
        /// From the cell to the part, to just behind it.
        segment: [Point3; 2],
    },
    /// Two neighbours, joined by a portal, that are hidden from each other.
    HiddenNeighbour {
        /// The two cells.
        cells: [CellId; 2],
        /// The portal.
        portal: usize,
    },
    /// Two cells whose insides overlap.
    Overlap {
        /// The two cells.
        cells: [CellId; 2],
    },
    /// A cell that is not convex, or has no inside.
    NotConvex {
        /// The cell.
        cell: CellId,
    },
    /// A cell of a plan that reaches out of the box around the scene.
    OutOfScene {
        /// The cell.
        cell: CellId,
    },
    /// A point inside of a cell that the table does not find in it.
    NotFound {
        /// The cell.
        cell: CellId,
        /// The point.
        point: Point3,
    },
    /// A portal that is not on the borders of both of its cells, or whose corners do not go round as seen from the first; in space also one that is no
    /// rectangle.
    OffBorder {
        /// The portal.
        portal: usize,
        /// The cell.
        cell: CellId,
    },
    /// A cell that free lines leave where it has no portal: the segment is free, and passes the cell. Methods that follow portals would hide what is
    /// behind.
    MissingPortal {
        /// The cell.
        cell: CellId,
        /// From inside of this or another cell to inside of one behind it, in scene units; z is 0 in a plane.
        segment: [Point3; 2],
    },
    /// A mirror on the border of a cell or in it, where the table has no part of one that looks into the cell.
    MissingMirror {
        /// The cell.
        cell: CellId,
        /// On the mirror, in scene units; z is 0 in a plane.
        point: Point3,
    },
    /// A sequence of portals that a free line passes, and that the stab tree of a cell does not have: the segment is free.
    MissingSequence {
        /// The cell that the segment begins in.
        cell: CellId,
        /// The first portals that the segment passes, up to the first that is missing.
        portals: Vec<PortalId>,
        /// From inside of the cell, in scene units; z is 0 in a plane.
        segment: [Point3; 2],
    },
    /// A portal that is not one of the file that the table was made from.
    UnlikePortal {
        /// The portal.
        portal: usize,
    },
    /// Geometry that is not what the table was made of, by its [digest](sightlines_pvs::GeometryDigest): the scene was changed since, however little, or other options make
    /// other things see-through. The other checks tell whether it matters, as far as they go.
    ChangedGeometry {
        /// What was changed.
        what: Geometry,
    },
    /// Numbers of cells, portals or objects that are not those of the scene.
    Count {
        /// Of what.
        what: &'static str,
        /// In the table.
        table: usize,
        /// In the scene.
        scene: usize,
    },
    /// An object with another name than in the scene.
    ObjectName {
        /// The object.
        object: u32,
    },
    /// An object with another box, or another number of polygons, than in the scene.
    ObjectBox {
        /// The object.
        object: u32,
    },
    /// An object that is another node or primitive of the file than the table says.
    ObjectSource {
        /// The object.
        object: u32,
    },
    /// An object with another number of triangles than its parts have together.
    ObjectParts {
        /// The object.
        object: u32,
    },
    /// A door that is an object which is no door in the scene.
    NoDoor {
        /// The door.
        door: DoorId,
    },
    /// A door with another name than the object that it is.
    DoorName {
        /// The door.
        door: DoorId,
    },
    /// A portal that a door closes, and that its leaf does not cover: what is seen past the leaf would be hidden when the door is shut.
    OpenDoor {
        /// The door.
        door: DoorId,
        /// The portal.
        portal: PortalId,
    },
    /// An object that touches a cell, and is not listed there.
    UnlistedObject {
        /// The cell.
        cell: CellId,
        /// The object.
        object: u32,
    },
}

/// A part of what is in a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Geometry {
    /// What hides other things.
    Hiding,
    /// What can be seen.
    Seen,
}

impl Violation {
    /// The kind of [`Violation::ChangedGeometry`].
    pub const CHANGED: &'static str = "changed-geometry";

    /// The kind, as one word with dashes.
    pub const fn kind(&self) -> &'static str {
        match self {
            Self::HiddenCell { .. } => "hidden-cell",
            Self::HiddenObject { .. } => "hidden-object",
            Self::HiddenPart { .. } => "hidden-part",
            Self::HiddenNeighbour { .. } => "hidden-neighbour",
            Self::Overlap { .. } => "overlap",
            Self::NotConvex { .. } => "not-convex",
            Self::OutOfScene { .. } => "out-of-scene",
            Self::NotFound { .. } => "not-found",
            Self::OffBorder { .. } => "off-border",
            Self::MissingPortal { .. } => "missing-portal",
            Self::MissingMirror { .. } => "missing-mirror",
            Self::MissingSequence { .. } => "missing-sequence",
            Self::UnlikePortal { .. } => "unlike-portal",
            Self::ChangedGeometry { .. } => Self::CHANGED,
            Self::Count { .. } => "count",
            Self::ObjectName { .. } => "object-name",
            Self::ObjectBox { .. } => "object-box",
            Self::ObjectSource { .. } => "object-source",
            Self::ObjectParts { .. } => "object-parts",
            Self::NoDoor { .. } => "no-door",
            Self::DoorName { .. } => "door-name",
            Self::OpenDoor { .. } => "open-door",
            Self::UnlistedObject { .. } => "unlisted-object",
        }
    }

    /// The cells concerned.
    pub fn cells(&self) -> Vec<CellId> {
        match *self {
            Self::HiddenCell { cells, .. } | Self::HiddenNeighbour { cells, .. } | Self::Overlap { cells } => {
                cells.to_vec()
            }
            Self::HiddenObject { cell, .. }
            | Self::HiddenPart { cell, .. }
            | Self::NotConvex { cell }
            | Self::OutOfScene { cell }
            | Self::NotFound { cell, .. }
            | Self::OffBorder { cell, .. }
            | Self::MissingPortal { cell, .. }
            | Self::MissingMirror { cell, .. }
            | Self::MissingSequence { cell, .. }
            | Self::UnlistedObject { cell, .. } => vec![cell],
            _ => Vec::new(),
        }
    }

    /// The object concerned.
    pub const fn object(&self) -> Option<u32> {
        match *self {
            Self::HiddenObject { object, .. }
            | Self::ObjectName { object }
            | Self::ObjectBox { object }
            | Self::ObjectSource { object }
            | Self::ObjectParts { object }
            | Self::UnlistedObject { object, .. } => Some(object),
            _ => None,
        }
    }

    /// The segment that shows it.
    pub const fn segment(&self) -> Option<[Point3; 2]> {
        match *self {
            Self::HiddenCell { segment, .. }
            | Self::HiddenObject { segment, .. }
            | Self::HiddenPart { segment, .. }
            | Self::MissingPortal { segment, .. }
            | Self::MissingSequence { segment, .. } => Some(segment),
            _ => None,
        }
    }
}

/// Coordinates in full: read again, they are the same numbers.
struct Full<'a>(&'a Point3);

impl fmt::Display for Full<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "({}, {}, {})", self.0[0], self.0[1], self.0[2])
    }
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::HiddenCell { cells: [a, b], segment: [p, q] } => {
                write!(
                    f,
                    "cells {a} and {b} are hidden from each other, but nothing is between {} and {}",
                    Full(p),
                    Full(q)
                )
            }
            Self::HiddenObject { cell, object, segment: [p, q] } => {
                write!(
                    f,
                    "object {object} is hidden from cell {cell}, but is seen from {} towards {}",
                    Full(p),
                    Full(q)
                )
            }
            Self::HiddenPart { cell, part, segment: [p, q] } => {
                write!(f, "part {part} is hidden from cell {cell}, but is seen from {} towards {}", Full(p), Full(q))
            }
            Self::HiddenNeighbour { cells: [a, b], portal } => {
                write!(f, "cells {a} and {b} are hidden from each other, but joined by portal {portal}")
            }
            Self::Overlap { cells: [a, b] } => write!(f, "cells {a} and {b} overlap"),
            Self::NotConvex { cell } => write!(f, "cell {cell} is not convex, or has no inside"),
            Self::OutOfScene { cell } => write!(f, "cell {cell} reaches out of the box around the scene"),
            Self::NotFound { cell, point } => write!(f, "cell {cell} is not found at {}, which is inside", Full(point)),
            Self::OffBorder { portal, cell } => {
                write!(f, "portal {portal} is not on the border of cell {cell}, or faces the wrong way")
            }
            Self::MissingPortal { cell, segment: [p, q] } => {
                write!(f, "cell {cell} has no portal where the free line from {} to {} leaves it", Full(p), Full(q))
            }
            Self::MissingMirror { cell, point } => {
                write!(f, "cell {cell} has no part of the mirror that is at {}", Full(point))
            }
            Self::MissingSequence { cell, portals, segment: [p, q] } => {
                let portals: Vec<String> = portals.iter().map(ToString::to_string).collect();
                let portals = portals.join(", ");
                let [p, q] = [Full(p), Full(q)];
                write!(
                    f,
                    "the stab tree of cell {cell} lacks the portals {portals}, which the free line from {p} to {q} passes"
                )
            }
            Self::UnlikePortal { portal } => write!(f, "portal {portal} is none of the scene"),
            Self::ChangedGeometry { what } => {
                let what = match what {
                    Geometry::Hiding => "what hides",
                    Geometry::Seen => "what can be seen",
                };
                write!(
                    f,
                    "{what} is not as when the table was made: the scene has changed, or is read with other options"
                )
            }
            Self::Count { what, table, scene } => write!(f, "the table has {table} {what}, the scene {scene}"),
            Self::ObjectName { object } => write!(f, "object {object} has another name in the scene"),
            Self::ObjectBox { object } => write!(f, "object {object} has another extent in the scene"),
            Self::ObjectSource { object } => {
                write!(f, "object {object} is another node or primitive in the scene")
            }
            Self::ObjectParts { object } => {
                write!(f, "object {object} has another number of triangles in the scene than its parts")
            }
            Self::NoDoor { door } => write!(f, "door {door} is an object that is no door in the scene"),
            Self::DoorName { door } => write!(f, "door {door} has another name than its object in the scene"),
            Self::OpenDoor { door, portal } => {
                write!(f, "door {door} closes portal {portal}, which its leaf or box does not cover")
            }
            Self::UnlistedObject { cell, object } => {
                write!(f, "object {object} touches cell {cell}, which does not list it")
            }
        }
    }
}

/// What was looked at, and what was found.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Findings {
    /// Cells, portals and objects whose structure was looked at.
    pub n_cells: usize,
    /// Portals.
    pub n_portals: usize,
    /// Objects.
    pub n_objects: usize,
    /// Doors.
    pub n_doors: usize,
    /// Random rays.
    pub n_rays: u64,
    /// Segments, free as far as doubles tell, that were followed through the portals of the table, and its stab trees if it has any.
    pub n_followed: u64,
    /// Sequences of portals that stab trees do not have, and that segments were aimed along.
    pub n_sequences: u64,
    /// Unordered pairs of different cells.
    pub cells: Confirmed,
    /// Pairs of a cell and an object.
    pub objects: Confirmed,
    /// Random segments at hidden pairs.
    pub sampled: Sampled,
    /// What is no violation.
    pub remarks: Remarks,
    /// Why no rays were shot, if none were.
    pub no_rays: Option<&'static str>,
    /// All violations, those of one kind after the other, the first [`VerifyOptions::MOST_VIOLATIONS`] of each.
    pub violations: Vec<Violation>,
    /// Number of violations that were found, including those that are not listed.
    pub n_violations: usize,
    /// The same for each kind ([`Violation::kind`]).
    pub by_kind: BTreeMap<&'static str, usize>,
}

impl Findings {
    /// Whether nothing was found that a true table must not have.
    pub const fn is_true(&self) -> bool {
        self.n_violations == 0
    }

    /// Adds violations before all others.
    pub(crate) fn add_first(&mut self, violations: impl IntoIterator<Item = Violation>) {
        let n = self.violations.len();
        violations.into_iter().for_each(|violation| self.add(violation));
        self.violations.rotate_left(n);
    }

    /// Adds a violation, unless there are enough of its kind.
    pub(crate) fn add(&mut self, violation: Violation) {
        self.n_violations += 1;
        let of_kind = self.by_kind.entry(violation.kind()).or_default();
        *of_kind += 1;
        if *of_kind <= VerifyOptions::MOST_VIOLATIONS {
            self.violations.push(violation);
        }
    }
}
