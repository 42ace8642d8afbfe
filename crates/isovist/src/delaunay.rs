//! The Delaunay triangulation of points, by `spade`, as triangles.

use crate::MeshError;
use crate::edge::{Edge, NONE};
use sightlines_geometry::Point2;
use spade::{DelaunayTriangulation, HasPosition, Triangulation};

/// A point with its index.
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

/// The triangles of different points, and an edge that leaves each point.
pub(crate) fn delaunay(points: &[Point2]) -> Result<(Vec<Edge>, Vec<u32>), MeshError> {
    let refused = |x: f64| spade::validate_coordinate(x).is_err();
    if let Some(p) = points.iter().find(|p| refused(p.x) || refused(p.y)) {
        return Err(MeshError::Vertex { x: p.x, y: p.y });
    }
    let with_index = |(index, p): (u32, &Point2)| Vertex { position: spade::Point2::new(p.x, p.y), index };
    let all: Vec<Vertex> = (0u32..).zip(points).map(with_index).collect();
    let first = points.first().copied().unwrap_or_default();
    let delaunay = DelaunayTriangulation::<Vertex>::bulk_load(all);
    let delaunay = delaunay.map_err(|_| MeshError::Vertex { x: first.x, y: first.y })?;
    let mut slot = vec![NONE; delaunay.num_directed_edges()];
    for (triangle, face) in (0u32..).zip(delaunay.inner_faces()) {
        for (k, edge) in (0u32..).zip(face.adjacent_edges()) {
            slot[edge.fix().index()] = 3 * triangle + k;
        }
    }
    let mut edges = Vec::with_capacity(3 * delaunay.num_inner_faces());
    let mut leaving = vec![NONE; points.len()];
    for edge in delaunay.inner_faces().flat_map(|face| face.adjacent_edges()) {
        let from = edge.from().data().index;
        leaving[from as usize] = edges.len() as u32;
        edges.push(Edge { from, twin: slot[edge.rev().fix().index()], wall: NONE });
    }
    Ok((edges, leaving))
}
