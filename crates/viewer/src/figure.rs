//! What is drawn beside the table: the triangles of a scene, or the walls of a plan, in single precision from an origin.

use sightlines_cells::{Plan, Scene};
use sightlines_geometry::Point3;

/// Triangles of objects, or walls. Only ever drawn: no decision is made by it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Figure {
    pub(crate) origin: [f64; 3],
    /// Both ends of each wall.
    pub(crate) walls: Vec<[f32; 4]>,
    pub(crate) vertices: Vec<[f32; 3]>,
    pub(crate) triangles: Vec<[u32; 3]>,
    /// The first triangle of each object, and the end.
    pub(crate) firsts: Vec<u32>,
    /// Triangles that were left out.
    pub(crate) n_left_out: usize,
    /// Whether some faces that hide have one side.
    pub(crate) is_single_sided: bool,
}

/// The difference of two coordinates in single precision.
fn from(origin: f64, x: f64) -> f32 {
    (x - origin) as f32
}

impl Figure {
    /// The triangles of a scene, whose objects are those of the table. O(triangles).
    pub fn of_scene(scene: &Scene) -> Self {
        let objects = scene.objects();
        Self::of_objects(objects.iter().map(|object| (&object.vertices[..], &object.triangles[..])))
    }

    /// The same, with whether faces that hide have one side in the file: the page draws both, and states where the table is for others that
    /// do not. A scene that was read as if all had two sides does not tell.
    #[must_use]
    pub fn with_single_sided(self, is_single_sided: bool) -> Self {
        Self { is_single_sided, ..self }
    }

