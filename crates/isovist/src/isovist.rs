//! The visibility polygon of a point.

use crate::constructed::{Target, meet};
use crate::edge::{NONE, next};
use crate::expand::{Rays, Visitor, Window};
use crate::{EyeError, WallMesh};
use sightlines_cells::LineId;
use sightlines_geometry::{Point2, Segment2};

/// What an edge of an isovist is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Boundary {
    /// A part of a wall that is seen. Of walls that overlap, the first of the plan.
    Wall(LineId),
    /// A part of a ray that passes the end of a wall: space behind it may be hidden. Benedikt's occluding radial.
    Occluding,
    /// A part of the frame, where sight leaves the plan.
    Frame,
    /// Where [`Limits`](crate::Limits) end the view: the circle, or a side of the sector.
    Limit,
}

/// What is seen from a point: a polygon, counter-clockwise, in which every point can be joined to the eye.
///
/// Edge `i` runs from vertex `i` to the next one; the last runs to vertex 0. A vertex is an end of a wall, a crossing of two walls,
/// or where a ray past an end meets a wall; coordinates that doubles cannot represent are rounded to the nearest one, once.
///
/// An eye on a wall looks to both of its sides, and one in a corner into all of its angles.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Isovist {
    pub(crate) eye: Point2,
    pub(crate) vertices: Vec<Point2>,
    pub(crate) boundaries: Vec<Boundary>,
    /// Angle of the view, in radians: the whole circle, unless a sector limits it.
    pub(crate) angle: f64,
}

impl Isovist {
    /// The eye.
    pub const fn eye(&self) -> Point2 {
        self.eye
    }

    /// The vertices, counter-clockwise.
    pub fn vertices(&self) -> &[Point2] {
        &self.vertices
    }

    /// What each edge is; as many as vertices.
    pub fn boundaries(&self) -> &[Boundary] {
        &self.boundaries
    }

    /// Start, end and kind of each edge.
    pub fn edges(&self) -> impl Iterator<Item = (Point2, Point2, Boundary)> + '_ {
        let ends = self.vertices.iter().skip(1).chain(self.vertices.first());
        self.vertices.iter().zip(ends).zip(&self.boundaries).map(|((&a, &b), &kind)| (a, b, kind))
    }

    /// The walls that are seen, ascending, each once.
    pub fn walls(&self) -> Vec<LineId> {
        let wall = |b: &Boundary| if let Boundary::Wall(line) = *b { Some(line) } else { None };
        let mut walls: Vec<LineId> = self.boundaries.iter().filter_map(wall).collect();
        walls.sort_unstable();
        walls.dedup();
        walls
    }

    fn clear(&mut self, eye: Point2) {
        self.eye = eye;
        self.vertices.clear();
        self.boundaries.clear();
        self.angle = std::f64::consts::TAU;
    }
}

/// Computes isovists one after the other with the same memory.
#[derive(Debug, Clone)]
pub struct IsovistFinder<'a> {
    mesh: &'a WallMesh,
    stack: Vec<Window>,
    ends: Ends,
}

/// Collects where a view ends.
#[derive(Debug, Clone, Default)]
struct Ends(Vec<Window>);

impl Visitor for Ends {
    #[inline(always)]
    fn start(&mut self, _: u32) {}
    #[inline(always)]
    fn enter(&mut self, _: Window) {}
    #[inline(always)]
    fn end(&mut self, window: Window) {
        self.0.push(window);
    }
}

impl WallMesh {
    /// The isovist of a point. For many points, an [`IsovistFinder`] saves memory.
    ///
    /// Exact: see [`Isovist`]. Cost: about 10 ns for each triangle that is seen, and 50 ns for each vertex.
    ///
    /// # Errors
    /// [`EyeError`] for a point outside of the frame or with coordinates that are none.
    ///
    /// # Source
    /// Benedikt, "To take hold of space: isovists and isovist fields", Environment and Planning B 6, 1979.
    pub fn isovist(&self, eye: Point2) -> Result<Isovist, EyeError> {
        let mut isovist = Isovist::default();
        IsovistFinder::new(self).look(eye, &mut isovist)?;
        Ok(isovist)
    }

