//! The vertices, edges and faces of a scene, each with one number.

use sightlines_geometry::{Aabb, BoxTree, Point3};
use std::collections::BTreeMap;

/// What kind of feature an id stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum FeatureKind {
    /// A corner of triangles.
    Vertex,
    /// An edge of triangles, without its ends.
    Edge,
    /// A triangle, without its edges.
    Face,
}

/// The features of triangles, prepared for nearest-feature queries.
///
/// Corners at the same place are one vertex, and edges between the same two vertices are one edge, whichever
/// triangles they belong to. Ids are dense: first vertices, then edges, both in the order in which the
/// triangles name them, then the triangles themselves.
#[derive(Debug, Clone, PartialEq)]
pub struct Features {
    pub(super) vertices: Vec<Point3>,
    /// Lower vertex first.
    pub(super) edges: Vec<[u32; 2]>,
    pub(super) faces: Vec<Face>,
    /// The boxes of the faces.
    pub(super) tree: BoxTree<3>,
}

/// A triangle by the ids of its parts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Face {
    pub(super) vertices: [u32; 3],
    /// Indices of edges, from 0: between vertices 0 and 1, 1 and 2, 2 and 0.
    pub(super) edges: [u32; 3],
}

/// Triangles in a leaf of the tree.
const PER_LEAF: usize = 4;

impl Features {
    /// Numbers the features of triangles, with coordinates that
    /// [`check_coordinate`](sightlines_geometry::check_coordinate) accepts. Triangles without area count with their
    /// edges and vertices.
    ///
    /// Cost: O(n log² n) for n triangles.
    ///
    /// # Panics
    /// With more features than 2^32, which take about 100 GB.
    pub fn new(triangles: impl IntoIterator<Item = [Point3; 3]>) -> Self {
        let (mut by_place, mut by_ends) = (BTreeMap::new(), BTreeMap::new());
        let (mut vertices, mut edges, mut faces) = (Vec::new(), Vec::new(), Vec::new());
        for corners in triangles {
            let ids = corners.map(|p| {
                // Both zeros are one place.
                *by_place.entry(p.map(|x| (x + 0.0).to_bits())).or_insert_with(|| push(&mut vertices, p))
            });
            let edge = |k: usize| {
                let (a, b) = (ids[k], ids[(k + 1) % 3]);
                let ends = [a.min(b), a.max(b)];
                *by_ends.entry(ends).or_insert_with(|| push(&mut edges, ends))
            };
            let of = [0, 1, 2].map(edge);
            push(&mut faces, Face { vertices: ids, edges: of });
        }
        let n = vertices.len() + edges.len() + faces.len();
        assert!(u32::try_from(n).is_ok(), "fewer features than 2^32");
        let at = |i: u32| vertices[i as usize];
        let boxes: Vec<Aabb<3>> = faces.iter().map(|face| Aabb::around(face.vertices.map(at))).collect();
        Self { tree: BoxTree::build(&boxes, PER_LEAF), vertices, edges, faces }
    }

    /// How many features there are.
    pub fn len(&self) -> usize {
        self.vertices.len() + self.edges.len() + self.faces.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.vertices.is_empty()
    }

    /// The lowest id of an edge, which is the number of vertices.
    pub fn first_edge(&self) -> u32 {
        self.vertices.len() as u32
    }

    /// The lowest id of a face, which is the number of vertices and edges.
    pub fn first_face(&self) -> u32 {
        (self.vertices.len() + self.edges.len()) as u32
    }

    /// What an id stands for.
    pub fn kind(&self, id: u32) -> FeatureKind {
        if id < self.first_edge() {
            FeatureKind::Vertex
        } else if id < self.first_face() {
            FeatureKind::Edge
        } else {
            FeatureKind::Face
        }
    }
}

/// Adds to a list; the index of what was added.
fn push<T>(list: &mut Vec<T>, item: T) -> u32 {
    let index = u32::try_from(list.len()).expect("fewer features than 2^32");
    list.push(item);
    index
}
