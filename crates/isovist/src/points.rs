//! Which of many points an eye sees.

use crate::edge::NONE;
use crate::expand::{Rays, Visitor, Window};
use crate::locate::MeshPlace;
use crate::{EyeError, Touch, WallMesh};
use sightlines_geometry::{Point2, orient2d};

/// Points by the triangles that they lie in.
#[derive(Debug, Clone)]
pub struct PointIndex {
    points: Vec<Point2>,
    places: Vec<MeshPlace>,
    first: Vec<u32>,
    items: Vec<(Point2, u32)>,
}

impl PointIndex {
    /// The points, in the order that they were given.
    pub fn points(&self) -> &[Point2] {
        &self.points
    }

    fn in_triangle(&self, triangle: u32) -> &[(Point2, u32)] {
        &self.items[self.first[triangle as usize] as usize..self.first[triangle as usize + 1] as usize]
    }
}

/// Collects the points in the triangles that a view enters.
struct Seen<'a> {
    mesh: &'a WallMesh,
    index: &'a PointIndex,
    eye: Point2,
    place: MeshPlace,
    touch: Touch,
    seen: &'a mut Vec<u32>,
}

impl Visitor for Seen<'_> {
    fn start(&mut self, triangle: u32) {
        // Nothing is between the eye and a point of a triangle around it, unless both are on the line of one of its walls.
        for &(p, i) in self.index.in_triangle(triangle) {
            let clear = match self.place {
                MeshPlace::Inside(_) => true,
                _ => p == self.eye || !self.is_along_wall(triangle, p) || self.sees(p),
            };
            if clear {
                self.seen.push(i);
            }
        }
    }

    #[inline(always)]
    fn enter(&mut self, Window { edge, right, left }: Window) {
        let points = self.index.in_triangle(edge / 3);
        if points.is_empty() {
            return;
        }
        let (r, l) = (self.mesh.corners[right as usize], self.mesh.corners[left as usize]);
        let is_exact = r.reach == 0.0 && l.reach == 0.0;
        for &(p, i) in points {
            let (of_right, of_left) = if is_exact {
                (orient2d(self.eye, r.at, p), orient2d(self.eye, l.at, p))
            } else {
                // Positive if the corner is to the left of the line from the eye to the point.
                (-self.mesh.side(self.eye, p, right), -self.mesh.side(self.eye, p, left))
            };
            let sees = match self.touch {
                Touch::Blocks => of_right > 0.0 && of_left < 0.0,
                Touch::Passes if of_right < 0.0 || of_left > 0.0 => false,
                Touch::Passes => (of_right > 0.0 && of_left < 0.0) || self.sees(p),
            };
            if sees {
                self.seen.push(i);
            }
        }
    }

    #[inline(always)]
    fn end(&mut self, _: Window) {}
}

impl Seen<'_> {
    /// Whether the eye and a point of a triangle are on the line of one of its edges.
    fn is_along_wall(&self, triangle: u32, p: Point2) -> bool {
        (3 * triangle..3 * triangle + 3).any(|edge| {
            let (u, v) = self.mesh.ends(edge);
            self.mesh.orient(self.eye, u, v) == 0.0 && self.mesh.orient(p, u, v) == 0.0
        })
    }

    fn sees(&self, p: Point2) -> bool {
        self.mesh.sees_from(self.eye, self.place, p, self.touch)
    }
}

impl WallMesh {
    /// Sorts points into the triangles, for [`WallMesh::points_seen`].
    ///
    /// # Errors
    /// [`EyeError`] for the first point that is none or outside of the frame.
    pub fn index(&self, points: &[Point2]) -> Result<PointIndex, EyeError> {
        let mut checked = Vec::with_capacity(points.len());
        let mut places = Vec::with_capacity(points.len());
        let mut entries: Vec<(u32, u32)> = Vec::with_capacity(points.len());
        for (i, &p) in (0u32..).zip(points) {
            let (p, place) = self.locate(p)?;
            checked.push(p);
            places.push(place);
            match place {
                MeshPlace::Inside(triangle) => entries.push((triangle, i)),
                MeshPlace::OnEdge(edge) => {
                    let twin = self.edges[edge as usize].twin;
                    entries.push((edge / 3, i));
                    if twin != NONE {
                        entries.push((twin / 3, i));
                    }
                }
                MeshPlace::OnCorner(edge) => entries.extend(self.leaving(edge).map(|out| (out / 3, i))),
            }
        }
        entries.sort_unstable();
        let mut first = vec![0u32; self.n_triangles() + 1];
        for &(triangle, _) in &entries {
            first[triangle as usize + 1] += 1;
        }
        for triangle in 0..self.n_triangles() {
            first[triangle + 1] += first[triangle];
        }
        let items = entries.into_iter().map(|(_, i)| (checked[i as usize], i)).collect();
        Ok(PointIndex { points: checked, places, first, items })
    }

    /// Fills `seen` with the indices of all points that point `eye` of the index sees, ascending, itself included. Exact: the same as
    /// [`WallMesh::sees`] for each of them.
    ///
    /// Cost: about 10 ns for each triangle that is seen and each point in one, and sorting what is seen.
    ///
    /// # Panics
    /// If the index has no such point.
    pub fn points_seen(&self, eye: u32, index: &PointIndex, touch: Touch, seen: &mut Vec<u32>) {
        let (p, place) = (index.points[eye as usize], index.places[eye as usize]);
        self.points_seen_at(p, place, index, touch, seen);
    }

    /// The same for an eye that is not in the index.
    ///
    /// # Errors
    /// [`EyeError`] for a point outside of the frame or with coordinates that are none.
    pub fn points_seen_from(
        &self,
        eye: Point2,
        index: &PointIndex,
        touch: Touch,
        seen: &mut Vec<u32>,
    ) -> Result<(), EyeError> {
        let (eye, place) = self.locate(eye)?;
        self.points_seen_at(eye, place, index, touch, seen);
        Ok(())
    }

    fn points_seen_at(&self, eye: Point2, place: MeshPlace, index: &PointIndex, touch: Touch, seen: &mut Vec<u32>) {
        seen.clear();
        let rays = match touch {
            Touch::Blocks => Rays::Open,
            Touch::Passes => Rays::Closed,
        };
        let mut stack = Vec::new();
        self.expand(eye, place, rays, &mut stack, &mut Seen { mesh: self, index, eye, place, touch, seen });
        seen.sort_unstable();
        seen.dedup();
    }
}
