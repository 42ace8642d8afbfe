//! Cameras that draw into images, and their pictures. Needs a Vulkan device, which may be one in software.

use bevy::camera::RenderTarget;
use bevy::camera::visibility::VisibleEntities;
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::log::LogPlugin;
use bevy::pbr::{MeshMaterial3d, StandardMaterial};
use bevy::prelude::*;
use bevy::render::gpu_readback::{Readback, ReadbackComplete};
use bevy::render::pipelined_rendering::PipelinedRenderingPlugin;
use bevy::render::render_resource::{Face, PollType, TextureFormat, TextureUsages};
use bevy::render::renderer::RenderDevice;
use bevy::render::view::Msaa;
use bevy::render::{RenderApp, RenderPlugin};
use bevy::window::{ExitCondition, WindowPlugin};
use bevy::winit::WinitPlugin;
use bevy_sightlines::{PvsCamera, PvsObject, PvsState, PvsView, SightlinesPlugin};
use sightlines_walkthrough::CameraPose;
use std::path::Path;
use std::time::{Duration, Instant};

/// Size of the pictures: rows of 64 pixels or a multiple come without padding.
pub(crate) const SIZE: UVec2 = UVec2::new(192, 108);

/// The angle of view from top to bottom, in radians.
pub(crate) const FOV: f64 = 1.2;

/// Whether there is to be a device; says so where there is none.
pub(crate) fn has_device() -> bool {
    let wish = std::env::var("SIGHTLINES_GPU").unwrap_or_default();
    if wish == "off" {
        println!("NOT RUN: no GPU was to be looked for (SIGHTLINES_GPU=off)");
    }
    wish != "off"
}

/// The pictures of a camera, in the order in which they were drawn.
#[derive(Component, Default)]
struct Pictures(Vec<Vec<u8>>);

/// An app with a renderer and without a window.
pub(crate) fn app(folder: &Path) -> App {
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
        SightlinesPlugin,
    ));
    app.finish();
    app.cleanup();
    app
}

