//! Faces that turn their backs, decided in object space.
//!
//! A face is seen from the front where the eye is strictly in front of its plane: one exact orientation, and no angle between
//! anything. Edge-on faces show nothing and count as turned away.

use crate::camera::Camera;
use crate::face_mask::FaceMask;
use crate::faces::Faces;
use sightlines_geometry::{Aabb, Point3, check_coordinate, orient3d};

/// Which side of a face eyes see.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Facing {
    /// The front, from everywhere.
    Front,
    /// The back or the edge, from everywhere: the front is never seen.
    Back,
    /// The front from some places and not from others, or not known.
    Mixed,
}

/// Which side of a face is seen from the convex hull of `eyes`, exactly.
///
/// * `corners`: in scene units, counter-clockwise where the front is seen; corners on one line have no front
/// * `eyes`: one eye, or the corners of a region of eyes. Eyes with coordinates that no scene may have say nothing:
///   [`Facing::Mixed`]. No eyes see no front.
///
/// The plane's function is linear, so it is greatest and least in corners of the hull: what holds for all corners holds for all
/// eyes. One exact orientation for each eye.
pub fn facing(corners: &[Point3; 3], eyes: impl IntoIterator<Item = Point3>) -> Facing {
    let &[a, b, c] = corners;
    let (mut n, mut front) = (0usize, 0usize);
    for eye in eyes {
        if eye.iter().any(|&x| check_coordinate(x).is_err()) {
            return Facing::Mixed;
        }
        n += 1;
        front += usize::from(orient3d(a, b, c, eye) > 0.0);
    }
    match front {
        0 => Facing::Back,
        _ if front == n => Facing::Front,
        _ => Facing::Mixed,
    }
}

/// The eight corners of a box of eyes; none if nothing is in it.
pub fn corners_of(region: &Aabb<3>) -> impl Iterator<Item = Point3> + Clone {
    let Aabb { min, max } = *region;
    let n = if region.is_empty() { 0 } else { 8u8 };
    (0..n).map(move |i| std::array::from_fn(|k| if i >> k & 1 == 0 { min[k] } else { max[k] }))
}

/// Takes away the faces whose front the eye does not see; how many went.
pub fn backface(faces: &Faces, camera: &Camera, chosen: &mut FaceMask) -> u64 {
    backface_region(faces, &[camera.eye()], chosen)
}

/// Takes away the faces whose front is seen from nowhere in the convex hull of `eyes`; how many went.
pub fn backface_region(faces: &Faces, eyes: &[Point3], chosen: &mut FaceMask) -> u64 {
    chosen.retain(|face| facing(faces.of(face), eyes.iter().copied()) != Facing::Back)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    type P = [i64; 3];

    /// The oracle: the determinant in whole numbers.
    fn height([a, b, c]: [P; 3], p: P) -> i64 {
        let minus = |a: P, b: P| [0, 1, 2].map(|k| a[k] - b[k]);
        let (u, v, w) = (minus(b, a), minus(c, a), minus(p, a));
        let n = [(1, 2), (2, 0), (0, 1)].map(|(i, j)| u[i] * v[j] - u[j] * v[i]);
        n[0] * w[0] + n[1] * w[1] + n[2] * w[2]
    }

    fn real(p: P) -> Point3 {
        p.map(|x| x as f64)
    }

    fn point() -> impl Strategy<Value = P> {
        [-3i64..4, -3..4, -3..4]
    }

    proptest! {
        /// All eyes on a grid in the box are tested, not only its corners.
        #[test]
        fn a_region_sees_what_its_eyes_see(face in [point(), point(), point()], a in point(), b in point()) {
            let region = Aabb::around([real(a), real(b)]);
            let (min, max) = (region.min.map(|x| x as i64), region.max.map(|x| x as i64));
            let mut heights = Vec::new();
            for x in min[0]..=max[0] {
                for y in min[1]..=max[1] {
                    heights.extend((min[2]..=max[2]).map(|z| height(face, [x, y, z])));
                }
            }
            let want = if heights.iter().all(|&h| h <= 0) {
                Facing::Back
            } else if heights.iter().all(|&h| h > 0) {
                Facing::Front
            } else {
                Facing::Mixed
            };
            prop_assert_eq!(facing(&face.map(real), corners_of(&region)), want);
        }

        #[test]
        fn an_eye_sees_the_front_or_not(face in [point(), point(), point()], eye in point()) {
            let faces = Faces::new(vec![face.map(real)]).unwrap();
            let [corner, across, down] = [[-1., 1., 1.], [1., 0., 0.], [0., -1., 0.]];
            let camera = Camera::new(real(eye), corner, across, down, [2, 2]).unwrap();
            let mut chosen = FaceMask::all(&faces);
            let n_before = chosen.len() as u64;
            let gone = backface(&faces, &camera, &mut chosen);
            prop_assert_eq!(gone, n_before - chosen.len() as u64);
            prop_assert_eq!(chosen.has(0), height(face, eye) > 0);
        }
    }

    #[test]
    fn one_ulp_decides() {
        let face = [[0.1, 0.1, 0.3], [0.7, 0.2, 0.3], [0.3, 0.9, 0.3]];
        let eyes = [0.3f64.next_down(), 0.3, 0.3f64.next_up()].map(|z| [1e9, -3.5, z]);
        assert_eq!(eyes.map(|eye| facing(&face, [eye])), [Facing::Back, Facing::Back, Facing::Front]);
        assert_eq!(facing(&face, eyes), Facing::Mixed);
    }

    #[test]
    fn nonsense_is_not_culled() {
        let face = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]];
        for bad in [f64::NAN, f64::INFINITY, 1e300] {
            assert_eq!(facing(&face, [[0., 0., -1.], [bad, 0., -1.]]), Facing::Mixed);
        }
        assert_eq!(facing(&face, corners_of(&Aabb::EMPTY)), Facing::Back);
    }
}
