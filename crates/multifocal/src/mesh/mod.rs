//! Meshes as occluders: triangles put together to patches, patches chosen for a volume, and sheets that
//! hide without being flat or convex.
//!
//! * [`Mesh`]: corners that are equal made one, and the edges that triangles share
//! * [`patches`]: as few and as large [`Occluder`](crate::Occluder)s as a heuristic finds
//! * [`select`]: which of many are worth drawing into a buffer
//! * [`Sheets`]: whether a surface, however it is bent and cut into triangles, separates two boxes
//!
//! What is chosen is heuristic everywhere, what is claimed is checked by exact predicates.

mod flat;
mod grow;
mod method;
mod patch;
mod patch_options;
mod polygon;
mod probe;
mod select;
mod shaft;
mod sheet;
mod vector;
mod weld;

pub use method::SheetMethod;
pub use patch::patches;
pub use patch_options::PatchOptions;
pub use select::{Chooser, select};
pub use shaft::avoids;
pub use sheet::{SheetTester, Sheets};
pub use weld::Mesh;
