//! Floor plans of scenes in space.

use super::figure::Figure;
use super::picture::{Annotations, Look, draw};
use super::section::Section;
use super::space::Up;
use super::visible_set::VisibleSet;
use super::{DrawError, Drawing, PictureSubject, SeenFromEye, Surfaces, check_cells, check_sight, check_size, svg};
use sightlines_geometry::Point2;
use sightlines_pvs::{CellId, Table};

/// How to draw a floor plan of a scene in space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SliceOptions<'a> {
    /// Whose visible set is shown; the viewer may be at another height.
    pub view: PictureSubject<[f64; 3]>,
    /// With [`PictureSubject::Eye`]: what the viewer sees of that, drawn over it.
    pub sight: Option<SeenFromEye<'a, [f64; 3]>>,
    /// Which way is up.
    pub up: Up,
    /// Where to cut, as a coordinate on the axis that points up, in scene units.
    pub height: f64,
    /// A line of sight to draw, as it is seen from above, in scene units; it may be at other heights.
    pub line: Option<[[f64; 3]; 2]>,
    /// A cell to mark as the one looked for.
    pub target: Option<CellId>,
    /// Indices of portals to mark, such as those that the line passes; those at other heights are not drawn.
    pub marked_portals: &'a [usize],
    /// The scene that the table was made of: what the plane cuts of it is drawn in place of the walls that the cells tell of.
    pub surfaces: Option<&'a Surfaces>,
    /// Whether a legend and a scale bar stand below, if there is room for words.
    pub legend: bool,
    /// The longer side of the picture in pixels, from [`MIN_SIZE`](super::MIN_SIZE) to
    /// [`MAX_SIZE`](super::MAX_SIZE).
    pub size: u32,
}

impl Default for SliceOptions<'_> {
    /// The cells alone at height 0, y up, with a legend, 1600 pixels.
    fn default() -> Self {
        Self {
            view: PictureSubject::Plan,
            sight: None,
            up: Up::Y,
            height: 0.0,
            line: None,
            target: None,
            marked_portals: &[],
            surfaces: None,
            legend: true,
            size: 1600,
        }
    }
}

/// Draws the cells that a horizontal plane cuts as SVG, seen from above: cells light, walls dark where a
/// cell has no portal, solid matter blank, and what is seen from a cell or a point. A plane on the border of
/// two storeys shows the upper one. With [`SliceOptions::surfaces`] the lines are those in which the plane cuts the triangles of the
/// scene, slanted ones too; triangles in the plane are filled. Else objects are not drawn. O(table + surfaces).
///
/// # Errors
/// [`DrawError`] for a table of a plan, a cell that does not exist, a height without cells, an unusable size
/// or point.
pub fn slice_svg(table: &Table, options: &SliceOptions<'_>) -> Result<String, DrawError> {
    Ok(slice_drawing(table, options)?.to_svg())
}

/// The picture of [`slice_svg`], to be put beside others.
///
/// # Errors
/// As for [`slice_svg`].
pub fn slice_drawing(table: &Table, options: &SliceOptions<'_>) -> Result<Drawing, DrawError> {
    let SliceOptions { view, sight, up, height, line, target, marked_portals, surfaces, legend, size } = *options;
    let Looked { seen, eye, looks } = look(table, view, sight, size)?;
    check_cells(table, target)?;
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
    let figure = match surfaces {
        Some(surfaces) => figure.with_section(Section::of(surfaces.along(table), up, on_floor, height, seen.as_ref())),
        None => figure,
    };
    let annotations = Annotations {
        target,
        portals: marked_portals,
        eye: eye.map(on_floor),
        line: line.map(|ends| ends.map(on_floor)),
        looks: looks.map(|(direction, angle)| (on_floor(direction), angle)),
        rings: [&[]; 2],
    };
    let title = format!("{} at height {}", title(view, seen.as_ref()), svg::short(height));
    let look = Look { objects: false, group_colours: true, legend };
    Ok(draw(title, &figure, seen.as_ref(), &annotations, look, size))
}

/// What a picture of a scene in space is called.
pub(super) fn title(view: PictureSubject<[f64; 3]>, seen: Option<&VisibleSet>) -> String {
    match view {
        PictureSubject::Plan => "Cells".to_owned(),
        PictureSubject::Cell(cell) => svg::seen_from_cell(cell),
        PictureSubject::Eye(eye) => svg::seen_from_point(&eye, seen.is_some_and(VisibleSet::is_narrowed)),
    }
}

/// What is seen, and from where; along the axes of the table.
#[derive(Debug, Default)]
pub(super) struct Looked {
    pub(super) seen: Option<VisibleSet>,
    pub(super) eye: Option<[f64; 3]>,
    pub(super) looks: Option<([f64; 3], f64)>,
}

/// Checks what all pictures of scenes in space have in common; what is seen, and the viewer.
pub(super) fn look(
    table: &Table,
    view: PictureSubject<[f64; 3]>,
    sight: Option<SeenFromEye<'_, [f64; 3]>>,
    size: u32,
) -> Result<Looked, DrawError> {
    if table.dimension() != 3 {
        return Err(DrawError::NotSpatial(table.dimension()));
    }
    check_size(size)?;
    match view {
        PictureSubject::Plan => Ok(Looked::default()),
        PictureSubject::Cell(cell) => {
            check_cells(table, [cell])?;
            Ok(Looked { seen: Some(VisibleSet::from_cell(table, cell)), ..Looked::default() })
        }
        PictureSubject::Eye(eye) => {
            check_sight(table, sight.as_ref())?;
            let looks = sight.and_then(|sight| sight.looks);
            if !eye.iter().chain(looks.iter().flat_map(|(direction, _)| direction)).all(|x| x.is_finite()) {
                return Err(DrawError::NotFinite);
            }
            // Pictures are along the axes of the table.
            let along = |p: [f64; 3]| table.frame().map_or(p, |frame| frame.to_frame(p));
            let seen = VisibleSet::from_point(table, eye);
            let seen = if let Some(sight) = &sight { seen.narrowed(sight) } else { seen };
            Ok(Looked { seen: Some(seen), eye: Some(along(eye)), looks: looks.map(|(to, angle)| (along(to), angle)) })
        }
    }
}
