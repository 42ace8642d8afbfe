//! Isometric views of the cells of a scene in space.

use super::legend::{Entry, Swatch};
use super::order::back_to_front;
use super::raster::{Raster, points_below};
use super::section::Section;
use super::slice::{Looked, look, title};
use super::space::{Up, project};
use super::svg::{self, stroke};
use super::visible_set::VisibleSet;
use super::{DrawError, Drawing, PictureSubject, SeenFromEye, Surfaces, check_cells};
use crate::frame::{Frame, Px};
use crate::theme;
use sightlines_geometry::{Aabb, Point2};
use sightlines_pvs::{CellId, Place, PlaceBuffer, Table};
use std::fmt::Write;

/// How to draw an isometric view.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IsometricOptions<'a> {
    /// Whose visible set is shown.
    pub view: PictureSubject<[f64; 3]>,
    /// With [`PictureSubject::Eye`]: what the viewer sees of that.
    pub sight: Option<SeenFromEye<'a, [f64; 3]>>,
    /// Which way is up.
    pub up: Up,
    /// Where to cut off what is above, as a coordinate on the axis that points up, in scene units.
    pub below: Option<f64>,
    /// The scene that the table was made of: its surfaces are drawn in place of the cells.
    pub surfaces: Option<&'a Surfaces>,
    /// A cell to mark as the one looked for.
    pub target: Option<CellId>,
    /// A line of sight, along the axes of the table, drawn over all that is before it.
    pub line: Option<[[f64; 3]; 2]>,
    /// Polygons to outline, such as the portals that the line passes, or what blocks all lines; along the axes of the table.
    pub marked: &'a [Vec<[f64; 3]>],
    /// Whether a legend and a scale bar, for lengths along the axes, stand below, if there is room for words.
    pub legend: bool,
    /// The longer side of the picture in pixels, from [`MIN_SIZE`](super::MIN_SIZE) to
    /// [`MAX_SIZE`](super::MAX_SIZE).
    pub size: u32,
}

impl Default for IsometricOptions<'_> {
    /// All cells alone, y up, with a legend, 1600 pixels.
    fn default() -> Self {
        Self {
            view: PictureSubject::Plan,
            sight: None,
            up: Up::Y,
            below: None,
            surfaces: None,
            target: None,
            line: None,
            marked: &[],
            legend: true,
            size: 1600,
        }
    }
}

/// Draws a table in space in SVG, for a viewer on the positive side of all axes. O(n log n) for n cells, as a rule, and the pixels.
///
/// * Without [`IsometricOptions::surfaces`] the cells are boxes: the three faces that look at the viewer, opaque, from back to front. What
///   is seen from a cell or a point is coloured, and all else is grey; what is seen and lies behind other cells shows faintly.
/// * With them the surfaces are drawn, as pixels in PNG within the SVG, so that it does not grow with their number: shaded, and in the
///   colour of the cell in front of them. Single-sided surfaces are left out from behind, so that one looks into rooms. Where the height
///   cuts them, there is a line.
///
/// # Errors
/// [`DrawError`] for a table of a plan, a cell that does not exist, nothing below the height, an unusable
/// size or point.
pub fn isometric_svg(table: &Table, options: &IsometricOptions<'_>) -> Result<String, DrawError> {
    Ok(isometric_drawing(table, options)?.to_svg())
}

