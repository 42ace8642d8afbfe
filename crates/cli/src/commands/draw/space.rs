//! Pictures of tables in space.

use super::DrawArgs;
use super::Error;
use crate::picture::PictureError;
use crate::picture::{middle, up_of};
use crate::place;
use sightlines::pvs::Table;
use sightlines::report::{IsometricOptions, SliceOptions, Up, View, isometric_svg, slice_svg};

/// An axis as an argument.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum UpAxis {
    X,
    Y,
    Z,
}

/// The requested picture.
pub(super) fn draw(args: &DrawArgs, table: &Table) -> Result<String, Error> {
    let path = &args.table;
    let up = args.up.map_or(up_of(table), |axis| match axis {
        UpAxis::X => Up::X,
        UpAxis::Y => Up::Y,
        UpAxis::Z => Up::Z,
    });
    let view = match (args.cell, &args.eye) {
        (Some(id), _) => View::Cell(place::cell(id, table, path)?),
        (None, Some(eye)) => View::Eye(eye.spatial(table, path)?),
        (None, None) => View::Plan,
    };
    let drawn = if args.isometric {
        isometric_svg(table, &IsometricOptions { view, up, below: args.height, size: args.size })
    } else {
        let height = args.height.or_else(|| height_of(table, view, up));
        let height = height.ok_or_else(|| nowhere(args, table, up))?;
        slice_svg(table, &SliceOptions { view, up, height, size: args.size, ..SliceOptions::default() })
    };
    Ok(drawn.map_err(|source| PictureError::Draw { path: path.clone(), source })?)
}

/// The height of the eye.
fn height_of(table: &Table, view: View<[f64; 3]>, up: Up) -> Option<f64> {
    match view {
        View::Plan => None,
        View::Cell(id) => Some(middle(table, id, up)),
        View::Eye(eye) => Some(table.frame().map_or(eye, |frame| frame.to_frame(eye))[up.axis()]),
    }
}

fn nowhere(args: &DrawArgs, table: &Table, up: Up) -> Error {
    let low = table.cells().iter().map(|cell| cell.min[up.axis()]).fold(f64::INFINITY, f64::min);
    let high = table.cells().iter().map(|cell| cell.max[up.axis()]).fold(f64::NEG_INFINITY, f64::max);
    Error::WhichHeight { path: args.table.clone(), low, high }
}
