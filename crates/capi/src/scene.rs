//! Scenes to make tables of: objects from arrays of corners and triangles.

use crate::border;
use crate::handle::{self, Handle, lock};
use crate::info::{SlBox, below};
use crate::status::{Failure, SL_ERROR_GEOMETRY, SlStatus, guard};
use sightlines_cells::{MovingObject, Scene, SceneObject};
use sightlines_geometry::{Aabb, check_coordinate};
use std::ffi::c_char;
use std::sync::{Mutex, MutexGuard};

/// A scene that is being put together. One call at a time.
pub struct SlScene {
    _opaque: [u8; 0],
}

impl Handle for SlScene {
    type State = Mutex<Parts>;
    const TAG: u64 = 0x51_6873_6365_6e65;
    const NAME: &'static str = "scene";
}

/// It is seen, and hides nothing: glass, leaves, fences.
pub const SL_OBJECT_SEE_THROUGH: u32 = 1;
/// A door that stands shut. Tables take it to be open, so it hides nothing; `sl_viewer_close_door` shuts it. Its leaf is seen where it stands;
/// `sl_scene_set_motion` says where else it gets to.
pub const SL_OBJECT_DOOR: u32 = 2;
/// Its faces are mirrors.
pub const SL_OBJECT_MIRROR: u32 = 4;
/// Engines draw the fronts of its triangles only, counter-clockwise: they are seen from there, and hide from there; those of closed objects hide
/// from both sides.
pub const SL_OBJECT_SINGLE_SIDED: u32 = 8;
/// It moves, and may be anywhere, unless `sl_scene_set_motion` says where it stays; it hides nothing.
pub const SL_OBJECT_MOVING: u32 = 16;

/// What is behind a scene's handle.
#[derive(Debug, Clone, Default)]
pub struct Parts {
    objects: Vec<SceneObject>,
    flags: Vec<u32>,
    within: Vec<Option<Aabb<3>>>,
    /// Whether an object has coordinates in double precision.
    has_doubles: bool,
}

impl Parts {
    /// Whether all coordinates are in single precision.
    pub(crate) fn is_single(&self) -> bool {
        !self.has_doubles
    }

    /// The objects with any of these flags.
    fn with(&self, flag: u32) -> Vec<u32> {
        (0u32..).zip(&self.flags).filter(|(_, flags)| **flags & flag != 0).map(|(object, _)| object).collect()
    }

    /// The checked scene.
    pub(crate) fn scene(&self) -> Result<Scene, Failure> {
        let moving = self.with(SL_OBJECT_MOVING).into_iter();
        let moving = moving.map(|object| MovingObject { object, within: self.within[object as usize] }).collect();
        Scene::new(self.objects.clone())
            .and_then(|scene| scene.with_see_through(self.with(SL_OBJECT_SEE_THROUGH | SL_OBJECT_DOOR)))
            .and_then(|scene| scene.with_doors(self.with(SL_OBJECT_DOOR)))
            .and_then(|scene| scene.with_mirrors(self.with(SL_OBJECT_MIRROR)))
            .and_then(|scene| scene.with_moving(moving))
            .and_then(|scene| scene.with_backs_culled(self.with(SL_OBJECT_SINGLE_SIDED)))
            .map_err(|error| Failure::new(SL_ERROR_GEOMETRY, error.to_string()))
    }

    fn add(&mut self, name: &str, vertices: Vec<[f64; 3]>, indices: &[u32], flags: u32) -> Result<u32, Failure> {
        let object = u32::try_from(self.objects.len()).ok().filter(|&object| object != u32::MAX);
        let object = object.ok_or_else(|| Failure::argument("the scene has as many objects as it can have"))?;
        let (triangles, rest) = indices.as_chunks::<3>();
        if !rest.is_empty() {
            let message = format!("object {object}: {} indices are no triangles: not a multiple of 3", indices.len());
            return Err(Failure::new(SL_ERROR_GEOMETRY, message));
        }
        if flags >= 2 * SL_OBJECT_MOVING {
            return Err(Failure::argument(format!("object {object}: {flags:#x} has a bit that is no flag")));
        }
        // Checked now, where the caller still has what is wrong at hand; with the number that the object would have.
        let added = SceneObject { name: name.to_owned(), vertices, triangles: triangles.to_vec() };
        let checked = Scene::new(vec![added]).map_err(|error| {
            let message = error.to_string();
            let message = message.strip_prefix("object 0").unwrap_or(&message).to_owned();
            Failure::new(SL_ERROR_GEOMETRY, format!("object {object}{message}"))
        })?;
        self.objects.extend(checked.objects().iter().cloned());
        self.flags.push(flags);
        self.within.push(None);
        Ok(object)
    }
}

/// The scene behind a handle, for one call.
///
/// # Safety
/// As for [`handle::behind`].
pub(crate) unsafe fn scene<'a>(handle: *const SlScene) -> Result<MutexGuard<'a, Parts>, Failure> {
    // SAFETY: as for this function.
    lock(unsafe { handle::behind(handle)? }, SlScene::NAME)
}

