//! The predicates that a witness of visibility stands on: is a segment free?
//!
//! Signs of determinants of input coordinates, computed exactly (`geometry`, which wraps Shewchuk's adaptive predicates). Each errs
//! towards "not certain", where a segment touches something or runs along it; so what is certain is true of a whole
//! neighbourhood of the segment, which is an open set of lines.

use sightlines_geometry::{Point2, Point3, orient2d, orient3d};

/// Whether the closed segments `p q` and `a b` have certainly no point in common; exact but for segments on one line, which are
/// never certain.
pub fn segments_apart(p: Point2, q: Point2, a: Point2, b: Point2) -> bool {
    let same_side = |s: f64, t: f64| (s > 0.0 && t > 0.0) || (s < 0.0 && t < 0.0);
    same_side(orient2d(p, q, a), orient2d(p, q, b)) || same_side(orient2d(a, b, p), orient2d(a, b, q))
}

/// Whether the closed segment `p q` has certainly no point in common with the closed triangle; exact but for segments in the
/// triangle's plane, which are never certain.
///
/// If the line through `p` and `q` meets the triangle and is not in its plane, it passes all three edges on the same side,
/// or touches them.
pub fn segment_and_triangle_apart(p: Point3, q: Point3, [a, b, c]: &[Point3; 3]) -> bool {
    let (sp, sq) = (orient3d(*a, *b, *c, p), orient3d(*a, *b, *c, q));
    if (sp > 0.0 && sq > 0.0) || (sp < 0.0 && sq < 0.0) {
        return true;
    }
    let edges = edge_sides(p, q, [a, b, c]);
    edges.iter().any(|&s| s > 0.0) && edges.iter().any(|&s| s < 0.0)
}

/// Whether the segment `p q` crosses the open triangle from one side to the other. Exact.
pub fn segment_crosses_triangle(p: Point3, q: Point3, [a, b, c]: &[Point3; 3]) -> bool {
    let (sp, sq) = (orient3d(*a, *b, *c, p), orient3d(*a, *b, *c, q));
    let edges = edge_sides(p, q, [a, b, c]);
    ((sp > 0.0 && sq < 0.0) || (sp < 0.0 && sq > 0.0))
        && (edges.iter().all(|&s| s > 0.0) || edges.iter().all(|&s| s < 0.0))
}

/// Whether the segment `p q` crosses the inside of a flat convex polygon from one side to the other. Exact for polygons with all corners in
/// one plane.
pub fn segment_crosses_polygon(p: Point3, q: Point3, corners: &[Point3]) -> bool {
    let &[a, b, c, ..] = corners else { return false };
    let (sp, sq) = (orient3d(a, b, c, p), orient3d(a, b, c, q));
    let sides = || corners.iter().zip(corners.iter().cycle().skip(1)).map(|(&a, &b)| orient3d(p, q, a, b));
    ((sp > 0.0 && sq < 0.0) || (sp < 0.0 && sq > 0.0)) && (sides().all(|s| s > 0.0) || sides().all(|s| s < 0.0))
}

/// Whether the closed segment `p q` has certainly no point in common with a flat convex polygon: with none of the triangles that its first
/// corner makes with its edges.
pub fn segment_and_polygon_apart(p: Point3, q: Point3, corners: &[Point3]) -> bool {
    let Some((&first, rest)) = corners.split_first() else { return true };
    rest.windows(2).all(|edge| segment_and_triangle_apart(p, q, &[first, edge[0], edge[1]]))
}

fn edge_sides(p: Point3, q: Point3, [a, b, c]: [&Point3; 3]) -> [f64; 3] {
    [orient3d(p, q, *a, *b), orient3d(p, q, *b, *c), orient3d(p, q, *c, *a)]
}

/// Whether `p` is strictly inside the convex polygon with these counter-clockwise corners. Exact.
pub fn strictly_in_polygon(polygon: &[Point2], p: Point2) -> bool {
    let n = polygon.len();
    n >= 3 && (0..n).all(|i| polygon[i] == polygon[(i + 1) % n] || orient2d(polygon[i], polygon[(i + 1) % n], p) > 0.0)
}

/// Whether the open insides of two convex polygons with counter-clockwise corners have no point in common. Exact: then a line through
/// a side of one of them separates them.
pub fn insides_apart(a: &[Point2], b: &[Point2]) -> bool {
    let separates = |sides: &[Point2], others: &[Point2]| {
        let n = sides.len();
        (0..n).any(|i| {
            let (s, t) = (sides[i], sides[(i + 1) % n]);
            s != t && others.iter().all(|&p| orient2d(s, t, p) <= 0.0)
        })
    };
    separates(a, b) || separates(b, a)
}

