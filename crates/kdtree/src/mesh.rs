//! The pieces of an object: triangles connected by their corners.

use crate::union_find::UnionFind;
use sightlines_cells::{Point3, SceneObject};
use sightlines_geometry::{Aabb, Point2, orient2d};

/// An object, separated into pieces.
#[derive(Debug, Clone, Default)]
pub(crate) struct Mesh {
    /// The piece of each triangle.
    pub(crate) piece_of: Vec<u32>,
    /// The pieces, in the order of their first triangles.
    pub(crate) pieces: Vec<MeshPiece>,
}

/// Triangles connected by their corners.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MeshPiece {
    /// Smallest box around it.
    pub(crate) bounds: Aabb<3>,
    /// Whether every edge is passed as often in one direction as in the other, so that the piece is the
    /// border of something and winds a whole number of times around every point off it.
    pub(crate) closed: bool,
    /// Whether every triangle with an area is perpendicular to an axis.
    pub(crate) axial: bool,
    /// Whether it encloses a negative volume: a cavity, or a room modelled from inside. In rounded
    /// arithmetic.
    pub(crate) inverted: bool,
}

impl Mesh {
    /// Corners at the same place are one corner, whatever their index. O(n log n).
    pub(crate) fn of(object: &SceneObject) -> Self {
        let welded = welded(&object.vertices);
        let triangles: Vec<[u32; 3]> = object.triangles.iter().map(|t| t.map(|i| welded[i as usize])).collect();
        let mut union = UnionFind::new(welded.len());
        for [a, b, c] in &triangles {
            union.join(*a, *b);
            union.join(*a, *c);
        }
        let (mut number, mut pieces) = (vec![u32::MAX; welded.len()], Vec::new());
        let mut piece_of = Vec::with_capacity(triangles.len());
        for t in &triangles {
            let piece = &mut number[union.root(t[0]) as usize];
            if *piece == u32::MAX {
                *piece = pieces.len() as u32;
                pieces.push(MeshPiece { bounds: Aabb::EMPTY, closed: true, axial: true, inverted: false });
            }
            piece_of.push(*piece);
        }
        let mut mesh = Self { piece_of, pieces };
        mesh.measure(object);
        mesh.find_borders(&triangles);
        mesh
    }

    fn measure(&mut self, object: &SceneObject) {
        let mut volumes = vec![(None, 0.0); self.pieces.len()];
        for (&piece, corners) in self.piece_of.iter().zip(object.corners()) {
            let (p, (origin, volume)) = (&mut self.pieces[piece as usize], &mut volumes[piece as usize]);
            p.bounds = corners.into_iter().fold(p.bounds, Aabb::with);
            p.axial &= is_flat_axis(&corners);
            *volume += signed_volume(*origin.get_or_insert(corners[0]), corners);
        }
        for (piece, (_, volume)) in self.pieces.iter_mut().zip(volumes) {
            piece.inverted = volume < 0.0;
        }
    }

    fn find_borders(&mut self, triangles: &[[u32; 3]]) {
        let edges = triangles.iter().zip(&self.piece_of);
        let edges = edges.flat_map(|(&[a, b, c], &piece)| [(a, b, piece), (b, c, piece), (c, a, piece)]);
        let mut edges: Vec<(u32, u32, i8, u32)> =
            edges.map(|(a, b, p)| if a < b { (a, b, 1, p) } else { (b, a, -1, p) }).filter(|e| e.0 != e.1).collect();
        edges.sort_unstable();
        for same in edges.chunk_by(|e, f| (e.0, e.1) == (f.0, f.1)) {
            let balance: i64 = same.iter().map(|e| i64::from(e.2)).sum();
            // Edges of the same two corners are of one piece.
            self.pieces[same[0].3 as usize].closed &= balance == 0;
        }
    }
}

/// For each corner the number of its place.
fn welded(vertices: &[Point3]) -> Vec<u32> {
    let order = |a: &Point3, b: &Point3| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])).then(a[2].total_cmp(&b[2]));
    let mut by_place: Vec<u32> = (0..vertices.len() as u32).collect();
    by_place.sort_unstable_by(|&i, &j| order(&vertices[i as usize], &vertices[j as usize]));
    let mut number = vec![0; vertices.len()];
    for (place, same) in (0u32..).zip(by_place.chunk_by(|&i, &j| vertices[i as usize] == vertices[j as usize])) {
        same.iter().for_each(|&i| number[i as usize] = place);
    }
    number
}

fn signed_volume(origin: Point3, [a, b, c]: [Point3; 3]) -> f64 {
    let v = |p: Point3| glam::DVec3::from_array(p) - glam::DVec3::from_array(origin);
    v(a).dot(v(b).cross(v(c)))
}

