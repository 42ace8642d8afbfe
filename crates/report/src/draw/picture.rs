//! The drawing of a planar figure.

use super::figure::{Figure, Shape};
use super::svg::{self, fill, stroke};
use super::visible_set::VisibleSet;
use crate::frame::{Frame, Px};
use crate::theme::{self, Strokes};
use sightlines_geometry::{Aabb, Point2, signed_area};
use sightlines_pvs::CellId;
use std::fmt::Write;

/// What is marked in a picture.
#[derive(Debug, Default)]
pub(super) struct Annotations<'a> {
    /// The cell looked for.
    pub(super) target: Option<CellId>,
    /// Indices of portals.
    pub(super) portals: &'a [usize],
    /// A line of sight.
    pub(super) line: Option<[Point2; 2]>,
    /// Where the viewer is.
    pub(super) eye: Option<Point2>,
}

/// A picture while it is drawn.
pub(super) struct Picture<'a> {
    figure: &'a Figure,
    frame: Frame,
    strokes: Strokes,
    /// `None` for a plan alone.
    seen: Option<&'a VisibleSet>,
}

impl<'a> Picture<'a> {
    /// A picture of which the longer side has `size` pixels.
    pub(super) fn new(figure: &'a Figure, seen: Option<&'a VisibleSet>, size: u32) -> Self {
        let frame = Frame::around(figure.bounds(), size);
        let area: f64 = figure.cells.iter().map(|c| signed_area(&c.corners)).sum();
        let cell = (frame.area(area) / (figure.cells.len().max(1) as f64)).sqrt();
        Self { figure, frame, strokes: Strokes::for_cells(cell, f64::from(size)), seen }
    }

    /// The whole picture.
    pub(super) fn draw(
        &self,
        title: &str,
        annotations: &Annotations<'_>,
        objects: bool,
        group_colours: bool,
    ) -> String {
        let mut out = svg::open(title, [self.frame.width, self.frame.height]);
        self.fills(&mut out, annotations.target, group_colours);
        self.lines(&mut out);
        if objects {
            self.objects(&mut out);
        }
        self.annotations(&mut out, annotations);
        out.push_str(svg::CLOSE);
        out
    }

    /// The cells, one path for each colour: cells that share a side leave no seam in a common path.
    fn fills(&self, out: &mut String, target: Option<CellId>, group_colours: bool) {
        let chosen = |keep: &dyn Fn(&Shape) -> bool| {
            let mut path = String::new();
            for cell in self.figure.cells.iter().filter(|cell| keep(cell)) {
                self.frame.polygon(&mut path, &cell.corners);
            }
            path
        };
        let base = if self.seen.is_some() { theme::HIDDEN } else { theme::CELL };
        fill(out, &chosen(&|_| true), base);
        if let Some(seen) = self.seen {
            fill(out, &chosen(&|cell| seen.sees(cell.id)), theme::SEEN);
        } else if group_colours {
            let n = theme::GROUPS.len();
            for (k, colour) in theme::GROUPS.iter().enumerate() {
                fill(out, &chosen(&|cell| cell.group.is_some_and(|g| g as usize % n == k)), colour);
            }
        }
        // Bordered too, so that a tiny cell is found in a large plan.
        for (path, colour) in [
            (chosen(&|cell| target == Some(cell.id)), theme::TARGET),
            (chosen(&|cell| self.seen.is_some_and(|seen| seen.is_from(cell.id))), theme::FROM),
        ] {
            fill(out, &path, colour);
            stroke(out, &path, colour, self.strokes.mark);
        }
    }

    fn lines(&self, out: &mut String) {
        let (mut doors, mut closed) = (String::new(), String::new());
        for (_, door) in &self.figure.doors {
            self.frame.polyline(&mut doors, &[door.a, door.b]);
        }
        for wall in &self.figure.walls {
            self.frame.polyline(&mut closed, &[wall.a, wall.b]);
        }
        let colour = if self.seen.is_some() { theme::PORTAL_FAINT } else { theme::PORTAL };
        stroke(out, &doors, colour, self.strokes.portal);
        stroke(out, &closed, theme::WALL, self.strokes.wall);
    }

