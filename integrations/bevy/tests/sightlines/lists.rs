//! What is left in the lists of cameras, compared with the answer of the query.

use crate::app::*;
use bevy::gltf::GltfPlugin;
use bevy::gltf::convert_coordinates::GltfConvertCoordinates;
use bevy::light::LightPlugin;
use bevy::math::{DAffine3, DMat4, DVec3};
use bevy::prelude::*;
use bevy_sightlines::pvs::{DoorRecord, ObjectId, PortalId, Table};
use bevy_sightlines::{PvsCamera, PvsDoor, PvsMethod, PvsObject, PvsState, PvsTable};
use sightlines_eye_to_cell::{Doors, Method, Scratch, StepBudget, TableCells, View, VisibleSet, VisibleSubgraph};
use sightlines_pvs::{CellId, PlaceBuffer};
use sightlines_walkthrough::{CameraPose, wander};
use std::collections::{BTreeSet, HashMap};

/// Answers queries without the plugin: point location, a subgraph for each cell, the method.
struct Oracle {
    cells: TableCells<Table>,
    subgraphs: HashMap<CellId, VisibleSubgraph>,
    scratch: Scratch,
    seen: VisibleSet,
    doors: Doors,
}

impl Oracle {
    fn new(table: Table) -> Self {
        let cells = TableCells::new(table);
        let (scratch, seen, doors) = (Scratch::new(), VisibleSet::new(), Doors::all_open());
        Self { cells, subgraphs: HashMap::new(), scratch, seen, doors }
    }

    /// The objects that are seen; `None` outside.
    fn objects(&mut self, eye: DVec3, clip_from_scene: DMat4, method: Method) -> Option<BTreeSet<ObjectId>> {
        let mut buffer = PlaceBuffer::new();
        let at: Vec<CellId> = self.cells.table().cells_at(eye.to_array(), &mut buffer).inside()?.to_vec();
        let view = View::from_view_projection(eye.to_array(), clip_from_scene.to_cols_array_2d()).expect("a camera");
        self.scratch.allow(StepBudget::FRAME);
        self.seen.clear(self.cells.table().n_cells(), self.cells.table().objects().len());
        for cell in at {
            let cells = &self.cells;
            let prepare = || VisibleSubgraph::prepare(cells, cell).expect("a table in memory can be read");
            let subgraph = self.subgraphs.entry(cell).or_insert_with(prepare);
            method.look(subgraph, &view, &self.doors, &mut self.scratch, &mut self.seen);
        }
        Some(self.seen.objects().iter().copied().collect())
    }
}

fn affine(place: &GlobalTransform) -> DAffine3 {
    let map = place.affine();
    DAffine3::from_cols(
        map.matrix3.x_axis.as_dvec3(),
        map.matrix3.y_axis.as_dvec3(),
        map.matrix3.z_axis.as_dvec3(),
        map.translation.as_dvec3(),
    )
}

/// A pose of a walk as that of a camera, in a scene that stands at `scene`.
fn pose_in(scene: &Transform, pose: &CameraPose) -> Transform {
    let place = scene.compute_affine();
    let eye = place.transform_point3(Vec3::from_array(pose.eye.map(|x| x as f32)));
    let dir = place.transform_vector3(Vec3::from_array(pose.dir.map(|x| x as f32)));
    Transform::from_translation(eye).looking_to(dir, Vec3::Y)
}

fn walk(table: &Table, n: usize, seed: u64) -> Vec<CameraPose> {
    let poses = wander(&TableCells::new(table), n, 0.3, seed).expect("a table in memory can be read");
    assert_eq!(poses.len(), n, "the tower has portals");
    poses
}

/// What a comparison came to.
#[derive(Debug, Default, PartialEq)]
struct Tally {
    frames: usize,
    inside: usize,
    /// Entities that Bevy draws, and what is left of them.
    bevy: usize,
    drawn: usize,
    wrong: usize,
}

