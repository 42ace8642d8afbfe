//! glTF 2.0: from a document to objects in world coordinates.

use super::buffers::{Buffers, split_glb, upgrade};
use super::build::{Builder, SingleSides};
use super::extras::{Stated, StatedMoves, StatedRole};
use super::json::Document;
use super::material::{self, shows_fronts_only};
use super::motion::{Motions, Moved, Vertices};
use super::movers::{self, INSTANCING};
use super::nodes::{Nodes, Placed, place_nodes, scene_names, too_many};
use super::primitive::{LocalMesh, n_triangles_of};
use super::role::Role;
use super::surface::{Classification, Classifier, SceneReadOptions};
use super::{MAX_ELEMENTS, MAX_OBJECTS, SceneFile, SceneFormat};
use crate::beside::{Folder, Neighbours};
use crate::bytes::without_mark;
use crate::error::{Malformed, Within, counted, malformed};
use crate::point::check_point;
use sightlines_cells::Point3;
use sightlines_geometry::Aabb;
use sightlines_geometry::range::{Range, RangeBox, bounded, box_of, united};
use std::path::Path;

pub(crate) use super::buffers::MAGIC;

/// Extensions that do not change where a triangle is, and quantised meshes, which are understood.
#[rustfmt::skip]
const HARMLESS: [&str; 13] = [
    "EXT_lights_", "EXT_texture_", INSTANCING, "KHR_animation_pointer", "KHR_implicit_shapes", "KHR_lights_",
    "KHR_materials_", "KHR_mesh_quantization", "KHR_node_visibility", "KHR_physics_rigid_bodies", "KHR_texture_",
    "KHR_xmp", "MSFT_texture_",
];

/// Reads a GLB, or the text of a glTF if it does not begin like a GLB.
///
/// * `folder`: where buffers in files are searched; without it they are refused.
/// * returns the scene at rest: one object per node and primitive of the default scene (the first if none is
///   the default, all trees of nodes if there is no scene), parents before children, children in order, in
///   world coordinates. An object has the name of its node, else of the mesh, else `node N`; primitives
///   after the first add `#1`, `#2` and so on. Faces of mirrored nodes are turned round, as glTF has it.
///
/// Costs time and memory in proportion to the file and to what its instances make of it, which
/// [`MAX_ELEMENTS`] and [`MAX_OBJECTS`] bound.
///
/// # Errors
/// [`Malformed`] with node and primitive.
///
/// # Source
/// Khronos Group, glTF 2.0 Specification (ISO/IEC 12113:2022), and KHR_mesh_quantization.
/// Chosen here: extensions that code geometry in another way are refused. What hides and what is only seen: see [`Role`] and
/// [`Classified`](super::Classified). What is animated, physics, skins and morph targets hide nothing, and are seen in a box that they
/// never leave, or from everywhere if there is no telling.
pub fn parse_glb(bytes: &[u8], folder: Option<&Path>) -> Result<SceneFile, Malformed> {
    let folder = folder.map(|folder| Folder(folder.to_owned()));
    let beside = folder.as_ref().map(|folder| folder as &dyn Neighbours);
    parse_gltf_with(bytes, beside, &SceneReadOptions::default())
}

/// As [`parse_glb`], with options, and with buffers wherever `beside` has them; without it, those in files are refused.
///
/// # Errors
/// As [`parse_glb`].
pub fn parse_gltf_with(
    bytes: &[u8],
    beside: Option<&dyn Neighbours>,
    options: &SceneReadOptions,
) -> Result<SceneFile, Malformed> {
    parse(bytes, beside, options, |_| {}).map(|(file, _)| file)
}

/// A node with a mesh, as it is read: what an object comes from, one for each primitive of the mesh.
#[derive(Debug, Clone, Copy)]
pub(super) struct Origin<'a> {
    pub(super) node: usize,
    pub(super) mesh: usize,
    /// Whether triangles are turned round.
    pub(super) mirrors: bool,
    pub(super) locals: &'a [LocalMesh],
}

/// What was read of buffers outside a file, by buffer.
pub(super) type Loaded = Vec<Option<Vec<u8>>>;

