//! What simplification leaves.

use sightlines_cells::{Scene, SceneError, SceneObject};

/// A scene with fewer triangles, as a change to the scene it was made of.
#[derive(Debug, Clone, PartialEq)]
pub struct Simplified {
    /// For each object of the scene the triangles that are left, as indices of the object's own vertices: no vertex is new.
    /// Kept ones come first, in their order, then merged and new ones.
    pub triangles: Vec<Vec<[u32; 3]>>,
    /// For each of them which triangle of its object it was, and `None` for a merged or new one.
    pub origin: Vec<Vec<Option<u32>>>,
    /// For each object which of its triangles were taken away because they are proven hidden, ascending.
    pub hidden: Vec<Vec<u32>>,
    /// For every eye of the views that lies on no surface: the share of the sphere of directions in which the first hit is another one is at most this.
    /// A proven bound; for [`geometric`](crate::geometric) there is none, and it is infinite.
    pub bound: f64,
    /// How far collapsing has moved the surface at most, in scene units: points of what was changed, before and after, are no farther from the
    /// other surface. 0 if nothing was collapsed. Holes of what was left out are not counted.
    pub deviation: f64,
    /// How far collapsing has moved it at most as a part of its distance to the eye, for every eye: near the angle by which it seems to have
    /// moved. At most [`SimplifyOptions::shift`](crate::SimplifyOptions::shift); infinite for [`geometric`](crate::geometric).
    pub shift: f64,
    /// What became of the triangles.
    pub counts: Counts,
}

/// What became of triangles.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counts {
    /// Those of the scene.
    pub before: usize,
    /// Taken away, as they have no area.
    pub without_area: usize,
    /// Taken away, as they are proven hidden from every eye.
    pub hidden: usize,
    /// Left out within the budget.
    pub deleted: usize,
    /// Taken away by collapsing, or changed by it.
    pub collapsed: usize,
    /// Put in by collapsing.
    pub new: usize,
    /// Saved by merging faces in one plane.
    pub merged_away: usize,
    /// Put in by merging: they cover what was covered before.
    pub merged: usize,
    /// What is left, new and merged ones included.
    pub left: usize,
}

impl Simplified {
    /// Whether what is left lies inside of what was there: nothing is new but what was merged. Only then may it hide something, where it was made for or
    /// elsewhere.
    pub fn is_part_of_the_original(&self) -> bool {
        self.counts.new == 0
    }

    /// Whether an object lost or changed a triangle.
    pub fn changes(&self, scene: &Scene, object: usize) -> bool {
        let all = scene.objects()[object].triangles.len();
        let origin = &self.origin[object];
        origin.len() != all || origin.iter().any(Option::is_none)
    }

    /// What is left, as a scene: the same objects with the same vertices, some perhaps without triangles.
    ///
    /// # Errors
    /// [`SceneError`], never for the scene that it was made of.
    pub fn scene(&self, scene: &Scene) -> Result<Scene, SceneError> {
        let object = |(o, triangles): (&SceneObject, &Vec<[u32; 3]>)| SceneObject {
            name: o.name.clone(),
            vertices: o.vertices.clone(),
            triangles: triangles.clone(),
        };
        let objects = scene.objects().iter().zip(&self.triangles).map(object).collect();
        Scene::new(objects)?.with_mirrors(scene.mirrors().to_vec())
    }
}
