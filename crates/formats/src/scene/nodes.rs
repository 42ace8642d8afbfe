//! The nodes of a scene of a glTF: where they are in the world, and what they have of those above them.

use super::MAX_OBJECTS;
use super::accessor::{AccessorRole, Elements};
use super::buffers::Buffers;
use super::json::{Document, Mesh, Node, Primitive, SceneRoots};
use super::material::see_through;
use super::motion::Motions;
use super::movers::{INSTANCING, Instances};
use super::role::{MeshNames, Role, role_of_name};
use super::surface::Evidence;
use super::transform::Transform;
use crate::error::{Malformed, malformed};
use sightlines_cells::Point3;
use std::collections::BTreeSet;

/// A node that has a mesh, and where it is in the world.
#[derive(Debug)]
pub(super) struct Placed<'a> {
    pub(super) index: usize,
    pub(super) node: &'a Node,
    pub(super) mesh_idx: usize,
    pub(super) mesh: &'a Mesh,
    pub(super) world: Transform,
    inherited: Inherited,
    /// Which of its instances it is, if it has some.
    pub(super) instance: Option<usize>,
}

/// What a node has of those above it, and its children of it.
#[derive(Debug, Clone, Copy, Default)]
struct Inherited {
    /// The role of the nearest node that has one, and the part of the name that states it, if its extras do not.
    role: Option<(Role, Option<&'static str>)>,
    /// Whether one of them is not drawn at first.
    is_invisible: bool,
}

impl Inherited {
    /// What `node` has, below what has `self`. `meshes` are all of the document.
    fn by(self, node: &Node, meshes: &[Mesh], names: &MeshNames<'_>) -> Self {
        let of_mesh = || meshes.get(node.mesh?)?.name.as_deref();
        let of_name = node.name.as_deref().and_then(|name| names.role_of(name));
        let of_name = of_name.or_else(|| names.hull(of_mesh()?).filter(|_| node.name.is_none()));
        let of_name = of_name.map(|(role, part)| (role, Some(part)));
        let own = node.stated.role.role().map(|role| (role, None)).filter(|own| own.0 != Role::Mirror);
        let own = own.or(of_name.filter(|own| own.0 != Role::Mirror));
        Self { role: own.or(self.role), is_invisible: self.is_invisible || node.is_invisible() }
    }

    /// What of it holds for the children: that a name promises more hiding, or a hull, is said of one node. What is below a hull is
    /// seen, and hides nothing.
    fn for_children(self) -> Self {
        let role = self.role.and_then(|role| match role {
            (Role::Occluder, Some(_)) => None,
            (Role::Ignore, name @ Some(_)) => Some((Role::SeeThrough, name)),
            _ => Some(role),
        });
        Self { role, ..self }
    }
}

impl<'a> Placed<'a> {
    pub(super) fn given_name(&self) -> Option<&'a str> {
        self.node.name.as_deref().or(self.mesh.name.as_deref())
    }

    pub(super) fn name(&self, primitive: usize) -> String {
        let name = self.given_name().map_or_else(|| format!("node {}", self.index), str::to_owned);
        let name = self.instance.map_or(name.clone(), |instance| format!("{name}[{}]", instance + 1));
        if primitive == 0 { name } else { format!("{name}#{primitive}") }
    }

    /// Whether extras of the node, the mesh or the material, or the name of the node, state that a primitive is a mirror.
    pub(super) fn is_mirror(&self, document: &Document, primitive: &Primitive) -> bool {
        let by_name = self.node.name.as_deref().and_then(role_of_name).map(|(role, _)| role);
        let material = primitive.material.and_then(|m| document.materials.get(m)?.as_ref());
        let stated = [self.node.stated, self.mesh.stated, material.map(|m| m.stated).unwrap_or_default()];
        by_name == Some(Role::Mirror) || stated.iter().any(|stated| stated.role.role() == Some(Role::Mirror))
    }

    /// What is known of one of its objects if it has a material. `name` is that of the object. Of several roles the one that is
    /// stated of the least counts: of the material, the mesh, the node, or the nearest node above it that has one.
    pub(super) fn evidence<'e>(
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
        let own = [material.and_then(|m| m.stated.role.role()), self.mesh.stated.role.role()].into_iter().flatten();
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

    pub(super) fn fail(&self, primitive: usize, what: Malformed) -> Malformed {
        what.within(format_args!("{}, primitive {primitive}", label(self.index, self.node)))
    }
}

