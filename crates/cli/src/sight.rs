//! What a viewer sees, as arguments: in a direction, by a method, with doors closed.

use crate::error::{ErrorAbout, Result, anyhow};
use crate::place::Point;
use crate::tables::Cells;
use crate::view::{LensArgs, Methods, lifted, method_help};
use sightlines::eye_to_cell::{Doors, View};
use sightlines::walkthrough::CameraPose;
use std::path::Path;

/// The view, as arguments.
#[derive(Debug, clap::Args)]
pub(crate) struct SightArgs {
    /// Direction of view [default: all directions]
    #[arg(long, help_heading = "Viewer", value_name = "DX,DY[,DZ]", allow_hyphen_values = true)]
    pub(crate) dir: Option<Point>,
    #[command(flatten)]
    pub(crate) lens: LensArgs,
    #[arg(long, help_heading = "Method", value_name = "NAME")]
    #[arg(help = method_help(" [default: exact if an option describes the view, else the visible set of the eye's cell]"))]
    pub(crate) method: Option<Methods>,
    /// Closed portals by number, and shut doors by name, separated by commas; all doors of a name are shut. A name with a comma is given
    /// alone. A number is a portal; door:12 is a door that is called 12. May be given several times
    #[arg(long, help_heading = "Method", value_name = "PORTAL|NAME,...")]
    pub(crate) closed: Vec<String>,
}

/// A view, and what of it is marked in a picture.
#[derive(Debug, Clone)]
pub(crate) struct Sight {
    pub(crate) view: View,
    /// The direction as it was given, and the angle in degrees; none all round.
    pub(crate) looks: Option<(Vec<f64>, f64)>,
}

/// Angles of view without a direction.
pub(crate) fn without_direction(options: &str) -> anyhow::Error {
    anyhow!("{options} need --dir: without it the viewer looks all round")
}

impl SightArgs {
    /// The view of an eye. The caller has refused a lens without a direction, if it means nothing to them.
    pub(crate) fn sight<C: Cells>(&self, cells: &C, path: &Path, eye: &[f64]) -> Result<Sight> {
        let lens = self.lens.lens(cells, path)?;
        let Some(dir) = &self.dir else {
            let view = View::all_round(lifted(eye)).about("--eye")?;
            return Ok(Sight { view, looks: None });
        };
        let given = dir.coordinates(cells.n_dimensions(), path)?;
        let view = lens.view(CameraPose { eye: lifted(eye), dir: lifted(given) });
        let view = view.about("--dir")?;
        Ok(Sight { view, looks: Some((given.to_vec(), lens.fov)) })
    }

    /// The doors that are shut.
    pub(crate) fn doors<C: Cells>(&self, cells: &C, path: &Path) -> Result<Doors> {
        let mut doors = Doors::all_open();
        for text in &self.closed {
            doors.close_named(text, cells.doors(), cells.n_portals()).in_file(path)?;
        }
        Ok(doors)
    }
}
