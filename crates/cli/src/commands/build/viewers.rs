//! Where viewers can be, as the file of a scene states it.

use serde::Serialize;
use sightlines::bake::{BakeOptions, Bakeable, CellsFrom};
use std::fmt;

/// The region of viewers that a file states.
#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct Viewers {
    n_volumes: usize,
    min: [f64; 3],
    max: [f64; 3],
}

/// Takes the box around the view volumes of a scene as the region of viewers, unless the options name one or the cells themselves.
pub(super) fn take(content: &Bakeable, options: &mut BakeOptions<'_>) -> Option<Viewers> {
    let Bakeable::Scene(file) = content else { return None };
    let region = file.info.view_region()?;
    if options.cut.view_region.is_some() || matches!(options.cells, CellsFrom::Boxes(_)) {
        return None;
    }
    options.cut.view_region = Some(region);
    Some(Viewers { n_volumes: file.info.view_volumes.len(), min: region.min, max: region.max })
}

impl Viewers {
    const fn volumes(&self) -> &'static str {
        if self.n_volumes == 1 { "the view volume" } else { "the view volumes" }
    }

    /// What a report in few words says of cells.
    pub(super) fn brief(&self) -> String {
        format!(", in {} of the file", self.volumes())
    }
}

impl fmt::Display for Viewers {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { min: [x0, y0, z0], max: [x1, y1, z1], .. } = self;
        let volumes = self.volumes();
        writeln!(f, "viewers        in {volumes} of the file: ({x0}, {y0}, {z0}) to ({x1}, {y1}, {z1})")
    }
}
