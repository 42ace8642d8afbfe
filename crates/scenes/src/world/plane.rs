//! Planes with integer normals, and convex polygons cut by them in doubles, as compilers of maps do.

use sightlines_geometry::Point3;

/// The plane of the points `x` with `normal · x = offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WorldPlane {
    /// Points to the front; not zero.
    pub normal: [i32; 3],
    /// The distance from the origin, times the length of the normal.
    pub offset: f64,
}

/// The parts in front and behind.
pub(super) type Halves<T> = [Option<T>; 2];

impl WorldPlane {
    /// A plane at right angles to an axis.
    pub fn axial(axis: usize, at: f64) -> Self {
        let mut normal = [0; 3];
        normal[axis] = 1;
        Self { normal, offset: at }
    }

    /// The same plane, seen from behind.
    #[must_use]
    pub fn flipped(self) -> Self {
        Self { normal: self.normal.map(|n| -n), offset: -self.offset }
    }

    /// The signed distance of a point, positive in front; rounded.
    pub fn distance(&self, p: Point3) -> f64 {
        let n = self.normal.map(f64::from);
        (n[0] * p[0] + n[1] * p[1] + n[2] * p[2] - self.offset) / self.length()
    }

    /// The length of the normal.
    pub(super) fn length(&self) -> f64 {
        let n = self.normal.map(f64::from);
        (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]).sqrt()
    }

    /// The axis that the plane is at right angles to, if it is axial.
    pub fn axis(&self) -> Option<usize> {
        let axis = self.normal.iter().position(|&n| n != 0)?;
        (self.normal.iter().filter(|&&n| n != 0).count() == 1).then_some(axis)
    }

    /// A square in the plane that covers the cube from `-reach` to `reach`, counter-clockwise seen from the front.
    pub(super) fn square(&self, reach: f64) -> Vec<Point3> {
        let n = self.normal.map(f64::from);
        let k = (0..3).max_by_key(|&k| self.normal[k].abs()).expect("there are three axes");
        let (u, v) = ((k + 1) % 3, (k + 2) % 3);
        let corner = |s: f64, t: f64| {
            let mut p = [0.0; 3];
            (p[u], p[v]) = (s * reach, t * reach);
            p[k] = (self.offset - n[u] * p[u] - n[v] * p[v]) / n[k];
            p
        };
        let mut corners = vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
        if n[k] < 0.0 {
            corners.reverse();
        }
        corners
    }

    /// Cuts a convex polygon. Corners at most `epsilon` away count as on the plane and belong to both halves; a half
    /// without a corner beyond that is `None`.
    pub(super) fn split(&self, polygon: &[Point3], epsilon: f64) -> Halves<Vec<Point3>> {
        let distances: Vec<f64> = polygon.iter().map(|&p| self.distance(p)).collect();
        let mut halves = [Vec::new(), Vec::new()];
        for (i, (&p, &d)) in polygon.iter().zip(&distances).enumerate() {
            let next = (i + 1) % polygon.len();
            let (q, e) = (polygon[next], distances[next]);
            (d >= -epsilon).then(|| halves[0].push(p));
            (d <= epsilon).then(|| halves[1].push(p));
            if d > epsilon && e < -epsilon {
                let cut = self.crossing([p, q], [d, e]);
                halves.iter_mut().for_each(|half| half.push(cut));
            } else if d < -epsilon && e > epsilon {
                let cut = self.crossing([q, p], [e, d]);
                halves.iter_mut().for_each(|half| half.push(cut));
            }
        }
        let beyond = [distances.iter().any(|&d| d > epsilon), distances.iter().any(|&d| d < -epsilon)];
        let [front, back] = halves;
        [beyond[0].then_some(front), beyond[1].then_some(back)].map(|half| half.filter(|h| h.len() >= 3))
    }

    /// The point at which an edge crosses, from a point in front to one behind: every call gives the same bits. Exactly
    /// on the plane if that is axial.
    fn crossing(&self, [p, q]: [Point3; 2], [d, e]: [f64; 2]) -> Point3 {
        let t = d / (d - e);
        let mut cut = [0, 1, 2].map(|k| p[k] + t * (q[k] - p[k]));
        if let Some(axis) = self.axis() {
            cut[axis] = self.offset / f64::from(self.normal[axis]);
        }
        cut
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sightlines_geometry::Portal3;

    #[test]
    fn squares_face_the_front_and_halves_make_the_whole() {
        let planes = [[1, 0, 0], [0, -2, 0], [1, 2, 3], [-3, 1, -2], [0, 1, -1]];
        let mut n_cut = 0;
        for normal in planes {
            let plane = WorldPlane { normal, offset: 5.0 };
            let square = plane.square(64.0);
            let n = Portal3::around(&square).unwrap().normal();
            let facing: f64 = (0..3).map(|k| n[k] * f64::from(normal[k])).sum();
            assert!(facing > 0.0, "{normal:?}");
            for other in planes {
                let cutter = WorldPlane { normal: other, offset: -3.0 };
                let area =
                    |p: &[Point3]| Portal3::around(p).unwrap().normal().map(|x| x * x).iter().sum::<f64>().sqrt();
                let halves = cutter.split(&square, 1e-9);
                let sum: f64 = halves.iter().flatten().map(|h| area(h)).sum();
                assert!((sum / area(&square) - 1.0).abs() < 1e-9, "{normal:?} {other:?}");
                n_cut += usize::from(halves.iter().all(Option::is_some));
            }
        }
        assert!(n_cut > 15, "{n_cut}");
    }

    #[test]
    fn what_lies_on_a_plane_is_on_no_side() {
        let plane = WorldPlane::axial(2, 4.0);
        assert_eq!(plane.split(&plane.square(8.0), 1e-9), [None, None]);
        assert_eq!(plane.flipped().distance([0.0, 0.0, 5.0]), -1.0);
        assert_eq!((plane.axis(), WorldPlane { normal: [1, 1, 0], offset: 0.0 }.axis()), (Some(2), None));
    }
}
