//! The orientation predicate of space: on which side of an oriented plane does a point lie?
//!
//! Source: Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric
//! Predicates", Discrete Comput. Geom. 18, 1997, section 4 (the `robust` crate).

use crate::Point3;

/// Positive if `d` lies on the side of the plane through `a`, `b` and `c` that their right-hand normal
/// `(b - a) × (c - a)` points to, negative on the other side, zero if the four are coplanar.
///
/// The sign is exact for all coordinates that [`check_coordinate`](crate::check_coordinate) accepts; only the
/// sign means anything. The same as: how the directed lines `a` to `b` and `c` to `d` pass each other.
#[inline]
pub fn orient3d(a: Point3, b: Point3, c: Point3, d: Point3) -> f64 {
    let coord = |p: Point3| robust::Coord3D { x: p[0], y: p[1], z: p[2] };
    // `robust` calls the side positive from which the three go round clockwise.
    -robust::orient3d(coord(a), coord(b), coord(c), coord(d))
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_rational::BigRational;
    use num_traits::{Signed, Zero};
    use proptest::prelude::*;

    /// The oracle: the determinant in rational arithmetic.
    fn sign([a, b, c, d]: [Point3; 4]) -> i32 {
        let rational = |x: f64| BigRational::from_float(x).unwrap();
        let [u, v, w] = [b, c, d].map(|p| [0, 1, 2].map(|k| rational(p[k]) - rational(a[k])));
        let minor = |i: usize, j: usize| u[i].clone() * v[j].clone() - u[j].clone() * v[i].clone();
        let det = minor(1, 2) * w[0].clone() + minor(2, 0) * w[1].clone() + minor(0, 1) * w[2].clone();
        if det.is_zero() {
            0
        } else if det.is_positive() {
            1
        } else {
            -1
        }
    }

    fn sign_of(x: f64) -> i32 {
        i32::from(x > 0.0) - i32::from(x < 0.0)
    }

    /// Points a few ulps around a coarse grid.
    fn nasty() -> impl Strategy<Value = Point3> {
        let coordinate = (-3i32..4, -2i64..3).prop_map(|(g, ulps)| {
            let x = f64::from(g) * 0.1;
            if x == 0.0 { 0.0 } else { f64::from_bits(x.to_bits().wrapping_add_signed(ulps)) }
        });
        [coordinate.clone(), coordinate.clone(), coordinate]
    }

    proptest! {
        #[test]
        fn orientation_in_space_is_exact(p in [nasty(), nasty(), nasty(), nasty()]) {
            let [a, b, c, d] = p;
            prop_assert_eq!(sign_of(orient3d(a, b, c, d)), sign(p), "{:?}", p);
        }
    }

    #[test]
    fn the_right_hand_side_is_positive() {
        let (o, x, y, z) = ([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
        assert!(orient3d(o, x, y, z) > 0.0);
        assert!(orient3d(o, y, x, z) < 0.0);
        assert_eq!(orient3d(o, x, y, [5.0, 7.0, 0.0]), 0.0);
    }
}
