//! `draw`: a table as a picture.

use crate::Answer;
use crate::error::CliError;
use crate::place::{self, Point};
use crate::{input, output};
use sightlines::pvs::Table;
use sightlines::report::{DrawOptions, MAX_SIZE, MIN_SIZE, View, plan_svg, svg_to_png};
use std::path::{Path, PathBuf};

/// Arguments of `draw`.
#[derive(Debug, clap::Args)]
pub(crate) struct DrawArgs {
    /// The table
    #[arg(value_name = "FILE.pvs")]
    table: PathBuf,
    /// The picture to write
    #[arg(short, long, value_name = "OUT.svg|OUT.png")]
    output: PathBuf,
    /// Show what this cell sees
    #[arg(long, value_name = "N", conflicts_with = "eye")]
    cell: Option<u32>,
    /// Show what a viewer at this point sees; exit code 1, and no picture, if that is outside every cell
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true)]
    eye: Option<Point>,
    /// The longer side of the picture in pixels
    #[arg(long, value_name = "PX", default_value_t = 1600)]
    #[arg(value_parser = clap::value_parser!(u32).range(i64::from(MIN_SIZE)..=i64::from(MAX_SIZE)))]
    size: u32,
}

/// The kinds of pictures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum PictureKind {
    Svg,
    Png,
}

impl PictureKind {
    /// Tells the kind of a picture by the end of its name.
    pub(crate) fn of(path: &Path) -> Result<Self, CliError> {
        match path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase).as_deref() {
            Some("svg") => Ok(Self::Svg),
            Some("png") => Ok(Self::Png),
            _ => Err(CliError::PictureKind(path.to_owned())),
        }
    }
}

/// Draws a table that came from `source` into a file.
pub(crate) fn picture(source: &Path, table: &Table, options: &DrawOptions, out: &Path) -> Result<(), CliError> {
    let kind = PictureKind::of(out)?;
    let svg = plan_svg(table, options).map_err(|error| CliError::Draw { path: source.to_owned(), source: error })?;
    match kind {
        PictureKind::Svg => output::save(out, svg.as_bytes()),
        PictureKind::Png => {
            let png = svg_to_png(&svg).map_err(|error| CliError::Png { path: out.to_owned(), source: error })?;
            output::save(out, &png)
        }
    }
}

pub(crate) fn run(args: &DrawArgs) -> Result<Answer, CliError> {
    PictureKind::of(&args.output)?;
    output::refuse_same(&args.table, &args.output)?;
    let table = input::table(&args.table)?;
    let view = match (args.cell, &args.eye) {
        (Some(id), _) => View::Cell(place::cell(id, &table, &args.table)?),
        (None, Some(eye)) => {
            if table.locate(eye.of(&table, &args.table)?).is_empty() {
                output::stdout(|out| {
                    std::io::Write::write_fmt(out, format_args!("the point {eye} is outside every cell\n"))
                })?;
                return Ok(Answer::No);
            }
            View::Eye(eye.planar(&table, &args.table)?)
        }
        (None, None) => View::Plan,
    };
    let options = DrawOptions { view, size: args.size, ..DrawOptions::default() };
    picture(&args.table, &table, &options, &args.output)?;
    Ok(Answer::Yes)
}
