//! Polygons that lines are cut off at.

use super::MAX_ELEMENTS;
use super::expand::too_many;
use crate::error::Malformed;
use sightlines_geometry::{Aabb, Point2, Segment2, check_coordinate, orient2d};

/// A polygon in the world's coordinates. Its inside is what rays leave through an odd number of sides, and its border.
#[derive(Debug)]
struct Polygon {
    sides: Vec<Segment2>,
    bounds: Aabb<2>,
    /// The clip of the insert that this one is in.
    outer: Option<usize>,
}

/// The clips of all inserts that have one.
#[derive(Debug, Default)]
pub(super) struct Clips(Vec<Polygon>);

impl Clips {
    /// Adds a polygon, of which only what is inside of `outer` counts.
    pub(super) fn add(
        &mut self,
        corners: impl Iterator<Item = [f64; 2]>,
        outer: Option<usize>,
    ) -> Result<usize, Malformed> {
        let checked = |[x, y]: [f64; 2]| Ok(Point2::new(check_coordinate(x)?, check_coordinate(y)?));
        let corners = corners.map(checked).collect::<Result<Vec<_>, Malformed>>()?;
        let bounds = Aabb::around(corners.iter().map(|p| [p.x, p.y]));
        let ends = corners.iter().zip(corners.iter().cycle().skip(1));
        self.0.push(Polygon { sides: ends.map(|(&a, &b)| Segment2 { a, b }).collect(), bounds, outer });
        Ok(self.0.len() - 1)
    }

    /// The clip and those around it.
    fn all(&self, clip: Option<usize>) -> impl Iterator<Item = &Polygon> {
        let first = clip.map(|k| &self.0[k]);
        std::iter::successors(first, |polygon| polygon.outer.map(|k| &self.0[k]))
    }

    /// The point of a clip's bounds that is nearest.
    pub(super) fn nearest(&self, clip: Option<usize>, point: [f64; 2]) -> [f64; 2] {
        let into =
            |p: [f64; 2], of: &Polygon| std::array::from_fn(|k| p[k].max(of.bounds.min[k]).min(of.bounds.max[k]));
        self.all(clip).fold(point, into)
    }

    /// The parts of a line that are drawn; all of it is as it was, bit by bit. Parts that only touch are left out.
    ///
    /// * `n_compared`: the comparisons of lines with sides so far, which count as elements
    pub(super) fn parts(
        &self,
        clip: Option<usize>,
        line: Segment2,
        n_compared: &mut usize,
    ) -> Result<Vec<Segment2>, Malformed> {
        /// How many take as long as an element.
        const CHEAP: usize = 1 << 8;
        let mut parts = vec![line];
        for polygon in self.all(clip) {
            *n_compared += parts.len() * polygon.sides.len();
            if *n_compared / CHEAP > MAX_ELEMENTS {
                return Err(too_many());
            }
            parts = parts.into_iter().flat_map(|part| polygon.parts(part)).collect();
        }
        Ok(parts)
    }
}

impl Polygon {
    fn contains(&self, p: Point2) -> bool {
        let crosses = |side: &&Segment2| {
            let [low, high] = if side.a.y < side.b.y { [side.a, side.b] } else { [side.b, side.a] };
            (low.y <= p.y) != (high.y <= p.y) && orient2d(low, high, p) > 0.0
        };
        self.bounds.contains([p.x, p.y])
            && (self.sides.iter().filter(crosses).count() % 2 == 1 || self.sides.iter().any(|side| side.contains(p)))
    }

    fn parts(&self, Segment2 { a, b }: Segment2) -> Vec<Segment2> {
        // Where the line meets the lines of the sides, as shares of it.
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
        let mut drawn: Vec<[f64; 2]> = Vec::new();
        for pair in shares.windows(2).filter(|pair| self.contains(at(0.5 * (pair[0] + pair[1])))) {
            match drawn.last_mut() {
                Some(last) if last[1] == pair[0] => last[1] = pair[1],
                _ => drawn.push([pair[0], pair[1]]),
            }
        }
        let parts = drawn.into_iter().map(|share| share.map(at)).map(|[a, b]| Segment2 { a, b });
        parts.filter(|part| part.a != part.b).collect()
    }
}