/// Reads a scene, and calls `watch` for each node with a mesh, in the order of objects. Also returns the buffers that
/// were read from other files.
pub(super) fn parse(
    bytes: &[u8],
    beside: Option<&dyn Neighbours>,
    options: &SceneReadOptions,
    watch: impl FnMut(Origin<'_>),
) -> Result<(SceneFile, Loaded), Malformed> {
    let (text, binary) = split(bytes)?;
    let document: Document =
        serde_json::from_str(text).map_err(|error| match check_version(&stated_version(text)) {
            Ok(()) => malformed!("the glTF text cannot be read: {error}"),
            Err(other) => other,
        })?;
    check_understood(&document)?;
    let buffers = Buffers::new(&document.buffers, binary, beside);
    let Nodes { placed, above, n_coarser } = place_nodes(&document, &buffers, options.scene.as_deref())?;
    check_size(&document, &placed)?;
    let mut classifier = Classifier::new(options);
    let mut builder = Builder::saying(document.asset.simplified);
    let motions = Motions::new(&document, &buffers, &above);
    build(&mut builder, &document, &motions, &placed, &mut classifier, watch)?;
    let warnings = &mut builder.warnings;
    warnings.extend(unclear_extras(&document));
    if n_coarser > 0 {
        let nodes = counted(n_coarser, "node is a coarser level", "nodes are coarser levels");
        warnings.push(format!("{nodes} of others (MSFT_lod): left out, the finest stands for them"));
    }
    if options.scene.is_none() && document.scenes.len() > 1 {
        let read = scene_names(&document).swap_remove(document.scene.unwrap_or(0));
        let n = document.scenes.len();
        warnings.push(format!("the default scene, {read}, was read, one of {n} in the file"));
    }
    let of_nodes = document.nodes.iter().filter_map(|node| node.extensions.as_deref());
    warnings.extend(movers::warnings(document.moves_everything(), &document.extensions, of_nodes));
    warnings.extend(material::warnings(&document));
    warnings.extend(classifier.warnings());
    Ok((builder.finish(SceneFormat::Gltf, options)?, buffers.into_loaded()))
}

pub(super) fn split(bytes: &[u8]) -> Result<(&str, Option<&[u8]>), Malformed> {
    let (text, binary) = if bytes.starts_with(MAGIC) { split_glb(bytes)? } else { (bytes, None) };
    let text = std::str::from_utf8(without_mark(text));
    let text = text.map_err(|e| malformed!("byte {} of the glTF text is not UTF-8", e.valid_up_to()))?;
    Ok((text, binary))
}

/// The version that a text states which may be of another one; that which is read if there is no telling.
fn stated_version(text: &str) -> String {
    let whole: Option<serde_json::Value> = serde_json::from_str(text).ok();
    let version = whole.as_ref().and_then(|whole| whole.pointer("/asset/version"));
    version.map_or("2".to_owned(), |version| version.as_str().map_or_else(|| version.to_string(), str::to_owned))
}

fn check_version(version: &str) -> Result<(), Malformed> {
    let first = version.split('.').next();
    if first == Some("2") {
        Ok(())
    } else {
        Err(malformed!("glTF version {version:?} is not 2.x{}", upgrade(first == Some("1"))))
    }
}

fn check_understood(document: &Document) -> Result<(), Malformed> {
    check_version(&document.asset.version)?;
    let strange = |name: &&String| !HARMLESS.iter().any(|harmless| name.starts_with(harmless));
    match document.extensions_required.iter().find(strange) {
        Some(name) => Err(malformed!("extension {name} is not understood{}", remedy(name))),
        None => Ok(()),
    }
}

/// The command that writes a file without an extension, if there is a usual one.
fn remedy(extension: &str) -> &'static str {
    match extension {
        "KHR_draco_mesh_compression" | "EXT_meshopt_compression" => {
            "; `npx @gltf-transform/cli cp IN.glb OUT.glb` unpacks the file"
        }
        "KHR_meshopt_compression" => "; `gltfpack -i IN.glb -o OUT.glb -noq -kn -km` unpacks the file",
        _ => "",
    }
}

