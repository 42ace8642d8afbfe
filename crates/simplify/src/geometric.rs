//! The ordinary metric of shape, for comparison.

use crate::mesh::{Change, Collapser, Mesh, Policy, Weights};
use crate::simplified::{Counts, Simplified};
use crate::simplify::{SimplifyError, finish};
use crate::weigh::Areas;
use sightlines_cells::Scene;
use sightlines_visible_surface::Faces;

/// Simplifies a scene by its shape alone, to at most `target` triangles as far as edges can be collapsed: the ordinary
/// metric, independent of eyes, for comparison. Each object is a mesh of its own. Gives no guarantee about what is
/// visible.
///
/// # Errors
/// [`SimplifyError::Faces`]
///
/// # Source
/// Garland and Heckbert, "Surface simplification using quadric error metrics", SIGGRAPH 1997; weighted by area.
pub fn geometric(scene: &Scene, target: usize) -> Result<Simplified, SimplifyError> {
    struct Count(usize);
    impl Policy for Count {
        fn may_touch(&self, _: &Mesh, _: u32) -> bool {
            true
        }
        fn accepts(&mut self, _: &Mesh, _: &Change, _: f64) -> bool {
            true
        }
        fn is_done(&self, mesh: &Mesh) -> bool {
            mesh.n_left() <= self.0
        }
    }
    let (whole, scene) = (scene, &*scene.still_part());
    let faces = Faces::of_scene(scene)?;
    let mut mesh = Mesh::of_objects(scene);
    let mut counts = Counts { before: faces.len(), ..Counts::default() };
    for face in faces.ids().filter(|&f| !faces.has_area(f)) {
        counts.without_area += 1;
        mesh.remove(face);
    }
    let area = Areas::new(&faces);
    let weights = Weights { face: &|face| area.share(face), may_be_silhouette: &|_, _| false };
    let mut collapser = Collapser::new(&mesh, &weights);
    collapser.run(&mut mesh, &mut Count(target));
    let deviation = collapser.deviation();
    Ok(finish(scene, &mesh, counts, f64::INFINITY, [deviation, f64::INFINITY]).with_moving_of(whole))
}
