//! Levels that the game makes itself: meshes that name the objects that they show.

use crate::app::*;
use bevy::camera::visibility::NoFrustumCulling;
use bevy::math::{DAffine3, DVec3};
use bevy::prelude::*;
use bevy_sightlines::pvs::{ObjectId, Table, TableParts};
use bevy_sightlines::{PvsCamera, PvsMethod, PvsParts, PvsScene, PvsSource, PvsState};
use sightlines_eye_to_cell::TableCells;
use sightlines_pvs::PlaceBuffer;
use sightlines_walkthrough::{CameraPose, wander};
use std::collections::BTreeSet;

/// Objects of a mesh.
const OF_MESH: usize = 3;

/// Where the level is: as a Quake map in Bevy, with its third axis up, smaller, and away from the origin.
fn place() -> Transform {
    Transform { rotation: Quat::from_xyzw(-0.5, 0.5, 0.5, 0.5), ..Transform::from_xyz(3.0, -2.0, 7.0) }
        .with_scale(Vec3::splat(0.025))
}

/// The tower's table without the nodes of its file, as those of other formats are.
fn plain() -> Table {
    Table::new(TableParts { object_sources: Vec::new(), ..table("tower.pvs").into_parts() }).expect("sources are free")
}

/// A level without a file.
struct Made {
    app: App,
    level: Entity,
    /// A mesh for every three objects, in their order.
    meshes: Vec<Entity>,
    /// A camera with the table, and one without.
    cameras: [Entity; 2],
}

/// Makes a level of the boxes of the tower's objects, with cameras that ask `shown`.
fn made(shown: Table) -> Made {
    let mut app = app();
    let objects = plain().into_parts().objects;
    let source = |(k, object): (u32, &bevy_sightlines::pvs::ObjectRecord)| PvsSource {
        node: k,
        name: object.name.clone(),
        min: object.min,
        max: object.max,
        ..default()
    };
    let sources: Vec<PvsSource> = (0..).zip(&objects).map(source).collect();
    let level = app.world_mut().spawn((PvsScene { sources }, place())).id();
    let mut meshes = Vec::new();
    for (first, of_mesh) in (0..).step_by(OF_MESH).zip(objects.chunks(OF_MESH)) {
        let corner = |k: usize, min: bool| {
            let all = of_mesh.iter().map(|object| if min { object.min[k] } else { object.max[k] });
            all.fold(if min { f64::INFINITY } else { f64::NEG_INFINITY }, if min { f64::min } else { f64::max }) as f32
        };
        let (min, max) = (
            Vec3::from_array([0, 1, 2].map(|k| corner(k, true))),
            Vec3::from_array([0, 1, 2].map(|k| corner(k, false))),
        );
        let mesh = app.world_mut().resource_mut::<Assets<Mesh>>().add(Cuboid::from_size(max - min));
        // In the coordinates of the world: the level is not above its meshes.
        let at = place().mul_transform(Transform::from_translation((min + max) / 2.0));
        let parts = PvsParts::new(level, first..first + of_mesh.len() as u32);
        meshes.push(app.world_mut().spawn((Mesh3d(mesh), at, Visibility::default(), parts)).id());
    }
    let table = add_table(&mut app, shown);
    let pvs = PvsCamera::new(table).with_method(PvsMethod::CellToCell).without_thread();
    let cameras = [Some(pvs), None].map(|pvs| spawn_camera(&mut app, pvs));
    for _ in 0..3 {
        app.update();
    }
    Made { app, level, meshes, cameras }
}

impl Made {
    fn put(&mut self, pose: &CameraPose) {
        let [eye, dir] = [pose.eye, pose.dir].map(|v| Vec3::from_array(v.map(|x| x as f32)));
        let (eye, dir) = (place().transform_point(eye), place().rotation * dir);
        look(&mut self.app, &self.cameras, Transform::from_translation(eye).looking_to(dir, Vec3::Y));
        self.app.update();
        while view(&self.app, self.cameras[0]).state == PvsState::Late {
            self.app.update();
        }
    }

    fn drawn(&self) -> [BTreeSet<Entity>; 2] {
        self.cameras.map(|camera| drawn(&self.app, camera).into_iter().collect())
    }

    /// The objects that the table calls visible from where the cameras are; none outside.
    fn seen(&self, table: &Table) -> Option<BTreeSet<ObjectId>> {
        let at = |entity| {
            let place = self.app.world().get::<GlobalTransform>(entity).expect("it has one").affine();
            let [x, y, z] = place.matrix3.to_cols_array_2d().map(|column| DVec3::from_array(column.map(f64::from)));
            DAffine3::from_cols(x, y, z, place.translation.as_dvec3())
        };
        let eye = at(self.level).inverse().transform_point3(at(self.cameras[0]).translation);
        let mut buffer = PlaceBuffer::new();
        let cells = table.cells_at(eye.to_array(), &mut buffer).inside()?.to_vec();
        Some(cells.into_iter().flat_map(|cell| table.visible_objects(cell)).collect())
    }
}

fn poses(n: usize) -> Vec<CameraPose> {
    wander(&TableCells::new(plain()), n, 0.3, 11).expect("a table in memory can be read")
}

