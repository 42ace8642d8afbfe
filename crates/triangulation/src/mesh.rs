//! The triangulation: triangles, their neighbours, and which edges are lines.

use crate::TriangulationError;
use crate::noding::Noded;
use crate::piece::Piece;
use sightlines_cells::Plan;
use sightlines_geometry::Point2;
use spade::{ConstrainedDelaunayTriangulation, HasPosition, Triangulation};
use std::collections::BTreeMap;

/// No triangle: the outside of the convex hull.
pub(crate) const OUTSIDE: u32 = u32::MAX;

/// A piece of a line, as an edge of the triangulation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Line {
    pub(crate) opaque: bool,
}

/// One edge of a triangle, running counter-clockwise: the triangle is on its left.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Edge {
    /// Index of its start among the vertices.
    pub(crate) from: u32,
    /// The edge of the neighbouring triangle that runs the other way; [`OUTSIDE`] on the hull.
    pub(crate) twin: u32,
    /// The line it is a piece of, if any.
    pub(crate) line: Option<Line>,
}

/// Triangles in the plane. Edges `3 t`, `3 t + 1`, `3 t + 2` are those of triangle `t`.
#[derive(Debug)]
pub(crate) struct Mesh {
    pub(crate) vertices: Vec<Point2>,
    pub(crate) edges: Vec<Edge>,
    /// Groups that lines name for a triangle they bound: (triangle, group), sorted.
    pub(crate) named: Vec<(u32, u32)>,
}

impl Mesh {
    pub(crate) fn n_triangles(&self) -> usize {
        self.edges.len() / 3
    }

    /// The next edge of the same triangle.
    pub(crate) fn next(edge: u32) -> u32 {
        if edge % 3 == 2 { edge - 2 } else { edge + 1 }
    }

    /// Start and end of an edge.
    pub(crate) fn ends(&self, edge: u32) -> (Point2, Point2) {
        let start = |e: u32| self.vertices[self.edges[e as usize].from as usize];
        (start(edge), start(Self::next(edge)))
    }
}

/// A vertex with its index.
#[derive(Debug, Clone, Copy)]
struct Vertex {
    position: spade::Point2<f64>,
    index: u32,
}

impl HasPosition for Vertex {
    type Scalar = f64;
    fn position(&self) -> spade::Point2<f64> {
        self.position
    }
}

/// The combined properties of the pieces between two vertices, along the edge from the lower index to the higher.
#[derive(Debug, Clone, Default)]
struct EdgeAttributes {
    opaque: bool,
    left: Vec<u32>,
    right: Vec<u32>,
}

impl EdgeAttributes {
    fn add(&mut self, plan: &Plan, noded: &Noded, piece: &Piece, forward: bool) {
        self.opaque |= piece.opaque;
        let Some(line) = plan.lines().get(piece.line as usize) else { return };
        let extra = &noded.extra[piece.line as usize];
        let (left, right) = if forward { (line.left, line.right) } else { (line.right, line.left) };
        self.left.extend(left.iter().chain(extra));
        self.right.extend(right.iter().chain(extra));
    }
}

/// Distinct end points and corners of the frame in lexicographic order.
fn distinct(pieces: &[Piece], frame: &[Point2]) -> Vec<Point2> {
    let mut points: Vec<Point2> = pieces.iter().flat_map(|p| [p.a, p.b]).chain(frame.iter().copied()).collect();
    points.sort_by(order);
    points.dedup();
    points
}

fn order(p: &Point2, q: &Point2) -> std::cmp::Ordering {
    p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y))
}

fn index_of(points: &[Point2], p: &Point2) -> u32 {
    let found = points.binary_search_by(|q| order(q, p)).expect("every end point is among the distinct ones");
    u32::try_from(found).expect("fewer than 2^32 points")
}

/// Triangulates the convex hull of all pieces and of the points of `frame`.
pub(crate) fn triangulate(plan: &Plan, noded: &Noded, frame: &[Point2]) -> Result<Mesh, TriangulationError> {
    let vertices = distinct(&noded.pieces, frame);
    let mut lines: BTreeMap<(u32, u32), EdgeAttributes> = BTreeMap::new();
    for piece in &noded.pieces {
        let (a, b) = (index_of(&vertices, &piece.a), index_of(&vertices, &piece.b));
        lines.entry((a.min(b), a.max(b))).or_default().add(plan, noded, piece, a < b);
    }
    let cdt = constrained(&vertices, lines.keys())?;
    if cdt.num_inner_faces() == 0 {
        return Err(TriangulationError::Flat);
    }
    Ok(mesh_of(&cdt, vertices, &lines))
}

type Cdt = ConstrainedDelaunayTriangulation<Vertex>;

fn constrained<'a>(
    vertices: &[Point2],
    lines: impl Iterator<Item = &'a (u32, u32)>,
) -> Result<Cdt, TriangulationError> {
    let with_index = |(index, p): (u32, &Point2)| Vertex { position: spade::Point2::new(p.x, p.y), index };
    let all: Vec<Vertex> = (0..).zip(vertices).map(with_index).collect();
    for p in vertices {
        let refused = |x: f64| spade::validate_coordinate(x).is_err();
        if refused(p.x) || refused(p.y) {
            return Err(TriangulationError::Vertex { x: p.x, y: p.y });
        }
    }
    let edges = lines.map(|&(a, b)| [a as usize, b as usize]).collect();
    let first = vertices.first().copied().unwrap_or_default();
    // Noding leaves no conflict. A constraint that conflicts nevertheless is dropped; that removes a wall, which errs
    // towards visible.
    Cdt::try_bulk_load_cdt(all, edges, |_| {}).map_err(|_| TriangulationError::Vertex { x: first.x, y: first.y })
}

fn mesh_of(cdt: &Cdt, vertices: Vec<Point2>, lines: &BTreeMap<(u32, u32), EdgeAttributes>) -> Mesh {
    let mut slot = vec![OUTSIDE; cdt.num_directed_edges()];
    for (triangle, face) in (0u32..).zip(cdt.inner_faces()) {
        for (k, edge) in (0u32..).zip(face.adjacent_edges()) {
            slot[edge.fix().index()] = 3 * triangle + k;
        }
    }
    let mut edges = Vec::with_capacity(3 * cdt.num_inner_faces());
    let mut named = Vec::new();
    for (triangle, face) in (0u32..).zip(cdt.inner_faces()) {
        for edge in face.adjacent_edges() {
            let (from, to) = (edge.from().data().index, edge.to().data().index);
            let marks = lines.get(&(from.min(to), from.max(to)));
            if let Some(marks) = marks {
                let groups = if from < to { &marks.left } else { &marks.right };
                named.extend(groups.iter().map(|&g| (triangle, g)));
            }
            let twin = slot[edge.rev().fix().index()];
            edges.push(Edge { from, twin, line: marks.map(|m| Line { opaque: m.opaque }) });
        }
    }
    named.sort_unstable();
    named.dedup();
    Mesh { vertices, edges, named }
}
