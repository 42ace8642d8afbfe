//! What is left out before anything is drawn.

use crate::error::{ErrorAbout, Result, bail};
use crate::output::{JsonSchema, Serialize};
use crate::tables::{Cells, Opened};
use sightlines::cells::{Scene, unlike};
use sightlines::geometry::Point3;
use sightlines::pvs::{ObjectId, Place, PlaceBuffer};
use sightlines::visible_surface::{Camera, CullStep, FaceMask, Faces};
use std::path::Path;
use std::time::Instant;

/// What a way to leave faces out takes away, for help texts.
pub(super) const fn about(way: CullStep) -> &'static str {
    match way {
        CullStep::Backface => "Back-facing triangles",
        CullStep::Frustum => "Everything outside the view frustum, first by boxes of objects, then by faces",
        CullStep::Pvs => "Everything that is not visible from the cell of the eye, according to --table",
        CullStep::HierarchicalZ => "Everything behind a hierarchical z-buffer of the rest",
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
    ways: &[CullStep],
    faces: &Faces,
    camera: &Camera,
    seen: Option<&[bool]>,
    chosen: &mut FaceMask,
) -> Vec<Gone> {
    let each = |by: &CullStep| {
        let start = Instant::now();
        let n_faces = by.apply(faces, camera, seen, chosen);
        Gone { by: by.name(), n_faces, seconds: start.elapsed().as_secs_f64() }
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
