//! The drawing of a planar figure.

use super::Drawing;
use super::figure::{Figure, Shape};
use super::legend::{Entry, Swatch};
use super::section::{Kind, Section};
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
    /// Where they look, and the angle of view in radians.
    pub(super) looks: Option<(Point2, f64)>,
    /// Where walls were joined, and where they nearly meet.
    pub(super) rings: [&'a [Point2]; 2],
}

/// What is drawn besides the cells and what is seen.
#[derive(Debug, Clone, Copy)]
pub(super) struct Look {
    pub(super) objects: bool,
    pub(super) group_colours: bool,
    pub(super) legend: bool,
}

/// Draws a figure; the longer side of the picture has `size` pixels.
pub(super) fn draw(
    title: String,
    figure: &Figure,
    seen: Option<&VisibleSet>,
    annotations: &Annotations<'_>,
    look: Look,
    size: u32,
) -> Drawing {
    let strokes = |frame: Frame| {
        let area: f64 = figure.cells.iter().map(|c| signed_area(&c.corners)).sum();
        let cell = (frame.area(area) / (figure.cells.len().max(1) as f64)).sqrt();
        Strokes::for_cells(cell, f64::from(size))
    };
    let bounds = figure.bounds();
    let about =
        Picture { figure, frame: Frame::around(bounds, size), strokes: strokes(Frame::around(bounds, size)), seen };
    let mut drawing = Drawing::new(title, bounds, size, about.entries(annotations, look), look.legend);
    let frame = drawing.frame();
    let picture = Picture { figure, frame, strokes: strokes(frame), seen };
    let out = drawing.body();
    picture.fills(out, annotations.target, look.group_colours);
    picture.lines(out);
    if look.objects {
        picture.objects(out);
    }
    picture.annotations(out, annotations);
    drawing
}

/// The colour of a cut surface.
fn colour_of(kind: Kind) -> &'static str {
    match kind {
        Kind::Seen => theme::WALL,
        Kind::Hidden => theme::SURFACE_HIDDEN,
        Kind::SeeThrough => theme::SEE_THROUGH,
    }
}

/// The rings of [`Annotations::rings`].
const RINGS: [(&str, &str); 2] =
    [(theme::PORTAL, "ends of walls that are joined"), (theme::TARGET, "ends of walls that nearly meet others")];

/// Which cells are meant.
type Keep<'a> = &'a dyn Fn(CellId) -> bool;

/// A picture while it is drawn.
struct Picture<'a> {
    figure: &'a Figure,
    frame: Frame,
    strokes: Strokes,
    /// `None` for a plan alone.
    seen: Option<&'a VisibleSet>,
}

