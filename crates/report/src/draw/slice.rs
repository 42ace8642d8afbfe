//! Floor plans of scenes in space.

use super::figure::Figure;
use super::picture::{Annotations, Picture};
use super::space::Up;
use super::visible_set::VisibleSet;
use super::{DrawError, View, check_cells, check_size, svg};
use sightlines_geometry::Point2;
use sightlines_pvs::Table;

/// How to draw a floor plan of a scene in space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SliceOptions {
    /// Whose visible set is shown; the viewer may be at another height.
    pub view: View<[f64; 3]>,
    /// Which way is up.
    pub up: Up,
    /// Where to cut, as a coordinate on the axis that points up, in scene units.
    pub height: f64,
    /// A line of sight to draw, as it is seen from above, in scene units; it may be at other heights.
    pub line: Option<[[f64; 3]; 2]>,
    /// The longer side of the picture in pixels, from [`MIN_SIZE`](super::MIN_SIZE) to
    /// [`MAX_SIZE`](super::MAX_SIZE).
    pub size: u32,
}

impl Default for SliceOptions {
    /// The cells alone at height 0, y up, 1600 pixels.
    fn default() -> Self {
        Self { view: View::Plan, up: Up::Y, height: 0.0, line: None, size: 1600 }
    }
}

/// Draws the cells that a horizontal plane cuts as SVG, seen from above: cells light, walls dark where a
/// cell has no portal, solid matter blank, and what is seen from a cell or a point. A plane on the border of
/// two storeys shows the upper one. Objects are not drawn. O(table).
///
/// # Errors
/// [`DrawError`] for a table of a plan, a cell that does not exist, a height without cells, an unusable size
/// or point.
pub fn slice_svg(table: &Table, options: &SliceOptions) -> Result<String, DrawError> {
    let SliceOptions { view, up, height, line, size } = *options;
    let (seen, eye) = look(table, view, size)?;
    if !height.is_finite() || !line.iter().flatten().flatten().all(|x| x.is_finite()) {
        return Err(DrawError::NotFinite);
    }
    let figure = Figure::of_slice(table, up, height);
    if figure.cells.is_empty() {
        let low = table.cells().iter().map(|c| c.min[up.axis()]).fold(f64::INFINITY, f64::min);
        let high = table.cells().iter().map(|c| c.max[up.axis()]).fold(f64::NEG_INFINITY, f64::max);
        return Err(DrawError::NoCellAt { height, low, high });
    }
    let on_floor = |p: [f64; 3]| Point2::from(up.on_floor(p));
    let annotations =
        Annotations { eye: eye.map(on_floor), line: line.map(|ends| ends.map(on_floor)), ..Annotations::default() };
    let title = format!("{} at height {height}", title(view));
    Ok(Picture::new(&figure, seen.as_ref(), size).draw(&title, &annotations, false, true))
}

/// What a picture of a scene in space is called.
pub(super) fn title(view: View<[f64; 3]>) -> String {
    match view {
        View::Plan => "Cells".to_owned(),
        View::Cell(cell) => svg::seen_from_cell(cell),
        View::Eye(eye) => svg::seen_from_point(&eye),
    }
}

/// Checks what all pictures of scenes in space have in common; what is seen, and the viewer.
pub(super) fn look(
    table: &Table,
    view: View<[f64; 3]>,
    size: u32,
) -> Result<(Option<VisibleSet>, Option<[f64; 3]>), DrawError> {
    if table.dimension() != 3 {
        return Err(DrawError::NotSpatial(table.dimension()));
    }
    check_size(size)?;
    match view {
        View::Plan => Ok((None, None)),
        View::Cell(cell) => {
            check_cells(table, [cell])?;
            Ok((Some(VisibleSet::from_cell(table, cell)), None))
        }
        View::Eye(eye) if eye.iter().all(|x| x.is_finite()) => {
            // Pictures are along the axes of the table.
            let along = table.frame().map_or(eye, |frame| frame.to_frame(eye));
            Ok((Some(VisibleSet::from_point(table, eye)), Some(along)))
        }
        View::Eye(_) => Err(DrawError::NotFinite),
    }
}
