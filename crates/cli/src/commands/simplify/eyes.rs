//! Where eyes are: boxes, or cells of a table.

use crate::error::{ErrorAbout, Result};
use crate::input;
use crate::region::Region;
use sightlines::multifocal::Volume;
use sightlines::pvs::{CellId, Table};
use sightlines::simplify::Views;
use std::path::PathBuf;

/// Where eyes are, as arguments.
#[derive(Debug, Clone, clap::Args)]
pub(super) struct EyesArgs {
    /// View volume as a box: its lower corner, then its upper one, in scene units; repeatable
    #[arg(
        long,
        help_heading = "Viewer",
        value_name = "X0,Y0,Z0,X1,Y1,Z1",
        allow_hyphen_values = true,
        required_unless_present = "table",
        conflicts_with = "table"
    )]
    volume: Vec<Region>,
    /// The table of the scene, for eyes in its cells --cell; what it hides from them is hidden
    #[arg(long, help_heading = "Viewer", value_name = "FILE.pvs", requires = "cell")]
    pub(super) table: Option<PathBuf>,
    /// Cells of the table, by number, separated by commas
    #[arg(long, help_heading = "Viewer", value_name = "N[,N...]", value_delimiter = ',', requires = "table")]
    cell: Vec<u32>,
}

impl EyesArgs {
    pub(super) fn table(&self) -> Result<Option<Table>> {
        self.table.as_ref().map(|path| input::table(path)).transpose()
    }

    /// The places: cells of `table`, which is the one that was read, along its axes.
    pub(super) fn views(&self, table: Option<&Table>) -> Result<Views> {
        let (Some(path), Some(table)) = (&self.table, table) else {
            let volumes = self
                .volume
                .iter()
                .map(|region| Volume::new(region.0))
                .collect::<Result<Vec<_>, _>>()
                .about("--volume")?;
            return Ok(Views::new(volumes).expect("the arguments have a volume"));
        };
        let cells: Vec<CellId> = self.cell.iter().copied().map(CellId).collect();
        Views::of_cells(table, &cells).in_file(path)
    }
}
