//! What a frame costs with and without the plugin, with and without Bevy's GPU occlusion culling. `cargo xtask bevy-assets` first, then
//! `cargo run --release --example compare` or `… compare -- LEVEL.glb LEVEL.pvs FRAMES`.
//!
//! Walks through the level with each of the four in turn, without a window, and prints what one thread does in a frame: the main schedule,
//! extraction, the render schedule up to the end of its preparation, and the encoding of the commands. All schedules run on one thread, and on
//! Linux it is the time of that thread on a processor that is counted, so that the load of the machine does not matter much. What the
//! graphics device does is not part of it, and where that is software the device's own threads are not either.

use bevy::camera::RenderTarget;
use bevy::core_pipeline::prepass::DepthPrepass;
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::ecs::schedule::{ScheduleLabel, SingleThreadedExecutor};
use bevy::log::LogPlugin;
use bevy::prelude::*;
use bevy::render::occlusion_culling::OcclusionCulling;
use bevy::render::pipelined_rendering::PipelinedRenderingPlugin;
use bevy::render::render_resource::TextureFormat;
use bevy::render::view::Msaa;
use bevy::render::{ExtractSchedule, Render, RenderApp, RenderPlugin, RenderSystems};
use bevy::window::{ExitCondition, WindowPlugin};
use bevy::winit::WinitPlugin;
use bevy_sightlines::{PvsCamera, PvsState, PvsTable, PvsView, SightlinesPlugin};
use sightlines_eye_to_cell::TableCells;
use sightlines_pvs::Table;
use sightlines_walkthrough::{CameraPose, wander};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::time::{Duration, Instant};

/// Nanoseconds of this thread on a processor; elsewhere than on Linux, of the clock.
fn now() -> u64 {
    static BEGIN: OnceLock<Instant> = OnceLock::new();
    let on_processor = || {
        let stat = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
        stat.split_whitespace().next()?.parse().ok()
    };
    on_processor().unwrap_or_else(|| BEGIN.get_or_init(Instant::now).elapsed().as_nanos() as u64)
}

/// When the preparation of the last frame's rendering ended.
#[derive(Resource, Default)]
struct Prepared(u64);

/// Nanoseconds of all frames together, and what was drawn.
#[derive(Default)]
struct Sums {
    main: u64,
    extract: u64,
    prepare: u64,
    encode: u64,
    drawn: u64,
    plugin: Duration,
    query: Duration,
    late: u32,
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets");
    let level = words.first().map_or_else(|| assets.join("tower16.glb"), PathBuf::from);
    let table = words.get(1).map_or_else(|| assets.join("tower16.pvs"), PathBuf::from);
    let n_frames = words.get(2).and_then(|n| n.parse().ok()).unwrap_or(300);
    let bytes =
        std::fs::read(&table).unwrap_or_else(|e| panic!("{}: {e}; see `cargo xtask bevy-assets`", table.display()));
    let table = Table::from_bytes(&bytes).expect("a table");
    let poses = wander(&TableCells::new(&table), n_frames, 0.05, 5).expect("a table in memory can be read");
    println!(
        "{}: {} objects, {} frames; microseconds of one thread in a frame",
        level.display(),
        table.objects().len(),
        poses.len()
    );
    println!("| | drawn | main | extract | up to prepare | encode | all | of it the plugin | of that the query |");
    println!("| --- | --: | --: | --: | --: | --: | --: | --: | --: |");
    for (name, has_plugin, occludes) in [
        ("Bevy", false, false),
        ("with the plugin", true, false),
        ("with GPU occlusion culling", false, true),
        ("with both", true, true),
    ] {
        let sums = walk(&level, &table, &poses, has_plugin, occludes);
        let mean = |ns: u64| ns as f64 / 1e3 / poses.len() as f64;
        let [plugin, query] = [sums.plugin, sums.query].map(|t| t.as_secs_f64() * 1e6 / poses.len() as f64);
        println!(
            "| {name} | {:.0} | {:.0} | {:.0} | {:.0} | {:.0} | {:.0} | {:.1} | {:.1} |",
            sums.drawn as f64 / poses.len() as f64,
            mean(sums.main),
            mean(sums.extract),
            mean(sums.prepare),
            mean(sums.encode),
            mean(sums.main + sums.extract + sums.prepare + sums.encode),
            plugin,
            query,
        );
        if sums.late > 0 {
            println!("  {} frames came before their cell was prepared", sums.late);
        }
    }
}

fn on_one_thread(app: &mut SubApp, label: impl ScheduleLabel) {
    app.edit_schedule(label, |schedule| {
        schedule.set_executor(SingleThreadedExecutor::new());
    });
}

