//! Regions of the plane inside of a polygon, and the parts of lines in them.

use crate::{Aabb, Point2, Segment2, orient2d};

/// What is inside of a polygon of any shape, and its border: points from which a ray leaves through an odd number of sides. Sides that are there
/// twice, such as those of a slit, count for the border only.
#[derive(Debug, Clone, PartialEq)]
pub struct PolygonRegion {
    sides: Vec<Segment2>,
    bounds: Aabb<2>,
}

impl PolygonRegion {
    /// Inside of the polygon with these corners.
    pub fn new(corners: &[Point2]) -> Self {
        let ends = corners.iter().zip(corners.iter().cycle().skip(1));
        let sides = ends.map(|(&a, &b)| Segment2::new(a, b)).collect();
        Self { sides, bounds: Aabb::around(corners.iter().map(|p| p.to_array())) }
    }

    /// The smallest box around it.
    pub fn bounds(&self) -> &Aabb<2> {
        &self.bounds
    }

    /// Number of sides.
    pub fn n_sides(&self) -> usize {
        self.sides.len()
    }

    /// Whether a point is inside or on the border. Exact, O(sides).
    pub fn contains(&self, p: Point2) -> bool {
        let crosses = |side: &&Segment2| {
            let [low, high] = if side.a.y < side.b.y { [side.a, side.b] } else { [side.b, side.a] };
            (low.y <= p.y) != (high.y <= p.y) && orient2d(low, high, p) > 0.0
        };
        self.bounds.contains(p.to_array())
            && (self.sides.iter().filter(crosses).count() % 2 == 1 || self.sides.iter().any(|side| side.contains(p)))
    }

    /// The parts of a line that are inside or on the border, in its direction; none of a single point. Ends that are not those of the line are rounded,
    /// and so it is not certain whether what runs along a side is inside. O(sides²) at worst, O(sides) for lines that meet the lines of few sides.
    pub fn parts(&self, line: Segment2) -> Vec<Segment2> {
        let Segment2 { a, b } = line;
        // Where it meets the lines of the sides, as shares of it.
        let mut shares = vec![0.0, 1.0];
        for side in &self.sides {
            let [from, to] = [a, b].map(|p| orient2d(side.a, side.b, p));
            if (from < 0.0) != (to < 0.0) {
                shares.push((from / (from - to)).clamp(0.0, 1.0));
            }
        }
        shares.sort_by(f64::total_cmp);
        let at = |t: f64| match t {
            0.0 => a,
            1.0 => b,
            _ => a + (b - a) * t,
        };
        let mut inside: Vec<[f64; 2]> = Vec::new();
        for pair in shares.windows(2).filter(|pair| self.contains(at(0.5 * (pair[0] + pair[1])))) {
            match inside.last_mut() {
                Some(last) if last[1] == pair[0] => last[1] = pair[1],
                _ => inside.push([pair[0], pair[1]]),
            }
        }
        let parts = inside.into_iter().map(|ends| ends.map(at)).map(|[a, b]| Segment2 { a, b });
        parts.filter(|part| part.a != part.b).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn point() -> impl Strategy<Value = Point2> {
        (-4i8..5, -4i8..5).prop_map(|(x, y)| Point2::new(x.into(), y.into()))
    }

    proptest! {
        /// Invariant: the parts of a line are its points inside, up to rounding: each of many points between grid lines is in a part exactly if it is inside.
        /// Twin and impostor: both happen, in all cases together.
        #[test]
        fn parts_are_what_is_inside(corners in prop::collection::vec(point(), 3..8), a in point(), b in point()) {
            let region = PolygonRegion::new(&corners);
            let runs_along = |side: &Segment2| [a, b].iter().all(|&p| orient2d(side.a, side.b, p) == 0.0);
            prop_assume!(!region.sides.iter().any(runs_along));
            let parts = region.parts(Segment2::new(a, b));
            let length = (b - a).length_squared();
            let shares: Vec<[f64; 2]> =
                parts.iter().map(|part| [part.a, part.b].map(|p| (p - a).dot(b - a) / length)).collect();
            prop_assert!(shares.iter().all(|[low, high]| low < high));
            prop_assert!(shares.windows(2).all(|pair| pair[0][1] <= pair[1][0]));
            for k in 0..256 {
                let share = (f64::from(k) + 0.5) / 256.0;
                // Lines of the grid meet at fractions with small denominators, far from these or on them.
                if shares.iter().flatten().any(|end| (end - share).abs() < 1e-9) || a == b {
                    continue;
                }
                // Exact: both ends are small integers, and the share has nine bits.
                let p = a + (b - a) * share;
                let is_in_part = shares.iter().any(|[low, high]| *low < share && share < *high);
                prop_assert_eq!(is_in_part, region.contains(p), "{} {:?}", share, shares);
            }
        }

        /// Invariant: of a box it is what comparing coordinates says.
        #[test]
        fn boxes_contain_what_lies_between(a in point(), b in point(), p in point()) {
            let region = PolygonRegion::new(&[a, Point2::new(b.x, a.y), b, Point2::new(a.x, b.y)]);
            let between = |a: f64, b: f64, x: f64| a.min(b) <= x && x <= a.max(b);
            prop_assert_eq!(region.contains(p), between(a.x, b.x, p.x) && between(a.y, b.y, p.y));
        }
    }
}
