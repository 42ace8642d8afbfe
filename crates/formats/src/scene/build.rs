//! From corners and triangles to the objects of a scene, the same way for all formats.

use super::error::SceneReadError;
use super::{Axis, LengthUnit, SceneFile, SceneFormat, SceneInfo};
use sightlines_cells::{Point3, Scene, SceneObject};
use sightlines_geometry::coordinate::MIN_MAGNITUDE;
use sightlines_geometry::{CoordinateError, Point2, check_coordinate, orient2d};

/// A mesh of which every corner is used.
#[derive(Debug, Default)]
pub(super) struct Compact {
    /// For each corner its index in the file, ascending.
    pub(super) corners: Vec<usize>,
    /// Triangles as indices into `corners`.
    pub(super) triangles: Vec<[u32; 3]>,
}

impl Compact {
    /// Leaves out the corners that nothing uses: primitives often share one large list of corners.
    ///
    /// * `used`: indices of corners in the file, in any order and with repetitions.
    /// * `triangles`: indices of corners, each of them in `used`; fewer than 2^32 corners are used.
    pub(super) fn new(mut used: Vec<usize>, triangles: impl Iterator<Item = [usize; 3]>) -> Self {
        used.sort_unstable();
        used.dedup();
        used.shrink_to_fit();
        let place = |index: usize| used.partition_point(|&u| u < index) as u32;
        let triangles = triangles.map(|t| t.map(place)).collect();
        Self { corners: used, triangles }
    }
}

/// The objects read so far.
#[derive(Debug, Default)]
pub(super) struct Builder {
    objects: Vec<SceneObject>,
    n_degenerate: usize,
}

impl Builder {
    /// Adds an object, without those of its triangles that have no area.
    ///
    /// `mirrored` turns every triangle round, so that fronts stay fronts.
    pub(super) fn add(
        &mut self,
        name: String,
        vertices: Vec<Point3>,
        triangles: impl Iterator<Item = [u32; 3]>,
        mirrored: bool,
    ) {
        let mut n_all = 0;
        let counted = triangles.inspect(|_| n_all += 1);
        let turned = counted.map(|[a, b, c]| if mirrored { [a, c, b] } else { [a, b, c] });
        let triangles: Vec<_> = turned.filter(|t| !are_collinear(t.map(|i| vertices[i as usize]))).collect();
        self.n_degenerate += n_all - triangles.len();
        self.objects.push(SceneObject { name, vertices, triangles });
    }

    /// The scene, if there is anything to see in it.
    pub(super) fn finish(self, format: SceneFormat) -> Result<SceneFile, SceneReadError> {
        let (n_objects, n_degenerate) = (self.objects.len(), self.n_degenerate);
        let scene = Scene::new(self.objects)?;
        let n_triangles = scene.n_triangles();
        if n_triangles == 0 {
            return Err(SceneReadError::NoTriangles { n_objects, n_degenerate });
        }
        let says_more = format == SceneFormat::Gltf;
        let info = SceneInfo {
            format,
            up: Axis::Y,
            up_is_assumed: !says_more,
            unit: if says_more { LengthUnit::Metre } else { LengthUnit::Unknown },
            n_objects,
            n_objects_without_triangles: scene.objects().iter().filter(|o| o.triangles.is_empty()).count(),
            n_triangles,
            n_degenerate_triangles: n_degenerate,
        };
        Ok(SceneFile { scene, info })
    }
}

/// Whether three points lie on one line, exactly: they do in all three projections.
fn are_collinear([a, b, c]: [Point3; 3]) -> bool {
    let flat = |u: usize, v: usize| {
        let [a, b, c] = [a, b, c].map(|p| Point2::new(p[u], p[v]));
        orient2d(a, b, c) == 0.0
    };
    flat(0, 1) && flat(1, 2) && flat(2, 0)
}

/// A point for the scene. What is nearer to zero than a coordinate may be becomes zero: such numbers are
/// what rounding leaves of zeros, when a file was written or where transforms are composed.
pub(super) fn check_point(p: Point3) -> Result<Point3, CoordinateError> {
    let [x, y, z] = p.map(|x| if x.abs() < MIN_MAGNITUDE { 0.0 } else { x });
    Ok([check_coordinate(x)?, check_coordinate(y)?, check_coordinate(z)?])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn collinear_is_exact() {
        let line = |t: f64| [1.0 + t, 2.0 - 3.0 * t, 0.5 * t];
        assert!(are_collinear([line(0.0), line(1.0), line(-7.0)]));
        assert!(are_collinear([line(0.0), line(0.0), [9.0, 8.0, 7.0]]));
        // One unit in the last place off a line along an axis, at any distance.
        let off = 1e7_f64.next_up();
        assert!(!are_collinear([[0.0, 1e7, 1e7], [1.0, 1e7, 1e7], [2.0, 1e7, off]]));
        assert!(!are_collinear([[1e7, 0.0, 0.0], [1e7, 0.0, 5.0], [off, 0.0, 9.0]]));
    }

    #[test]
    fn unused_corners_are_left_out() {
        let compact = Compact::new(vec![9, 4, 4, 7], [[9, 4, 7]].into_iter());
        assert_eq!((compact.corners, compact.triangles), (vec![4, 7, 9], vec![[2, 0, 1]]));
    }

    #[test]
    fn coordinates_are_checked() {
        assert_eq!(check_point([1.0, -1e-45, -0.0]).unwrap().map(f64::to_bits), [1.0, 0.0, 0.0].map(f64::to_bits));
        assert!(check_point([1.0, f64::NAN, 0.0]).is_err() && check_point([1e300, 0.0, 0.0]).is_err());
    }
}
