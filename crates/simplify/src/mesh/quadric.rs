//! Sums of squared distances to planes.

use sightlines_geometry::Point3;

/// A sum of weighted squared distances to planes, as a function of a point.
///
/// # Source
/// Garland and Heckbert, "Surface simplification using quadric error metrics", SIGGRAPH 1997.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Quadric {
    /// xx, xy, xz, yy, yz, zz.
    square: [f64; 6],
    linear: Point3,
    constant: f64,
}

impl Quadric {
    /// The plane through a point with a normal of any length; zero if it has none.
    pub(super) fn plane(normal: Point3, through: Point3, weight: f64) -> Self {
        let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
        let [x, y, z] = normal.map(|n| n / length);
        let d = -(x * through[0] + y * through[1] + z * through[2]);
        let quadric = Self {
            square: [x * x, x * y, x * z, y * y, y * z, z * z].map(|q| q * weight),
            linear: [x, y, z].map(|n| n * d * weight),
            constant: d * d * weight,
        };
        if quadric.constant.is_finite() && quadric.square.iter().all(|q| q.is_finite()) {
            quadric
        } else {
            Self::default()
        }
    }

    pub(super) fn add(&mut self, other: &Self) {
        (0..6).for_each(|k| self.square[k] += other.square[k]);
        (0..3).for_each(|k| self.linear[k] += other.linear[k]);
        self.constant += other.constant;
    }

    /// Its value at a point; never negative.
    pub(super) fn at(&self, [x, y, z]: Point3) -> f64 {
        let q = &self.square;
        let square = q[0] * x * x + q[3] * y * y + q[5] * z * z + 2.0 * (q[1] * x * y + q[2] * x * z + q[4] * y * z);
        let linear = 2.0 * (self.linear[0] * x + self.linear[1] * y + self.linear[2] * z);
        (square + linear + self.constant).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_squared_and_added() {
        let mut q = Quadric::plane([0.0, 0.0, 5.0], [1.0, 2.0, 3.0], 2.0);
        assert!((q.at([7.0, 8.0, 4.5]) - 4.5).abs() < 1e-12);
        q.add(&Quadric::plane([1.0, 1.0, 0.0], [0.0; 3], 1.0));
        assert!((q.at([1.0, 1.0, 3.0]) - 2.0).abs() < 1e-12);
        assert_eq!(Quadric::plane([0.0; 3], [1.0; 3], 1.0), Quadric::default());
    }
}
