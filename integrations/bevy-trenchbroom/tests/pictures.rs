//! A Quake map with and without its table: the same pictures to the last bit, with fewer meshes drawn.
//!
//! Reads `quake/e1m1.bsp` in the folder that SIGHTLINES_DATA names, and its table `assets/e1m1.pvs`, made by `cargo xtask bevy-trenchbroom`. Needs a Vulkan device, which
//! may be one in software.

use bevy::camera::RenderTarget;
use bevy::camera::visibility::VisibleEntities;
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::log::LogPlugin;
use bevy::prelude::*;
use bevy::render::gpu_readback::{Readback, ReadbackComplete};
use bevy::render::pipelined_rendering::PipelinedRenderingPlugin;
use bevy::render::render_resource::{PollType, TextureFormat, TextureUsages};
use bevy::render::renderer::RenderDevice;
use bevy::render::view::Msaa;
use bevy::render::{RenderApp, RenderPlugin};
use bevy::window::{ExitCondition, WindowPlugin};
use bevy::winit::WinitPlugin;
use bevy_sightlines::pvs::{BitMatrix, CellId, ObjectId, Table, TableParts};
use bevy_sightlines::{PvsCamera, PvsMover, PvsParts, PvsScene, PvsState, PvsTable, PvsView, SightlinesPlugin};
use bevy_sightlines_trenchbroom::{PvsMap, PvsMapCut, TrenchBroomPvsPlugin};
use bevy_trenchbroom::bevy_materialize::generic_material::GenericMaterial3d;
use bevy_trenchbroom::bsp::Bsp;
use bevy_trenchbroom::class::builtin::BspSolidEntity;
use bevy_trenchbroom::config::WriteTrenchBroomConfigOnStartPlugin;
use bevy_trenchbroom::prelude::*;
use sightlines_eye_to_cell::TableCells;
use sightlines_pvs::PlaceBuffer;
use sightlines_walkthrough::{CameraPose, wander};
use std::collections::BTreeSet;
use std::path::Path;
use std::time::{Duration, Instant};

/// Size of the pictures: rows of 64 pixels or a multiple come without padding.
const SIZE: UVec2 = UVec2::new(192, 108);
/// Frames of the walk.
const N: usize = 100;
/// Units of the map between frames.
const STEP: f64 = 48.0;

/// Something of the map that is not of its world.
#[solid_class(base(BspSolidEntity, Visibility))]
#[derive(Debug, Clone)]
struct FuncDoor;

/// The pictures of a camera, in the order in which they were drawn.
#[derive(Component, Default)]
struct Pictures(Vec<Vec<u8>>);

fn app(folder: &Path) -> App {
    let config = TrenchBroomConfig::new("test").suppress_invalid_entity_definitions(true).no_bsp_lighting(true);
    let mut app = App::new();
    app.add_plugins((
        DefaultPlugins
            .build()
            .disable::<WinitPlugin>()
            .disable::<LogPlugin>()
            .disable::<PipelinedRenderingPlugin>()
            .set(WindowPlugin { primary_window: None, exit_condition: ExitCondition::DontExit, ..default() })
            .set(AssetPlugin { file_path: folder.display().to_string(), ..default() })
            .set(RenderPlugin { synchronous_pipeline_compilation: true, ..default() }),
        TrenchBroomPlugins(config).build().disable::<WriteTrenchBroomConfigOnStartPlugin>(),
        SightlinesPlugin,
        TrenchBroomPvsPlugin,
    ));
    app.finish();
    app.cleanup();
    app
}

/// A frame, until the device has ended it.
fn frame(app: &mut App) {
    app.update();
    let device = app.sub_app(RenderApp).world().resource::<RenderDevice>();
    device.poll(PollType::wait_indefinitely()).expect("the device ends its work");
}

/// Colors of meshes: enough that one that is missing shows what is behind it, and few enough to draw them at once.
const N_PAINTS: u32 = 127;