/// A coordinate that the predicates take: what is too near to zero becomes zero.
pub fn snapped(p: Point3) -> Point3 {
    const LEAST: f64 = 1e-30;
    p.map(|x| if x.abs() < LEAST { 0.0 } else { x })
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_rational::BigRational;
    use num_traits::{One, Zero};
    use proptest::prelude::*;

    fn small() -> impl Strategy<Value = [f64; 3]> {
        [-3i32..4, -3i32..4, -3i32..4].prop_map(|p| p.map(f64::from))
    }

    /// The oracle: all points that the line through `p` and `q` has in common with the triangle, by Cramer's rule in rational
    /// numbers; `None` for a line in its plane or parallel to it.
    fn meeting(p: Point3, q: Point3, t: &[Point3; 3]) -> Option<(BigRational, [BigRational; 3])> {
        let r = |x: f64| BigRational::from_float(x).unwrap();
        let sub = |a: Point3, b: Point3| [0, 1, 2].map(|k| r(a[k]) - r(b[k]));
        let det = |u: &[BigRational; 3], v: &[BigRational; 3], w: &[BigRational; 3]| {
            let m = |i: usize, j: usize| v[i].clone() * w[j].clone() - v[j].clone() * w[i].clone();
            u[0].clone() * m(1, 2) - u[1].clone() * m(0, 2) + u[2].clone() * m(0, 1)
        };
        // p + s (q - p) = a + v (b - a) + w (c - a)
        let (d, e, f, o) = (sub(p, q), sub(t[1], t[0]), sub(t[2], t[0]), sub(p, t[0]));
        let all = det(&d, &e, &f);
        if all.is_zero() {
            return None;
        }
        let (s, v, w) = (det(&o, &e, &f) / &all, det(&d, &o, &f) / &all, det(&d, &e, &o) / &all);
        Some((s, [BigRational::one() - &v - &w, v, w]))
    }

    proptest! {
        #[test]
        fn triangles_and_segments_as_in_rational_numbers(p in small(), q in small(), t in [small(), small(), small()]) {
            let Some((s, weights)) = meeting(p, q, &t) else { return Ok(()) };
            let (zero, one) = (BigRational::zero(), BigRational::one());
            let meets = s >= zero && s <= one && weights.iter().all(|w| *w >= zero);
            let crosses = s > zero && s < one && weights.iter().all(|w| *w > zero);
            prop_assert_eq!(segment_and_triangle_apart(p, q, &t), !meets);
            prop_assert_eq!(segment_crosses_triangle(p, q, &t), crosses);
            prop_assert_eq!(segment_crosses_polygon(p, q, &t), crosses);
            prop_assert_eq!(segment_and_polygon_apart(p, q, &t), !meets);
            // The parallelogram of which the triangle is one half.
            let half = |a: Point3, b: Point3, c: Point3| [0, 1, 2].map(|k| a[k] + c[k] - b[k]);
            let quad = [t[0], t[1], t[2], half(t[0], t[1], t[2])];
            let [u, v] = [weights[0].clone(), weights[2].clone()];
            let along = |x: &BigRational| [*x > zero && *x < one, *x >= zero && *x <= one];
            // A point of the plane is `b + u (a - b) + v (c - b)`.
            let [u, v] = [along(&u), along(&v)];
            prop_assert_eq!(segment_crosses_polygon(p, q, &quad), s > zero && s < one && u[0] && v[0]);
            prop_assert_eq!(segment_and_polygon_apart(p, q, &quad), !(s >= zero && s <= one && u[1] && v[1]));
        }

        #[test]
        fn segments_apart_are_those_that_do_not_meet(p in small(), q in small(), a in small(), b in small()) {
            let [p, q, a, b] = [p, q, a, b].map(|p| Point2::new(p[0], p[1]));
            prop_assume!(p != q && a != b);
            let meets = sightlines_geometry::Segment2::new(p, q).meets(&sightlines_geometry::Segment2::new(a, b));
            let on_one_line = orient2d(p, q, a) == 0.0 && orient2d(p, q, b) == 0.0;
            prop_assert_eq!(segments_apart(p, q, a, b), !meets && !on_one_line);
        }

        #[test]
        fn insides_apart_have_no_common_point(a in [small(), small(), small()], b in [small(), small(), small()]) {
            let flat = |t: [Point3; 3]| t.map(|p| Point2::new(p[0], p[1]));
            let turned = |t: [Point2; 3]| if orient2d(t[0], t[1], t[2]) < 0.0 { [t[0], t[2], t[1]] } else { t };
            let [a, b] = [a, b].map(|t| turned(flat(t)));
            prop_assume!(orient2d(a[0], a[1], a[2]) > 0.0 && orient2d(b[0], b[1], b[2]) > 0.0);
            // Insides that meet do so in a point of a fine grid, as areas of this size go.
            let common = (-60..61).flat_map(|x| (-60..61).map(move |y| Point2::new(f64::from(x) * 0.0503, f64::from(y) * 0.0497)))
                .any(|p| strictly_in_polygon(&a, p) && strictly_in_polygon(&b, p));
            if common {
                prop_assert!(!insides_apart(&a, &b));
            }
        }
    }

    #[test]
    fn touching_is_not_apart_and_not_inside() {
        let t = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
        let through = |x: f64, y: f64| ([x, y, -1.0], [x, y, 1.0]);
        let (p, q) = through(1.0, 1.0);
        assert!(segment_crosses_triangle(p, q, &t) && !segment_and_triangle_apart(p, q, &t));
        for (x, y) in [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0)] {
            let (p, q) = through(x, y);
            assert!(!segment_crosses_triangle(p, q, &t) && !segment_and_triangle_apart(p, q, &t), "{x} {y}");
        }
        let (p, q) = through(2.0, 2.0f64.next_up());
        assert!(segment_and_triangle_apart(p, q, &t));
        assert!(!segment_and_triangle_apart([5.0, 5.0, 0.0], [6.0, 5.0, 0.0], &t), "in its plane: never certain");
    }
}
