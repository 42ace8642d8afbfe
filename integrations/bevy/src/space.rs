//! Affine maps in double precision, as arrays: Bevy's transforms are in single precision, and so are their inverses.

use bevy::math::{Affine3A, Mat4};

/// A point or a vector.
pub(crate) type Point = [f64; 3];

/// An affine map: the images of the axes, then that of the origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Affine {
    axes: [Point; 3],
    origin: Point,
}

fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

impl Affine {
    /// Maps every point to itself.
    pub(crate) const IDENTITY: Self =
        Self { axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], origin: [0.0; 3] };

    /// The same map as one of Bevy's.
    pub(crate) fn of(map: Affine3A) -> Self {
        let columns = map.to_cols_array_2d();
        let [x, y, z, origin] = columns.map(|column| column.map(f64::from));
        Self { axes: [x, y, z], origin }
    }

    /// Where a vector points to.
    fn turn(&self, v: Point) -> Point {
        std::array::from_fn(|k| self.axes[0][k] * v[0] + self.axes[1][k] * v[1] + self.axes[2][k] * v[2])
    }

    /// Where a point is mapped to.
    pub(crate) fn point(&self, p: Point) -> Point {
        let v = self.turn(p);
        std::array::from_fn(|k| v[k] + self.origin[k])
    }

    /// First `inner`, then this.
    pub(crate) fn after(&self, inner: &Self) -> Self {
        Self { axes: inner.axes.map(|axis| self.turn(axis)), origin: self.point(inner.origin) }
    }

    /// The map back; `None` if there is none, or its numbers are not finite.
    pub(crate) fn inverse(&self) -> Option<Self> {
        let [x, y, z] = self.axes;
        let volume = dot(cross(x, y), z);
        let rows = [cross(y, z), cross(z, x), cross(x, y)].map(|row| row.map(|v| v / volume));
        let axes = std::array::from_fn(|k| rows.map(|row| row[k]));
        let turned = Self { axes, origin: [0.0; 3] };
        let inverse = Self { origin: turned.turn(self.origin).map(|v| -v), ..turned };
        (volume != 0.0 && inverse.is_finite()).then_some(inverse)
    }

    /// Whether all numbers are finite.
    fn is_finite(&self) -> bool {
        self.axes.iter().chain([&self.origin]).flatten().all(|v| v.is_finite())
    }

    /// Where the origin is mapped to.
    pub(crate) const fn origin(&self) -> Point {
        self.origin
    }

    /// The smallest box, along the axes, around the images of a box's corners.
    pub(crate) fn box_around(&self, min: Point, max: Point) -> (Point, Point) {
        around(corners(min, max).map(|corner| self.point(corner)))
    }

    /// `projection` after this map, by columns.
    pub(crate) fn projected(&self, projection: &Mat4) -> [[f64; 4]; 4] {
        let columns = projection.to_cols_array_2d().map(|column| column.map(f64::from));
        let image = |v: Point, w: f64| -> [f64; 4] {
            std::array::from_fn(|k| {
                columns[0][k] * v[0] + columns[1][k] * v[1] + columns[2][k] * v[2] + columns[3][k] * w
            })
        };
        let [x, y, z] = self.axes;
        [image(x, 0.0), image(y, 0.0), image(z, 0.0), image(self.origin, 1.0)]
    }
}

/// The corners of a box.
pub(crate) fn corners(min: Point, max: Point) -> [Point; 8] {
    std::array::from_fn(|i| std::array::from_fn(|k| if i >> k & 1 == 0 { min[k] } else { max[k] }))
}

/// The smallest box around some points.
pub(crate) fn around<const N: usize>(points: [Point; N]) -> (Point, Point) {
    let start = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    points.iter().fold(start, |(min, max), point| {
        (std::array::from_fn(|k| min[k].min(point[k])), std::array::from_fn(|k| max[k].max(point[k])))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::math::{Quat, Vec3};

    #[test]
    fn an_inverse_undoes_its_map_and_a_flat_map_has_none() {
        let map = Affine3A::from_scale_rotation_translation(
            Vec3::new(2.0, 0.5, -3.0),
            Quat::from_rotation_y(0.7),
            Vec3::new(10.0, -20.0, 30.0),
        );
        let map = Affine::of(map);
        let inverse = map.inverse().expect("it has one");
        let p = inverse.point(map.point([1.0, 2.0, 3.0]));
        assert!((0..3).all(|k| (p[k] - [1.0, 2.0, 3.0][k]).abs() < 1e-12), "{p:?}");
        let same = map.after(&inverse);
        assert!(same.point([4.0, 5.0, 6.0]).iter().zip([4.0, 5.0, 6.0]).all(|(a, b)| (a - b).abs() < 1e-12));
        let flat = Affine::of(Affine3A::from_scale(Vec3::new(1.0, 0.0, 1.0)));
        assert_eq!(flat.inverse(), None);
        assert_eq!(Affine::of(Affine3A::from_translation(Vec3::splat(f32::NAN))).inverse(), None);
    }

    #[test]
    fn a_turned_box_is_bounded_by_its_corners() {
        let quarter = Affine::of(Affine3A::from_rotation_y(std::f32::consts::FRAC_PI_2));
        let (min, max) = quarter.box_around([0.0, 0.0, 0.0], [1.0, 2.0, 3.0]);
        let close = |a: Point, b: Point| (0..3).all(|k| (a[k] - b[k]).abs() < 1e-6);
        assert!(close(min, [0.0, 0.0, -1.0]) && close(max, [3.0, 2.0, 0.0]), "{min:?} {max:?}");
    }
}
