//! Isometric views of the cells of a scene in space.

use super::legend::Entry;
use super::order::back_to_front;
use super::slice::{Looked, look, title};
use super::space::Up;
use super::visible_set::VisibleSet;
use super::{DrawError, Drawing, Sight, View, svg};
use crate::frame::{Frame, Px};
use crate::theme;
use sightlines_geometry::{Aabb, Point2};
use sightlines_pvs::{CellId, Table};
use std::fmt::Write;

/// How to draw an isometric view.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IsometricOptions<'a> {
    /// Whose visible set is shown.
    pub view: View<[f64; 3]>,
    /// With [`View::Eye`]: what the viewer sees of that.
    pub sight: Option<Sight<'a, [f64; 3]>>,
    /// Which way is up.
    pub up: Up,
    /// Where to cut off what is above, as a coordinate on the axis that points up, in scene units.
    pub below: Option<f64>,
    /// Whether a legend and a scale bar, for lengths along the axes, stand below, if there is room for words.
    pub legend: bool,
    /// The longer side of the picture in pixels, from [`MIN_SIZE`](super::MIN_SIZE) to
    /// [`MAX_SIZE`](super::MAX_SIZE).
    pub size: u32,
}

impl Default for IsometricOptions<'_> {
    /// All cells alone, y up, with a legend, 1600 pixels.
    fn default() -> Self {
        Self { view: View::Plan, sight: None, up: Up::Y, below: None, legend: true, size: 1600 }
    }
}

/// Draws the cells of a table in space as boxes in SVG, for a viewer on the positive side of all axes: the
/// three faces that look at the viewer, from back to front, translucent, so that the inside shows. What is
/// seen from a cell or a point is coloured; then all else is drawn as thin edges only. O(n log n) for n
/// cells, as a rule.
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
    let IsometricOptions { view, sight, up, below, legend, size } = *options;
    let Looked { seen, eye, .. } = look(table, view, sight, size)?;
    if below.is_some_and(|height| !height.is_finite()) {
        return Err(DrawError::NotFinite);
    }
    let (ids, boxes) = shown(table, up, below);
    if let Some(height) = below.filter(|_| ids.is_empty()) {
        let low = table.cells().iter().map(|c| c.min[up.axis()]).fold(f64::INFINITY, f64::min);
        let high = table.cells().iter().map(|c| c.max[up.axis()]).fold(f64::NEG_INFINITY, f64::max);
        return Err(DrawError::NoCellAt { height, low, high });
    }
    let bounds = Aabb::around(boxes.iter().flat_map(|b| outline(b, up)).map(|p| [p.x, p.y]));
    let looks: Vec<Look> = ids.iter().map(|&id| Look::of(id, seen.as_ref())).collect();
    let entries = Look::entries(&looks, seen.as_ref().is_some_and(VisibleSet::is_narrowed));
    let mut drawing = Drawing::new(title(view, seen.as_ref()), bounds, size, entries, legend);
    let frame = drawing.frame();
    let out = drawing.body();
    for i in back_to_front(&boxes) {
        draw(out, &frame, &boxes[i], up, looks[i], size);
    }
    if let Some(eye) = eye {
        svg::dot(out, frame.place(project(eye, up)), f64::from(size) / 320.0, theme::SIGHTLINE);
    }
    Ok(drawing)
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

/// Cosine of 30 degrees, rounded; a picture is not a predicate.
const COS_30: f64 = 0.866_025_403_784_438_6;

/// A point in the plane of the picture: all three axes are equally short.
fn project(p: [f64; 3], up: Up) -> Point2 {
    let [right, left] = up.sideways().map(|axis| p[axis]);
    Point2::new((right - left) * COS_30, p[up.axis()] - 0.5 * (right + left))
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

/// How a cell is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Look {
    /// Its visibility is not shown.
    Plain,
    From,
    VisibleSet,
    /// Seen by the viewer's cell, and not by the viewer.
    OfCell,
    Hidden,
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
            (Self::Plain, Entry::area(theme::CELL_SHADES[1], "cells")),
            (Self::From, Entry::area(theme::FROM, from)),
            (Self::VisibleSet, Entry::area(theme::SEEN, in_sight)),
            (Self::OfCell, Entry::area(theme::SEEN_BY_CELL, "seen from elsewhere in that cell")),
            (Self::Hidden, Entry::area(theme::PAPER, "not seen")),
        ];
        all.into_iter().filter(|(look, _)| looks.contains(look)).map(|(_, entry)| entry).collect()
    }

    /// The shades of the top, of the face to the left and of that to the right, and how opaque they are.
    fn shades(self) -> Option<([&'static str; 3], &'static str)> {
        match self {
            Self::Plain => Some((theme::CELL_SHADES, ".45")),
            Self::From => Some((theme::FROM_SHADES, ".85")),
            Self::VisibleSet => Some((theme::SEEN_SHADES, ".3")),
            Self::OfCell => Some((theme::SEEN_SHADES, ".1")),
            Self::Hidden => None,
        }
    }

    /// Colour and width of the edges, in a picture of `size` pixels.
    fn edge(self, size: u32) -> (&'static str, f64) {
        let (colour, width) = if self == Self::Hidden { (theme::EDGE_HIDDEN, 0.5) } else { (theme::EDGE, 0.9) };
        (colour, width * (f64::from(size) / 1600.0).max(0.5))
    }
}

fn draw(out: &mut String, frame: &Frame, b: &Aabb<3>, up: Up, look: Look, size: u32) {
    // The corner nearest to the viewer belongs to all three faces.
    let near = [true, true, true];
    let faces = [
        [near, [true, false, true], [false, false, true], [false, true, true]],
        [near, [false, true, true], [false, true, false], [true, true, false]],
        [near, [true, true, false], [true, false, false], [true, false, true]],
    ];
    let mut edges = String::new();
    for (k, face) in faces.into_iter().enumerate() {
        let mut path = String::new();
        frame.polygon(&mut path, &face.map(|high| corner(b, up, high)));
        if let Some((shades, opacity)) = look.shades() {
            let _ = writeln!(out, "<path d=\"{path}\" fill=\"{}\" fill-opacity=\"{opacity}\"/>", shades[k]);
        }
        edges.push_str(&path);
    }
    let (colour, width) = look.edge(size);
    let _ = writeln!(
        out,
        "<path d=\"{edges}\" fill=\"none\" stroke=\"{colour}\" stroke-opacity=\".5\" stroke-width=\"{}\"/>",
        Px(width)
    );
}
