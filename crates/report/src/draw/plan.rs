//! Plans: the whole of a planar table.

use super::figure::Figure;
use super::picture::{Annotations, Picture};
use super::visible_set::VisibleSet;
use super::{DrawError, View, check_cells, check_size, svg};
use sightlines_geometry::Point2;
use sightlines_pvs::{CellId, Table};

/// How to draw a plan.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawOptions {
    /// Whose visible set is shown.
    pub view: View,
    /// A cell to mark as the one looked for.
    pub target: Option<CellId>,
    /// A line of sight, in scene units.
    pub line: Option<[Point2; 2]>,
    /// Indices of portals to mark, such as those that the line passes.
    pub marked_portals: Vec<usize>,
    /// Whether objects are drawn.
    pub objects: bool,
    /// Whether [`View::Plan`] tints the cells by group, if they have any.
    pub group_colours: bool,
    /// The longer side of the picture in pixels, from [`MIN_SIZE`](super::MIN_SIZE) to
    /// [`MAX_SIZE`](super::MAX_SIZE).
    pub size: u32,
}

impl Default for DrawOptions {
    /// The plan alone, with objects and group colours, 1600 pixels.
    fn default() -> Self {
        Self {
            view: View::Plan,
            target: None,
            line: None,
            marked_portals: Vec::new(),
            objects: true,
            group_colours: true,
            size: 1600,
        }
    }
}

/// Draws a table of a plan as SVG: cells light, walls dark, portals thin, and by [`DrawOptions`] what is
/// seen from a cell or a point. y grows upwards, proportions are kept, stroke widths follow the size of
/// the cells. O(table).
///
/// # Errors
/// [`DrawError`] for a table in space, cells or portals that do not exist, an unusable size or point.
pub fn plan_svg(table: &Table, options: &DrawOptions) -> Result<String, DrawError> {
    check(table, options)?;
    let figure = Figure::of_plan(table);
    let (seen, eye) = match options.view {
        View::Plan => (None, None),
        View::Cell(cell) => (Some(VisibleSet::from_cell(table, cell)), None),
        View::Eye(eye) => (Some(VisibleSet::from_point(table, [eye.x, eye.y, 0.0])), Some(eye)),
    };
    let annotations = Annotations { target: options.target, portals: &options.marked_portals, line: options.line, eye };
    let title = match options.view {
        View::Plan => "Cells and portals".to_owned(),
        View::Cell(cell) => svg::seen_from_cell(cell),
        View::Eye(eye) => svg::seen_from_point(&[eye.x, eye.y]),
    };
    let picture = Picture::new(&figure, seen.as_ref(), options.size);
    Ok(picture.draw(&title, &annotations, options.objects, options.group_colours))
}

fn check(table: &Table, options: &DrawOptions) -> Result<(), DrawError> {
    if table.dimension() != 2 {
        return Err(DrawError::NotPlanar(table.dimension()));
    }
    let from = if let View::Cell(cell) = options.view { Some(cell) } else { None };
    check_cells(table, [from, options.target].into_iter().flatten())?;
    let n_portals = table.portals().len();
    if let Some(&portal) = options.marked_portals.iter().find(|&&portal| portal >= n_portals) {
        return Err(DrawError::NoSuchPortal { portal, n_portals });
    }
    check_size(options.size)?;
    let eye = if let View::Eye(eye) = options.view { Some(eye) } else { None };
    let finite = options.line.into_iter().flatten().chain(eye).all(Point2::is_finite);
    if finite { Ok(()) } else { Err(DrawError::NotFinite) }
}
