//! glTF 2.0: from a document to objects in world coordinates.

use super::accessor::Elements;
use super::buffers::{Buffers, split_glb};
use super::build::{Builder, Compact};
use super::error::{AccessorErrorKind, AccessorRole, NodeErrorKind, NodeId, PrimitiveErrorKind, SceneReadError};
use super::instances::transforms;
use super::json::{Document, Mesh, Node, Primitive, SceneRoots, TRIANGLES};
use super::material::{self, see_through, shows_fronts_only};
use super::motion::{Motions, Moved, Vertices};
use super::movers::{self, INSTANCING};
use super::role::{Role, StatedRole, role_of_name};
use super::surface::{Classification, Classifier, Evidence, SceneReadOptions};
use super::transform::Transform;
use super::{MAX_ELEMENTS, MAX_OBJECTS, SceneFile, SceneFormat};
use crate::beside::{Folder, Neighbours};
use crate::point::check_point;
use std::path::Path;

pub(crate) use super::buffers::MAGIC;

/// Modes from here on make triangles; those before are points and lines.
pub(super) const FIRST_OF_TRIANGLES: u32 = TRIANGLES;
const TRIANGLE_STRIP: u32 = 5;
const TRIANGLE_FAN: u32 = 6;

/// Extensions that do not change where a triangle is, and quantised meshes, which are understood.
const HARMLESS: [&str; 13] = [
    "EXT_lights_",
    "EXT_texture_",
    INSTANCING,
    "KHR_animation_pointer",
    "KHR_implicit_shapes",
    "KHR_lights_",
    "KHR_materials_",
    "KHR_mesh_quantization",
    "KHR_node_visibility",
    "KHR_physics_rigid_bodies",
    "KHR_texture_",
    "KHR_xmp",
    "MSFT_texture_",
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
/// [`SceneReadError`] with node and primitive.
///
/// # Source
/// Khronos Group, glTF 2.0 Specification (ISO/IEC 12113:2022), and KHR_mesh_quantization.
/// Chosen here: extensions that code geometry in another way are refused. What hides and what is only seen: see [`Role`] and
/// [`Classified`](super::Classified). What is animated, physics, skins and morph targets hide nothing, and are seen in a box that they
/// never leave, or from everywhere if there is no telling.
pub fn parse_glb(bytes: &[u8], folder: Option<&Path>) -> Result<SceneFile, SceneReadError> {
    let folder = folder.map(|folder| Folder(folder.to_owned()));
    parse_gltf(bytes, folder.as_ref().map(|folder| folder as &dyn Neighbours))
}

/// As [`parse_glb`], with buffers wherever `beside` has them; without it, those in files are refused.
///
/// # Errors
/// As [`parse_glb`].
pub fn parse_gltf(bytes: &[u8], beside: Option<&dyn Neighbours>) -> Result<SceneFile, SceneReadError> {
    parse_gltf_with(bytes, beside, &SceneReadOptions::default())
}

/// As [`parse_gltf`], with options.
///
/// # Errors
/// As [`parse_glb`].
pub fn parse_gltf_with(
    bytes: &[u8],
    beside: Option<&dyn Neighbours>,
    options: &SceneReadOptions,
) -> Result<SceneFile, SceneReadError> {
    parse(bytes, beside, options, |_| {}).map(|(file, _)| file)
}

/// A node with a mesh, as it is read: what an object comes from, one for each primitive of the mesh.
#[derive(Debug, Clone, Copy)]
pub(super) struct Origin<'a> {
    pub(super) node: usize,
    pub(super) mesh: usize,
    /// Whether triangles are turned round.
    pub(super) mirrors: bool,
    /// The mesh's primitives.
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
) -> Result<(SceneFile, Loaded), SceneReadError> {
    let (text, binary) = split(bytes)?;
    let document: Document = serde_json::from_str(text).map_err(|source| SceneReadError::Json { source })?;
    check_understood(&document)?;
    let buffers = Buffers::new(&document.buffers, binary, beside);
    let Nodes { placed, above } = place_nodes(&document, &buffers, options.scene.as_deref())?;
    check_size(&document, &placed)?;
    let mut classifier = Classifier::new(options);
    let mut builder = build(&document, &Motions::new(&document, &buffers, &above), &placed, &mut classifier, watch)?;
    builder.warnings.extend(unknown_roles(&document));
    if options.scene.is_none() && document.scenes.len() > 1 {
        let read = scene_names(&document).swap_remove(document.scene.unwrap_or(0));
        let n = document.scenes.len();
        builder.warnings.push(format!("the default scene, {read}, was read, one of {n} in the file"));
    }
    let of_nodes = document.nodes.iter().filter_map(|node| node.extensions.as_deref());
    builder.warnings.extend(movers::warnings(document.moves_everything(), &document.extensions, of_nodes));
    builder.warnings.extend(material::warnings(&document));
    builder.warnings.extend(classifier.warnings());
    let file = builder.finish(SceneFormat::Gltf, options)?;
    Ok((file, buffers.into_loaded()))
}

