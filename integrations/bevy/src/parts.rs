//! Meshes that come from no glTF file: the game names the objects that they show.

use crate::gltf::{PvsScene, PvsSource, corners_of};
use crate::level::Slots;
use crate::space::{Affine, Point};
use bevy::camera::primitives::Aabb;
use bevy::camera::visibility::NoFrustumCulling;
use bevy::ecs::lifecycle::RemovedComponents;
use bevy::prelude::*;

/// On a mesh that comes from no glTF file: which objects of a level it shows. It is drawn where one of them is seen.
///
/// The level is an entity with a [`PvsScene`] that the game has made: a source for each object of the table, in the table's order, with its name
/// and box. The transform of that entity takes coordinates of the table to those of the world, so it may turn and scale.
///
/// While the mesh's box (`Aabb`) reaches out of the boxes of its sources, it is judged by its own box, as what moves is. Which triangles it has within
/// them is not looked at: whoever names fewer objects than the mesh shows has it vanish where it can be seen.
#[derive(Component, Debug, Clone, Reflect)]
#[reflect(Component, Clone)]
pub struct PvsParts {
    /// The level.
    #[entities]
    pub level: Entity,
    /// Indices into [`PvsScene::sources`]. With none, or one that is not there, the mesh is always drawn.
    pub sources: Vec<u32>,
}

impl PvsParts {
    /// These sources of this level.
    pub fn new(level: Entity, sources: impl IntoIterator<Item = u32>) -> Self {
        Self { level, sources: sources.into_iter().collect() }
    }
}

type Parts<'a> = (Entity, &'a PvsParts, Option<&'a Aabb>, &'a GlobalTransform, Has<NoFrustumCulling>);
type Moved = Or<(Changed<PvsParts>, Changed<Aabb>, Changed<GlobalTransform>)>;

/// Notes meshes with [`PvsParts`] that are new or have moved, and all of a level that has, and forgets those that are gone.
///
/// Costs a look at the ticks of each of them, and O(sources) for those that it notes.
pub(crate) fn note_parts(
    mut slots: ResMut<Slots>,
    all: Query<Parts<'_>>,
    moved: Query<Entity, (With<PvsParts>, Moved)>,
    levels: Query<(Entity, Ref<PvsScene>, Ref<GlobalTransform>)>,
    mut gone: RemovedComponents<PvsParts>,
) {
    for entity in gone.read().filter(|entity| !all.contains(*entity)) {
        slots.forget(entity);
    }
    let mut note = |entity: Entity| {
        let Ok((_, parts, bounds, at, is_exempt)) = all.get(entity) else { return };
        let is_there = levels.get(parts.level).is_ok_and(|(_, scene, place)| {
            bounds.is_none_or(|bounds| is_within((bounds, at), (parts, &scene, &place)))
        });
        slots.put_parts(entity, parts.level, !is_there, is_exempt);
    };
    let has_moved = |(level, scene, place): (Entity, Ref<'_, PvsScene>, Ref<'_, GlobalTransform>)| {
        (scene.is_changed() || place.is_changed()).then_some(level)
    };
    let turned: Vec<Entity> = levels.iter().filter_map(has_moved).collect();
    moved.iter().for_each(&mut note);
    if !turned.is_empty() {
        all.iter().filter(|(_, parts, ..)| turned.contains(&parts.level)).for_each(|(entity, ..)| note(entity));
    }
}

/// Whether the box of a mesh is within the one around the boxes of its sources, in the coordinates of the level, to within 256 units of 2^-24 of their
/// size: Bevy's coordinates and transforms are in single precision. True for a mesh that is always drawn. Finds meshes that have moved; without such a move it decides
/// nothing.
fn is_within(
    (bounds, at): (&Aabb, &GlobalTransform),
    (parts, scene, place): (&PvsParts, &PvsScene, &GlobalTransform),
) -> bool {
    let boxes: Option<Vec<&PvsSource>> =
        parts.sources.iter().map(|&source| scene.sources.get(source as usize)).collect();
    let Some(boxes) = boxes.filter(|boxes| !boxes.is_empty()) else { return true };
    let Some(to_level) = Affine::of(place.affine()).inverse() else { return false };
    let (min, max) = corners_of(bounds);
    let (min, max) = to_level.after(&Affine::of(at.affine())).box_around(min, max);
    let start: (Point, Point) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    let around = boxes.into_iter().fold(start, |(min, max), source| {
        (std::array::from_fn(|k| min[k].min(source.min[k])), std::array::from_fn(|k| max[k].max(source.max[k])))
    });
    let size = (0..3).map(|k| around.0[k].abs().max(around.1[k].abs())).fold(0.0, f64::max);
    let slack = size * 256.0 / f64::from(1u32 << 24);
    (0..3).all(|k| around.0[k] - slack <= min[k] && max[k] <= around.1[k] + slack)
}