    /// Objects as small boxes, those that are not seen fainter.
    fn objects(&self, out: &mut String) {
        let (mut shown, mut hidden) = (String::new(), String::new());
        for (id, bounds) in &self.figure.objects {
            let is_seen = self.seen.is_none_or(|seen| seen.sees_object(*id));
            self.object(if is_seen { &mut shown } else { &mut hidden }, bounds);
        }
        let width = self.strokes.portal;
        for (path, colour) in [(hidden, theme::OBJECT_HIDDEN), (shown, theme::OBJECT)] {
            if !path.is_empty() {
                let _ = writeln!(
                    out,
                    "<path d=\"{path}\" fill=\"{colour}\" fill-opacity=\".45\" stroke=\"{colour}\" \
                     stroke-width=\"{}\"/>",
                    Px(width)
                );
            }
        }
    }

    fn object(&self, path: &mut String, bounds: &Aabb<2>) {
        let [x0, y1] = self.frame.place(bounds.min.into());
        let [x1, y0] = self.frame.place(bounds.max.into());
        // A point is drawn as a small diamond; a box as it is, but never thinner than can be seen.
        let least = self.strokes.mark;
        if x1 - x0 < least && y1 - y0 < least {
            let (x, y, r) = (0.5 * (x0 + x1), 0.5 * (y0 + y1), least);
            let _ = write!(path, "M{} {}L{} {}", Px(x - r), Px(y), Px(x), Px(y - r));
            let _ = write!(path, "L{} {}L{} {}Z", Px(x + r), Px(y), Px(x), Px(y + r));
        } else {
            let _ = write!(path, "M{} {}H{}V{}H{}Z", Px(x0), Px(y0), Px(x1), Px(y1), Px(x0));
        }
    }

    /// Rings around cells too thin to be seen, marked doors, the line of sight, the eye.
    fn annotations(&self, out: &mut String, annotations: &Annotations<'_>) {
        for cell in &self.figure.cells {
            if annotations.target == Some(cell.id) {
                self.ring_if_thin(out, cell, theme::TARGET);
            }
        }
        for cell in self.figure.cells.iter().filter(|cell| self.seen.is_some_and(|seen| seen.is_from(cell.id))) {
            self.ring_if_thin(out, cell, theme::FROM);
        }
        let mut doors = String::new();
        for &portal in annotations.portals {
            // Doors are in the order of their portals.
            if let Ok(i) = self.figure.doors.binary_search_by_key(&portal, |(id, _)| *id) {
                let door = self.figure.doors[i].1;
                self.frame.polyline(&mut doors, &[door.a, door.b]);
            }
        }
        stroke(out, &doors, theme::SIGHTLINE, self.strokes.wall * 1.2);
        if let Some(line) = annotations.line {
            let mut path = String::new();
            self.frame.polyline(&mut path, &line);
            stroke(out, &path, theme::PAPER, 2.2 * self.strokes.line);
            stroke(out, &path, theme::SIGHTLINE, self.strokes.line);
        }
        for point in annotations.line.into_iter().flatten().chain(annotations.eye) {
            svg::dot(out, self.frame.place(point), self.strokes.mark, theme::SIGHTLINE);
        }
    }

    fn ring_if_thin(&self, out: &mut String, cell: &Shape, colour: &str) {
        let bounds = Aabb::around(cell.corners.iter().map(|p| [p.x, p.y]));
        let [x0, y1] = self.frame.place(bounds.min.into());
        let [x1, y0] = self.frame.place(bounds.max.into());
        let least = self.strokes.wall.max(self.strokes.mark);
        if (x1 - x0).min(y1 - y0) > 2.0 * least {
            return;
        }
        let [x, y, r] = [0.5 * (x0 + x1), 0.5 * (y0 + y1), 4.0 * self.strokes.mark].map(Px);
        for (colour, width) in [(theme::PAPER, 2.0 * least), (colour, least)] {
            let _ = writeln!(
                out,
                "<circle cx=\"{x}\" cy=\"{y}\" r=\"{r}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{}\"/>",
                Px(width)
            );
        }
    }
}