impl Picture<'_> {
    /// What the colours of this picture mean; only of what is there.
    fn entries(&self, annotations: &Annotations<'_>, look: Look) -> Vec<Entry> {
        let mut entries = Vec::new();
        let any = |keep: Keep<'_>| self.figure.cells.iter().any(|cell| keep(cell.id));
        if let Some(seen) = self.seen {
            let is_eye = annotations.eye.is_some();
            let [from, in_sight] = match (is_eye, seen.is_narrowed()) {
                (_, true) => ["the viewer's cell", "seen by the viewer"],
                (true, false) => ["the cell of the point", "seen from that cell"],
                (false, false) => ["the cell", "seen from the cell"],
            };
            let kinds: [(&str, &str, Keep<'_>); 4] = [
                (theme::FROM, from, &|id| seen.is_from(id)),
                (theme::SEEN, in_sight, &|id| seen.is_in_sight(id) && !seen.is_from(id)),
                (theme::SEEN_BY_CELL, "seen from elsewhere in that cell", &|id| seen.sees(id) && !seen.is_in_sight(id)),
                (theme::HIDDEN, "not seen", &|id| !seen.sees(id) && !seen.is_in_sight(id)),
            ];
            entries.extend(kinds.into_iter().filter(|(_, _, keep)| any(keep)).map(|(c, l, _)| Entry::area(c, l)));
            if annotations.target.is_some_and(|target| any(&|id| id == target)) {
                entries.push(Entry::area(theme::TARGET, "the cell looked for"));
            }
        } else if look.group_colours && self.figure.cells.iter().any(|cell| cell.group.is_some()) {
            entries.push(Entry::area(theme::GROUPS[0], "cells, tinted by group"));
        } else {
            entries.push(Entry::area(theme::CELL, "cells"));
        }
        let line = |colour, width, label| Entry { swatch: Swatch::Line(colour, width), label };
        if let Some(section) = &self.figure.section {
            let drawn = Kind::ALL.into_iter().rev().filter(|kind| section.of_kind(*kind).next().is_some());
            entries.extend(drawn.map(|kind| line(colour_of(kind), self.surface(), self.label_of(kind))));
            if !section.flat.is_empty() {
                entries.push(Entry::area(theme::FLAT, "surfaces in the plane"));
            }
        }
        if !self.figure.walls.is_empty() {
            entries.push(line(theme::WALL, self.strokes.wall, "walls"));
        }
        if !self.figure.doors.is_empty() {
            let colour = if self.seen.is_some() { theme::PORTAL_FAINT } else { theme::PORTAL };
            entries.push(line(colour, self.strokes.portal, "portals"));
        } else if self.figure.has_bare_cells() {
            entries.push(line(theme::PORTAL_FAINT, self.strokes.portal, "borders of cells"));
        }
        if look.objects && !self.figure.objects.is_empty() {
            let is_seen = |id: u32| self.seen.is_none_or(|seen| seen.sees_object(id));
            let all = || self.figure.objects.iter().map(|(id, _)| *id);
            if all().any(is_seen) {
                entries.push(Entry::area(theme::OBJECT, if self.seen.is_some() { "objects seen" } else { "objects" }));
            }
            if !all().all(is_seen) {
                entries.push(Entry::area(theme::OBJECT_HIDDEN, "objects not seen"));
            }
        }
        if annotations.line.is_some() {
            entries.push(line(theme::SIGHTLINE, self.strokes.line, "a line of sight"));
        } else if !annotations.portals.is_empty() {
            entries.push(line(theme::SIGHTLINE, self.strokes.wall, "portals of a blocked way"));
        }
        for ((colour, label), places) in RINGS.into_iter().zip(annotations.rings) {
            if !places.is_empty() {
                entries.push(Entry { swatch: Swatch::Dot(colour), label });
            }
        }
        if annotations.eye.is_some() {
            entries.push(Entry { swatch: Swatch::Dot(theme::SIGHTLINE), label: "the viewer" });
        }
        entries
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
            if seen.is_narrowed() {
                fill(out, &chosen(&|cell| seen.sees(cell.id) && !seen.is_in_sight(cell.id)), theme::SEEN_BY_CELL);
            }
            fill(out, &chosen(&|cell| seen.is_in_sight(cell.id)), theme::SEEN);
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
        if self.figure.has_bare_cells() {
            let mut borders = String::new();
            self.figure.cells.iter().for_each(|cell| self.frame.polygon(&mut borders, &cell.corners));
            stroke(out, &borders, theme::PORTAL_FAINT, self.strokes.portal);
        }
        stroke(out, &doors, colour, self.strokes.portal);
        if let Some(section) = &self.figure.section {
            self.section(out, section);
        }
        stroke(out, &closed, theme::WALL, self.strokes.wall);
    }

    /// The surfaces of the scene.
    fn section(&self, out: &mut String, section: &Section) {
        let mut flat = String::new();
        section.flat.iter().for_each(|corners| self.frame.polygon(&mut flat, corners));
        if !flat.is_empty() {
            let _ = writeln!(out, "<path d=\"{flat}\" fill=\"{}\" fill-opacity=\".6\"/>", theme::FLAT);
        }
        for kind in Kind::ALL {
            stroke(out, &self.frame.lines(section.of_kind(kind)), colour_of(kind), self.surface());
        }
    }

    /// The width of the lines of surfaces: two sides of a wall are two lines.
    fn surface(&self) -> f64 {
        0.6 * self.strokes.wall
    }

    fn label_of(&self, kind: Kind) -> &'static str {
        match (kind, self.seen.is_some()) {
            (Kind::Hidden, _) => "surfaces not seen",
            (Kind::SeeThrough, _) => "see-through surfaces",
            (Kind::Seen, true) => "surfaces seen",
            (Kind::Seen, false) => "surfaces of the scene",
        }
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

    /// Rings around cells too thin to be seen, marked doors, the line of sight, joints of walls, the eye.
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
        if let (Some(eye), Some((direction, angle))) = (annotations.eye, annotations.looks) {
            self.view(out, eye, direction, angle);
        }
        for ((colour, _), places) in RINGS.into_iter().zip(annotations.rings) {
            places.iter().for_each(|&p| self.ring(out, self.frame.place(p), colour));
        }
        for point in annotations.line.into_iter().flatten().chain(annotations.eye) {
            svg::dot(out, self.frame.place(point), self.strokes.mark, theme::SIGHTLINE);
        }
    }

    /// The two sides of the view, as short lines from the eye; nothing for one who looks straight up or down.
    fn view(&self, out: &mut String, eye: Point2, direction: Point2, angle: f64) {
        let length = direction.length();
        if !(length > 0.0 && length.is_finite()) {
            return;
        }
        let ahead = direction * (f64::from(self.frame.width.max(self.frame.height)) / 12.0 / self.frame.scale / length);
        let mut path = String::new();
        for half in [0.5 * angle, -0.5 * angle] {
            let (sin, cos) = half.sin_cos();
            let side = Point2::new(ahead.x * cos - ahead.y * sin, ahead.x * sin + ahead.y * cos);
            self.frame.polyline(&mut path, &[eye, eye + side]);
        }
        stroke(out, &path, theme::PAPER, 2.2 * self.strokes.line);
        stroke(out, &path, theme::SIGHTLINE, self.strokes.line);
    }

    fn ring_if_thin(&self, out: &mut String, cell: &Shape, colour: &str) {
        let bounds = Aabb::around(cell.corners.iter().map(|p| [p.x, p.y]));
        let [x0, y1] = self.frame.place(bounds.min.into());
        let [x1, y0] = self.frame.place(bounds.max.into());
        let least = self.strokes.wall.max(self.strokes.mark);
        if (x1 - x0).min(y1 - y0) > 2.0 * least {
            return;
        }
        self.ring(out, [0.5 * (x0 + x1), 0.5 * (y0 + y1)], colour);
    }

    /// A ring around a place of the picture.
    fn ring(&self, out: &mut String, [x, y]: [f64; 2], colour: &str) {
        let least = self.strokes.wall.max(self.strokes.mark);
        let [x, y, r] = [x, y, 4.0 * self.strokes.mark].map(Px);
        for (colour, width) in [(theme::PAPER, 2.0 * least), (colour, least)] {
            let _ = writeln!(
                out,
                "<circle cx=\"{x}\" cy=\"{y}\" r=\"{r}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{}\"/>",
                Px(width)
            );
        }
    }
}
