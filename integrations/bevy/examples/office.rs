//! A walk through a generated office tower of 16 floors. `cargo xtask bevy-assets` first, then
//! `cargo run --release --example office --features gizmos,overlay`.
//!
//! W A S D and the mouse walk, Q and E go down and up, shift runs, Escape frees the mouse.
//! C: culls or not. M: the next method. L: locks the set, to fly out and look at it. G: cells. P: portals.

mod support;

use bevy::gizmos::config::GizmoConfigStore;
use bevy::prelude::*;
use bevy_sightlines::{PvsCamera, PvsGizmos, PvsLock, PvsMethod, PvsOverlayPlugin, SightlinesPlugin};
use support::{light, need, walk, walker};

fn main() {
    need(&["tower16.glb", "tower16.pvs"]);
    App::new()
        .add_plugins((DefaultPlugins, SightlinesPlugin, PvsOverlayPlugin))
        .add_systems(Startup, setup)
        .add_systems(Update, (walk, keys))
        .run();
}

fn setup(mut commands: Commands<'_, '_>, assets: Res<AssetServer>) {
    commands.spawn(WorldAssetRoot(assets.load(GltfAssetLabel::Scene(0).from_asset("tower16.glb"))));
    commands.spawn((walker(), PvsCamera::new(assets.load("tower16.pvs"))));
    light(&mut commands);
}

fn keys(
    mut commands: Commands<'_, '_>,
    keys: Res<ButtonInput<KeyCode>>,
    mut cameras: Query<(Entity, &mut PvsCamera, Has<PvsLock>)>,
    mut gizmos: ResMut<GizmoConfigStore>,
) {
    for (entity, mut camera, is_locked) in &mut cameras {
        if keys.just_pressed(KeyCode::KeyC) {
            camera.culls = !camera.culls;
        }
        if keys.just_pressed(KeyCode::KeyM) {
            camera.method = match camera.method {
                PvsMethod::CellToCell => PvsMethod::DisjointCell,
                PvsMethod::DisjointCell => PvsMethod::ConnectedComponent,
                PvsMethod::ConnectedComponent => PvsMethod::IncidentPortals,
                PvsMethod::IncidentPortals => PvsMethod::Exact,
                PvsMethod::Exact => PvsMethod::CellToCell,
            };
        }
        if keys.just_pressed(KeyCode::KeyL) {
            match is_locked {
                true => commands.entity(entity).remove::<PvsLock>(),
                false => commands.entity(entity).insert(PvsLock),
            };
        }
    }
    let (_, shown) = gizmos.config_mut::<PvsGizmos>();
    if keys.just_pressed(KeyCode::KeyG) {
        (shown.cells, shown.at) = (!shown.cells, !shown.at);
    }
    if keys.just_pressed(KeyCode::KeyP) {
        shown.portals = !shown.portals;
    }
}
