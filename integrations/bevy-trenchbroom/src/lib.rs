#![doc = include_str!("../README.md")]
//!
//! # Scope
//!
//! - **Owns**: which meshes of a map show which faces of its world, and cutting meshes that show too many.
//! - **Out of scope**: loading maps (`bevy_trenchbroom`), making tables (the program `sightlines`), culling (`bevy_sightlines`).
//! - **Invariants**: every triangle of a mesh is in exactly one of its parts; one that is of no face of the world is always drawn.

#![forbid(unsafe_code)]

mod cut;
mod world;

pub use cut::PvsMapCut;

use bevy::prelude::*;
use bevy_sightlines::{PvsMover, PvsParts};
use bevy_trenchbroom::TrenchBroomServer;
use bevy_trenchbroom::bevy_materialize::generic_material::GenericMaterialApplied;
use bevy_trenchbroom::bsp::Bsp;
use bevy_trenchbroom::geometry::BrushGeometry;
use world::World as MapWorld;

/// Ties the maps of entities with [`PvsMap`] to their tables.
///
/// Added after the plugins of `bevy_trenchbroom` and `SightlinesPlugin`.
#[derive(Debug, Clone, Copy, Default)]
pub struct TrenchBroomPvsPlugin;

impl Plugin for TrenchBroomPvsPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<PvsMap>().register_type::<PvsMapCut>().add_systems(PreUpdate, (found, cut_meshes).chain());
    }
}

/// On the entity with `WorldAssetRoot` of a map: which map it is.
///
/// The meshes of the map's world, one for each texture, are cut into parts that are seen from the same places, as soon as they are there. What else the
/// map brings with meshes, such as doors, becomes a `PvsMover`.
#[derive(Component, Debug, Clone, Reflect)]
#[reflect(Component, Clone)]
pub struct PvsMap {
    /// The map.
    pub map: Handle<Bsp>,
    /// How many leafs of the map, next to each other in its tree, have their faces of one texture in one part. More leafs make fewer entities, and
    /// more that is drawn in vain. At least 1.
    pub leafs_of_part: u32,
}

impl PvsMap {
    /// With parts of one leaf.
    pub const fn new(map: Handle<Bsp>) -> Self {
        Self { map, leafs_of_part: 1 }
    }

    /// The same with parts of several leafs.
    #[must_use]
    pub const fn with_leafs(mut self, leafs_of_part: u32) -> Self {
        self.leafs_of_part = leafs_of_part;
        self
    }
}

/// What is known of a map that was loaded. On the same entity.
#[derive(Component)]
struct Found {
    map: AssetId<Bsp>,
    /// The entity with the map's faces.
    level: Entity,
    world: MapWorld,
}

/// Reads the faces of maps that have been loaded.
fn found(
    mut commands: Commands,
    maps: Query<(Entity, &PvsMap, Option<&Found>)>,
    bsps: Res<Assets<Bsp>>,
    server: Res<TrenchBroomServer>,
) {
    for (root, map, found) in &maps {
        if found.is_some_and(|found| found.map == map.map.id()) {
            continue;
        }
        let Some(bsp) = bsps.get(&map.map) else { continue };
        if let Some(found) = found {
            commands.entity(found.level).try_despawn();
        }
        let world = MapWorld::new(&bsp.data, &server.config, map.leafs_of_part.max(1));
        let place = world::to_bevy(server.config.scale);
        let level = commands.spawn((world.scene(), place, Visibility::default(), ChildOf(root))).id();
        commands.entity(root).insert(Found { map: map.map.id(), level, world });
    }
}

/// Meshes of maps that have not been looked at.
type Fresh = (With<BrushGeometry>, Without<PvsMapCut>, Without<PvsParts>);

/// Cuts the meshes of worlds, and makes movers of all others.
fn cut_meshes(
    mut commands: Commands,
    fresh: Query<(Entity, &Mesh3d), Fresh>,
    maps: Query<&Found>,
    parents: Query<&ChildOf>,
    bsps: Res<Assets<Bsp>>,
    mut meshes: ResMut<Assets<Mesh>>,
) {
    for (entity, mesh) in &fresh {
        let Some(found) = parents.iter_ancestors(entity).find_map(|above| maps.get(above).ok()) else { continue };
        let (Some(bsp), Some(whole)) = (bsps.get(found.map), meshes.get(&mesh.0)) else { continue };
        let is_world =
            bsp.models.first().is_some_and(|world| world.meshes.iter().any(|(_, of)| of.id() == mesh.0.id()));
        if !is_world {
            commands.entity(entity).insert((PvsMover, PvsMapCut { n_parts: 0, n_loose: 0 }));
            continue;
        }
        let parts = match cut::cut(whole, &found.world) {
            Ok(parts) => parts,
            Err(error) => {
                tracing::warn!("a mesh of the world is drawn as a whole: {error}");
                commands.entity(entity).insert(PvsMapCut { n_parts: 0, n_loose: 0 });
                continue;
            }
        };
        let n_loose = parts.iter().filter(|part| part.faces.is_empty()).map(|part| part.n_triangles).sum();
        let n_parts = parts.len() as u32;
        for part in parts {
            let copy = commands
                .entity(entity)
                .clone_and_spawn_with_opt_out(|cloner| {
                    cloner.deny::<(Mesh3d, bevy::camera::primitives::Aabb, Children, GenericMaterialApplied)>();
                })
                .id();
            commands.entity(copy).insert((Mesh3d(meshes.add(part.mesh)), PvsParts::new(found.level, part.faces)));
        }
        commands.entity(entity).remove::<Mesh3d>().insert(PvsMapCut { n_parts, n_loose });
    }
}
