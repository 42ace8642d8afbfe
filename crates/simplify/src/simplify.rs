//! From a scene to one with fewer triangles.

use crate::bound;
use crate::estimate::Estimate;
use crate::hidden::HiddenBy;
use crate::intercepts::Intercepts;
use crate::mesh::{Change, Collapser, Mesh, Policy, State, Weights, merge};
use crate::options::{OptionsError, SimplifyOptions};
use crate::select::{Account, least_visible};
use crate::simplified::{Counts, Simplified};
use crate::views::{View, Views, ViewsError};
use sightlines_cells::Scene;
use sightlines_geometry::{Aabb, Point3, orient3d};
use sightlines_multifocal::BackendError;
use sightlines_pvs::Table;
use sightlines_visible_surface::{Faces, FacesError};
use std::collections::BTreeMap;

/// Why a scene was not simplified.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SimplifyError {
    /// An option out of its range.
    #[error(transparent)]
    Options(#[from] OptionsError),
    /// A scene that cannot be looked at.
    #[error(transparent)]
    Faces(#[from] FacesError),
    /// The method failed.
    #[error(transparent)]
    Backend(#[from] BackendError),
    /// The table is not of the scene.
    #[error("the table is of another scene: {0}")]
    OtherScene(String),
    /// Cells of a table that are no boxes, or none at all.
    #[error(transparent)]
    Views(#[from] ViewsError),
    /// A memory that is too small for one level.
    #[error("{asked} bytes are too few: a level for all cells takes {least}")]
    Memory {
        /// What was asked for.
        asked: u64,
        /// What is needed at least, with this budget.
        least: u64,
    },
}

/// The weight of an area beside that of rays: a face that no ray of the estimate met counts as if all faces together had so much of the
/// view, by area. Without it, what is not met would be bent in any way.
const WEIGHT_OF_AREA: f64 = 1e-3;

/// Simplifies a scene for all eyes of `views`.
///
/// 1. What is proven hidden from every eye, or has no area, is taken away; no ray is changed.
/// 2. The faces that intercept least are left out, within the budget but for the part that is kept for collapsing.
/// 3. Of what intercepts least among the rest, edges are collapsed, those first that change the shape least where rays see it
///    ([quadrics](Collapser) weighted by the estimate; silhouettes and borders keep their share). A corner moves to a
///    neighbour, so no vertex is new and all that belongs to vertices survives.
/// 4. What is left of the budget leaves out more.
/// 5. If asked for, faces of an object that lie in one plane, exactly, are merged where the surface stays the same set of points.
///
/// * `by`: what proves faces hidden; with nothing, bounds are still bounds, and larger
///
/// Errs on the side of the promise (see [`crate`]): fewer triangles might do. A view inside of an object, or through which surfaces pass,
/// is a place as any other: what it touches is never left out within a budget below one half. Meshes may be open, and need not be manifold: places at
/// which more than two faces meet at an edge stay where they are.
///
/// Deterministic, whatever the number of threads. Costs what the method costs for each part of the views, the rays, and
/// O(n log n) for collapsing. Memory: 8 bytes for each face and part.
///
/// # Errors
/// [`SimplifyError`]
///
/// # Source
/// What a face intercepts as the metric: Marsden's slides on the multifocal z-buffer, 2002; hardly-visible sets: Andújar et
/// al., Computer Graphics Forum 19(3), 2000.
pub fn simplify(
    scene: &Scene,
    views: &Views,
    by: &HiddenBy<'_>,
    options: &SimplifyOptions,
) -> Result<Simplified, SimplifyError> {
    options.check()?;
    if let Some(table) = by.table {
        check_table(scene, table)?;
    }
    in_threads(options.threads, || {
        let faces = Faces::of_scene(scene)?;
        let views = views.clone().cut(options.n_parts);
        let intercepts = Intercepts::new(&faces, &views, by, options.depth)?;
        Ok(within_budget(scene, &faces, Mesh::new(scene), &views, &intercepts, options))
    })
}

/// Runs with so many threads; 0 for one for each core.
pub(crate) fn in_threads<T: Send>(threads: usize, run: impl FnOnce() -> T + Send) -> T {
    match rayon::ThreadPoolBuilder::new().num_threads(threads).build() {
        Ok(pool) => pool.install(run),
        // Threads cannot be had: those of the process will do.
        Err(_) => run(),
    }
}

/// Whether a table has the objects of a scene.
pub(crate) fn check_table(scene: &Scene, table: &Table) -> Result<(), SimplifyError> {
    let other = |what: String| Err(SimplifyError::OtherScene(what));
    if table.dimension() != 3 {
        return other("it is of a plan".to_owned());
    }
    let (n, m) = (scene.objects().len(), table.objects().len());
    if n != m {
        return other(format!("it has {m} objects, the scene {n}"));
    }
    for (id, (object, record)) in scene.objects().iter().zip(table.objects()).enumerate() {
        let bounds = Aabb::<3>::around(object.corners().flatten());
        if object.name != record.name {
            return other(format!("object {id} is called {:?} in it and {:?} in the scene", record.name, object.name));
        }
        if (0..3).any(|k| bounds.min[k] < record.min[k] || bounds.max[k] > record.max[k]) {
            return other(format!("object {id}, {:?}, is somewhere else", object.name));
        }
    }
    Ok(())
}

/// What remains when it is known what faces intercept; `mesh` is the whole scene's.
pub(crate) fn within_budget(
    scene: &Scene,
    faces: &Faces,
    mut mesh: Mesh,
    views: &Views,
    intercepts: &Intercepts,
    options: &SimplifyOptions,
) -> Simplified {
    let mut counts = Counts { before: faces.len(), ..Counts::default() };
    for face in faces.ids() {
        if !faces.has_area(face) {
            counts.without_area += 1;
            mesh.remove(face);
        } else if intercepts.is_hidden(face) {
            counts.hidden += 1;
            mesh.remove(face);
        }
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
        // Half of what is kept pays for what goes, the other for what comes.
        let mut paid = Paid::choose(faces, views, intercepts, &mesh, options, account);
        let estimate = Estimate::new(faces, views, options.n_rays);
        let fronts = Fronts::new(faces, views);
        let area = Areas::new(faces);
        let weights = Weights {
            face: &|face| estimate.share(face) + WEIGHT_OF_AREA * area.share(face),
            may_be_silhouette: &|f, g| fronts.may_differ(f, g),
        };
        let mut collapser = Collapser::new(&mesh, &weights);
        collapser.run(&mut mesh, &mut paid);
        (deviation, shift) = (collapser.deviation(), paid.shift);
        account = paid.settle(&mesh);
        counts.deleted += delete(&mut mesh, &mut account, budget);
    }
    if options.flat {
        let before = mesh.n_left();
        merge(&mut mesh);
        counts.merged_away = before - mesh.n_left();
    }
    finish(scene, &mesh, counts, account.most(), [deviation, shift])
}

fn kept_faces<'a>(mesh: &'a Mesh, faces: &Faces) -> impl Iterator<Item = u32> + 'a {
    faces.ids().filter(|&f| mesh.face(f).state == State::Kept)
}

fn finish(scene: &Scene, mesh: &Mesh, mut counts: Counts, bound: f64, [deviation, shift]: [f64; 2]) -> Simplified {
    let (triangles, origin) = mesh.left(scene);
    let n = |state: State| mesh.faces().iter().filter(|f| f.state == state).count();
    (counts.new, counts.merged, counts.left) = (n(State::New), n(State::Merged), mesh.n_left());
    let gone = counts.before - counts.without_area - counts.hidden - counts.deleted - counts.merged_away;
    counts.collapsed = gone - counts.merged - n(State::Kept);
    Simplified { triangles, origin, bound, deviation, shift, counts }
}

/// Collapses what is paid for.
struct Paid<'a> {
    faces: &'a Faces,
    views: &'a Views,
    intercepts: &'a Intercepts,
    depth: u32,
    budget: f64,
    most_shift: f64,
    /// The largest shift so far.
    shift: f64,
    account: Account,
    /// Faces whose change is paid for.
    may_go: Vec<bool>,
    /// What new faces take up, part by part.
    charges: BTreeMap<u32, Vec<f64>>,
}