/// The text of a GLB or a glTF, and the binary chunk.
pub(super) fn split(bytes: &[u8]) -> Result<(&str, Option<&[u8]>), SceneReadError> {
    let (text, binary) = if bytes.starts_with(MAGIC) { split_glb(bytes)? } else { (bytes, None) };
    // Some editors begin a text with a byte order mark.
    let text = text.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(text);
    let text = std::str::from_utf8(text).map_err(|e| SceneReadError::Utf8 { offset: e.valid_up_to() })?;
    Ok((text, binary))
}

fn check_understood(document: &Document) -> Result<(), SceneReadError> {
    let version = &document.asset.version;
    if version != "2" && !version.starts_with("2.") {
        return Err(SceneReadError::Version { found: version.clone() });
    }
    let strange = |name: &&String| !HARMLESS.iter().any(|harmless| name.starts_with(harmless));
    match document.extensions_required.iter().find(strange) {
        Some(name) => Err(SceneReadError::Extension { name: name.clone() }),
        None => Ok(()),
    }
}

/// A node that has a mesh, and where it is in the world.
#[derive(Debug)]
struct Placed<'a> {
    index: usize,
    node: &'a Node,
    mesh_idx: usize,
    mesh: &'a Mesh,
    world: Transform,
    inherited: Inherited,
    /// Which of its instances it is, if it has some.
    instance: Option<usize>,
}

/// What a node has of those above it, and its children of it.
#[derive(Debug, Clone, Copy, Default)]
struct Inherited {
    /// The role of the nearest node that has one, and the ending of the name that states it, if its extras do not.
    role: Option<(Role, Option<&'static str>)>,
    /// Whether one of them is not drawn at first.
    is_invisible: bool,
}

impl Inherited {
    /// What `node` has, below what has `self`.
    fn by(self, node: &Node) -> Self {
        let of_name = node.name.as_deref().and_then(role_of_name).map(|(role, ending)| (role, Some(ending)));
        let own = node.stated.role.role().map(|role| (role, None)).filter(|own| own.0 != Role::Mirror);
        let own = own.or(of_name.filter(|own| own.0 != Role::Mirror));
        Self { role: own.or(self.role), is_invisible: self.is_invisible || node.is_invisible() }
    }

    /// What of it holds for the children: that a name promises more hiding is said of one node.
    fn for_children(self) -> Self {
        Self { role: self.role.filter(|role| !matches!(role, (Role::Occluder, Some(_)))), ..self }
    }
}

impl<'a> Placed<'a> {
    fn id(&self) -> NodeId {
        id_of(self.index, self.node)
    }

    fn given_name(&self) -> Option<&'a str> {
        self.node.name.as_deref().or(self.mesh.name.as_deref())
    }

