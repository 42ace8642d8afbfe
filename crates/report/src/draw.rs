//! Plans as SVG: cells, walls, portals, and what is seen from somewhere.

use crate::frame::{Frame, Px};
use crate::outline::{corners, ends, walls};
use crate::theme::{self, Strokes};
use sightlines_geometry::{Aabb, Point2, signed_area};
use sightlines_pvs::{CellId, CellRecord, Table};
use std::fmt::Write;

/// Smallest longer side of a picture, in pixels.
pub const MIN_SIZE: u32 = 16;
/// Largest longer side of a picture, in pixels.
pub const MAX_SIZE: u32 = 8192;

/// What a picture shows besides the plan.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum View {
    /// Nothing: cells and portals alone.
    #[default]
    Plan,
    /// The cells that this cell sees.
    Cell(CellId),
    /// What a viewer at this point sees (scene units): the union over the cells that contain it.
    Eye(Point2),
}

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
    /// The longer side of the picture in pixels, from [`MIN_SIZE`] to [`MAX_SIZE`].
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

/// Why a table cannot be drawn so.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DrawError {
    /// The table is of a scene in space.
    #[error("a table of dimension {0} is not a plan")]
    NotPlanar(u8),
    /// A cell that the table does not have.
    #[error("there is no cell {cell}: the table has {n_cells} cells")]
    NoSuchCell {
        /// The cell asked for.
        cell: u32,
        /// Number of cells of the table.
        n_cells: usize,
    },
    /// A portal that the table does not have.
    #[error("there is no portal {portal}: the table has {n_portals} portals")]
    NoSuchPortal {
        /// The portal asked for.
        portal: usize,
        /// Number of portals of the table.
        n_portals: usize,
    },
    /// A picture too small to show anything or too large for memory.
    #[error("a picture of {0} pixels is not from {MIN_SIZE} to {MAX_SIZE} pixels")]
    Size(u32),
    /// A point or a line with a coordinate that is not finite.
    #[error("a point to be drawn has a coordinate that is not finite")]
    NotFinite,
}

/// Draws a table of a plan as SVG: cells light, walls dark, portals thin, and by [`DrawOptions`] what is
/// seen from a cell or a point. y grows upwards, proportions are kept, stroke widths follow the size of
/// the cells. O(table).
///
/// # Errors
/// [`DrawError`] for a table in space, cells or portals that do not exist, an unusable size or point.
pub fn plan_svg(table: &Table, options: &DrawOptions) -> Result<String, DrawError> {
    check(table, options)?;
    let picture = Picture::new(table, options);
    let mut svg = picture.open();
    picture.fills(&mut svg);
    picture.lines(&mut svg);
    if options.objects {
        picture.objects(&mut svg);
    }
    picture.marks(&mut svg);
    svg.push_str("</svg>\n");
    Ok(svg)
}

fn check(table: &Table, options: &DrawOptions) -> Result<(), DrawError> {
    if table.dimension() != 2 {
        return Err(DrawError::NotPlanar(table.dimension()));
    }
    let n_cells = table.n_cells();
    let from = if let View::Cell(cell) = options.view { Some(cell) } else { None };
    if let Some(cell) = [from, options.target].into_iter().flatten().find(|cell| cell.idx() >= n_cells) {
        return Err(DrawError::NoSuchCell { cell: cell.0, n_cells });
    }
    let n_portals = table.portals().len();
    if let Some(&portal) = options.marked_portals.iter().find(|&&portal| portal >= n_portals) {
        return Err(DrawError::NoSuchPortal { portal, n_portals });
    }
    if !(MIN_SIZE..=MAX_SIZE).contains(&options.size) {
        return Err(DrawError::Size(options.size));
    }
    let eye = if let View::Eye(eye) = options.view { Some(eye) } else { None };
    let finite = options.line.into_iter().flatten().chain(eye).all(Point2::is_finite);
    if finite { Ok(()) } else { Err(DrawError::NotFinite) }
}

/// What is seen: whether each cell is, and which objects are, ascending.
struct Seen {
    cells: Vec<bool>,
    objects: Vec<u32>,
}

