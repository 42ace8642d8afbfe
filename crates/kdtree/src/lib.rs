#![doc = include_str!("../README.md")]
//!
//! # Scope
//!
//! - **Owns**: [`AxialFace`] and its classes against a cell ([`classify`], [`cleaves`]), the choice of
//!   splitting planes ([`KdOptions`]), the tree with its cells, portals and point location ([`AxialTree`]),
//!   the way from a [`Plan`](sightlines_cells::Plan) to a graph ([`subdivide_plan`]), and that from a
//!   [`Scene`](sightlines_cells::Scene): which of its triangles act as walls ([`scene_faces`]), which cells are
//!   inside solids ([`subdivide_scene`], [`SceneCutter`] for scenes that change), which boxes are inside solids of any shape ([`Matter`]),
//!   which portals a door of the scene closes ([`shut_doors`]).
//! - **Out of scope**: sight lines, tables, files, walls that are not axis-parallel.
//! - **Invariants**: the cells tile the bounds without gap or overlap; no coordinate is ever computed, so
//!   cells and portals have the coordinates of faces and bounds, bit for bit; a portal is an opening of
//!   positive measure that no face covers; cell ids count the leaves depth-first, low before high.
//!
//! # On which side it errs
//! A face blocks sight only where it lies on the border of cells. Faces that the tree does not follow (the
//! threshold [`KdOptions::tau`], lines that are not axial) block nothing, so everything visible through the
//! cells and portals without them is reported visible. With `tau` 0 every face is followed and the subdivision is
//! exact: an open set of lines meets no face if and only if it passes portals wherever it leaves a cell.
//!
//! # Dimension
//! Everything is generic over the dimension `D`, which has to be 2 or 3. The dimension is fixed at
//! compile time: a plan is not lifted into space in order to be cut.
//!
//! # Source
//! Teller and Séquin, "Visibility preprocessing for interactive walkthroughs", SIGGRAPH 1991, for the
//! face classes and split rules. The wording of the classes, the order of ties and the compression of
//! coordinates to ranks are our own.

mod build;
mod cache;
mod coplanar;
mod doors;
mod error;
mod face;
mod flat;
mod hollow;
mod left_out;
mod matter;
mod mesh;
mod plan;
mod portals;
mod ranks;
mod region;
mod rooms;
mod scene;
mod scene_faces;
mod scene_options;
mod skeleton;
mod solid;
mod split;
mod touch;
mod tree;
mod union_find;

pub use build::{KdOptions, bounds_of, subdivide};
pub use doors::{ShutDoor, shut_doors};
pub use error::{FaceError, KdError};
pub use face::{AxialFace, AxialPlane, FaceClass, classify, cleaves};
pub use matter::Matter;
pub use plan::{PlanFaces, PlanSubdivision, plan_faces, planar_graph, subdivide_plan};
pub use scene::{SceneCutter, SceneSubdivision, SceneSummary, subdivide_scene};
pub use scene_faces::{SceneFaces, default_detail_below, scene_faces};
pub use scene_options::SceneOptions;
pub use tree::{AxialCell, AxialNode, AxialPortal, AxialTree};