    fn name(&self, primitive: usize) -> String {
        let name = self.given_name().map_or_else(|| format!("node {}", self.index), str::to_owned);
        let name = self.instance.map_or(name.clone(), |instance| format!("{name}[{}]", instance + 1));
        if primitive == 0 { name } else { format!("{name}#{primitive}") }
    }

    /// Whether extras of the node, the mesh or the material, or the name of the node, state that a primitive is a mirror.
    fn is_mirror(&self, document: &Document, primitive: &Primitive) -> bool {
        let by_name = self.node.name.as_deref().and_then(role_of_name).map(|(role, _)| role);
        let material = primitive.material.and_then(|m| document.materials.get(m)?.as_ref());
        let stated =
            [self.node.stated.role.role(), self.mesh.role.role(), material.and_then(|m| m.role.role()), by_name];
        stated.contains(&Some(Role::Mirror))
    }

    /// What is known of one of its objects if it has a material. `name` is that of the object. Of several roles the one that is
    /// stated of the least counts: of the material, the mesh, the node, or the nearest node above it that has one.
    fn evidence<'e>(
        &'e self,
        document: &'e Document,
        motions: &Motions<'_, '_>,
        primitive: &Primitive,
        material: Option<usize>,
        name: &'e str,
    ) -> Evidence<'e> {
        let see_through = material.and_then(|m| see_through(document, m));
        let material = material.and_then(|m| document.materials.get(m)?.as_ref());
        let names = [Some(name), self.node.name.as_deref(), self.mesh.name.as_deref()];
        let names = names.into_iter().chain([material.and_then(|m| m.name.as_deref())]).flatten().collect();
        let own = [material.and_then(|m| m.role.role()), self.mesh.role.role()].into_iter().flatten();
        let mut own = own.filter(|role| *role != Role::Mirror).map(|role| (role, None));
        let role = own.next().or(self.inherited.role);
        let reason =
            |ending: Option<&str>| ending.map_or_else(|| "extras".to_owned(), |ending| format!("a name with {ending}"));
        let is_invisible = self.inherited.is_invisible || motions.appears(self.index);
        let invisible = is_invisible.then(|| "KHR_node_visibility".to_owned());
        let moves = motions.why(self.index, self.mesh, primitive);
        Evidence {
            names,
            role: role.map(|(role, ending)| (role, reason(ending))),
            see_through: see_through.or(invisible),
            deforms: moves.as_ref().is_some_and(|moves| moves.deforms),
            moves: moves.map(|moves| moves.reason),
        }
    }

    fn fail(&self, primitive: usize, kind: PrimitiveErrorKind) -> SceneReadError {
        SceneReadError::Primitive { node: self.id(), primitive, kind: Box::new(kind) }
    }
}

fn id_of(index: usize, node: &Node) -> NodeId {
    NodeId { index, name: node.name.as_deref().map(str::to_owned) }
}

/// The scene of a document that has this name, or else this index.
fn scene_called(document: &Document, name: &str) -> Result<usize, SceneReadError> {
    let of_name = document.scenes.iter().position(|scene| scene.name.as_deref() == Some(name));
    let of_index = || name.parse().ok().filter(|&index: &usize| index < document.scenes.len());
    of_name
        .or_else(of_index)
        .ok_or_else(|| SceneReadError::NoSuchScene { name: name.to_owned(), names: scene_names(document) })
}

/// The names of all scenes; the index of one without.
fn scene_names(document: &Document) -> Vec<String> {
    let name = |(k, scene): (usize, &SceneRoots)| scene.name.as_deref().map_or_else(|| k.to_string(), str::to_owned);
    document.scenes.iter().enumerate().map(name).collect()
}

