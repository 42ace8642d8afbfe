//! In which triangle a point lies.

use crate::WallMesh;
use crate::edge::{NONE, around, next, previous};
use sightlines_geometry::Point2;

/// Where a point lies in the mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum MeshPlace {
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

impl WallMesh {
    /// Checks a point and finds where it lies.
    ///
    /// A walk towards the point from a triangle near it, O(1) on average: a triangle is left through an edge that has the point on
    /// its other side. A walk that takes too many steps ends in a search of all triangles.
    pub(crate) fn locate(&self, p: Point2) -> Result<(Point2, MeshPlace), EyeError> {
        let check = |x: f64| sightlines_geometry::check_coordinate(x);
        let wrong = |kind| EyeError::Coordinate { x: p.x, y: p.y, kind };
        let p = Point2::new(check(p.x).map_err(wrong)?, check(p.y).map_err(wrong)?);
        let frame = self.frame();
        let inside = |k: usize, x: f64| frame.min[k] < x && x < frame.max[k];
        if !inside(0, p.x) || !inside(1, p.y) {
            return Err(EyeError::Outside { x: p.x, y: p.y });
        }
        let mut triangle = self.locator.start(p);
        // Far more steps than walks take, and fewer than all triangles of a large mesh.
        let most_steps = 1000 + self.n_triangles() as u32 / 16;
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
                if twin == NONE {
                    return Err(EyeError::Outside { x: p.x, y: p.y });
                }
                steps += 1;
                triangle = if steps == most_steps { self.scan(p).unwrap_or(twin / 3) } else { twin / 3 };
                continue;
            }
            let place = match n_on {
                0 => MeshPlace::Inside(triangle),
                1 => MeshPlace::OnEdge(on[0]),
                // The corner that two edges share starts one of them.
                _ if next(on[0]) == on[1] => MeshPlace::OnCorner(on[1]),
                _ => {
                    debug_assert_eq!(previous(on[0]), on[1]);
                    MeshPlace::OnCorner(on[0])
                }
            };
            return Ok((p, place));
        }
    }

    /// The first triangle that a point is in, or on the border of.
    #[cold]
    fn scan(&self, p: Point2) -> Option<u32> {
        let holds = |&triangle: &u32| {
            (3 * triangle..3 * triangle + 3).all(|edge| {
                let (u, v) = self.ends(edge);
                self.orient(p, u, v) >= 0.0
            })
        };
        (0..self.n_triangles() as u32).find(holds)
    }

    /// The edges that leave the corner where an edge starts, one for each triangle around it.
    pub(crate) fn leaving(&self, edge: u32) -> impl Iterator<Item = u32> + '_ {
        around(&self.edges, edge)
    }
}
