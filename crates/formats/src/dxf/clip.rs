//! Polygons that lines are cut off at.

use super::{MAX_ELEMENTS, too_many};
use crate::error::Malformed;
use sightlines_geometry::{Aabb, Point2, PolygonRegion, Segment2, check_coordinate};

/// What is inside of a clip, in the world's coordinates.
#[derive(Debug)]
struct Clip {
    region: PolygonRegion,
    /// The clip of the insert that this one is in.
    outer: Option<usize>,
}

/// The clips of all inserts that have one.
#[derive(Debug, Default)]
pub(super) struct Clips(Vec<Clip>);

impl Clips {
    /// Adds a polygon, of which only what is inside of `outer` counts.
    pub(super) fn add(
        &mut self,
        corners: impl Iterator<Item = [f64; 2]>,
        outer: Option<usize>,
    ) -> Result<usize, Malformed> {
        let checked = |[x, y]: [f64; 2]| Ok(Point2::new(check_coordinate(x)?, check_coordinate(y)?));
        let corners = corners.map(checked).collect::<Result<Vec<_>, Malformed>>()?;
        self.0.push(Clip { region: PolygonRegion::new(&corners), outer });
        Ok(self.0.len() - 1)
    }

    /// The clip and those around it.
    fn all(&self, clip: Option<usize>) -> impl Iterator<Item = &PolygonRegion> {
        let first = clip.map(|k| &self.0[k]);
        std::iter::successors(first, |clip| clip.outer.map(|k| &self.0[k])).map(|clip| &clip.region)
    }

    /// The point of a clip's bounds that is nearest.
    pub(super) fn nearest(&self, clip: Option<usize>, point: [f64; 2]) -> [f64; 2] {
        let into = |p: [f64; 2], of: &PolygonRegion| {
            let Aabb { min, max } = of.bounds();
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
        for region in self.all(clip) {
            *n_compared += parts.len() * region.n_sides();
            if *n_compared / CHEAP > MAX_ELEMENTS {
                return Err(too_many());
            }
            parts = parts.into_iter().flat_map(|part| region.parts(part)).collect();
        }
        Ok(parts)
    }
}
