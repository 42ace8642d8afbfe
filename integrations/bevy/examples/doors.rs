//! Doors that open and close: space shuts and opens the nearest one. `cargo xtask bevy-assets` first, then
//! `cargo run --release --example doors --features overlay`.
//!
//! A door of a level of yours has a name in its table: `PvsDoor::named("front door")`. The generated tower has no doors, so this example hangs
//! leaves into the narrow openings of its ground floor: each fills its portal, and shuts it by number.

mod support;

use bevy::prelude::*;
use bevy_sightlines::{PvsCamera, PvsDoor, PvsOverlayPlugin, PvsTable, SightlinesPlugin};
use support::{Walker, light, need, walk, walker};

fn main() {
    need(&["tower.glb", "tower.pvs"]);
    App::new()
        .add_plugins((DefaultPlugins, SightlinesPlugin, PvsOverlayPlugin))
        .add_systems(Startup, setup)
        .add_systems(Update, (walk, hang, push))
        .run();
}

fn setup(mut commands: Commands<'_, '_>, assets: Res<AssetServer>) {
    commands.spawn(WorldAssetRoot(assets.load(GltfAssetLabel::Scene(0).from_asset("tower.glb"))));
    commands.spawn((walker(), PvsCamera::new(assets.load("tower.pvs"))));
    light(&mut commands);
}

/// Hangs the leaves, once, when the table is there.
fn hang(
    mut commands: Commands<'_, '_>,
    mut is_done: Local<'_, bool>,
    cameras: Query<&PvsCamera>,
    tables: Res<Assets<PvsTable>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let table = cameras.iter().find_map(|camera| tables.get(&camera.table)?.table());
    let Some(table) = table.filter(|_| !*is_done) else { return };
    *is_done = true;
    let wood = materials.add(Color::srgb(0.5, 0.3, 0.1));
    for (k, portal) in (0..).zip(table.portals()) {
        let bounds = |axis: usize| {
            let along = portal.points.iter().map(|point| point[axis] as f32);
            (along.clone().fold(f32::INFINITY, f32::min), along.fold(f32::NEG_INFINITY, f32::max))
        };
        let [x, y, z] = [bounds(0), bounds(1), bounds(2)];
        let size = Vec3::new(x.1 - x.0, y.1 - y.0, z.1 - z.0);
        let width = size.x.max(size.z);
        // As wide and as high as a door, on the floor, in a wall along an axis.
        if y.0 > 0.2 || !(1.8..2.5).contains(&size.y) || !(0.7..1.5).contains(&width) || size.x.min(size.z) > 0.0 {
            continue;
        }
        let middle = Vec3::new(x.0 + x.1, y.0 + y.1, z.0 + z.1) / 2.0;
        commands.spawn((
            Mesh3d(meshes.add(Cuboid::from_size(size + Vec3::splat(0.02)))),
            MeshMaterial3d(wood.clone()),
            Transform::from_translation(middle),
            Visibility::Hidden,
            PvsDoor::portals([k]),
        ));
    }
}

/// Shuts or opens the nearest door.
fn push(
    keys: Res<ButtonInput<KeyCode>>,
    walkers: Query<&Transform, With<Walker>>,
    mut doors: Query<(&Transform, &mut Visibility, &mut PvsDoor)>,
) {
    let (true, Ok(eye)) = (keys.just_pressed(KeyCode::Space), walkers.single()) else { return };
    let nearest = doors.iter_mut().min_by(|(a, ..), (b, ..)| {
        let far = |at: &Transform| at.translation.distance(eye.translation);
        far(a).total_cmp(&far(b))
    });
    if let Some((_, mut leaf, mut door)) = nearest {
        door.is_open = !door.is_open;
        *leaf = if door.is_open { Visibility::Hidden } else { Visibility::Inherited };
    }
}
