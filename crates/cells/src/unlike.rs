//! Whether a table is of a scene, as far as its objects show.

use crate::scene::Scene;
use sightlines_geometry::{Aabb, Point3};
use sightlines_pvs::Frame;

/// What a table and a scene do not have in common.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Unlike {
    /// The table has two dimensions.
    #[error("the table is of a plan")]
    Plane,
    /// They have not as many objects.
    #[error("the table has {table} objects, the scene {scene}")]
    Count {
        /// Objects of the table.
        table: usize,
        /// Objects of the scene.
        scene: usize,
    },
    /// An object has another name.
    #[error("object {object} is called {table:?} in the table and {scene:?} in the scene")]
    Name {
        /// Index of the object.
        object: u32,
        /// Its name in the table.
        table: String,
        /// Its name in the scene.
        scene: String,
    },
    /// The digest of the table is not that of the scene.
    #[error("it was made of other geometry: the scene has changed, or is read with other options")]
    Changed,
    /// An object reaches out of its box.
    #[error("object {object}, {name:?}, is not where the table has it")]
    Box {
        /// Index of the object.
        object: u32,
        /// Its name.
        name: String,
    },
}

/// Compares the objects of a scene with those of a table: their number, names and boxes. A table does not hold what is within a
/// box, and what moves is in a larger one, so this finds tables of other scenes, and not all of them.
///
/// * `dimension`, `frame`: of the table
/// * `n`: number of its objects
/// * `object`: the name and the box of each of them
///
/// # Errors
/// Those of `object`.
pub fn unlike<E>(
    scene: &Scene,
    dimension: u8,
    frame: Option<&Frame>,
    n: usize,
    mut object: impl FnMut(u32) -> Result<(String, Aabb<3>), E>,
) -> Result<Option<Unlike>, E> {
    if dimension != 3 {
        return Ok(Some(Unlike::Plane));
    }
    if n != scene.objects().len() {
        return Ok(Some(Unlike::Count { table: n, scene: scene.objects().len() }));
    }
    for (id, o) in (0u32..).zip(scene.objects()) {
        let (name, known) = object(id)?;
        if name != o.name {
            return Ok(Some(Unlike::Name { object: id, table: name, scene: o.name.clone() }));
        }
        // In a table with a frame a corner is within the gap of its place along it.
        let along = |p: Point3| frame.map_or([p; 2], |frame| frame.around(p, p).into());
        let is_off = |[min, max]: [Point3; 2]| (0..3).any(|k| max[k] < known.min[k] || min[k] > known.max[k]);
        if o.corners().flatten().map(along).any(is_off) {
            return Ok(Some(Unlike::Box { object: id, name }));
        }
    }
    Ok(None)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::SceneObject;
    use std::convert::Infallible;

    #[test]
    fn tables_of_other_scenes_are_told() {
        let vertices = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]];
        let wall = SceneObject { name: "wall".to_owned(), vertices, triangles: vec![[0, 1, 2]] };
        let scene = Scene::new(vec![wall]).unwrap();
        let of = |dimension: u8, n: usize, name: &str, max: [f64; 3]| {
            let record = |_| Ok::<_, Infallible>((name.to_owned(), Aabb { min: [0.0; 3], max }));
            let Ok(found) = unlike(&scene, dimension, None, n, record);
            found.map(|found| found.to_string())
        };
        assert_eq!(of(3, 1, "wall", [1.0, 2.0, 0.0]), None);
        assert_eq!(of(3, 1, "wall", [1.0, 2.0, 9.0]), None);
        assert_eq!(of(2, 1, "wall", [1.0, 2.0, 0.0]).unwrap(), "the table is of a plan");
        assert_eq!(of(3, 2, "wall", [1.0, 2.0, 0.0]).unwrap(), "the table has 2 objects, the scene 1");
        let name = of(3, 1, "door", [1.0, 2.0, 0.0]).unwrap();
        assert_eq!(name, "object 0 is called \"door\" in the table and \"wall\" in the scene");
        let place = of(3, 1, "wall", [1.0, 1.0, 0.0]).unwrap();
        assert_eq!(place, "object 0, \"wall\", is not where the table has it");
    }
}