fn label(index: usize, node: &Node) -> String {
    match &node.name {
        // As a Rust string: a name may hold anything, and a message should stay one line.
        Some(name) => format!("node {index} ({name:?})"),
        None => format!("node {index}"),
    }
}

pub(super) fn too_many(what: &str, max: usize) -> Malformed {
    malformed!("with it the scene has more than {max} {what}")
}

fn scene_called(document: &Document, name: &str) -> Result<usize, Malformed> {
    let of_name = document.scenes.iter().position(|scene| scene.name.as_deref() == Some(name));
    let of_index = || name.parse().ok().filter(|&index: &usize| index < document.scenes.len());
    of_name.or_else(of_index).ok_or_else(|| {
        let names = scene_names(document).join(", ");
        malformed!("there is no scene {name:?}, but {}", if names.is_empty() { "none" } else { &names })
    })
}

/// The names of all scenes; the index of one without.
pub(super) fn scene_names(document: &Document) -> Vec<String> {
    let name = |(k, scene): (usize, &SceneRoots)| scene.name.as_deref().map_or_else(|| k.to_string(), str::to_owned);
    document.scenes.iter().enumerate().map(name).collect()
}

/// The nodes where a scene begins: the one that is asked for, or the default.
fn roots(document: &Document, asked: Option<&str>) -> Result<Vec<usize>, Malformed> {
    let asked = asked.map(|name| scene_called(document, name)).transpose()?;
    let scene = asked.or(document.scene).unwrap_or(0);
    match document.scenes.get(scene) {
        Some(roots) => match roots.nodes.iter().find(|&&node| node >= document.nodes.len()) {
            Some(node) => Err(malformed!("there is no node {node}").within(format_args!("scene {scene}"))),
            None => Ok(roots.nodes.clone()),
        },
        None if document.scene.is_some() => Err(malformed!("there is no scene {scene}, which should be the default")),
        None => {
            let children: BTreeSet<usize> = document.nodes.iter().flat_map(|n| &n.children).copied().collect();
            Ok((0..document.nodes.len()).filter(|node| !children.contains(node)).collect())
        }
    }
}

pub(super) struct Nodes<'a> {
    pub(super) placed: Vec<Placed<'a>>,
    /// The parent of each node of the scene, `Some(None)` for a root; `None` for nodes that are of no or another scene.
    pub(super) above: Vec<Option<Option<usize>>>,
    /// Number of nodes that are left out with all below them, because others are finer levels of them.
    pub(super) n_coarser: usize,
}

/// The nodes of a scene. Keeps its own stack, so depth costs nothing but memory.
pub(super) fn place_nodes<'a>(
    document: &'a Document,
    buffers: &Buffers<'_>,
    scene: Option<&str>,
) -> Result<Nodes<'a>, Malformed> {
    let mut above: Vec<Option<Option<usize>>> = vec![None; document.nodes.len()];
    let start = |node| (node, None, Transform::IDENTITY, Inherited::default());
    let roots = roots(document, scene)?;
    let coarser = coarser_levels(document, &roots);
    let mut stack: Vec<_> = roots.into_iter().rev().map(start).collect();
    let names = mesh_names(document);
    let (mut placed, mut n_coarser) = (Vec::new(), 0);
    while let Some((index, parent_idx, parent, inherited)) = stack.pop() {
        let node = &document.nodes[index];
        let fail = |what: Malformed| what.within(label(index, node));
        if above[index].replace(parent_idx).is_some() {
            return Err(fail(malformed!("reached twice, though nodes form trees")));
        }
        if coarser.contains(&index) {
            n_coarser += 1;
            continue;
        }
        let world = parent.after(&Transform::of_node(node).map_err(fail)?);
        let inherited = inherited.by(node, &document.meshes, &names);
        if let Some(mesh_idx) = node.mesh {
            let mesh = document.meshes.get(mesh_idx).ok_or_else(|| fail(malformed!("there is no mesh {mesh_idx}")))?;
            let at = |world: Transform, instance| Placed { index, node, mesh_idx, mesh, world, inherited, instance };
            match node.extensions.as_ref().and_then(|extensions| extensions.instances.as_ref()) {
                None => placed.push(at(world, None)),
                Some(instances) => {
                    let instances = instances.as_ref().ok_or_else(|| fail(no_instances()))?;
                    let all = transforms(instances, document, buffers).map_err(fail)?;
                    if placed.len() + all.len() > MAX_OBJECTS {
                        return Err(at(world, None).fail(0, too_many("objects", MAX_OBJECTS)));
                    }
                    placed.extend(all.iter().enumerate().map(|(k, own)| at(world.of_instance(own), Some(k))));
                }
            }
        }
        if let Some(&child) = node.children.iter().find(|&&child| child >= document.nodes.len()) {
            return Err(fail(malformed!("there is no node {child}, which it has as a child")));
        }
        stack.extend(node.children.iter().rev().map(|&child| (child, Some(index), world, inherited.for_children())));
    }
    Ok(Nodes { placed, above, n_coarser })
}

