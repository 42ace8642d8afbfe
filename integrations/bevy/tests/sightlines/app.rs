//! Apps without a window and without a renderer, with everything that visibility needs.

use bevy::asset::{AssetPlugin, LoadState, RecursiveDependencyLoadState};
use bevy::camera::CameraPlugin;
use bevy::camera::visibility::VisibleEntities;
use bevy::diagnostic::DiagnosticsPlugin;
use bevy::gltf::GltfPlugin;
use bevy::image::ImagePlugin;
use bevy::mesh::MeshPlugin;
use bevy::prelude::*;
use bevy::world_serialization::WorldSerializationPlugin;
use bevy_sightlines::pvs::{BitMatrix, CellId, ObjectId, Table, TableParts};
use bevy_sightlines::{PvsCamera, PvsObject, PvsProblem, PvsTable, PvsView, SightlinesPlugin};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// The folder of generated levels.
pub(crate) fn assets() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("assets")
}

/// The bytes of a generated file.
pub(crate) fn bytes(name: &str) -> Vec<u8> {
    let path = assets().join(name);
    std::fs::read(&path).unwrap_or_else(|e| panic!("{}: {e}; make it by `cargo xtask bevy-assets`", path.display()))
}

/// A generated table.
pub(crate) fn table(name: &str) -> Table {
    Table::from_bytes(&bytes(name)).expect("the program writes tables")
}

/// The table, with an object hidden from a cell that sees it.
pub(crate) fn without(table: &Table, cell: CellId, object: ObjectId) -> Table {
    let (n_cells, n_objects) = (table.n_cells(), table.objects().len());
    let mut seen = BitMatrix::new(n_cells, n_objects);
    for from in (0..n_cells as u32).map(CellId) {
        table
            .visible_objects(from)
            .into_iter()
            .for_each(|o| seen.set(from.idx(), o.idx(), (from, o) != (cell, object)));
    }
    let parts = TableParts { objects_seen: Some(seen), ..table.clone().into_parts() };
    Table::new(parts).expect("a row may be shorter")
}

/// An app with everything that visibility needs, in which a frame is an `update`.
pub(crate) fn app() -> App {
    app_in(&assets())
}

/// The same with another folder of assets.
pub(crate) fn app_in(folder: &Path) -> App {
    app_with(folder, |_| {})
}

/// The same with more plugins.
pub(crate) fn app_with(folder: &Path, more: impl FnOnce(&mut App)) -> App {
    app_of(folder, GltfPlugin::default(), more)
}

/// The same with another way to load files.
pub(crate) fn app_of(folder: &Path, gltf: GltfPlugin, more: impl FnOnce(&mut App)) -> App {
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        TransformPlugin,
        DiagnosticsPlugin,
        AssetPlugin { file_path: folder.display().to_string(), watch_for_changes_override: Some(false), ..default() },
        WorldSerializationPlugin,
        ImagePlugin::default(),
        MeshPlugin,
        CameraPlugin,
        gltf,
        SightlinesPlugin,
    ));
    more(&mut app);
    app.finish();
    app.cleanup();
    app
}

/// Spawns a level.
pub(crate) fn spawn_level(app: &mut App, path: &str, at: Transform) -> Entity {
    let scene = app.world().resource::<AssetServer>().load(GltfAssetLabel::Scene(0).from_asset(path.to_owned()));
    app.world_mut().spawn((WorldAssetRoot(scene), at)).id()
}

/// A camera that looks through a wide lens.
pub(crate) fn lens() -> Projection {
    Projection::Perspective(PerspectiveProjection { fov: 1.2, aspect_ratio: 16.0 / 9.0, near: 0.05, ..default() })
}

/// Adds a table as it is.
pub(crate) fn add_table(app: &mut App, table: Table) -> Handle<PvsTable> {
    app.world_mut().resource_mut::<Assets<PvsTable>>().add(PvsTable::new(table))
}

/// Spawns a camera, with a table or without.
pub(crate) fn spawn_camera(app: &mut App, pvs: Option<PvsCamera>) -> Entity {
    let camera = app.world_mut().spawn((Camera3d::default(), Camera::default(), lens(), Transform::default())).id();
    if let Some(pvs) = pvs {
        app.world_mut().entity_mut(camera).insert(pvs);
    }
    camera
}

/// Updates until `done`.
pub(crate) fn until(app: &mut App, what: &str, mut done: impl FnMut(&mut World) -> bool) {
    let begin = Instant::now();
    while !done(app.world_mut()) {
        assert!(begin.elapsed() < Duration::from_secs(120), "waited in vain for {what}");
        app.update();
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Updates until so many meshes of levels are there.
pub(crate) fn until_level(app: &mut App, n_objects: usize) {
    until(app, "a level", |world| world.query::<&PvsObject>().iter(world).count() == n_objects);
    app.update();
}

/// Updates until an asset is there, or has failed.
pub(crate) fn until_loaded(app: &mut App, table: &Handle<PvsTable>) {
    until(app, "a table", |world| {
        let server = world.resource::<AssetServer>();
        matches!(
            (server.get_load_state(table), server.get_recursive_dependency_load_state(table)),
            (Some(LoadState::Failed(_)), _) | (_, Some(RecursiveDependencyLoadState::Loaded))
        )
    });
}

/// Puts cameras somewhere.
pub(crate) fn look(app: &mut App, cameras: &[Entity], at: Transform) {
    for &camera in cameras {
        *app.world_mut().get_mut::<Transform>(camera).expect("a camera has one") = at;
    }
}

/// The meshes that a camera draws.
pub(crate) fn drawn(app: &App, camera: Entity) -> Vec<Entity> {
    let visible = app.world().get::<VisibleEntities>(camera).expect("a camera has one");
    visible.get(std::any::TypeId::of::<Mesh3d>()).to_vec()
}

/// What the plugin notes of a camera.
pub(crate) fn view(app: &App, camera: Entity) -> &PvsView {
    app.world().get::<PvsView>(camera).expect("a camera with a table has one")
}

/// The problems that were reported.
#[derive(Resource, Default)]
pub(crate) struct Problems(pub(crate) Vec<PvsProblem>);

/// Collects the problems that are reported from now on.
pub(crate) fn collect_problems(app: &mut App) {
    app.init_resource::<Problems>().add_systems(
        Last,
        |mut found: MessageReader<PvsProblem>, mut problems: ResMut<Problems>| {
            problems.0.extend(found.read().cloned());
        },
    );
}