/// Frames in which the list is not the expected one, and meshes that were drawn without the table, and with it.
fn compare(shown: Table, n: usize) -> (usize, usize, usize) {
    let truth = plain();
    let mut made = made(shown);
    let (mut wrong, mut bevy, mut left) = (0, 0, 0);
    for pose in &poses(n) {
        made.put(pose);
        let [cut, whole] = made.drawn();
        let seen = made.seen(&truth);
        let is_seen = |mesh: usize| {
            let objects = (mesh * OF_MESH..truth.objects().len().min((mesh + 1) * OF_MESH)).map(|k| ObjectId(k as u32));
            seen.as_ref().is_none_or(|seen| objects.into_iter().any(|object| seen.contains(&object)))
        };
        let of = |entity: &Entity| made.meshes.iter().position(|mesh| mesh == entity).expect("a mesh of the level");
        let expected: BTreeSet<Entity> = whole.iter().copied().filter(|entity| is_seen(of(entity))).collect();
        wrong += usize::from(cut != expected);
        (bevy, left) = (bevy + whole.len(), left + cut.len());
    }
    (wrong, bevy, left)
}

#[test]
fn meshes_that_name_their_objects_are_drawn_where_one_of_them_is_seen() {
    let (wrong, bevy, left) = compare(plain(), 500);
    assert_eq!(wrong, 0);
    assert!(left < bevy / 2, "{left} of {bevy} are left");
    println!("500 frames: {bevy} meshes in view, {left} of them seen");
}

#[test]
fn a_table_that_hides_what_is_seen_is_found_out() {
    let table = plain();
    let pose = &poses(1)[0];
    let cell = table.cells_at(pose.eye, &mut PlaceBuffer::new()).inside().expect("a walk is inside")[0];
    // All that the cell sees is hidden from it, but for what is in it.
    let far = table.visible_objects(cell).into_iter().filter(|object| !table.objects_of(cell).contains(object));
    let hidden = far.fold(plain(), |table, object| without(&table, cell, object));
    let (wrong, ..) = compare(hidden, 20);
    assert!(wrong > 0);
}

#[test]
fn what_is_not_where_its_objects_are_is_judged_by_its_box() {
    let mut made = made(plain());
    let pose = poses(1)[0];
    made.put(&pose);
    let [cut, whole] = made.drawn();
    let &hidden = whole.difference(&cut).next().expect("something is culled");
    let at = *made.app.world().get::<Transform>(hidden).expect("it has one");
    // To the eye: seen, whatever the table says of its objects.
    let [eye, dir] = [pose.eye, pose.dir].map(|v| Vec3::from_array(v.map(|x| x as f32)));
    let near = place().transform_point(eye + dir);
    made.app.world_mut().get_mut::<Transform>(hidden).expect("it has one").translation = near;
    made.app.update();
    assert!(made.drawn()[0].contains(&hidden));
    *made.app.world_mut().get_mut::<Transform>(hidden).expect("it has one") = at;
    made.app.update();
    assert!(!made.drawn()[0].contains(&hidden));

    // Of nothing, of something that is not there, exempt from culling, of no level: drawn.
    let &another = whole.difference(&cut).nth(1).expect("more is culled");
    let level = made.level;
    for parts in [PvsParts::new(level, []), PvsParts::new(level, [1 << 20]), PvsParts::new(another, [0])] {
        let before = made.app.world().get::<PvsParts>(another).expect("it has some").clone();
        let is_of_level = parts.level == level;
        made.app.world_mut().entity_mut(another).insert(parts);
        made.app.update();
        // One of no level is judged by its box, which no level has: it is left to Bevy.
        assert!(made.drawn()[0].contains(&another), "{is_of_level}");
        made.app.world_mut().entity_mut(another).insert(before);
        made.app.update();
        assert!(!made.drawn()[0].contains(&another));
    }
    made.app.world_mut().entity_mut(another).insert(NoFrustumCulling);
    made.app.update();
    assert!(made.drawn()[0].contains(&another));
    made.app.world_mut().entity_mut(another).remove::<NoFrustumCulling>();
    made.app.update();
    assert!(!made.drawn()[0].contains(&another));
    made.app.world_mut().entity_mut(another).remove::<PvsParts>();
    made.app.update();
    assert!(made.drawn()[0].contains(&another));
}

#[test]
fn a_level_that_moves_away_from_its_meshes_or_goes_hides_nothing() {
    let mut made = made(plain());
    let pose = poses(1)[0];
    made.put(&pose);
    let [cut, whole] = made.drawn();
    assert!(cut.len() < whole.len());
    // By a tenth of a unit: the eye stays in its cell, and the meshes are judged by their boxes, which is less exact.
    made.app.world_mut().get_mut::<Transform>(made.level).expect("it has one").translation.y += 0.002;
    made.app.update();
    assert_eq!(view(&made.app, made.cameras[0]).state, PvsState::Inside);
    let [moved, _] = made.drawn();
    assert!(cut.is_subset(&moved) && cut != moved, "{} are drawn, {} before", moved.len(), cut.len());
    *made.app.world_mut().get_mut::<Transform>(made.level).expect("it has one") = place();
    made.app.update();
    assert_eq!(made.drawn()[0], cut);
    made.app.world_mut().entity_mut(made.level).despawn();
    made.app.update();
    assert_eq!(made.drawn()[0], whole);
}