/// Loads the map, and paints every part and every door.
fn load(app: &mut App) -> Entity {
    let assets = app.world().resource::<AssetServer>();
    let (scene, map) = (assets.load("e1m1.bsp#Scene"), assets.load("e1m1.bsp"));
    app.world_mut().spawn((WorldAssetRoot(scene), PvsMap::new(map)));
    let begin = Instant::now();
    let mut parts = app.world_mut().query::<&PvsParts>();
    while parts.iter(app.world()).len() == 0 {
        assert!(begin.elapsed() < Duration::from_secs(120), "the map is not loaded");
        app.update();
    }
    (0..10).for_each(|_| app.update());
    let shown: Vec<Entity> = app.world_mut().query_filtered::<Entity, With<Mesh3d>>().iter(app.world()).collect();
    for &entity in &shown {
        app.world_mut().entity_mut(entity).remove::<GenericMaterial3d>();
    }
    app.update();
    let paints: Vec<Handle<StandardMaterial>> = (1..=N_PAINTS)
        .map(|k| {
            let bits = k.wrapping_mul(0x9E37_79B1);
            let base_color = Color::srgb_u8((bits >> 24) as u8 | 16, (bits >> 16) as u8, (bits >> 8) as u8);
            let paint = StandardMaterial { base_color, unlit: true, cull_mode: None, ..default() };
            app.world_mut().resource_mut::<Assets<StandardMaterial>>().add(paint)
        })
        .collect();
    for (entity, paint) in shown.into_iter().zip(paints.iter().cycle()) {
        app.world_mut().entity_mut(entity).insert(MeshMaterial3d(paint.clone()));
    }
    app.world_mut().query_filtered::<Entity, With<PvsScene>>().single(app.world()).expect("one map")
}

/// A camera that draws into an image which is read back. Its near plane is as good as in its eye.
fn camera(app: &mut App, table: Option<Table>) -> Entity {
    let mut image = Image::new_target_texture(SIZE.x, SIZE.y, TextureFormat::Rgba8UnormSrgb, None);
    image.texture_descriptor.usage |= TextureUsages::COPY_SRC;
    let image = app.world_mut().resource_mut::<Assets<Image>>().add(image);
    let camera = app.world_mut().spawn((
        Camera3d::default(),
        Camera { clear_color: ClearColorConfig::Custom(Color::BLACK), ..default() },
        RenderTarget::Image(image.clone().into()),
        Projection::Perspective(PerspectiveProjection { fov: 1.2, near: 0.000_01, ..default() }),
        Tonemapping::None,
        Msaa::Off,
        Readback::texture(image),
        Pictures::default(),
    ));
    let camera = camera.id();
    app.world_mut().entity_mut(camera).observe(|read: On<ReadbackComplete>, mut pictures: Query<&mut Pictures>| {
        if let Ok(mut pictures) = pictures.get_mut(read.entity) {
            pictures.0.push(read.data.clone());
        }
    });
    if let Some(table) = table {
        let table = app.world_mut().resource_mut::<Assets<PvsTable>>().add(PvsTable::new(table));
        app.world_mut().entity_mut(camera).insert(PvsCamera::new(table).without_thread());
    }
    camera
}

fn put(app: &mut App, level: Entity, camera: Entity, pose: &CameraPose) {
    let place = app.world().get::<GlobalTransform>(level).expect("it has one").affine();
    let [eye, dir] = [pose.eye, pose.dir].map(|v| Vec3::from_array(v.map(|x| x as f32)));
    *app.world_mut().get_mut::<Transform>(camera).expect("it has one") =
        Transform::from_translation(place.transform_point3(eye)).looking_to(place.transform_vector3(dir), Vec3::Y);
}

fn n_meshes(app: &App, camera: Entity) -> usize {
    let visible = app.world().get::<VisibleEntities>(camera).expect("it has one");
    visible.get(std::any::TypeId::of::<Mesh3d>()).len()
}

/// The table, with everything hidden from some cells that is not in them.
fn blind(table: &Table, from: &BTreeSet<CellId>) -> Table {
    let mut seen = BitMatrix::new(table.n_cells(), table.objects().len());
    for cell in (0..table.n_cells() as u32).map(CellId) {
        let own: BTreeSet<ObjectId> = table.objects_of(cell).iter().copied().collect();
        for object in table.visible_objects(cell) {
            seen.set(cell.idx(), object.idx(), !from.contains(&cell) || own.contains(&object));
        }
    }
    Table::new(TableParts { objects_seen: Some(seen), ..table.clone().into_parts() }).expect("rows may be shorter")
}

