//! Takes out of a camera's lists what cannot be seen from where it is.

use crate::asset::PvsTable;
use crate::camera::{PvsCamera, PvsChanged, PvsLock, PvsProblem, PvsProblemKind, PvsState, PvsView, Walk, Walker};
use crate::diagnostics::Counts;
use crate::doors::Doorways;
use crate::gltf::{PvsScene, corners_of};
use crate::level::{Judged, Slots};
use crate::parts::PvsParts;
use crate::space::Affine;
use crate::tie::Tie;
use bevy::asset::LoadState;
use bevy::camera::CameraProjection;
use bevy::camera::primitives::Aabb;
use bevy::camera::visibility::{NoFrustumCulling, VisibleEntities};
use bevy::platform::collections::HashMap;
use bevy::platform::time::Instant;
use bevy::prelude::*;
use sightlines_eye_to_cell::{StepBudget, View};
use sightlines_pvs::CellId;
use sightlines_walkthrough::{AnswerKind, DrawList, WalkOptions};

/// Frames in which scenes are there and none fits, before that is worth a warning: others may still be on their way.
const PATIENCE: u32 = 60;

/// The versions of tables: how often each was loaded.
#[derive(Resource, Debug, Default)]
pub(crate) struct Versions(HashMap<AssetId<PvsTable>, u64>);

/// Counts the loads of tables, so that cameras notice when one is loaded again.
pub(crate) fn note_tables(mut events: MessageReader<AssetEvent<PvsTable>>, mut versions: ResMut<Versions>) {
    for event in events.read() {
        match event {
            AssetEvent::Added { id } | AssetEvent::Modified { id } | AssetEvent::Removed { id } => {
                *versions.0.entry(*id).or_default() += 1;
            }
            _ => {}
        }
    }
}

/// The cameras, with all that culling them needs.
type Cameras<'w, 's> = Query<
    'w,
    's,
    (
        Entity,
        &'static Camera,
        &'static PvsCamera,
        &'static mut PvsView,
        &'static mut Walker,
        &'static GlobalTransform,
        &'static Projection,
        &'static mut VisibleEntities,
        Has<PvsLock>,
    ),
>;

/// The scenes, and what is above them.
type Scenes<'w, 's> = Query<'w, 's, (Entity, &'static PvsScene, &'static GlobalTransform)>;

/// Everything of a mesh that is judged by its box.
type Boxes<'w, 's> = Query<'w, 's, (&'static Aabb, &'static GlobalTransform, Has<NoFrustumCulling>)>;

