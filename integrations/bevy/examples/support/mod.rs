//! What the examples share: a walker with keys and mouse, light, and a look whether the levels are there.

use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::input::mouse::AccumulatedMouseMotion;
use bevy::prelude::*;
use bevy::window::{CursorGrabMode, CursorOptions};
use std::path::Path;

/// Ends the program with a hint if a generated file is not there.
pub(crate) fn need(files: &[&str]) {
    for file in files {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets").join(file);
        if !path.is_file() {
            eprintln!(
                "{} is not there: `cargo xtask bevy-assets` in the folder of the project makes it",
                path.display()
            );
            std::process::exit(2);
        }
    }
}

/// A camera that walks: W A S D, Q and E down and up, shift to run, the mouse to look around.
#[derive(Component)]
pub(crate) struct Walker {
    /// Metres a second.
    pub(crate) speed: f32,
}

/// A camera in the ground floor of a generated tower.
///
/// Bevy's default tones need its feature `tonemapping_luts`, without which everything is pink.
pub(crate) fn walker() -> impl Bundle {
    let at = Transform::from_xyz(9.0, 1.7, 5.0).looking_to(Vec3::X, Vec3::Y);
    (Camera3d::default(), Tonemapping::AcesFitted, at, Walker { speed: 3.0 })
}

/// Moves the walkers.
pub(crate) fn walk(
    time: Res<Time>,
    keys: Res<ButtonInput<KeyCode>>,
    mouse: Res<AccumulatedMouseMotion>,
    mut cursors: Query<&mut CursorOptions>,
    mut walkers: Query<(&Walker, &mut Transform)>,
) {
    if keys.just_pressed(KeyCode::Escape) {
        for mut cursor in &mut cursors {
            cursor.grab_mode = if cursor.visible { CursorGrabMode::Locked } else { CursorGrabMode::None };
            cursor.visible = !cursor.visible;
        }
    }
    let axis = |plus, minus| f32::from(u8::from(keys.pressed(plus))) - f32::from(u8::from(keys.pressed(minus)));
    let run = if keys.pressed(KeyCode::ShiftLeft) { 4.0 } else { 1.0 };
    for (walker, mut at) in &mut walkers {
        let (mut yaw, mut pitch, _) = at.rotation.to_euler(EulerRot::YXZ);
        yaw -= mouse.delta.x * 0.003;
        pitch = (pitch - mouse.delta.y * 0.003).clamp(-1.5, 1.5);
        at.rotation = Quat::from_euler(EulerRot::YXZ, yaw, pitch, 0.0);
        let ahead = Quat::from_rotation_y(yaw);
        let way = ahead * Vec3::new(axis(KeyCode::KeyD, KeyCode::KeyA), 0.0, axis(KeyCode::KeyS, KeyCode::KeyW))
            + Vec3::Y * axis(KeyCode::KeyE, KeyCode::KeyQ);
        at.translation += way.normalize_or_zero() * walker.speed * run * time.delta_secs();
    }
}

/// A sun and some light from everywhere.
pub(crate) fn light(commands: &mut Commands<'_, '_>) {
    commands.insert_resource(GlobalAmbientLight { brightness: 400.0, ..default() });
    commands.spawn((
        DirectionalLight { illuminance: 4000.0, ..default() },
        Transform::default().looking_to(Vec3::new(0.4, -1.0, 0.3), Vec3::Y),
    ));
}