impl<'a> Paid<'a> {
    fn choose(
        faces: &'a Faces,
        views: &'a Views,
        intercepts: &'a Intercepts,
        mesh: &Mesh,
        options: &SimplifyOptions,
        mut account: Account,
    ) -> Self {
        let budget = options.budget;
        let mut may_go = vec![false; faces.len()];
        let limit = budget - budget * options.collapse / 2.0;
        least_visible(intercepts, kept_faces(mesh, faces), limit, &mut account, |face| may_go[face as usize] = true);
        let (depth, most_shift) = (options.depth, options.shift);
        Self {
            faces,
            views,
            intercepts,
            depth,
            budget,
            most_shift,
            shift: 0.0,
            account,
            may_go,
            charges: BTreeMap::new(),
        }
    }

    /// What a triangle takes up at most, in each part.
    fn shares(&self, corners: &[Point3; 3]) -> Vec<f64> {
        self.views.parts().iter().map(|v| bound::share(corners, v.volume.bounds(), self.depth)).collect()
    }

    /// At most the distance of any eye to the faces of a change, before and after.
    fn nearest(&self, mesh: &Mesh, change: &Change) -> f64 {
        let changed = change.lost.iter().chain(change.moved.iter().map(|(f, _)| f));
        let corners = changed.flat_map(|&f| mesh.corners(f)).chain([mesh.place(change.to)]);
        let around = Aabb::<3>::around(corners);
        let to = |view: &View| bound::distance(&around, view.volume.bounds());
        self.views.parts().iter().map(to).fold(f64::INFINITY, f64::min)
    }

