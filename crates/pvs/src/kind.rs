//! What a table was made from, and how.

use std::fmt;

/// What kind of table it is: what its cells are, and by which methods pairs were found hidden.
///
/// Code that depends on how a table was made reads this, never the free text of [`crate::Table::info`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[non_exhaustive]
pub enum TableKind {
    /// Not stated: made by hand or by another program. Nothing may be concluded from it.
    #[default]
    Unspecified,
    /// A plan, cut along its axis-parallel walls by a k-d tree.
    PlanKdTree,
    /// A plan, cut by a constrained triangulation.
    PlanTriangulation,
    /// A scene in space, cut by a k-d tree. Cells are boxes; within the box around all of them, space that is in no cell is
    /// inside of something solid.
    SceneKdTree {
        /// The methods that found what is hidden.
        hidden_by: SceneMethods,
    },
    /// A scene in space seen from boxes that were given. Cells are boxes that may overlap and leave gaps.
    SceneGivenCells {
        /// The methods that found what is hidden.
        hidden_by: SceneMethods,
    },
    /// The portal file of a Quake map. Cells are its clusters; their boxes are only those around their portals, so points
    /// cannot be located.
    QuakePortalFile,
    /// A Quake map with its portal file. Cells are its clusters; points can be located if the table has planes.
    QuakeMap,
}

/// The methods that found which parts of a scene in space are hidden from which cells. What any of them hides is hidden.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct SceneMethods {
    /// Sight lines past opaque axis-parallel rectangles.
    pub sightlines: bool,
    /// A from-region method, such as the multifocal z-buffer.
    pub from_region: bool,
    /// Whether nothing is promised for eyes inside solid matter, because a from-region method used its inside as an occluder.
    pub only_in_air: bool,
}

impl TableKind {
    /// The only dimension that a table of this kind can have; `None` if it is not stated.
    pub const fn dimension(self) -> Option<u8> {
        match self {
            Self::Unspecified => None,
            Self::PlanKdTree | Self::PlanTriangulation => Some(2),
            Self::SceneKdTree { .. } | Self::SceneGivenCells { .. } | Self::QuakePortalFile | Self::QuakeMap => Some(3),
        }
    }

    /// Whether the cells are boxes in space, exactly those that the table stores.
    pub const fn has_box_cells(self) -> bool {
        matches!(self, Self::SceneKdTree { .. } | Self::SceneGivenCells { .. })
    }

    /// Whether the cells are boxes in space that leave no gap but the insides of solid things.
    pub const fn cells_fill_space(self) -> bool {
        matches!(self, Self::SceneKdTree { .. })
    }

    /// Whether there may be air outside every cell in the box around them: given boxes may leave gaps, and places leave out what is
    /// behind the backs of faces.
    pub const fn leaves_gaps(self) -> bool {
        matches!(self, Self::SceneGivenCells { .. })
    }

    /// Whether nothing is promised for eyes inside solid matter.
    pub const fn only_in_air(self) -> bool {
        match self {
            Self::SceneKdTree { hidden_by } | Self::SceneGivenCells { hidden_by } => hidden_by.only_in_air,
            _ => false,
        }
    }

    /// Whether the cells are the clusters of a Quake map, joined by convex portals.
    pub const fn is_quake(self) -> bool {
        matches!(self, Self::QuakePortalFile | Self::QuakeMap)
    }
}

impl fmt::Display for TableKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Unspecified => "unspecified",
            Self::PlanKdTree => "plan, k-d tree",
            Self::PlanTriangulation => "plan, triangulation",
            Self::SceneKdTree { .. } => "scene, k-d tree",
            Self::SceneGivenCells { .. } => "scene, boxes as cells",
            Self::QuakePortalFile => "Quake portal file",
            Self::QuakeMap => "Quake map",
        })
    }
}

/// An axis of the coordinate system.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Axis {
    /// The first.
    X,
    /// The second.
    Y,
    /// The third.
    Z,
}

impl Axis {
    /// All axes, in the order of coordinates.
    pub const ALL: [Self; 3] = [Self::X, Self::Y, Self::Z];

    /// The index of its coordinate.
    pub const fn idx(self) -> usize {
        self as usize
    }
}
