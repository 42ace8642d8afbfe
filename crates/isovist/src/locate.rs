//! In which triangle a point lies.

use crate::WallMesh;
use crate::corner::Corner;
use crate::mesh::{Edge, NONE, next, previous};
use sightlines_geometry::{Aabb, Point2};

/// Triangles to start from, on a grid.
#[derive(Debug, Clone)]
pub(crate) struct Locator {
    min: Point2,
    scale: Point2,
    n: usize,
    start: Vec<u32>,
}

/// Where a point lies in the mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Place {
    /// Inside a triangle.
    Inside(u32),
    /// Inside an edge.
    OnEdge(u32),
    /// On the corner where an edge starts.
    OnCorner(u32),
}

/// A point at which nothing can be asked.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EyeError {
    /// A coordinate is NaN, infinite, or of a magnitude for which predicates are not exact.
    #[error("the point ({x}, {y}) is not one: {kind}")]
    Coordinate {
        /// Its coordinate.
        x: f64,
        /// Its coordinate.
        y: f64,
        /// What is wrong with it.
        #[source]
        kind: sightlines_geometry::CoordinateError,
    },
    /// It lies on the frame at which views end, or outside of it.
    #[error("the point ({x}, {y}) is not inside the frame around the plan")]
    Outside {
        /// Its coordinate.
        x: f64,
        /// Its coordinate.
        y: f64,
    },
}

impl Locator {
    /// About as many cells as triangles.
    pub(crate) fn new(corners: &[Corner], edges: &[Edge], frame: &Aabb<2>) -> Self {
        let n = ((edges.len() as f64 / 3.0).sqrt() as usize).clamp(1, 2048);
        let size = Point2::from(frame.max) - Point2::from(frame.min);
        let mut locator = Self { min: Point2::from(frame.min), scale: n as f64 / size, n, start: vec![NONE; n * n] };
        for triangle in 0..edges.len() as u32 / 3 {
            let at = |k: u32| corners[edges[(3 * triangle + k) as usize].from as usize].at;
            let cell = locator.cell((at(0) + at(1) + at(2)) / 3.0);
            locator.start[cell] = triangle;
        }
        // A cell without a triangle starts where the one before it does.
        let mut last = locator.start.iter().copied().find(|&t| t != NONE).unwrap_or(0);
        for start in &mut locator.start {
            if *start == NONE {
                *start = last;
            }
            last = *start;
        }
        locator
    }

    fn cell(&self, p: Point2) -> usize {
        let place = |x: f64| (x as usize).min(self.n - 1);
        let at = (p - self.min) * self.scale;
        place(at.y) * self.n + place(at.x)
    }
}

impl WallMesh {
    /// Checks a point and finds where it lies.
    ///
    /// A walk towards the point from a triangle near it, O(1) on average: a triangle is left through an edge that has the point on
    /// its other side. Of two such edges, a count of steps picks one, so that no walk goes round for ever.
    pub(crate) fn locate(&self, p: Point2) -> Result<(Point2, Place), EyeError> {
        let check = |x: f64| sightlines_geometry::check_coordinate(x);
        let wrong = |kind| EyeError::Coordinate { x: p.x, y: p.y, kind };
        let p = Point2::new(check(p.x).map_err(wrong)?, check(p.y).map_err(wrong)?);
        let frame = self.frame();
        let inside = |k: usize, x: f64| frame.min[k] < x && x < frame.max[k];
        if !inside(0, p.x) || !inside(1, p.y) {
            return Err(EyeError::Outside { x: p.x, y: p.y });
        }
        let mut triangle = self.locator.start[self.locator.cell(p)];
        let mut steps = 0u32;
        loop {
            let mut away = NONE;
            let mut on = [NONE; 2];
            let mut n_on = 0;
            for k in 0..3 {
                let edge = 3 * triangle + (k + steps) % 3;
                let (u, v) = self.ends(edge);
                let side = self.orient(p, u, v);
                if side < 0.0 {
                    away = edge;
                    break;
                }
                if side == 0.0 && n_on < 2 {
                    on[n_on] = edge;
                    n_on += 1;
                }
            }
            if away != NONE {
                let twin = self.edges[away as usize].twin;
                debug_assert_ne!(twin, NONE, "a point inside the frame lies in a triangle");
                if twin == NONE || steps > 1_000_000 {
                    return Err(EyeError::Outside { x: p.x, y: p.y });
                }
                triangle = twin / 3;
                steps += 1;
                continue;
            }
            let place = match n_on {
                0 => Place::Inside(triangle),
                1 => Place::OnEdge(on[0]),
                // The corner that two edges share starts one of them.
                _ if next(on[0]) == on[1] => Place::OnCorner(on[1]),
                _ => {
                    debug_assert_eq!(previous(on[0]), on[1]);
                    Place::OnCorner(on[0])
                }
            };
            return Ok((p, place));
        }
    }

    /// The edges that leave the corner where an edge starts, one for each triangle around it.
    pub(crate) fn leaving(&self, edge: u32) -> impl Iterator<Item = u32> + '_ {
        crate::build::around(&self.edges, edge)
    }
}
