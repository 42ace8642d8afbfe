//! Convex polyhedra as the polygons around them, cut by planes.

use super::plane::{Halves, WorldPlane};
use sightlines_geometry::Point3;

/// A convex polyhedron: planes that face outwards, each with the part of it that is surface.
#[derive(Debug, Clone)]
pub(super) struct Polytope {
    pub(super) faces: Vec<(WorldPlane, Vec<Point3>)>,
}

impl Polytope {
    /// A box.
    pub(super) fn cuboid(min: Point3, max: Point3) -> Self {
        let lows = (0..3).map(|k| WorldPlane::axial(k, min[k]).flipped());
        let planes: Vec<WorldPlane> = lows.chain((0..3).map(|k| WorldPlane::axial(k, max[k]))).collect();
        let reach = min.iter().chain(&max).fold(1.0f64, |r, x| r.max(2.0 * x.abs()));
        let face = |plane: &WorldPlane| {
            let square = plane.square(reach);
            (*plane, clip_behind(square, planes.iter().filter(|p| *p != plane), 0.0).expect("a box has six faces"))
        };
        Self { faces: planes.iter().map(face).collect() }
    }

    /// All corners, some more than once.
    pub(super) fn corners(&self) -> impl Iterator<Item = Point3> + '_ {
        self.faces.iter().flat_map(|(_, polygon)| polygon.iter().copied())
    }

    /// The least and the greatest distance of a corner from a plane.
    pub(super) fn range(&self, plane: &WorldPlane) -> [f64; 2] {
        let widen = |[low, high]: [f64; 2], p| {
            let d = plane.distance(p);
            [low.min(d), high.max(d)]
        };
        self.corners().fold([f64::INFINITY, f64::NEG_INFINITY], widen)
    }

    /// The part of a plane inside.
    pub(super) fn section(&self, plane: &WorldPlane, epsilon: f64) -> Option<Vec<Point3>> {
        let reach = self.corners().flatten().fold(1.0f64, |r, x| r.max(2.0 * x.abs()));
        clip_behind(plane.square(reach), self.faces.iter().map(|(p, _)| p), epsilon)
    }

    /// Cuts in two; `None` if a side, or the section between them, is empty.
    pub(super) fn split(&self, plane: &WorldPlane, epsilon: f64) -> Option<[Self; 2]> {
        let [low, high] = self.range(plane);
        if low >= -epsilon || high <= epsilon {
            return None;
        }
        let section = self.section(plane, epsilon)?;
        let mut halves = [Vec::new(), Vec::new()];
        for (face, polygon) in &self.faces {
            let cut: Halves<Vec<Point3>> = plane.split(polygon, epsilon);
            for (half, piece) in halves.iter_mut().zip(cut) {
                half.extend(piece.map(|piece| (*face, piece)));
            }
        }
        let reversed = section.iter().rev().copied().collect();
        halves[0].push((plane.flipped(), reversed));
        halves[1].push((*plane, section));
        let is_solid = halves.iter().all(|faces| faces.len() >= 4);
        is_solid.then(|| halves.map(|faces| Self { faces }))
    }

    /// The mean of the corners of all faces: a point inside.
    pub(super) fn middle(&self) -> Point3 {
        let n = self.corners().count() as f64;
        let sum = self.corners().fold([0.0; 3], |s, p| [0, 1, 2].map(|k| s[k] + p[k]));
        sum.map(|x| x / n)
    }
}

/// The part of a polygon behind all planes, or on them.
fn clip_behind<'p>(
    polygon: Vec<Point3>,
    planes: impl IntoIterator<Item = &'p WorldPlane>,
    epsilon: f64,
) -> Option<Vec<Point3>> {
    planes.into_iter().try_fold(polygon, |polygon, plane| {
        let [_, behind] = plane.split(&polygon, epsilon);
        behind
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use sightlines_geometry::Portal3;

    /// Six times the volume, from the faces.
    fn volume(p: &Polytope) -> f64 {
        let o = p.middle();
        let cone = |(_, polygon): &(WorldPlane, Vec<Point3>)| {
            let n = Portal3::around(polygon).expect("faces have area").normal();
            (0..3).map(|k| n[k] * (polygon[0][k] - o[k])).sum::<f64>()
        };
        p.faces.iter().map(cone).sum()
    }

    #[test]
    fn halves_of_a_polyhedron_make_the_whole() {
        let mut parts = vec![Polytope::cuboid([-4.0, 0.0, 1.0], [4.0, 6.0, 9.0])];
        assert!((volume(&parts[0]) - 6.0 * 8.0 * 6.0 * 8.0).abs() < 1e-9);
        let planes = [([1, 0, 0], 1.0), ([1, 2, -1], 3.0), ([0, 3, 1], 12.0), ([-2, 1, 3], 15.0)];
        for (normal, offset) in planes {
            let plane = WorldPlane { normal, offset };
            parts = parts.into_iter().flat_map(|p| p.split(&plane, 1e-9).map_or(vec![p], Vec::from)).collect();
            let sum: f64 = parts.iter().map(volume).sum();
            assert!((sum - 2304.0).abs() < 1e-6, "{sum}");
        }
        assert!(parts.len() > 6, "{}", parts.len());
        assert!(parts[0].split(&WorldPlane::axial(0, 4.0), 1e-9).is_none());
    }
}
