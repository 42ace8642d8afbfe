//! Meshes as occluders: triangles merged into patches, patches selected for a volume, and sheets that hide without
//! being flat or convex.
//!
//! * [`Mesh`]: merged equal corners, and the edges that triangles share
//! * [`patches`]: as few and as large [`Occluder`](crate::Occluder)s as a heuristic finds
//! * [`select`]: the occluders that are worth drawing into a buffer
//! * [`Sheets`]: whether a surface, however it is bent and cut into triangles, separates two boxes
//!
//! Every choice is heuristic; every claim is checked by exact predicates.

mod flat;
mod fronts;
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
pub use patch::{patches, patches_of};
pub use patch_options::PatchOptions;
pub use select::{Chooser, select};
pub use shaft::avoids;
pub use sheet::{SheetTester, Sheets};
pub use vector::collinear;
pub use weld::Mesh;
