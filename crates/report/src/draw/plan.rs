//! Plans: the whole of a planar table.

use super::figure::Figure;
use super::picture::{Annotations, Look, draw};
use super::visible_set::VisibleSet;
use super::{DrawError, Drawing, PictureSubject, SeenFromEye, check_cells, check_sight, check_size, svg};
use sightlines_geometry::Point2;
use sightlines_pvs::{CellId, Table};

/// How to draw a plan.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawOptions<'a> {
    /// Whose visible set is shown.
    pub view: PictureSubject,
    /// With [`PictureSubject::Eye`]: what the viewer sees of that, drawn over it.
    pub sight: Option<SeenFromEye<'a>>,
    /// A cell to mark as the one looked for.
    pub target: Option<CellId>,
    /// A line of sight, in scene units.
    pub line: Option<[Point2; 2]>,
    /// Indices of portals to mark, such as those that the line passes.
    pub marked_portals: Vec<usize>,
    /// Places where walls were joined.
    pub joints: &'a [Point2],
    /// Places where walls nearly meet, and were not joined.
    pub near_misses: &'a [Point2],
    /// Whether objects are drawn.
    pub objects: bool,
    /// Whether a legend and a scale bar stand below, if there is room for words.
    pub legend: bool,
    /// Whether [`PictureSubject::Plan`] tints the cells by group, if they have any.
    pub group_colours: bool,
    /// The longer side of the picture in pixels, from [`MIN_SIZE`](super::MIN_SIZE) to
    /// [`MAX_SIZE`](super::MAX_SIZE).
    pub size: u32,
}

impl Default for DrawOptions<'_> {
    /// The plan alone, with objects, group colours and a legend, 1600 pixels.
    fn default() -> Self {
        Self {
            view: PictureSubject::Plan,
            sight: None,
            target: None,
            line: None,
            marked_portals: Vec::new(),
            joints: &[],
            near_misses: &[],
            objects: true,
            legend: true,
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
/// [`DrawError`] for a table in space, cells, objects or portals that do not exist, an unusable size or point.
pub fn plan_svg(table: &Table, options: &DrawOptions<'_>) -> Result<String, DrawError> {
    Ok(plan_drawing(table, options)?.to_svg())
}

/// The picture of [`plan_svg`], to be put beside others.
///
/// # Errors
/// As for [`plan_svg`].
pub fn plan_drawing(table: &Table, options: &DrawOptions<'_>) -> Result<Drawing, DrawError> {
    check(table, options)?;
    let figure = Figure::of_plan(table);
    let sight = options.sight.as_ref().filter(|_| matches!(options.view, PictureSubject::Eye(_)));
    let (seen, eye) = match options.view {
        PictureSubject::Plan => (None, None),
        PictureSubject::Cell(cell) => (Some(VisibleSet::from_cell(table, cell)), None),
        PictureSubject::Eye(eye) => (Some(VisibleSet::from_point(table, [eye.x, eye.y, 0.0])), Some(eye)),
    };
    let seen = match (seen, sight) {
        (Some(seen), Some(sight)) => Some(seen.narrowed(sight)),
        (seen, _) => seen,
    };
    let annotations = Annotations {
        target: options.target,
        portals: &options.marked_portals,
        line: options.line,
        eye,
        looks: sight.and_then(|sight| sight.looks),
        rings: [options.joints, options.near_misses],
    };
    let title = match options.view {
        PictureSubject::Plan => "Cells and portals".to_owned(),
        PictureSubject::Cell(cell) => svg::seen_from_cell(cell),
        PictureSubject::Eye(eye) => svg::seen_from_point(&[eye.x, eye.y], sight.is_some()),
    };
    let look = Look { objects: options.objects, group_colours: options.group_colours, legend: options.legend };
    Ok(draw(title, &figure, seen.as_ref(), &annotations, look, options.size))
}

fn check(table: &Table, options: &DrawOptions<'_>) -> Result<(), DrawError> {
    if table.dimension() != 2 {
        return Err(DrawError::NotPlanar(table.dimension()));
    }
    let from = if let PictureSubject::Cell(cell) = options.view { Some(cell) } else { None };
    check_cells(table, [from, options.target].into_iter().flatten())?;
    let n_portals = table.portals().len();
    if let Some(&portal) = options.marked_portals.iter().find(|&&portal| portal >= n_portals) {
        return Err(DrawError::NoSuchPortal { portal, n_portals });
    }
    check_size(options.size)?;
    check_sight(table, options.sight.as_ref())?;
    let eye = if let PictureSubject::Eye(eye) = options.view { Some(eye) } else { None };
    let direction = options.sight.and_then(|sight| sight.looks).map(|(direction, _)| direction);
    let rings = options.joints.iter().chain(options.near_misses).copied();
    let finite = options.line.into_iter().flatten().chain(eye).chain(direction).chain(rings).all(Point2::is_finite);
    if finite { Ok(()) } else { Err(DrawError::NotFinite) }
}