/// The picture of [`isometric_svg`], to be put beside others.
///
/// # Errors
/// As for [`isometric_svg`].
pub fn isometric_drawing(table: &Table, options: &IsometricOptions<'_>) -> Result<Drawing, DrawError> {
    let IsometricOptions { view, sight, up, below, surfaces, target, line: sightline, marked, legend, size } = *options;
    let Looked { seen, eye, .. } = look(table, view, sight, size)?;
    check_cells(table, target)?;
    let points = || sightline.iter().flatten().chain(marked.iter().flatten());
    if below.is_some_and(|height| !height.is_finite()) || !points().flatten().all(|x| x.is_finite()) {
        return Err(DrawError::NotFinite);
    }
    let (ids, boxes) = shown(table, up, below);
    if let Some(height) = below.filter(|_| ids.is_empty()) {
        let low = table.cells().iter().map(|c| c.min[up.axis()]).fold(f64::INFINITY, f64::min);
        let high = table.cells().iter().map(|c| c.max[up.axis()]).fold(f64::NEG_INFINITY, f64::max);
        return Err(DrawError::NoCellAt { height, low, high });
    }
    let of_boxes = || Aabb::around(boxes.iter().flat_map(|b| outline(b, up)).map(|p| [p.x, p.y]));
    let of_surfaces = surfaces.map(|surfaces| {
        let points = points_below(surfaces.along(table), up, below);
        Aabb::around(points.map(|p| [p.x, p.y]))
    });
    let bounds = of_surfaces.filter(|bounds| !bounds.is_empty()).unwrap_or_else(of_boxes);
    let bounds = bounds.united(Aabb::around(points().map(|&p| project(p, up)).map(|p| [p.x, p.y])));
    let look_of = |id: CellId| if target == Some(id) { Look::Target } else { Look::of(id, seen.as_ref()) };
    let looks: Vec<Look> = ids.iter().map(|&id| look_of(id)).collect();
    let mut entries = Look::entries(&looks, seen.as_ref().is_some_and(VisibleSet::is_narrowed));
    let cut = surfaces
        .zip(below)
        .map(|(surfaces, height)| Section::of(surfaces.along(table), up, |p| project(p, up), height, seen.as_ref()));
    let line = 0.6 * (f64::from(size) / 500.0);
    if surfaces.is_some() {
        entries.push(Entry::area(theme::SURFACE_OUTSIDE, "outside every cell"));
    }
    if cut.as_ref().is_some_and(|cut| !cut.lines.is_empty()) {
        entries.push(Entry { swatch: Swatch::Line(theme::WALL, line), label: "where the height cuts surfaces" });
    }
    if !marked.is_empty() {
        let label = if sightline.is_some() { "portals on the line" } else { "what blocks every line" };
        entries.push(Entry { swatch: Swatch::Line(theme::SIGHTLINE, line), label });
    }
    if sightline.is_some() {
        entries.push(Entry { swatch: Swatch::Line(theme::SIGHTLINE, 2.0 * line), label: "a line of sight" });
    }
    if eye.is_some() {
        entries.push(Entry { swatch: Swatch::Dot(theme::SIGHTLINE), label: "the viewer" });
    }
    let title = match below {
        Some(height) => format!("{}, cut at height {}", title(view, seen.as_ref()), svg::short(height)),
        None => title(view, seen.as_ref()),
    };
    let mut drawing = Drawing::new(title, bounds, size, entries, legend);
    let frame = drawing.frame();
    let out = drawing.body();
    match surfaces {
        None => solid(out, &frame, up, (&boxes, &looks), size),
        Some(surfaces) => {
            let raster = Raster::of(surfaces.along(table), &frame, up, below);
            let mut places = PlaceBuffer::new();
            let image = raster.image(|p| colour_at(table, seen.as_ref(), p, &mut places));
            out.push_str(&image.unwrap_or_default());
            if let Some(cut) = cut {
                stroke(out, &frame.lines(cut.lines.iter().map(|(_, line)| *line)), theme::WALL, line);
            }
        }
    }
    let mut path = String::new();
    for polygon in marked {
        let corners: Vec<Point2> = polygon.iter().map(|&p| project(p, up)).collect();
        frame.polygon(&mut path, &corners);
    }
    stroke(out, &path, theme::SIGHTLINE, line);
    if let Some(ends) = sightline.map(|ends| ends.map(|p| project(p, up))) {
        let mut path = String::new();
        frame.polyline(&mut path, &ends);
        stroke(out, &path, theme::PAPER, 4.0 * line);
        stroke(out, &path, theme::SIGHTLINE, 2.0 * line);
        ends.iter().for_each(|&p| svg::dot(out, frame.place(p), f64::from(size) / 250.0, theme::SIGHTLINE));
    }
    if let Some(eye) = eye {
        svg::dot(out, frame.place(project(eye, up)), f64::from(size) / 200.0, theme::SIGHTLINE);
    }
    Ok(drawing)
}

/// The colour of what a point along the axes of the table is in front of, by what is seen of the cells there.
fn colour_at(table: &Table, seen: Option<&VisibleSet>, p: [f64; 3], places: &mut PlaceBuffer) -> [u8; 3] {
    let p = table.frame().map_or(p, |frame| frame.to_scene(p));
    let Place::Inside(cells) = table.cells_at(p, places) else { return rgb(theme::SURFACE_OUTSIDE) };
    // Of several cells, at a border, the one of which most is to be told.
    let look = cells.iter().map(|&cell| Look::of(cell, seen)).min().unwrap_or(Look::Hidden);
    rgb(look.colour())
}

/// The three parts of a colour of six digits.
fn rgb(colour: &str) -> [u8; 3] {
    let part = |k: usize| colour.get(2 * k + 1..2 * k + 3).and_then(|part| u8::from_str_radix(part, 16).ok());
    std::array::from_fn(|k| part(k).unwrap_or_default())
}

