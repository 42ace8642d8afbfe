use super::*;
use sightlines_multifocal::mesh::{SheetMethod, Sheets};
use sightlines_multifocal::{Occludees, Split, adaptive};
use sightlines_scenes::{TowerOptions, tower, tower_rooms};
use std::sync::Arc;

/// Groups of boxes hide nothing that a ray reaches, and as much as each box asked for itself.
#[test]
fn groups_hide_as_much_as_boxes_and_nothing_seen() {
    let options = TowerOptions { floors: 1, rooms_x: 2, rooms_y: 2, furniture: 1, ..TowerOptions::default() };
    let scene = tower(options).unwrap();
    let faces = Faces::of_scene(&scene).unwrap();
    // Three rooms in eight boxes each: more than a group.
    let rooms = tower_rooms(options).unwrap();
    let volume = |room: &Aabb<3>| Volume::new(*room).unwrap();
    let views = crate::Views::new(rooms.iter().take(3).map(|room| volume(&room.bounds))).unwrap().cut(24);
    let boxes: Vec<Volume> = views.parts().iter().map(|view| view.volume).collect();
    assert_eq!(boxes.len(), 24);
    let sheets = Arc::new(Sheets::new(&scene.occluding_triangles().collect::<Vec<_>>()));
    let make = || Box::new(SheetMethod::shared(Arc::clone(&sheets))) as RegionMethod;
    let start = vec![faces.ids().map(|face| faces.has_area(face)).collect::<Vec<bool>>(); boxes.len()];
    let asker = Asker::new(&faces);
    let each = asker.each(&make, &boxes, start.clone()).unwrap();
    let any = asker.any(&make, &boxes, &start).unwrap();

    let sampler = RaySampler::new(faces.corners().iter().map(std::slice::from_ref));
    let occludees = Occludees::new(faces.corners().iter().map(|t| vec![*t]).collect());
    let (mut random, mut n_hits, mut n_hidden, mut n_alone) = (Random::new(8), 0, 0, 0);
    let mut alone_any = vec![false; faces.len()];
    for ((each, start), volume) in each.iter().zip(&start).zip(&boxes) {
        for _ in 0..4000 {
            let Some(face) = sampler.first_triangle(random.point(volume.bounds()), random.direction()) else {
                continue;
            };
            assert!(each[face as usize] && any[face as usize], "{face} {volume:?}");
            n_hits += 1;
        }
        let mut alone = start.clone();
        let split = Split { depth: 0, n_rays: 1 << 14, ..Split::default() };
        adaptive::see(&mut *make(), &occludees, &sampler, volume, &split, &mut alone, &mut |_| {}).unwrap();
        n_hidden += each.iter().filter(|visible| !**visible).count();
        n_alone += alone.iter().filter(|visible| !**visible).count();
        alone_any.iter_mut().zip(&alone).for_each(|(any, alone)| *any |= alone);
    }
    assert!(n_hits > 10_000 && n_alone > 24 * faces.len() / 2, "{n_hits} {n_alone}");
    assert!(n_hidden * 1000 >= n_alone * 999, "{n_hidden} {n_alone}");
    let count = |visible: &[bool]| visible.iter().filter(|visible| **visible).count();
    assert!(count(&any) * 999 <= count(&alone_any) * 1000, "{} {}", count(&any), count(&alone_any));
    // An impostor that hides one face more is caught by the rays.
    let mut impostor = each[0].clone();
    let face = (0..4000).find_map(|_| sampler.first_triangle(random.point(boxes[0].bounds()), random.direction()));
    impostor[face.expect("a room has walls") as usize] = false;
    let hits = (0..4000).filter_map(|_| sampler.first_triangle(random.point(boxes[0].bounds()), random.direction()));
    assert!(hits.into_iter().any(|face| !impostor[face as usize]));
}
