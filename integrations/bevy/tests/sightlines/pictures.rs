//! Pictures with and without the plugin: the same to the last bit, with fewer meshes drawn.
//!
//! Cameras stand in the same place and draw into images, one with a table, one without, one with a table in which a visible pair is hidden. Every mesh has a color of its own, so that
//! one that is missing shows.

use crate::app::{bytes, without};
use crate::shots::{
    FOV, SIZE, Sides, app, camera, color, folder_of, has_device, is_inside, load, meshes, n_different, paint,
    paint_all, start, take, take_all,
};
use bevy::pbr::MeshMaterial3d;
use bevy::prelude::*;
use bevy::render::renderer::RenderAdapterInfo;
use bevy_sightlines::pvs::{CellId, ObjectId, PortalId, Table};
use bevy_sightlines::{PvsCamera, PvsDoor, PvsMethod, PvsTable};
use sightlines_eye_to_cell::TableCells;
use sightlines_pvs::PlaceBuffer;
use sightlines_walkthrough::{CameraPose, wander};
use std::collections::BTreeSet;
use std::path::Path;

/// What a walk came to.
#[derive(Debug, Default)]
struct Tally {
    frames: usize,
    /// Pictures that differ, and pixels that do.
    different: usize,
    pixels: usize,
    /// The same with a table in which one visible pair is hidden.
    different_impostor: usize,
    pixels_impostor: usize,
    /// Different pictures among those with the table.
    scenes: usize,
    /// Frames inside of cells.
    inside: usize,
    /// Meshes drawn without the table, and with it.
    bevy: usize,
    drawn: usize,
    /// Pixels that show leaves of doors.
    leaves: usize,
    /// Pictures of which one or two pixels differ, and that are the same with the camera turned a little, to whichever side: the device drew
    /// neither of two meshes where their edges meet, and showed what is behind.
    cracks: usize,
}

/// Of a pixel, by how much the camera is turned to find cracks between meshes.
const A_LITTLE: f64 = 0.02;

/// The same view, turned by a small part of a pixel: left, right, up, down.
fn turned(pose: &CameraPose) -> [CameraPose; 4] {
    let by = A_LITTLE * FOV / f64::from(SIZE.y);
    let [x, y, z] = pose.dir;
    let beside = [-z, 0.0, x];
    let turn = |to: [f64; 3], by: f64| {
        let dir = std::array::from_fn(|k| pose.dir[k] + by * to[k]);
        CameraPose { dir, ..*pose }
    };
    let above = [-x * y, x * x + z * z, -z * y];
    [turn(beside, by), turn(beside, -by), turn(above, by), turn(above, -by)]
}

/// A pair of the table that a picture shows: the cell of its eye, and the object with most pixels of those that do not touch the cell.
fn visible_pair(table: &Table, pose: &CameraPose, picture: &[u8]) -> Option<(CellId, ObjectId)> {
    let mut buffer = PlaceBuffer::new();
    let eye = pose.eye.map(|x| f64::from(x as f32));
    let &[cell] = table.cells_at(eye, &mut buffer).inside()? else { return None };
    let shown = |object: ObjectId| {
        let [r, g, b, _] = color(object.0).to_srgba().to_u8_array();
        picture.chunks_exact(4).filter(|pixel| pixel[..3] == [r, g, b]).count()
    };
    let far = table.visible_objects(cell).into_iter().filter(|object| !table.objects_of(cell).contains(object));
    far.map(|object| (shown(object), object)).max().filter(|(n, _)| *n > 20).map(|(_, object)| (cell, object))
}

/// Hangs the leaves of doors that are shut.
fn hang(app: &mut App, doors: &[(PortalId, [Vec3; 2])]) {
    let wood = paint(app, LEAF, None);
    for (portal, [min, max]) in doors {
        let mesh = app.world_mut().resource_mut::<Assets<Mesh>>().add(Cuboid::from_size(*max - *min));
        let leaf = (Mesh3d(mesh), MeshMaterial3d(wood.clone()), Transform::from_translation((*min + *max) / 2.0));
        app.world_mut().spawn((leaf, PvsDoor::portals([portal.0]).shut()));
    }
}

/// The number by which leaves of doors are painted.
const LEAF: u32 = 1 << 20;