    /// Objects that are made of polygons, such as the faces of a Quake map, each polygon as a fan of triangles. O(corners).
    pub fn of_polygons<'a>(objects: impl Iterator<Item = impl Iterator<Item = &'a [Point3]>>) -> Self {
        let fans = |polygons: &mut dyn Iterator<Item = &'a [Point3]>| {
            let (mut corners, mut triangles) = (Vec::new(), Vec::new());
            for polygon in polygons {
                let first = corners.len() as u32;
                triangles.extend((2..polygon.len() as u32).map(|k| [first, first + k - 1, first + k]));
                corners.extend(polygon);
            }
            (corners, triangles)
        };
        let objects: Vec<(Vec<Point3>, Vec<[u32; 3]>)> = objects.map(|mut polygons| fans(&mut polygons)).collect();
        Self::of_objects(objects.iter().map(|(corners, triangles)| (&corners[..], &triangles[..])))
    }

    /// The lines of a plan that block sight, and its joints. O(lines).
    pub fn of_plan(plan: &Plan) -> Self {
        let bounds = plan.bounds();
        let origin = if bounds.is_empty() { [0.0; 3] } else { [middle(&bounds, 0), middle(&bounds, 1), 0.0] };
        let wall = |a: sightlines_geometry::Point2, b: sightlines_geometry::Point2| {
            [from(origin[0], a.x), from(origin[1], a.y), from(origin[0], b.x), from(origin[1], b.y)]
        };
        let walls = plan.walls().map(|segment| wall(segment.a, segment.b)).collect();
        Self { origin, walls, ..Self::default() }
    }

    fn of_objects<'a>(objects: impl Iterator<Item = (&'a [Point3], &'a [[u32; 3]])> + Clone) -> Self {
        let mut low = [f64::INFINITY; 3];
        let mut high = [f64::NEG_INFINITY; 3];
        for p in objects.clone().flat_map(|(vertices, _)| vertices) {
            for (k, &x) in p.iter().enumerate() {
                (low[k], high[k]) = (low[k].min(x), high[k].max(x));
            }
        }
        let origin = if low[0] <= high[0] { std::array::from_fn(|k| 0.5 * (low[k] + high[k])) } else { [0.0; 3] };
        let mut figure = Self { origin, firsts: vec![0], ..Self::default() };
        for (vertices, triangles) in objects {
            let first = figure.vertices.len() as u32;
            let placed = |p: &Point3| std::array::from_fn(|k| from(origin[k], p[k]));
            figure.vertices.extend(vertices.iter().map(placed));
            figure.triangles.extend(triangles.iter().map(|t| t.map(|i| first + i)));
            figure.firsts.push(figure.triangles.len() as u32);
        }
        figure
    }

    /// Number of triangles that are drawn.
    pub fn n_triangles(&self) -> usize {
        self.triangles.len()
    }

    /// The same with at most `most` triangles: the largest ones, of all objects together, in their order. What is left out is
    /// counted, and said on the page. O(n log n).
    #[must_use]
    pub fn with_at_most(&self, most: usize) -> Self {
        if self.triangles.len() <= most {
            return self.clone();
        }
        let mut by_size: Vec<u32> = (0..self.triangles.len() as u32).collect();
        let size = |t: u32| self.size(self.triangles[t as usize]);
        by_size.sort_by(|&a, &b| size(b).total_cmp(&size(a)).then(a.cmp(&b)));
        let mut kept = vec![false; self.triangles.len()];
        by_size[..most].iter().for_each(|&t| kept[t as usize] = true);
        let is_single_sided = self.is_single_sided;
        let mut less = Self { origin: self.origin, firsts: vec![0], is_single_sided, ..Self::default() };
        let mut renamed = vec![u32::MAX; self.vertices.len()];
        for range in self.firsts.windows(2) {
            for t in (range[0]..range[1]).filter(|&t| kept[t as usize]) {
                let corners = self.triangles[t as usize].map(|i| {
                    let name = &mut renamed[i as usize];
                    if *name == u32::MAX {
                        *name = less.vertices.len() as u32;
                        less.vertices.push(self.vertices[i as usize]);
                    }
                    *name
                });
                less.triangles.push(corners);
            }
            less.firsts.push(less.triangles.len() as u32);
        }
        less.n_left_out = self.n_left_out + self.triangles.len() - most;
        less
    }

    /// The square of twice the area.
    fn size(&self, triangle: [u32; 3]) -> f64 {
        let [a, b, c] = triangle.map(|i| self.vertices[i as usize].map(f64::from));
        let side = |p: [f64; 3]| std::array::from_fn::<f64, 3, _>(|k| p[k] - a[k]);
        let ([x, y, z], [u, v, w]) = (side(b), side(c));
        let cross = [y * w - z * v, z * u - x * w, x * v - y * u];
        cross.iter().map(|x| x * x).sum()
    }

    /// Walls, vertices, triangles, first triangles: little-endian numbers of four bytes.
    pub(crate) fn to_bytes(&self) -> Vec<u8> {
        let floats = self.walls.as_flattened().iter().chain(self.vertices.as_flattened());
        let mut bytes: Vec<u8> = floats.flat_map(|x| x.to_le_bytes()).collect();
        let firsts: &[u32] = if self.firsts.len() > 1 { &self.firsts } else { &[] };
        bytes.extend(self.triangles.as_flattened().iter().chain(firsts).flat_map(|i| i.to_le_bytes()));
        bytes
    }

    /// Number of objects.
    pub(crate) fn n_objects(&self) -> usize {
        self.firsts.len().saturating_sub(1)
    }
}

fn middle(bounds: &sightlines_geometry::Aabb<2>, k: usize) -> f64 {
    0.5 * (bounds.min[k] + bounds.max[k])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quad(x: f64, size: f64) -> Vec<Point3> {
        [[0.0, 0.0], [size, 0.0], [size, size], [0.0, size]].map(|[y, z]| [x, y, z]).to_vec()
    }

    #[test]
    fn the_largest_triangles_stay() {
        let faces = [quad(0.0, 1.0), quad(1.0, 3.0), quad(2.0, 2.0), vec![]];
        let all = Figure::of_polygons(faces.iter().map(|face| std::iter::once(&face[..])));
        assert_eq!((all.n_triangles(), all.n_objects(), &all.firsts[..]), (6, 4, &[0, 2, 4, 6, 6][..]));
        assert_eq!(all.with_at_most(6), all);
        let less = all.with_at_most(3);
        assert_eq!((less.n_triangles(), less.n_left_out, &less.firsts[..]), (3, 3, &[0, 0, 2, 3, 3][..]));
        assert!(all.clone().with_single_sided(true).with_at_most(3).is_single_sided && !less.is_single_sided);
        let largest = less.triangles[0].map(|i| less.vertices[i as usize]);
        assert_eq!(largest.map(|p| p[0]), [0.0; 3], "the second quad, from the middle of all");
        assert_eq!(all.to_bytes().len(), 4 * (3 * 12 + 3 * 6 + 5));
    }
}