/// Culls every camera that has a [`PvsCamera`].
pub(crate) fn cull(
    mut cameras: Cameras<'_, '_>,
    (scenes, parents): (Scenes<'_, '_>, Query<'_, '_, &ChildOf>),
    (boxes, parts, slots): (Boxes<'_, '_>, Query<'_, '_, &PvsParts>, Res<'_, Slots>),
    (tables, server, versions): (Res<'_, Assets<PvsTable>>, Option<Res<'_, AssetServer>>, Res<'_, Versions>),
    doorways: Doorways<'_, '_>,
    (mut problems, mut changes): (MessageWriter<'_, PvsProblem>, MessageWriter<'_, PvsChanged>),
    mut counts: ResMut<'_, Counts>,
) {
    *counts = Counts::default();
    for (camera, state, pvs, mut view, mut walker, place, projection, mut visible, is_locked) in &mut cameras {
        // Bevy leaves the lists of such cameras as they were.
        if !state.is_active {
            continue;
        }
        let begin = Instant::now();
        let walk = match walker.0.get_mut() {
            Ok(walk) => walk,
            Err(poisoned) => poisoned.into_inner(),
        };
        let id = pvs.table.id();
        let mut warn = |walk: &mut Walk, what: PvsProblemKind| {
            // That of backs is found once, and takes no other's place.
            let is_first = what == PvsProblemKind::BacksDrawn || !std::mem::replace(&mut walk.has_warned, true);
            if is_first {
                let path = server.as_ref().and_then(|server| server.get_path(id));
                let path = path.map_or_else(|| id.to_string(), |path| path.to_string());
                tracing::warn!("{path}: {what}");
                problems.write(PvsProblem { camera, table: id, what });
            }
        };
        view.start();
        let of = (id, versions.0.get(&id).copied().unwrap_or_default());
        if walk.of != Some(of) {
            // The same table again may be warned of once more.
            *walk = Walk { of: Some(of), ..Walk::default() };
        }
        let Some(table) = tables.get(id) else {
            let is_lost = server.as_ref().is_some_and(|s| matches!(s.get_load_state(id), Some(LoadState::Failed(_))));
            view.state = if is_lost { PvsState::NoTable } else { PvsState::Loading };
            if is_lost {
                warn(walk, PvsProblemKind::NotLoaded);
            }
            view.leave_all(&visible, &mut counts);
            continue;
        };
        find_level(walk, table, pvs, &scenes, &parents);
        let found = walk.tie.as_ref().and_then(|(scene, _)| scenes.get(*scene).ok());
        let Some((scene, level, scene_place)) = found else {
            view.state = PvsState::NoLevel;
            let largest = walk.misfits.values().max_by_key(|(n, _)| *n);
            if let (true, Some((_, misfit))) = (walk.frames_without > PATIENCE, largest) {
                let misfit = misfit.clone();
                warn(walk, PvsProblemKind::NoLevel(misfit));
            }
            view.leave_all(&visible, &mut counts);
            continue;
        };
        view.level = Some(scene);
        if !std::mem::replace(&mut walk.has_compared_backs, true)
            && table.takes_backs_to_be_drawn()
            && level.sources.iter().any(|mesh| mesh.is_single_sided)
        {
            warn(walk, PvsProblemKind::BacksDrawn);
        }
        let eye =
            if is_locked && walk.view.is_some() { walk.view.clone() } else { eye(place, projection, scene_place) };
        let (Some(eye), Some(to_scene)) = (eye, Affine::of(scene_place.affine()).inverse()) else {
            view.state = PvsState::NoEye;
            warn(walk, PvsProblemKind::NoPerspective);
            view.leave_all(&visible, &mut counts);
            continue;
        };
        start(walk, table, pvs);
        let Some(mut follower) = walk.follower.take() else { continue };
        if walk.doors != Some(doorways.version()) {
            walk.doors = Some(doorways.version());
            follower.close(&doorways.closed(table));
        }
        let tie = walk.tie.as_ref().map(|(_, tie)| tie);
        let asked = Instant::now();
        follower.look(&eye, pvs.method.into(), &mut |frame, sees_box| {
            view.query = asked.elapsed();
            view.state = match frame.answer {
                AnswerKind::Outside => PvsState::Outside,
                AnswerKind::Late => PvsState::Late,
                AnswerKind::Full => PvsState::Inside,
            };
            view.fell_back = frame.method < pvs.method.into();
            view.at.extend_from_slice(frame.at);
            if frame.answer == AnswerKind::Outside || !pvs.culls {
                return;
            }
            view.cells.extend_from_slice(frame.seen.cells());
            let mut culled = 0;
            let mut keep = |entity: &Entity| {
                let is_kept = match slots.judge(*entity) {
                    Judged::Free => true,
                    Judged::Table { scene: of, source } => {
                        of != scene || tie.and_then(|tie| tie.object(source)).is_none_or(|o| frame.seen.has_object(o))
                    }
                    Judged::Parts { scene: of } => {
                        of != scene
                            || tie.zip(parts.get(*entity).ok()).is_none_or(|(tie, parts)| sees_part(tie, parts, frame))
                    }
                    Judged::Box { scene: Some(of) } if of != scene => true,
                    Judged::Box { .. } => boxes.get(*entity).map_or(true, |(bounds, at, is_exempt)| {
                        let (min, max) = corners_of(bounds);
                        let (min, max) = to_scene.after(&Affine::of(at.affine())).box_around(min, max);
                        is_exempt || sees_box(min, max)
                    }),
                };
                culled += u32::from(!is_kept);
                is_kept
            };
            for list in visible.entities.values_mut() {
                list.retain(&mut keep);
            }
            view.culled = culled;
        });
        if let Some(error) = follower.take_error() {
            warn(walk, PvsProblemKind::Read(error));
        }
        walk.follower = Some(follower);
        walk.view = Some(eye);
        if let Some(change) = changed(walk, table, &view, camera) {
            changes.write(change);
        }
        view.leave_all(&visible, &mut counts);
        view.all = begin.elapsed();
        counts.query += view.query;
    }
}

impl PvsView {
    /// Nothing is known of this frame yet.
    fn start(&mut self) {
        let (mut at, mut cells) = (std::mem::take(&mut self.at), std::mem::take(&mut self.cells));
        at.clear();
        cells.clear();
        *self = Self { at, cells, ..Self::default() };
    }

    /// Counts what is left.
    fn leave_all(&mut self, visible: &VisibleEntities, counts: &mut Counts) {
        self.drawn = visible.entities.values().map(|list| list.len() as u32).sum();
        counts.n_cameras += 1;
        counts.drawn += self.drawn;
        counts.culled += self.culled;
    }
}

/// Whether one of the sources of a mesh is seen, or nothing is known of one.
fn sees_part(tie: &Tie, parts: &PvsParts, frame: &DrawList<'_>) -> bool {
    let sees = |&source: &u32| tie.object(source).is_none_or(|object| frame.seen.has_object(object));
    parts.sources.is_empty() || parts.sources.iter().any(sees)
}

/// Ties the table to the scene that it was made of, unless it is tied to one that is still there.
fn find_level(walk: &mut Walk, table: &PvsTable, pvs: &PvsCamera, scenes: &Scenes<'_, '_>, parents: &Query<&ChildOf>) {
    let is_meant = |scene: Entity| {
        pvs.level.is_none_or(|level| level == scene || parents.iter_ancestors(scene).any(|above| above == level))
    };
    if walk.tie.as_ref().is_some_and(|(scene, _)| scenes.contains(*scene) && is_meant(*scene)) {
        return;
    }
    walk.tie = None;
    walk.view = None;
    walk.misfits.retain(|scene, _| scenes.contains(*scene) && is_meant(*scene));
    let mut meant: Vec<Entity> = scenes.iter().map(|(scene, ..)| scene).filter(|scene| is_meant(*scene)).collect();
    meant.sort_unstable();
    for entity in meant {
        if walk.misfits.contains_key(&entity) {
            continue;
        }
        let Ok((_, scene, _)) = scenes.get(entity) else { continue };
        match Tie::new(table, scene) {
            Ok(tie) => {
                tracing::debug!("{} of {} objects tied", tie.n_tied(), table.n_objects());
                walk.tie = Some((entity, tie));
                walk.frames_without = 0;
                walk.doors = None;
                return;
            }
            Err(misfit) => {
                walk.misfits.insert(entity, (scene.sources.len(), misfit));
            }
        }
    }
    walk.frames_without += u32::from(!walk.misfits.is_empty());
}

/// The eye and the view of a camera, in the coordinates of a scene; `None` without a perspective, and in a scene without a volume.
///
/// In double precision from what Bevy has in single precision: the camera's place and turn, its projection and the place of the scene are
/// exactly those that Bevy draws with.
fn eye(camera: &GlobalTransform, projection: &Projection, scene: &GlobalTransform) -> Option<View> {
    let (camera, scene) = (Affine::of(camera.affine()), Affine::of(scene.affine()));
    let eye = scene.inverse()?.point(camera.origin());
    let view_from_scene = camera.inverse()?.after(&scene);
    let clip_from_view = match projection {
        Projection::Perspective(perspective) => perspective.get_clip_from_view(),
        Projection::Orthographic(_) => return None,
        Projection::Custom(custom) => custom.get_clip_from_view(),
    };
    View::from_view_projection(eye, view_from_scene.projected(&clip_from_view)).ok()
}

/// Begins to follow the camera, if that has not begun with these options.
fn start(walk: &mut Walk, table: &PvsTable, pvs: &PvsCamera) {
    let options = (pvs.steps, pvs.prepares_ahead, pvs.prepared_bytes);
    if walk.follower.is_some() && walk.made_with == Some(options) {
        return;
    }
    walk.made_with = Some(options);
    walk.doors = None;
    walk.follower = Some(table.follow(WalkOptions {
        budget: pvs.prepared_bytes,
        steps: pvs.steps.map_or(StepBudget::UNLIMITED, StepBudget::steps),
        has_thread: pvs.prepares_ahead && !cfg!(target_family = "wasm"),
        ..WalkOptions::default()
    }));
}

/// What may be seen from where the camera is that could not before, and the other way round; `None` if it is in the same cells.
fn changed(walk: &mut Walk, table: &PvsTable, view: &PvsView, camera: Entity) -> Option<PvsChanged> {
    if walk.at == view.at {
        return None;
    }
    let mut now: Vec<CellId> = Vec::new();
    let mut row = Vec::new();
    for &cell in &view.at {
        table.visible(cell, &mut row);
        now.append(&mut row);
    }
    now.sort_unstable();
    now.dedup();
    let without = |a: &[CellId], b: &[CellId]| a.iter().copied().filter(|c| b.binary_search(c).is_err()).collect();
    let change = PvsChanged {
        camera,
        at: view.at.clone(),
        entered: without(&now, &walk.may_see),
        left: without(&walk.may_see, &now),
    };
    walk.at.clone_from(&view.at);
    walk.may_see = now;
    Some(change)
}
