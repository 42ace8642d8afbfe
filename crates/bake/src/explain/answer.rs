//! What is found about two cells.

use crate::graph::GraphKind;
use sightlines_cells::{CellId, PortalId};
use sightlines_geometry::{AxialDoor, Point2, Point3, Portal2};
use sightlines_sightline::{AxialWitness, PlanarWitness};
use sightlines_stabtree::{AxialProof, Blocking};

/// Why one cell sees another, or why it does not.
#[derive(Debug, Clone, PartialEq)]
pub struct Explanation {
    /// The kind of the cells.
    pub cells: GraphKind,
    /// What was found.
    pub answer: Answer,
    /// Whether a checker that shares no code with the search accepts a line or a reason; `None` if
    /// [none was asked for](super::ExplainOptions::check), and for all but clusters.
    pub checked: Option<bool>,
}

/// What is found about two cells. All points are along the axes of the table, and have z = 0 in the plane.
#[derive(Debug, Clone, PartialEq)]
pub enum Answer {
    /// They are one cell, and a cell sees itself.
    Same,
    /// A line joins them: what it passes, and where it is, exactly.
    Visible(SightLine, ExactLine),
    /// No open set of lines joins them.
    Hidden(Reason),
    /// The search ended at this limit: cells entered in a plan, linear programs for boxes, sequences of portals for clusters.
    GivenUp(u64),
    /// Clusters: no line was found, and rounding leaves open whether one passes these portals.
    Undecided(Way),
    /// Cells without portals: no line is known, which proves nothing.
    Unknown {
        /// About how many rays from each cell found none; `None` without a scene.
        n_rays: Option<u32>,
        /// Of a pair that the table hides, the methods of which at least one hid it, by their names in
        /// [`StatedMethods`](crate::StatedMethods).
        hidden_by: Vec<String>,
    },
}

impl Answer {
    /// Whether they see each other; `None` if that was not decided.
    pub const fn verdict(&self) -> Option<bool> {
        match self {
            Self::Same | Self::Visible(..) => Some(true),
            Self::Hidden(_) => Some(false),
            Self::GivenUp(_) | Self::Undecided(_) | Self::Unknown { .. } => None,
        }
    }
}

/// A line from one cell to another.
#[derive(Debug, Clone, PartialEq)]
pub struct SightLine {
    /// The cells that it passes, in order: at least two.
    pub cells: Vec<CellId>,
    /// The portals between them, one fewer; none for cells without portals.
    pub portals: Vec<PortalId>,
    /// A point in the first cell and one in the last, rounded, along the axes of the table; of clusters, whose volumes are unknown, a little
    /// beyond the first portal and the last. `None` if the line may leave no room for one in doubles.
    pub ends: Option<[Point3; 2]>,
}

/// A line, exactly.
#[derive(Debug, Clone, PartialEq)]
pub enum ExactLine {
    /// In a plan, with the portals as they are oriented for crossing them in order.
    Planar(Box<PlanarWitness>, Vec<Portal2>),
    /// Between boxes of a k-d tree, with the portals as they are oriented for crossing them in order.
    Axial(Box<AxialWitness>, Vec<AxialDoor>),
    /// Between clusters: two points of the line, in its direction, and where it crosses each portal, rounded.
    Convex([Point3; 2], Vec<Point3>),
    /// Between cells without portals: nothing in the scene touches the segment between [`SightLine::ends`], which lie inside the cells.
    Segment,
}

impl ExactLine {
    /// Where the line crosses each portal, rounded; `None` for a portal that it lies in. O(portals), in fractions.
    pub fn crossings(&self) -> Vec<Option<Point3>> {
        match self {
            Self::Planar(witness, doors) => doors.iter().map(|&door| Some(lifted(witness.crossing(door)))).collect(),
            Self::Axial(witness, doors) => doors.iter().map(|door| witness.crossing(door)).collect(),
            Self::Convex(_, crossings) => crossings.iter().copied().map(Some).collect(),
            Self::Segment => Vec::new(),
        }
    }

    /// Where the line crosses the first portal and the last, rounded, for lines without [`SightLine::ends`].
    pub fn outer_crossings(&self) -> Option<[Point3; 2]> {
        let all = self.crossings();
        Some([(*all.first()?)?, (*all.last()?)?]).filter(|ends| ends.iter().flatten().all(|x| x.is_finite()))
    }
}

/// A point of the plane, in space.
pub(super) const fn lifted(p: Point2) -> Point3 {
    [p.x, p.y, 0.0]
}

/// Why no line joins two cells.
#[derive(Debug, Clone, PartialEq)]
pub enum Reason {
    /// No chain of portals leads from one to the other.
    NotConnected,
    /// Plans and clusters: every chain of portals passes one of these ways.
    Blocked {
        /// The cell, one of the two, from which the ways lead to the other.
        start: CellId,
        /// Number of ways.
        n_blocked: u64,
        /// The first of them, as many as [asked for](super::ExplainOptions::max_blocked).
        blocked: Vec<BlockedWay>,
    },
    /// Boxes of a k-d tree: every line meets a wall.
    Walls(AxialProof),
}

/// Portals in order, as they are passed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Way {
    /// The portals. In plans they follow each other; between those of clusters there may be others.
    pub portals: Vec<PortalId>,
    /// The cell behind each.
    pub cells: Vec<CellId>,
}

/// Portals that no open set of lines passes in order, whatever is between them.
#[derive(Debug, Clone, PartialEq)]
pub struct BlockedWay {
    /// The portals.
    pub way: Way,
    /// Why.
    pub proof: Blocks,
}

/// Why no line passes some portals in order.
#[derive(Debug, Clone, PartialEq)]
pub enum Blocks {
    /// Plans: a line would have to pass on the right of the left ends and on the left of the right ends, and no line separates them.
    Corners {
        /// Left ends.
        lefts: Vec<Corner>,
        /// Right ends.
        rights: Vec<Corner>,
    },
    /// Clusters.
    Convex(Blocking),
}

/// An end of a portal of a plan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Corner {
    /// The portal.
    pub portal: PortalId,
    /// Its end.
    pub point: Point2,
}