/// The nodes where a scene begins: the one that is asked for, or the default.
fn roots(document: &Document, asked: Option<&str>) -> Result<Vec<usize>, SceneReadError> {
    let asked = asked.map(|name| scene_called(document, name)).transpose()?;
    let scene = asked.or(document.scene).unwrap_or(0);
    match document.scenes.get(scene) {
        Some(roots) => match roots.nodes.iter().find(|&&node| node >= document.nodes.len()) {
            Some(&node) => Err(SceneReadError::NoRoot { scene, node }),
            None => Ok(roots.nodes.clone()),
        },
        None if document.scene.is_some() => Err(SceneReadError::NoScene { scene }),
        None => {
            let mut is_child = vec![false; document.nodes.len()];
            for &child in document.nodes.iter().flat_map(|n| &n.children) {
                // A child that does not exist is reported when its parent is placed.
                if let Some(is_child) = is_child.get_mut(child) {
                    *is_child = true;
                }
            }
            Ok((0..is_child.len()).filter(|&node| !is_child[node]).collect())
        }
    }
}

/// The nodes of a scene.
struct Nodes<'a> {
    /// Those with meshes, parents before children.
    placed: Vec<Placed<'a>>,
    /// The parent of each node of the scene, `Some(None)` for a root; `None` for nodes that are of no or another scene.
    above: Vec<Option<Option<usize>>>,
}

/// The nodes of a scene. Keeps its own stack, so depth costs nothing but memory.
fn place_nodes<'a>(
    document: &'a Document,
    buffers: &Buffers<'_>,
    scene: Option<&str>,
) -> Result<Nodes<'a>, SceneReadError> {
    let mut above: Vec<Option<Option<usize>>> = vec![None; document.nodes.len()];
    let start = |node| (node, None, Transform::IDENTITY, Inherited::default());
    let mut stack: Vec<_> = roots(document, scene)?.into_iter().rev().map(start).collect();
    let mut placed = Vec::new();
    while let Some((index, parent_idx, parent, inherited)) = stack.pop() {
        let node = &document.nodes[index];
        let fail = |kind| SceneReadError::Node { node: id_of(index, node), kind };
        if above[index].replace(parent_idx).is_some() {
            return Err(fail(NodeErrorKind::ReachedTwice));
        }
        let world = parent.after(&Transform::of_node(node).map_err(fail)?);
        let inherited = inherited.by(node);
        if let Some(mesh_idx) = node.mesh {
            let mesh = document.meshes.get(mesh_idx).ok_or_else(|| fail(NodeErrorKind::NoMesh { mesh: mesh_idx }))?;
            let at = |world: Transform, instance| Placed { index, node, mesh_idx, mesh, world, inherited, instance };
            match node.extensions.as_ref().and_then(|extensions| extensions.instances.as_ref()) {
                None => placed.push(at(world, None)),
                Some(instances) => {
                    let instances = instances.as_ref().map_err(|_| fail(NodeErrorKind::NoInstances))?;
                    let all = transforms(instances, document, buffers).map_err(fail)?;
                    if placed.len() + all.len() > MAX_OBJECTS {
                        let kind = PrimitiveErrorKind::TooMany { what: "objects", max: MAX_OBJECTS };
                        return Err(at(world, None).fail(0, kind));
                    }
                    placed.extend(all.iter().enumerate().map(|(k, own)| at(world.after(own), Some(k))));
                }
            }
        }
        if let Some(&child) = node.children.iter().find(|&&child| child >= document.nodes.len()) {
            return Err(fail(NodeErrorKind::NoChild { child }));
        }
        stack.extend(node.children.iter().rev().map(|&child| (child, Some(index), world, inherited.for_children())));
    }
    Ok(Nodes { placed, above })
}

/// Refuses scenes that are too large before any object is made: a small file can describe a large scene.
fn check_size(document: &Document, placed: &[Placed<'_>]) -> Result<(), SceneReadError> {
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
                    return Err(at.fail(k, PrimitiveErrorKind::TooMany { what, max: *max }));
                }
            }
        }
    }
    Ok(())
}