impl Seen {
    fn new(table: &Table, ids: impl Iterator<Item = CellId>, objects: Vec<u32>) -> Self {
        let mut cells = vec![false; table.n_cells()];
        ids.for_each(|id| cells[id.idx()] = true);
        Self { cells, objects }
    }
}

/// A picture while it is drawn.
struct Picture<'a> {
    table: &'a Table,
    options: &'a DrawOptions,
    frame: Frame,
    strokes: Strokes,
    /// The cells looked from; none for a plan alone.
    from: Vec<CellId>,
    /// What they see; `None` for a plan alone.
    seen: Option<Seen>,
}

fn bounds(table: &Table) -> Aabb<2> {
    Aabb::around(table.cells().iter().flat_map(|c| [[c.min[0], c.min[1]], [c.max[0], c.max[1]]]))
}

impl<'a> Picture<'a> {
    fn new(table: &'a Table, options: &'a DrawOptions) -> Self {
        let frame = Frame::around(bounds(table), options.size);
        let area: f64 = table.cells().iter().map(|c| signed_area(&corners(c))).sum();
        let cell = (frame.area(area) / (table.n_cells().max(1) as f64)).sqrt();
        let (from, seen) = match options.view {
            View::Plan => (Vec::new(), None),
            View::Cell(cell) => (vec![cell], Some(Seen::new(table, table.visible(cell), table.visible_objects(cell)))),
            View::Eye(eye) => {
                let eye = [eye.x, eye.y];
                let objects = table.visible_objects_from(&eye);
                (table.locate(&eye), Some(Seen::new(table, table.visible_from(&eye).iter(), objects)))
            }
        };
        let strokes = Strokes::for_cells(cell, f64::from(options.size));
        Self { table, options, frame, strokes, from, seen }
    }

