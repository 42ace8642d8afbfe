//! Occluders: patches of surfaces.

use sightlines_geometry::{Aabb, CoordinateError, Point3, check_coordinate, orient3d};

/// Why an occluder is invalid.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum OccluderError {
    /// An outline of fewer than three corners, or no facet.
    #[error("an occluder needs an outline of at least 3 corners and at least one facet")]
    TooFew,
    /// A facet without area.
    #[error("facet {0} of an occluder has no area")]
    Flat(usize),
    /// A coordinate that predicates cannot take.
    #[error("an occluder's {0}")]
    Coordinate(#[from] CoordinateError),
}

/// A piece of surface without holes: triangles put together, and the closed loop of edges around them.
///
/// It need be neither flat nor convex; but it hides something from a volume of eyes only on those lines that pass all
/// edges of the outline on the same side, and cross the planes of all facets. So a nearly flat patch with a nearly
/// convex outline hides most of what is behind it, and never anything visible.
///
/// # Why this is sound
/// Let a segment from an eye `v` to a point `p` pass every edge of the outline on the same side. Seen along
/// the line the outline then goes round it in one direction all the way, so it winds around it at least once,
/// and a surface with that outline is crossed by the line. If `v` is strictly in front of the planes of all facets
/// and `p` is behind or on them, whatever facet is crossed is crossed between the two. The conditions are
/// affine in `v` and in `p`, so they hold for a box of eyes and a rectangle of points if they hold for the
/// corners. (Lines that lie in one plane with the whole outline wind around nothing; they are no open set.)
/// What matters is that the outline bounds the triangles.
#[derive(Debug, Clone, PartialEq)]
pub struct Occluder {
    outline: Vec<Point3>,
    facets: Vec<[Point3; 3]>,
    bounds: Aabb<3>,
    is_front_only: bool,
}

impl Occluder {
    /// A triangle.
    ///
    /// # Errors
    /// [`OccluderError::Flat`], [`OccluderError::Coordinate`]
    pub fn triangle(corners: [Point3; 3]) -> Result<Self, OccluderError> {
        Self::patch(corners.to_vec(), &[corners])
    }

    /// A surface made of triangles, and its outline.
    ///
    /// * `outline`: at least 3 corners, the boundary of the surface, once around, counter-clockwise as seen from the
    ///   side that the triangles' right-hand normals `(b - a) × (c - a)` point to; corners of the boundary that lie
    ///   exactly on the straight line between their neighbours may be left out
    /// * `triangles`: all triangles of the surface
    ///
    /// That the outline bounds the triangles is the caller's responsibility; it is not checked. Keeps one triangle for
    /// each different plane. O(triangles · planes).
    ///
    /// # Errors
    /// [`OccluderError`]
    pub fn patch(outline: Vec<Point3>, triangles: &[[Point3; 3]]) -> Result<Self, OccluderError> {
        if outline.len() < 3 || triangles.is_empty() {
            return Err(OccluderError::TooFew);
        }
        for p in outline.iter().chain(triangles.iter().flatten()) {
            for &x in p {
                check_coordinate(x)?;
            }
        }
        let mut facets: Vec<[Point3; 3]> = Vec::new();
        for (idx, &triangle) in triangles.iter().enumerate() {
            let [a, b, c] = triangle;
            if is_flat(a, b, c) {
                return Err(OccluderError::Flat(idx));
            }
            if !facets.iter().any(|&facet| is_same_plane(facet, triangle)) {
                facets.push(triangle);
            }
        }
        let bounds = Aabb::around(outline.iter().chain(triangles.iter().flatten()).copied());
        Ok(Self { outline, facets, bounds, is_front_only: false })
    }

    /// The same, which hides from eyes in front of all of its facets only: of triangles that hide from their fronts, all of which it turns as
    /// they do.
    #[must_use]
    pub fn from_front(self) -> Self {
        Self { is_front_only: true, ..self }
    }

    /// Whether it hides from eyes in front of it only.
    pub const fn is_front_only(&self) -> bool {
        self.is_front_only
    }

    /// The outline.
    pub fn outline(&self) -> &[Point3] {
        &self.outline
    }

    /// One triangle in each different plane of the surface.
    pub fn facets(&self) -> &[[Point3; 3]] {
        &self.facets
    }

    /// Whether all of it lies in one plane.
    pub const fn is_flat(&self) -> bool {
        self.facets.len() == 1
    }

    /// The box around all of it.
    pub const fn bounds(&self) -> &Aabb<3> {
        &self.bounds
    }

    /// Whether all of `eyes` are strictly in front of all facets (`Some(true)`), or strictly behind all
    /// (`Some(false)`). With `None` the occluder hides nothing from them. Exact.
    pub fn side_of(&self, eyes: &[Point3]) -> Option<bool> {
        let mut sides = self.facets.iter().flat_map(|facet| {
            let across = across(facet);
            eyes.iter().map(move |&v| {
                across
                    .map_or_else(|| orient3d(facet[0], facet[1], facet[2], v), |(k, turn)| turn * (v[k] - facet[0][k]))
            })
        });
        let first = sides.next()?;
        if first > 0.0 {
            sides.all(|s| s > 0.0).then_some(true)
        } else if first < 0.0 {
            sides.all(|s| s < 0.0).then_some(false)
        } else {
            None
        }
    }

    /// The same, but `None` as well if the occluder hides from its front only, and `eyes` are behind it.
    pub fn hiding_side_of(&self, eyes: &[Point3]) -> Option<bool> {
        self.side_of(eyes).filter(|&front| front || !self.is_front_only)
    }
}

/// The axis that a triangle is perpendicular to, if there is one, and 1 or -1: whether its normal points along it. Exact.
fn across(&[a, b, c]: &[Point3; 3]) -> Option<(usize, f64)> {
    let k = (0..3).find(|&k| a[k] == b[k] && a[k] == c[k])?;
    let of = |p: Point3| robust::Coord { x: p[(k + 1) % 3], y: p[(k + 2) % 3] };
    let turn = robust::orient2d(of(a), of(b), of(c));
    (turn != 0.0).then_some((k, turn.signum()))
}

/// Whether two triangles lie in one plane, and turn the same way. Exact.
fn is_same_plane([a, b, c]: [Point3; 3], other: [Point3; 3]) -> bool {
    if other.iter().any(|&p| orient3d(a, b, c, p) != 0.0) {
        return false;
    }
    // In one plane they turn the same way if they do so in a projection that shows the first one's area.
    let turn = |[a, b, c]: [Point3; 3], k: usize| {
        let of = |p: Point3| robust::Coord { x: p[k], y: p[(k + 1) % 3] };
        robust::orient2d(of(a), of(b), of(c))
    };
    (0..3)
        .map(|k| (turn([a, b, c], k), turn(other, k)))
        .find(|t| t.0 != 0.0)
        .is_some_and(|t| (t.0 > 0.0) == (t.1 > 0.0))
}

/// Whether three points lie on a line. Exact.
fn is_flat(a: Point3, b: Point3, c: Point3) -> bool {
    (0..3).all(|k| {
        let of = |p: Point3| robust::Coord { x: p[k], y: p[(k + 1) % 3] };
        robust::orient2d(of(a), of(b), of(c)) == 0.0
    })
}