/// Each triangle of the world is in one part, and each part shows the faces that its triangles are of.
fn check_parts(app: &mut App) {
    let world = app.world_mut();
    let cuts: Vec<PvsMapCut> = world.query_filtered::<&PvsMapCut, Without<PvsMover>>().iter(world).copied().collect();
    assert!(cuts.iter().all(|cut| cut.n_loose == 0 && cut.n_parts > 0), "{cuts:?}");
    let parts: Vec<(u32, Vec<u32>)> = {
        let mut parts = world.query::<(&PvsParts, &Mesh3d)>();
        let meshes = world.resource::<Assets<Mesh>>();
        let n = |mesh: &Mesh3d| meshes.get(&mesh.0).expect("it is kept").count_vertices() as u32 / 3;
        parts.iter(world).map(|(parts, mesh)| (n(mesh), parts.sources.clone())).collect()
    };
    let (bsps, n_parts) = (world.resource::<Assets<Bsp>>(), cuts.iter().map(|cut| cut.n_parts as usize).sum::<usize>());
    let (_, bsp) = bsps.iter().next().expect("one map");
    let model = &bsp.data.models[0];
    let faces = (model.first_face..model.first_face + model.num_faces).map(|k| &bsp.data.faces[k as usize]);
    let n_triangles: u32 = faces.map(|face| face.num_edges.0 - 2).sum();
    assert_eq!(parts.len(), n_parts);
    assert_eq!(parts.iter().map(|(n, _)| n).sum::<u32>(), n_triangles);
    let mut shown: Vec<u32> = parts.iter().flat_map(|(_, faces)| faces.clone()).collect();
    shown.sort_unstable();
    assert_eq!(shown, (0..model.num_faces).collect::<Vec<u32>>());
    let n_movers = world.query::<&PvsMover>().iter(world).count();
    assert!(n_movers > 10, "the map has doors");
    println!(
        "{} meshes of the world in {n_parts} parts, {n_triangles} triangles, {n_movers} meshes of doors",
        cuts.len()
    );
}

#[test]
fn pictures_of_a_map_are_the_same_with_fewer_meshes() {
    let Some(data) = std::env::var_os("SIGHTLINES_DATA") else {
        println!("NOT RUN: SIGHTLINES_DATA has no folder of real maps");
        return;
    };
    if std::env::var_os("SIGHTLINES_GPU").is_some_and(|wish| wish == "off") {
        println!("NOT RUN: no GPU was to be looked for (SIGHTLINES_GPU=off)");
        return;
    }
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/e1m1.pvs");
    let bytes = std::fs::read(&file).expect("made by `cargo xtask bevy-trenchbroom`");
    let table = Table::from_bytes(&bytes).expect("a table");
    let mut app = app(&Path::new(&data).join("quake"));
    let level = load(&mut app);
    check_parts(&mut app);

    let poses = wander(&TableCells::new(table.clone()), N, STEP, 11).expect("a table in memory can be read");
    let mut buffer = PlaceBuffer::new();
    let at = |pose: &CameraPose, buffer: &mut PlaceBuffer| table.cells_at(pose.eye, buffer).inside().map(<[_]>::to_vec);
    let last: BTreeSet<CellId> = at(&poses[N - 1], &mut buffer).expect("a walk is inside").into_iter().collect();
    let cameras = [Some(table.clone()), None, Some(blind(&table, &last))].map(|table| camera(&mut app, table));
    cameras.iter().for_each(|camera| put(&mut app, level, *camera, &poses[0]));
    for _ in 0..10 {
        frame(&mut app);
    }
    let (mut inside, mut bevy, mut drawn) = (0, 0, 0);
    let (mut different, mut impostor, mut scenes) = (0, 0, BTreeSet::new());
    for pose in &poses {
        cameras.iter().for_each(|camera| put(&mut app, level, *camera, pose));
        // The second frame brings the picture of the first.
        frame(&mut app);
        let state = app.world().get::<PvsView>(cameras[0]).expect("it has one").state;
        inside += usize::from(matches!(state, PvsState::Inside | PvsState::Late));
        bevy += n_meshes(&app, cameras[1]);
        drawn += n_meshes(&app, cameras[0]);
        frame(&mut app);
        let [cut, whole, blind] = cameras.map(|camera| {
            let mut read = app.world_mut().get_mut::<Pictures>(camera).expect("it has some");
            let picture = read.0.pop().expect("one for each frame");
            read.0.clear();
            picture
        });
        assert_eq!(cut.len(), 4 * (SIZE.x * SIZE.y) as usize);
        different += usize::from(cut != whole);
        impostor += usize::from(blind != whole);
        let colors: BTreeSet<&[u8]> = cut.chunks_exact(4).collect();
        if colors.len() > 10 {
            scenes.insert(cut);
        }
    }
    let scenes = scenes.len();
    println!(
        "{N} frames, {inside} inside, {scenes} scenes: {drawn} of {bevy} meshes drawn, {different} pictures differ, {impostor} with the impostor"
    );
    assert_eq!((inside, different), (N, 0));
    assert!(scenes > N / 2 && drawn * 2 < bevy && impostor > 0);
}