/// Draws cells as opaque boxes from back to front, and then faintly those that are seen.
fn solid(out: &mut String, frame: &Frame, up: Up, (boxes, looks): (&[Aabb<3>], &[Look]), size: u32) {
    let width = 0.6 * (f64::from(size) / 1600.0).max(0.5);
    let _ = writeln!(out, "<g stroke=\"{}\" stroke-width=\"{}\">", theme::EDGE_HIDDEN, Px(width));
    for i in back_to_front(boxes) {
        draw(out, frame, &boxes[i], up, looks[i]);
    }
    out.push_str("</g>\n");
    for (look, opacity) in [(Look::VisibleSet, ".12"), (Look::From, ".5"), (Look::Target, ".5")] {
        let mut path = String::new();
        for (b, _) in boxes.iter().zip(looks).filter(|(_, of)| **of == look) {
            frame.polygon(&mut path, &outline(b, up));
        }
        if !path.is_empty() {
            let colour = look.colour();
            let _ = writeln!(out, "<path d=\"{path}\" fill=\"{colour}\" fill-opacity=\"{opacity}\"/>");
        }
    }
}

/// The cells that begin below a height, cut there.
fn shown(table: &Table, up: Up, below: Option<f64>) -> (Vec<CellId>, Vec<Aabb<3>>) {
    let cells = (0u32..).map(CellId).zip(table.cells());
    let cut = |(id, cell): (CellId, &sightlines_pvs::CellRecord)| {
        let mut b = Aabb { min: cell.min, max: cell.max };
        if let Some(height) = below {
            b.max[up.axis()] = b.max[up.axis()].min(height);
        }
        (b.min[up.axis()] < b.max[up.axis()]).then_some((id, b))
    };
    cells.filter_map(cut).unzip()
}

/// A corner of a box: on the high side or not, to the right, to the left, and upwards.
fn corner(b: &Aabb<3>, up: Up, high: [bool; 3]) -> Point2 {
    let [right, left] = up.sideways();
    let mut p = b.min;
    for (axis, high) in [right, left, up.axis()].into_iter().zip(high) {
        p[axis] = if high { b.max[axis] } else { b.min[axis] };
    }
    project(p, up)
}

/// The six corners around a box as it is seen.
fn outline(b: &Aabb<3>, up: Up) -> [Point2; 6] {
    let (below, above) = ([true, false, false], [false, true, true]);
    [below, [true, false, true], [false, false, true], above, [false, true, false], [true, true, false]]
        .map(|high| corner(b, up, high))
}

/// How a cell is drawn; the first is what is told of a border between cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Look {
    From,
    Target,
    VisibleSet,
    /// Seen by the viewer's cell, and not by the viewer.
    OfCell,
    Hidden,
    /// Its visibility is not shown.
    Plain,
}

impl Look {
    fn of(cell: CellId, seen: Option<&VisibleSet>) -> Self {
        match seen {
            None => Self::Plain,
            Some(seen) if seen.is_from(cell) => Self::From,
            Some(seen) if seen.is_in_sight(cell) => Self::VisibleSet,
            Some(seen) if seen.sees(cell) => Self::OfCell,
            Some(_) => Self::Hidden,
        }
    }

    /// What the colours mean; only of what is there.
    fn entries(looks: &[Self], is_narrowed: bool) -> Vec<Entry> {
        let (from, in_sight) =
            if is_narrowed { ("the viewer's cell", "seen by the viewer") } else { ("the cell", "seen from the cell") };
        let all = [
            (Self::Plain, "cells"),
            (Self::From, from),
            (Self::Target, "the cell looked for"),
            (Self::VisibleSet, in_sight),
            (Self::OfCell, "seen from elsewhere in that cell"),
            (Self::Hidden, "not seen"),
        ];
        let there = all.into_iter().filter(|(look, _)| looks.contains(look));
        there.map(|(look, label)| Entry::area(look.colour(), label)).collect()
    }

    fn colour(self) -> &'static str {
        self.shades()[2]
    }

    /// The shades of the top, of the face to the left and of that to the right.
    fn shades(self) -> [&'static str; 3] {
        match self {
            Self::Plain => theme::CELL_SHADES,
            Self::From => theme::FROM_SHADES,
            Self::Target => theme::TARGET_SHADES,
            Self::VisibleSet => theme::SEEN_SHADES,
            Self::OfCell => theme::SEEN_BY_CELL_SHADES,
            Self::Hidden => theme::HIDDEN_SHADES,
        }
    }
}

fn draw(out: &mut String, frame: &Frame, b: &Aabb<3>, up: Up, look: Look) {
    // The corner nearest to the viewer belongs to all three faces.
    let near = [true, true, true];
    let faces = [
        [near, [true, false, true], [false, false, true], [false, true, true]],
        [near, [false, true, true], [false, true, false], [true, true, false]],
        [near, [true, true, false], [true, false, false], [true, false, true]],
    ];
    for (face, shade) in faces.into_iter().zip(look.shades()) {
        let mut path = String::new();
        frame.polygon(&mut path, &face.map(|high| corner(b, up, high)));
        let _ = writeln!(out, "<path d=\"{path}\" fill=\"{shade}\"/>");
    }
}
