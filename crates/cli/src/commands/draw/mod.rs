//! `draw`: a table as a picture.

pub(crate) mod space;

mod error;
use crate::Answer;
use crate::input::refuse;
use crate::picture::{PictureKind, draw_plan, save_picture};
use crate::place::{self, Point};
use crate::{input, output};
use error::Error;
use sightlines::geometry::check_coordinate;
use sightlines::pvs::Table;
use sightlines::report::{DrawOptions, MAX_SIZE, MIN_SIZE, View};
use std::path::PathBuf;

/// Arguments of `draw`.
#[derive(Debug, clap::Args)]
pub(crate) struct DrawArgs {
    /// The table
    #[arg(value_name = "FILE.pvs")]
    table: PathBuf,
    /// Show what is visible from this cell
    #[arg(long, help_heading = "Viewer", value_name = "N", conflicts_with = "eye")]
    cell: Option<u32>,
    /// Show what is visible from the cell of this point, in scene units; exit code 1 and no picture outside every cell
    #[arg(long, help_heading = "Viewer", value_name = "X,Y[,Z]", allow_hyphen_values = true)]
    eye: Option<Point>,
    /// Scenes in space: height of the floor plan, in scene units [default: that of the eye or of the middle of the
    /// cell]. With --isometric: leave out everything above
    #[arg(long, help_heading = "Picture", value_name = "Y", value_parser = height, allow_hyphen_values = true)]
    height: Option<f64>,
    /// Scenes in space: draw the cells as boxes, viewed from the positive side of all axes
    #[arg(long, help_heading = "Picture")]
    isometric: bool,
    /// Scenes in space: the axis that points up [default: the one stored in the table, else y]
    #[arg(long, help_heading = "Picture", value_name = "AXIS")]
    up: Option<space::UpAxis>,
    /// Longer side of the picture, in pixels
    #[arg(long, help_heading = "Picture", value_name = "PX", default_value_t = 1600)]
    #[arg(value_parser = clap::value_parser!(u32).range(i64::from(MIN_SIZE)..=i64::from(MAX_SIZE)))]
    size: u32,
    /// The picture to write
    #[arg(short, long, help_heading = "Output", value_name = "OUT.svg|OUT.png")]
    output: PathBuf,
}

fn height(text: &str) -> Result<f64, String> {
    let height: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    check_coordinate(height).map_err(|error| error.to_string())
}

pub(crate) fn run(args: &DrawArgs) -> Result<Answer, Error> {
    PictureKind::of(&args.output)?;
    output::check(&[&args.table], &[&args.output])?;
    let table = input::table(&args.table)?;
    input::refuse_without_places(&table, &args.table, "there is nothing to draw")?;
    if let Some(eye) = &args.eye
        && table.place_at(eye.lifted(&table, &args.table)?).is_outside()
    {
        output::stdout(|out| std::io::Write::write_fmt(out, format_args!("the point {eye} is outside every cell\n")))?;
        return Ok(Answer::No);
    }
    let svg = if table.dimension() == 2 { plan(args, &table)? } else { space::draw(args, &table)? };
    save_picture(&svg, &args.output)?;
    Ok(Answer::Yes)
}

fn plan(args: &DrawArgs, table: &Table) -> Result<String, Error> {
    let given = [("--height", args.height.is_some()), ("--isometric", args.isometric), ("--up", args.up.is_some())];
    refuse(&args.table, &given, "scenes in space", "the table of a plan")?;
    let view = match (args.cell, &args.eye) {
        (Some(id), _) => View::Cell(place::cell(id, table, &args.table)?),
        (None, Some(eye)) => View::Eye(eye.planar(table, &args.table)?),
        (None, None) => View::Plan,
    };
    Ok(draw_plan(&args.table, table, &DrawOptions { view, size: args.size, ..DrawOptions::default() })?)
}
