//! Pictures of tables in space.

use super::DrawArgs;
use super::viewer::Shown;
use crate::error::{ErrorAbout, Result, anyhow};
use crate::picture::{middle, up_of};
use crate::place;
use crate::view;
use sightlines::pvs::Table;
use sightlines::report::{
    Drawing, IsometricOptions, PictureSubject, SliceOptions, Surfaces, Up, isometric_drawing, slice_drawing,
};

/// The axis that points up: the one that was given, if it is an axis, else that of the table.
fn up(args: &DrawArgs, table: &Table) -> Up {
    match args.sight.lens.up() {
        Some(view::Up([1.0, 0.0, 0.0])) => Up::X,
        Some(view::Up([0.0, 1.0, 0.0])) => Up::Y,
        Some(view::Up([0.0, 0.0, 1.0])) => Up::Z,
        _ => up_of(table),
    }
}

pub(super) fn draw(
    args: &DrawArgs,
    table: &Table,
    shown: Option<&Shown<'_>>,
    surfaces: Option<&Surfaces>,
    legend: bool,
) -> Result<Drawing> {
    let path = &args.table;
    let up = up(args, table);
    let view = match (args.cell, &args.eye) {
        (Some(id), _) => PictureSubject::Cell(place::cell(id, table, path)?),
        (None, Some(eye)) => PictureSubject::Eye(eye.spatial(path)?),
        (None, None) => PictureSubject::Plan,
    };
    let sight = shown.map(|shown| shown.sight(|p| p));
    let drawn = if args.isometric {
        let below = args.height.or_else(|| height_of(table, view, up));
        let options = IsometricOptions {
            view,
            sight,
            up,
            below,
            surfaces,
            legend,
            size: args.size,
            ..IsometricOptions::default()
        };
        isometric_drawing(table, &options)
    } else {
        let height = args.height.or_else(|| height_of(table, view, up));
        let height = height.ok_or_else(|| nowhere(args, table, up))?;
        let options =
            SliceOptions { view, sight, up, height, surfaces, legend, size: args.size, ..SliceOptions::default() };
        slice_drawing(table, &options)
    };
    drawn.in_file(path)
}

fn height_of(table: &Table, view: PictureSubject<[f64; 3]>, up: Up) -> Option<f64> {
    match view {
        PictureSubject::Plan => None,
        PictureSubject::Cell(id) => Some(middle(table, id, up)),
        PictureSubject::Eye(eye) => Some(table.frame().map_or(eye, |frame| frame.to_frame(eye))[up.axis()]),
    }
}

fn nowhere(args: &DrawArgs, table: &Table, up: Up) -> anyhow::Error {
    let low = table.cells().iter().map(|cell| cell.min[up.axis()]).fold(f64::INFINITY, f64::min);
    let high = table.cells().iter().map(|cell| cell.max[up.axis()]).fold(f64::NEG_INFINITY, f64::max);
    anyhow!(
        "{}: a floor plan of a scene in space needs --height (cells reach from {low} to {high}), --eye or --cell; \
             without, there is --isometric",
        args.table.display()
    )
}
