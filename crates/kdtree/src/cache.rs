//! What is cached of a scene for the next one, which may share most of its objects.

use crate::coplanar::FlatRect;
use crate::mesh::{FlatTriangle, Mesh, TriangleKind, kind_of};
use sightlines_cells::{Point3, Scene, SceneObject};
use sightlines_geometry::Aabb;
use std::collections::BTreeMap;
use std::sync::{Arc, OnceLock};

/// The classified triangles of an object. What depends on them alone is computed once.
#[derive(Debug)]
pub(crate) struct Shape {
    vertices: Vec<Point3>,
    triangles: Vec<[u32; 3]>,
    /// Smallest box around the corners.
    pub(crate) bounds: Aabb<3>,
    /// The axis-parallel triangles with an area, and which they are.
    pub(crate) flat: Vec<(u32, FlatTriangle)>,
    /// Axis-parallel triangles without area.
    pub(crate) n_empty: usize,
    /// All other triangles.
    pub(crate) n_other: usize,
    /// Its pieces, computed on first use.
    pub(crate) mesh: OnceLock<Arc<Mesh>>,
}

impl Shape {
    /// Whether at least half of its triangles are axis-parallel.
    pub(crate) fn is_mostly_flat(&self) -> bool {
        self.flat.len() >= self.n_other
    }

    /// The same, and they are not all across one axis.
    pub(crate) fn stands_along_axes(&self) -> bool {
        let mut axes = self.flat.iter().map(|(_, triangle)| triangle.axis);
        self.is_mostly_flat() && axes.next().is_some_and(|first| axes.any(|axis| axis != first))
    }

    pub(crate) fn of(object: &SceneObject) -> Self {
        let (mut flat, mut n_empty, mut n_other) = (Vec::new(), 0, 0);
        for (triangle, corners) in (0u32..).zip(object.corners()) {
            match kind_of(&corners) {
                TriangleKind::Other => n_other += 1,
                TriangleKind::Empty => n_empty += 1,
                TriangleKind::Flat(found) => flat.push((triangle, found)),
            }
        }
        let (vertices, triangles) = (object.vertices.clone(), object.triangles.clone());
        Self { vertices, triangles, bounds: object.bounds(), flat, n_empty, n_other, mesh: OnceLock::new() }
    }

    /// Whether an object has these triangles. Names do not matter.
    fn is_of(&self, object: &SceneObject) -> bool {
        self.vertices == object.vertices && self.triangles == object.triangles
    }

    /// Equal for equal objects; unequal for most others.
    fn key(vertices: &[Point3], triangles: &[[u32; 3]]) -> ([u64; 3], usize, usize) {
        // Negative zero is zero.
        (vertices.first().map_or([0; 3], |p| p.map(|x| (x + 0.0).to_bits())), vertices.len(), triangles.len())
    }
}

/// The triangles of a plane that hide, and the rectangles in them.
#[derive(Debug, Clone)]
pub(crate) struct PlaneFaces {
    /// Each with whether it is of a closed piece.
    pub(crate) triangles: Vec<(FlatTriangle, bool)>,
    /// Disjoint rectangles.
    pub(crate) rects: Vec<FlatRect>,
    /// How many regions were left out because they are small.
    pub(crate) n_small: usize,
}

/// Planes by axis and the place on it, see [`total_order`].
pub(crate) type Planes = BTreeMap<(usize, u64), PlaneFaces>;

/// What is cached of a scene. Results are the same with and without it.
#[derive(Debug, Clone, Default)]
pub(crate) struct FaceCache {
    shapes: Vec<Arc<Shape>>,
    /// The size below which things were detail for these planes.
    detail_below: f64,
    pub(crate) planes: Planes,
}

impl FaceCache {
    /// The shapes of a scene's objects, which become the cached ones. An object that equals one of the last scene, at
    /// any index, reuses its shape.
    pub(crate) fn shapes_of(&mut self, scene: &Scene) -> Vec<Arc<Shape>> {
        let before = std::mem::take(&mut self.shapes);
        let mut by_key = None;
        let mut find = |object: &SceneObject| {
            let sorted = by_key.get_or_insert_with(|| {
                let mut sorted: Vec<_> =
                    before.iter().map(|shape| (Shape::key(&shape.vertices, &shape.triangles), shape)).collect();
                sorted.sort_by_key(|s| s.0);
                sorted
            });
            let key = Shape::key(&object.vertices, &object.triangles);
            let first = sorted.partition_point(|s| s.0 < key);
            let same = sorted[first..].iter().take_while(|s| s.0 == key).find(|s| s.1.is_of(object));
            same.map(|s| Arc::clone(s.1))
        };
        let shape = |(i, object): (usize, &SceneObject)| match before.get(i).filter(|shape| shape.is_of(object)) {
            Some(same) => Arc::clone(same),
            None if before.is_empty() => Arc::new(Shape::of(object)),
            None => find(object).unwrap_or_else(|| Arc::new(Shape::of(object))),
        };
        self.shapes = scene.objects().iter().enumerate().map(shape).collect();
        self.shapes.clone()
    }

    /// Takes the planes of the last scene, if things of this size were detail.
    pub(crate) fn take_planes(&mut self, detail_below: f64) -> Planes {
        let planes = std::mem::take(&mut self.planes);
        let before = std::mem::replace(&mut self.detail_below, detail_below);
        if before == detail_below { planes } else { Planes::new() }
    }
}

/// A double as a number with the order of [`f64::total_cmp`].
pub(crate) fn total_order(x: f64) -> u64 {
    let bits = x.to_bits();
    if bits >> 63 == 1 { !bits } else { bits | 1 << 63 }
}