/// Walks with three cameras: with the table, without one, and with one in which a visible pair is hidden.
fn walk(app: &mut App, table: &Table, poses: &[CameraPose], doors: &[(PortalId, [Vec3; 2])]) -> Tally {
    load(app, table.objects().len());
    // Eyes of the walk also come to where only backs are seen.
    paint_all(app, Sides::Both);
    hang(app, doors);
    let add = |app: &mut App, table: Table| {
        let table = app.world_mut().resource_mut::<Assets<PvsTable>>().add(PvsTable::new(table));
        camera(app, Some(PvsCamera::new(table).with_method(PvsMethod::Exact).without_thread()))
    };
    let whole = camera(app, None);
    start(app, [whole], &poses[0]);
    let pair = poses[poses.len() / 2..].iter().step_by(5).find_map(|pose| {
        let [picture] = take(app, [whole], pose);
        visible_pair(table, pose, &picture)
    });
    let (cell, object) = pair.expect("something is seen from afar");
    let cut = add(app, table.clone());
    let impostor = add(app, without(table, cell, object));
    let cameras = [cut, whole, impostor];
    let mut tally = Tally { frames: poses.len(), ..Tally::default() };
    let pictures = take_all(app, cameras, poses, |app, _| {
        tally.inside += usize::from(is_inside(app, cut));
        tally.bevy += meshes(app, whole).len();
        tally.drawn += meshes(app, cut).len();
    });
    let mut scenes = BTreeSet::new();
    let leaf = color(LEAF).to_srgba().to_u8_array();
    for ([cut, whole, impostor], pose) in pictures.iter().zip(poses) {
        let (n, n_impostor) = (n_different(cut, whole), n_different(impostor, whole));
        let is_the_same = |pose: &CameraPose| {
            let [cut, whole, _] = take(app, cameras, pose);
            cut == whole
        };
        if (1..=2).contains(&n) && turned(pose).iter().all(is_the_same) {
            tally.cracks += 1;
        } else {
            tally.different += usize::from(n > 0);
            tally.pixels += n;
        }
        tally.different_impostor += usize::from(n_impostor > 0);
        tally.pixels_impostor += n_impostor;
        tally.leaves += cut.chunks_exact(4).filter(|pixel| pixel[..3] == leaf[..3]).count();
        let colors: BTreeSet<&[u8]> = cut.chunks_exact(4).collect();
        if colors.len() > 2 {
            scenes.insert(cut.to_vec());
        }
    }
    tally.scenes = scenes.len();
    println!("{tally:?}");
    tally
}

/// Portals as wide and as high as a door, each with a box that fills it and a little of what is around it.
fn doors(table: &Table) -> Vec<(PortalId, [Vec3; 2])> {
    let mut found = Vec::new();
    for (k, portal) in (0..).zip(table.portals()) {
        let corners = portal.points.iter().map(|point| Vec3::from_array(point.map(|x| x as f32)));
        let (min, max) = corners.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(a, b), p| (a.min(p), b.max(p)));
        let (size, wide) = (max - min, (max - min).x.max((max - min).z));
        let stands = size.y > 1.5 && size.y < 2.6 && size.x.min(size.z) == 0.0 && wide > 0.6 && wide < 1.6;
        if portal.points.len() == 4 && stands {
            found.push((PortalId(k), [min - Vec3::splat(0.01), max + Vec3::splat(0.01)]));
        }
    }
    found
}

fn poses(table: &Table, n: usize, step: f64) -> Vec<CameraPose> {
    wander(&TableCells::new(table), n, step, 11).expect("a table in memory can be read")
}

fn compare(name: &str, glb: &[u8], table: &Table, step: f64, doors: &[(PortalId, [Vec3; 2])]) -> Tally {
    let folder = folder_of(glb, name);
    let tally = walk(&mut app(&folder), table, &poses(table, 200, step), doors);
    std::fs::remove_dir_all(folder).expect("it is ours");
    assert_eq!((tally.frames, tally.inside, tally.different), (200, 200, 0), "{tally:?}");
    assert!(tally.cracks <= 2, "{tally:?}");
    assert!(tally.scenes > 100 && tally.drawn * 2 < tally.bevy, "{tally:?}");
    // The comparison can fail.
    assert!(tally.different_impostor > 0, "{tally:?}");
    tally
}

#[test]
fn pictures_of_a_tower_with_shut_doors_are_the_same_with_fewer_meshes() {
    if !has_device() {
        return;
    }
    let table = crate::app::table("tower.pvs");
    let doors = doors(&table);
    assert!(doors.len() > 10, "{} doors", doors.len());
    let tally = compare("tower", &bytes("tower.glb"), &table, 0.3, &doors);
    assert!(tally.leaves > 1000, "{tally:?}");
}

/// The office of the folder of real data, with a table that the program has made of it for both sides of faces.
#[test]
fn pictures_of_a_real_building_are_the_same_with_fewer_meshes() {
    let Some(data) = std::env::var_os("SIGHTLINES_DATA").filter(|_| has_device()) else {
        println!("NOT RUN: SIGHTLINES_DATA has no folder of real scenes");
        return;
    };
    let glb = std::fs::read(Path::new(&data).join("scenes/office_a/office_a.glb")).expect("the office is there");
    let folder = folder_of(&glb, "office-device");
    let device = app(&folder).world().resource::<RenderAdapterInfo>().name.clone();
    std::fs::remove_dir_all(folder).expect("it is ours");
    if device.contains("SwiftShader") {
        println!(
            "NOT RUN: SwiftShader loses triangles that are a millimetre from the eye, as in the joints between floors"
        );
        return;
    }
    let table = Table::from_bytes(&bytes("office.pvs")).expect("a table");
    compare("office", &glb, &table, 0.3, &[]);
}