fn mesh_names(document: &Document) -> MeshNames<'_> {
    let nodes = document.nodes.iter().filter(|node| node.mesh.is_some()).filter_map(|node| node.name.as_deref());
    nodes.chain(document.meshes.iter().filter_map(|mesh| mesh.name.as_deref())).collect()
}

/// The nodes that are coarser levels of a node of the scene (`MSFT_lod`), which stands for them. Files list them as levels and place
/// them nowhere; those that place them as well would show a thing several times over.
///
/// A node that is a level itself stands for nothing, so that nothing is left out for the sake of what is left out.
fn coarser_levels(document: &Document, roots: &[usize]) -> BTreeSet<usize> {
    let levels = |node: usize| document.nodes.get(node).map_or(&[][..], Node::coarser);
    let all: BTreeSet<usize> = (0..document.nodes.len()).flat_map(levels).copied().collect();
    if all.is_empty() {
        return all;
    }
    let (mut found, mut is_done) = (BTreeSet::new(), vec![false; document.nodes.len()]);
    let mut stack: Vec<usize> = roots.iter().copied().filter(|root| !all.contains(root)).collect();
    while let Some(node) = stack.pop() {
        let Some(false) = is_done.get(node) else { continue };
        is_done[node] = true;
        found.extend(levels(node));
        stack.extend(document.nodes[node].children.iter().filter(|child| !all.contains(child)));
    }
    found
}

/// Where each instance is in the coordinates of its node.
///
/// # Source
/// The specification of `EXT_mesh_gpu_instancing`: the transform of an instance is applied before that of the node.
fn transforms(instances: &Instances, document: &Document, buffers: &Buffers<'_>) -> Result<Vec<Transform>, Malformed> {
    let [translation, rotation, scale] = *instances;
    let misfit =
        |attribute: &str, accessor: usize| malformed!("{INSTANCING}: {attribute} (accessor {accessor}) does not fit");
    let read = |attribute: &'static str, accessor: Option<usize>, kind: &str| {
        let Some(accessor) = accessor else { return Ok(None) };
        let of_kind = document.accessors.get(accessor).is_some_and(|a| a.kind == kind);
        match Elements::new(document, buffers, accessor, AccessorRole::Attribute) {
            Ok(elements) if of_kind => Ok(Some((elements, attribute, accessor))),
            _ => Err(misfit(attribute, accessor)),
        }
    };
    let all =
        [read("TRANSLATION", translation, "VEC3")?, read("ROTATION", rotation, "VEC4")?, read("SCALE", scale, "VEC3")?];
    let n = all.iter().flatten().map(|(elements, ..)| elements.count).min().ok_or_else(no_instances)?;
    if let Some((_, attribute, accessor)) = all.iter().flatten().find(|(elements, ..)| elements.count != n) {
        return Err(misfit(attribute, *accessor));
    }
    let [translation, rotation, scale] = all.map(|found| found.map(|(elements, ..)| elements));
    let numbers = |of: Option<Elements<'_>>, k: usize| of.map(|elements| elements.normalized_numbers(k));
    let point = |of, k, without: Point3| numbers(of, k).and_then(|all| all.try_into().ok()).unwrap_or(without);
    let transform = |k: usize| {
        let turn = numbers(rotation, k).and_then(|numbers| numbers.try_into().ok()).unwrap_or([0.0, 0.0, 0.0, 1.0]);
        Transform::from_parts(point(translation, k, [0.0; 3]), turn, point(scale, k, [1.0; 3]))
    };
    (0..n).map(transform).collect()
}

/// The error of a mesh that is to be drawn many times, and nowhere.
fn no_instances() -> Malformed {
    malformed!("{INSTANCING} without TRANSLATION, ROTATION or SCALE")
}
