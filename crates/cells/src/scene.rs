//! Scenes in space: objects made of triangles.

use sightlines_geometry::{Aabb, CoordinateError, Point3, check_coordinate};

/// Something that is seen or not as a whole: a mesh of triangles.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneObject {
    /// What users call it.
    pub name: String,
    /// Corners, in world coordinates and scene units.
    pub vertices: Vec<Point3>,
    /// Triangles as indices of corners, counter-clockwise as seen from the front.
    pub triangles: Vec<[u32; 3]>,
}

impl SceneObject {
    /// Smallest box around the corners; empty if there are none.
    pub fn bounds(&self) -> Aabb<3> {
        Aabb::around(self.vertices.iter().copied())
    }

    /// The corners of each triangle.
    pub fn corners(&self) -> impl ExactSizeIterator<Item = [Point3; 3]> + '_ {
        self.triangles.iter().map(|t| t.map(|i| self.vertices[i as usize]))
    }
}

/// A scene in space, checked: coordinates that the predicates accept, indices in range.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Scene {
    objects: Vec<SceneObject>,
    mirrors: Vec<u32>,
}

/// Why objects do not make a scene.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// A coordinate cannot be used.
    #[error("object {object}, vertex {vertex}: {kind}")]
    Vertex {
        /// Index of the object.
        object: usize,
        /// Index of the vertex in it.
        vertex: usize,
        /// What is wrong with it.
        #[source]
        kind: CoordinateError,
    },
    /// A triangle names a corner that does not exist.
    #[error("object {object}, triangle {triangle}: there is no vertex {vertex}")]
    Index {
        /// Index of the object.
        object: usize,
        /// Index of the triangle in it.
        triangle: usize,
        /// The corner that it names.
        vertex: u32,
    },
    /// What is marked as a mirror is no object.
    #[error("object {object} cannot be a mirror: there is no such object")]
    Mirror {
        /// Index of the object.
        object: usize,
    },
}

impl Scene {
    /// Checks `objects`; their order gives them their ids. Negative zeros become zeros.
    ///
    /// # Errors
    /// [`SceneError`] with the place of the first offender.
    pub fn new(objects: Vec<SceneObject>) -> Result<Self, SceneError> {
        let mut objects = objects;
        for (object, o) in objects.iter_mut().enumerate() {
            for (vertex, p) in o.vertices.iter_mut().enumerate() {
                for x in p {
                    *x = check_coordinate(*x).map_err(|kind| SceneError::Vertex { object, vertex, kind })?;
                }
            }
            for (triangle, t) in o.triangles.iter().enumerate() {
                if let Some(&vertex) = t.iter().find(|&&i| i as usize >= o.vertices.len()) {
                    return Err(SceneError::Index { object, triangle, vertex });
                }
            }
        }
        Ok(Self { objects, mirrors: Vec::new() })
    }

    /// The same scene, with the faces of these objects as mirrors, and no others.
    ///
    /// # Errors
    /// [`SceneError::Mirror`] for an object that does not exist.
    pub fn with_mirrors(mut self, mut mirrors: Vec<u32>) -> Result<Self, SceneError> {
        mirrors.sort_unstable();
        mirrors.dedup();
        if let Some(&object) = mirrors.iter().find(|&&object| object as usize >= self.objects.len()) {
            return Err(SceneError::Mirror { object: object as usize });
        }
        self.mirrors = mirrors;
        Ok(self)
    }

    /// The objects that are mirrors, ascending.
    pub fn mirrors(&self) -> &[u32] {
        &self.mirrors
    }

    /// The objects, by id.
    pub fn objects(&self) -> &[SceneObject] {
        &self.objects
    }

    /// Number of triangles of all objects.
    pub fn n_triangles(&self) -> usize {
        self.objects.iter().map(|o| o.triangles.len()).sum()
    }

    /// Smallest box around everything; empty for a scene without vertices.
    pub fn bounds(&self) -> Aabb<3> {
        Aabb::around(self.objects.iter().flat_map(|o| o.vertices.iter().copied()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle(corners: [Point3; 3], indices: [u32; 3]) -> SceneObject {
        SceneObject { name: "t".to_owned(), vertices: corners.to_vec(), triangles: vec![indices] }
    }

    #[test]
    fn scenes_are_checked() {
        let good = triangle([[0., 0., 0.], [1., 0., 0.], [0., 2., -0.]], [0, 1, 2]);
        let scene = Scene::new(vec![good.clone()]).unwrap();
        assert_eq!((scene.n_triangles(), scene.bounds().max), (1, [1., 2., 0.]));
        assert_eq!(scene.objects()[0].corners().next(), Some([[0., 0., 0.], [1., 0., 0.], [0., 2., 0.]]));
        let bad = triangle([[0., 0., 0.], [1., f64::INFINITY, 0.], [0., 2., 0.]], [0, 1, 2]);
        let error = Scene::new(vec![good.clone(), bad]).unwrap_err();
        assert_eq!(error.to_string(), "object 1, vertex 1: coordinate inf is not a finite number");
        let bad = SceneObject { triangles: vec![[0, 1, 2], [0, 3, 1]], ..good };
        assert_eq!(Scene::new(vec![bad]).unwrap_err().to_string(), "object 0, triangle 1: there is no vertex 3");
        assert_eq!(scene.clone().with_mirrors(vec![0, 0]).unwrap().mirrors(), [0]);
        let error = scene.with_mirrors(vec![1]).unwrap_err().to_string();
        assert_eq!(error, "object 1 cannot be a mirror: there is no such object");
    }
}
