//! The memory that a bake is known to need, before it begins.

use crate::bakeable::Bakeable;
use crate::methods::OcclusionMethod;
use crate::options::{Recipe, SceneMethod};
use sightlines_formats::quake::Prt;
use sightlines_progress::memory::Needs;

/// Stacks, and what an allocator keeps for a thread.
const OF_A_THREAD: u64 = 4 << 20;
/// What a query keeps for each triangle of the scene, in each thread: where sheets were looked for, and whether it was seen.
const OF_A_TRIANGLE: u64 = 64;
/// What a row of runs takes, of a cell in a city.
const OF_A_ROW: u64 = 512;
/// Squares that are there at once while cells are asked about: what is possible, what is proven and what is left open, before this question and behind it.
const SQUARES: u64 = 5;

impl Bakeable {
    /// The memory that its bake is known to need, beside what is read. Nothing is known of plans, nor of scenes before they are cut by a k-d tree.
    ///
    /// * `by_rows`: for a table that is written row by row
    pub fn needs(&self, recipe: &Recipe, by_rows: bool) -> Needs {
        match self {
            Self::Scene(file) => {
                let Some(n) = recipe.cells.most() else { return Needs::default() };
                let n_objects = file.scene.objects().len() as u64;
                let has_buffers =
                    matches!(recipe.method, SceneMethod::Both | SceneMethod::FromRegion(OcclusionMethod::Multifocal));
                let buffers = if has_buffers { recipe.buffers.bytes_per_thread() } else { 0 };
                let of_triangles = OF_A_TRIANGLE * file.scene.n_triangles() as u64;
                // Four flags for each cell and object.
                let per_thread = OF_A_THREAD + buffers + of_triangles + 4 * (n + n_objects);
                if by_rows {
                    return Needs { shared: n * OF_A_ROW, per_thread };
                }
                let needs = Needs { shared: 0, per_thread };
                needs.and_bits(SQUARES, n, n).and_bits(SQUARES, n, n_objects)
            }
            Self::Portals(prt) | Self::Map(_, prt) => portals_need(prt),
            Self::Plan { .. } => Needs::default(),
        }
    }
}

/// The memory that the search of a portal file needs, beside the file: two squares of clusters, a row for each side of a portal, and the table.
pub fn portals_need(prt: &Prt) -> Needs {
    let [n, n_gates] = [prt.n_clusters() as u64, 2 * prt.n_portals() as u64];
    let needs = Needs { shared: 0, per_thread: OF_A_THREAD + n };
    needs.and_bits(3, n, n).and_bits(1, n_gates, n)
}
