//! Scenes in space as OBJ.

use super::write::SceneWriteError;
use super::{MIRROR_SUFFIX, Simplification};
use sightlines_cells::{Scene, SceneObject};
use std::fmt::Write;

/// The keyword, in a comment, of what a reader of ours should know and the format cannot state.
pub(super) const STATEMENT: &str = "#sightlines";
/// What stands behind it in the first line of a scene with fewer triangles than another; a second word is [`OCCLUDER`] where it is one.
pub(super) const SIMPLIFIED: &str = "simplified";
pub(super) const OCCLUDER: &str = "occluder";
/// What stands behind it below the name of an object that hides nothing.
pub(super) const SEE_THROUGH: &str = "see-through";

/// Writes a scene as OBJ: an `o` per object, with coordinates as the shortest decimals that are read as the same doubles.
///
/// Reading it again gives the same objects in the same order with the same triangles; corners that no triangle uses and triangles without
/// area are gone then. What hides nothing is stated in a comment: other programs draw it as a wall.
///
/// # Errors
/// [`SceneWriteError::Obj`]: what cannot be read as it is in the scene is refused.
pub fn write_obj(scene: &Scene) -> Result<Vec<u8>, SceneWriteError> {
    write(scene, None)
}

/// As [`write_obj`], of a scene that has fewer triangles than the one that it was made from, and says so in a comment.
///
/// # Errors
/// As [`write_obj`].
pub fn write_simplified_obj(scene: &Scene, simplified: Simplification) -> Result<Vec<u8>, SceneWriteError> {
    write(scene, Some(simplified))
}

fn write(scene: &Scene, simplified: Option<Simplification>) -> Result<Vec<u8>, SceneWriteError> {
    let mut text = String::new();
    let mut line = |line: std::fmt::Arguments<'_>| writeln!(text, "{line}").expect("a string takes any text");
    if let Some(simplified) = simplified {
        let occluder = if simplified.occluder { format!(" {OCCLUDER}") } else { String::new() };
        line(format_args!("{STATEMENT} {SIMPLIFIED}{occluder}"));
    }
    // Corners count from 1.
    let mut first = 1u64;
    for (k, object) in (0u32..).zip(scene.objects()) {
        check(scene, k, object).map_or(Ok(()), |what| Err(SceneWriteError::Obj { object: k as usize, what }))?;
        line(format_args!("o {}", object.name));
        if !scene.is_opaque(k) {
            line(format_args!("{STATEMENT} {SEE_THROUGH}"));
        }
        // With an exponent where that is shorter, as it is read everywhere.
        object.vertices.iter().for_each(|[x, y, z]| line(format_args!("v {x:?} {y:?} {z:?}")));
        for t in &object.triangles {
            let [a, b, c] = t.map(|corner| first + u64::from(corner));
            line(format_args!("f {a} {b} {c}"));
        }
        first += object.vertices.len() as u64;
    }
    Ok(text.into_bytes())
}

/// What an OBJ cannot hold of an object.
fn check(scene: &Scene, k: u32, object: &SceneObject) -> Option<&'static str> {
    let name = &object.name;
    let is_trimmed = name.trim_ascii().len() == name.len();
    let is_mirror = scene.mirrors().binary_search(&k).is_ok();
    if name.is_empty() || !is_trimmed || name.contains('\n') || name.ends_with('\\') {
        // The line would end elsewhere.
        Some("its name")
    } else if is_mirror != name.ends_with(MIRROR_SUFFIX) {
        Some("a mirror whose name does not end in -mirror, nor such a name of anything else")
    } else if scene.moving().iter().any(|moving| moving.object == k) {
        Some("what moves")
    } else if scene.is_single_sided(k) || scene.hides_from_front(k) {
        Some("what has one side")
    } else if object.triangles.is_empty() {
        Some("what has no triangles")
    } else {
        None
    }
}
