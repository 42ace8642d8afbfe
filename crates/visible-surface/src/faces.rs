//! What is to be seen: triangles, checked once.

use sightlines_cells::Scene;
use sightlines_geometry::{Aabb, Adaptive, CoordinateError, Orient2d, Point2, Point3, check_coordinate};

/// What a pixel shows where nothing is, and an id that no face has.
pub const NOTHING: u32 = u32::MAX;

/// Triangles with coordinates that the predicates accept. A face is the index of one.
///
/// Faces are seen from both sides unless back faces are culled; the front is where the corners go round counter-clockwise.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Faces {
    corners: Vec<[Point3; 3]>,
    object: Vec<u32>,
    has_area: Vec<bool>,
}

/// Why triangles do not make [`Faces`].
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FacesError {
    /// A coordinate cannot be used.
    #[error("face {face}, corner {corner}: {kind}")]
    Corner {
        /// Index of the face.
        face: usize,
        /// Which of its corners.
        corner: usize,
        /// What is wrong with it.
        #[source]
        kind: CoordinateError,
    },
    /// There are more than ids, which are 32 bits.
    #[error("{0} faces are more than can be numbered")]
    TooMany(usize),
}

impl Faces {
    /// Checks triangles, each of which is an object of its own. Negative zeros become zeros.
    ///
    /// # Errors
    /// [`FacesError`] with the place of the first offender.
    pub fn new(mut corners: Vec<[Point3; 3]>) -> Result<Self, FacesError> {
        if corners.len() >= NOTHING as usize {
            return Err(FacesError::TooMany(corners.len()));
        }
        for (face, of) in corners.iter_mut().enumerate() {
            for (corner, p) in of.iter_mut().enumerate() {
                for x in p {
                    *x = check_coordinate(*x).map_err(|kind| FacesError::Corner { face, corner, kind })?;
                }
            }
        }
        let has_area = corners.iter().map(has_area).collect();
        let object = (0..corners.len() as u32).collect();
        Ok(Self { corners, object, has_area })
    }

    /// The triangles of a scene, object by object.
    ///
    /// # Errors
    /// [`FacesError::TooMany`]
    pub fn of_scene(scene: &Scene) -> Result<Self, FacesError> {
        let mut faces = Self::new(scene.objects().iter().flat_map(|o| o.corners()).collect())?;
        faces.object.clear();
        for (id, object) in (0..).zip(scene.objects()) {
            faces.object.resize(faces.object.len() + object.triangles.len(), id);
        }
        Ok(faces)
    }

    /// Number of faces.
    pub fn len(&self) -> usize {
        self.corners.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.corners.is_empty()
    }

    /// The corners of all faces, in scene units.
    pub fn corners(&self) -> &[[Point3; 3]] {
        &self.corners
    }

    /// The corners of a face.
    #[inline]
    pub fn of(&self, face: u32) -> &[Point3; 3] {
        &self.corners[face as usize]
    }

    /// The object that a face belongs to.
    pub fn object(&self, face: u32) -> u32 {
        self.object[face as usize]
    }

    /// Whether the corners of a face are not on one line, exactly; what has no area is not drawn.
    pub fn has_area(&self, face: u32) -> bool {
        self.has_area[face as usize]
    }

    /// All ids.
    pub fn ids(&self) -> std::ops::Range<u32> {
        0..self.corners.len() as u32
    }

    /// The smallest box around a face.
    pub fn bounds(&self, face: u32) -> Aabb<3> {
        Aabb::around(*self.of(face))
    }
}

fn has_area(&[a, b, c]: &[Point3; 3]) -> bool {
    [(0, 1), (1, 2), (2, 0)].into_iter().any(|(i, j)| {
        let flat = |p: Point3| Point2::new(p[i], p[j]);
        Adaptive.orient(flat(a), flat(b), flat(c)) != 0.0
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use sightlines_cells::SceneObject;

    #[test]
    fn faces_are_checked() {
        let error = Faces::new(vec![[[0.0; 3]; 3], [[0.0; 3], [0.0, f64::NAN, 0.0], [1.0; 3]]]).unwrap_err();
        assert_eq!(error.to_string(), "face 1, corner 1: coordinate NaN is not a finite number");
        let thin = [[0.0; 3], [0.1, 0.2, 0.3], [0.2, 0.4, 0.6]];
        let faces = Faces::new(vec![thin, [[0.0; 3], [0.1, 0.2, 0.3], [0.2, 0.4, 0.6000000000000001]]]).unwrap();
        assert_eq!([faces.has_area(0), faces.has_area(1)], [false, true]);
    }

    #[test]
    fn scenes_keep_their_objects() {
        let object = |n: usize| SceneObject {
            name: String::new(),
            vertices: vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]],
            triangles: vec![[0, 1, 2]; n],
        };
        let scene = Scene::new(vec![object(1), object(0), object(2)]).unwrap();
        let faces = Faces::of_scene(&scene).unwrap();
        assert_eq!(faces.ids().map(|f| faces.object(f)).collect::<Vec<_>>(), [0, 2, 2]);
    }
}
