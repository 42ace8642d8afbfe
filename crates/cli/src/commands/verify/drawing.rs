//! The picture of the first ray that shows a violation.

use crate::error::{ErrorAbout, Result};
use crate::picture::up_of;
use crate::picture::{draw_plan, save_picture};
use sightlines::geometry::Point2;
use sightlines::pvs::Table;
use sightlines::report::{DrawOptions, PictureSubject, SliceOptions, slice_svg};
use sightlines::verify::{Findings, Violation};
use std::path::{Path, PathBuf};

/// Draws what a cell sees according to the table, and the ray that contradicts it. `None`, and no picture, if no violation has a
/// ray.
pub(super) fn draw(source: &Path, table: &Table, findings: &Findings, out: &Path) -> Result<Option<PathBuf>> {
    let shown = findings.violations.iter().find_map(|v| Some((v, v.segment()?)));
    let Some((violation, segment)) = shown else { return Ok(None) };
    let cells = violation.cells();
    let svg = if table.dimension() == 2 {
        let target = if let Violation::HiddenCell { cells: [_, to], .. } = violation { Some(*to) } else { None };
        let line = Some(segment.map(|[x, y, _]| Point2::new(x, y)));
        let options = DrawOptions { view: PictureSubject::Cell(cells[0]), target, line, ..DrawOptions::default() };
        draw_plan(source, table, &options)?
    } else {
        let up = up_of(table);
        let options = SliceOptions {
            view: PictureSubject::Cell(cells[0]),
            up,
            height: segment[0][up.axis()],
            line: Some(segment),
            ..SliceOptions::default()
        };
        slice_svg(table, &options).in_file(source)?
    };
    save_picture(&svg, out)?;
    Ok(Some(out.to_owned()))
}