    fn open(&self) -> String {
        let Frame { width, height, .. } = self.frame;
        let title = match self.options.view {
            View::Plan => "Cells and portals".to_owned(),
            View::Cell(cell) => format!("What cell {} sees", cell.0),
            View::Eye(eye) => format!("What a viewer at ({}, {}) sees", eye.x, eye.y),
        };
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {width} {height}\" stroke-linecap=\"round\" stroke-linejoin=\"round\">\n\
             <title>{title}</title>\n<rect width=\"100%\" height=\"100%\" fill=\"{}\"/>\n",
            theme::PAPER
        )
    }

    /// The cells, one path for each colour: cells that share a side leave no seam in a common path.
    fn fills(&self, svg: &mut String) {
        let chosen = |keep: &dyn Fn(usize, &CellRecord) -> bool| {
            let mut path = String::new();
            for (_, cell) in self.table.cells().iter().enumerate().filter(|(i, cell)| keep(*i, cell)) {
                self.frame.polygon(&mut path, &corners(cell));
            }
            path
        };
        let id = |i: usize| CellId(i as u32);
        let base = if self.seen.is_some() { theme::HIDDEN } else { theme::CELL };
        fill(svg, &chosen(&|_, _| true), base);
        if let Some(seen) = &self.seen {
            fill(svg, &chosen(&|i, _| seen.cells[i]), theme::SEEN);
        } else if self.options.group_colours {
            let n = theme::GROUPS.len();
            for (k, colour) in theme::GROUPS.iter().enumerate() {
                let tinted = |_: usize, cell: &CellRecord| cell.group.is_some_and(|g| g as usize % n == k);
                fill(svg, &chosen(&tinted), colour);
            }
        }
        // Bordered too, so that a tiny cell is found in a large plan.
        for (path, colour) in [
            (chosen(&|i, _| self.options.target == Some(id(i))), theme::TARGET),
            (chosen(&|i, _| self.from.contains(&id(i))), theme::FROM),
        ] {
            fill(svg, &path, colour);
            stroke(svg, &path, colour, self.strokes.mark);
        }
    }

    fn lines(&self, svg: &mut String) {
        let (mut doors, mut closed) = (String::new(), String::new());
        for door in self.table.portals().iter().filter_map(|p| ends(&p.points)) {
            self.frame.polyline(&mut doors, &[door.a, door.b]);
        }
        for wall in walls(self.table) {
            self.frame.polyline(&mut closed, &[wall.a, wall.b]);
        }
        let colour = if self.seen.is_some() { theme::PORTAL_FAINT } else { theme::PORTAL };
        stroke(svg, &doors, colour, self.strokes.portal);
        stroke(svg, &closed, theme::WALL, self.strokes.wall);
    }

    /// Objects as small boxes, those that are not seen fainter.
    fn objects(&self, svg: &mut String) {
        let (mut shown, mut hidden) = (String::new(), String::new());
        for (i, object) in self.table.objects().iter().enumerate() {
            let is_seen = self.seen.as_ref().is_none_or(|seen| seen.objects.binary_search(&(i as u32)).is_ok());
            let path = if is_seen { &mut shown } else { &mut hidden };
            self.object(path, object.min, object.max);
        }
        let width = self.strokes.portal;
        for (path, colour) in [(hidden, theme::OBJECT_HIDDEN), (shown, theme::OBJECT)] {
            if !path.is_empty() {
                let _ = writeln!(
                    svg,
                    "<path d=\"{path}\" fill=\"{colour}\" fill-opacity=\".45\" stroke=\"{colour}\" \
                     stroke-width=\"{}\"/>",
                    Px(width)
                );
            }
        }
    }

    fn object(&self, path: &mut String, min: [f64; 3], max: [f64; 3]) {
        let [x0, y1] = self.frame.place(Point2::new(min[0], min[1]));
        let [x1, y0] = self.frame.place(Point2::new(max[0], max[1]));
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
    fn marks(&self, svg: &mut String) {
        for (cells, colour) in [(self.options.target.as_slice(), theme::TARGET), (&self.from[..], theme::FROM)] {
            cells.iter().for_each(|&cell| self.ring_if_thin(svg, cell, colour));
        }
        let mut doors = String::new();
        for &portal in &self.options.marked_portals {
            if let Some(door) = ends(&self.table.portals()[portal].points) {
                self.frame.polyline(&mut doors, &[door.a, door.b]);
            }
        }
        stroke(svg, &doors, theme::SIGHTLINE, self.strokes.wall * 1.2);
        if let Some(line) = self.options.line {
            let mut path = String::new();
            self.frame.polyline(&mut path, &line);
            stroke(svg, &path, theme::PAPER, 2.2 * self.strokes.line);
            stroke(svg, &path, theme::SIGHTLINE, self.strokes.line);
            line.iter().for_each(|&end| self.dot(svg, end, theme::SIGHTLINE));
        }
        if let View::Eye(eye) = self.options.view {
            self.dot(svg, eye, theme::SIGHTLINE);
        }
    }

    fn ring_if_thin(&self, svg: &mut String, cell: CellId, colour: &str) {
        let record = &self.table.cells()[cell.idx()];
        let [x0, y1] = self.frame.place(Point2::new(record.min[0], record.min[1]));
        let [x1, y0] = self.frame.place(Point2::new(record.max[0], record.max[1]));
        let least = self.strokes.wall.max(self.strokes.mark);
        if (x1 - x0).min(y1 - y0) > 2.0 * least {
            return;
        }
        let [x, y, r] = [0.5 * (x0 + x1), 0.5 * (y0 + y1), 4.0 * self.strokes.mark].map(Px);
        for (colour, width) in [(theme::PAPER, 2.0 * least), (colour, least)] {
            let _ = writeln!(
                svg,
                "<circle cx=\"{x}\" cy=\"{y}\" r=\"{r}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{}\"/>",
                Px(width)
            );
        }
    }

    fn dot(&self, svg: &mut String, at: Point2, colour: &str) {
        let ([x, y], r) = (self.frame.place(at), self.strokes.mark);
        let _ = writeln!(
            svg,
            "<circle cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"{colour}\" stroke=\"{}\" stroke-width=\"{}\"/>",
            Px(x),
            Px(y),
            Px(1.2 * r),
            theme::PAPER,
            Px(0.4 * r)
        );
    }
}

fn fill(svg: &mut String, path: &str, colour: &str) {
    if !path.is_empty() {
        let _ = writeln!(svg, "<path d=\"{path}\" fill=\"{colour}\"/>");
    }
}

fn stroke(svg: &mut String, path: &str, colour: &str, width: f64) {
    if !path.is_empty() {
        let _ = writeln!(svg, "<path d=\"{path}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{}\"/>", Px(width));
    }
}
