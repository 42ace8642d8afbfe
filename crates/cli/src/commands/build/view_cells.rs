//! View cells from a file, as an argument.

use crate::error::Result;
use sightlines::formats::view_cells::read_view_cells;
use sightlines::formats::{ReadError, ViewCells};
use std::path::PathBuf;

/// Which boxes are the cells of a scene.
#[derive(Debug, Clone, Default, clap::Args)]
pub(super) struct ViewCellsArgs {
    /// Scenes in space: use these boxes as cells, as JSON: {"cells":[{"id":"hall","min":[0,0,0],"max":[4,2.5,6]}]}
    #[arg(long, help_heading = "Cells", value_name = "FILE.json")]
    cells: Option<PathBuf>,
}

impl ViewCellsArgs {
    /// Whether a file was given.
    pub(super) fn is_given(&self) -> bool {
        self.cells.is_some()
    }

    /// The view cells of the file, if one was given.
    ///
    /// # Errors
    /// [`ReadError`] with the file's name and the place in it.
    pub(super) fn read(&self) -> Result<Option<ViewCells>, ReadError> {
        self.cells.as_ref().map(read_view_cells).transpose()
    }
}
