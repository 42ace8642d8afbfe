//! What is seen from regions and paths: from any of their points, or from all of them.

use crate::edge::{NONE, next, previous};
use crate::expand::{Rays, Visitor, Window};
use crate::locate::MeshPlace;
use crate::{EyeError, Touch, WallMesh};
use sightlines_geometry::{Point2, Segment2, orient2d, polygon_contains};
use sightlines_pvs::{CellId, CellRecord, Table, bits};

/// A part of the plane that viewers can be in: a polygon with its inside, or a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ViewerRegion<'a> {
    /// A polygon with its inside, in either direction, without its first point repeated.
    Polygon(&'a [Point2]),
    /// The straight pieces between points, one after the other.
    Path(&'a [Point2]),
}

impl<'a> ViewerRegion<'a> {
    /// The points.
    pub const fn points(self) -> &'a [Point2] {
        match self {
            Self::Polygon(points) | Self::Path(points) => points,
        }
    }

    /// The straight pieces; one of length zero for a single point.
    pub fn pieces(self) -> impl Iterator<Item = Segment2> + 'a {
        let points = self.points();
        let closes = matches!(self, Self::Polygon(_)) || points.len() == 1;
        let back = points.last().zip(points.first()).filter(|_| closes).map(|(&a, &b)| Segment2::new(a, b));
        points.windows(2).map(|pair| Segment2::new(pair[0], pair[1])).chain(back)
    }

    /// Whether a convex cell has a point in common with the region. Exact.
    fn touches(self, cell: &[Point2]) -> bool {
        let sides = || cell.iter().zip(cell.iter().cycle().skip(1)).map(|(&a, &b)| Segment2::new(a, b));
        self.pieces().any(|piece| sides().any(|side| side.meets(&piece)))
            || self.points().first().is_some_and(|&p| polygon_contains(cell, p))
            || (matches!(self, Self::Polygon(_)) && cell.first().is_some_and(|&c| winds_around(self, c)))
    }
}

/// Whether a point that is on no side of a polygon is inside of it: by the number of sides that a ray crosses.
fn winds_around(region: ViewerRegion<'_>, p: Point2) -> bool {
    let crossed = region.pieces().filter(|side| {
        let (above_a, above_b) = (side.a.y > p.y, side.b.y > p.y);
        above_a != above_b && (orient2d(side.a, side.b, p) > 0.0) == above_b
    });
    crossed.count() % 2 == 1
}

/// The polygon of a cell; its box if it has none.
fn polygon_of(cell: &CellRecord) -> Vec<Point2> {
    let ([x0, y0, _], [x1, y1, _]) = (cell.min, cell.max);
    match cell.polygon.as_slice() {
        [] => [(x0, y0), (x1, y0), (x1, y1), (x0, y1)].map(Point2::from).to_vec(),
        polygon => polygon.iter().copied().map(Point2::from).collect(),
    }
}

/// The cells of a table that a region has points in. Exact; O(cells × points).
pub fn cells_of_region(table: &Table, region: ViewerRegion<'_>) -> Vec<CellId> {
    let touches = |cell: &CellId| region.touches(&polygon_of(&table.cells()[cell.0 as usize]));
    (0u32..).take(table.n_cells()).map(CellId).filter(touches).collect()
}

/// The region isovist in cells: those that are seen from *any* point of a region or path, by the rows of a table.
///
/// Errs towards visible: a cell that the region has a point in counts as a whole. Cost: as [`cells_of_region`], and a row for each of
/// its cells.
///
/// # Source
/// Teller and Séquin, "Visibility preprocessing for interactive walkthroughs", SIGGRAPH 1991, for the table.
pub fn seen_from_any(table: &Table, region: ViewerRegion<'_>) -> Vec<CellId> {
    let mut seen = vec![0; table.n_cells().div_ceil(64)];
    for cell in cells_of_region(table, region) {
        bits::or_words(&mut seen, table.row(cell));
    }
    bits::ones(&seen).map(|cell| CellId(cell as u32)).collect()
}

/// The corners of walls in the triangles that a view enters.
struct Corners<'a> {
    mesh: &'a WallMesh,
    /// Each with an edge that starts there.
    found: Vec<(u32, u32)>,
}

impl Visitor for Corners<'_> {
    fn start(&mut self, triangle: u32) {
        self.found.extend((3 * triangle..3 * triangle + 3).map(|edge| (self.mesh.edges[edge as usize].from, edge)));
    }

    fn enter(&mut self, window: Window) {
        let apex = previous(window.edge);
        self.found.push((self.mesh.edges[apex as usize].from, apex));
    }

    fn end(&mut self, _: Window) {}
}