    pub(crate) fn target(&self, corner: u32) -> Target {
        let at = self.corners[corner as usize].at;
        let first = self.corners.len() - self.crossings.len();
        let low = (corner as usize).checked_sub(first).map_or(Point2::ZERO, |crossing| self.low[crossing]);
        Target { at, low, exact: self.exact(corner) }
    }

    /// The line that an edge lies on: its wall's, or its own on the frame.
    fn line_of(&self, edge: u32) -> Segment2 {
        match self.edges[edge as usize].wall {
            NONE => {
                let (a, b) = self.ends(edge);
                Segment2::new(self.corners[a as usize].at, self.corners[b as usize].at)
            }
            wall => self.walls[wall as usize],
        }
    }
}

impl<'a> IsovistFinder<'a> {
    /// A viewer in this mesh.
    pub fn new(mesh: &'a WallMesh) -> Self {
        Self { mesh, stack: Vec::new(), ends: Ends::default() }
    }

    /// Computes the isovist of a point, in place of what `isovist` was.
    ///
    /// # Errors
    /// As [`WallMesh::isovist`].
    pub fn look(&mut self, eye: Point2, isovist: &mut Isovist) -> Result<(), EyeError> {
        let (eye, place) = self.mesh.locate(eye)?;
        isovist.clear(eye);
        self.ends.0.clear();
        self.mesh.expand(eye, place, Rays::Open, &mut self.stack, &mut self.ends);
        self.outline(isovist);
        Ok(())
    }

    /// Joins where the view ends to a polygon.
    fn outline(&self, isovist: &mut Isovist) {
        let mesh = self.mesh;
        let eye = isovist.eye;
        // The edge before, its wall, and the corner at which it was left, if it was left at its end.
        let (mut last_edge, mut last_wall, mut last_corner) = (NONE, NONE, NONE);
        let mut has_edge = false;
        for &Window { edge, right, left } in &self.ends.0 {
            let (from, to) = (mesh.edges[edge as usize].from, mesh.edges[next(edge) as usize].from);
            let wall = mesh.edges[edge as usize].wall;
            let kind = mesh.wall_of(edge).map_or(Boundary::Frame, Boundary::Wall);
            let point = |corner: u32, own: u32| {
                if corner == own {
                    mesh.corners[own as usize].at
                } else {
                    meet(eye, &mesh.target(corner), &mesh.line_of(edge))
                }
            };
            let end = point(left, to);
            // Neighbours share a ray, so on one line they share a point.
            let on_one_line = edge == last_edge || (wall != NONE && wall == last_wall);
            if on_one_line && has_edge && isovist.vertices.last() != Some(&end) {
                // The line goes on: its end moves.
                isovist.vertices.pop();
                isovist.vertices.push(end);
            } else {
                let is_joined = on_one_line || (right == from && last_corner == from);
                if !is_joined {
                    isovist.push(point(right, from), Boundary::Occluding);
                }
                has_edge = isovist.push(end, kind);
            }
            (last_edge, last_wall, last_corner) = (edge, wall, if left == to { to } else { NONE });
        }
        let first = self.ends.0.first().map_or(NONE, |window| window.edge);
        let is_one_line = first == last_edge || (last_wall != NONE && mesh.edges[first as usize].wall == last_wall);
        isovist.close(is_one_line);
    }
}

impl Isovist {
    /// Adds the end of an edge, unless rounding leaves the edge no length.
    fn push(&mut self, end: Point2, kind: Boundary) -> bool {
        if self.vertices.last() == Some(&end) {
            return false;
        }
        self.vertices.push(end);
        self.boundaries.push(kind);
        true
    }

    /// Closes the outline. Until now boundary `i` is that of the edge that *ends* at vertex `i`, and the first is that of the edge to
    /// the first vertex. `is_one_line`: the first and the last edge are on one line.
    fn close(&mut self, is_one_line: bool) {
        while self.vertices.len() > 1 && self.vertices.first() == self.vertices.last() {
            // The last edge ends where the first one starts.
            let kind = self.boundaries.pop().expect("as many as vertices");
            self.vertices.pop();
            self.boundaries[0] = kind;
        }
        if !self.boundaries.is_empty() {
            self.boundaries.rotate_left(1);
        }
        let n = self.vertices.len();
        // The walk may have begun in the middle of a line.
        if n > 3 && is_one_line && self.boundaries[n - 1] == self.boundaries[0] {
            self.vertices.remove(0);
            self.boundaries.remove(0);
        }
    }
}
