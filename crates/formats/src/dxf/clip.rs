//! Polygons that lines are cut off at.

use super::{MAX_ELEMENTS, too_many};
use crate::error::Malformed;
use sightlines_geometry::{Aabb, Point2, PolygonRegion, Segment2, check_coordinate};

/// What is inside of a clip, in the world's coordinates.
#[derive(Debug)]
struct Clip {
    region: PolygonRegion,
    /// Whether all but the region is drawn.
    is_hole: bool,
    /// The clip of the insert that this one is in.
    outer: Option<usize>,
}

impl Clip {
    /// The parts of a line that are drawn, in its direction.
    fn parts(&self, line: Segment2) -> Vec<Segment2> {
        let inside = self.region.parts(line);
        if !self.is_hole {
            return inside;
        }
        // From the end of each part to the beginning of the next.
        let ends = inside.iter().flat_map(|part| [part.a, part.b]);
        let ends: Vec<Point2> = [line.a].into_iter().chain(ends).chain([line.b]).collect();
        let outside = ends.chunks_exact(2).filter(|pair| pair[0] != pair[1]);
        outside.map(|pair| Segment2 { a: pair[0], b: pair[1] }).collect()
    }
}

/// The clips of all inserts that have one.
#[derive(Debug, Default)]
pub(super) struct Clips(Vec<Clip>);

impl Clips {
    /// Adds a polygon, of which only what is inside of `outer` counts.
    ///
    /// * `is_hole`: whether what is outside of the polygon is drawn
    pub(super) fn add(
        &mut self,
        corners: impl Iterator<Item = [f64; 2]>,
        is_hole: bool,
        outer: Option<usize>,
    ) -> Result<usize, Malformed> {
        let checked = |[x, y]: [f64; 2]| Ok(Point2::new(check_coordinate(x)?, check_coordinate(y)?));
        let corners = corners.map(checked).collect::<Result<Vec<_>, Malformed>>()?;
        self.0.push(Clip { region: PolygonRegion::new(&corners), is_hole, outer });
        Ok(self.0.len() - 1)
    }

    fn all(&self, clip: Option<usize>) -> impl Iterator<Item = &Clip> {
        let first = clip.map(|k| &self.0[k]);
        std::iter::successors(first, |clip| clip.outer.map(|k| &self.0[k]))
    }

    pub(super) fn nearest(&self, clip: Option<usize>, point: [f64; 2]) -> [f64; 2] {
        let into = |p: [f64; 2], of: &Clip| {
            if of.is_hole {
                return p;
            }
            let Aabb { min, max } = of.region.bounds();
            std::array::from_fn(|k| p[k].max(min[k]).min(max[k]))
        };
        self.all(clip).fold(point, into)
    }

    /// Whether everything within a distance of a line is drawn; no if that is not certain.
    pub(super) fn has_all_near(
        &self,
        clip: Option<usize>,
        line: Segment2,
        distance: f64,
        n_compared: &mut usize,
    ) -> Result<bool, Malformed> {
        let [low, high] = [f64::min, f64::max].map(|of| [of(line.a.x, line.b.x), of(line.a.y, line.b.y)]);
        let (low, high) = (low.map(|x| (x - distance).next_down()), high.map(|x| (x + distance).next_up()));
        let corners = [[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]].map(Point2::from);
        for (k, &a) in corners.iter().enumerate() {
            let side = Segment2 { a, b: corners[(k + 1) % 4] };
            if self.parts(clip, side, n_compared)? != [side] {
                return Ok(false);
            }
        }
        Ok(true)
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
        for clip in self.all(clip) {
            *n_compared += parts.len() * clip.region.n_sides();
            if *n_compared / CHEAP > MAX_ELEMENTS {
                return Err(too_many());
            }
            parts = parts.into_iter().flat_map(|part| clip.parts(part)).collect();
        }
        Ok(parts)
    }
}
