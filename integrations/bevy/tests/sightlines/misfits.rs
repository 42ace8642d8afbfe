//! Tables that are missing, broken, or of another level: everything is drawn, and there is one warning. And what happens while levels come
//! and go.

use crate::app::*;
use bevy::camera::primitives::{Aabb, Frustum, Sphere};
use bevy::camera::visibility::{NoCpuCulling, NoFrustumCulling};
use bevy::prelude::*;
use bevy_sightlines::pvs::{ObjectSource, Table, TableParts};
use bevy_sightlines::{
    PvsCamera, PvsChanged, PvsMisfit, PvsMover, PvsObject, PvsProblemKind, PvsScene, PvsState, PvsTable,
};

/// A place in the first floor of the tower, and a view across it.
fn here() -> Transform {
    Transform::from_xyz(9.0, 1.7, 5.0).looking_to(Vec3::new(1.0, -0.1, 0.2), Vec3::Y)
}

/// An app with the tower, a camera with a table, and one without, both in the same place.
fn two(table: impl FnOnce(&mut App) -> Handle<PvsTable>) -> (App, Entity, Entity) {
    let mut app = app();
    collect_problems(&mut app);
    let handle = table(&mut app);
    spawn_level(&mut app, "tower.glb", Transform::IDENTITY);
    until_level(&mut app, crate::app::table("tower.pvs").objects().len());
    let (cut, whole) =
        (spawn_camera(&mut app, Some(PvsCamera::new(handle).without_thread())), spawn_camera(&mut app, None));
    look(&mut app, &[cut, whole], here());
    for _ in 0..100 {
        app.update();
    }
    (app, cut, whole)
}

fn problems(app: &App) -> Vec<PvsProblemKind> {
    app.world().resource::<Problems>().0.iter().map(|problem| problem.what.clone()).collect()
}

fn fits(app: &mut App) -> Handle<PvsTable> {
    add_table(app, table("tower.pvs"))
}

#[test]
fn a_table_from_a_file_culls() {
    let (mut app, cut, whole) = two(|app| app.world().resource::<AssetServer>().load("tower.pvs"));
    until(&mut app, "the table", |world| {
        world.query::<&bevy_sightlines::PvsView>().iter(world).any(|view| view.state == PvsState::Inside)
    });
    app.update();
    assert!(drawn(&app, cut).len() < drawn(&app, whole).len() / 2);
    assert_eq!(problems(&app), []);
    let noted = view(&app, cut);
    assert!(!noted.at().is_empty() && noted.cells().len() >= noted.at().len() && noted.level.is_some());
}