fn walk(level: &Path, table: &Table, poses: &[CameraPose], has_plugin: bool, occludes: bool) -> Sums {
    let folder = level.parent().expect("a file is in a folder").canonicalize().expect("the folder is there");
    let file = level.file_name().expect("a file has a name").to_string_lossy().into_owned();
    let mut app = App::new();
    app.add_plugins(
        DefaultPlugins
            .build()
            .disable::<WinitPlugin>()
            .disable::<LogPlugin>()
            .disable::<PipelinedRenderingPlugin>()
            .set(WindowPlugin { primary_window: None, exit_condition: ExitCondition::DontExit, ..default() })
            .set(AssetPlugin { file_path: folder.display().to_string(), ..default() })
            .set(RenderPlugin { synchronous_pipeline_compilation: true, ..default() }),
    );
    if has_plugin {
        app.add_plugins(SightlinesPlugin);
    }
    app.finish();
    app.cleanup();
    let scene = app.world().resource::<AssetServer>().load(GltfAssetLabel::Scene(0).from_asset(file));
    app.world_mut().spawn(WorldAssetRoot(scene));
    app.world_mut().spawn((
        DirectionalLight { shadow_maps_enabled: false, ..default() },
        Transform::default().looking_to(Vec3::new(0.4, -1.0, 0.3), Vec3::Y),
    ));
    let image = Image::new_target_texture(64, 36, TextureFormat::Rgba8UnormSrgb, None);
    let image = app.world_mut().resource_mut::<Assets<Image>>().add(image);
    let lens = Projection::Perspective(PerspectiveProjection { fov: 1.0, near: 0.05, ..default() });
    let target = RenderTarget::Image(image.into());
    let camera = app.world_mut().spawn((Camera3d::default(), target, lens, Tonemapping::None, Msaa::Off)).id();
    if has_plugin {
        let handle = app.world_mut().resource_mut::<Assets<PvsTable>>().add(PvsTable::new(table.clone()));
        app.world_mut().entity_mut(camera).insert(PvsCamera::new(handle));
    }
    if occludes {
        app.world_mut().entity_mut(camera).insert((DepthPrepass, OcclusionCulling));
    }
    let n_objects = table.objects().len();
    let mut objects = app.world_mut().query::<&Mesh3d>();
    let begin = Instant::now();
    while objects.iter(app.world()).count() < n_objects {
        assert!(begin.elapsed() < Duration::from_secs(300), "the level is not loaded");
        app.update();
    }
    for label in [First.intern(), PreUpdate.intern(), Update.intern(), PostUpdate.intern(), Last.intern()] {
        on_one_thread(app.main_mut(), label);
    }
    let render = app.get_sub_app_mut(RenderApp).expect("there is a renderer");
    on_one_thread(render, ExtractSchedule);
    render.init_resource::<Prepared>().add_systems(
        Render,
        (|mut prepared: ResMut<Prepared>| prepared.0 = now())
            .after(RenderSystems::Prepare)
            .before(RenderSystems::Render),
    );
    on_one_thread(render, Render);
    let mut sums = Sums::default();
    let mut render = app.remove_sub_app(RenderApp).expect("there is a renderer");
    // The first frames send the level to the device.
    let first = std::iter::repeat_n(&poses[0], 30);
    for (k, pose) in first.chain(poses).enumerate() {
        let [eye, dir] = [pose.eye, pose.dir].map(|v| Vec3::from_array(v.map(|x| x as f32)));
        *app.world_mut().get_mut::<Transform>(camera).expect("it has one") =
            Transform::from_translation(eye).looking_to(dir, Vec3::Y);
        let begin = now();
        app.main_mut().run_default_schedule();
        let simulated = now();
        render.extract(app.world_mut());
        let extracted = now();
        render.update();
        let encoded = now();
        app.world_mut().clear_trackers();
        if k < 30 {
            continue;
        }
        let prepared = render.world().resource::<Prepared>().0;
        sums.main += simulated - begin;
        sums.extract += extracted - simulated;
        sums.prepare += prepared - extracted;
        sums.encode += encoded - prepared;
        let visible = app.world().get::<bevy::camera::visibility::VisibleEntities>(camera).expect("it has one");
        sums.drawn += visible.len(std::any::TypeId::of::<Mesh3d>()) as u64;
        if let Some(view) = app.world().get::<PvsView>(camera) {
            sums.plugin += view.all;
            sums.query += view.query;
            sums.late += u32::from(view.state == PvsState::Late);
        }
    }
    sums
}