/// Walks with two cameras, and compares the lists of the one with a table with those of the other one cut with the oracle's answer.
fn compare(
    app: &mut App,
    scene: Transform,
    shown: PvsTable,
    (truth, closed): (&Table, &[PortalId]),
    methods: &[PvsMethod],
    n: usize,
) -> Tally {
    let n_objects = truth.objects().len();
    spawn_level(app, "tower.glb", scene);
    until_level(app, n_objects);
    let handle = app.world_mut().resource_mut::<Assets<PvsTable>>().add(shown);
    let cut = spawn_camera(app, Some(PvsCamera::new(handle).without_thread()));
    let whole = spawn_camera(app, None);
    let sources: HashMap<Entity, u32> =
        app.world_mut().query::<(Entity, &PvsObject)>().iter(app.world()).map(|(e, o)| (e, o.source)).collect();
    assert_eq!(sources.len(), n_objects);
    let root = {
        let mut roots = app.world_mut().query_filtered::<Entity, With<bevy_sightlines::PvsScene>>();
        roots.single(app.world()).expect("one scene")
    };
    let mut oracle = Oracle::new(truth.clone());
    closed.iter().for_each(|portal| {
        oracle.doors.close(*portal);
    });
    // The file may be turned against the scene that it is in.
    let scene = app.world().get::<GlobalTransform>(root).expect("it has one").compute_transform();
    let mut tally = Tally::default();
    for (k, pose) in walk(truth, n, 7).iter().enumerate() {
        let method = methods[k % methods.len()];
        app.world_mut().get_mut::<PvsCamera>(cut).expect("it has one").method = method;
        look(app, &[cut, whole], pose_in(&scene, pose));
        app.update();
        // A frame that comes to a new cell prepares it for the next.
        while view(app, cut).state == PvsState::Late {
            app.update();
        }
        let place = affine(app.world().get::<GlobalTransform>(cut).expect("it has one"));
        let root = affine(app.world().get::<GlobalTransform>(root).expect("it has one"));
        let Projection::Perspective(lens) = lens() else { unreachable!("the lens is one") };
        let clip_from_view = bevy::camera::CameraProjection::get_clip_from_view(&lens).as_dmat4();
        let clip_from_scene = clip_from_view * DMat4::from(place.inverse() * root);
        let seen = oracle.objects(root.inverse().transform_point3(place.translation), clip_from_scene, method.into());
        let all = drawn(app, whole);
        let expected: Vec<Entity> = all
            .iter()
            .copied()
            .filter(|entity| seen.as_ref().is_none_or(|seen| seen.contains(&ObjectId(sources[entity]))))
            .collect();
        let left = drawn(app, cut);
        tally.frames += 1;
        tally.inside += usize::from(seen.is_some());
        tally.bevy += all.len();
        tally.drawn += left.len();
        tally.wrong += usize::from(left != expected);
        assert!(left.is_sorted(), "the order stays");
        let noted = view(app, cut);
        assert_eq!((noted.drawn as usize, noted.culled as usize), (left.len(), all.len() - left.len()));
        assert_eq!(noted.state == PvsState::Inside, seen.is_some(), "frame {k}: {noted:?}");
    }
    tally
}

const METHODS: [PvsMethod; 5] = [
    PvsMethod::Exact,
    PvsMethod::CellToCell,
    PvsMethod::DisjointCell,
    PvsMethod::ConnectedComponent,
    PvsMethod::IncidentPortals,
];

#[test]
fn what_is_left_is_the_answer_of_the_query_cut_with_the_frustum() {
    let table = table("tower.pvs");
    let tally = compare(&mut app(), Transform::IDENTITY, PvsTable::new(table.clone()), (&table, &[]), &METHODS, 10_000);
    println!("{tally:?}");
    assert_eq!((tally.frames, tally.wrong), (10_000, 0), "{tally:?}");
    assert!(tally.inside > 9_900 && tally.drawn * 2 < tally.bevy, "{tally:?}");
}

