//! What is really there.

use sightlines_cells::{CellGraph, Convex, Plan, Scene};
use sightlines_geometry::{Aabb, Point3};
use sightlines_progress::Cancelled;
use sightlines_pvs::{GeometryDigest, Table, TableKind};

/// The scene that a table is to be true to.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub enum Truth<'a> {
    /// A plan: opaque lines stop sight.
    Plan(&'a Plan),
    /// A scene in space: every triangle stops sight, from both sides, but for those of objects that are see-through.
    Scene(&'a Scene),
    /// The portals of a Quake map: a line sees on through portals, in their order along it.
    Portals(&'a CellGraph<Convex>),
    /// A Quake map with its portals: also, nothing is seen through what is solid, and from cluster to cluster only where the
    /// portal file joins the two.
    World(&'a CellGraph<Convex>, &'a MapTree),
}

/// What is on a side of a plane of a map.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MapChild {
    /// Another plane, after this one.
    Node(u32),
    /// A leaf of a cluster.
    Cluster(u32),
    /// Something solid, or a leaf that is in no cluster.
    Solid,
}

/// A plane of a map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapNode {
    /// Its normal, of unit length but for rounding.
    pub normal: Point3,
    /// The plane is where `normal · p == distance`, in scene units.
    pub distance: f64,
    /// What is above it, where `normal · p` is larger, and below.
    pub children: [MapChild; 2],
}

/// A face of a map.
#[derive(Debug, Clone, PartialEq)]
pub struct MapFace {
    /// What a table calls it.
    pub name: String,
    /// The convex polygons that it is made of, most often one: the corners of each in turn, in scene units.
    pub polygons: Vec<Vec<Point3>>,
}

impl MapFace {
    /// The box around all of its corners; empty if it has none.
    pub(crate) fn bounds(&self) -> Aabb<3> {
        Aabb::around(self.polygons.iter().flatten().copied())
    }
}

/// The tree of planes that a map was cut along, with its faces.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MapTree {
    /// Planes, each before those under it; the first is the root. Empty if nothing is cut.
    pub nodes: Vec<MapNode>,
    /// The faces of the world.
    pub faces: Vec<MapFace>,
    /// For each cluster the faces that its leafs list, ascending.
    pub listed: Vec<Vec<u32>>,
}

/// Why a table was not checked: it cannot be of the scene, or the observer cancelled.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum VerifyError {
    /// A table of the plane and a scene in space, or the reverse.
    #[error("the table has {table} dimensions, the scene {scene}")]
    Dimension {
        /// Of the table.
        table: u8,
        /// Of the scene.
        scene: u8,
    },
    /// A table of a Quake map and another scene in space, or the reverse.
    #[error("the table is {table}, but the scene is {scene}")]
    Kind {
        /// What the table is of.
        table: &'static str,
        /// What the scene is.
        scene: &'static str,
    },
    /// A table of a map of which only the portals were given, or the reverse.
    #[error("the table {0}")]
    Places(&'static str),
    /// A corner that is farther from where the file has it than the gap that the table states.
    #[error("object {object}, vertex {vertex} is not within the gap of the table's frame")]
    Frame {
        /// Index of the object.
        object: usize,
        /// Index of the vertex in it.
        vertex: usize,
    },
    /// A scene with coordinates that are too large along the axes of the table.
    #[error("the scene cannot be taken along the frame of the table")]
    Range,
    /// The observer cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl Truth<'_> {
    const fn dimension(&self) -> u8 {
        if matches!(self, Self::Plan(_)) { 2 } else { 3 }
    }

    /// The digests that a table of it has.
    pub(crate) fn digest(&self) -> GeometryDigest {
        match self {
            Self::Plan(plan) => plan.digest(),
            Self::Scene(scene) => scene.digest(),
            Self::Portals(graph) | Self::World(graph, _) => graph.digest(),
        }
    }

    /// Refuses a table that cannot be of such a scene.
    pub(crate) fn check_kind(&self, table: &Table) -> Result<(), VerifyError> {
        if table.dimension() != self.dimension() {
            return Err(VerifyError::Dimension { table: table.dimension(), scene: self.dimension() });
        }
        let of_clusters = table.kind().is_quake();
        match self {
            Self::Portals(_) | Self::World(..) if !of_clusters => {
                Err(VerifyError::Kind { table: "of no Quake map", scene: "one" })
            }
            Self::Scene(_) if of_clusters => Err(VerifyError::Kind { table: "of a Quake map", scene: "none" }),
            Self::World(..) if table.kind() == TableKind::QuakePortalFile => {
                Err(VerifyError::Places("was made of a portal file alone: give that file, not the map"))
            }
            _ => Ok(()),
        }
    }
}