fn build(
    document: &Document,
    motions: &Motions<'_, '_>,
    placed: &[Placed<'_>],
    classifier: &mut Classifier<'_>,
    mut watch: impl FnMut(Origin<'_>),
) -> Result<Builder, SceneReadError> {
    let mut builder = Builder::saying(document.asset.simplified);
    // Meshes by their index, read when the first node has them.
    let mut meshes: Vec<Option<Vec<LocalMesh>>> = Vec::new();
    meshes.resize_with(document.meshes.len(), || None);
    for at in placed {
        let mesh = match &mut meshes[at.mesh_idx] {
            Some(mesh) => mesh,
            unread => {
                let read = |(k, p)| LocalMesh::read(document, motions.buffers(), p).map_err(|kind| at.fail(k, kind));
                unread.insert(at.mesh.primitives.iter().enumerate().map(read).collect::<Result<_, _>>()?)
            }
        };
        watch(Origin { node: at.index, mesh: at.mesh_idx, mirrors: at.world.mirrors(), locals: mesh });
        for (k, local) in mesh.iter().enumerate() {
            let (name, primitive) = (at.name(k), &at.mesh.primitives[k]);
            let materials = materials_of(primitive);
            let evidence = materials.iter().map(|&m| at.evidence(document, motions, primitive, m, &name));
            let mut class = classifier.classify(evidence);
            let moved = class.as_ref().filter(|class| class.moves).map(|_| {
                let vertices = Vertices { corners: &local.mesh.corners, positions: &local.positions };
                let moved = motions.moved(at.index, at.mesh, primitive, vertices);
                // Boxes are around the mesh of the node, not around its instances.
                if at.instance.is_some() { Moved { at_rest: None, within: None } } else { moved }
            });
            let placed =
                |(vertex, p)| check_point(p).map_err(|kind| at.fail(k, PrimitiveErrorKind::Vertex { vertex, kind }));
            let corners = local.mesh.corners.iter().copied();
            let vertices = match moved.as_ref().and_then(|moved| moved.at_rest.as_ref()) {
                Some(at_rest) => corners.zip(at_rest.iter().copied()).map(placed).collect::<Result<_, _>>()?,
                None => {
                    let world = local.positions.iter().map(|&p| at.world.apply(p));
                    corners.zip(world).map(placed).collect::<Result<_, _>>()?
                }
            };
            builder.add(name, vertices, local.mesh.triangles.iter().copied(), at.world.mirrors(), moved.is_some());
            if at.is_mirror(document, primitive) {
                builder.mark_mirror();
            }
            let fronts_only = |&m: &Option<usize>| m.is_none_or(|m| shows_fronts_only(document, m));
            if !classifier.shows_both_sides() && at.world.keeps_sides() && materials.iter().all(fronts_only) {
                builder.mark_fronts_only();
            }
            if class.as_ref().is_none_or(Classification::hides)
                && materials.iter().any(|&m| is_single_sided(document, m))
            {
                // Who says by name that something hides has the last word.
                let is_vouched_for = class.as_ref().is_some_and(|class| class.is_vouched_for);
                if let Some(other) = builder.count_single_sided(classifier.hides_no_single_sides() && !is_vouched_for) {
                    class = Some(other);
                }
            }
            if let Some(class) = class {
                builder.classify(class, moved.and_then(|moved| moved.within));
            }
        }
    }
    Ok(builder)
}

/// The material of a primitive, and those that it may have instead; `None` for the standard one.
fn materials_of(primitive: &Primitive) -> Vec<Option<usize>> {
    std::iter::once(primitive.material).chain(primitive.variants.iter().copied().map(Some)).collect()
}

/// Whether engines draw only the fronts of what has a material.
fn is_single_sided(document: &Document, material: Option<usize>) -> bool {
    let material = material.and_then(|m| document.materials.get(m)?.as_ref());
    material.is_none_or(|material| !material.double_sided)
}

/// Warnings of extras that state a role that there is not.
fn unknown_roles(document: &Document) -> Vec<String> {
    fn of<'a>(what: &str, said: impl Iterator<Item = (StatedRole, Option<&'a str>)>) -> Option<String> {
        let names: Vec<&str> =
            said.filter(|(role, _)| *role == StatedRole::Unknown).map(|(_, name)| name.unwrap_or_default()).collect();
        let (first, n) = (names.first()?, names.len());
        let roles = Role::ALL.map(Role::name).join(", ");
        Some(format!("extras of {what} state a role that is none of {roles}: {n}, the first called {first:?}"))
    }
    let nodes = document.nodes.iter().map(|node| (node.stated.role, node.name.as_deref()));
    let meshes = document.meshes.iter().map(|mesh| (mesh.role, mesh.name.as_deref()));
    let materials = document.materials.iter().flatten().map(|material| (material.role, material.name.as_deref()));
    [of("nodes", nodes), of("meshes", meshes), of("materials", materials)].into_iter().flatten().collect()
}