#[test]
fn scenes_that_are_moved_turned_and_scaled_are_culled_as_they_stand() {
    let table = table("tower.pvs");
    let place = Transform {
        translation: Vec3::new(100.0, -20.0, 3.0),
        rotation: Quat::from_euler(EulerRot::YXZ, 0.8, 0.3, -0.2),
        scale: Vec3::new(2.0, 0.5, 1.5),
    };
    let tally = compare(&mut app(), place, PvsTable::new(table.clone()), (&table, &[]), &METHODS[..2], 1000);
    println!("{tally:?}");
    assert_eq!((tally.frames, tally.wrong), (1000, 0), "{tally:?}");
    assert!(tally.inside > 990 && tally.drawn * 2 < tally.bevy, "{tally:?}");
}

/// glTF looks along its z axis, Bevy against it: files can be turned while they are loaded.
#[test]
fn files_that_are_turned_while_they_are_loaded_are_culled() {
    let table = table("tower.pvs");
    let turned = GltfConvertCoordinates { rotate_scene_entity: true, rotate_meshes: true };
    let mut app = app_of(&assets(), GltfPlugin { convert_coordinates: turned, ..default() }, |_| {});
    let shown = PvsTable::new(table.clone());
    let tally = compare(&mut app, Transform::IDENTITY, shown, (&table, &[]), &METHODS[..2], 500);
    println!("{tally:?}");
    assert_eq!((tally.frames, tally.wrong, tally.inside), (500, 0, 500), "{tally:?}");
    assert!(tally.drawn * 2 < tally.bevy, "{tally:?}");
}

#[test]
fn nothing_is_seen_through_doors_that_are_shut() {
    let open = table("tower.pvs");
    let portals: Vec<PortalId> = (0..open.portals().len() as u32).step_by(3).map(PortalId).collect();
    let (by_number, by_name) = portals.split_at(portals.len() / 2);
    let record = |portals: &[PortalId]| DoorRecord { name: "gate".to_owned(), object: None, portals: portals.to_vec() };
    let (left, right) = by_name.split_at(by_name.len() / 2);
    // Names may repeat, as the two wings of a door may have one.
    let table = open.clone().with_doors(vec![record(left), record(right)]).expect("the portals are there");
    let tallies = [true, false].map(|are_shut| {
        let mut app = app();
        for door in [PvsDoor::named("gate"), PvsDoor::portals(by_number.iter().map(|portal| portal.0))] {
            app.world_mut().spawn(if are_shut { door.shut() } else { door });
        }
        let closed = if are_shut { &portals[..] } else { &[] };
        let shown = PvsTable::new(table.clone());
        compare(&mut app, Transform::IDENTITY, shown, (&table, closed), &METHODS, 1000)
    });
    println!("{tallies:?}");
    assert!(tallies.iter().all(|tally| (tally.frames, tally.wrong) == (1000, 0)), "{tallies:?}");
    assert!(tallies[0].drawn * 10 < tallies[1].drawn * 9, "{tallies:?}");
}

#[cfg(feature = "packed")]
#[test]
fn packed_tables_cull_the_same() {
    let table = table("tower.pvs");
    let packed = PvsTable::packed(bytes("tower.pvz"), 1 << 20).expect("the program packs tables");
    let tally = compare(&mut app(), Transform::IDENTITY, packed, (&table, &[]), &METHODS, 1000);
    println!("{tally:?}");
    assert_eq!((tally.frames, tally.wrong), (1000, 0), "{tally:?}");
    assert!(tally.drawn * 2 < tally.bevy, "{tally:?}");
}

