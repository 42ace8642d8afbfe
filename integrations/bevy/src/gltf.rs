//! What a glTF file says of its meshes, noted while Bevy loads it: nothing has to be authored.

use crate::space::{Affine, Point};
use bevy::asset::LoadContext;
use bevy::camera::primitives::Aabb;
use bevy::gltf::extensions::{ErasedGltfExtensionHandler, GltfExtensionHandler};
use bevy::mesh::morph::MeshMorphWeights;
use bevy::mesh::skinning::SkinnedMesh;
use bevy::platform::collections::HashMap;
use bevy::prelude::*;

/// Where a mesh of a glTF scene comes from.
#[derive(Debug, Clone, PartialEq, Default, Reflect)]
#[reflect(Default, Clone)]
pub struct PvsSource {
    /// Its node, as an index in the file.
    pub node: u32,
    /// The primitive of the node's mesh.
    pub primitive: u32,
    /// The name of the node, else of its mesh, else `node N`; primitives after the first add `#1`, `#2` and so on.
    pub name: String,
    /// Lower corner of a box around it, in the coordinates of the scene, as the file has it.
    pub min: [f64; 3],
    /// Upper corner of that box.
    pub max: [f64; 3],
    /// Whether its material has one side in the file: then Bevy draws no backs of it, unless the game changes the material.
    pub is_single_sided: bool,
}

/// On the root of every scene that was loaded from a glTF file: its meshes in the order of the file, parents before children. Added by the
/// plugin while the file is loaded.
///
/// The root is the entity that holds the scene's nodes; the entity with `WorldAssetRoot` is above it.
///
/// A game may also make one for a level from elsewhere, and tie meshes to it with [`PvsParts`](crate::PvsParts).
#[derive(Component, Debug, Clone, Default, Reflect)]
#[reflect(Component, Default, Clone)]
#[require(Transform)]
pub struct PvsScene {
    /// The meshes.
    pub sources: Vec<PvsSource>,
}

/// On every mesh of a scene that was loaded from a glTF file: which of [`PvsScene::sources`] it is. Added by the plugin while the file is
/// loaded.
///
/// Meshes with skins or morph targets have none: they are drawn whenever Bevy draws them. Remove it from an entity to have
/// that for any other one.
#[derive(Component, Debug, Clone, Copy, Default, Reflect)]
#[reflect(Component, Default, Clone)]
pub struct PvsObject {
    /// Index into [`PvsScene::sources`].
    pub source: u32,
    /// The box around the mesh, in its own coordinates, as the file has it: center and half extents.
    pub(crate) bounds: [[f32; 3]; 2],
}

/// On the nodes and meshes of a glTF scene: where the file puts them, and whether they are elsewhere now.
#[derive(Component, Debug, Clone, Copy, Reflect)]
#[reflect(Component, Clone)]
pub(crate) struct Rest {
    pub(crate) at: Transform,
    /// What it hangs on.
    #[entities]
    pub(crate) parent: Entity,
    pub(crate) is_elsewhere: bool,
}

/// Writes [`PvsScene`], [`PvsObject`] and where everything rests.
#[derive(Debug, Clone, Default)]
pub(crate) struct Notes {
    /// Of the scene that is being loaded: for each entity of a node its index and given name.
    nodes: HashMap<Entity, (u32, Option<String>)>,
    /// For each entity of a mesh its primitive, and whether its material has one side.
    meshes: HashMap<Entity, (u32, bool)>,
}

impl GltfExtensionHandler for Notes {
    fn dyn_clone(&self) -> Box<dyn ErasedGltfExtensionHandler> {
        Box::new(Self::default())
    }

    fn on_spawn_mesh_and_material(
        &mut self,
        _: &mut LoadContext<'_>,
        primitive: &::gltf::Primitive<'_>,
        _: &::gltf::Mesh<'_>,
        material: &::gltf::Material<'_>,
        entity: &mut EntityWorldMut<'_>,
        _: &str,
    ) {
        self.meshes.insert(entity.id(), (primitive.index() as u32, !material.double_sided()));
    }

    fn on_gltf_node(&mut self, _: &mut LoadContext<'_>, node: &::gltf::Node<'_>, entity: &mut EntityWorldMut<'_>) {
        let of_mesh = || node.mesh().and_then(|mesh| mesh.name().map(str::to_owned));
        let name = node.name().map(str::to_owned).or_else(of_mesh);
        self.nodes.insert(entity.id(), (node.index() as u32, name));
    }

    fn on_scene_completed(&mut self, _: &mut LoadContext<'_>, _: &::gltf::Scene<'_>, root: Entity, world: &mut World) {
        let mut scene = PvsScene::default();
        let mut stack = vec![(root, Affine::IDENTITY)];
        while let Some((entity, above)) = stack.pop() {
            let Some(local) = world.get::<Transform>(entity).copied() else { continue };
            // The root turns with its scene: what is below has the coordinates of the file.
            let here = if entity == root { above } else { above.after(&Affine::of(local.compute_affine())) };
            if let Some(parent) = world.get::<ChildOf>(entity).map(ChildOf::parent) {
                world.entity_mut(entity).insert(Rest { at: local, parent, is_elsewhere: false });
            }
            let children: Vec<Entity> = world.get::<Children>(entity).into_iter().flatten().copied().collect();
            for &child in &children {
                self.note_mesh(world, (entity, child), here, &mut scene.sources);
            }
            // Children in order, so the last goes onto the stack first.
            stack.extend(children.into_iter().rev().map(|child| (child, here)));
        }
        world.entity_mut(root).insert(scene);
        self.nodes.clear();
        self.meshes.clear();
    }
}

impl Notes {
    /// Tags a child of a node, if it is a mesh.
    fn note_mesh(
        &self,
        world: &mut World,
        (node, child): (Entity, Entity),
        above: Affine,
        sources: &mut Vec<PvsSource>,
    ) {
        let (Some(&(primitive, is_single_sided)), Some((node, name))) =
            (self.meshes.get(&child), self.nodes.get(&node))
        else {
            return;
        };
        let local = world.get::<Transform>(child).copied().unwrap_or_default();
        let bounds = world.get::<Aabb>(child).copied().unwrap_or_default();
        let (min, max) = corners_of(&bounds);
        let (min, max) = above.after(&Affine::of(local.compute_affine())).box_around(min, max);
        let name = name.clone().unwrap_or_else(|| format!("node {node}"));
        let name = if primitive == 0 { name } else { format!("{name}#{primitive}") };
        let object =
            PvsObject { source: sources.len() as u32, bounds: [bounds.center.into(), bounds.half_extents.into()] };
        sources.push(PvsSource { node: *node, primitive, name, min, max, is_single_sided });
        let mut child = world.entity_mut(child);
        // Their vertices leave the box.
        if !child.contains::<SkinnedMesh>() && !child.contains::<MeshMorphWeights>() {
            child.insert(object);
        }
    }
}

/// The lower and the upper corner of a box, in double precision.
pub(crate) fn corners_of(bounds: &Aabb) -> (Point, Point) {
    let (center, half) = (bounds.center.to_array().map(f64::from), bounds.half_extents.to_array().map(f64::from));
    (std::array::from_fn(|k| center[k] - half[k]), std::array::from_fn(|k| center[k] + half[k]))
}