/// A triangle perpendicular to an axis, with an area.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct FlatTriangle {
    /// The axis.
    pub(crate) axis: usize,
    /// Where on it the triangle lies.
    pub(crate) at: f64,
    /// Whether its front faces larger coordinates of the axis.
    pub(crate) up: bool,
    /// Its corners, along the other axes ascending.
    pub(crate) corners: [Point2; 3],
}

/// How a k-d tree treats a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum TriangleKind {
    /// Perpendicular to an axis: all three corners have the same coordinate on it, to the last bit.
    Flat(FlatTriangle),
    /// Perpendicular to an axis, but without area.
    Empty,
    /// All others.
    Other,
}

/// The axes other than `axis`, ascending.
pub(crate) const fn others(axis: usize) -> [usize; 2] {
    [(axis == 0) as usize, 2 - (axis == 2) as usize]
}

/// Classifies a triangle. Exact.
pub(crate) fn kind_of(corners: &[Point3; 3]) -> TriangleKind {
    let [a, b, c] = corners;
    let Some(axis) = (0..3).find(|&k| a[k] == b[k] && b[k] == c[k]) else { return TriangleKind::Other };
    let [u, v] = others(axis);
    let flat = corners.map(|p| Point2::new(p[u], p[v]));
    let turn = orient2d(flat[0], flat[1], flat[2]);
    if turn == 0.0 {
        return TriangleKind::Empty;
    }
    // Of the three pairs of other axes, x before z alone is left-handed.
    TriangleKind::Flat(FlatTriangle { axis, at: a[axis], up: (turn > 0.0) != (axis == 1), corners: flat })
}

fn is_flat_axis(corners: &[Point3; 3]) -> bool {
    kind_of(corners) != TriangleKind::Other
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tetrahedron at `x`, its corners repeated for each triangle.
    fn tetrahedron(x: f64, n_sides: usize) -> (Vec<Point3>, Vec<[u32; 3]>) {
        let p = [[x, 0., 0.], [x + 1., 0., 0.], [x, 1., 0.], [x, 0., 1.]];
        let sides = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        let corners = sides[..n_sides].iter().flatten().map(|&i: &usize| p[i]).collect();
        (corners, (0..n_sides as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect())
    }

    fn object(parts: Vec<(Vec<Point3>, Vec<[u32; 3]>)>) -> SceneObject {
        let mut out = SceneObject { name: String::new(), vertices: vec![], triangles: vec![] };
        for (vertices, triangles) in parts {
            let first = out.vertices.len() as u32;
            out.vertices.extend(vertices);
            out.triangles.extend(triangles.into_iter().map(|t| t.map(|i| i + first)));
        }
        out
    }

    #[test]
    fn pieces_are_separated() {
        let mut turned = tetrahedron(9.0, 4);
        turned.1.iter_mut().for_each(|t| t.swap(0, 1));
        let mesh = Mesh::of(&object(vec![tetrahedron(0.0, 4), tetrahedron(5.0, 3), turned]));
        assert_eq!(mesh.piece_of, [0, 0, 0, 0, 1, 1, 1, 2, 2, 2, 2]);
        let what: Vec<_> = mesh.pieces.iter().map(|p| (p.closed, p.axial, p.inverted)).collect();
        assert_eq!(what, [(true, false, false), (false, true, false), (true, false, true)]);
        assert_eq!(mesh.pieces[1].bounds, Aabb { min: [5., 0., 0.], max: [6., 1., 1.] });
        // Where two touch in a corner, they are one.
        let mesh = Mesh::of(&object(vec![tetrahedron(0.0, 4), tetrahedron(1.0, 3)]));
        assert_eq!((mesh.pieces.len(), mesh.pieces[0].closed), (1, false));
    }

    #[test]
    fn fronts_are_known() {
        let (vertices, triangles) = tetrahedron(0.0, 4);
        let kinds: Vec<_> = triangles.iter().map(|t| kind_of(&t.map(|i| vertices[i as usize]))).collect();
        let front = |k: &TriangleKind| if let TriangleKind::Flat(f) = k { Some((f.axis, f.up)) } else { None };
        let fronts: Vec<_> = kinds.iter().map(front).collect();
        assert_eq!(fronts, [Some((2, false)), Some((1, false)), Some((0, false)), None]);
        assert_eq!(kind_of(&[[0., 1., 2.], [0., 2., 4.], [0., 3., 6.]]), TriangleKind::Empty);
        assert_eq!(kind_of(&[[0., 1., 2.], [0., 2., 4.], [0f64.next_up(), 3., 7.]]), TriangleKind::Other);
        assert_eq!((others(0), others(1), others(2)), ([1, 2], [0, 2], [0, 1]));
    }
}