/// A camera that draws into an image which is read back. Its near plane is as good as in its eye: one that cuts a wall open shows what is
/// behind it, of which the table knows nothing.
pub(crate) fn camera(app: &mut App, pvs: Option<PvsCamera>) -> Entity {
    let mut image = Image::new_target_texture(SIZE.x, SIZE.y, TextureFormat::Rgba8UnormSrgb, None);
    image.texture_descriptor.usage |= TextureUsages::COPY_SRC;
    let image = app.world_mut().resource_mut::<Assets<Image>>().add(image);
    let lens = Projection::Perspective(PerspectiveProjection { fov: FOV as f32, near: 0.000_01, ..default() });
    let camera = app.world_mut().spawn((
        Camera3d::default(),
        Camera { clear_color: ClearColorConfig::Custom(Color::BLACK), ..default() },
        RenderTarget::Image(image.clone().into()),
        lens,
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
    if let Some(pvs) = pvs {
        app.world_mut().entity_mut(camera).insert(pvs);
    }
    camera
}

/// A color that no other mesh has.
pub(crate) fn color(k: u32) -> Color {
    let bits = (k + 1).wrapping_mul(0x9E37_79B1);
    Color::srgb_u8((bits >> 24) as u8 | 16, (bits >> 16) as u8, (bits >> 8) as u8)
}

/// Which sides of faces are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Sides {
    /// As the materials that the objects have now.
    AsLoaded,
    Both,
}

/// The pictures of a camera that have been read.
fn pictures(app: &mut App, camera: Entity) -> &mut Vec<Vec<u8>> {
    &mut app.world_mut().get_mut::<Pictures>(camera).expect("it has some").into_inner().0
}

/// A frame, until the device has ended it. So the pictures of all cameras come equally late, and the k-th of each are of one frame, however
/// slow the device is. Without, an app that is dropped gives the device some seconds, and panics then.
fn frame(app: &mut App) {
    app.update();
    let device = app.sub_app(RenderApp).world().resource::<RenderDevice>();
    device.poll(PollType::wait_indefinitely()).expect("the device ends its work");
}

/// Puts a camera somewhere.
fn put(app: &mut App, camera: Entity, pose: &CameraPose) {
    let [eye, dir] = [pose.eye, pose.dir].map(|v| Vec3::from_array(v.map(|x| x as f32)));
    *app.world_mut().get_mut::<Transform>(camera).expect("it has one") =
        Transform::from_translation(eye).looking_to(dir, Vec3::Y);
}

/// Loads the level of so many objects.
pub(crate) fn load(app: &mut App, n_objects: usize) {
    let level = app.world().resource::<AssetServer>().load(GltfAssetLabel::Scene(0).from_asset("level.glb"));
    app.world_mut().spawn(WorldAssetRoot(level));
    let begin = Instant::now();
    let mut objects = app.world_mut().query::<(Entity, &PvsObject)>();
    while objects.iter(app.world()).count() < n_objects {
        assert!(begin.elapsed() < Duration::from_secs(120), "the level is not loaded");
        app.update();
    }
}

/// Gives each object a color of its own.
pub(crate) fn paint_all(app: &mut App, sides: Sides) {
    let mut objects = app.world_mut().query::<(Entity, &PvsObject)>();
    let all: Vec<(Entity, u32)> = objects.iter(app.world()).map(|(entity, object)| (entity, object.source)).collect();
    for (entity, source) in all {
        let loaded = app.world().get::<MeshMaterial3d<StandardMaterial>>(entity).expect("it has one");
        let loaded = app.world().resource::<Assets<StandardMaterial>>().get(loaded).expect("it was loaded");
        let cull_mode = if sides == Sides::Both { None } else { loaded.cull_mode };
        let material = paint(app, source, cull_mode);
        app.world_mut().entity_mut(entity).insert(MeshMaterial3d(material));
    }
}

/// A material of a color that no other has.
pub(crate) fn paint(app: &mut App, k: u32, cull_mode: Option<Face>) -> Handle<StandardMaterial> {
    let material = StandardMaterial { base_color: color(k), unlit: true, cull_mode, ..default() };
    app.world_mut().resource_mut::<Assets<StandardMaterial>>().add(material)
}

/// Some first frames, which send everything to the device.
pub(crate) fn start<const N: usize>(app: &mut App, cameras: [Entity; N], pose: &CameraPose) {
    cameras.iter().for_each(|camera| put(app, *camera, pose));
    (0..10).for_each(|_| frame(app));
    cameras.iter().for_each(|camera| pictures(app, *camera).clear());
}

/// The pictures of a view by some cameras.
pub(crate) fn take<const N: usize>(app: &mut App, cameras: [Entity; N], pose: &CameraPose) -> [Vec<u8>; N] {
    cameras.iter().for_each(|camera| put(app, *camera, pose));
    // The second frame brings the picture of the first.
    frame(app);
    frame(app);
    cameras.map(|camera| {
        let taken = pictures(app, camera);
        let last = taken.pop().expect("one for each frame");
        taken.clear();
        last
    })
}

/// The pictures of some views by some cameras, a frame for each view. After the k-th frame `look` is called with k.
pub(crate) fn take_all<const N: usize>(
    app: &mut App,
    cameras: [Entity; N],
    poses: &[CameraPose],
    mut look: impl FnMut(&App, usize),
) -> Vec<[Vec<u8>; N]> {
    start(app, cameras, &poses[0]);
    for (k, pose) in poses.iter().enumerate() {
        cameras.iter().for_each(|camera| put(app, *camera, pose));
        frame(app);
        look(app, k);
    }
    // Each frame brings the pictures of the one before.
    frame(app);
    let mut lists = cameras.map(|camera| {
        let taken = pictures(app, camera).split_off(1);
        assert!(taken.iter().all(|picture| picture.len() == 4 * (SIZE.x * SIZE.y) as usize));
        assert_eq!(taken.len(), poses.len());
        taken.into_iter()
    });
    let all: Vec<[Vec<u8>; N]> =
        poses.iter().map(|_| lists.each_mut().map(|list| list.next().expect("one for each pose"))).collect();
    // None comes earlier or later than that: one that differs from its neighbours is the same when taken alone.
    let differs = |k: usize| all[k] != all[k - 1] && all[k] != all[k + 1];
    let k = (1..all.len() - 1).find(|k| differs(*k)).expect("not everything looks the same");
    assert!(take(app, cameras, &poses[k]) == all[k], "{k}");
    all
}

/// Whether a camera with a table was in a cell in the last frame.
pub(crate) fn is_inside(app: &App, camera: Entity) -> bool {
    matches!(app.world().get::<PvsView>(camera).expect("it has one").state, PvsState::Inside | PvsState::Late)
}

/// Number of pixels that two pictures do not share.
pub(crate) fn n_different(a: &[u8], b: &[u8]) -> usize {
    a.chunks_exact(4).zip(b.chunks_exact(4)).filter(|(a, b)| a != b).count()
}

/// The meshes that a camera draws.
pub(crate) fn meshes(app: &App, camera: Entity) -> &[Entity] {
    let visible = app.world().get::<VisibleEntities>(camera).expect("it has one");
    visible.get(std::any::TypeId::of::<Mesh3d>())
}

/// A folder with the level under the name that the walk loads.
pub(crate) fn folder_of(glb: &[u8], name: &str) -> std::path::PathBuf {
    let folder = std::env::temp_dir().join(format!("bevy-sightlines-{}-{name}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    std::fs::write(folder.join("level.glb"), glb).expect("a file");
    folder
}
