//! What is drawn along a walk with the levels of a folder, and without.

use crate::error::{ErrorAbout, Result, bail};
use crate::tables::Cells;
use sightlines::eye_to_cell::View;
use sightlines::formats::levels::{INDEX_NAME, read_levels_index};
use sightlines::report::WalkedLevels;
use sightlines::walkthrough::{LevelIndex, LevelSize};
use std::path::Path;

/// Counts the triangles of each frame.
pub(super) fn drawn<C: Cells>(folder: &Path, cells: &C, file: &Path, views: &[View]) -> Result<WalkedLevels> {
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
    let drawn = levels.drawn_by(index.n_triangles, cells, eyes).in_file(file)?;
    Ok(WalkedLevels::new(folder, levels.levels().len(), index.n_triangles, &drawn))
}
