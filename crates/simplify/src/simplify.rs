//! From a scene to one with fewer triangles.

use crate::collapse_budget::CollapseBudget;
use crate::estimate::HitEstimate;
use crate::hidden::{HiddenBy, Hider};
use crate::intercepts::Intercepts;
use crate::mesh::{Collapser, Left, Mesh, State, Weights, merge};
use crate::options::{OptionsError, SimplifyOptions};
use crate::select::{Account, kept_faces, least_visible};
use crate::simplified::{Counts, Simplified};
use crate::views::{Views, ViewsError};
use crate::weigh::{Areas, Fronts};
use sightlines_cells::{Scene, Unlike, unlike};
use sightlines_geometry::Aabb;
use sightlines_multifocal::BackendError;
use sightlines_progress::Halt;
use sightlines_pvs::Table;
use sightlines_visible_surface::{Faces, FacesError};
use std::borrow::Cow;
use std::convert::Infallible;

/// Why a scene was not simplified.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SimplifyError {
    /// An option out of its range.
    #[error(transparent)]
    Options(#[from] OptionsError),
    /// A scene whose faces cannot be rendered.
    #[error(transparent)]
    Faces(#[from] FacesError),
    /// The method failed.
    #[error(transparent)]
    Backend(#[from] BackendError),
    /// The table is not of the scene.
    #[error("the table is of another scene: {0}")]
    OtherScene(Unlike),
    /// A view is of a cell that the table does not have, or has elsewhere.
    #[error("the views are cells of another table: cell {cell} of this one is not there")]
    OtherTable {
        /// The cell.
        cell: u32,
    },
    /// A scene whose mirrors show hidden things.
    #[error("the scene has mirrors ({n}), and what is seen in them alone would be left out; mirrors can be ignored")]
    Mirrors {
        /// Number of mirrors.
        n: usize,
    },
    /// Cells of a table that are not boxes, or an empty list.
    #[error(transparent)]
    Views(#[from] ViewsError),
    /// A memory budget that is too small for one level.
    #[error("{asked} bytes are too few: a level for all cells takes {least}")]
    Memory {
        /// The requested memory.
        asked: u64,
        /// The smallest possible memory, with this budget.
        least: u64,
    },
    /// An observer or a store of units ends the work.
    #[error(transparent)]
    Halted(#[from] Halt),
}

/// The weight of area relative to that of rays: a face that no ray of the estimate hit counts as if all faces together
/// had this much of the view, by area. Without it, such faces could be deformed arbitrarily.
const WEIGHT_OF_AREA: f64 = 1e-3;

/// Simplifies a scene for all eyes of `views`.
///
/// 1. Faces that are proven hidden from every eye, or have no area, are removed; no ray changes.
/// 2. The faces that intercept least are left out, within the budget except for the part reserved for collapsing.
/// 3. Among the faces that intercept least of the rest, edges are collapsed, in order of how little the shape changes
///    where rays see it (quadrics weighted by the estimate; silhouettes and borders in proportion). A corner moves to a
///    neighbour, so no vertex is new and vertices keep all their attributes.
/// 4. The rest of the budget is spent on leaving out more faces.
/// 5. On request, faces of an object that lie exactly in one plane are merged where the surface stays the same set of
///    points.
///
/// * `by`: what proves faces hidden; without it, bounds still hold, but are larger
///
/// The guarantee is for eyes that lie on no surface: an eye on a wall sees past it on both sides, where surfaces hidden
/// from all other eyes are removed.
///
/// Errs on the side of the guarantee (see [`crate`]): fewer triangles might suffice. Views inside an object, or crossed
/// by surfaces, need no special care: what touches a view is never left out within a budget below one half. Meshes may
/// be open, and need not be manifold: places at which more than two faces meet at an edge stay where they are.
///
/// Deterministic, whatever the number of threads. Costs what the method costs for each part of the views, the rays, and
/// O(n log n) for collapsing. Memory: 8 bytes for each face and part.
///
/// What [moves](Scene::moving) stays as it is.
///
/// # Errors
/// [`SimplifyError`]
///
/// # Source
/// The intercepted share as the metric: Marsden's slides on the multifocal z-buffer, 2002; hardly-visible sets: Andújar
/// et
/// al., Computer Graphics Forum 19(3), 2000.
pub fn simplify(
    scene: &Scene,
    views: &Views,
    by: &HiddenBy<'_>,
    options: &SimplifyOptions,
) -> Result<Simplified, SimplifyError> {
    PreparedScene::of(scene, views, by, options, options.budget > 0.0)?.simplify(options)
}

/// A scene with bounds on what its faces can intercept for some views: to be simplified with several budgets.
#[derive(Debug)]
pub struct PreparedScene<'a> {
    whole: &'a Scene,
    /// What does not move.
    scene: Cow<'a, Scene>,
    faces: Faces,
    views: Views,
    intercepts: Intercepts,
}

impl<'a> PreparedScene<'a> {
    /// Determines what is hidden, and bounds the rest. Of the options, only the number of parts, the depth and the
    /// threads matter.
    ///
    /// # Errors
    /// [`SimplifyError`]
    pub fn new(
        scene: &'a Scene,
        views: &Views,
        by: &HiddenBy<'_>,
        options: &SimplifyOptions,
    ) -> Result<Self, SimplifyError> {
        Self::of(scene, views, by, options, true)
    }

    /// * `has_budget`: whether there will be one; without, all that matters is what no eye sees
    fn of(
        scene: &'a Scene,
        views: &Views,
        by: &HiddenBy<'_>,
        options: &SimplifyOptions,
        has_budget: bool,
    ) -> Result<Self, SimplifyError> {
        options.check()?;
        check_mirrors(scene, options)?;
        if let Some(table) = by.table {
            check_table(scene, table)?;
            check_views(views, table)?;
        }
        in_threads(options.threads, || {
            let (whole, scene) = (scene, scene.still_part());
            let faces = Faces::of_scene(&scene)?;
            let views = views.clone().cut(options.n_parts);
            let intercepts = if has_budget {
                Intercepts::new(&faces, &views, by, options.depth)?
            } else {
                Intercepts::of_any(&Hider::new(&faces, by).may_see_from_any(&views)?)
            };
            Ok(Self { whole, scene, faces, views, intercepts })
        })
    }

    /// Simplifies as [`simplify`] does, with the prepared bounds.
    ///
    /// # Errors
    /// [`SimplifyError::Options`]
    pub fn simplify(&self, options: &SimplifyOptions) -> Result<Simplified, SimplifyError> {
        options.check()?;
        let Self { whole, scene, faces, views, intercepts } = self;
        let run = || within_budget(scene, faces, || Mesh::new(scene), views, intercepts, options).with_moving_of(whole);
        Ok(in_threads(options.threads, run))
    }

    /// Bounds on what its faces can intercept, for each part of [`Self::views`].
    pub const fn intercepts(&self) -> &Intercepts {
        &self.intercepts
    }

    /// The views, in parts.
    pub const fn views(&self) -> &Views {
        &self.views
    }

    /// Its faces, but for those of what moves.
    pub const fn faces(&self) -> &Faces {
        &self.faces
    }
}

/// Runs on this many threads; 0 for one per core.
pub(crate) fn in_threads<T: Send>(threads: usize, run: impl FnOnce() -> T + Send) -> T {
    match rayon::ThreadPoolBuilder::new().num_threads(threads).build() {
        Ok(pool) => pool.install(run),
        // No threads could be created: the existing ones are used.
        Err(_) => run(),
    }
}

/// Refuses scenes with mirrors, unless they are ignored.
pub(crate) fn check_mirrors(scene: &Scene, options: &SimplifyOptions) -> Result<(), SimplifyError> {
    match scene.mirrors().len() {
        n if n > 0 && !options.ignore_mirrors => Err(SimplifyError::Mirrors { n }),
        _ => Ok(()),
    }
}

/// Whether the cells of views are cells of a table.
fn check_views(views: &Views, table: &Table) -> Result<(), SimplifyError> {
    for (cell, view) in views.parts().iter().filter_map(|v| Some((v.cell?, v))) {
        let record = table.cells().get(cell.idx()).map(|c| Aabb { min: c.min, max: c.max });
        let view = view.volume.bounds();
        if !record.is_some_and(|cell| cell.contains(view.min) && cell.contains(view.max)) {
            return Err(SimplifyError::OtherTable { cell: cell.0 });
        }
    }
    Ok(())
}

/// Refuses a table of another scene, and one with a frame.
pub(crate) fn check_table(scene: &Scene, table: &Table) -> Result<(), SimplifyError> {
    // Its cells are along other axes than the scene, whose objects may still be where it says.
    if table.frame().is_some() {
        return Err(ViewsError::Frame.into());
    }
    let object = |id: u32| {
        let record = &table.objects()[id as usize];
        Ok::<_, Infallible>((record.name.clone(), Aabb { min: record.min, max: record.max }))
    };
    let Ok(found) = unlike(scene, table.dimension(), table.frame(), table.objects().len(), object);
    // Faces that the table hides may have come to light.
    let has_changed = || table.digest().is_some_and(|digest| digest != scene.digest());
    let unlike = found.or_else(|| has_changed().then_some(Unlike::Changed));
    unlike.map_or(Ok(()), |unlike| Err(SimplifyError::OtherScene(unlike)))
}

/// Simplifies within the budget, given bounds on what faces can intercept.
///
/// * `mesh`: makes that of the whole scene; it is not needed where only hidden faces go
pub(crate) fn within_budget(
    scene: &Scene,
    faces: &Faces,
    mesh: impl FnOnce() -> Mesh,
    views: &Views,
    intercepts: &Intercepts,
    options: &SimplifyOptions,
) -> Simplified {
    if options.budget == 0.0 && !options.flat {
        return without_hidden(scene, faces, intercepts);
    }
    let mut mesh = mesh();
    let mut counts = Counts { before: faces.len(), ..Counts::default() };
    let mut hidden = vec![Vec::new(); scene.objects().len()];
    let mut first = 0;
    for (object, hidden) in scene.objects().iter().zip(&mut hidden) {
        for (k, face) in (0..object.triangles.len() as u32).zip(first..) {
            if !faces.has_area(face) {
                counts.without_area += 1;
                mesh.remove(face);
            } else if intercepts.is_hidden(face) {
                hidden.push(k);
                mesh.remove(face);
            }
        }
        counts.hidden += hidden.len();
        first += object.triangles.len() as u32;
    }
    let (budget, kept) = (options.budget, options.budget * options.collapse);
    let mut account = Account::new(intercepts.n_parts());
    let delete = |mesh: &mut Mesh, account: &mut Account, budget: f64| {
        let candidates: Vec<u32> = kept_faces(mesh, faces).collect();
        let mut n = 0;
        least_visible(intercepts, candidates.into_iter(), budget, account, |face| {
            mesh.remove(face);
            n += 1;
        });
        n
    };
    if budget > 0.0 {
        counts.deleted += delete(&mut mesh, &mut account, budget - kept);
    }
    let [mut deviation, mut shift] = [0.0; 2];
    if kept > 0.0 {
        // One half of the reserved budget covers removed faces, the other new ones.
        let mut paying = CollapseBudget::choose(faces, views, intercepts, &mesh, options, account);
        let estimate = HitEstimate::through(scene, faces, views, options.n_rays);
        let fronts = Fronts::new(faces, views);
        let area = Areas::new(faces);
        let weights = Weights {
            face: &|face| estimate.share(face) + WEIGHT_OF_AREA * area.share(face),
            may_be_silhouette: &|f, g| fronts.may_differ(f, g),
        };
        let mut collapser = Collapser::new(&mesh, &weights);
        collapser.run(&mut mesh, &mut paying);
        (deviation, shift) = (collapser.deviation(), paying.shift);
        account = paying.settle(&mesh);
        counts.deleted += delete(&mut mesh, &mut account, budget);
    }
    if options.flat {
        let before = mesh.n_left();
        merge(&mut mesh);
        counts.merged_away = before - mesh.n_left();
    }
    Simplified { hidden, ..finish(scene, &mesh, counts, account.most(), [deviation, shift]) }
}

/// What is left without faces that are hidden or have no area.
fn without_hidden(scene: &Scene, faces: &Faces, intercepts: &Intercepts) -> Simplified {
    let mut counts = Counts { before: faces.len(), ..Counts::default() };
    let n = scene.objects().len();
    let (mut triangles, mut origin, mut hidden) = (Vec::with_capacity(n), Vec::with_capacity(n), Vec::with_capacity(n));
    let mut face = 0;
    for object in scene.objects() {
        let (mut kept, mut gone) = (Vec::new(), Vec::new());
        for k in 0..object.triangles.len() as u32 {
            if !faces.has_area(face) {
                counts.without_area += 1;
            } else if intercepts.is_hidden(face) {
                gone.push(k);
            } else {
                kept.push(k);
            }
            face += 1;
        }
        counts.hidden += gone.len();
        counts.left += kept.len();
        triangles.push(kept.iter().map(|&k| object.triangles[k as usize]).collect());
        origin.push(kept.into_iter().map(Some).collect());
        hidden.push(gone);
    }
    Simplified { triangles, origin, hidden, bound: 0.0, deviation: 0.0, shift: 0.0, counts }
}

pub(crate) fn finish(
    scene: &Scene,
    mesh: &Mesh,
    mut counts: Counts,
    bound: f64,
    [deviation, shift]: [f64; 2],
) -> Simplified {
    let Left { triangles, origin } = mesh.left(scene);
    let n = |state: State| mesh.faces().iter().filter(|f| f.state == state).count();
    (counts.new, counts.merged, counts.left) = (n(State::New), n(State::Merged), mesh.n_left());
    let gone = counts.before - counts.without_area - counts.hidden - counts.deleted - counts.merged_away;
    counts.collapsed = gone - counts.merged - n(State::Kept);
    let hidden = vec![Vec::new(); triangles.len()];
    Simplified { triangles, origin, hidden, bound, deviation, shift, counts }
}

#[cfg(test)]
mod tests;
