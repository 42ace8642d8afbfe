//! What is left out before anything is drawn.

use crate::error::{ErrorAbout, Result, bail};
use crate::output::{JsonSchema, Serialize};
use crate::tables::{Cells, Opened};
use sightlines::cells::{Scene, unlike};
use sightlines::geometry::Point3;
use sightlines::pvs::{ObjectId, Place, PlaceBuffer};
use sightlines::visible_surface::hierarchical::{self, DepthPyramid};
use sightlines::visible_surface::{Camera, DepthFormat, FaceMask, Faces, RenderInput, VisibleSurface, ZBuffer, cull};
use std::path::Path;
use std::time::Instant;

/// A way to leave faces out, as an argument.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum Cull {
    /// Back-facing triangles
    Backface,
    /// Everything outside the view frustum, first by boxes of objects, then by faces
    Frustum,
    /// Everything that is not visible from the cell of the eye, according to --table
    Pvs,
    /// Everything behind a hierarchical z-buffer of the rest
    HierarchicalZ,
}

impl Cull {
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Backface => "backface",
            Self::Frustum => "frustum",
            Self::Pvs => "pvs",
            Self::HierarchicalZ => "hierarchical-z",
        }
    }
}

/// Faces that were left out in one way.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Gone {
    /// The way of culling.
    pub(super) by: &'static str,
    /// Faces that it removed of those that were left.
    pub(super) n_faces: u64,
    /// Seconds it took.
    pub(super) seconds: f64,
}

/// Leaves faces out of `chosen`, by each way in turn. `seen` has, for each object of the scene, whether the table shows
/// it; `None` skips the table.
pub(super) fn leave_out(
    ways: &[Cull],
    faces: &Faces,
    camera: &Camera,
    seen: Option<&[bool]>,
    chosen: &mut FaceMask,
) -> Vec<Gone> {
    let each = |&by: &Cull| {
        let start = Instant::now();
        let n = match by {
            Cull::Backface => cull::backface(faces, camera, chosen),
            Cull::Frustum => cull::frustum(faces, camera, chosen),
            Cull::Pvs => seen.map_or(0, |seen| cull::objects(faces, chosen, |object| seen[object as usize])),
            Cull::HierarchicalZ => {
                let (image, _) = ZBuffer::new(DepthFormat::Exact).picture(&RenderInput { faces, camera, mask: chosen });
                hierarchical::cull(faces, chosen, &DepthPyramid::sampled(faces, camera, &image))
            }
        };
        Gone { by: by.name(), n_faces: n, seconds: start.elapsed().as_secs_f64() }
    };
    ways.iter().map(each).collect()
}

/// Which objects of a scene a table shows from a point; `None`, and a warning, if that is outside every cell, where
/// everything may be seen.
pub(super) fn seen_by_table(
    opened: &Opened,
    table: &Path,
    path: &Path,
    scene: &Scene,
    eye: Point3,
) -> Result<Option<Vec<bool>>> {
    match opened {
        Opened::Plain(cells) => ask(cells, table, path, scene, eye),
        Opened::Packed(cells) => ask(cells, table, path, scene, eye),
    }
}

fn ask<C: Cells>(cells: &C, table: &Path, path: &Path, scene: &Scene, eye: Point3) -> Result<Option<Vec<bool>>> {
    cells.refuse_without_places(table)?;
    let object = |id| Ok::<_, C::Error>((cells.object_name(id)?, cells.object_box(id)?));
    let found =
        unlike(scene, cells.n_dimensions(), cells.frame().as_ref(), cells.counts()[1], |id| object(ObjectId(id)));
    if let Some(unlike) = found.in_file(table)? {
        bail!("{}: does not go with {}: {unlike}", table.display(), path.display());
    }
    let mut buffer = PlaceBuffer::new();
    let place = cells.cells_at(eye, &mut buffer).in_file(table)?;
    let Place::Inside(at) = place else {
        tracing::warn!("{}: the eye is outside every cell, where everything may be seen", table.display());
        return Ok(None);
    };
    let mut seen = vec![false; scene.objects().len()];
    let mut objects = Vec::new();
    for &cell in at {
        cells.objects_seen(cell, &mut objects).in_file(table)?;
        objects.iter().for_each(|&object| seen[object.idx()] = true);
    }
    Ok(Some(seen))
}