/// The table with one pair hidden: at the middle of the walk, the eye's cell and an object in the picture that does not touch it.
fn with_a_hidden_pair(table: &Table) -> Table {
    let mut oracle = Oracle::new(table.clone());
    for pose in walk(table, 3000, 7).iter().skip(1500) {
        let eye = DVec3::from_array(pose.eye);
        let camera =
            Transform::from_translation(eye.as_vec3()).looking_to(DVec3::from_array(pose.dir).as_vec3(), Vec3::Y);
        let view = DMat4::from(affine(&GlobalTransform::from(camera)).inverse());
        let Projection::Perspective(lens) = lens() else { unreachable!("the lens is one") };
        let clip = bevy::camera::CameraProjection::get_clip_from_view(&lens).as_dmat4() * view;
        let mut buffer = PlaceBuffer::new();
        let Some(&[cell]) = table.cells_at(camera.translation.to_array().map(f64::from), &mut buffer).inside() else {
            continue;
        };
        let seen = oracle.objects(camera.translation.as_dvec3(), clip, Method::Exact).expect("it is inside");
        let far = seen.into_iter().find(|object| !table.objects_of(cell).contains(object));
        if let Some(object) = far {
            return without(table, cell, object);
        }
    }
    panic!("nothing is seen from afar")
}

/// The comparison can fail: with a table in which one visible pair of a cell and an object is hidden, it does.
#[test]
fn a_table_with_a_hidden_pair_is_found_out() {
    let table = table("tower.pvs");
    let impostor = with_a_hidden_pair(&table);
    let tally = compare(&mut app(), Transform::IDENTITY, PvsTable::new(impostor), (&table, &[]), &METHODS[1..2], 3000);
    println!("{tally:?}");
    assert!(tally.wrong > 0, "{tally:?}");
}

#[test]
fn other_cameras_and_shadows_keep_what_they_had() {
    let table = table("tower.pvs");
    let lists = |with_table: bool| {
        let mut app = app_with(&assets(), |app| {
            app.add_plugins((bevy::gizmos::GizmoPlugin, LightPlugin));
        });
        spawn_level(&mut app, "tower.glb", Transform::IDENTITY);
        until_level(&mut app, table.objects().len());
        let handle = add_table(&mut app, table.clone());
        let pvs = with_table.then(|| PvsCamera::new(handle).without_thread());
        let (cut, whole) = (spawn_camera(&mut app, pvs), spawn_camera(&mut app, None));
        app.world_mut().spawn((
            DirectionalLight { shadow_maps_enabled: true, ..default() },
            Transform::default().looking_to(Vec3::new(0.3, -1.0, 0.2), Vec3::Y),
        ));
        let lamp = app
            .world_mut()
            .spawn((PointLight { shadow_maps_enabled: true, ..default() }, Transform::from_xyz(9.0, 2.0, 5.0)));
        let lamp = lamp.id();
        let pose = walk(&table, 40, 3)[39];
        look(&mut app, &[cut, whole], pose_in(&Transform::IDENTITY, &pose));
        for _ in 0..3 {
            app.update();
        }
        let world = app.world_mut();
        let cube: Vec<Vec<Entity>> = world
            .get::<bevy::camera::visibility::CubemapVisibleEntities>(lamp)
            .expect("a lamp has one")
            .iter()
            .map(|face| face.entities.clone())
            .collect();
        let cascades: Vec<usize> = world
            .query::<&bevy::camera::visibility::CascadesVisibleEntities>()
            .iter(world)
            .flat_map(|cascades| {
                let mut views: Vec<_> = cascades.entities.iter().collect();
                views.sort_by_key(|(view, _)| **view);
                views
                    .into_iter()
                    .flat_map(|(_, list)| list.iter().map(|cascade| cascade.entities.len()))
                    .collect::<Vec<_>>()
            })
            .collect();
        (drawn(&app, cut), drawn(&app, whole), cube, cascades)
    };
    let ((cut, whole, cube, cascades), (uncut, whole_without, cube_without, cascades_without)) =
        (lists(true), lists(false));
    assert!(cut.len() < uncut.len(), "{} of {}", cut.len(), uncut.len());
    assert_eq!(whole, whole_without);
    assert_eq!((&cube, &cascades), (&cube_without, &cascades_without));
    let n_shadows = cube.iter().map(Vec::len).sum::<usize>() + cascades.iter().sum::<usize>();
    assert!(n_shadows > cut.len(), "lights see more than the camera draws: {n_shadows}");
}
