//! Scenes in space: glTF 2.0 (GLB or text with buffers) and OBJ.
//!
//! | | glTF | OBJ |
//! | --- | --- | --- |
//! | objects | one per node and primitive of the default scene, parents before children | one per `o`, or per `g` where there is no `o` |
//! | up, unit | Y, metres, as the format says | Y assumed, unknown |
//! | numbers | single precision or quantised, placed by transforms in double precision | double precision |
//! | seen, and hide nothing | materials with `alphaMode` `BLEND` or `MASK`, or with transmission, volume or an extension that is not known; what is not drawn at first | materials with `d`, `Tr`, `map_d`, or of which nothing is known |
//! | roles | `"extras": {"sightlines": {"role": …}}` of nodes, meshes and materials, see [`Role`]; endings of names | endings of names |
//! | mirrors | nodes, meshes and materials with that role, or nodes with a name that ends in `-mirror` | objects with such a name |
//! | left out | looks, animations, cameras | looks, normals, lines, curves |
//! | written again | with fewer triangles, and all else as it was ([`GltfSource::rewrite`]) | as OBJ or as GLB, without materials |
//!
//! Objects keep their order, which gives them their ids, even those that are only points or lines and have no
//! triangles. Corners that nothing uses are left out, and so are triangles without area. What moves or changes its shape
//! (animations, physics and other extensions, skins, morph targets) hides nothing. Instances (`EXT_mesh_gpu_instancing`) are objects each, with `[1]`,
//! `[2]` and so on behind the name. Unknown compressions are refused: a wall in the wrong place
//! would be a silent error.

mod accessor;
mod buffers;
mod build;
mod extras;
mod gltf;
mod json;
mod material;
mod motion;
mod movers;
mod mtl;
mod nodes;
mod obj;
mod pattern;
mod primitive;
mod rewrite;
mod role;
mod source;
mod surface;
mod transform;
mod write;
mod write_obj;

pub(crate) use gltf::MAGIC as GLB_MAGIC;
pub use gltf::{parse_glb, parse_gltf_with};
pub use obj::{parse_obj, parse_obj_with};
pub use pattern::{EmptyPattern, NamePattern};
pub use rewrite::{Removal, RemovedObjects, RewriteError};
pub use role::Role;
pub use source::{GltfSource, ObjectOrigin, parse_glb_with_source};
pub use surface::{BackFaces, Classified, ParseBackFacesError, SceneReadOptions};
pub use write::{Rounding, SceneWriteError, write_glb, write_rounded_glb, write_simplified_glb};
pub use write_obj::{write_obj, write_simplified_obj};

use crate::ReadError;
use crate::beside::Folder;
use crate::error::{Malformed, malformed};
use sightlines_cells::Scene;
use sightlines_geometry::Aabb;
pub use sightlines_pvs::Axis;
use std::fs;
use std::path::Path;

/// The most triangles, and the most corners, that a scene may have: they take up to 2.4 GB together.
pub const MAX_ELEMENTS: usize = 1 << 26;
/// The most objects that a scene of glTF may have.
pub const MAX_OBJECTS: usize = 1 << 22;

/// The suffix of the names of mirrors.
pub const MIRROR_SUFFIX: &str = "-mirror";

/// A scene, and what its file states about it.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneFile {
    /// The scene.
    pub scene: Scene,
    /// What its file states about it.
    pub info: SceneInfo,
}

/// What a file states about its scene.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneInfo {
    /// How it was written.
    pub format: SceneFormat,
    /// Which way is up.
    pub up: Axis,
    /// Whether `up` is only assumed, because the format does not say.
    pub up_is_assumed: bool,
    /// How long 1 is.
    pub unit: LengthUnit,
    /// Number of objects.
    pub n_objects: usize,
    /// Number of objects that have no triangles.
    pub n_objects_without_triangles: usize,
    /// Number of triangles of all objects.
    pub n_triangles: usize,
    /// Number of triangles that were left out because they have no area: their corners lie on a line, exactly.
    pub n_degenerate_triangles: usize,
    /// The triangles that were left out, for that reason or because corners are not there: the object of each, and its place among all triangles
    /// that the file has of that object; ascending. In an OBJ file, faces are counted as the triangles that they are cut into, and those that were left out are not.
    pub left_out_triangles: Vec<[u32; 2]>,
    /// Number of triangles that hide, of which engines draw the fronts only (glTF: materials that are not `doubleSided`).
    pub n_single_sided_triangles: usize,
    /// Those of them that hide from their front only, as they are not of a closed object.
    pub n_front_occluding_triangles: usize,
    /// Set if the file states that its scene was made from one with more triangles.
    pub simplified: Option<Simplification>,
    /// What it was read with.
    pub read_with: SceneReadOptions,
    /// For each object the largest magnitude of its coordinates as the file stores them, before nodes move them elsewhere, in scene units: what
    /// a format of single precision rounds. Empty if nothing moves them.
    pub stored_sizes: Vec<f64>,
    /// The objects that are not simply walls, ascending.
    pub surfaces: Vec<Classified>,
    /// The boxes around objects that show where viewers can be ([`Role::ViewVolume`]), in their order, in scene units.
    pub view_volumes: Vec<Aabb<3>>,
    /// Objects with that role that are ignored, ascending: those without a triangle that has an area, and all if the box around them is flat.
    pub ignored_view_volumes: Vec<u32>,
    /// What a user should hear of the file, a sentence each.
    pub warnings: Vec<String>,
}

