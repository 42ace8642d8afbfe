//! The result of simplification.

use sightlines_cells::{Scene, SceneError, SceneObject};

/// A scene with fewer triangles, as a change to the scene it was made of.
#[derive(Debug, Clone, PartialEq)]
pub struct Simplified {
    /// For each object of the scene the remaining triangles, as indices of the object's own vertices: no vertex is new.
    /// Kept ones come first, in their order, then merged and new ones.
    pub triangles: Vec<Vec<[u32; 3]>>,
    /// For each of them which triangle of its object it was; `None` for a merged or new one.
    pub origin: Vec<Vec<Option<u32>>>,
    /// For each object which of its triangles were removed because they are proven hidden, ascending.
    pub hidden: Vec<Vec<u32>>,
    /// For every eye of the views that lies on no surface: an upper bound of the share of directions whose first hit
    /// changed. Proven, if a table had a part in it for eyes that see the back of no single-sided face; infinite for [`geometric`](crate::geometric), which has no bound.
    pub bound: f64,
    /// Upper bound, in scene units, of how far collapsing has moved the surface: changed points, before and after, are
    /// no farther than this from the other surface. 0 if nothing was collapsed. Holes where faces were left out are not
    /// counted.
    pub deviation: f64,
    /// Upper bound of how far collapsing has moved it as a fraction of its distance from the eye, for every eye: about
    /// the angle by which it appears to move. At most [`SimplifyOptions::shift`](crate::SimplifyOptions::shift);
    /// infinite for [`geometric`](crate::geometric).
    pub shift: f64,
    /// Counts of triangles.
    pub counts: Counts,
}

/// Counts of triangles.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct Counts {
    /// Triangles before.
    #[cfg_attr(feature = "serde", serde(rename = "n_before"))]
    pub before: usize,
    /// Triangles without area, which were removed.
    #[cfg_attr(feature = "serde", serde(rename = "n_without_area"))]
    pub without_area: usize,
    /// Triangles removed because no eye sees them.
    #[cfg_attr(feature = "serde", serde(rename = "n_hidden"))]
    pub hidden: usize,
    /// Triangles removed for the budget.
    #[cfg_attr(feature = "serde", serde(rename = "n_deleted"))]
    pub deleted: usize,
    /// Triangles removed or replaced by collapsing edges.
    #[cfg_attr(feature = "serde", serde(rename = "n_collapsed"))]
    pub collapsed: usize,
    /// Triangles that replace collapsed ones.
    #[cfg_attr(feature = "serde", serde(rename = "n_new"))]
    pub new: usize,
    /// Triangles saved by merging coplanar ones.
    #[cfg_attr(feature = "serde", serde(rename = "n_merged_away"))]
    pub merged_away: usize,
    /// Triangles that are the result of merging.
    #[cfg_attr(feature = "serde", serde(rename = "n_merged"))]
    pub merged: usize,
    /// Triangles after.
    #[cfg_attr(feature = "serde", serde(rename = "n_left"))]
    pub left: usize,
}

impl Simplified {
    /// Whether everything that is left lies inside the original surface: nothing is new except merged faces. Only then
    /// may it be used as an occluder, there or elsewhere.
    pub fn is_part_of_the_original(&self) -> bool {
        self.counts.new == 0
    }

    /// Whether an object lost or changed a triangle.
    pub fn changes(&self, scene: &Scene, object: usize) -> bool {
        let all = scene.objects()[object].triangles.len();
        let origin = &self.origin[object];
        origin.len() != all || origin.iter().any(Option::is_none)
    }

    /// The same, with all triangles of what moves in a scene: they are never changed. This was made of its
    /// [part that does not move](Scene::still_part).
    pub(crate) fn with_moving_of(mut self, scene: &Scene) -> Self {
        for moving in scene.moving() {
            let all = &scene.objects()[moving.object as usize].triangles;
            self.triangles[moving.object as usize].clone_from(all);
            self.origin[moving.object as usize] = (0..all.len() as u32).map(Some).collect();
            self.counts.before += all.len();
            self.counts.left += all.len();
        }
        self
    }

    /// Whether what is left may be used as an occluder at the place of the original. Faces that are merged along a [frame](sightlines_pvs::Frame) are in one
    /// plane there; with the corners of the file they are so only within the gap, and a merged face may be off the surface by as much.
    ///
    /// * `is_framed`: whether it was simplified along a frame, with other corners than it is used with
    pub fn is_occluder(&self, is_framed: bool) -> bool {
        self.is_part_of_the_original() && !(is_framed && self.counts.merged > 0)
    }

    /// The remaining triangles as a scene: the same objects with the same vertices, some perhaps without triangles.
    ///
    /// # Errors
    /// [`SceneError`], never for the scene that it was made from.
    pub fn scene(&self, scene: &Scene) -> Result<Scene, SceneError> {
        let object = |(o, triangles): (&SceneObject, &Vec<[u32; 3]>)| SceneObject {
            name: o.name.clone(),
            vertices: o.vertices.clone(),
            triangles: triangles.clone(),
        };
        scene.replaced((0..).zip(scene.objects().iter().zip(&self.triangles).map(object)))
    }

    /// The objects of which something is left, with the vertices that are used; without doors and sources.
    ///
    /// # Errors
    /// As [`Simplified::scene`].
    pub fn left(&self, scene: &Scene) -> Result<Scene, SceneError> {
        let object = |(o, triangles): (&SceneObject, &Vec<[u32; 3]>)| {
            let mut used: Vec<u32> = triangles.iter().flatten().copied().collect();
            used.sort_unstable();
            used.dedup();
            let place = |v: u32| used.partition_point(|&u| u < v) as u32;
            SceneObject {
                name: o.name.clone(),
                vertices: used.iter().map(|&v| o.vertices[v as usize]).collect(),
                triangles: triangles.iter().map(|t| t.map(place)).collect(),
            }
        };
        let objects = (0..).zip(scene.objects().iter().zip(&self.triangles).map(object));
        scene.replaced(objects.filter(|(_, object)| !object.triangles.is_empty()))
    }
}
