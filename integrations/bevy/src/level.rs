//! Which entities are meshes of levels, and which of them are not where their file puts them.

use crate::gltf::{PvsObject, PvsScene, Rest, corners_of};
use crate::movers::PvsMover;
use bevy::camera::primitives::Aabb;
use bevy::camera::visibility::NoFrustumCulling;
use bevy::ecs::lifecycle::RemovedComponents;
use bevy::ecs::system::SystemParam;
use bevy::prelude::*;

/// What is known of an entity.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Slot {
    entity: Entity,
    /// The root of its scene.
    pub(crate) scene: Entity,
    /// Which source of its scene it is.
    pub(crate) source: u32,
    /// It moves, says the game.
    is_mover: bool,
    /// It, or what it hangs on, is not where its file puts it.
    is_elsewhere: bool,
    /// Its box has grown.
    is_outgrown: bool,
    /// It is not to be culled.
    is_exempt: bool,
    /// It has [`PvsParts`](crate::PvsParts): several sources, or one.
    has_parts: bool,
}

/// How an entity is judged.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Judged {
    /// Left to Bevy.
    Free,
    /// By the answer for this source of this scene.
    Table { scene: Entity, source: u32 },
    /// By the answers for the sources that its [`PvsParts`](crate::PvsParts) name.
    Parts { scene: Entity },
    /// By the cells that its box meets: for all cameras, or for those in this scene.
    Box { scene: Option<Entity> },
}

/// All entities that may be culled, by the index of the entity.
#[derive(Resource, Debug, Default)]
pub(crate) struct Slots {
    slots: Vec<Option<Slot>>,
    /// Entities that are movers, for the next look.
    movers: Vec<Entity>,
}

impl Slots {
    fn slot(&self, entity: Entity) -> Option<&Slot> {
        self.slots.get(entity.index_u32() as usize)?.as_ref().filter(|slot| slot.entity == entity)
    }

    fn slot_mut(&mut self, entity: Entity) -> Option<&mut Slot> {
        self.slots.get_mut(entity.index_u32() as usize)?.as_mut().filter(|slot| slot.entity == entity)
    }

    fn put(&mut self, slot: Slot) {
        let index = slot.entity.index_u32() as usize;
        if self.slots.len() <= index {
            self.slots.resize(index + 1, None);
        }
        self.slots[index] = Some(slot);
    }

    /// Notes a mesh with parts of a level.
    pub(crate) fn put_parts(&mut self, entity: Entity, scene: Entity, is_elsewhere: bool, is_exempt: bool) {
        let (is_mover, is_outgrown) = (false, false);
        self.put(Slot {
            entity,
            scene,
            source: u32::MAX,
            is_mover,
            is_elsewhere,
            is_outgrown,
            is_exempt,
            has_parts: true,
        });
    }

    /// Leaves an entity to Bevy.
    pub(crate) fn forget(&mut self, entity: Entity) {
        if self.slot(entity).is_some() {
            self.slots[entity.index_u32() as usize] = None;
        }
    }

    /// How an entity is judged. O(1).
    #[inline]
    pub(crate) fn judge(&self, entity: Entity) -> Judged {
        match self.slot(entity) {
            None => Judged::Free,
            Some(slot) if slot.is_exempt => Judged::Free,
            Some(slot) if slot.is_mover => Judged::Box { scene: None },
            Some(slot) if slot.is_elsewhere || slot.is_outgrown => Judged::Box { scene: Some(slot.scene) },
            Some(slot) if slot.has_parts => Judged::Parts { scene: slot.scene },
            Some(slot) => Judged::Table { scene: slot.scene, source: slot.source },
        }
    }
}

/// The hierarchy of the levels.
#[derive(SystemParam)]
pub(crate) struct Hierarchy<'w, 's> {
    parents: Query<'w, 's, &'static ChildOf>,
    children: Query<'w, 's, &'static Children>,
    scenes: Query<'w, 's, (), With<PvsScene>>,
    exempt: Query<'w, 's, (), With<NoFrustumCulling>>,
}

/// Everything of the file that may have moved.
type Moved = Or<(Changed<Transform>, Changed<ChildOf>)>;