impl SceneInfo {
    /// The box around all places where viewers can be, as the file states them; `None` if it states none, or if the box is flat
    /// ([`SceneInfo::ignored_view_volumes`]).
    pub fn view_region(&self) -> Option<Aabb<3>> {
        let corners = self.view_volumes.iter().flat_map(|volume| [volume.min, volume.max]);
        Some(Aabb::around(corners)).filter(|region| !build::is_flat(region))
    }
}

/// How a scene with fewer triangles is related to the one that it was made from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Simplification {
    /// Whether it lies inside the original, so that what it hides was hidden before: triangles were only taken
    /// away. A scene of which triangles were moved may hide what can be seen, and must not be used to hide.
    ///
    /// Files that state that they are simplified, but not how, are read as `false`.
    pub occluder: bool,
}

/// A format of scenes in space.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum SceneFormat {
    /// glTF 2.0, as GLB or as text.
    Gltf,
    /// Wavefront OBJ.
    Obj,
}

/// How long a scene unit is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum LengthUnit {
    /// One metre.
    Metre,
    /// Not stated.
    Unknown,
}

/// Reads the scene in the file at `path`: a GLB by its content, else by the name what is named `.obj`, `.glb`
/// or `.gltf`, else a glTF text by its content. Buffers of a glTF, and libraries of materials of an OBJ, are searched in the
/// file's folder.
///
/// # Errors
/// [`ReadError`] with the file's name and the place in it.
pub fn read_scene(path: impl AsRef<Path>) -> Result<SceneFile, ReadError> {
    read_scene_with(path, &SceneReadOptions::default())
}

/// As [`read_scene`], with options.
///
/// # Errors
/// As [`read_scene`].
pub fn read_scene_with(path: impl AsRef<Path>, options: &SceneReadOptions) -> Result<SceneFile, ReadError> {
    read(path.as_ref(), |bytes, format, folder| match format {
        SceneFormat::Gltf => parse_gltf_with(&bytes, Some(folder), options),
        SceneFormat::Obj => parse_obj_with(&bytes, Some(folder), options),
    })
}

/// As [`read_scene`], with the source that is needed to write the file again with fewer triangles; an OBJ has none.
///
/// # Errors
/// As [`read_scene`].
pub fn read_scene_with_source(path: impl AsRef<Path>) -> Result<(SceneFile, Option<GltfSource>), ReadError> {
    read_scene_with_source_and(path, &SceneReadOptions::default())
}

/// As [`read_scene_with_source`], with options.
///
/// # Errors
/// As [`read_scene`].
pub fn read_scene_with_source_and(
    path: impl AsRef<Path>,
    options: &SceneReadOptions,
) -> Result<(SceneFile, Option<GltfSource>), ReadError> {
    read(path.as_ref(), |bytes, format, folder| match format {
        SceneFormat::Gltf => {
            source::parse_with_source(bytes, Some(&folder.0), options).map(|(file, source)| (file, Some(source)))
        }
        SceneFormat::Obj => parse_obj_with(&bytes, Some(folder), options).map(|file| (file, None)),
    })
}

fn read<T>(
    path: &Path,
    parse: impl FnOnce(Vec<u8>, SceneFormat, &Folder) -> Result<T, Malformed>,
) -> Result<T, ReadError> {
    let bytes = fs::read(path).map_err(|error| ReadError::new(path, error))?;
    let named = |extension: &str| path.extension().is_some_and(|e| e.eq_ignore_ascii_case(extension));
    let format = if bytes.starts_with(gltf::MAGIC) {
        SceneFormat::Gltf
    } else if named("obj") {
        SceneFormat::Obj
    } else if named("glb") || named("gltf") || bytes.trim_ascii_start().starts_with(b"{") {
        SceneFormat::Gltf
    } else {
        return Err(ReadError::new(path, malformed!("neither GLB nor glTF nor OBJ")));
    };
    parse(bytes, format, &Folder::of(path)).map_err(|error| ReadError::new(path, error))
}