    /// What was not changed after all need not be paid for.
    fn settle(mut self, mesh: &Mesh) -> Account {
        for face in self.faces.ids().filter(|&f| self.may_go[f as usize] && mesh.face(f).state == State::Kept) {
            self.account.refund(|part| self.intercepts.of(part, face));
        }
        self.account
    }
}

impl Policy for Paid<'_> {
    fn may_touch(&self, _: &Mesh, face: u32) -> bool {
        self.may_go[face as usize]
    }

    fn accepts(&mut self, mesh: &Mesh, change: &Change, moved: f64) -> bool {
        if change.lost.iter().chain(change.moved.iter().map(|(f, _)| f)).any(|&f| !self.may_go[f as usize]) {
            return false;
        }
        let shift = moved / self.nearest(mesh, change);
        // Also where the distance is 0.
        if shift.is_nan() || shift > self.most_shift {
            return false;
        }
        let new: Vec<(u32, Vec<f64>)> =
            change.moved.iter().map(|&(f, _)| (f, self.shares(&change.corners(mesh, f)))).collect();
        let mut account = self.account.clone();
        for face in change.lost.iter().chain(change.moved.iter().map(|(f, _)| f)) {
            if let Some(charge) = self.charges.get(face) {
                account.refund(|part| charge[part]);
            }
        }
        if !new.iter().all(|(_, charge)| account.spend(self.budget, |part| charge[part])) {
            return false;
        }
        self.account = account;
        self.shift = self.shift.max(shift.next_up());
        change.lost.iter().for_each(|face| drop(self.charges.remove(face)));
        self.charges.extend(new);
        true
    }

    fn is_done(&self, _: &Mesh) -> bool {
        false
    }
}

/// From which sides faces are seen.
struct Fronts(Vec<[bool; 2]>);

impl Fronts {
    fn new(faces: &Faces, views: &Views) -> Self {
        let corners: Vec<Point3> = views.parts().iter().flat_map(|v| v.volume.corners()).collect();
        let of = |face: u32| {
            let [a, b, c] = *faces.of(face);
            let mut sides = [false; 2];
            for &eye in &corners {
                let side = orient3d(a, b, c, eye);
                sides[0] |= side > 0.0;
                sides[1] |= side < 0.0;
            }
            sides
        };
        Self(faces.ids().map(of).collect())
    }

    /// Whether some eye may be on one side of one face and on the other side of the other.
    fn may_differ(&self, f: u32, g: u32) -> bool {
        let (f, g) = (self.0[f as usize], self.0[g as usize]);
        f != g || f == [true, true]
    }
}

/// Areas of faces as shares of all.
struct Areas {
    of: Vec<f64>,
    sum: f64,
}

impl Areas {
    fn new(faces: &Faces) -> Self {
        let area = |&[a, b, c]: &[Point3; 3]| {
            let (u, v) = ([0, 1, 2].map(|k| b[k] - a[k]), [0, 1, 2].map(|k| c[k] - a[k]));
            let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
            n.iter().map(|x| x * x).sum::<f64>().sqrt() / 2.0
        };
        let of: Vec<f64> = faces.corners().iter().map(area).collect();
        Self { sum: of.iter().sum(), of }
    }

    fn share(&self, face: u32) -> f64 {
        let share = self.of[face as usize] / self.sum;
        if share.is_finite() { share } else { 0.0 }
    }
}

/// Simplifies a scene by its shape alone, to at most `target` triangles as far as edges can be collapsed: the ordinary metric, which
/// knows no eyes, to compare with. Each object is a mesh of its own. Nothing is promised of what is seen.
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
    Ok(finish(scene, &mesh, counts, f64::INFINITY, [deviation, f64::INFINITY]))
}

#[cfg(test)]
mod tests;