#[test]
fn without_a_table_everything_is_drawn_and_one_warning_is_given() {
    for (name, content) in [("missing.pvs", None), ("broken.pvs", Some(&b"no table"[..]))] {
        let folder = std::env::temp_dir().join(format!("bevy-sightlines-{}-{name}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        std::fs::copy(assets().join("tower.glb"), folder.join("tower.glb")).expect("a copy");
        if let Some(content) = content {
            std::fs::write(folder.join(name), content).expect("a file");
        }
        let mut app = app_in(&folder);
        collect_problems(&mut app);
        let handle = app.world().resource::<AssetServer>().load(name);
        spawn_level(&mut app, "tower.glb", Transform::IDENTITY);
        until_level(&mut app, table("tower.pvs").objects().len());
        until_loaded(&mut app, &handle);
        let (cut, whole) = (spawn_camera(&mut app, Some(PvsCamera::new(handle))), spawn_camera(&mut app, None));
        look(&mut app, &[cut, whole], here());
        for _ in 0..100 {
            app.update();
        }
        assert_eq!(drawn(&app, cut), drawn(&app, whole));
        assert_eq!(problems(&app), [PvsProblemKind::NotLoaded]);
        assert_eq!(view(&app, cut).state, PvsState::NoTable);
        let server = app.world().resource::<AssetServer>();
        let state = server.get_load_state(&app.world().get::<PvsCamera>(cut).expect("it has one").table);
        let Some(bevy::asset::LoadState::Failed(error)) = state else { panic!("{state:?}") };
        assert!(error.to_string().contains(name), "{error}");
        std::fs::remove_dir_all(&folder).expect("it is ours");
    }
}

#[test]
fn with_a_table_of_another_level_everything_is_drawn_and_one_warning_is_given() {
    let n = table("tower.pvs").objects().len();
    let other_name = |app: &mut App| {
        let mut parts = table("tower.pvs").into_parts();
        parts.objects[3].name = "a name".to_owned();
        add_table(app, Table::new(parts).expect("names are free"))
    };
    let other_place = |app: &mut App| {
        let mut parts = table("tower.pvs").into_parts();
        (parts.objects[5].min[1], parts.objects[5].max[1]) =
            (parts.objects[5].min[1] + 0.25, parts.objects[5].max[1] + 0.25);
        add_table(app, Table::new(parts).expect("boxes are free"))
    };
    // As older files have it: without the nodes of the objects.
    let fewer = |app: &mut App| {
        let parts = TableParts { object_sources: Vec::new(), ..table("small.pvs").into_parts() };
        add_table(app, Table::new(parts).expect("sources are free"))
    };
    let other_nodes = |app: &mut App| {
        let mut parts = table("tower.pvs").into_parts();
        parts.object_sources[7] = parts.object_sources[7].map(|source| ObjectSource { node: 100_000, ..source });
        add_table(app, Table::new(parts).expect("sources are free"))
    };
    let small = |app: &mut App| add_table(app, table("small.pvs"));
    let kinds =
        [two(fewer), two(other_name), two(other_place), two(other_nodes), two(small)].map(|(app, cut, whole)| {
            assert_eq!(drawn(&app, cut), drawn(&app, whole));
            assert_eq!(view(&app, cut).state, PvsState::NoLevel);
            let [PvsProblemKind::NoLevel(misfit)] = &problems(&app)[..] else { panic!("{:?}", problems(&app)) };
            misfit.clone()
        });
    let n_small = table("small.pvs").objects().len();
    assert_eq!(kinds[0], PvsMisfit::Count { table: n_small, scene: n });
    assert!(matches!(&kinds[1], PvsMisfit::Name { object: 3, table, .. } if table == "a name"), "{:?}", kinds[1]);
    assert!(matches!(&kinds[2], PvsMisfit::Place { object: 5, .. }), "{:?}", kinds[2]);
    assert!(matches!(&kinds[3], PvsMisfit::Missing { object: 7, .. }), "{:?}", kinds[3]);
}

/// A table for engines that draw backs does not fit a level with single-sided materials, of which Bevy draws none.
#[test]
fn tables_for_engines_that_draw_backs_are_warned_of() {
    for (backs, is_single_sided, expected) in [
        (Some("drawn"), true, &[PvsProblemKind::BacksDrawn][..]),
        (Some("drawn"), false, &[]),
        (Some("culled"), true, &[]),
        (None, true, &[]),
    ] {
        let mut app = app();
        collect_problems(&mut app);
        let mut parts = table("tower.pvs").into_parts();
        parts.info.extend(backs.map(|backs| ("backs".to_owned(), backs.to_owned())));
        parts.info.sort();
        let handle = add_table(&mut app, Table::new(parts).expect("information is free"));
        spawn_level(&mut app, "tower.glb", Transform::IDENTITY);
        until_level(&mut app, table("tower.pvs").objects().len());
        let mut scenes = app.world_mut().query::<&mut PvsScene>();
        for mut scene in scenes.iter_mut(app.world_mut()) {
            scene.sources.iter_mut().for_each(|mesh| mesh.is_single_sided = is_single_sided);
        }
        let cut = spawn_camera(&mut app, Some(PvsCamera::new(handle).without_thread()));
        look(&mut app, &[cut], here());
        for _ in 0..3 {
            app.update();
        }
        assert_eq!(problems(&app), expected, "{backs:?}");
        assert_eq!(view(&app, cut).state, PvsState::Inside);
    }
}

#[test]
fn a_table_is_loaded_again_while_the_camera_is_there() {
    let (mut app, cut, whole) = two(fits);
    let before = drawn(&app, cut);
    assert!(before.len() < drawn(&app, whole).len());
    let handle = app.world().get::<PvsCamera>(cut).expect("it has one").table.clone();
    // One that does not fit, then the first one again.
    for (content, is_cut) in [("small.pvs", false), ("tower.pvs", true)] {
        let again = PvsTable::new(table(content));
        app.world_mut().resource_mut::<Assets<PvsTable>>().insert(&handle, again).expect("a handle is there");
        app.update();
        app.update();
        let now = drawn(&app, cut);
        assert_eq!(now, if is_cut { before.clone() } else { drawn(&app, whole) }, "{content}");
    }
}

#[test]
fn a_level_goes_and_comes_again() {
    let (mut app, cut, whole) = two(fits);
    let before = drawn(&app, cut).len();
    let mut roots = app.world_mut().query_filtered::<Entity, With<WorldAssetRoot>>();
    let level = roots.single(app.world()).expect("one level");
    app.world_mut().despawn(level);
    app.update();
    assert_eq!((drawn(&app, cut), view(&app, cut).state), (Vec::new(), PvsState::NoLevel));
    spawn_level(&mut app, "tower.glb", Transform::IDENTITY);
    until_level(&mut app, table("tower.pvs").objects().len());
    app.update();
    assert_eq!(drawn(&app, cut).len(), before);
    assert!(before < drawn(&app, whole).len());
    assert_eq!(problems(&app), []);
}

#[test]
fn what_is_taken_out_of_the_level_is_taken_out_of_the_lists_only() {
    let (mut app, cut, _) = two(fits);
    let before = drawn(&app, cut);
    app.world_mut().despawn(before[0]);
    app.world_mut().entity_mut(before[1]).remove::<PvsObject>();
    app.update();
    assert_eq!(drawn(&app, cut), before[1..]);
}

/// A mesh of the level that is hidden, and its middle, which is in the picture.
fn hidden_one(app: &App, cut: Entity, whole: Entity) -> (Entity, Vec3) {
    let left = drawn(app, cut);
    let frustum = app.world().get::<Frustum>(whole).expect("a camera has one");
    let middle = |entity: Entity| {
        let bounds = app.world().get::<Aabb>(entity).expect("it has one");
        app.world().get::<GlobalTransform>(entity).expect("it has one").transform_point(bounds.center.into())
    };
    let hidden = drawn(app, whole).into_iter().filter(|entity| !left.contains(entity));
    let mut hidden = hidden.map(|entity| (entity, middle(entity)));
    let is_in_view = |at: Vec3| frustum.intersects_sphere(&Sphere { center: at.into(), radius: -0.1 }, false);
    hidden.find(|(_, at)| is_in_view(*at)).expect("something is hidden")
}

#[test]
fn what_moves_is_drawn_where_it_is() {
    let (mut app, cut, whole) = two(fits);
    let (hidden, center) = hidden_one(&app, cut, whole);
    let rest = *app.world().get::<Transform>(hidden).expect("it has one");
    let way = here().transform_point(Vec3::new(0.0, 0.0, -0.8)) - center;
    app.world_mut().get_mut::<Transform>(hidden).expect("it has one").translation += way;
    app.update();
    assert!(drawn(&app, cut).contains(&hidden), "it is before the camera");
    *app.world_mut().get_mut::<Transform>(hidden).expect("it has one") = rest;
    app.update();
    assert!(!drawn(&app, cut).contains(&hidden), "it is back");
    // The same by the node that it hangs on.
    let node = app.world().get::<ChildOf>(hidden).expect("it hangs on one").parent();
    app.world_mut().get_mut::<Transform>(node).expect("it has one").translation += way;
    app.update();
    assert!(drawn(&app, cut).contains(&hidden));
    app.world_mut().get_mut::<Transform>(node).expect("it has one").translation -= way;
    app.update();
    // Rounding may leave the node elsewhere than before: then it is judged by its box.
    let scene = app.world_mut().query_filtered::<Entity, With<PvsScene>>().single(app.world()).expect("one scene");
    app.world_mut().entity_mut(hidden).insert(ChildOf(scene));
    app.update();
    app.update();
    assert!(view(&app, cut).state == PvsState::Inside);
}

#[test]
fn movers_are_culled_by_the_cells_that_their_boxes_meet() {
    let (mut app, cut, whole) = two(fits);
    let (_, center) = hidden_one(&app, cut, whole);
    let mut spawn = |at: Vec3, is_mover: bool| {
        let mesh = app.world_mut().resource_mut::<Assets<Mesh>>().add(Cuboid::from_length(0.02));
        let top = app.world_mut().spawn((Transform::from_translation(at), Visibility::default())).id();
        if is_mover {
            app.world_mut().entity_mut(top).insert(PvsMover);
        }
        let part = app.world_mut().spawn((Mesh3d(mesh), ChildOf(top))).id();
        (top, part)
    };
    let (near, far) = (here().transform_point(Vec3::new(0.0, 0.0, -0.5)), center);
    let ((_, near), (top, far), (_, far_still)) = (spawn(near, true), spawn(far, true), spawn(far, false));
    for _ in 0..3 {
        app.update();
    }
    let (left, all) = (drawn(&app, cut), drawn(&app, whole));
    assert_eq!([near, far, far_still].map(|entity| all.contains(&entity)), [true; 3], "all are in the picture");
    assert_eq!([near, far, far_still].map(|entity| left.contains(&entity)), [true, false, true]);
    app.world_mut().entity_mut(top).remove::<PvsMover>();
    app.update();
    assert!(drawn(&app, cut).contains(&far), "it is left to Bevy again");
}

#[test]
fn what_is_exempt_from_culling_by_the_frustum_is_exempt() {
    let (mut app, cut, whole) = two(fits);
    let (hidden, _) = hidden_one(&app, cut, whole);
    app.world_mut().entity_mut(hidden).insert(NoFrustumCulling);
    app.update();
    assert!(drawn(&app, cut).contains(&hidden));
    app.world_mut().entity_mut(hidden).remove::<NoFrustumCulling>();
    app.update();
    assert!(!drawn(&app, cut).contains(&hidden));
    // Such meshes are in no list, and drawn: there is nothing that the plugin could take them out of.
    app.world_mut().entity_mut(hidden).insert(NoCpuCulling);
    app.update();
    assert!(!drawn(&app, whole).contains(&hidden) && !drawn(&app, cut).contains(&hidden));
    assert!(app.world().get::<ViewVisibility>(hidden).expect("it has one").get());
}

#[test]
fn a_camera_without_a_perspective_draws_everything() {
    let (mut app, cut, whole) = two(fits);
    for camera in [cut, whole] {
        app.world_mut().entity_mut(camera).insert(Projection::Orthographic(OrthographicProjection::default_3d()));
    }
    app.update();
    assert_eq!((drawn(&app, cut), view(&app, cut).state), (drawn(&app, whole), PvsState::NoEye));
    assert_eq!(problems(&app), [PvsProblemKind::NoPerspective]);
}

#[test]
fn a_locked_set_stays_while_the_camera_flies() {
    let (mut app, cut, whole) = two(fits);
    let seen = view(&app, cut).cells().to_vec();
    app.world_mut().entity_mut(cut).insert(bevy_sightlines::PvsLock);
    look(&mut app, &[cut, whole], Transform::from_xyz(30.0, 30.0, 60.0).looking_at(Vec3::new(9.0, 1.7, 5.0), Vec3::Y));
    app.update();
    assert_eq!(view(&app, cut).cells(), seen);
    assert!(drawn(&app, cut).len() * 2 < drawn(&app, whole).len());
    app.world_mut().entity_mut(cut).remove::<bevy_sightlines::PvsLock>();
    app.update();
    assert_eq!((view(&app, cut).state, drawn(&app, cut)), (PvsState::Outside, drawn(&app, whole)));
}

#[test]
fn changes_of_what_may_be_seen_are_sent() {
    #[derive(Resource, Default)]
    struct Changes(Vec<PvsChanged>);
    let (mut app, cut, _) = two(fits);
    app.init_resource::<Changes>().add_systems(
        Last,
        |mut sent: MessageReader<PvsChanged>, mut all: ResMut<Changes>| {
            all.0.extend(sent.read().cloned());
        },
    );
    app.update();
    app.world_mut().resource_mut::<Changes>().0.clear();
    app.update();
    assert_eq!(app.world().resource::<Changes>().0, [], "nothing has changed");
    let before = view(&app, cut).at().to_vec();
    look(&mut app, &[cut], Transform::from_xyz(3.0, 1.7, 2.0));
    app.update();
    let sent = app.world().resource::<Changes>().0.clone();
    let [change] = &sent[..] else { panic!("{sent:?}") };
    assert_eq!((change.camera, &change.at[..]), (cut, view(&app, cut).at()));
    assert_ne!(change.at, before);
    assert!(!change.entered.is_empty() && change.entered.is_sorted() && change.left.is_sorted());
}
