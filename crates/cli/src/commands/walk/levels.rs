//! What is drawn along a walk with the levels of a folder, and without.

use crate::error::{ErrorAbout, Result, bail};
use crate::output::{JsonSchema, Serialize, percent, share};
use crate::tables::Cells;
use sightlines::eye_to_cell::View;
use sightlines::formats::levels::{INDEX_NAME, read_levels_index};
use sightlines::walkthrough::{LevelIndex, LevelSize, LevelsDrawn};
use std::fmt;
use std::path::Path;

/// Triangles that are drawn, on average over the frames with the eye in a cell.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Drawn {
    /// The folder of levels.
    folder: String,
    /// Levels in it.
    n_levels: usize,
    /// Frames.
    n_frames: usize,
    /// Of these, frames in which all cells of the eye have the same level.
    n_with_level: usize,
    /// Triangles drawn in each frame without levels: all of the scene.
    without: u64,
    /// Triangles drawn in a frame with levels, on average.
    with_mean: f64,
    /// Triangles drawn in a frame with levels, at most.
    with_most: u64,
}

/// Counts the triangles of each frame.
pub(super) fn drawn<C: Cells>(folder: &Path, cells: &C, file: &Path, views: &[View]) -> Result<Drawn> {
    let path = folder.join(INDEX_NAME);
    let index = read_levels_index(&path)?;
    let [table, _] = cells.counts();
    if index.cells.len() != table {
        bail!(
            "{}: the levels are for another table: the index has {} cells, {} has {table}",
            path.display(),
            index.cells.len(),
            file.display()
        );
    }
    let sizes = index.levels.iter().map(|level| LevelSize { bytes: level.n_bytes, n_triangles: level.n_triangles });
    let sizes: Vec<LevelSize> = sizes.collect();
    let levels = LevelIndex::new(index.cells, sizes).in_file(&path)?;
    let eyes = views.iter().map(View::eye);
    let LevelsDrawn { n_frames, n_with_level, n_triangles, most } =
        levels.drawn_by(index.n_triangles, cells, eyes).in_file(file)?;
    Ok(Drawn {
        folder: folder.display().to_string(),
        n_levels: levels.levels().len(),
        n_frames,
        n_with_level,
        without: index.n_triangles,
        with_mean: share(n_triangles as f64, n_frames as f64),
        with_most: most,
    })
}

impl fmt::Display for Drawn {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [of_mean, of_most] =
            [self.with_mean, self.with_most as f64].map(|n| percent(share(n, self.without as f64)));
        let (mean, most) = (self.with_mean, self.with_most);
        let Self { folder, n_levels, n_frames, n_with_level, .. } = self;
        writeln!(f, "levels         {n_levels} of {folder}, in {n_with_level} of {n_frames} frames inside")?;
        writeln!(f, "triangles      {} a frame without levels", self.without)?;
        writeln!(f, "               {mean:.1} with levels on average, {of_mean}; at most {most}, {of_most}")
    }
}