/// Notes new meshes of levels, and forgets those that are gone. Costs a look at the ticks of each node and mesh.
pub(crate) fn note(
    mut slots: ResMut<Slots>,
    hierarchy: Hierarchy<'_, '_>,
    mut rests: Query<(Entity, &Transform, Option<&ChildOf>, &mut Rest)>,
    moved: Query<Entity, (With<Rest>, Moved)>,
    fresh: Query<(Entity, &PvsObject), Added<PvsObject>>,
    objects: Query<&PvsObject>,
    (mut gone, mut loose): (RemovedComponents<PvsObject>, RemovedComponents<ChildOf>),
) {
    for entity in gone.read().filter(|entity| !objects.contains(*entity)) {
        slots.forget(entity);
    }
    let mut turned = Vec::new();
    for entity in moved.iter().chain(loose.read()) {
        let Ok((_, at, parent, mut rest)) = rests.get_mut(entity) else { continue };
        let rest = rest.bypass_change_detection();
        let is_elsewhere = *at != rest.at || parent.map(ChildOf::parent) != Some(rest.parent);
        if rest.is_elsewhere != is_elsewhere {
            rest.is_elsewhere = is_elsewhere;
            turned.push(entity);
        }
    }
    let rests = rests.as_readonly();
    for (entity, object) in &fresh {
        let Some((scene, is_elsewhere)) = hierarchy.above(entity, &rests) else { continue };
        let is_exempt = hierarchy.exempt.contains(entity);
        slots.put(Slot {
            entity,
            scene,
            source: object.source,
            is_mover: false,
            is_elsewhere,
            is_outgrown: false,
            is_exempt,
            has_parts: false,
        });
    }
    for top in turned {
        for entity in std::iter::once(top).chain(hierarchy.children.iter_descendants(top)) {
            let is_elsewhere = hierarchy.above(entity, &rests).is_none_or(|(_, is_elsewhere)| is_elsewhere);
            if let Some(slot) = slots.slot_mut(entity) {
                slot.is_elsewhere = is_elsewhere;
            }
        }
    }
}

/// Notes meshes of levels whose boxes have changed: other meshes, or other vertices.
pub(crate) fn note_boxes(mut slots: ResMut<Slots>, boxes: Query<(Entity, &PvsObject, &Aabb), Changed<Aabb>>) {
    for (entity, object, bounds) in &boxes {
        if let Some(slot) = slots.slot_mut(entity) {
            slot.is_outgrown = has_grown(object, bounds);
        }
    }
}

impl Hierarchy<'_, '_> {
    /// The root of the scene that an entity is in, and whether something on the way there is not where the file puts it.
    fn above(
        &self,
        entity: Entity,
        rests: &Query<(Entity, &Transform, Option<&ChildOf>, &Rest)>,
    ) -> Option<(Entity, bool)> {
        let mut is_elsewhere = false;
        let mut here = entity;
        loop {
            is_elsewhere |= rests.get(here).is_ok_and(|(_, _, _, rest)| rest.is_elsewhere);
            here = self.parents.get(here).ok()?.parent();
            if self.scenes.contains(here) {
                return Some((here, is_elsewhere));
            }
        }
    }
}

/// Whether a box reaches out of the one that the file gives a mesh, by more than 64 units of 2^-24 of its size: center and half
/// extents are rounded, and files round the bounds of their meshes.
fn has_grown(object: &PvsObject, bounds: &Aabb) -> bool {
    let [center, half_extents] = object.bounds.map(Vec3::from_array);
    let (at_rest, now) =
        (corners_of(&Aabb { center: center.into(), half_extents: half_extents.into() }), corners_of(bounds));
    let size = (0..3).map(|k| at_rest.0[k].abs().max(at_rest.1[k].abs())).fold(0.0, f64::max);
    let slack = size * 64.0 / f64::from(1u32 << 24);
    (0..3).any(|k| now.0[k] < at_rest.0[k] - slack || now.1[k] > at_rest.1[k] + slack)
}

/// Notes which entities are movers: those with [`PvsMover`] and all below them. O(movers).
pub(crate) fn note_movers(
    mut slots: ResMut<Slots>,
    movers: Query<Entity, With<PvsMover>>,
    children: Query<&Children>,
    meshes: Query<(), With<Mesh3d>>,
) {
    let slots = &mut *slots;
    let mut before = std::mem::take(&mut slots.movers);
    for entity in before.drain(..) {
        if let Some(slot) = slots.slot_mut(entity) {
            slot.is_mover = false;
        }
    }
    for top in &movers {
        for entity in std::iter::once(top).chain(children.iter_descendants(top)) {
            if !meshes.contains(entity) {
                continue;
            }
            match slots.slot_mut(entity) {
                Some(slot) => slot.is_mover = true,
                None => slots.put(Slot {
                    entity,
                    scene: Entity::PLACEHOLDER,
                    source: u32::MAX,
                    is_mover: true,
                    is_elsewhere: false,
                    is_outgrown: false,
                    is_exempt: false,
                    has_parts: false,
                }),
            }
            before.push(entity);
        }
    }
    slots.movers = before;
}

/// What is not to be culled by its box is not culled by its cells either.
pub(crate) fn exempt(event: On<Add, NoFrustumCulling>, mut slots: ResMut<Slots>) {
    if let Some(slot) = slots.slot_mut(event.entity) {
        slot.is_exempt = true;
    }
}

/// The way back.
pub(crate) fn readmit(event: On<Remove, NoFrustumCulling>, mut slots: ResMut<Slots>) {
    if let Some(slot) = slots.slot_mut(event.entity) {
        slot.is_exempt = false;
    }
}