impl WallMesh {
    /// Whether an eye sees *all* of a region or path: every point of it, by the rules of [`WallMesh::sees`]. Exact.
    ///
    /// The eye sees a straight piece if it sees both ends and no wall ends in the triangle between. With [`Touch::Passes`], walls may
    /// touch the sides of the triangle from outside, and leave the eye through it.
    ///
    /// Cost: an isovist, two sights for each piece, and a comparison for each piece and corner that is near.
    ///
    /// # Errors
    /// [`EyeError`] for the eye or a point of the region that is outside of the frame or has coordinates that are none.
    pub fn sees_all(&self, eye: Point2, region: ViewerRegion<'_>, touch: Touch) -> Result<bool, EyeError> {
        let (eye, place) = self.locate(eye)?;
        for &p in region.points() {
            let (p, _) = self.locate(p)?;
            if !self.sees_from(eye, place, p, touch) {
                return Ok(false);
            }
        }
        let rays = if touch == Touch::Blocks { Rays::Open } else { Rays::Closed };
        let mut corners = Corners { mesh: self, found: Vec::new() };
        self.expand(eye, place, rays, &mut Vec::new(), &mut corners);
        corners.found.sort_unstable();
        corners.found.dedup_by_key(|&mut (corner, _)| corner);
        // Crossings of walls are left out: a wall that passes through a triangle without an end in it crosses a side.
        corners.found.retain(|&(corner, _)| self.corners[corner as usize].reach == 0.0 && !self.is_at(eye, corner));
        let blocks = |piece: &Segment2| {
            let Some(triangle) = Triangle::new(eye, piece) else {
                // The sights to both ends have decided.
                return false;
            };
            (touch == Touch::Blocks && self.has_wall_between(&triangle, place))
                || corners.found.iter().any(|&(_, edge)| self.is_in_the_way(&triangle, edge, touch))
        };
        Ok(!region.pieces().any(|piece| blocks(&piece)))
    }

    /// Whether a wall leaves the eye strictly between the two sides of a triangle.
    fn has_wall_between(&self, triangle: &Triangle, place: MeshPlace) -> bool {
        let is_between =
            |corner: u32| triangle.is_right_of_left(self, corner) && triangle.is_left_of_right(self, corner);
        let is_wall = |edge: u32| self.edges[edge as usize].wall != NONE;
        match place {
            MeshPlace::Inside(_) => false,
            MeshPlace::OnEdge(edge) => {
                is_wall(edge) && [edge, next(edge)].into_iter().any(|e| is_between(self.edges[e as usize].from))
            }
            MeshPlace::OnCorner(edge) => self.leaving(edge).any(|out| {
                let ends = [(out, next(out)), (previous(out), previous(out))];
                ends.into_iter().any(|(edge, to)| is_wall(edge) && is_between(self.edges[to as usize].from))
            }),
        }
    }

    /// Whether the end of a wall where an edge starts is in a triangle, but not on the piece; if walls may be touched, whether a wall goes on
    /// from there inside the triangle, and not along the ray from the eye.
    fn is_in_the_way(&self, &Triangle { eye, a, b }: &Triangle, edge: u32, touch: Touch) -> bool {
        let end = self.corners[self.edges[edge as usize].from as usize].at;
        let (on_right, on_left, before) = (orient2d(eye, a, end), orient2d(b, eye, end), orient2d(a, b, end));
        if on_right < 0.0 || on_left < 0.0 || before <= 0.0 {
            return false;
        }
        if touch == Touch::Blocks {
            return true;
        }
        // On a side it matters which way a wall goes on; inside, whether it leaves the ray from the eye.
        let goes_inside = |corner: u32| match (on_right == 0.0, on_left == 0.0) {
            (true, _) => self.side(eye, a, corner) > 0.0,
            (false, true) => self.side(b, eye, corner) > 0.0,
            (false, false) => self.side(eye, end, corner) != 0.0,
        };
        self.leaving(edge).any(|out| {
            let ends = [(out, next(out)), (previous(out), previous(out))];
            let is_wall = |edge: u32| self.edges[edge as usize].wall != NONE;
            ends.into_iter().any(|(edge, to)| is_wall(edge) && goes_inside(self.edges[to as usize].from))
        })
    }
}

/// The triangle from an eye to a piece, counter-clockwise.
struct Triangle {
    eye: Point2,
    a: Point2,
    b: Point2,
}

impl Triangle {
    /// `None` if the three are on one line.
    fn new(eye: Point2, piece: &Segment2) -> Option<Self> {
        let turn = orient2d(eye, piece.a, piece.b);
        let (a, b) = if turn > 0.0 { (piece.a, piece.b) } else { (piece.b, piece.a) };
        (turn != 0.0).then_some(Self { eye, a, b })
    }

    fn is_left_of_right(&self, mesh: &WallMesh, corner: u32) -> bool {
        mesh.side(self.eye, self.a, corner) > 0.0
    }

    fn is_right_of_left(&self, mesh: &WallMesh, corner: u32) -> bool {
        mesh.side(self.b, self.eye, corner) > 0.0
    }
}