/// A primitive as it is in its mesh.
#[derive(Debug)]
pub(super) struct LocalMesh {
    pub(super) mesh: Compact,
    /// Of each corner of `mesh`.
    positions: Vec<[f64; 3]>,
}

impl LocalMesh {
    fn read(document: &Document, buffers: &Buffers<'_>, primitive: &Primitive) -> Result<Self, PrimitiveErrorKind> {
        let positions = primitive.attributes.position.ok_or(PrimitiveErrorKind::NoPositions)?;
        let elements = |accessor, role| {
            let fail = |kind: AccessorErrorKind| PrimitiveErrorKind::Accessor { role, accessor, kind };
            Elements::new(document, buffers, accessor, role).map_err(fail)
        };
        let positions = elements(positions, AccessorRole::Positions)?;
        let corners = match primitive.indices {
            Some(indices) => read_indices(&elements(indices, AccessorRole::Indices)?, positions.count)?,
            None => (0..positions.count).collect(),
        };
        check_mode(primitive.mode, corners.len())?;
        let n_triangles = n_triangles_of(primitive.mode, corners.len());
        let triangles = (0..n_triangles).map(|k| triangle_of(primitive.mode, k).map(|place| corners[place]));
        let mesh = Compact::new(corners.clone(), triangles);
        let positions = mesh.corners.iter().map(|&k| positions.position(k)).collect();
        Ok(Self { mesh, positions })
    }
}

pub(super) fn read_indices(indices: &Elements<'_>, n_positions: usize) -> Result<Vec<usize>, PrimitiveErrorKind> {
    let check = |position| {
        let index = indices.index(position);
        let fail = PrimitiveErrorKind::Index { position, index, n_positions };
        usize::try_from(index).ok().filter(|&i| i < n_positions).ok_or(fail)
    };
    (0..indices.count).map(check).collect()
}

/// Refuses modes that do not exist, and lists of triangles that end in a part of one.
fn check_mode(mode: u32, n_corners: usize) -> Result<(), PrimitiveErrorKind> {
    match mode {
        TRIANGLES if !n_corners.is_multiple_of(3) => Err(PrimitiveErrorKind::Corners { n_corners }),
        0..=TRIANGLE_FAN => Ok(()),
        _ => Err(PrimitiveErrorKind::Mode { mode }),
    }
}

/// Triangles that `n` corners make; points and lines make none.
fn n_triangles_of(mode: u32, n: usize) -> usize {
    match mode {
        TRIANGLES => n / 3,
        TRIANGLE_STRIP | TRIANGLE_FAN => n.saturating_sub(2),
        _ => 0,
    }
}

/// Which corners triangle `k` has, in the order of the specification (section 3.7.2.1).
fn triangle_of(mode: u32, k: usize) -> [usize; 3] {
    match mode {
        // Every other triangle of a strip runs the other way round.
        TRIANGLE_STRIP => [k, k + 1 + k % 2, k + 2 - k % 2],
        TRIANGLE_FAN => [k + 1, k + 2, 0],
        _ => [3 * k, 3 * k + 1, 3 * k + 2],
    }
}
