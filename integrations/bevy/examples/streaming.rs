//! A packed table that is read from the disk piece by piece while the camera walks. `cargo xtask bevy-assets` first, then
//! `cargo run --release --example streaming --features packed,overlay`.
//!
//! At most 256 KiB of unpacked blocks and 1 MiB of prepared cells are in memory, whatever the size of the level.

mod support;

use bevy::prelude::*;
use bevy_sightlines::{PvsCamera, PvsOverlayPlugin, PvsTable, SightlinesPlugin};
use std::path::Path;
use support::{light, need, walk, walker};

fn main() {
    need(&["tower16.glb", "tower16.pvz"]);
    App::new()
        .add_plugins((DefaultPlugins, SightlinesPlugin, PvsOverlayPlugin))
        .add_systems(Startup, setup)
        .add_systems(Update, walk)
        .run();
}

fn setup(
    mut commands: Commands<'_, '_>,
    assets: Res<AssetServer>,
    mut tables: ResMut<Assets<PvsTable>>,
) -> Result<(), BevyError> {
    let file = std::fs::File::open(Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/tower16.pvz"))?;
    let table = tables.add(PvsTable::packed(file, 256 << 10)?);
    commands.spawn(WorldAssetRoot(assets.load(GltfAssetLabel::Scene(0).from_asset("tower16.glb"))));
    commands.spawn((walker(), PvsCamera { prepared_bytes: 1 << 20, ..PvsCamera::new(table) }));
    light(&mut commands);
    Ok(())
}
