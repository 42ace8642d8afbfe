//! A walk through a Quake map: `cargo run --release --example walk -- FOLDER NAME`, with `NAME.bsp` and its table `NAME.pvs` in that folder.
//!
//! Keys: W A S D walk, the arrows turn, Q and E go down and up, shift runs. C: culls or not.

use bevy::app::AppExit;
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::prelude::*;
use bevy_sightlines::{PvsCamera, PvsOverlayPlugin, SightlinesPlugin};
use bevy_sightlines_trenchbroom::{PvsMap, TrenchBroomPvsPlugin};
use bevy_trenchbroom::bsp::Bsp;
use bevy_trenchbroom::class::builtin::BspSolidEntity;
use bevy_trenchbroom::config::WriteTrenchBroomConfigOnStartPlugin;
use bevy_trenchbroom::prelude::*;

/// Doors are drawn where they are shut.
#[solid_class(base(BspSolidEntity, Visibility))]
#[derive(Debug, Clone)]
struct FuncDoor;

/// The name of the map.
#[derive(Resource)]
struct MapName(String);

fn main() -> AppExit {
    let mut words = std::env::args().skip(1);
    let (Some(folder), Some(name)) = (words.next(), words.next()) else {
        eprintln!("which folder, and which map?");
        return AppExit::from_code(2);
    };
    let folder = std::path::absolute(folder).map_or_else(|_| String::new(), |folder| folder.display().to_string());
    let config = TrenchBroomConfig::new("walk").suppress_invalid_entity_definitions(true);
    App::new()
        .add_plugins((
            DefaultPlugins.set(AssetPlugin { file_path: folder, ..default() }),
            TrenchBroomPlugins(config).build().disable::<WriteTrenchBroomConfigOnStartPlugin>(),
            SightlinesPlugin,
            TrenchBroomPvsPlugin,
            PvsOverlayPlugin,
        ))
        .insert_resource(GlobalAmbientLight::NONE)
        .insert_resource(MapName(name))
        .add_systems(Startup, setup)
        .add_systems(Update, (begin, walk))
        .run()
}

fn setup(mut commands: Commands<'_, '_>, assets: Res<AssetServer>, name: Res<MapName>) {
    let map = format!("{}.bsp", name.0);
    commands.spawn((WorldAssetRoot(assets.load(format!("{map}#Scene"))), PvsMap::new(assets.load(map))));
    // Bevy's default tones need its feature `tonemapping_luts`.
    commands.spawn((
        Camera3d::default(),
        Tonemapping::AcesFitted,
        PvsCamera::new(assets.load(format!("{}.pvs", name.0))),
    ));
}

/// Puts the camera where players begin, and light into maps that have none.
fn begin(
    mut commands: Commands<'_, '_>,
    mut is_done: Local<'_, bool>,
    maps: Query<&PvsMap>,
    bsps: Res<Assets<Bsp>>,
    server: Res<TrenchBroomServer>,
    mut cameras: Query<&mut Transform, With<PvsCamera>>,
) {
    let Some(bsp) = maps.iter().find_map(|map| bsps.get(&map.map)).filter(|_| !*is_done) else { return };
    if bsp.lightmap.is_none() {
        commands.insert_resource(GlobalAmbientLight { brightness: 2000.0, ..default() });
    }
    let start = bsp.entities.iter().find(|entity| entity.classname().is_ok_and(|name| name == "info_player_start"));
    let place =
        start.and_then(|start| Some((start.get::<Vec3>("origin").ok()?, start.get::<f32>("angle").unwrap_or(0.0))));
    let (Some((place, turn)), Ok(mut at)) = (place, cameras.single_mut()) else { return };
    *is_done = true;
    // Eyes are 22 units above the origin of a player.
    let ahead = Vec3::new(turn.to_radians().cos(), turn.to_radians().sin(), 0.0);
    let eye = place + Vec3::Z * 22.0;
    *at = Transform::from_translation(server.config.to_bevy_space(eye))
        .looking_at(server.config.to_bevy_space(eye + ahead * 100.0), Vec3::Y);
}

fn walk(time: Res<Time>, keys: Res<ButtonInput<KeyCode>>, mut cameras: Query<(&mut PvsCamera, &mut Transform)>) {
    let axis = |plus, minus| f32::from(u8::from(keys.pressed(plus))) - f32::from(u8::from(keys.pressed(minus)));
    let speed = if keys.pressed(KeyCode::ShiftLeft) { 16.0 } else { 5.0 };
    for (mut camera, mut at) in &mut cameras {
        camera.culls ^= keys.just_pressed(KeyCode::KeyC);
        let (yaw, pitch, _) = at.rotation.to_euler(EulerRot::YXZ);
        let yaw = yaw + axis(KeyCode::ArrowLeft, KeyCode::ArrowRight) * time.delta_secs() * 1.5;
        let pitch = pitch + axis(KeyCode::ArrowUp, KeyCode::ArrowDown) * time.delta_secs();
        at.rotation = Quat::from_euler(EulerRot::YXZ, yaw, pitch.clamp(-1.5, 1.5), 0.0);
        let way = Vec3::new(axis(KeyCode::KeyD, KeyCode::KeyA), 0.0, axis(KeyCode::KeyS, KeyCode::KeyW));
        let way = Quat::from_rotation_y(yaw) * way + Vec3::Y * axis(KeyCode::KeyE, KeyCode::KeyQ);
        at.translation += way.normalize_or_zero() * speed * time.delta_secs();
    }
}