/// Makes an empty scene.
///
/// @param scene  Where the handle goes; free it with `sl_scene_free`.
/// @return `SL_OK`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_scene_new(scene: *mut *mut SlScene) -> SlStatus {
    guard(|| {
        border::place(scene, "the place of the scene")?;
        // SAFETY: pointers are as the header demands.
        unsafe { border::put(scene, handle::give::<SlScene>(Mutex::default()), "the place of the scene") }
    })
}

/// Frees a scene. Tables made of it stay.
///
/// @param scene  A scene that no other thread is using, or null, for which nothing is done.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_scene_free(scene: *mut SlScene) {
    // SAFETY: pointers are as the header demands.
    guard(|| unsafe { handle::free(scene) });
}

/// Adds an object: what is seen or not as a whole. Everything is copied.
///
/// @param name          UTF-8, with a zero byte at its end; null for no name.
/// @param vertices      x, y and z of one corner after the other, in scene units.
/// @param vertex_count  Number of corners.
/// @param indices       Three corners for each triangle, counter-clockwise as seen from the front.
/// @param index_count   Number of indices: three times the number of triangles.
/// @param flags         `SL_OBJECT_…`, joined by `|`; 0 for a wall, or anything else that hides.
/// @param object        Where its number goes, from 0 in the order of calls; the tables have the same. May be null.
/// @return `SL_OK`; `SL_ERROR_GEOMETRY` for a coordinate that is no finite number or too large, an index without a corner, or indices that
///         are no triangles; `SL_ERROR_ARGUMENT` for unknown flags. After a failure the scene is as before.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_scene_add_object(
    scene: *mut SlScene,
    name: *const c_char,
    vertices: *const f64,
    vertex_count: usize,
    indices: *const u32,
    index_count: usize,
    flags: u32,
    object: *mut u32,
) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands; an array has the alignment of what is in it.
        unsafe {
            let vertices = border::slice(vertices.cast::<[f64; 3]>(), vertex_count, "the place of the vertices")?;
            add(scene, name, (vertices.to_vec(), false), (indices, index_count), flags, object)
        }
    })
}

/// Adds an object with corners in single precision: as `sl_scene_add_object`.
///
/// @param name          UTF-8, with a zero byte at its end; null for no name.
/// @param vertices      x, y and z of one corner after the other, in scene units.
/// @param vertex_count  Number of corners.
/// @param indices       Three corners for each triangle, counter-clockwise as seen from the front.
/// @param index_count   Number of indices: three times the number of triangles.
/// @param flags         `SL_OBJECT_…`, joined by `|`; 0 for a wall, or anything else that hides.
/// @param object        Where its number goes; may be null.
/// @return As `sl_scene_add_object`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_scene_add_object_f32(
    scene: *mut SlScene,
    name: *const c_char,
    vertices: *const f32,
    vertex_count: usize,
    indices: *const u32,
    index_count: usize,
    flags: u32,
    object: *mut u32,
) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands; an array has the alignment of what is in it.
        unsafe {
            let vertices = border::slice(vertices.cast::<[f32; 3]>(), vertex_count, "the place of the vertices")?;
            let vertices = vertices.iter().map(|p| p.map(f64::from)).collect();
            add(scene, name, (vertices, true), (indices, index_count), flags, object)
        }
    })
}

/// Adds an object; the flag beside the corners says whether they are in single precision.
///
/// # Safety
/// As for the module `border`.
unsafe fn add(
    scene: *mut SlScene,
    name: *const c_char,
    (vertices, is_single): (Vec<[f64; 3]>, bool),
    (indices, n): (*const u32, usize),
    flags: u32,
    object: *mut u32,
) -> Result<(), Failure> {
    // SAFETY: as for this function.
    unsafe {
        let mut scene = self::scene(scene)?;
        let name = if name.is_null() { "" } else { border::text(name, "the name")? };
        let indices = border::slice(indices, n, "the place of the indices")?;
        if !object.is_null() {
            border::place(object, "the place of the object")?;
        }
        let added = scene.add(name, vertices, indices, flags)?;
        scene.has_doubles |= !is_single;
        if object.is_null() { Ok(()) } else { border::put(object, added, "the place of the object") }
    }
}

/// States a box that an object never leaves, wherever it moves; it moves from then on, and hides nothing.
///
/// @param object  Its number.
/// @param within  The box, in scene units; it is widened to where the object is at rest. Null: it may be anywhere.
/// @return `SL_OK`; `SL_ERROR_ARGUMENT` if there is no such object; `SL_ERROR_GEOMETRY` for a coordinate that cannot be used.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_scene_set_motion(scene: *mut SlScene, object: u32, within: *const SlBox) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let mut scene = unsafe { self::scene(scene)? };
        let object = below(object, scene.objects.len(), "object")?;
        // SAFETY: pointers are as the header demands.
        let within = if within.is_null() { None } else { Some(*unsafe { border::read(within, "the box")? }) };
        for x in within.iter().flat_map(|b| b.min.iter().chain(&b.max)) {
            let failed =
                |error| Failure::new(SL_ERROR_GEOMETRY, format!("object {object}, the box of its motion: {error}"));
            check_coordinate(*x).map_err(failed)?;
        }
        scene.flags[object] |= SL_OBJECT_MOVING;
        scene.within[object] = within.map(|SlBox { min, max }| Aabb { min, max });
        Ok(())
    })
}