/// Refuses scenes that are too large before any object is made: a small file can describe a large scene.
fn check_size(document: &Document, placed: &[Placed<'_>]) -> Result<(), Malformed> {
    let count = |accessor: usize| document.accessors.get(accessor).map_or(0, |a| a.count);
    let mut sum = [("triangles", 0_usize, MAX_ELEMENTS), ("corners", 0, MAX_ELEMENTS), ("objects", 0, MAX_OBJECTS)];
    for at in placed {
        for (k, primitive) in at.mesh.primitives.iter().enumerate() {
            let n_positions = primitive.attributes.position.map_or(0, count);
            let n = primitive.indices.map_or(n_positions, count);
            // A long name weighs as much as several objects.
            let n_objects = 1 + at.given_name().map_or(0, str::len) / 128;
            for ((what, sum, max), more) in
                sum.iter_mut().zip([n_triangles_of(primitive.mode, n), n.min(n_positions), n_objects])
            {
                *sum = sum.saturating_add(more);
                if *sum > *max {
                    return Err(at.fail(k, too_many(what, *max)));
                }
            }
        }
    }
    Ok(())
}

fn build(
    builder: &mut Builder,
    document: &Document,
    motions: &Motions<'_, '_>,
    placed: &[Placed<'_>],
    classifier: &mut Classifier<'_>,
    mut watch: impl FnMut(Origin<'_>),
) -> Result<(), Malformed> {
    // Meshes by their index, read when the first node has them.
    let mut meshes: Vec<Option<Vec<LocalMesh>>> = Vec::new();
    meshes.resize_with(document.meshes.len(), || None);
    for at in placed {
        let mesh = match &mut meshes[at.mesh_idx] {
            Some(mesh) => mesh,
            unread => {
                let read = |(k, p)| LocalMesh::read(document, motions.buffers(), p).map_err(|what| at.fail(k, what));
                let mut locals = at.mesh.primitives.iter().enumerate().map(read).collect::<Result<Vec<_>, _>>()?;
                let left_out = locals.iter_mut().map(|local| local.left_out.take()).enumerate();
                left_out.for_each(|(k, some)| {
                    some.into_iter().for_each(|(n, what)| builder.leave_out(n, at.fail(k, what)))
                });
                unread.insert(locals)
            }
        };
        watch(Origin { node: at.index, mesh: at.mesh_idx, mirrors: at.world.mirrors(), locals: mesh });
        for (k, local) in mesh.iter().enumerate() {
            let (name, primitive) = (at.name(k), &at.mesh.primitives[k]);
            let materials = primitive.materials();
            let evidence = materials.iter().map(|&m| at.evidence(document, motions, primitive, m, &name));
            let mut class = classifier.classify(evidence);
            let moved = class.as_ref().filter(|class| class.moves).map(|_| {
                let vertices = Vertices { corners: &local.mesh.corners, positions: &local.positions };
                let moved = motions.moved(at.index, at.mesh, primitive, vertices);
                // Boxes are around the mesh of the node, not around its instances.
                if at.instance.is_some() { Moved::default() } else { moved }
            });
            let placed =
                |(vertex, p)| check_point(p).within(format_args!("position {vertex}")).map_err(|what| at.fail(k, what));
            let at_rest = moved.as_ref().and_then(|moved| moved.at_rest.as_ref());
            let world = (0..local.positions.len()).map(|k| match at_rest {
                Some(at_rest) => at_rest[k],
                None => at.world.apply(local.positions[k]),
            });
            let corners = local.mesh.corners.iter().copied();
            let vertices: Vec<Point3> = corners.zip(world).map(placed).collect::<Result<_, _>>()?;
            let largest = |p: Point3| p.iter().fold(0.0f64, |m, x| m.max(x.abs()));
            let stored_size = match at_rest {
                // Sums of stored corners, by weights.
                Some(_) => vertices.iter().map(|&p| largest(p)).fold(0.0, f64::max),
                None => local.positions.iter().map(|&p| largest(at.world.reach(p))).fold(0.0, f64::max),
            };
            let moved = match &class {
                Some(class) if class.opens => Some(Moved { at_rest: None, within: opened(&vertices) }),
                _ => moved,
            };
            let triangles = local.mesh.triangles.iter().copied();
            builder.add(name, vertices, (triangles, &local.places_left_out), at.world.mirrors(), moved.is_some());
            builder.note_source(at.index, k);
            builder.note_stored_size(stored_size);
            if at.is_mirror(document, primitive) {
                builder.mark_mirror();
            }
            let is_single_sided = materials.iter().any(|&m| is_single_sided(document, m));
            let sides = match is_single_sided && classifier.hides_from_fronts_only() {
                false => SingleSides::Hide,
                true if at.world.keeps_sides() => SingleSides::HideFromFronts,
                true if at.world.has_fronts() => SingleSides::HideIfClosed,
                true => SingleSides::Show,
            };
            if class.as_ref().is_some_and(|class| class.shuts) {
                builder.mark_door(sides);
            }
            let fronts_only = |&m: &Option<usize>| m.is_none_or(|m| shows_fronts_only(document, m));
            if !classifier.shows_both_sides() && at.world.keeps_sides() && materials.iter().all(fronts_only) {
                builder.mark_fronts_only();
            }
            if is_single_sided && class.as_ref().is_none_or(Classification::hides) {
                // Who says by name that something hides has the last word.
                let is_vouched_for = class.as_ref().is_some_and(|class| class.is_vouched_for);
                let sides = if is_vouched_for { SingleSides::Hide } else { sides };
                class = builder.count_single_sided(sides).or(class);
            }
            if let Some(class) = class {
                builder.classify(class, moved.and_then(|moved| moved.within));
            }
        }
    }
    Ok(())
}

/// A box that a door does not leave that stands shut with these corners: wherever it turns about a line through the box around them, or
/// slides by the diagonal of that box, each of its points stays within a diagonal of the box. `None` if there is no such box.
fn opened(corners: &[Point3]) -> Option<Aabb<3>> {
    let sides: RangeBox = corners.iter().copied().map(box_of).reduce(united)?;
    let [x, y, z] = sides.map(|side| Range::of(side.high).minus(Range::of(side.low)).square());
    let diagonal = x.plus(y).plus(z).high.sqrt().next_up();
    let off = Range { low: -diagonal, high: diagonal };
    bounded(sides.map(|side| side.plus(off)))
}

/// Whether engines draw only the fronts of what has a material.
fn is_single_sided(document: &Document, material: Option<usize>) -> bool {
    let material = material.and_then(|m| document.materials.get(m)?.as_ref());
    material.is_none_or(|material| !material.double_sided)
}

/// Warnings of extras that state a role that there is not, or that state motion as something that is neither true nor false.
fn unclear_extras(document: &Document) -> Vec<String> {
    let nodes = document.nodes.iter().map(|node| (node.stated, node.name.as_deref()));
    let meshes = document.meshes.iter().map(|mesh| (mesh.stated, mesh.name.as_deref()));
    let materials = document.materials.iter().flatten().map(|material| (material.stated, material.name.as_deref()));
    let all: [(&str, Vec<_>); 3] =
        [("nodes", nodes.collect()), ("meshes", meshes.collect()), ("materials", materials.collect())];
    let unknown = format!("a role that is none of {}", Role::ALL.map(Role::name).join(", "));
    let moves = "a \"moves\" that is neither true nor false, which counts as true";
    let mut warnings = Vec::new();
    for (what, said) in &all {
        for (state, is_of_role) in [(unknown.as_str(), true), (moves, false)] {
            let is_unclear = |stated: &Stated| match is_of_role {
                true => stated.role == StatedRole::Unknown,
                false => stated.moves == StatedMoves::Unclear,
            };
            let names = said.iter().filter(|(stated, _)| is_unclear(stated)).map(|(_, name)| name.unwrap_or_default());
            if let (Some(first), n) = (names.clone().next(), names.count()) {
                warnings.push(format!("extras of {what} state {state}: {n}, the first called {first:?}"));
            }
        }
    }
    warnings
}
